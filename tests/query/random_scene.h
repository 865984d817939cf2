#pragma once
/// A random scene for queries, and random query filters.
#include "tests/query/exact.h"

namespace rubble::test {

/// A way of a random direction and a length from `least` to `most`.
inline Vec3 randomWay(Random& random, double least, double most) {
  const double length = random.uniform(least, most);
  return random.direction() * length;
}

/// 300 bodies in a cube of 20 m that may overlap, over a half space.
inline Scene randomScene(std::uint64_t seed) {
  Random random(seed);
  Scene scene = emptyScene();
  BodyDef floor = ground();
  floor.position = {0, 0, -8};
  floor.orientation = random.rotationUpTo(.3);
  scene.bodies.push_back(floor);
  for (int i = 0; i < 300; ++i) {
    const bool mesh = random.below(10) == 0;
    const Vec3 position = random.vector(10);
    BodyDef def = body(mesh ? randomMesh(random, 2) : randomSolid(random, 3), position);
    def.orientation = random.rotation();
    def.motion = mesh || random.below(2) ? Motion::Static : Motion::Dynamic;
    def.filter.layers = 1u << random.below(3);
    def.sensor = random.below(10) == 0;
    scene.bodies.push_back(def);
  }
  return scene;
}

inline QueryFilter randomFilter(Random& random) {
  QueryFilter f;
  f.mask = random.below(2) ? 0xffffffffu : 1u << random.below(3);
  f.sensors = random.below(2);
  return f;
}

/// Queries of all kinds about a random scene.
struct RandomQueries {
  RandomQueries(std::uint64_t seed, int count) {
    Random random(seed);
    for (int i = 0; i < count; ++i) {
      rays.push_back({random.vector(12), random.direction(), random.uniform(1, 30), randomFilter(random)});
      casts.push_back({randomSolid(random, 1), random.vector(12), random.rotation(), random.vector(10),
                       randomFilter(random)});
      shapes.push_back({randomSolid(random, 3), random.vector(10), random.rotation(), randomFilter(random)});
      points.push_back({random.vector(12), random.uniform(.1, 8), randomFilter(random)});
    }
  }
  std::vector<RayQuery> rays;
  std::vector<CastQuery> casts;
  std::vector<OverlapQuery> shapes;
  std::vector<ClosestQuery> points;
};

}  // namespace rubble::test

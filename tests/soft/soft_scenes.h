#pragma once
/// Small deformable objects for tests. z is up and gravity is 10.
#include <algorithm>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble::test {

inline TetSolidDef jellyBox(const Vec3& corner, double size, int cells, double stiffness = 1e5) {
  TetSolidDef box = tetBox(corner, {size, size, size}, {cells, cells, cells});
  box.youngsModulus = stiffness;
  return box;
}

inline TetSolidDef clampedBeam(int along, int across, double stiffness) {
  TetSolidDef beam = tetBox({0, 0, 0}, {1, .1, .1}, {along, across, across});
  beam.youngsModulus = stiffness;
  beam.poissonRatio = .3;
  for (std::size_t i = 0; i < beam.vertices.size(); ++i)
    if (beam.vertices[i].x == 0) beam.fixed.push_back(static_cast<int>(i));
  return beam;
}

inline Scene sceneWith(const Deformable& object, const Vec3& gravity = {0, 0, -10}) {
  Scene scene = emptyScene(gravity);
  scene.deformables.push_back(object);
  return scene;
}

/// Puts all vertices at random places within 1 m of the origin in each axis, at rest.
inline void throwApart(World& world, DeformableId id, unsigned seed) {
  std::vector<Vec3> x = world.positions(id);
  Random random(seed);
  for (Vec3& a : x) a = random.vector(1);
  world.setVertices(id, x, std::vector<Vec3>(x.size()));
}

struct Momentum {
  Vec3 linear, angular, center;
  double mass = 0;
};
inline Momentum momentumOf(const World& world, DeformableId id) {
  Momentum p;
  const std::vector<Vec3> x = world.positions(id), v = world.velocities(id);
  const std::vector<double> m = world.masses(id);
  for (std::size_t i = 0; i < x.size(); ++i) {
    p.linear += m[i] * v[i];
    p.angular += m[i] * cross(x[i], v[i]);
    p.center += m[i] * x[i];
    p.mass += m[i];
  }
  p.center = p.center / p.mass;
  return p;
}

/// Cells whose volume is not within `share` of that at rest.
inline int crushed(const World& world, DeformableId id, double share) {
  const TetSolidDef& d = std::get<TetSolidDef>(world.definition(id));
  const std::vector<Vec3> now = world.positions(id);
  const auto volume = [](const std::vector<Vec3>& x, const std::array<int, 4>& t) {
    const Vec3& a = x[static_cast<std::size_t>(t[0])];
    return dot(x[static_cast<std::size_t>(t[1])] - a,
               cross(x[static_cast<std::size_t>(t[2])] - a, x[static_cast<std::size_t>(t[3])] - a));
  };
  return static_cast<int>(std::count_if(d.tetrahedra.begin(), d.tetrahedra.end(), [&](const auto& t) {
    const double ratio = volume(now, t) / volume(d.vertices, t);
    return !(std::fabs(ratio - 1) < share);
  }));
}

}  // namespace rubble::test

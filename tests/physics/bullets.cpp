#include "tests/physics/bullets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tests/support/random.h"

namespace rubble::test {
namespace {

/// A bullet whose longest side is about 2 r and whose thinnest one `thin` times that.
Shape bulletShape(Random& random, const std::string& kind, double r, double thin) {
  const double t = r * thin;
  if (kind == "plate") return Shape::box({r, r * random.uniform(.3, 1), t});
  if (kind == "rod") return Shape::box({t, t, r});
  if (kind == "sphere") return Shape::sphere(r);
  if (kind == "capsule") return Shape::capsule(t, r);
  if (kind == "coin") return Shape::cylinder(r, t);
  if (kind == "cone") return Shape::cone(t, r);
  if (kind == "hull") {
    std::vector<Vec3> points;
    for (int k = 0; k < 10; ++k) {
      const Vec3 d = random.direction();
      points.push_back(r * Vec3{d.x, d.y, thin * d.z});
    }
    return Shape::hull(points);
  }
  return Shape::compound({{Shape::box({r, t, t}), {}, {}}, {Shape::box({t, r, t}), {}, {}}});
}

Shape sheet(double half, int cells, bool twoSided) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      points.push_back({half * (2. * i / cells - 1), half * (2. * j / cells - 1), 0});
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i;
      triangles.push_back({a, a + 1, a + cells + 2});
      triangles.push_back({a, a + cells + 2, a + cells + 1});
    }
  return Shape::mesh(points, triangles, twoSided);
}

}  // namespace

Throw randomThrow(std::uint64_t seed) {
  static const std::array<std::string, 8> bullets = {"plate", "rod",  "sphere", "capsule",
                                                     "coin",  "cone", "hull",   "cross"};
  static const std::array<std::string, 8> plates = {"box",  "thin box",       "disc",    "hull",
                                                    "mesh", "two-sided mesh", "heights", "dynamic box"};
  Random random(seed * 104729 + 11);
  Throw out;
  out.bullet = bullets[static_cast<std::size_t>(random.below(8))];
  out.plate = plates[static_cast<std::size_t>(random.below(8))];
  const double r = random.logUniform(.005, .5), thin = random.logUniform(.01, .5);
  out.halfWidth = 40 * r;
  out.reach = 1.5 * r;
  out.speed = random.logUniform(10, 3000);
  BodyDef plate;
  plate.motion = out.plate == "dynamic box" ? Motion::Dynamic
                 : random.below(4) == 0     ? Motion::Kinematic
                                            : Motion::Static;
  const double w = out.halfWidth,
               half = r * (out.plate == "thin box" ? random.logUniform(.01, .1) : random.logUniform(.1, 1));
  plate.position = {0, 0, -half};
  if (out.plate == "disc")
    plate.shape = Shape::cylinder(w, half);
  else if (out.plate == "hull") {
    std::vector<Vec3> corners;
    for (int k = 0; k < 8; ++k)
      corners.push_back({(k & 1) ? w : -w, (k & 2) ? w : -w, (k & 4) ? half : -half});
    plate.shape = Shape::hull(corners);
  } else if (out.plate == "mesh" || out.plate == "two-sided mesh") {
    plate.shape = sheet(w, 1 + random.below(30), out.plate != "mesh");
    plate.position = {};
  } else if (out.plate == "heights") {
    const int n = 2 + random.below(30);
    plate.shape = Shape::heightField(n, n, {2 * w / (n - 1), 2 * w / (n - 1), 0},
                                     std::vector<double>(std::size_t(n) * std::size_t(n), 0));
    plate.position = {-w, -w, 0};
  } else {
    plate.shape = Shape::box({w, w, half});
  }
  plate.density = 8000 * random.logUniform(.1, 10);
  BodyDef bullet;
  bullet.shape = bulletShape(random, out.bullet, r, thin);
  bullet.density = 8000;
  bullet.orientation = random.rotation();
  out.dt = std::array{1. / 30, 1. / 60, 1. / 240}[static_cast<std::size_t>(random.below(3))];
  out.iterations = random.below(2) == 0 ? 4 : 10;
  // a spin of up to 1.5 rad per step, and a way of half a step to one and a half to the plate
  bullet.angularVelocity = random.uniform(0, 1.5) / out.dt * random.direction();
  const Vec3 d = normalize(Vec3{random.uniform(-.7, .7), random.uniform(-.7, .7), -1});
  bullet.velocity = out.speed * d;
  const double distance = 2 * r + random.uniform(0, 1.5) * std::min(out.speed * out.dt, 10 * w);
  bullet.position = (-distance) * d + Vec3{0, 0, .5 * r};
  bullet.material.restitution = random.below(3) == 0 ? random.uniform(0, .8) : 0;
  out.scene.gravity = {0, 0, 0};
  out.scene.bodies = {plate, bullet};
  return out;
}

ThrowOutcome take(const Throw& shot, const std::string& backend) {
  WorldOptions options;
  options.backend = backend;
  options.threads = 1;
  options.timings = false;
  options.params.dt = shot.dt;
  options.params.iterations = shot.iterations;
  World world(shot.scene, options);
  const double start = world.quality().kineticEnergy;
  const BodyId plate = world.bodyAt(0), bullet = world.bodyAt(1);
  const Vec3 center = world.massOf(bullet).center;
  ThrowOutcome out;
  for (int i = 0; i < 24; ++i) {
    world.step();
    out.gain = std::max(out.gain, world.quality().kineticEnergy / start - 1);
    const BodyState p = world.state(plate), b = world.state(bullet);
    const Vec3 at = rotateInverse(p.orientation, b.position + rotate(b.orientation, center) - p.position);
    const Vec3 middle = shot.plate == "heights" ? Vec3{shot.halfWidth, shot.halfWidth, 0} : Vec3{};
    const bool beside = std::fabs(at.x - middle.x) > shot.halfWidth - shot.reach ||
                        std::fabs(at.y - middle.y) > shot.halfWidth - shot.reach;
    if (beside) break;
    if (at.z < 0) {
      out.passed = true;
      break;
    }
  }
  return out;
}

}  // namespace rubble::test

/// Bullets against plates: what goes further in a step than it is thick.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "motion_probes.h"
#include "probe_parts.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfPlate{.5, .5, .005};
constexpr double kHalfBullet = .005;  // [m]
constexpr double kAway = 11.7;        // of the bullet at the start [m]

Scene build(const Arguments& arguments) {
  const double angle = value(arguments, "angle") * std::numbers::pi / 180;
  const Vec3 direction{portable::sin(angle), 0, -portable::cos(angle)};
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef plate = block(kHalfPlate, {}, 7800);
  plate.name = "plate";
  scene.bodies.push_back(plate);
  BodyDef bullet = block({kHalfBullet, kHalfBullet, kHalfBullet}, -kAway * direction, 11340);
  bullet.name = "bullet";
  if (whole(arguments, "box") == 0) bullet.shape = Shape::sphere(kHalfBullet);
  bullet.orientation = fromAxisAngle(normalize(Vec3{1, 2, 3}), .7);
  bullet.velocity = value(arguments, "speed") * direction;
  scene.bodies.push_back(bullet);
  return scene;
}

/// height_min_m: least height of the bullet's center over the middle of the plate, while it is over the
/// plate.
class OverPlate final : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    const BodyState plate = world.state(world.findBody("plate")),
                    bullet = world.state(world.findBody("bullet"));
    const Vec3 x = rotateInverse(plate.orientation, bullet.position - plate.position);
    if (std::fabs(x.x) < kHalfPlate.x && std::fabs(x.y) < kHalfPlate.y) least_ = std::min(least_, x.z);
  }
  void finish(const World& world, Metrics& metrics) override {
    metrics["height_min_m"] = least_;
    metrics["through_m_s"] = world.state(world.findBody("plate")).velocity.z -
                             world.state(world.findBody("bullet")).velocity.z;
  }

 private:
  double least_ = kAway;
};

Probes probes(const Arguments&, const Scene&) {
  Probes result;
  result.push_back(std::make_unique<OverPlate>());
  result.push_back(impactProbe("bullet", "plate"));
  return result;
}

std::vector<Claim> claims(const Arguments& arguments) {
  return {atLeast("height_min_m", .003, "the bullet stays on its side of the plate"),
          atMost("through_m_s", .005 * value(arguments, "speed"), "and does not go on into it"),
          atMost("momentum_error", .04, "what the bullet loses the plate has")};
}

}  // namespace

std::vector<Spec> fastSpecs() {
  Spec spec;
  spec.name = "bullet-plate";
  spec.doc = "A bullet of 1 cm flies at a free steel plate of 1 cm: 17 m per step.";
  spec.arguments = {quantity("speed", 1000, 10, 2000, "m/s", "of the bullet"),
                    quantity("angle", 30, 0, 80, "deg", "to the normal of the plate"),
                    flag("box", false, "1: the bullet is a cube")};
  spec.build = build;
  spec.probes = probes;
  spec.claims = claims;
  spec.camera = overview;
  spec.steps = 90;
  spec.tags = {"fast"};
  return {
      spec,
      variant(spec, "bullet-plate-cube", "The same with a cube, straight on.", {{"box", 1}, {"angle", 0}}),
      variant(spec, "bullet-plate-slow", "A bullet of 50 m/s grazes a plate.",
              {{"speed", 50}, {"angle", 80}})};
}

}  // namespace rubble::scenes

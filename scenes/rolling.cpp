/// Rolling without slip, with closed forms: balls, capsules and wheels on the level and on a slope of 20
/// degrees, up to half a radian per step.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kFrom = 2;  ///< measured from then on [s]
constexpr std::array kRadii{.05, .2, 1.};
constexpr std::array kTurns{.05, .2, .5};  ///< of a roller on the level in a step of 1/60 s [rad]

Shape shapeOf(int kind, double r) {
  if (kind == 0) return Shape::sphere(r);
  if (kind == 1) return Shape::cylinder(r, .4 * r);
  return Shape::capsule(r, r);
}

/// Rollers have a name, a radius and a slope [rad]; those on the level begin to roll with their speed.
Scene buildRolling(const Arguments& arguments) {
  const double slope = value(arguments, "slope") * std::numbers::pi / 180;
  Scene scene = emptyScene(kUpZ, kG);
  for (const bool steep : {false, true}) {
    const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, steep ? slope : 0);
    const Vec3 origin{0, steep ? 1000. : 0., 0};
    put(scene, held(box({1500, 100, 1}, origin - rotate(tilt, {0, 0, 1}), 1)), steep ? "slope" : "level");
    scene.bodies.back().orientation = tilt;
    for (int kind = 0; kind < 3; ++kind)
      for (std::size_t size = 0; size < kRadii.size(); ++size)
        for (std::size_t k = 0; k < (steep ? 1 : kTurns.size()); ++k) {
          const double r = kRadii[size], spin = steep ? 0 : kTurns[k] * 60;
          BodyDef body = box({}, origin + rotate(tilt, {0, 5. * (kind * 9 + int(size) * 3 + int(k)) - 60, r}),
                             1);
          body.shape = shapeOf(kind, r);
          body.orientation = tilt * fromAxisAngle(Vec3{1, 0, 0}, std::numbers::pi / 2);
          body.velocity = {spin * r, 0, 0};
          body.angularVelocity = {0, spin, 0};
          put(scene, body,
              std::string(steep ? "down_" : "along_") + std::to_string(kind) + std::to_string(size) +
                  std::to_string(k));
        }
  }
  setFriction(scene, 1);
  return scene;
}

/// roll_error: largest |omega r / v - 1|; speed_error: largest change of the speed on the level;
/// acceleration_error: on the slope against g sin(slope) / (1 + I / (m r^2)).
Probes rollingProbes(const Arguments& arguments, const Scene&) {
  const double slope = value(arguments, "slope") * std::numbers::pi / 180;
  Probes probes;
  probes.push_back(everyStep([slope](const World& world, const StepReport&, Metrics& metrics) {
    if (world.time() < kFrom) return;
    for (const BodyId id : world.bodies()) {
      const BodyDef& body = world.definition(id);
      if (body.motion != Motion::Dynamic) continue;
      const BodyState s = world.state(id);
      const double r = body.shape.radius, v = length(s.velocity);
      // farther down they would rotate by more than 2 rad per step
      if (length(s.angularVelocity) * world.params().dt > .55) continue;
      raise(metrics, "roll_error", std::fabs(length(s.angularVelocity) * r / v - 1));
      if (body.name[0] == 'a') {
        raise(metrics, "speed_error", std::fabs(v / length(body.velocity) - 1));
      } else {
        const double moment = world.massOf(id).inertia.z / (world.massOf(id).mass * r * r);
        raise(metrics, "acceleration_error",
              std::fabs(v / world.time() / (kG * portable::sin(slope) / (1 + moment)) - 1));
      }
    }
  }));
  return probes;
}

}  // namespace

std::vector<Spec> rollingSpecs() {
  Spec spec;
  spec.name = "rolling";
  spec.doc =
      "Balls, wheels and capsules that roll on the level by up to half a radian per step, and down a slope "
      "of "
      "20 degrees.";
  spec.arguments = {quantity("slope", 20, 1, 30, "deg", "of the steep ground")};
  spec.build = buildRolling;
  spec.probes = rollingProbes;
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        atMost("roll_error", .002, "they roll without slip"),
        atMost("speed_error", .005, "and keep their speed on the level"),
        atMost("acceleration_error", .01, "down the slope as the closed form says, within 1 %")};
  };
  spec.camera = overview;
  spec.steps = 240;
  spec.iterations = 4;
  spec.tags = {"friction"};
  return {spec};
}

}  // namespace rubble::scenes

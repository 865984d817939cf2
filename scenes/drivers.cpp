/// Scenes with somebody at the controls: a character on a course, a vehicle on hills.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "character.h"
#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"
#include "vehicle.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kDegree = std::numbers::pi / 180;
constexpr Vec3 kZ{0, 0, 1};

/// Course of the character, along x: stairs to a deck, a ramp down, a wall to walk around, a crate to push.
constexpr double kStep = .25, kTread = .5, kStairs = 5, kDeck = 6.5, kRampStart = 9, kRampEnd = 12.5,
                 kWalkSpeed = 2, kEnd = 17;
Scene buildCharacter(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ));
  const auto block = [&](const Vec3& low, const Vec3& high, const std::string& name) {
    return put(scene, held(box((high - low) / 2, (low + high) / 2, 1)), name);
  };
  for (int k = 0; k < int(kStairs); ++k)
    block({4 + kTread * k, -1.5, 0}, {kDeck, 1.5, kStep * (k + 1)}, "step" + std::to_string(k));
  const double height = kStep * kStairs;
  block({kDeck, -1.5, 0}, {kRampStart, 1.5, height}, "deck");
  const double slope = portable::atan2(height, kRampEnd - kRampStart),
               slant = portable::hypot(height, kRampEnd - kRampStart);
  BodyDef ramp = held(box({slant / 2, 1.5, .1}, {}, 1));
  ramp.orientation = fromAxisAngle(Vec3{0, 1, 0}, slope);
  ramp.position = Vec3{(kRampStart + kRampEnd) / 2, 0, height / 2} - rotate(ramp.orientation, kZ * .1);
  put(scene, ramp, "ramp");
  block({14, -3, 0}, {14.4, .8, 1.5}, "wall");
  BodyDef crate = box({.3, .3, .3}, {15.6, .5, .3}, 20);
  crate.material = {.3, .3, 0};
  put(scene, crate, "crate");
  BodyDef person;
  person.motion = Motion::Kinematic;
  person.shape = Shape::capsule(.3, .6);
  person.position = {0, 0, .95};
  put(scene, person, "character");
  return scene;
}
Drive characterDriver(const Arguments&, const Scene&) {
  return [](World& world) {
    constexpr Vec3 kWay[] = {{3.2, .4, 0}, {5, 0, 0}, {13, 0, 0}, {14.2, 1.6, 0}, {kEnd, 0, 0}};
    const BodyId body = world.findBody("character");
    const Vec3 at = world.state(body).position;
    const auto* const next = std::ranges::find_if(kWay, [&](const Vec3& p) { return p.x > at.x + .2; });
    Vec3 walk;
    if (next != std::end(kWay)) walk = normalize(Vec3{next->x - at.x, next->y - at.y, 0}) * kWalkSpeed;
    const Character character(body);
    // a jump on the deck
    character.move(world, walk, std::fabs(at.x - kDeck - 1) < .05 ? 4 : 0);
  };
}
Probes characterProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const BodyState person = bodyOf(world, "character");
    const double feet = person.position.z - .9;
    raise(metrics, "jump_m", feet - kStep * kStairs);
    raise(metrics, "sunk_m", -feet);
    metrics["finish_error_m"] = std::fabs(person.position.x - kEnd);
    metrics["feet_m"] = feet;
    metrics["crate_pushed_m"] = length(bodyOf(world, "crate").position - Vec3{15.6, .5, .3});
  }));
  return probes;
}

/// A vehicle that follows a circle on hills.
constexpr int kSamples = 61;
constexpr double kSpacing = 2, kHalf = (kSamples - 1) * kSpacing / 2, kCircle = 35, kSpeed = 9, kMass = 1200;
double hill(double x, double y) { return 1.5 * portable::sin(x / 9) * portable::cos(y / 11); }
Scene buildVehicle(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  std::vector<double> heights;
  for (int j = 0; j < kSamples; ++j)
    for (int i = 0; i < kSamples; ++i) heights.push_back(hill(i * kSpacing - kHalf, j * kSpacing - kHalf));
  BodyDef land;
  land.motion = Motion::Static;
  land.shape = Shape::heightField(kSamples, kSamples, {kSpacing, kSpacing, 0}, heights);
  land.position = {-kHalf, -kHalf, 0};
  put(scene, land, "land");
  BodyDef chassis = box({2, .9, .3}, {kCircle, 0, hill(kCircle, 0) + 1.1}, kMass);
  chassis.orientation = fromAxisAngle(kZ, 90 * kDegree);
  put(scene, chassis, "chassis");
  for (int k = 0; k < 4; ++k) {
    BodyDef wheel;
    wheel.motion = Motion::Kinematic;
    wheel.shape = Shape::cylinder(.4, .14);
    wheel.position = chassis.position +
                     rotate(chassis.orientation, Vec3{k < 2 ? 1.4 : -1.4, k % 2 ? 1.06 : -1.06, -.5});
    wheel.orientation = chassis.orientation * fromAxisAngle(Vec3{1, 0, 0}, 90 * kDegree);
    wheel.filter.mask = 0;
    wheel.filter.layers = 0;
    put(scene, wheel, "wheel" + std::to_string(k));
  }
  return scene;
}
Drive vehicleDriver(const Arguments&, const Scene&) {
  return [](World& world) {
    const BodyId chassis = world.findBody("chassis");
    std::vector<WheelDef> wheels;
    std::vector<BodyId> shown;
    for (int k = 0; k < 4; ++k) {
      WheelDef& wheel = wheels.emplace_back();
      wheel.mount = {k < 2 ? 1.4 : -1.4, k % 2 ? 1.06 : -1.06, -.1};
      wheel.steers = k < 2, wheel.drives = true;
      shown.push_back(world.findBody("wheel" + std::to_string(k)));
    }
    const BodyState state = world.state(chassis);
    // towards a point of the circle ahead
    const double angle = portable::atan2(state.position.y, state.position.x) + 8 / kCircle;
    const Vec3 ahead = rotateInverse(
        state.orientation,
        Vec3{kCircle * portable::cos(angle), kCircle * portable::sin(angle), state.position.z} -
            state.position);
    const double speed = dot(state.velocity, rotate(state.orientation, Vec3{1, 0, 0}));
    Controls controls;
    controls.steering = std::clamp(portable::atan2(ahead.y, ahead.x), -.5, .5);
    controls.force = std::clamp(3000 * (kSpeed - speed), -4000., 4000.);
    RaycastVehicle(chassis, wheels, shown).drive(world, controls);
  };
}
Probes vehicleProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(
      everyStep([way = 0.](const World& world, const StepReport& report, Metrics& metrics) mutable {
        const BodyState chassis = bodyOf(world, "chassis");
        way += length(chassis.velocity) * world.params().dt;
        metrics["travel_m"] = way;
        raise(metrics, "tilt_peak_deg",
              portable::acos(std::min(1.0, rotate(chassis.orientation, kZ).z)) / kDegree);
        if (world.time() > 3)
          raise(metrics, "off_track_m",
                std::fabs(portable::hypot(chassis.position.x, chassis.position.y) - kCircle));
        raise(metrics, "chassis_contacts", report.contacts);
        metrics["speed_ratio"] = length(chassis.velocity) / kSpeed;
      }));
  return probes;
}

Spec drivenSpec(Spec spec, std::function<Drive(const Arguments&, const Scene&)> driver) {
  spec.driver = std::move(driver);
  return spec;
}

}  // namespace

std::vector<Spec> driverSpecs() {
  return {
      drivenSpec(jointSpec("character",
                           "A character controller over the API: it climbs stairs, jumps, walks "
                           "down a ramp and around a wall.",
                           buildCharacter, characterProbes,
                           {atMost("finish_error_m", .3, "it gets to the end of the course"),
                            within("feet_m", 0, .05, "and stands on the ground there"),
                            within("jump_m", .5, .9, "its jump follows v^2 / 2 g"),
                            atMost("sunk_m", 1e-3, "it is never below the ground"),
                            atLeast("crate_pushed_m", .1, "the crate gives way")},
                           660),
                 characterDriver),
      drivenSpec(jointSpec("vehicle",
                           "A vehicle over the API whose wheels are rays, on the hills of a height field.",
                           buildVehicle, vehicleProbes,
                           {atLeast("travel_m", 60, "it gets along"),
                            within("speed_ratio", .8, 1.2, "at the speed that it wants"),
                            atMost("off_track_m", 3, "on its circle"), atMost("tilt_peak_deg", 25, "upright"),
                            atMost("chassis_contacts", 0, "on its wheels alone")},
                           600),
                 vehicleDriver),
  };
}

}  // namespace rubble::scenes

/// Friction with closed forms: stopping distance, the threshold of a ramp, a sphere that starts to roll, a
/// floor that moves. Sources: avbd-demo3d, three-avbd (z up, g 10).
#include "friction_probes.h"

#include <array>
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "motion_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

BodyDef slab(const Vec3& halfExtents, const Vec3& position, double friction) {
  BodyDef body = block(halfExtents, position, 1);
  body.name = "ground";
  body.motion = Motion::Static;
  body.material = {friction, friction, 0};
  return body;
}

// Ladder: boxes with friction 5, 4.5, ... 0 on a slab of 0.5.

constexpr int kLadderBoxes = 11;
constexpr double kLadderSlab = .5;
double ladderFriction(int i) { return 5 - .5 * i; }

Scene buildLadder(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(slab({50, 50, .5}, {}, kLadderSlab));
  for (int i = 0; i < kLadderBoxes; ++i) {
    BodyDef box = block({.5, .5, .25}, {0, -30 + 2.0 * i, .75}, value(arguments, "density"));
    box.name = "box" + std::to_string(i);
    box.material = {ladderFriction(i), ladderFriction(i), 0};
    box.velocity = {value(arguments, "speed"), 0, 0};
    scene.bodies.push_back(box);
  }
  return scene;
}

Probes ladderProbes(const Arguments&, const Scene& scene) {
  std::vector<Slider> sliders;
  for (int i = 0; i < kLadderBoxes; ++i)
    if (ladderFriction(i) > 0)
      sliders.push_back({"box" + std::to_string(i), std::sqrt(kLadderSlab * ladderFriction(i))});
  Probes probes;
  probes.push_back(stopProbe(scene, sliders));
  probes.push_back(travelProbe("box" + std::to_string(kLadderBoxes - 1), {1, 0, 0}));
  return probes;
}

std::vector<Claim> ladderClaims(const Arguments&) {
  return {atMost("stop_distance_error", .03, "friction up to 1: the way to rest within 3 %"),
          atMost("stop_distance_error_high", .05, "friction above 1: within 5 %"),
          atLeast("travel_m", 50, "the box without friction leaves the slab")};
}

// Ramp: boxes with friction around the tangent of its angle.

constexpr std::array kRampRatios{.9, .95, .98, .99, 1.01, 1.02, 1.05, 1.1};
constexpr Vec3 kRampHalf{20, 12, .5};
constexpr double kRampStart = -18;  // along the ramp, from its middle [m]

Scene buildRamp(const Arguments& arguments) {
  const double angle = value(arguments, "angle") * std::numbers::pi / 180;
  const double mu = value(arguments, "mu");
  const Quat tilt = fromAxisAngle(Vec3{0, 1, 0}, angle);
  const Vec3 middle{0, 0, kRampHalf.x * portable::sin(angle) + 1};
  Scene scene = emptyScene(kUpZ, 10);
  BodyDef ramp = slab(kRampHalf, middle, mu);
  ramp.orientation = tilt;
  scene.bodies.push_back(ramp);
  for (std::size_t i = 0; i < kRampRatios.size(); ++i) {
    const double pair = kRampRatios[i] * portable::tan(angle);
    const double own = pair * pair / mu;
    BodyDef box = block({.5, .5, .5},
                        middle + rotate(tilt, {kRampStart, 2.0 * double(i) - double(kRampRatios.size() - 1),
                                               kRampHalf.z + .5}),
                        1);
    box.name = "box" + std::to_string(i);
    box.orientation = tilt;
    box.material = {own, own, 0};
    scene.bodies.push_back(box);
  }
  return scene;
}

Probes rampProbes(const Arguments&, const Scene&) {
  std::vector<RampBox> boxes;
  for (std::size_t i = 0; i < kRampRatios.size(); ++i)
    boxes.push_back({"box" + std::to_string(i), kRampRatios[i]});
  Probes probes;
  probes.push_back(rampProbe(boxes, .1, 5));
  return probes;
}

std::vector<Claim> rampClaims(const Arguments&) {
  return {atMost("slides_wrong", 0, "a box slides if, and only if, its friction is below tan(angle), to 1 %"),
          atMost("creep_max_m", .001, "a box that holds moves less than 1 mm in the last 5 s")};
}

// Sphere.

constexpr double kSphereRadius = .5;

Scene buildSphere(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef sphere;
  sphere.name = "sphere";
  sphere.shape = Shape::sphere(kSphereRadius);
  sphere.density = 1;
  sphere.position = {0, 0, kSphereRadius};
  sphere.velocity = {value(arguments, "speed"), 0, 0};
  scene.bodies.push_back(sphere);
  setFriction(scene, value(arguments, "mu"));
  return scene;
}

Probes sphereProbes(const Arguments& arguments, const Scene& scene) {
  const double speed = value(arguments, "speed");
  Probes probes;
  probes.push_back(speedProbe("sphere", {1, 0, 0}, speed));
  probes.push_back(slipProbe(scene, "sphere", speed));
  return probes;
}

std::vector<Claim> sphereClaims(const Arguments&) {
  return {within("final_speed_ratio", .98 * 5 / 7, 1.02 * 5 / 7, "5/7 of the first speed, within 2 %"),
          atMost("final_slip_ratio", .01, "it rolls without slipping")};
}

// Moving floor.

Scene buildFloor(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  BodyDef floor = slab({20, 2, .5}, {0, 0, -.5}, .6);
  floor.name = "floor";
  floor.motion = Motion::Kinematic;
  floor.velocity = {value(arguments, "speed"), 0, 0};
  scene.bodies.push_back(floor);
  BodyDef box = block({.5, .5, .5}, {0, 0, .5}, 1);
  box.name = "box";
  scene.bodies.push_back(box);
  return scene;
}

Probes floorProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  probes.push_back(speedProbe("box", {1, 0, 0}, value(arguments, "speed")));
  return probes;
}

std::vector<Claim> floorClaims(const Arguments&) {
  return {within("final_speed_ratio", .99, 1.01, "the box takes the floor's speed, within 1 %")};
}

}  // namespace

std::vector<Spec> frictionSpecs() {
  Spec ladder;
  ladder.name = "friction-ladder";
  ladder.doc = "Eleven boxes with friction from 5 down to 0 slide to rest on a slab of 0.5 (avbd-demo3d).";
  ladder.arguments = {quantity("speed", 10, .5, 12, "m/s", "speed at the start"),
                      quantity("density", 1, 1e-3, 1e7, "kg/m3", "density of the boxes")};
  ladder.build = buildLadder;
  ladder.probes = ladderProbes;
  ladder.claims = ladderClaims;
  ladder.camera = overview;
  ladder.steps = 600;
  ladder.iterations = 10;
  ladder.tags = {"friction"};

  Spec ramp = ladder;
  ramp.name = "friction-ramp";
  ramp.doc = "Boxes on a ramp whose friction is a few per cent above or below the tangent of its angle.";
  ramp.arguments = {
      quantity("angle", 30, 5, 40, "deg", "slope of the ramp"),
      quantity("mu", 1, .05, 10, "1",
               "friction of the ramp; each box gets the one that makes the pair's what it should be")};
  ramp.build = buildRamp;
  ramp.probes = rampProbes;
  ramp.claims = rampClaims;

  Spec sphere = ladder;
  sphere.name = "sliding-sphere";
  sphere.doc = "A sphere that slides at first ends up rolling at 5/7 of its speed (three-avbd).";
  sphere.arguments = {quantity("speed", 3, .1, 20, "m/s", "speed at the start"),
                      quantity("mu", .5, .05, 2, "1", "friction")};
  sphere.build = buildSphere;
  sphere.probes = sphereProbes;
  sphere.claims = sphereClaims;
  sphere.steps = 300;

  Spec floor = ladder;
  floor.name = "moving-floor";
  floor.doc = "A kinematic floor carries a box along: its motion is in the contact rows.";
  floor.arguments = {quantity("speed", 1, -3, 3, "m/s", "speed of the floor")};
  floor.build = buildFloor;
  floor.probes = floorProbes;
  floor.claims = floorClaims;
  floor.steps = 180;

  return {ladder, ramp, sphere, floor};
}

}  // namespace rubble::scenes

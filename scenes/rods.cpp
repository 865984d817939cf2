/// Rods of oriented segments: torsion, and a coil spring, whose wire is twisted when it is pulled.
#include <cmath>
#include <numbers>

#include <rubble/rod.h>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

double shearModulus(const RodDef& rod) { return rod.youngsModulus / (2 * (1 + rod.poissonRatio)); }

// A rod that a motor twists.

constexpr double kRodLength = 1, kTorque = .02, kGravity = 10;  // [m], [N m], [m/s2]

RodDef twistedRod(const Arguments& arguments) {
  RodDef rod;
  const int pieces = whole(arguments, "segments");
  for (int i = 0; i <= pieces; ++i) rod.points.push_back({kRodLength * i / pieces, 0, 0});
  rod.name = "rod";
  rod.radius = .02;
  rod.youngsModulus = value(arguments, "youngs_modulus");
  rod.viscosity = .01 * rod.youngsModulus;
  rod.start = kWorld;
  rod.end = 0;
  return rod;
}

Scene buildTwist(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef hub = block({.02, .04, .02}, {kRodLength + .02, 0, 0}, 1000);
  hub.name = "hub";
  hub.mass = 1;
  scene.bodies.push_back(hub);
  // with the speed that its torque allows
  JointDef motor = jointAt(scene, JointType::Hinge, 0, kWorld, hub.position, frameAlong({1, 0, 0}));
  motor.axes[0].targetSpeed = 1e3;
  motor.axes[0].driveDamping = kHard;
  motor.axes[0].maxDriveForce = kTorque;
  scene.joints.push_back(motor);
  addRod(scene, twistedRod(arguments));
  return scene;
}

/// How far a body has turned about x since the beginning [rad].
double turnAboutX(const World& world, const BodyDef& start) {
  const Quat q = world.state(world.findBody(start.name)).orientation * conjugate(start.orientation);
  return 2 * portable::atan2(q.s < 0 ? -q.v.x : q.v.x, std::fabs(q.s));
}

Spec twistSpec() {
  Spec spec;
  spec.name = "rod-twist";
  spec.doc =
      "A motor twists a rod of oriented segments that is built in at the other end: torque = G J theta / L.";
  spec.arguments = {
      count("segments", 10, 2, 100, "pieces of the rod; beyond 12 it winds itself up at 4 iterations"),
      quantity("youngs_modulus", 4e5, 2e5, 1e9, "Pa", "of the rod")};
  spec.build = buildTwist;
  spec.probes = [](const Arguments& arguments, const Scene& scene) {
    const RodDef rod = twistedRod(arguments);
    const double wanted = kTorque * kRodLength /
                          (shearModulus(rod) * std::numbers::pi * portable::pow(rod.radius, 4) / 2);
    const int pieces = whole(arguments, "segments");
    const BodyDef hub = scene.bodies[0], middle = scene.bodies[1 + static_cast<std::size_t>(pieces / 2)];
    const double share = (pieces / 2 + .5) / pieces;
    Probes probes;
    probes.push_back(endProbe(
        {{"angle_ratio", [=](const World& w) { return turnAboutX(w, hub) / wanted; }},
         {"middle_ratio", [=](const World& w) { return turnAboutX(w, middle) / (share * wanted); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{within("angle_ratio", .98, 1.02, "theta = torque L / (G J)"),
                              within("middle_ratio", .98, 1.02, "the twist grows evenly along the rod"),
                              atMost("kinetic_energy_j", 1e-6, "it comes to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.3, -1.1, .6}, {.55, 0, 0}}; };
  spec.steps = 600;
  spec.tags = {"rod", "joint"};
  return spec;
}

// A coil spring.

constexpr double kCoilRadius = .05, kPitch = .02, kWeight = 10;  // [m], [N]

RodDef coil(const Arguments& arguments) {
  RodDef rod;
  const int turns = whole(arguments, "turns"), around = whole(arguments, "segments");
  for (int i = 0; i <= turns * around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around;
    rod.points.push_back(
        {kCoilRadius * portable::cos(angle), kCoilRadius * portable::sin(angle), -kPitch * i / around});
  }
  rod.name = "wire";
  rod.radius = .005;
  rod.youngsModulus = 2e9;
  rod.density = 100;
  rod.viscosity = 2e7;
  return rod;
}

Scene buildCoil(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kGravity);
  RodDef rod = coil(arguments);
  BodyDef load;
  load.name = "load";
  load.shape = Shape::cylinder(.06, .02);
  load.mass = kWeight / kGravity;
  load.position = {0, 0, rod.points.back().z - .03};
  load.lockRotation = {true, true, true};
  load.lockTranslation = {true, true, false};
  // the last turn lies against it
  load.filter.mask = 0;
  scene.bodies.push_back(load);
  rod.start = kWorld;
  rod.end = 0;
  const RodParts made = addRod(scene, rod);
  for (int i = 0; i < made.bodies; ++i) {
    scene.bodies[static_cast<std::size_t>(made.firstBody + i)].gravityScale = 0;
    scene.bodies[static_cast<std::size_t>(made.firstBody + i)].filter.group = -1;
  }
  return scene;
}

Spec coilSpec() {
  Spec spec;
  spec.name = "coil-spring";
  spec.doc = "A weight on a coil spring of oriented segments: its wire is twisted, k = G d^4 / (8 D^3 n).";
  spec.arguments = {count("turns", 6, 1, 100, "turns n"), count("segments", 20, 6, 200, "pieces of a turn")};
  spec.build = buildCoil;
  spec.probes = [](const Arguments& arguments, const Scene& scene) {
    const RodDef rod = coil(arguments);
    const double stiffness = shearModulus(rod) * portable::pow(2 * rod.radius, 4) /
                             (8 * portable::pow(2 * kCoilRadius, 3) * whole(arguments, "turns"));
    const double start = scene.bodies[0].position.z, wanted = kWeight / stiffness;
    Probes probes;
    probes.push_back(endProbe({{"length_ratio", [=](const World& w) {
                                  return (start - w.state(w.findBody("load")).position.z) / wanted;
                                }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("length_ratio", .95, 1.05, "as long as the formula of coil springs says"),
        atMost("kinetic_energy_j", 1e-3, "it comes to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.35, -.5, .02}, {0, 0, -.1}}; };
  spec.steps = 600;
  spec.testArguments = {{"turns", 3}};
  spec.tags = {"rod", "joint"};
  return spec;
}

}  // namespace

std::vector<Spec> rodSpecs() { return {twistSpec(), coilSpec()}; }

}  // namespace rubble::scenes

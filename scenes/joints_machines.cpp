/// Machines: several joints that must agree, against closed forms.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kDegree = std::numbers::pi / 180;
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

// Crank of 0.5 m, rod of 1.5 m, piston on a slider along x.
constexpr double kCrank = .5, kRod = 1.5, kCrankSpeed = 4;
Scene buildCrank(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int crank = put(scene, box({kCrank / 2, .05, .05}, {kCrank / 2, 0, 0}, 2), "crank");
  const int rod = put(scene, box({kRod / 2, .05, .05}, {kCrank + kRod / 2, .12, 0}, 3), "rod");
  const int piston = put(scene, box({.2, .05, .2}, {kCrank + kRod, .24, 0}, 4), "piston");
  join(scene, JointType::Hinge, crank, kWorld, {}, kY, "drive").axes[0] = motor(kCrankSpeed);
  join(scene, JointType::Hinge, rod, crank, {kCrank, .06, 0}, kY, "big end");
  join(scene, JointType::Hinge, piston, rod, {kCrank + kRod, .18, 0}, kY, "small end");
  join(scene, JointType::Slider, piston, kWorld, {kCrank + kRod, .24, 0}, kX, "cylinder");
  return scene;
}
Probes crankProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const double angle = jointOf(world, "drive").axes[0].position, side = kCrank * portable::sin(angle);
    const double x = kCrank * portable::cos(angle) + std::sqrt(kRod * kRod - side * side) - kCrank - kRod;
    raise(metrics, "piston_error_m", std::fabs(jointOf(world, "cylinder").axes[0].position - x));
    raise(metrics, "crank_error_rad", std::fabs(angle - kCrankSpeed * world.time()));
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// A motor drives three wheels, 2 : 1 and 3 : 1; the last one is braked.
constexpr double kBrake = 30, kGearSpeed = 12;
constexpr double kRatios[2] = {2, 3};
Scene buildGears(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const double radii[3] = {.25, .5, 1.5};
  double x = 0;
  int wheels[3];
  for (int i = 0; i < 3; ++i) {
    if (i > 0) x += radii[i - 1] + radii[i];
    const double r = radii[i] * .7;
    wheels[i] = put(scene, box({r, .1, r}, {x, i * .3, 0}, 10 * radii[i]), "wheel" + std::to_string(i));
    join(scene, JointType::Hinge, wheels[i], kWorld, {x, i * .3, 0}, kY, "axle" + std::to_string(i));
  }
  scene.joints[0].axes[0] = motor(kGearSpeed, 40);
  scene.joints[2].axes[0].friction = kBrake;
  for (int i = 0; i < 2; ++i) {
    JointDef& gear = join(scene, JointType::Gear, wheels[i], wheels[i + 1], {}, kY,
                          "gear" + std::to_string(i));
    gear.ratio = kRatios[i];
  }
  return scene;
}
Probes gearProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    double angles[3];
    for (int i = 0; i < 3; ++i) angles[i] = jointOf(world, "axle" + std::to_string(i)).axes[0].position;
    for (int i = 0; i < 2; ++i)
      raise(metrics, "tooth_error_rad", std::fabs(angles[i] + kRatios[i] * angles[i + 1]));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const JointAxisState drive = jointOf(world, "axle0").axes[0], load = jointOf(world, "axle2").axes[0];
    metrics["speed_ratio"] = load.speed * 6 / kGearSpeed;
    metrics["tooth_error_end_rad"] = std::fabs(drive.position - 6 * load.position);
    metrics["torque_ratio"] = drive.driveForce * 6 / kBrake;
    metrics["turns"] = drive.position / (2 * std::numbers::pi);
  }));
  return probes;
}

/// A weight on a rack falls and spins its pinion: a = g m r^2 / (I + m r^2).
constexpr double kPinion = .2, kPinionMass = 8, kWeight = 5;
Scene buildRack(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int pinion = put(scene, ball(kPinion, {0, 0, 0}, kPinionMass), "pinion");
  const int rack = put(scene, box({.05, .05, 1}, {kPinion + .05, 0, 0}, kWeight), "rack");
  join(scene, JointType::Hinge, pinion, kWorld, {}, kY, "axle");
  JointDef& slide = join(scene, JointType::Slider, rack, kWorld, {kPinion + .05, 0, 0}, kZ, "guide");
  slide.collide = false;
  JointDef mesh = jointAt(scene, JointType::Rack, pinion, rack, {kPinion, 0, 0}, frameAlong(kY));
  mesh.name = "rack";
  // B travels along x of its frame; a turn about y by +1 rad takes a point at +x down
  mesh.frameB = frameAlong(-kZ);
  mesh.anchorA = {};
  mesh.anchorB = {};
  mesh.ratio = kPinion;
  scene.joints.push_back(mesh);
  return scene;
}
Probes rackProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const double way = -jointOf(world, "guide").axes[0].position,
                 angle = jointOf(world, "axle").axes[0].position;
    raise(metrics, "mesh_error_m", std::fabs(way - kPinion * angle));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const double moment = .4 * kPinionMass * kPinion * kPinion,
                 a = kG * kWeight * kPinion * kPinion / (moment + kWeight * kPinion * kPinion);
    const double h = world.params().dt / world.params().substeps, t = world.time();
    // implicit Euler: a t (t + h) / 2
    metrics["fall_ratio"] = -jointOf(world, "guide").axes[0].position / (a * t * (t + h) / 2);
  }));
  return probes;
}

constexpr double kLightMass = 1;
Scene buildAtwood(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const int a = put(scene, ball(.2, {-.5, 0, -6}, kLightMass), "light");
  const int b = put(scene, ball(.2, {.5, 0, -2}, kLightMass * value(arguments, "ratio")), "heavy");
  JointDef pulley = jointAt(scene, JointType::Pulley, a, b, {});
  pulley.name = "pulley";
  pulley.anchorA = pulley.anchorB = {};
  pulley.pulleyA = {-.5, 0, 0}, pulley.pulleyB = {.5, 0, 0};
  scene.joints.push_back(pulley);
  return scene;
}
Probes atwoodProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  const double r = value(arguments, "ratio");
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    raise(metrics, "stretch_peak", jointOf(world, "pulley").gap / 8);
  }));
  probes.push_back(atEnd([r](const World& world, Metrics& metrics) {
    const double a = kG * (r - 1) / (r + 1), h = world.params().dt / world.params().substeps,
                 t = world.time();
    metrics["fall_ratio"] = (-2 - bodyOf(world, "heavy").position.z) / (a * t * (t + h) / 2);
    metrics["tension_ratio"] = jointOf(world, "pulley").axes[0].limitForce /
                               (-2 * kLightMass * r * kG / (r + 1));
  }));
  return probes;
}

/// Two shafts at an angle: the second turns by tan a2 = tan a1 / cos b.
constexpr double kShaftSpeed = 3;
Scene buildUniversal(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const double bend = value(arguments, "bend") * kDegree;
  const Vec3 along{portable::cos(bend), 0, portable::sin(bend)};
  const int a = put(scene, box({.5, .1, .1}, {-.5, 0, 0}, 2), "first");
  BodyDef second = box({.5, .1, .1}, .5 * along, 2);
  second.orientation = fromAxisAngle(kY, -bend);
  const int b = put(scene, second, "second");
  join(scene, JointType::Hinge, a, kWorld, {-1, 0, 0}, kX, "input").axes[0] = motor(kShaftSpeed);
  join(scene, JointType::Hinge, b, kWorld, along, along, "output");
  JointDef& cross = join(scene, JointType::Universal, a, b, {}, kX, "cross");
  // each body's own axes: x is its shaft, y of A and z of B carry the cross
  cross.frameA = cross.frameB = {};
  return scene;
}
Probes universalProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  const double cosine = portable::cos(value(arguments, "bend") * kDegree);
  probes.push_back(everyStep([cosine](const World& world, const StepReport&, Metrics& metrics) {
    const double in = jointOf(world, "input").axes[0].position,
                 out = jointOf(world, "output").axes[0].position;
    // y of A leaves the plane of the bend's normal: there tan out = tan in cos b
    const double wanted = portable::atan2(portable::sin(in) * cosine, portable::cos(in));
    raise(metrics, "angle_error_rad", std::fabs(std::remainder(out - wanted, 2 * std::numbers::pi)));
    const double speed = jointOf(world, "output").axes[0].speed / kShaftSpeed;
    raise(metrics, "speed_ratio_high", speed);
    if (world.time() > .1) raise(metrics, "speed_ratio_low_inverse", 1 / speed);
  }));
  probes.push_back(jointErrorProbe(.1));
  return probes;
}
std::vector<Claim> universalClaims(const Arguments& arguments) {
  const double high = 1 / portable::cos(value(arguments, "bend") * kDegree);
  return {atMost("angle_error_rad", .02, "tan a2 = tan a1 cos b, from the plane of the bend"),
          within("speed_ratio_high", .98 * high, 1.02 * high, "fastest 1 / cos b"),
          within("speed_ratio_low_inverse", .98 * high, 1.02 * high, "slowest cos b"),
          atMost("quarantined", 0, "every state stays finite")};
}

/// A platform on six springs of one joint: it slides to a limit, sinks on a spring, and turns as driven.
constexpr double kPlatformMass = 40, kPlatformSpring = 8000;
Scene buildPlatform(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int plate = put(scene, box({1, 1, .1}, {}, kPlatformMass), "plate");
  JointDef& joint = join(scene, JointType::SixDof, plate, kWorld, {}, kX, "platform");
  joint.axes[0].min = -.5, joint.axes[0].max = .5;
  joint.axes[0].targetSpeed = .4, joint.axes[0].driveDamping = 500;
  joint.axes[1].min = joint.axes[1].max = 0;
  joint.axes[2].driveStiffness = kPlatformSpring, joint.axes[2].driveDamping = 800;
  joint.axes[3].min = joint.axes[3].max = 0;
  joint.axes[4].min = joint.axes[4].max = 0;
  joint.axes[5].targetPosition = 1, joint.axes[5].driveStiffness = 400, joint.axes[5].driveDamping = 150;
  return scene;
}
Probes platformProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const JointState joint = jointOf(world, "platform");
    metrics["slid_m"] = joint.axes[0].position;
    metrics["sag_ratio"] = -joint.axes[2].position * kPlatformSpring / (kPlatformMass * kG);
    metrics["turned_rad"] = joint.axes[5].position;
    metrics["limit_force_ratio"] = -joint.axes[0].limitForce / (.4 * 500);
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// The cart-pole of reinforcement learning: a pole on a cart that runs on a rail.
constexpr double kCartMass = 1, kPoleMass = .1, kPoleHalf = .5, kRail = 2.4;
Scene buildCartPole(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.8);
  const int cart = put(scene, box({.2, .15, .1}, {}, kCartMass), "cart");
  const Vec3 tip = rotate(fromAxisAngle(kY, value(arguments, "lean")), 2 * kPoleHalf * kZ);
  const int pole = put(scene, rod({}, tip, .02, kPoleMass), "pole");
  JointDef& rail = join(scene, JointType::Slider, cart, kWorld, {}, kX, "rail");
  rail.axes[0].min = -kRail, rail.axes[0].max = kRail;
  join(scene, JointType::Hinge, pole, cart, {}, kY, "hinge").collide = false;
  return scene;
}
Probes cartPoleProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  const auto center = [](double cart, double pole) {
    return (kCartMass * cart + kPoleMass * pole) / (kCartMass + kPoleMass);
  };
  const double before = center(scene.bodies[0].position.x, scene.bodies[1].position.x);
  probes.push_back(everyStep([=](const World& world, const StepReport&, Metrics& metrics) {
    const double now = center(bodyOf(world, "cart").position.x, bodyOf(world, "pole").position.x);
    raise(metrics, "drift_m", std::fabs(now - before));
    raise(metrics, "swing_rad", std::fabs(jointOf(world, "hinge").axes[0].position));
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

}  // namespace

std::vector<Spec> machineSpecs() {
  Spec universal = jointSpec(
      "universal-shaft", "Two shafts at an angle on a universal joint, the first driven.", buildUniversal,
      universalProbes, {}, 300, {quantity("bend", 30, 0, 60, "deg", "angle of the shafts")});
  universal.claims = universalClaims;
  return {
      jointSpec("slider-crank", "A crank drives a piston.", buildCrank, crankProbes,
                {atMost("piston_error_m", .005, "r cos a + sqrt(l^2 - r^2 sin^2 a)"),
                 atMost("crank_error_rad", .05, "the motor keeps its speed"),
                 atMost("joint_gap_peak_m", .005, "every joint stays closed")},
                300),
      jointSpec("gear-train", "A motor, three wheels, 2 : 1 and 3 : 1, a brake on the last one.", buildGears,
                gearProbes,
                {atMost("tooth_error_rad", .01,
                        "the angles keep their ratio within half a degree of the motor while it speeds up"),
                 atMost("tooth_error_end_rad", .005, "and closer when it runs under load"),
                 within("speed_ratio", .99, 1.01, "a sixth of the speed"),
                 within("torque_ratio", .98, 1.02, "a sixth of the torque")},
                300),
      jointSpec("rack", "A weight on a rack falls and spins its pinion.", buildRack, rackProbes,
                {within("fall_ratio", .99, 1.01, "a = g m r^2 / (I + m r^2), implicit Euler in closed form"),
                 atMost("mesh_error_m", 1e-4, "they stay in mesh")},
                60),
      jointSpec("atwood", "Two masses on a rope over a pulley.", buildAtwood, atwoodProbes,
                {within("fall_ratio", .99, 1.01, "a = g (r - 1) / (r + 1), implicit Euler in closed form"),
                 atMost("stretch_peak", .001, "the rope keeps its length"),
                 within("tension_ratio", .99, 1.01, "2 m r g / (r + 1)")},
                60, {quantity("ratio", 2, 1.01, 1000, "1", "heavy over light mass")}),
      universal,
      jointSpec(
          "platform", "A platform on one six-dof joint: limited, locked, sprung and driven axes.",
          buildPlatform, platformProbes,
          {within("slid_m", .495, .505, "driven against its limit"),
           within("limit_force_ratio", .95, 1.05, "with the force of the drive"),
           within("sag_ratio", .99, 1.01, "m g / k"), within("turned_rad", .99, 1.01, "turned as driven"),
           atMost("joint_gap_peak_m", .01, "locked and limited axes hold")},
          300),
      jointSpec("cart-pole", "A pole on a cart, let go: the cart-pole of reinforcement learning.",
                buildCartPole, cartPoleProbes,
                {atMost("drift_m", .001, "no force acts along the rail: the center of mass stays"),
                 atLeast("swing_rad", 3, "the pole swings through to the other side"),
                 atMost("joint_gap_peak_m", .001, "rail and hinge hold")},
                300, {quantity("lean", .05, -3.1, 3.1, "rad", "initial angle of the pole from upright")}),
  };
}

}  // namespace rubble::scenes

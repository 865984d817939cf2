/// Gears and racks whose axes move: planets on an arm, a gearbox that falls, a differential, a rack on a
/// turntable.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kPi = std::numbers::pi;
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

/// A disc about an axis of the world.
BodyDef disc(double radius, double halfWidth, const Vec3& position, const Vec3& axis, double mass) {
  BodyDef body;
  body.shape = Shape::cylinder(radius, halfWidth);
  body.position = position;
  // z of the shape along the axis
  body.orientation = normalize(frameAlong(axis) * fromAxisAngle(kY, kPi / 2));
  body.mass = mass;
  return body;
}
JointDef& gear(Scene& scene, int a, int b, int frameBody, double ratio, const std::string& name) {
  JointDef& joint = join(scene, JointType::Gear, a, b, {}, kY, name);
  joint.frameBodyA = joint.frameBodyB = frameBody;
  joint.ratio = ratio;
  return joint;
}

// Teeth: sun, planet, ring. The ring stands still.
constexpr double kSun = 24, kPlanet = 18, kRing = 60, kTooth = .01, kSunSpeed = 6, kArmBrake = 20;
constexpr int kPlanets = 3;
Scene buildPlanetary(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int sun = put(scene, disc(kSun * kTooth, .06, {}, kY, 6), "sun");
  const int arm = put(scene, disc(.36, .03, {0, -.12, 0}, kY, 4), "arm");
  std::vector<ShapePartDef> blocks;
  constexpr int kBlocks = 24;
  for (int i = 0; i < kBlocks; ++i) {
    const double angle = 2 * kPi * i / kBlocks, radius = kRing * kTooth + .04;
    blocks.push_back({Shape::box({.085, .06, .03}),
                      {radius * portable::sin(angle), 0, radius * portable::cos(angle)},
                      fromAxisAngle(kY, angle)});
  }
  BodyDef frame;
  frame.motion = Motion::Static;
  frame.shape = Shape::compound(blocks);
  const int ring = put(scene, frame, "ring");
  join(scene, JointType::Hinge, sun, kWorld, {}, kY, "sun axle").axes[0] = motor(kSunSpeed);
  join(scene, JointType::Hinge, arm, kWorld, {}, kY, "arm axle").axes[0].friction = kArmBrake;
  for (int i = 0; i < kPlanets; ++i) {
    const double angle = 2 * kPi * i / kPlanets, radius = (kSun + kPlanet) * kTooth;
    const std::string number = std::to_string(i);
    const Vec3 place{radius * portable::sin(angle), 0, radius * portable::cos(angle)};
    const int planet = put(scene, disc(kPlanet * kTooth, .06, place, kY, 3), "planet" + number);
    join(scene, JointType::Hinge, planet, arm, place, kY, "pin" + number);
    gear(scene, sun, planet, arm, kPlanet / kSun, "sun mesh" + number);
    gear(scene, planet, ring, arm, -kRing / kPlanet, "ring mesh" + number);
  }
  return scene;
}
Probes planetaryProbes(const Arguments&, const Scene&) {
  Probes probes;
  const auto slack = [](const World& world) {
    const double sun = jointOf(world, "sun axle").axes[0].position,
                 arm = jointOf(world, "arm axle").axes[0].position;
    double largest = 0;
    for (int i = 0; i < kPlanets; ++i) {
      const double pin = jointOf(world, "pin" + std::to_string(i)).axes[0].position;
      largest = std::max(
          {largest, std::fabs(sun - arm + kPlanet / kSun * pin), std::fabs(pin + kRing / kPlanet * arm)});
    }
    return largest;
  };
  probes.push_back(everyStep([slack](const World& world, const StepReport&, Metrics& metrics) {
    raise(metrics, "tooth_error_rad", slack(world));
  }));
  probes.push_back(atEnd([slack](const World& world, Metrics& metrics) {
    const JointAxisState sun = jointOf(world, "sun axle").axes[0], arm = jointOf(world, "arm axle").axes[0];
    constexpr double kRatio = 1 + kRing / kSun;
    metrics["speed_ratio"] = arm.speed * kRatio / kSunSpeed;
    metrics["torque_ratio"] = sun.driveForce * kRatio / kArmBrake;
    metrics["tooth_error_end_rad"] = slack(world);
    metrics["arm_turns"] = arm.position / (2 * kPi);
  }));
  return probes;
}

// A motor in a housing that floats drives two wheels, 3 : 1.
constexpr double kFast = .12, kSlow = .36, kShaftSpeed = 30, kFastMass = 4, kSlowMass = 12, kHousingMass = 40;
Scene buildGearbox(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const double x = (kFast + kSlow) / 2;
  const int housing = put(scene, box({.66, .1, .4}, {}, kHousingMass), "housing");
  const int fast = put(scene, disc(kFast, .08, {-x, -.2, 0}, kY, kFastMass), "fast");
  const int slow = put(scene, disc(kSlow, .08, {x, -.2, 0}, kY, kSlowMass), "slow");
  join(scene, JointType::Hinge, fast, housing, {-x, -.2, 0}, kY, "shaft").axes[0] = motor(kShaftSpeed, 10);
  join(scene, JointType::Hinge, slow, housing, {x, -.2, 0}, kY, "output");
  JointDef mesh = gearBetween(scene, 0, 1, kSlow / kFast);
  mesh.name = "mesh";
  scene.joints.push_back(mesh);
  return scene;
}
Vec3 angularMomentum(const World& world, Vec3& linear, Vec3& center) {
  double mass = 0;
  linear = center = {};
  for (const BodyId id : world.bodies()) {
    const double m = world.massOf(id).mass;
    mass += m, linear += m * world.state(id).velocity, center += m * world.state(id).position;
  }
  center = center / mass;
  Vec3 sum;
  for (const BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    const MassProperties m = world.massOf(id);
    const Quat q = s.orientation * m.axes;
    sum += m.mass * cross(s.position - center, s.velocity - linear / mass) +
           rotate(q, mul(m.inertia, rotateInverse(q, s.angularVelocity)));
  }
  linear = linear / mass;
  return sum;
}
Probes gearboxProbes(const Arguments&, const Scene&) {
  Probes probes;
  constexpr double kFastMoment = kFastMass * kFast * kFast / 2, kSlowMoment = kSlowMass * kSlow * kSlow / 2;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    Vec3 velocity, center;
    const Vec3 momentum = angularMomentum(world, velocity, center);
    raise(metrics, "momentum_ratio", length(momentum) / (kSlowMoment * kShaftSpeed * kFast / kSlow));
    raise(metrics, "fall_error_m_s", length(velocity - Vec3{0, 0, -kG * world.time()}));
    const double shaft = jointOf(world, "shaft").axes[0].position,
                 output = jointOf(world, "output").axes[0].position;
    raise(metrics, "tooth_error_rad", std::fabs(shaft + kSlow / kFast * output));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    // all of it turns with the housing, and the wheels besides
    Vec3 velocity, center;
    angularMomentum(world, velocity, center);
    double moment = kFastMoment + kSlowMoment + kHousingMass * (.66 * .66 + .4 * .4) / 3;
    for (const BodyId id : world.bodies()) {
      const Vec3 r = world.state(id).position - center;
      moment += world.massOf(id).mass * (r.x * r.x + r.z * r.z);
    }
    const double wanted = -(kFastMoment - kSlowMoment * kFast / kSlow) * kShaftSpeed / moment;
    metrics["housing_speed_ratio"] = bodyOf(world, "housing").angularVelocity.y / wanted;
    metrics["shaft_speed_ratio"] = jointOf(world, "shaft").axes[0].speed / kShaftSpeed;
    metrics["housing_turns"] = bodyOf(world, "housing").angularVelocity.y * world.time() / (2 * kPi);
  }));
  return probes;
}

// A cage with a spider in it turns two wheels with different brakes.
constexpr double kCageTorque = 30, kWheelBrake[2] = {13, 14};
Scene buildDifferential(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 0);
  const int cage = put(scene, disc(.3, .04, {}, kX, 8), "cage");
  const int spider = put(scene, disc(.1, .03, {0, 0, .15}, kZ, 1), "spider");
  const int wheels[2] = {put(scene, disc(.25, .05, {-.5, 0, 0}, kX, 5), "left"),
                         put(scene, disc(.25, .05, {.5, 0, 0}, kX, 5), "right")};
  JointAxis& drive = join(scene, JointType::Hinge, cage, kWorld, {}, kX, "cage axle").axes[0];
  drive = motor(100, kCageTorque);
  join(scene, JointType::Hinge, spider, cage, {0, 0, .15}, kZ, "pin");
  for (int i = 0; i < 2; ++i)
    join(scene, JointType::Hinge, wheels[i], kWorld, {i == 0 ? -.5 : .5, 0, 0}, kX,
         i == 0 ? "left axle" : "right axle")
        .axes[0]
        .friction = kWheelBrake[i];
  for (int i = 0; i < 2; ++i) {
    JointDef& mesh = gear(scene, wheels[i], spider, cage, i == 0 ? 1 : -1,
                          i == 0 ? "left mesh" : "right mesh");
    // bevels: the wheel turns about x of the cage, the spider about its z
    mesh.frameA = normalize(conjugate(scene.bodies[static_cast<std::size_t>(wheels[i])].orientation) *
                            frameAlong(kX));
    mesh.frameB = normalize(conjugate(scene.bodies[static_cast<std::size_t>(spider)].orientation) *
                            frameAlong(kZ));
  }
  return scene;
}
Probes differentialProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const auto angle = [&](const char* name) { return jointOf(world, name).axes[0].position; };
    raise(metrics, "tooth_error_rad",
          std::fabs(angle("left axle") + angle("right axle") - 2 * angle("cage axle")));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    // both wheels get the same torque. Accelerations a of the wheels, with T the torque of the motor: T =
    // I_cage (aL + aR) / 2 + I (aL + aR) + brakes, I (aL - aR) = difference of the brakes
    constexpr double kWheel = 5 * .25 * .25 / 2,
                     kCage = 8 * .3 * .3 / 2 + .15 * .15 + (3 * .1 * .1 + .06 * .06) / 12;
    const double sum = (kCageTorque - kWheelBrake[0] - kWheelBrake[1]) / (kWheel + kCage / 2),
                 difference = (kWheelBrake[1] - kWheelBrake[0]) / kWheel;
    metrics["left_speed_ratio"] = jointOf(world, "left axle").axes[0].speed /
                                  ((sum + difference) / 2 * world.time());
    metrics["right_speed_ratio"] = jointOf(world, "right axle").axes[0].speed /
                                   ((sum - difference) / 2 * world.time());
  }));
  return probes;
}

// A weight hangs on a rack beside a pinion, both in a frame that a motor turns about the vertical.
constexpr double kPinion = .2, kPinionMass = 8, kWeight = 5, kTurnSpeed = 3;
Scene buildTurntable(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int table = put(scene, box({.1, .5, 1}, {-.4, 0, 0}, 30), "frame");
  const int pinion = put(scene, disc(kPinion, .06, {0, 0, 0}, kY, kPinionMass), "pinion");
  const int rack = put(scene, box({.05, .05, 1}, {kPinion + .05, 0, 0}, kWeight), "rack");
  join(scene, JointType::Hinge, table, kWorld, {}, kZ, "turntable").axes[0] = motor(kTurnSpeed);
  join(scene, JointType::Hinge, pinion, table, {}, kY, "axle");
  join(scene, JointType::Slider, rack, table, {kPinion + .05, 0, 0}, -kZ, "guide");
  // a turn about y by +1 rad takes a point at +x down
  JointDef mesh = rackBetween(scene, 1, 2, kPinion);
  mesh.name = "mesh";
  scene.joints.push_back(mesh);
  return scene;
}
Probes turntableProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const double way = jointOf(world, "guide").axes[0].position,
                 angle = jointOf(world, "axle").axes[0].position;
    raise(metrics, "mesh_error_m", std::fabs(way - kPinion * angle));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const double moment = kPinionMass * kPinion * kPinion / 2,
                 a = kG * kWeight * kPinion * kPinion / (moment + kWeight * kPinion * kPinion);
    const double h = world.params().dt / world.params().substeps, t = world.time();
    // along the axis of the turntable the turn adds nothing; implicit Euler: a t (t + h) / 2
    metrics["fall_ratio"] = jointOf(world, "guide").axes[0].position / (a * t * (t + h) / 2);
    metrics["turned_ratio"] = jointOf(world, "turntable").axes[0].position / (kTurnSpeed * t);
  }));
  return probes;
}

}  // namespace

std::vector<Spec> gearSpecs() {
  return {
      jointSpec(
          "planetary",
          "A planetary gear: the sun is driven, the ring stands, the arm of three planets is braked.",
          buildPlanetary, planetaryProbes,
          {within("speed_ratio", .99, 1.01, "the arm turns 1 + ring / sun times slower"),
           within("torque_ratio", .98, 1.02, "with as many times the torque"),
           atMost("tooth_error_rad", .005, "teeth stay in mesh within a third of a degree while it starts"),
           atMost("tooth_error_end_rad", .001, "and closer under load")},
          300),
      jointSpec(
          "gearbox", "A motor in a housing that falls drives two wheels, 3 : 1.", buildGearbox, gearboxProbes,
          {atMost("momentum_ratio", .02,
                  "of the wheels: the housing takes the reaction of the teeth, and implicit Euler a little"),
           atMost("fall_error_m_s", 1e-3, "it falls freely"),
           within("housing_speed_ratio", .98, 1.02, "-(I1 - I2 / 3) s / I"),
           within("shaft_speed_ratio", .99, 1.01, "the motor has its speed"),
           atMost("tooth_error_rad", .005, "teeth stay in mesh")},
          120),
      jointSpec("differential", "A cage drives two wheels with different brakes by a spider between them.",
                buildDifferential, differentialProbes,
                {atMost("tooth_error_rad", .035, "left + right = 2 cage"),
                 within("left_speed_ratio", .97, 1.03, "both wheels get the same torque"),
                 within("right_speed_ratio", .9, 1.1, "of which little is left beside the brake")},
                120),
      jointSpec("rack-turntable", "A weight on a rack spins its pinion, in a frame that turns.",
                buildTurntable, turntableProbes,
                {within("fall_ratio", .99, 1.01, "a = g m r^2 / (I + m r^2), implicit Euler in closed form"),
                 within("turned_ratio", .99, 1.01, "the frame turns as driven"),
                 atMost("mesh_error_m", 1e-4, "they stay in mesh")},
                60),
  };
}

}  // namespace rubble::scenes

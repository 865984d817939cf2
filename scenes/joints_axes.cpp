/// One axis at a time: hinges, springs, motors, ropes, against closed forms.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "motion_probes.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kDegree = std::numbers::pi / 180;
constexpr Vec3 kY{0, 1, 0}, kZ{0, 0, 1};

// A rod of 2 m on a hinge at its end: I / (m d) = (4/3) l^2 / l with half length l, and a thickness.
constexpr double kHalfRod = 1, kHalfThick = .05, kRodMass = 3;

Scene buildHingePendulum(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  BodyDef body = box({kHalfThick, kHalfThick, kHalfRod}, {}, kRodMass);
  const double angle = value(arguments, "angle") * kDegree;
  body.orientation = fromAxisAngle(kY, angle);
  body.position = rotate(body.orientation, Vec3{0, 0, -kHalfRod});
  put(scene, body, "rod");
  join(scene, JointType::Hinge, 0, kWorld, {}, kY, "hinge");
  return scene;
}
Probes hingePendulumProbes(const Arguments&, const Scene&) {
  Probes probes;
  const double moment = kRodMass * (kHalfRod * kHalfRod + kHalfThick * kHalfThick) / 3 +
                        kRodMass * kHalfRod * kHalfRod;
  probes.push_back(periodProbe("rod", 2 * std::numbers::pi * std::sqrt(moment / (kRodMass * kG * kHalfRod))));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// Two doors: one is thrown against its limit, a revolving one runs out by friction.
constexpr double kDoorHalf = .5, kDoorMass = 20, kDoorSpin = 2, kDoorLimit = 1.2, kDoorFriction = 3;
double doorMoment() { return kDoorMass * (kDoorHalf * kDoorHalf + .03 * .03) / 3; }

Scene buildDoor(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  for (int i = 0; i < 2; ++i) {
    const double y = 3 * i;
    const double arm = i == 0 ? kDoorHalf : 0;
    BodyDef door = box({kDoorHalf, .03, 1}, {arm, y, 1}, kDoorMass);
    door.angularVelocity = {0, 0, kDoorSpin};
    door.velocity = cross(door.angularVelocity, Vec3{arm, 0, 0});
    const int body = put(scene, door, i == 0 ? "stopped" : "rubbed");
    JointDef& hinge = join(scene, JointType::Hinge, body, kWorld, {0, y, 1}, kZ,
                           i == 0 ? "limit" : "friction");
    if (i == 0)
      hinge.axes[0].min = -kDoorLimit, hinge.axes[0].max = kDoorLimit;
    else
      hinge.axes[0].friction = kDoorFriction;
  }
  return scene;
}
Probes doorProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const JointAxisState axis = jointOf(world, "limit").axes[0];
    raise(metrics, "limit_excess_rad", std::fabs(axis.position) - kDoorLimit);
    if (axis.position > kDoorLimit - .02) metrics["reached_limit"] = 1;
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const double dt = world.params().dt / world.params().substeps;
    // implicit Euler: the speed is down by T dt / I before the first move
    const double stop = kDoorSpin * kDoorSpin * doorMoment() / (2 * kDoorFriction) - kDoorSpin * dt / 2;
    const JointAxisState axis = jointOf(world, "friction").axes[0];
    metrics["friction_way_error"] = axis.position / stop - 1;
    metrics["rest_speed_rad_s"] = std::fabs(axis.speed);
    metrics["rebound_rad_s"] = std::fabs(jointOf(world, "limit").axes[0].speed);
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// A mass on a damped spring, against implicit Euler in closed form for the same time step.
constexpr double kSpringMass = 2, kSpringRest = 1;
Scene buildSpring(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ball(.2, {0, 0, -kSpringRest}, kSpringMass), "bob");
  JointDef spring = jointAt(scene, JointType::Spring, 0, kWorld, {});
  spring.name = "spring";
  spring.anchorA = {};
  const double rate = 2 * std::numbers::pi * value(arguments, "frequency");
  spring.stiffness = kSpringMass * rate * rate;
  spring.dampingRatio = value(arguments, "damping_ratio");
  scene.joints.push_back(spring);
  return scene;
}
Probes springProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  const double rate = 2 * std::numbers::pi * value(arguments, "frequency"),
               zeta = value(arguments, "damping_ratio");
  struct Track {
    double z = 0, v = 0, amplitude = 0;
  };
  const auto track = std::make_shared<Track>();
  probes.push_back(everyStep([=](const World& world, const StepReport&, Metrics& metrics) {
    const int substeps = world.params().substeps;
    const double h = world.params().dt / substeps;
    for (int k = 0; k < substeps; ++k) {
      // (1 + 2 zeta w h + w^2 h^2) v' = v - h (g + w^2 z)
      track->v = (track->v - h * (kG + rate * rate * track->z)) /
                 (1 + 2 * zeta * rate * h + rate * rate * h * h);
      track->z += h * track->v;
    }
    const double z = bodyOf(world, "bob").position.z + kSpringRest;
    raise(metrics, "position_error_ratio", std::fabs(z - track->z) / (kG / (rate * rate)));
  }));
  probes.push_back(atEnd([=](const World& world, Metrics& metrics) {
    metrics["spring_force_ratio"] = jointOf(world, "spring").axes[0].driveForce / (-kSpringMass * kG);
  }));
  return probes;
}

/// A plank spun up by a motor of limited torque, and an arm that a motor cannot lift beyond 30 degrees.
constexpr double kPlankSpeed = 20, kMotorTorque = 50, kArm = 1, kArmMass = 2;
Scene buildMotor(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const int plank = put(scene, box({2.5, .5, .25}, {0, 0, 0}, 2.5), "plank");
  JointAxis& spin = join(scene, JointType::Hinge, plank, kWorld, {}, kY, "spin").axes[0];
  spin.targetSpeed = kPlankSpeed, spin.driveDamping = kHard, spin.maxDriveForce = kMotorTorque;
  const int arm = put(scene, ball(.1, {0, 4, -kArm}, kArmMass), "arm");
  JointAxis& lift = join(scene, JointType::Hinge, arm, kWorld, {0, 4, 0}, kY, "lift").axes[0];
  lift.targetSpeed = .05, lift.driveDamping = kHard, lift.maxDriveForce = kArmMass * kG * kArm * .5;
  return scene;
}
Probes motorProbes(const Arguments&, const Scene&) {
  Probes probes;
  const double moment = 2.5 * (2.5 * 2.5 + .25 * .25) / 3;
  probes.push_back(everyStep([=](const World& world, const StepReport&, Metrics& metrics) {
    const double wanted = std::min(kPlankSpeed, kMotorTorque / moment * world.time());
    raise(metrics, "speed_error_ratio", std::fabs(jointOf(world, "spin").axes[0].speed / wanted - 1));
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    const JointState lift = jointOf(world, "lift");
    metrics["stall_deg"] = lift.axes[0].position / kDegree;
    metrics["stall_torque_ratio"] = std::fabs(lift.axes[0].driveForce) / (kArmMass * kG * kArm * .5);
    metrics["turns_error"] = jointOf(world, "spin").axes[0].speed / kPlankSpeed - 1;
  }));
  return probes;
}

/// A mass falls a metre before its rope is taut.
constexpr double kRope = 2, kSlack = 1;
Scene buildTaut(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ball(.2, {0, 0, -kRope + kSlack}, value(arguments, "mass")), "bob");
  JointDef rope = jointAt(scene, JointType::Rope, 0, kWorld, {});
  rope.name = "rope";
  rope.anchorA = {};
  rope.length = kRope;
  scene.joints.push_back(rope);
  return scene;
}
Probes tautProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    raise(metrics, "stretch_peak", jointOf(world, "rope").gap / kRope);
    if (world.time() > 1) raise(metrics, "rebound_m", bodyOf(world, "bob").position.z + kRope);
  }));
  const double weight = value(arguments, "mass") * kG;
  probes.push_back(atEnd([weight](const World& world, Metrics& metrics) {
    metrics["tension_ratio"] = length(jointOf(world, "rope").force) / weight;
    metrics["stretch"] = jointOf(world, "rope").gap / kRope;
  }));
  return probes;
}

/// Ten hanging cubes on joints of growing strength: those that cannot bear their weight break.
constexpr int kHangers = 10;
Scene buildBreak(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  for (int i = 0; i < kHangers; ++i) {
    const int body = put(scene, box({.5, .5, .5}, {1.5 * i, 0, 0}, 1), "cube" + std::to_string(i));
    // 0.55 to 1.45 of the weight, in force or, at an arm of half a metre, in torque
    const double part = .55 + .1 * i;
    JointDef& joint = join(scene, JointType::Fixed, body, kWorld,
                           i % 2 ? Vec3{1.5 * i - .5, 0, 0} : Vec3{1.5 * i, 0, .5}, {1, 0, 0},
                           "joint" + std::to_string(i));
    (i % 2 ? joint.breakTorque : joint.breakForce) = i % 2 ? part * kG * .5 : part * kG;
  }
  return scene;
}
Probes breakProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport& report, Metrics& metrics) {
    metrics.try_emplace("events", 0).first->second += static_cast<double>(report.broken.size());
    metrics.try_emplace("wrong_events", 0);
    for (const JointId id : report.broken) metrics["wrong_events"] += !world.state(id).broken;
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    double wrong = 0;
    for (int i = 0; i < kHangers; ++i)
      wrong += jointOf(world, "joint" + std::to_string(i)).broken != (.55 + .1 * i < 1);
    metrics["broken_wrong"] = wrong;
  }));
  return probes;
}

/// A cube is dragged over the ground by a drag joint that moves; one beside it is too heavy for the same
/// force.
constexpr double kDragForce = 60;
Scene buildDrag(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ, 0, .5));
  for (int i = 0; i < 2; ++i) {
    // friction holds 25 N and 250 N
    const double mass = i == 0 ? 5 : 50, y = 3 * i;
    BodyDef cube = box({.5, .5, .5}, {0, y, .5}, mass);
    cube.material = {.5, .5, 0};
    const int body = put(scene, cube, i == 0 ? "light" : "heavy");
    JointDef& drag = join(scene, JointType::Drag, body, kWorld, {.5, y, .5}, {1, 0, 0},
                          i == 0 ? "drag" : "vain");
    drag.stiffness = 400, drag.dampingRatio = 1, drag.maxForce = kDragForce;
    for (int step = 30; step <= 150; step += 2) {
      Event event;
      event.step = step;
      event.setJoint.push_back({drag.name, 0, {}, {}, {}, Vec3{.5 + 3 * (step - 30) / 120., y, .5}});
      scene.events.push_back(event);
    }
  }
  return scene;
}
Probes grabProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    for (const char* name : {"drag", "vain"})
      raise(metrics, "force_peak_ratio", length(jointOf(world, name).force) / kDragForce);
  }));
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    metrics["dragged_m"] = bodyOf(world, "light").position.x;
    metrics["heavy_moved_m"] = std::fabs(bodyOf(world, "heavy").position.x);
  }));
  return probes;
}

}  // namespace

std::vector<Spec> jointAxisSpecs() {
  return {
      jointSpec("hinge-pendulum", "A rod on a hinge swings.", buildHingePendulum, hingePendulumProbes,
                {within("period_error", -.01, .01, "2 pi sqrt(I / (m g d)), within 1 %"),
                 atMost("joint_gap_peak_m", 1e-3, "the pivot stays"),
                 atMost("joint_angle_peak_deg", .1, "and so does the axis")},
                420, {quantity("angle", 5, 1, 10, "deg", "at the start, from the vertical")}),
      jointSpec(
          "door",
          "Two doors are thrown: one against its limit, a revolving one is stopped by friction in its hinge.",
          buildDoor, doorProbes,
          {atMost("limit_excess_rad", .02, "the limit holds"), within("reached_limit", 1, 1, "it is reached"),
           within("friction_way_error", -.01, .01, "friction stops the other after I w^2 / (2 T)"),
           atMost("rest_speed_rad_s", 1e-3, "and holds it"),
           atMost("joint_gap_peak_m", 2e-3, "the hinges stay")},
          240),
      jointSpec("spring-oscillator", "A mass on a damped spring, let go where the spring is at rest.",
                buildSpring, springProbes,
                {atMost("position_error_ratio", .01,
                        "implicit Euler in closed form: frequency and decay, within 1 % of the sag"),
                 within("spring_force_ratio", .98, 1.02, "in the end it carries the weight")},
                900,
                {quantity("frequency", .5, .05, 5, "1/s", "undamped"),
                 quantity("damping_ratio", .1, 0, 2, "1", "of critical")}),
      jointSpec("motor",
                "A motor of 50 N m spins up a plank to 20 rad/s, another stalls under the arm it lifts "
                "(avbd-demo2d).",
                buildMotor, motorProbes,
                {atMost("speed_error_ratio", .01, "w = min(20, T t / I) within 1 %"),
                 within("stall_deg", 28.5, 31.5, "stalls where m g l sin a = T, swinging a little"),
                 within("stall_torque_ratio", .99, 1.01, "with all its torque")},
                780),
      jointSpec("rope-taut", "A mass falls a metre before its rope is taut.", buildTaut, tautProbes,
                {atMost("stretch_peak", .02, "the rope stops it"),
                 atMost("rebound_m", .05, "without throwing it back"),
                 within("tension_ratio", .98, 1.02, "and carries its weight"),
                 atMost("stretch", .002, "at its length")},
                300, {quantity("mass", 10, 1e-3, 1e6, "kg", "of the bob")}),
      jointSpec("break-row", "Ten cubes hang on joints of growing strength, by force and by torque.",
                buildBreak, breakProbes,
                {within("broken_wrong", 0, 0, "just those that cannot bear the weight break"),
                 within("events", 5, 5, "each is reported once"),
                 within("wrong_events", 0, 0, "and it is the one that broke")},
                180),
      jointSpec("drag", "A drag joint of 60 N pulls a cube over the ground, and a heavy one in vain.",
                buildDrag, grabProbes,
                {within("dragged_m", 2.8, 3.05, "the light one follows, behind by friction over stiffness"),
                 atMost("heavy_moved_m", .01, "friction holds the other"),
                 atMost("force_peak_ratio", 1.0001, "the force stays in its bound")},
                300),
  };
}

}  // namespace rubble::scenes

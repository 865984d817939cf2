/// Machines that drive and reach: a robot arm, a car.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"

namespace rubble::scenes {
namespace {

constexpr double kG = 10, kDegree = std::numbers::pi / 180;
constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

/// Six hinges with position drives: to a pose and back, with a load in the hand.
constexpr double kLoad = 5, kPose[6] = {.6, -.7, 1.1, .4, -.5, .8};
Scene buildRobot(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  const double lengths[6] = {.4, 1, .9, .3, .25, .15}, masses[6] = {30, 20, 12, 4, 2, 1},
               most[6] = {800, 1500, 800, 200, 100, 50};
  // stretched upwards; axes: turn, shoulder, elbow, roll, wrist, flange
  const Vec3 axes[6] = {kZ, kY, kY, kZ, kY, kZ};
  double z = 0;
  int before = kWorld;
  for (int i = 0; i < 6; ++i) {
    const double width = .14 - .018 * i;
    const int link = put(scene, box({width, width, lengths[i] / 2}, {0, 0, z + lengths[i] / 2}, masses[i]),
                         "link" + std::to_string(i));
    JointAxis& axis = join(scene, JointType::Hinge, link, before, {0, 0, z}, axes[i],
                           "axis" + std::to_string(i))
                          .axes[0];
    axis.min = -2.8, axis.max = 2.8;
    axis.driveStiffness = kHard, axis.maxDriveForce = most[i];
    z += lengths[i];
    before = link;
  }
  const int load = put(scene, ball(.1, {0, 0, z + .1}, kLoad), "load");
  join(scene, JointType::Fixed, load, before, {0, 0, z}, kX, "hand");
  // to the pose in a second and a half, smoothly
  for (int k = 0; k <= 90; ++k) {
    Event event;
    event.step = 30 + k;
    const double s = k / 90., part = s * s * (3 - 2 * s);
    for (int i = 0; i < 6; ++i)
      event.setJoint.push_back({"axis" + std::to_string(i), 0, part * kPose[i], {}, {}, {}});
    scene.events.push_back(event);
  }
  return scene;
}
Probes robotProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  std::vector<double> masses;
  for (const BodyDef& body : scene.bodies) masses.push_back(*body.mass);
  probes.push_back(atEnd([masses](const World& world, Metrics& metrics) {
    double error = 0;
    for (int i = 0; i < 6; ++i)
      error = std::max(error,
                       std::fabs(jointOf(world, "axis" + std::to_string(i)).axes[0].position - kPose[i]));
    metrics["pose_error_deg"] = error / kDegree;
    // what the shoulder must hold: the moment of everything beyond it about its axis
    const JointDef& shoulder = world.definition(world.findJoint("axis1"));
    const BodyState upper = bodyOf(world, "link1"), base = bodyOf(world, "link0");
    const Vec3 point = upper.position + rotate(upper.orientation, shoulder.anchorA);
    const Vec3 axis = rotate(base.orientation * shoulder.frameB, kX);
    double moment = 0;
    for (std::size_t i = 1; i < masses.size(); ++i) {
      const Vec3 at = world.state(world.bodyAt(static_cast<int>(i))).position;
      moment += dot(axis, cross(at - point, Vec3{0, 0, -kG * masses[i]}));
    }
    metrics["shoulder_torque_ratio"] = jointOf(world, "axis1").axes[0].driveForce / -moment;
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// A chassis on four wheels, each on one six-dof joint: a spring upwards, free to spin about its axle.
constexpr double kChassis = 800, kWheelRadius = .35, kSuspension = 20000, kDriveSpeed = 15;
Scene buildCar(const Arguments&) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ, 0, 1));
  const int chassis = put(scene, box({1.6, .7, .25}, {0, 0, .75}, kChassis), "chassis");
  int number = 0;
  for (const double x : {-1.2, 1.2})
    for (const double y : {-.95, .95}) {
      BodyDef wheel = ball(kWheelRadius, {x, y, kWheelRadius}, 20);
      wheel.material = {1, 1, 0};
      const int body = put(scene, wheel, "wheel" + std::to_string(number));
      JointDef& joint = join(scene, JointType::SixDof, body, chassis, {x, y, kWheelRadius}, kX,
                             "wheel" + std::to_string(number));
      joint.axes[0].min = joint.axes[0].max = 0;
      joint.axes[1].min = joint.axes[1].max = 0;
      joint.axes[2].min = -.15, joint.axes[2].max = .15;
      joint.axes[2].driveStiffness = kSuspension, joint.axes[2].driveDamping = 2500;
      joint.axes[3].min = joint.axes[3].max = 0;
      joint.axes[5].min = joint.axes[5].max = 0;
      if (x < 0) joint.axes[4] = motor(kDriveSpeed, 300);
      ++number;
    }
  // sleepers to drive over
  for (int i = 0; i < 6; ++i) {
    BodyDef sleeper = box({.1, 2, .04}, {20 + 1.5 * i, 0, .04}, 1);
    sleeper.mass.reset();
    sleeper.motion = Motion::Static;
    put(scene, sleeper, "sleeper" + std::to_string(i));
  }
  return scene;
}
Probes carProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const BodyState chassis = bodyOf(world, "chassis");
    raise(metrics, "tilt_peak_deg",
          portable::acos(std::min(1.0, rotate(chassis.orientation, kZ).z)) / kDegree);
    if (world.time() > 1.4 && world.time() < 2) {
      double sag = 0;
      for (int i = 0; i < 4; ++i) sag += jointOf(world, "wheel" + std::to_string(i)).axes[2].position / 4;
      metrics["sag_ratio"] = sag * kSuspension / (kChassis * kG / 4);
    }
    metrics["travel_m"] = chassis.position.x;
    metrics["speed_ratio"] = chassis.velocity.x / (kDriveSpeed * kWheelRadius);
    metrics["side_m"] = std::fabs(chassis.position.y);
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

}  // namespace

std::vector<Spec> robotSpecs() {
  return {
      jointSpec("robot-arm", "Six hinges with position drives move a load to a pose.", buildRobot,
                robotProbes,
                {atMost("pose_error_deg", 1, "it gets there"),
                 within("shoulder_torque_ratio", .98, 1.02, "the shoulder holds the moment of all beyond it"),
                 atMost("joint_gap_peak_m", .005, "every joint stays closed")},
                300),
      jointSpec("car", "A car on springs, driven by its rear wheels, over sleepers.", buildCar, carProbes,
                {within("sag_ratio", .9, 1.1, "its springs carry it"),
                 atLeast("travel_m", 25, "it drives over the sleepers"),
                 within("speed_ratio", .9, 1.1, "at the speed of its wheels"),
                 atMost("tilt_peak_deg", 20, "upright"), atMost("side_m", 1.5, "and straight"),
                 atMost("joint_gap_peak_m", .05, "on its wheels")},
                600),
  };
}

}  // namespace rubble::scenes

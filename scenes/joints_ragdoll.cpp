/// Ragdolls: ball joints with cones and twists, hinges with limits.
#include <cmath>
#include <numbers>

#include "families.h"
#include "joint_probes.h"
#include "math/portable.h"
#include "ragdoll.h"

namespace rubble::scenes {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr Vec3 kZ{0, 0, 1};

// One limb on a shoulder, kicked hard in turn: it stays inside cone and twist.
constexpr double kCone = 40, kTwist = 30;
Scene buildLimb(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 10);
  put(scene, rod({0, 0, 0}, {0, 0, -.8}, .08, 3), "limb");
  JointDef& joint = join(scene, JointType::SwingTwist, 0, kWorld, {}, -kZ, "shoulder");
  joint.swingY = joint.swingZ = kCone * kDegree;
  joint.axes[1].min = -kTwist * kDegree, joint.axes[1].max = kTwist * kDegree;
  for (int i = 0; i < 8; ++i) {
    Event event;
    event.step = 40 * i;
    const double a = 2.4 * i;
    const Vec3 spin{6 * portable::cos(a), 6 * portable::sin(a), i % 2 ? 8. : -8.};
    event.setVelocity.push_back({"limb", cross(spin, Vec3{0, 0, -.4}), spin});
    scene.events.push_back(event);
  }
  return scene;
}
Probes limbProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(everyStep([](const World& world, const StepReport&, Metrics& metrics) {
    const JointState joint = jointOf(world, "shoulder");
    raise(metrics, "swing_peak_deg", joint.axes[0].position / kDegree);
    raise(metrics, "twist_peak_deg", std::fabs(joint.axes[1].position) / kDegree);
  }));
  probes.push_back(jointErrorProbe());
  return probes;
}

/// A ball joint of a ragdoll: half angles of its cone and twist in degrees.
void socket(Scene& scene, int limb, int trunk, const Vec3& point, const Vec3& axis, double cone,
            double twist) {
  JointDef& joint = join(scene, JointType::SwingTwist, limb, trunk, point, axis);
  joint.swingY = joint.swingZ = cone * kDegree;
  joint.axes[1].min = -twist * kDegree, joint.axes[1].max = twist * kDegree;
  joint.friction = .5;
}
void knee(Scene& scene, int lower, int upper, const Vec3& point, const Vec3& axis) {
  JointAxis& turn = join(scene, JointType::Hinge, lower, upper, point, axis).axes[0];
  turn.min = 0, turn.max = 2.2;
  turn.friction = .5;
}

}  // namespace

void addRagdoll(Scene& scene, const Vec3& foot, double turn, const std::string& name, double size) {
  const int first = static_cast<int>(scene.bodies.size());
  const std::size_t firstJoint = scene.joints.size();
  const int pelvis = put(scene, box({.1, .16, .1}, {0, 0, 1}, 11), name + ".pelvis");
  const int chest = put(scene, box({.11, .18, .22}, {0, 0, 1.33}, 22), name + ".chest");
  const int head = put(scene, ball(.11, {0, 0, 1.69}, 5), name + ".head");
  socket(scene, chest, pelvis, {0, 0, 1.1}, kZ, 30, 30);
  socket(scene, head, chest, {0, 0, 1.56}, kZ, 40, 60);
  for (const double side : {-1., 1.}) {
    const std::string s = name + (side < 0 ? ".right " : ".left ");
    const double y = side * .1, shoulder = side * .24;
    const int thigh = put(scene, rod({0, y, .86}, {0, y, .54}, .07, 8), s + "thigh");
    const int shin = put(scene, rod({0, y, .42}, {0, y, .08}, .055, 5), s + "shin");
    const int arm = put(scene, rod({0, shoulder, 1.45}, {0, shoulder, 1.22}, .05, 2.5), s + "arm");
    const int forearm = put(scene, rod({0, shoulder, 1.12}, {0, shoulder, .9}, .045, 1.5), s + "forearm");
    socket(scene, thigh, pelvis, {0, y, .9}, -kZ, 60, 30);
    socket(scene, arm, chest, {0, shoulder, 1.5}, -kZ, 100, 45);
    // a shin bends backwards (+y turns -z to -x), a forearm forwards
    knee(scene, shin, thigh, {0, y, .48}, {0, 1, 0});
    knee(scene, forearm, arm, {0, shoulder, 1.17}, {0, -1, 0});
  }
  const Quat q = fromAxisAngle(kZ, turn);
  for (std::size_t i = static_cast<std::size_t>(first); i < scene.bodies.size(); ++i) {
    BodyDef& body = scene.bodies[i];
    body.position = foot + rotate(q, size * body.position);
    body.orientation = q * body.orientation;
    body.shape.halfExtents = size * body.shape.halfExtents;
    body.shape.radius *= size, body.shape.halfLength *= size;
    *body.mass *= size * size * size;
  }
  for (std::size_t i = firstJoint; i < scene.joints.size(); ++i) {
    JointDef& joint = scene.joints[i];
    joint.name = name + ".joint" + std::to_string(i - firstJoint);
    joint.anchorA = size * joint.anchorA, joint.anchorB = size * joint.anchorB;
    // a moment scales with weight and length
    const double moment = size * size * size * size;
    joint.friction *= moment, joint.axes[0].friction *= moment;
  }
}

namespace {

Scene buildRagdolls(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  put(scene, ground(kUpZ, 0, .7));
  const int n = whole(arguments, "ragdolls"),
            wide = std::max(1, static_cast<int>(std::ceil(portable::cbrt(n))));
  for (int i = 0; i < n; ++i) {
    const int x = i % wide, y = i / wide % wide, level = i / (wide * wide);
    // evenly spread sizes in a quasi-random order
    const double spread = value(arguments, "size_spread"),
                 size = 1 + spread * (2 * std::fmod(i * .6180339887, 1) - 1);
    addRagdoll(scene, {1.1 * x + .15 * (level % 2), 1.1 * y, .5 + 2.1 * level}, 1.7 * i,
               "ragdoll" + std::to_string(i), size);
  }
  // a single ragdoll lands on both feet and would balance until round-off tips it over
  if (n == 1)
    for (BodyDef& body : scene.bodies)
      if (body.name == "ragdoll0.head") body.velocity = {1, 0, 0};
  return scene;
}
Probes ragdollProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(jointErrorProbe());
  probes.push_back(atEnd([](const World& world, Metrics& metrics) {
    double lowest = 1e30;
    for (const BodyId id : world.bodies())
      if (world.definition(id).motion == Motion::Dynamic)
        lowest = std::min(lowest, world.state(id).position.z);
    metrics["lowest_center_m"] = lowest;
  }));
  return probes;
}
std::vector<Claim> ragdollClaims(const Arguments&) {
  return {atMost("joint_gap_max_m", .005, "every joint is closed at the end"),
          atMost("joint_gap_peak_m", .04, "and never opens far"),
          atMost("joint_angle_peak_deg", 12, "limits hold in the fall"),
          atMost("max_speed_m_s", .5, "they come to rest"),
          atLeast("lowest_center_m", .03, "no body is in the ground"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> ragdollSpecs() {
  Spec limb;
  limb.name = "limb";
  limb.doc = "A limb on a shoulder with a cone of 40 degrees and a twist of 30, kicked eight times.";
  limb.build = buildLimb;
  limb.probes = limbProbes;
  limb.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("swing_peak_deg", kCone - 1, kCone + 2, "it reaches the cone and stays inside"),
        within("twist_peak_deg", kTwist - 1, kTwist + 2, "and its twist"),
        atMost("joint_gap_peak_m", .005, "the shoulder stays closed"),
        atMost("quarantined", 0, "every state stays finite")};
  };
  limb.camera = overview;
  limb.steps = 400;
  limb.tags = {"joint"};

  Spec ragdoll = limb;
  ragdoll.name = "ragdoll";
  ragdoll.doc = "A ragdoll of eleven bodies falls on the ground.";
  ragdoll.arguments = {count("ragdolls", 1, 1, 10000, "ragdolls, in a block above the ground"),
                       quantity("size_spread", 0, 0, .4, "1", "relative spread of their sizes")};
  ragdoll.build = buildRagdolls;
  ragdoll.probes = ragdollProbes;
  ragdoll.claims = ragdollClaims;
  ragdoll.steps = 480;

  Spec many = variant(ragdoll, "ragdolls", "A thousand ragdolls fall in a heap.", {{"ragdolls", 1000}}, 600);
  many.testArguments = {{"ragdolls", 8}};
  many.tags = {"joint", "scale"};
  Spec mixed = variant(many, "ragdolls-mixed",
                       "1,440 ragdolls of 0.7 to 1.3 times the usual size fall in a heap.",
                       {{"ragdolls", 1440}, {"size_spread", .3}});
  mixed.testArguments = {{"ragdolls", 9}};
  return {limb, ragdoll, many, mixed};
}

}  // namespace rubble::scenes

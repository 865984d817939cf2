#include "joint_probes.h"

#include <algorithm>
#include <numbers>

#include "probe_parts.h"

namespace rubble::scenes {
namespace {

class EveryStep : public Probe {
 public:
  explicit EveryStep(Measure measure) : measure_(std::move(measure)) {}
  void afterStep(const World& world, const StepReport& report) override { measure_(world, report, metrics_); }
  void finish(const World&, Metrics& metrics) override {
    for (const auto& [name, value] : metrics_) metrics[name] = value;
  }

 private:
  Measure measure_;
  Metrics metrics_;
};

class AtEnd : public Probe {
 public:
  explicit AtEnd(std::function<void(const World&, Metrics&)> measure) : measure_(std::move(measure)) {}
  void finish(const World& world, Metrics& metrics) override { measure_(world, metrics); }

 private:
  std::function<void(const World&, Metrics&)> measure_;
};

}  // namespace

std::unique_ptr<Probe> everyStep(Measure measure) { return std::make_unique<EveryStep>(std::move(measure)); }
std::unique_ptr<Probe> atEnd(std::function<void(const World&, Metrics&)> measure) {
  return std::make_unique<AtEnd>(std::move(measure));
}

void raise(Metrics& metrics, const std::string& name, double value) {
  const auto [found, fresh] = metrics.emplace(name, value);
  // a value that is not finite stays, and fails
  if (!fresh && !(value <= found->second)) found->second = value;
}

std::unique_ptr<Probe> jointErrorProbe(double from) {
  return everyStep([from](const World& world, const StepReport&, Metrics& metrics) {
    if (!reached(world, from)) return;
    double gap = 0, angle = 0;
    for (const JointId id : world.joints()) {
      const JointState state = world.state(id);
      if (state.broken) continue;
      gap = std::max(gap, state.gap);
      angle = std::max(angle, state.angle);
    }
    raise(metrics, "joint_gap_peak_m", gap);
    raise(metrics, "joint_angle_peak_deg", angle * 180 / std::numbers::pi);
  });
}

JointState jointOf(const World& world, const std::string& name) { return world.state(world.findJoint(name)); }
BodyState bodyOf(const World& world, const std::string& name) { return world.state(world.findBody(name)); }

int put(Scene& scene, BodyDef body, const std::string& name) {
  if (!name.empty()) body.name = name;
  scene.bodies.push_back(std::move(body));
  return static_cast<int>(scene.bodies.size()) - 1;
}

BodyDef box(const Vec3& halfExtents, const Vec3& position, double mass) {
  BodyDef body = block(halfExtents, position, 1000);
  body.mass = mass;
  return body;
}
BodyDef ball(double radius, const Vec3& position, double mass) {
  BodyDef body;
  body.shape = Shape::sphere(radius);
  body.position = position;
  body.mass = mass;
  return body;
}
BodyDef rod(const Vec3& a, const Vec3& b, double radius, double mass) {
  BodyDef body;
  const Vec3 way = b - a;
  body.shape = Shape::capsule(radius, length(way) / 2);
  body.position = (a + b) / 2;
  // a capsule lies along local z
  const Vec3 z = normalize(way);
  body.orientation = z.z < -1 + 1e-9 ? Quat{0, 1, 0, 0} : normalize(Quat{1 + z.z, -z.y, z.x, 0});
  body.mass = mass;
  return body;
}

JointDef& join(Scene& scene, JointType type, int a, int b, const Vec3& point, const Vec3& axis,
               const std::string& name) {
  scene.joints.push_back(jointAt(scene, type, a, b, point, frameAlong(axis)));
  scene.joints.back().name = name;
  return scene.joints.back();
}

BodyDef held(BodyDef body) {
  body.mass.reset();
  body.motion = Motion::Static;
  return body;
}
JointDef link(JointType type, int a, int b) {
  JointDef joint;
  joint.type = type;
  joint.bodyA = a, joint.bodyB = b;
  return joint;
}

JointAxis motor(double speed, double most) {
  JointAxis axis;
  axis.targetSpeed = speed;
  axis.driveDamping = kHard;
  axis.maxDriveForce = most;
  return axis;
}

Spec jointSpec(const std::string& name, const std::string& doc, Scene (*build)(const Arguments&),
               Probes (*probes)(const Arguments&, const Scene&), std::vector<Claim> claims, int steps,
               std::vector<Argument> arguments) {
  Spec s;
  s.name = name;
  s.doc = doc;
  s.arguments = std::move(arguments);
  s.build = build;
  s.probes = probes;
  claims.push_back(atMost("quarantined", 0, "every state stays finite"));
  s.claims = [claims](const Arguments&) { return claims; };
  s.camera = overview;
  s.steps = steps;
  s.tags = {"joint"};
  return s;
}

}  // namespace rubble::scenes

/// Where sticking and standing end, with closed forms: stick and slip of a block on a spring, cylinders and
/// cones that tip.
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

constexpr double kG = 10;

// Stick-slip: a block of 1 kg on a spring whose far end a kinematic body draws along x.

constexpr double kStatic = .5, kDynamic = .3;
constexpr double kSpring = 20;   // [N/m]
constexpr double kDrawing = .1;  // [m/s]
constexpr double kSpringLength = 2;

/// The block sticks until the spring pulls with mu_s m g. It then swings about mu_d m g until its velocity
/// is zero. With D = (mu_s - mu_d) m g / k and w^2 = k / m the period is 2 D / V + 2 (pi - atan(D w / V)) /
/// w.
double stickSlipPeriod() {
  const double d = (kStatic - kDynamic) * kG / kSpring, w = std::sqrt(kSpring);
  return 2 * d / kDrawing + 2 / w * (std::numbers::pi - portable::atan(d * w / kDrawing));
}

Scene buildStickSlip(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const double height = value(arguments, "height");
  put(scene, ground(kUpZ), "ground");
  put(scene, box({.5, .5, .5}, {0, 0, .5}, 1), "block");
  BodyDef hand = box({.1, .1, .1}, {kSpringLength, 0, height}, 1);
  hand.motion = Motion::Kinematic;
  hand.velocity = {kDrawing, 0, 0};
  hand.filter.mask = 0;
  put(scene, hand, "hand");
  for (BodyDef& body : scene.bodies) body.material = {kStatic, kDynamic, 0};
  JointDef spring = link(JointType::Spring, 1, 2);
  spring.name = "spring";
  spring.anchorA = {0, 0, height - .5};
  spring.stiffness = kSpring;
  spring.length = kSpringLength;
  scene.joints.push_back(spring);
  return scene;
}

/// period_error against the closed form; stiction_ratio: largest pull over mu_s m g.
class StickSlipProbe final : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    pull_ = std::max(pull_, length(jointOf(world, "spring").force));
    const bool slides = bodyOf(world, "block").velocity.x > .5 * kDrawing;
    if (slides && !slid_ && ++slips_ >= 2) (slips_ == 2 ? first_ : last_) = world.time();
    slid_ = slides;
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["stiction_ratio"] = pull_ / (kStatic * kG);
    if (slips_ > 2)
      metrics["period_error"] = std::fabs((last_ - first_) / (slips_ - 2) / stickSlipPeriod() - 1);
  }

 private:
  double pull_ = 0, first_ = 0, last_ = 0;
  int slips_ = 0;
  bool slid_ = false;
};

Probes stickSlipProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(std::make_unique<StickSlipProbe>());
  return probes;
}

std::vector<Claim> stickSlipClaims(const Arguments&) {
  return {atMost("period_error", .05, "the period of the closed form, within 5 %"),
          within("stiction_ratio", .98, 1.04,
                 "it holds up to mu_s m g; the spring goes on to pull while it begins to move")};
}

// Push: blocks that springs draw along at several heights, until they give way.

constexpr std::array kPushHeights{.05, .25, .5, .75, .9};

Scene buildPush(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  put(scene, ground(kUpZ), "ground");
  for (std::size_t i = 0; i < kPushHeights.size(); ++i) {
    const double y = 3. * double(i), height = kPushHeights[i];
    const int block = put(scene, box({.5, .5, .5}, {0, y, .5}, 1), "block" + std::to_string(i));
    BodyDef hand = box({.04, .04, .04}, {kSpringLength, y, height}, 1);
    hand.motion = Motion::Kinematic;
    hand.velocity = {kDrawing, 0, 0};
    hand.filter.mask = 0;
    JointDef spring = link(JointType::Spring, block, put(scene, hand, "hand" + std::to_string(i)));
    spring.name = "spring" + std::to_string(i);
    spring.anchorA = {0, 0, height - .5};
    spring.stiffness = kSpring;
    spring.length = kSpringLength;
    scene.joints.push_back(spring);
  }
  for (BodyDef& body : scene.bodies)
    body.material = {value(arguments, "mu"), kDynamic / kStatic * value(arguments, "mu"), 0};
  return scene;
}

/// stiction_least_ratio, stiction_most_ratio: pull of the spring as a block begins to slip over mu_s m g, of
/// all blocks.
class PushProbe final : public Probe {
 public:
  explicit PushProbe(double friction) : friction_(friction) {}
  void afterStep(const World& world, const StepReport&) override {
    for (std::size_t i = 0; i < kPushHeights.size(); ++i) {
      if (slips_[i]) continue;
      pull_[i] = length(jointOf(world, "spring" + std::to_string(i)).force) / (friction_ * kG);
      slips_[i] = bodyOf(world, "block" + std::to_string(i)).velocity.x > .2 * kDrawing;
    }
  }
  void finish(const World&, Metrics& metrics) override {
    if (std::find(slips_.begin(), slips_.end(), false) != slips_.end()) return;
    metrics["stiction_least_ratio"] = *std::min_element(pull_.begin(), pull_.end());
    metrics["stiction_most_ratio"] = *std::max_element(pull_.begin(), pull_.end());
  }

 private:
  double friction_;
  std::array<double, kPushHeights.size()> pull_{};
  std::array<bool, kPushHeights.size()> slips_{};
};

// Tipping: cylinders and cones on slopes just below and above the one at which their weight leaves their
// base.

constexpr double kRadius = .5;
constexpr std::array kYaws{0., .2, .37};

struct Standing {
  const char* name;
  bool cone;
  double half;  // of the height [m]
};
constexpr std::array<Standing, 4> kStanding{
    {{"drum", false, .5}, {"column", false, 1.25}, {"cone", true, .75}, {"spire", true, 1.5}}};

Scene buildTipping(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kG);
  const double off = value(arguments, "off") * std::numbers::pi / 180;
  for (std::size_t i = 0; i < kStanding.size(); ++i)
    for (std::size_t k = 0; k < 2 * kYaws.size(); ++k) {
      const auto& [kind, cone, half] = kStanding[i];
      const double center = cone ? half / 2 : half, yaw = kYaws[k / 2];
      const Quat tilt = fromAxisAngle(Vec3{0, 1, 0},
                                      portable::atan(kRadius / center) + (k % 2 == 0 ? -off : off));
      const Vec3 at{6. * double(i), 6. * double(k), 6};
      put(scene, held(box({1, 1, .2}, at - rotate(tilt, {0, 0, .2}), 1)),
          "slope_" + std::to_string(k) + kind);
      scene.bodies.back().orientation = tilt;
      BodyDef body = box({}, at + rotate(tilt, {0, 0, half}), 1);
      body.shape = cone ? Shape::cone(kRadius, half) : Shape::cylinder(kRadius, half);
      body.orientation = tilt * fromAxisAngle(Vec3{0, 0, 1}, yaw);
      put(scene, body, (k % 2 == 0 ? "stands_" : "tips_") + std::to_string(k / 2) + kind);
    }
  setFriction(scene, 4);
  return scene;
}

Probes tippingProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(atEnd([scene](const World& world, Metrics& metrics) {
    int wrong = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const BodyDef& body = scene.bodies[i];
      if (body.motion != Motion::Dynamic) continue;
      const Vec3 up = rotate(world.state(world.bodyAt(int(i))).orientation, kUpZ),
                 before = rotate(body.orientation, kUpZ);
      const bool tipped = dot(up, before) < portable::cos(10 * std::numbers::pi / 180);
      wrong += tipped != (body.name[0] == 't');
    }
    metrics["tips_wrong"] = wrong;
  }));
  return probes;
}

std::vector<Claim> tippingClaims(const Arguments&) {
  return {atMost("tips_wrong", 0,
                 "a body tips if, and only if, the slope is steeper than its closed form, to `off`")};
}

}  // namespace

std::vector<Spec> frictionLimitSpecs() {
  Spec slip;
  slip.name = "stick-slip";
  slip.doc = "A block on a spring whose end is drawn along at a constant speed sticks and slips in turn.";
  slip.arguments = {quantity("height", .5, .1, .8, "m", "of the spring over the ground")};
  slip.build = buildStickSlip;
  slip.probes = stickSlipProbes;
  slip.claims = stickSlipClaims;
  slip.camera = overview;
  slip.steps = 1200;
  slip.iterations = 4;
  slip.tags = {"friction"};

  Spec tipping = slip;
  tipping.name = "tipping";
  tipping.doc =
      "Cylinders and cones, turned about their axes, on slopes just below and above the one at which they "
      "tip.";
  tipping.arguments = {quantity("off", .5, .1, 5, "deg", "how far the slopes are from the closed form")};
  tipping.build = buildTipping;
  tipping.probes = tippingProbes;
  tipping.claims = tippingClaims;
  tipping.steps = 480;

  Spec push = slip;
  push.name = "push";
  push.doc = "Springs pull blocks at five heights. Each block slips when the pull is mu_s m g.";
  push.arguments = {
      quantity("mu", kStatic, .1, .5, "1", "static friction; the dynamic one is three fifths of it")};
  push.build = buildPush;
  push.probes = [](const Arguments& arguments, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<PushProbe>(value(arguments, "mu")));
    return probes;
  };
  push.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("stiction_least_ratio", .98, "none slips before mu_s m g"),
                              atMost("stiction_most_ratio", 1.02, "and none holds beyond it, within 2 %")};
  };
  push.steps = 240;
  return {slip, tipping, push};
}

}  // namespace rubble::scenes

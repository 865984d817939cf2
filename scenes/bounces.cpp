/// Restitution: bodies that bounce, each lower than before, and a chain of balls that hands a swing on.
#include <cmath>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "probe_parts.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr double kGravity = 9.81;

// Ladder: spheres, boxes and capsules with one restitution each.

constexpr double kRestitutions[] = {.3, .5, .8, 1};
constexpr double kSpacing = 2, kSize = .5;  // [m]

Scene buildLadder(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kGravity);
  scene.bodies.push_back(ground(kUpZ));
  for (int kind = 0; kind < 3; ++kind)
    for (int i = 0; i < 4; ++i) {
      BodyDef body;
      body.name = std::string(kind == 0 ? "sphere" : kind == 1 ? "box" : "capsule") + std::to_string(i);
      body.shape = kind == 0   ? Shape::sphere(kSize)
                   : kind == 1 ? Shape::box({kSize, .4, kSize})
                               : Shape::capsule(kSize, .3);
      if (kind == 2) body.orientation = frameAlong({0, 0, 1});
      body.position = {kSpacing * i, kSpacing * kind, kSize + value(arguments, "height")};
      body.material.restitution = kRestitutions[i];
      scene.bodies.push_back(body);
    }
  return scene;
}

/// ladder_error: largest |h / (e^2n h_0) - 1| of the tops of all bodies after the first bounces, as long as
/// they close twice as fast as an impact has to.
class LadderProbe final : public Probe {
 public:
  explicit LadderProbe(double height) : height_(height) {}

  void start(const World& world) override {
    for (const BodyId id : world.bodies())
      if (const double e = world.definition(id).material.restitution; e > 0)
        bouncers_.push_back({id, e, height_});
  }
  void afterStep(const World& world, const StepReport&) override {
    for (Bouncer& b : bouncers_) {
      const BodyState s = world.state(b.id);
      const bool rises = s.velocity.z > 0;
      if (rises) b.top = std::max(b.top, s.position.z - kSize);
      if (b.rises && !rises) finishBounce(b);
      b.rises = rises;
    }
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["ladder_error"] = error_, metrics["bounces"] = bounces_;
  }

 private:
  struct Bouncer {
    BodyId id;
    double e, expected;
    double top = 0;
    bool rises = false;
  };
  void finishBounce(Bouncer& b) {
    // twice 0.3 sqrt(g L)
    const bool fast = 2 * kGravity * b.expected > .36 * kGravity * 2 * kSize;
    b.expected *= b.e * b.e;
    if (fast) error_ = std::max(error_, std::abs(b.top / b.expected - 1)), ++bounces_;
    b.top = 0;
  }

  double height_, error_ = 0;
  int bounces_ = 0;
  std::vector<Bouncer> bouncers_;
};

Probes ladderProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  probes.push_back(std::make_unique<LadderProbe>(value(arguments, "height")));
  return probes;
}

std::vector<Claim> ladderClaims(const Arguments&) {
  return {atMost("ladder_error", .03, "tops are e^2n of the drop"),
          atLeast("bounces", 20, "and there are many")};
}

// Newton's cradle: balls on rods that touch at rest.

constexpr double kBall = .1, kRod = 1;  // [m]

Scene buildCradle(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, kGravity);
  const int balls = whole(arguments, "balls"), raised = whole(arguments, "raised");
  for (int i = 0; i < balls; ++i) {
    const double x = 2 * kBall * i, angle = i < raised ? value(arguments, "angle") : 0;
    BodyDef ball;
    ball.name = "ball" + std::to_string(i);
    ball.shape = Shape::sphere(kBall);
    ball.position = {x - kRod * portable::sin(angle), 0, -kRod * portable::cos(angle)};
    ball.material = {0, 0, value(arguments, "restitution")};
    scene.bodies.push_back(ball);
    JointDef rod;
    rod.type = JointType::Distance;
    rod.bodyA = i, rod.anchorB = {x, 0, 0}, rod.length = kRod;
    scene.joints.push_back(rod);
  }
  return scene;
}

/// handed_on_ratio: largest way of the last ball in the first swing over that of the first one; left_ratio:
/// largest speed of the others, over that of the impact, as the last one passes half of its way.
class CradleProbe final : public Probe {
 public:
  CradleProbe(int balls, int raised, double angle)
      : balls_(balls), raised_(raised), way_(kRod * portable::sin(angle)) {
    speed_ = std::sqrt(2 * kGravity * kRod * (1 - portable::cos(angle)));
  }
  void afterStep(const World& world, const StepReport&) override {
    const BodyState last = world.state(world.bodyAt(balls_ - 1));
    const double way = last.position.x - 2 * kBall * (balls_ - 1);
    if (over_) return;
    if (way > .1 * way_ && last.velocity.x < 0) over_ = true;
    highest_ = std::max(highest_, way);
    if (left_ >= 0 || way < .3 * way_) return;
    left_ = 0;
    for (int i = 0; i < balls_ - raised_; ++i)
      left_ = std::max(left_, length(world.state(world.bodyAt(i)).velocity) / speed_);
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["handed_on_ratio"] = highest_ / way_, metrics["left_ratio"] = left_;
  }

 private:
  int balls_, raised_;
  double way_, speed_, highest_ = 0, left_ = -1;
  bool over_ = false;
};

Probes cradleProbes(const Arguments& arguments, const Scene&) {
  Probes probes;
  probes.push_back(std::make_unique<CradleProbe>(whole(arguments, "balls"), whole(arguments, "raised"),
                                                 value(arguments, "angle")));
  return probes;
}

std::vector<Claim> cradleClaims(const Arguments& arguments) {
  if (value(arguments, "restitution") < 1) return {};
  return {within("handed_on_ratio", .9, 1.02, "the last ball swings as far as the first one came"),
          within("left_ratio", 0, .02, "and the others stay")};
}

}  // namespace

std::vector<Spec> bounceSpecs() {
  Spec ladder;
  ladder.name = "bounce-ladder";
  ladder.doc = "Spheres, boxes and capsules of restitution 0.3, 0.5, 0.8 and 1 fall and bounce.";
  ladder.arguments = {quantity("height", 2, .5, 20, "m", "of the drop")};
  ladder.build = buildLadder;
  ladder.probes = ladderProbes;
  ladder.claims = ladderClaims;
  ladder.camera = overview;
  ladder.steps = 480;
  ladder.iterations = 4;
  ladder.substeps = 2;
  ladder.tags = {"basic"};

  Spec cradle = ladder;
  cradle.name = "newtons-cradle";
  cradle.doc = "Balls on rods that touch at rest; the first ones are raised.";
  cradle.arguments = {count("balls", 5, 2, 20, "balls"), count("raised", 1, 1, 10, "balls that are raised"),
                      quantity("angle", .5, .05, 1, "rad", "of the raised rods"),
                      quantity("restitution", 1, 0, 1, "1", "of the balls")};
  cradle.build = buildCradle;
  cradle.probes = cradleProbes;
  cradle.claims = cradleClaims;
  cradle.steps = 120;
  cradle.iterations = 10;
  cradle.substeps = 4;
  cradle.tags = {"basic", "joint"};
  return {ladder, cradle};
}

}  // namespace rubble::scenes

/// Structures that friction or breakable joints hold: a card tower, dominoes, a corbelled arch, a beam.
/// Sources: the AVBD paper, Figure 6; avbd-demo3d (the beam; z up, g 10, density 1, friction 0.5).
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "motion_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

Probes stackProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

// Card tower: tents of two leaning cards, a level card from the ridge of each to the next, one tent fewer on
// each level.

constexpr double kCardLength = .4, kCardDepth = .25;       // [m]
constexpr double kCardLean = 25 * std::numbers::pi / 180;  // from the vertical
constexpr double kCardGap = .001;                          // between level cards [m]
constexpr int kCardSmashStep = 300;
constexpr double kCardSmashSeconds = 5;

Scene buildCards(const Arguments& arguments) {
  const int levels = whole(arguments, "levels");
  const double thick = value(arguments, "thickness"), density = value(arguments, "density");
  const double halfWidth = kCardLength / 2 * portable::sin(kCardLean) + thick / 2 * portable::cos(kCardLean);
  const double halfHeight = kCardLength / 2 * portable::cos(kCardLean) + thick / 2 * portable::sin(kCardLean);
  const double pitch = kCardLength + kCardGap;
  const Vec3 leaningHalf{thick / 2, kCardLength / 2, kCardDepth / 2};
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  double floor = 0;
  for (int level = 0; level < levels; ++level) {
    const int tents = levels - level;
    for (int i = 0; i < tents; ++i) {
      const double ridge = (i - .5 * (tents - 1)) * pitch;
      for (const double side : {-1.0, 1.0}) {
        BodyDef card = block(leaningHalf, {ridge + side * halfWidth, floor + halfHeight, 0}, density);
        card.orientation = fromAxisAngle(Vec3{0, 0, 1}, side * kCardLean);
        scene.bodies.push_back(card);
      }
    }
    floor += 2 * halfHeight;
    for (int i = 0; i + 1 < tents; ++i)
      scene.bodies.push_back(block({kCardLength / 2, thick / 2, kCardDepth / 2},
                                   {(i - .5 * (tents - 2)) * pitch, floor + thick / 2, 0}, density));
    floor += thick;
  }
  if (whole(arguments, "smash") == 1) {
    BodyDef ball;
    ball.name = "ball";
    ball.shape = Shape::sphere(.1);
    ball.density = density;
    ball.position = {-(levels * pitch / 2 + .3), .12, 0};
    ball.velocity = {5, 0, 0};
    addAt(scene, kCardSmashStep, {ball});
  }
  setFriction(scene, .7);
  return scene;
}

Probes cardProbes(const Arguments& arguments, const Scene& scene) {
  const bool smash = whole(arguments, "smash") == 1;
  Probes probes;
  if (smash) probes = smashProbes(scene, kCardSmashSeconds);
  probes.push_back(stackProbe(scene, smash ? kCardSmashSeconds : kNoBound));
  return probes;
}

std::vector<Claim> cardClaims(const Arguments& arguments) {
  const double height = whole(arguments, "levels") * kCardLength * portable::cos(kCardLean);
  std::vector<Claim> claims{
      atMost("max_drift_m", value(arguments, "thickness"), "no card moves by more than its thickness"),
      atMost("quarantined", 0, "every state stays finite")};
  if (whole(arguments, "smash") == 1)
    claims.push_back(
        atLeast("smash_top_drop_m", height / 2, "after the ball the top is below half its height"));
  return claims;
}

// Dominoes.

constexpr Vec3 kHalfDomino{.06, .5, .25};

Scene buildDominoes(const Arguments& arguments) {
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  const int dominoes = whole(arguments, "dominoes");
  const double size = value(arguments, "size"), rate = 1 / std::sqrt(size);
  for (int i = 0; i < dominoes; ++i) {
    BodyDef domino = block(
        size * kHalfDomino,
        size * Vec3{(i - .5 * (dominoes - 1)) * value(arguments, "spacing"), kHalfDomino.y, 0}, 600);
    domino.name = "domino" + std::to_string(i);
    scene.bodies.push_back(domino);
  }
  // The first one turns about its lower edge.
  const Vec3 spin{0, 0, -2 * rate};
  Event push;
  push.step = 60;
  push.setVelocity = {{"domino0", cross(spin, size * Vec3{-kHalfDomino.x, kHalfDomino.y, 0}), spin}};
  scene.events.push_back(push);
  return scene;
}

/// wave_speed: of the front between a quarter and three quarters of the row, over sqrt(g h).
class WaveProbe final : public Probe {
 public:
  WaveProbe(int dominoes, double spacing, double size)
      : dominoes_(dominoes), spacing_(spacing), size_(size) {}

  void afterStep(const World& world, const StepReport&) override {
    const auto passed = [&](double& time, double share) {
      if (time >= 0) return;
      const Quat q = world
                         .state(
                             world.findBody("domino" + std::to_string(static_cast<int>(share * dominoes_))))
                         .orientation;
      const double lean = portable::acos(std::min(1., rotate(q, Vec3{0, 1, 0}).y));
      if (lean > kLean)
        time = world.time() - world.params().dt * (lean - kLean) / std::max(lean - last_[share > .5], 1e-9);
      last_[share > .5] = lean;
    };
    passed(from_, .25), passed(to_, .75);
  }
  void finish(const World&, Metrics& metrics) override {
    if (to_ <= from_ || from_ < 0) return;
    const int between = static_cast<int>(.75 * dominoes_) - static_cast<int>(.25 * dominoes_);
    metrics["wave_speed"] = between * spacing_ * size_ / (to_ - from_) / std::sqrt(9.81 * size_);
  }

 private:
  static constexpr double kLean = .1;
  int dominoes_;
  double spacing_, size_, from_ = -1, to_ = -1, last_[2] = {0, 0};
};

Probes dominoProbes(const Arguments& arguments, const Scene& scene) {
  Probes probes;
  probes.push_back(fallenProbe(scene, {0, 1, 0}));
  probes.push_back(std::make_unique<WaveProbe>(whole(arguments, "dominoes"), value(arguments, "spacing"),
                                               value(arguments, "size")));
  return probes;
}

std::vector<Claim> dominoClaims(const Arguments& arguments) {
  return {within("fallen_ratio", 1, 1, "every domino falls"),
          atMost("penetration_max_m", .02 * value(arguments, "size"), "none rests in another"),
          atMost("quarantined", 0, "every state stays finite")};
}

// Corbelled arch: two piers whose courses reach further in, a lintel over the slit that is left.

constexpr double kCourseHeight = .5, kCorbel = .25, kPierWidth = 1.5, kSlit = .5, kArchDepth = .5;  // [m]

Scene buildArch(const Arguments& arguments) {
  const int courses = whole(arguments, "courses");
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  const double outer = kSlit / 2 + courses * kCorbel + kPierWidth;
  const auto place = [&](double halfLength, double x, int course) {
    scene.bodies.push_back(block(scale.length * Vec3{halfLength, kCourseHeight / 2, kArchDepth / 2},
                                 scale.length * Vec3{x, (course + .5) * kCourseHeight, 0}, scale.density));
  };
  for (int course = 0; course < courses; ++course) {
    const double half = (kPierWidth + (course + 1) * kCorbel) / 2;
    place(half, -(outer - half), course);
    place(half, outer - half, course);
  }
  place(outer, 0, courses);
  return scene;
}

std::vector<Claim> archClaims(const Arguments& arguments) {
  return standsClaims(.02 * scaleOf(arguments).length, "the lintel stays");
}

// Breakable beam on two pillars, boxes fall on it.

constexpr int kBeamBlocks = 11;

Scene buildBeam(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  for (int i = 0; i < kBeamBlocks; ++i) {
    BodyDef body = block({.5, .5, .25}, {i - .5 * (kBeamBlocks - 1), 0, 6}, 1);
    body.name = "beam" + std::to_string(i);
    scene.bodies.push_back(body);
    if (i == 0) continue;
    JointDef joint = ballJoint(i - 1, {.5, 0, 0}, i, {-.5, 0, 0}, "joint" + std::to_string(i));
    joint.type = JointType::Fixed;
    joint.breakTorque = value(arguments, "break_torque");
    scene.joints.push_back(joint);
  }
  for (const double side : {-1.0, 1.0}) {
    BodyDef pillar = block({.5, .5, 2.5}, {side * .5 * (kBeamBlocks - 1), 0, 2.5}, 1);
    pillar.motion = Motion::Static;
    pillar.name = side < 0 ? "pillar0" : "pillar1";
    scene.bodies.push_back(pillar);
  }
  for (int i = 0; i < whole(arguments, "boxes"); ++i) {
    BodyDef box = block({1, .5, .5}, {0, 0, 8.0 + 2 * i}, 1);
    box.name = "box" + std::to_string(i);
    scene.bodies.push_back(box);
  }
  scene.bodies.push_back(ground(kUpZ));
  setFriction(scene, .5);
  return scene;
}

Probes beamProbes(const Arguments&, const Scene&) { return {}; }

std::vector<Claim> beamClaims(const Arguments& arguments) {
  std::vector<Claim> claims{atMost("penetration_max_m", .05, "no box rests in another"),
                            atMost("joint_gap_max_m", .01, "joints that hold have no gap"),
                            atMost("quarantined", 0, "every state stays finite")};
  if (whole(arguments, "boxes") >= 5 && value(arguments, "break_torque") <= 810)
    claims.push_back(within("broken_joints", 1, kBeamBlocks - 2, "some joints break, not all"));
  if (whole(arguments, "boxes") == 0)
    claims.push_back(within("broken_joints", 0, 0, "the beam carries its own weight"));
  return claims;
}

}  // namespace

std::vector<Spec> structureSpecs() {
  Spec cards;
  cards.name = "card-tower";
  cards.doc =
      "A tower of leaning and level cards that friction holds; after 5 s a ball comes (AVBD paper, Figure 6; "
      "our dimensions).";
  cards.arguments = {count("levels", 5, 1, 20, "levels of tents"),
                     quantity("thickness", .004, .001, .02, "m", "of a card"),
                     quantity("density", 600, 1e-3, 1e7, "kg/m3", "of a card and of the ball"),
                     flag("smash", true, "1: the ball comes after 5 s")};
  cards.build = buildCards;
  cards.probes = cardProbes;
  cards.claims = cardClaims;
  cards.camera = overview;
  cards.steps = kCardSmashStep + 180;
  cards.iterations = 5;
  cards.substeps = 5;
  cards.smashStep = kCardSmashStep;
  cards.testArguments = {{"levels", 3}};
  cards.tags = {"friction", "smash"};

  Spec dominoes = cards;
  dominoes.name = "dominoes";
  dominoes.doc = "A row of dominoes; the first one is pushed after 1 s.";
  dominoes.arguments = {count("dominoes", 40, 2, 1000, "dominoes of 12 x 100 x 50 cm"),
                        quantity("spacing", .5, .2, .8, "m", "from one to the next"),
                        quantity("size", 1, .001, 1000, "1", "factor on all lengths")};
  dominoes.build = buildDominoes;
  dominoes.probes = dominoProbes;
  dominoes.claims = dominoClaims;
  dominoes.steps = 900;
  dominoes.iterations = 10;
  dominoes.substeps = 1;
  dominoes.smashStep = -1;
  dominoes.testArguments = {{"dominoes", 10}};
  dominoes.testSteps = 420;
  dominoes.tags = {"friction"};

  Spec arch = dominoes;
  arch.name = "corbel-arch";
  arch.doc =
      "A corbelled arch: courses that reach further in, a lintel on top, held by weight and friction alone.";
  arch.arguments = stackArguments({count("courses", 8, 1, 40, "courses of a pier")}, 2000);
  arch.build = buildArch;
  arch.probes = stackProbes;
  arch.claims = archClaims;
  arch.steps = 600;
  arch.iterations = 4;
  arch.testArguments = {};
  arch.testSteps = 300;
  arch.tags = {"stack"};

  Spec beam = arch;
  beam.name = "breakable-beam";
  beam.doc =
      "A beam of eleven blocks on fixed joints that break, two pillars, five boxes fall on it (avbd-demo3d).";
  beam.arguments = {quantity("break_torque", 810, 1, 1e9, "N m", "torque at which a joint breaks"),
                    count("boxes", 5, 0, 20, "boxes that fall")};
  beam.build = buildBeam;
  beam.probes = beamProbes;
  beam.claims = beamClaims;
  beam.iterations = 10;
  beam.testSteps = 0;
  beam.tags = {"joint", "break"};

  return {cards, dominoes, arch, beam};
}

}  // namespace rubble::scenes

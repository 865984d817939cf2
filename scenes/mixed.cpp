/// Worlds of jointed bodies and deformable objects. Joints are held as well as without the deformables: a
/// probe steps the same world without them in parallel.
#include <cmath>
#include <numbers>
#include <optional>

#include "families.h"
#include "grains.h"
#include "joint_probes.h"
#include "math/portable.h"
#include "ragdoll.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kY{0, 1, 0};

/// gap_ratio: mean joint gap over the run, over that of the scene without deformables, or over 2 um if that
/// is larger. 2 um is a few roundings of a float of the size of a robot.
class TwinProbe final : public Probe {
 public:
  explicit TwinProbe(Scene twin) : scene_(std::move(twin)) {}
  void start(const World& world) override {
    WorldOptions options;
    options.params = world.params();
    twin_.emplace(scene_, options);
  }
  void afterStep(const World& world, const StepReport&) override {
    twin_->step(), ++steps_;
    own_ += world.quality().jointGapMean, others_ += twin_->quality().jointGapMean;
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["gap_ratio"] = own_ / std::max(others_, kRoundOff * steps_);
  }

 private:
  Scene scene_;
  std::optional<World> twin_;
  static constexpr double kRoundOff = 2e-6;  // [m]
  double own_ = 0, others_ = 0;
  int steps_ = 0;
};

/// `instead`: rigid bodies in place of the deformables.
Probes twinProbes(Scene scene, std::vector<BodyDef> instead = {}) {
  scene.deformables.clear(), scene.attachments.clear();
  scene.bodies.insert(scene.bodies.end(), instead.begin(), instead.end());
  Probes probes;
  probes.push_back(std::make_unique<TwinProbe>(std::move(scene)));
  return probes;
}

Spec mixedSpec(const std::string& name, const std::string& doc, std::vector<Argument> arguments,
               Scene (*build)(const Arguments&), Probes (*probes)(const Arguments&, const Scene&)) {
  Spec spec;
  spec.name = name, spec.doc = doc;
  spec.arguments = std::move(arguments);
  spec.build = build, spec.probes = probes;
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        atMost("gap_ratio", 1.2,
               "joint gaps are no larger than with rigid bodies or none in their place, or than 2 um"),
        atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = overview;
  spec.steps = 240;
  spec.tags = {"joint", "soft"};
  return spec;
}

// Ragdolls on a trampoline.

constexpr double kBed = 4;  // [m]

Scene buildTrampoline(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ, -2));
  const int ragdolls = whole(arguments, "ragdolls"), cells = whole(arguments, "cells");
  for (int i = 0; i < ragdolls; ++i) {
    const double angle = 2 * std::numbers::pi * i / ragdolls, far = ragdolls > 1 ? .9 : 0;
    addRagdoll(scene, {far * portable::cos(angle), far * portable::sin(angle), .5 + .2 * i}, 1.3 * i,
               "ragdoll" + std::to_string(i));
  }
  ClothDef bed = clothSheet({-kBed / 2, -kBed / 2, 0}, {kBed, 0, 0}, {0, kBed, 0}, cells, cells);
  for (int i = 0; i < static_cast<int>(bed.vertices.size()); ++i) {
    const Vec3& v = bed.vertices[static_cast<std::size_t>(i)];
    if (std::max(std::fabs(v.x), std::fabs(v.y)) > .499 * kBed) bed.fixed.push_back(i);
  }
  bed.thickness = 5e-3, bed.youngsModulus = 5e6;
  scene.deformables.push_back(bed);
  return scene;
}
Probes trampolineProbes(const Arguments&, const Scene& scene) {
  BodyDef plate = held(box({kBed / 2, kBed / 2, .1}, {0, 0, -.1}, 1));
  return twinProbes(scene, {plate});
}

// Robot arms in a shower of sand.

Scene buildArms(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  const int arms = whole(arguments, "arms");
  for (int k = 0; k < arms; ++k) {
    int before = kWorld;
    for (int i = 0; i < 5; ++i) {
      const std::string name = std::to_string(k) + "." + std::to_string(i);
      const double width = .09 - .012 * i;
      const int part = put(scene, box({width, width, .2}, {1.2 * k, 0, .3 + .42 * i}, 12 - 2 * i),
                           "link" + name);
      JointAxis& axis = join(scene, JointType::Hinge, part, before, {1.2 * k, 0, .09 + .42 * i},
                             i == 0 ? kUpZ : kY, "axis" + name)
                            .axes[0];
      axis.min = -2.5, axis.max = 2.5;
      axis.driveStiffness = kHard, axis.maxDriveForce = 800;
      before = part;
    }
  }
  for (int step = 0; step < 240; ++step) {
    Event event;
    event.step = step;
    for (int k = 0; k < arms; ++k)
      for (int i = 0; i < 5; ++i)
        event.setJoint.push_back({"axis" + std::to_string(k) + "." + std::to_string(i),
                                  0,
                                  .5 * portable::sin(step / 30. + i + k),
                                  {},
                                  {},
                                  {}});
    scene.events.push_back(event);
  }
  const int side = whole(arguments, "side");
  scene.deformables.push_back(sandBlock({-.1, -.1, 2.6}, side, side, side, .02));
  return scene;
}
Probes armProbes(const Arguments&, const Scene& scene) { return twinProbes(scene); }

// Chains that swing among soft balls.

constexpr double kJelly = .25;  // [m]
Vec3 jellyAt(int chain) { return {-1.5 - .1 * chain, .6 * chain, .3}; }

Scene buildChains(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  const int links = whole(arguments, "links");
  for (int k = 0; k < 3; ++k) {
    int before = kWorld;
    for (int i = 0; i < links; ++i) {
      const Vec3 top{.2 * i - 1.5, .6 * k, 2.2};
      const int part = put(scene, rod(top, top + Vec3{.18, 0, 0}, .03, i + 1 == links ? 10 : .4));
      join(scene, JointType::Ball, part, before, top - Vec3{.01, 0, 0});
      before = part;
    }
    scene.deformables.push_back(tetBall(jellyAt(k), kJelly, 5));
  }
  return scene;
}
Probes chainProbes(const Arguments&, const Scene& scene) {
  std::vector<BodyDef> balls;
  for (int k = 0; k < 3; ++k) balls.push_back(ball(kJelly, jellyAt(k), 65));
  return twinProbes(scene, balls);
}

}  // namespace

std::vector<Spec> mixedSpecs() {
  Spec trampoline = mixedSpec(
      "mixed-trampoline", "Ragdolls fall on a trampoline of cloth.",
      {count("ragdolls", 4, 1, 12, "ragdolls"), count("cells", 24, 8, 200, "cells along an edge of the bed")},
      buildTrampoline, trampolineProbes);
  trampoline.testArguments = {{"ragdolls", 2}, {"cells", 16}};
  trampoline.testSteps = 150;
  Spec arms = mixedSpec(
      "mixed-arms", "Robot arms that wave in a shower of sand.",
      {count("arms", 2, 1, 8, "arms"), count("side", 10, 2, 60, "particles along an edge of the block")},
      buildArms, armProbes);
  arms.testArguments = {{"side", 6}};
  Spec chains = mixedSpec("mixed-chains", "Chains with a weight at the end swing into soft balls.",
                          {count("links", 10, 2, 60, "links of a chain")}, buildChains, chainProbes);
  return {trampoline, arms, chains};
}

}  // namespace rubble::scenes

/// Clay: a heavy ball dents a block that yields, and beside it one that does not.
#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

constexpr double kSide = .6, kHeight = .3, kBall = .12, kApart = .5;  // [m]
constexpr int kTakenStep = 150;

/// A block on the ground whose middle is at x.
TetSolidDef claySlab(double x, int cells) {
  TetSolidDef slab = tetBox({x - kSide / 2, -kSide / 2, 0}, {kSide, kSide, kHeight},
                            {cells, cells, std::max(1, cells / 2)});
  slab.youngsModulus = 5e5;
  slab.density = 1500;
  slab.viscosity = 500;
  return slab;
}

Scene buildDent(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  for (const double x : {-kApart, kApart}) {
    TetSolidDef slab = claySlab(x, whole(arguments, "cells"));
    slab.name = x < 0 ? "clay" : "twin";
    if (x < 0) slab.yieldStress = value(arguments, "yield_stress");
    scene.deformables.push_back(slab);
    BodyDef ball;
    ball.name = x < 0 ? "ball_clay" : "ball_twin";
    ball.shape = Shape::sphere(kBall);
    ball.density = 7800;
    ball.position = {x, 0, kHeight + kBall + value(arguments, "drop")};
    scene.bodies.push_back(ball);
  }
  Event taken;
  taken.step = kTakenStep;
  taken.remove = {"ball_clay", "ball_twin"};
  scene.events.push_back(taken);
  return scene;
}

/// Depth of the lowest of the vertices that are on top at rest [m].
double dentOf(const World& world, int object) {
  const DeformableId id = world.deformableAt(object);
  const std::vector<Vec3>&rest = common(world.definition(id)).vertices, now = world.positions(id);
  double deepest = 0;
  for (std::size_t v = 0; v < now.size(); ++v)
    if (rest[v].z > .999 * kHeight) deepest = std::max(deepest, kHeight - now[v].z);
  return deepest;
}

/// Dents of both blocks: at the deepest, at the end, and what share of the one the other is.
class DentProbe : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    for (int k = 0; k < 2; ++k) deepest_[k] = std::max(deepest_[k], dentOf(world, k));
  }
  void finish(const World& world, Metrics& metrics) override {
    for (int k = 0; k < 2; ++k) {
      const std::string name = k == 0 ? "clay" : "twin";
      const double now = dentOf(world, k);
      metrics[name + "_dent_peak_m"] = deepest_[k];
      metrics[name + "_dent_m"] = now;
      metrics[name + "_kept"] = deepest_[k] > 0 ? now / deepest_[k] : 0;
      metrics[name + "_volume_ratio"] = volumeInside(world, k) / (kSide * kSide * kHeight);
    }
  }

 private:
  double deepest_[2] = {0, 0};
};

Spec dentSpec() {
  Spec spec;
  spec.name = "soft-dent";
  spec.doc =
      "A ball of 56 kg falls on a block of clay, another on an elastic twin of it; when both are gone the "
      "clay keeps its dent.";
  spec.arguments = {count("cells", 12, 4, 60, "cells along an edge of a block"),
                    quantity("yield_stress", 1e4, 1e3, 1e6, "Pa", "of the clay"),
                    quantity("drop", .5, 0, 3, "m", "height that the balls fall")};
  spec.build = buildDent;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<DentProbe>());
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atLeast("clay_dent_m", .03, "the ball leaves a dent"),
                              atLeast("clay_kept", .55, "most of the deepest one"),
                              atLeast("twin_dent_peak_m", .04, "the elastic block was dented as well"),
                              atMost("twin_kept", .05, "and has come back"),
                              within("clay_volume_ratio", .99, 1.01, "the clay keeps its volume"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{0, -1.6, 1.35}, {0, 0, .15}}; };
  spec.travels = true;
  spec.steps = 300;
  spec.iterations = 10;
  spec.testArguments = {{"cells", 8}};
  spec.tags = {"soft", "contact"};
  return spec;
}

}  // namespace

std::vector<Spec> softClaySpecs() { return {dentSpec()}; }

}  // namespace rubble::scenes

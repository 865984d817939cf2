/// Strings in closed form: one that is stretched from the start and plucked, and one that hangs as a
/// catenary.
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

constexpr int kSegments = 40;

Vec3 middleOf(const World& world) { return world.positions(world.deformableAt(0))[kSegments / 2]; }

// Plucked: 1 m at rest, stretched by 1 %, in its first mode. Period 2 L / c, c^2 = T / (mass for each metre)
// = E strain (1 + strain) / density.

constexpr double kPlucked = .003, kStringModulus = 1.6e6, kStringDensity = 1000;

double pluckedPeriod(double strain) {
  return 2 * (1 + strain) / std::sqrt(kStringModulus * strain * (1 + strain) / kStringDensity);
}

Scene buildPlucked(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.gravity = {};
  CableDef string = straightCable({0, 0, 0}, {1, 0, 0}, kSegments);
  string.name = "string";
  string.radius = .002;
  string.youngsModulus = kStringModulus;
  string.density = kStringDensity;
  for (const Vec3& x : string.vertices)
    string.start.push_back(
        {x.x * (1 + value(arguments, "strain")), 0, kPlucked * portable::sin(std::numbers::pi * x.x)});
  string.fixed = {0, kSegments};
  scene.deformables.push_back(string);
  return scene;
}

/// Period of the middle, from the first to the last of the times at which it passes through the straight
/// line.
class PeriodProbe : public Probe {
 public:
  explicit PeriodProbe(double exact) : exact_(exact) {}
  void start(const World& world) override { height_ = middleOf(world).z, time_ = world.time(); }
  void afterStep(const World& world, const StepReport&) override {
    const double height = middleOf(world).z, time = world.time();
    if ((height > 0) != (height_ > 0)) {
      last_ = time_ + (time - time_) * height_ / (height_ - height);
      if (crossings_++ == 0) first_ = last_;
    }
    height_ = height, time_ = time;
  }
  void finish(const World&, Metrics& metrics) override {
    if (crossings_ > 1) metrics["period_ratio"] = 2 * (last_ - first_) / (crossings_ - 1) / exact_;
  }

 private:
  double exact_, height_ = 0, time_ = 0, first_ = 0, last_ = 0;
  int crossings_ = 0;
};

Spec pluckedSpec() {
  Spec spec;
  spec.name = "plucked-string";
  spec.doc =
      "A string that is stretched by 1 % from the start and plucked in its first mode: its period is that of "
      "its tension.";
  spec.arguments = {quantity("strain", .01, 1e-3, .1, "1", "authored stretch")};
  spec.build = buildPlucked;
  spec.probes = [](const Arguments& arguments, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<PeriodProbe>(pluckedPeriod(value(arguments, "strain"))));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("period_ratio", .98, 1.02, "all of the authored tension acts from the first step on")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.5, -1.2, .1}, {.5, 0, 0}}; };
  spec.steps = 240;
  spec.substeps = 16;
  spec.tags = {"soft"};
  return spec;
}

// Catenary: z = a (cosh(x / a) - 1) between two nails, a rope that hardly stretches. It starts there: what is
// missing of its tension shows as sag.

constexpr double kHalfSpan = 1, kCatenary = .8;  // a [m]

Scene buildCatenary(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  const int segments = whole(arguments, "segments");
  const double half = kCatenary * portable::sinh(kHalfSpan / kCatenary);
  CableDef rope = straightCable({-half, 0, 0}, {2 * half, 0, 0}, segments);
  rope.name = "rope";
  rope.radius = .005;
  rope.youngsModulus = 1e8;
  for (const Vec3& x : rope.vertices) {
    const double along = kCatenary * std::asinh(x.x / kCatenary);
    rope.start.push_back(
        {along, 0, kCatenary * (portable::cosh(along / kCatenary) - portable::cosh(kHalfSpan / kCatenary))});
  }
  rope.fixed = {0, segments};
  scene.deformables.push_back(rope);
  return scene;
}

Spec catenarySpec() {
  Spec spec;
  spec.name = "catenary";
  spec.doc = "A rope that hangs between two nails in the shape of a catenary stays there.";
  spec.arguments = {count("segments", kSegments, 4, 400, "pieces of the rope")};
  spec.build = buildCatenary;
  spec.probes = [](const Arguments&, const Scene&) {
    const double exact = kCatenary * (portable::cosh(kHalfSpan / kCatenary) - 1);
    const Measure sag{"sag_over_catenary", [=](const World& w) { return -lowestVertex(w) / exact; }};
    Probes probes;
    probes.push_back(endProbe({sag}));
    probes.push_back(peakProbe(0, {{"largest_sag_over_catenary", sag.of}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("sag_over_catenary", .98, 1.02, "it hangs as the closed form says"),
        atMost("largest_sag_over_catenary", 1.02, "and did not fall before its tension was there")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{0, -3, -.3}, {0, 0, -.4}}; };
  spec.steps = 240;
  spec.iterations = 10;
  spec.tags = {"soft"};
  return spec;
}

}  // namespace

std::vector<Spec> softStringSpecs() { return {pluckedSpec(), catenarySpec()}; }

}  // namespace rubble::scenes

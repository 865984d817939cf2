/// Contact of surfaces with themselves and one another: a strip that folds, a stack of sheets, pressed
/// balls, a chain of rings on a rope, a knot. surface_exact.h tests independently of the engine whether
/// surfaces cross.
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"
#include "surface_exact.h"

namespace rubble::scenes {
namespace {

/// Largest number of crossings, tested every `every` steps. Surfaces that have crossed do not separate by
/// themselves.
class CrossingProbe : public Probe {
 public:
  explicit CrossingProbe(int every) : every_(every) {}
  void afterStep(const World& world, const StepReport& report) override {
    deflected_ += report.deflectedVertices, held_ += report.heldVertices;
    if (report.step % every_ == 0) most_ = std::max(most_, countCrossings(world));
  }
  void finish(const World& world, Metrics& metrics) override {
    metrics["crossings_peak"] = std::max(most_, countCrossings(world));
    metrics["deflected"] = deflected_;
    metrics["held"] = held_;
  }

 private:
  int every_, most_ = 0, deflected_ = 0, held_ = 0;
};

Claim noCrossing() { return atMost("crossings_peak", 0, "no edge ever crosses a triangle (exact test)"); }

double highestVertex(const World& world) {
  double highest = -kNoBound;
  for (const DeformableId id : world.deformables())
    for (const Vec3& x : world.positions(id)) highest = std::max(highest, x.z);
  return highest;
}

// A strip that falls on its edge.

Scene buildFolds(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const int across = whole(arguments, "cells");
  ClothDef strip = clothSheet({-.15, 0, .05}, {.3, 0, 0}, {0, .06, 1.2}, across, 4 * across);
  strip.name = "strip";
  strip.thickness = 2e-3;
  strip.density = 200;
  scene.deformables.push_back(strip);
  return scene;
}

Spec foldsSpec() {
  Spec spec;
  spec.name = "cloth-folds";
  spec.doc = "A strip of cloth falls on its short edge and lays itself in folds.";
  spec.arguments = {count("cells", 10, 2, 200, "cells across the strip; four times as many along it")};
  spec.build = buildFolds;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<CrossingProbe>(10));
    probes.push_back(endProbe(
        {{"highest_m", highestVertex}, {"stretch", [](const World& w) { return largestStretch(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{noCrossing(), within("highest_m", .004, .3, "it lies in several layers"),
                              atMost("stretch", 1.3, "cloth hardly stretches"),
                              atMost("kinetic_energy_j", .01, "it comes to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.55, -.45, .4}, {0, .05, .06}}; };
  spec.steps = 1000;
  spec.iterations = 10;
  spec.testArguments = {{"cells", 5}};
  spec.testSteps = 300;
  spec.tags = {"cloth", "contact"};
  return spec;
}

// A stack of sheets.

/// Air between two sheets, over their thickness [1].
constexpr double kSheetAir = .02;

Scene buildStack(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const int layers = whole(arguments, "layers"), cells = whole(arguments, "cells");
  const double thickness = value(arguments, "thickness");
  for (int i = 0; i < layers; ++i) {
    ClothDef sheet = clothSheet({-.1, -.1, thickness * ((1 + kSheetAir) * i + .52)}, {.2, 0, 0}, {0, .2, 0},
                                cells, cells);
    sheet.thickness = thickness;
    sheet.density = 100;
    sheet.youngsModulus = 2e5;
    scene.deformables.push_back(sheet);
  }
  return scene;
}

Spec stackSpec() {
  Spec spec;
  spec.name = "cloth-stack";
  spec.doc = "Sheets of thick cloth, one above the other with a little air between them, settle to a stack.";
  spec.arguments = {count("layers", 30, 1, 1000, "sheets"), count("cells", 4, 1, 100, "cells along an edge"),
                    quantity("thickness", .01, 1e-3, .1, "m", "of a sheet")};
  spec.build = buildStack;
  spec.probes = [](const Arguments& arguments, const Scene&) {
    const double height = value(arguments, "layers") * value(arguments, "thickness"),
                 half = value(arguments, "thickness") / 2;
    Probes probes;
    probes.push_back(std::make_unique<CrossingProbe>(10));
    probes.push_back(endProbe(
        {{"height_over_thickness", [=](const World& w) { return (highestVertex(w) + half) / height; }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{noCrossing(),
                              within("height_over_thickness", .95, 1.05, "as high as its sheets are thick"),
                              atMost("kinetic_energy_j", .001, "it rests")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.2, -1.6, 1.1}, {0, 0, .5}}; };
  spec.steps = 1000;
  spec.iterations = 20;
  spec.testArguments = {{"layers", 10}, {"cells", 2}};
  spec.testSteps = 180;
  spec.tags = {"cloth", "contact", "stack"};
  return spec;
}

// Two balls under a lid.

Scene buildPress(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  const double radius = .2, half = .24;
  for (const Vec3& n : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}}) {
    BodyDef wall = block({.05, .05, .6}, n * (half + .05) + Vec3{0, 0, .6}, 1000);
    wall.shape.halfExtents = std::fabs(n.x) > 0 ? Vec3{.05, half + .1, .6} : Vec3{half + .1, .05, .6};
    wall.motion = Motion::Static;
    scene.bodies.push_back(wall);
  }
  for (const double z : {radius, 3.05 * radius}) {
    TetSolidDef ball = tetBall({0, 0, z}, radius, whole(arguments, "cells"));
    ball.youngsModulus = 3e4;
    ball.density = 500;
    ball.viscosity = 200;
    ball.collideSelf = true;
    scene.deformables.push_back(ball);
  }
  BodyDef lid = block({half - .01, half - .01, .05}, {0, 0, 4.4 * radius}, 1000);
  lid.name = "lid";
  lid.mass = value(arguments, "lid_mass");
  scene.bodies.push_back(lid);
  return scene;
}

Spec pressSpec() {
  Spec spec;
  spec.name = "soft-press";
  spec.doc = "Two squishy balls of 17 kg, one on the other in a shaft, under a lid.";
  spec.arguments = {count("cells", 6, 2, 60, "cells through a ball"),
                    quantity("lid_mass", 60, 1, 1000, "kg", "of the lid")};
  spec.build = buildPress;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<CrossingProbe>(10));
    probes.push_back(endProbe(
        {{"lid_height_m", [](const World& w) { return w.state(w.findBody("lid")).position.z; }},
         {"crushed_cells", [](const World& w) { return crushedCells(w, 0) + crushedCells(w, 1); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{noCrossing(),
                              within("lid_height_m", .4, .83, "the balls are pressed, and hold"),
                              atMost("kinetic_energy_j", .05, "all comes to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.7, -1, 1.9}, {0, 0, .4}}; };
  spec.steps = 1000;
  spec.iterations = 10;
  spec.testArguments = {{"cells", 4}};
  spec.testSteps = 240;
  spec.tags = {"soft", "contact"};
  return spec;
}

// An overhand knot under load: a trefoil that is open at its ends (Shastri 1992), over a straight rope.

constexpr double kRopeRadius = .01, kKnotLoad = .5;

Scene buildKnot(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -4));
  std::vector<Vec3> path;
  path.push_back({0, 0, 1.2});
  for (double t = -2.15; t <= 2.15; t += .01)
    path.push_back({.05 * (t * t * t - 3 * t), .03 * (t * t * t * t - 4 * t * t),
                    -.022 * (portable::pow(t, 5) - 10 * t)});
  path.push_back({0, 0, -1});
  // points at equal distances along it
  const double step = value(arguments, "segment_m");
  CableDef rope;
  rope.name = "rope";
  rope.radius = kRopeRadius;
  rope.youngsModulus = 1e6;
  rope.density = 500;
  rope.material = {.2, .2, 0};
  rope.vertices = {path[0]};
  double left = step;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double size = length(path[i + 1] - path[i]);
    double at = left;
    for (; at <= size; at += step) rope.vertices.push_back(path[i] + (path[i + 1] - path[i]) * (at / size));
    left = at - size;
  }
  rope.fixed = {0};
  BodyDef load;
  load.name = "load";
  load.shape = Shape::sphere(.05);
  load.mass = kKnotLoad;
  load.position = rope.vertices.back() - Vec3{0, 0, .05};
  scene.bodies.push_back(load);
  AttachmentDef hook;
  hook.vertices = {int(rope.vertices.size()) - 1};
  hook.body = int(scene.bodies.size()) - 1;
  scene.attachments.push_back(hook);
  scene.deformables.push_back(rope);
  return scene;
}

Spec knotSpec() {
  Spec spec;
  spec.name = "rope-knot";
  spec.doc =
      "A load pulls an overhand knot tight; the knot holds as long as the rope does not pass through itself.";
  spec.arguments = {quantity("segment_m", .02, .005, .05, "m", "length of a segment of the rope")};
  spec.build = buildKnot;
  spec.probes = [](const Arguments& arguments, const Scene& scene) {
    const double whole = value(arguments, "segment_m") *
                         double(common(scene.deformables[0]).vertices.size() - 1);
    Probes probes;
    probes.push_back(
        peakProbe(0, {{"closest_deficit", [](const World& w) { return 1 - closestSegments(w); }}}));
    probes.push_back(endProbe({{"in_knot_m",
                                [whole](const World& w) {
                                  const std::vector<Vec3> x = w.positions(w.deformableAt(0));
                                  return whole - length(x.back() - x.front());
                                }},
                               {"stretch", [](const World& w) { return largestStretch(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{within("in_knot_m", .05, .6, "the knot is tight, and takes up rope"),
                              atMost("closest_deficit", .5, "rope keeps half its thickness at least"),
                              atMost("stretch", 1.2, "rope hardly stretches")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.35, -1.9, .1}, {0, 0, -.15}}; };
  spec.steps = 1000;
  spec.iterations = 10;
  spec.testSteps = 300;
  spec.tags = {"rope", "contact"};
  return spec;
}

// Rings on a rope.

constexpr double kRingSize = .08;

constexpr double kSpan = .54, kSag = .45;
double ropeHeight(double x) { return -kSag * (1 - x * x / (kSpan * kSpan)); }

CableDef ringAround(const Vec3& center, int segments) {
  CableDef ring;
  ring.closed = true;
  ring.radius = kRopeRadius;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    ring.vertices.push_back(center + Vec3{0, kRingSize * portable::cos(angle),
                                          kRingSize * portable::sin(angle) - .6 * kRingSize});
  }
  return ring;
}

Scene buildRings(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -1.5));
  const int segments = whole(arguments, "segments"), rings = whole(arguments, "rings");
  CableDef rope;
  for (int i = 0; i <= segments; ++i) {
    const double x = kSpan * (2. * i / segments - 1);
    rope.vertices.push_back({x, 0, ropeHeight(x)});
  }
  rope.name = "rope";
  rope.radius = kRopeRadius;
  rope.fixed = {0, segments};
  scene.deformables.push_back(rope);
  for (int i = 0; i < rings; ++i) {
    const double x = -.35 + .7 * (i + .5) / rings;
    scene.deformables.push_back(ringAround({x, 0, ropeHeight(x)}, 16));
  }
  return scene;
}

/// The rope is closed by a line far above.
double worstLinking(const World& world) {
  std::vector<Vec3> rope = world.positions(world.deformableAt(0));
  rope.push_back(rope.back() + Vec3{0, 0, 100});
  rope.push_back(rope.front() + Vec3{0, 0, 100});
  double worst = kNoBound;
  const int count = int(world.deformables().size());
  for (int i = 1; i < count; ++i)
    worst = std::min(worst, std::fabs(linkingNumber(rope, world.positions(world.deformableAt(i)))));
  return worst;
}

Spec ringsSpec() {
  Spec spec;
  spec.name = "rope-rings";
  spec.doc = "Rings of rope fall along a slack rope that runs through them and heap up at its lowest point.";
  spec.arguments = {count("segments", 60, 10, 1000, "segments of the rope"),
                    count("rings", 5, 1, 12, "rings on it")};
  spec.build = buildRings;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(
        peakProbe(0, {{"stretch_peak", [](const World& w) { return largestStretch(w, 0); }},
                      {"closest_deficit", [](const World& w) { return 1 - closestSegments(w); }}}));
    probes.push_back(endProbe({{"linking_least", worstLinking}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        within("linking_least", .99, 1.01, "every ring is still on the rope (linking number)"),
        atMost("closest_deficit", .5, "ropes keep half their thickness at least"),
        atMost("stretch_peak", 1.2, "rope hardly stretches")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.5, -1.4, .2}, {0, 0, -.4}}; };
  spec.steps = 1000;
  spec.iterations = 10;
  spec.testSteps = 240;
  spec.tags = {"rope", "contact"};
  return spec;
}

}  // namespace

std::vector<Spec> softContactSpecs() {
  Spec high = variant(stackSpec(), "cloth-stack-100", "A hundred sheets of thick cloth settle to a stack.",
                      {{"layers", 100}});
  high.iterations = 40;
  high.tags.push_back("scale");
  return {foldsSpec(), stackSpec(), high, pressSpec(), ringsSpec(), knotSpec()};
}

}  // namespace rubble::scenes

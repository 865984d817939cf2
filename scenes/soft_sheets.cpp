/// Cloth, ropes and nets: cloth over a sphere, a trampoline, a flag on a jointed pole, springs of very
/// different stiffness, a capstan. Springs and flag: figures 4 and 5 of Giles et al. 2025, with our own
/// numbers where the paper gives none.
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

// Cloth over a sphere.

Scene buildDrape(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  BodyDef sphere = ground(kUpZ);
  sphere.name = "sphere";
  sphere.shape = Shape::sphere(.3);
  scene.bodies.push_back(sphere);
  const int cells = whole(arguments, "cells");
  ClothDef cloth = clothSheet({-.5, -.5, .35}, {1, 0, 0}, {0, 1, 0}, cells, cells);
  cloth.name = "cloth";
  cloth.thickness = 2e-3;
  cloth.density = 150;
  scene.deformables.push_back(cloth);
  return scene;
}

Spec drapeSpec() {
  Spec spec;
  spec.name = "cloth-sphere";
  spec.doc = "A square of cloth falls on a sphere and stays there.";
  spec.arguments = {count("cells", 20, 4, 400, "cells along an edge")};
  spec.build = buildDrape;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe(
        {{"lowest_m", lowestVertex}, {"stretch", [](const World& w) { return largestStretch(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{within("lowest_m", -.4, -.1, "it hangs down around the sphere"),
                              atMost("stretch", 1.1, "cloth hardly stretches"),
                              atMost("penetration_max_m", 2e-3, "on the sphere, not in it"),
                              atMost("kinetic_energy_j", .02, "it comes to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.1, -1.5, .9}, {0, 0, 0}}; };
  spec.travels = true;
  spec.steps = 300;
  spec.iterations = 10;
  spec.tags = {"cloth"};
  return spec;
}

// Trampoline.

Scene buildTrampoline(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -1));
  const int boxes = whole(arguments, "boxes");
  for (int i = 0; i < boxes; ++i) {
    BodyDef box = block({.2, .2, .2}, {-.4 + .4 * (i % 3), .1 * (i % 3), .6 + .5 * i}, 1000);
    box.mass = 10;
    scene.bodies.push_back(box);
  }
  scene.deformables.push_back(heldSheet(2, 0, whole(arguments, "cells")));
  return scene;
}

Spec trampolineSpec() {
  Spec spec;
  spec.name = "trampoline";
  spec.doc =
      "Boxes of 10 kg fall on a sheet of 2 m that is held at its edges; each box weighs as much as the whole "
      "sheet and more.";
  spec.arguments = {count("cells", 20, 8, 200, "cells along an edge"), count("boxes", 3, 1, 3, "boxes")};
  spec.build = buildTrampoline;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe({{"sag_m", [](const World& w) { return -lowestVertex(w); }}}));
    probes.push_back(meanProbe(6, {{"lift_over_weight", [](const World& w) {
                                      double weight = 0;
                                      for (const BodyId id : w.bodies())
                                        weight += w.massOf(id).mass * length(w.gravity());
                                      return liftOfVertices(w) / weight;
                                    }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{within("lift_over_weight", .99, 1.01, "the sheet carries the boxes"),
                              within("sag_m", .1, .5, "it gives way, and holds"),
                              atMost("penetration_max_m", 2e-3, "boxes lie on the sheet"),
                              atMost("kinetic_energy_j", .1, "all come to rest")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{2.2, -3, 1.6}, {0, 0, 0}}; };
  spec.steps = 480;
  spec.iterations = 10;
  spec.tags = {"cloth"};
  return spec;
}

// Masses between two walls, springs of very different stiffness in turn (figure 4).

constexpr double kSoftSpring = 100;

NetDef springChain(int masses, double ratio, bool held) {
  NetDef net;
  net.name = "springs";
  net.collide = false;
  net.masses = {1};
  for (int i = 0; i < masses; ++i) net.vertices.push_back({double(i), 0, 0});
  for (int i = 0; i + 1 < masses; ++i)
    net.edges.push_back({i, i + 1, i % 2 ? kSoftSpring : kSoftSpring * ratio});
  net.fixed = {0};
  if (held) net.fixed.push_back(masses - 1);
  return net;
}

Scene buildSprings(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -20));
  scene.deformables.push_back(springChain(whole(arguments, "masses") + 2, value(arguments, "ratio"), true));
  return scene;
}

/// Largest |elongation| of the stiff springs over their length.
double stiffStretch(const World& w) {
  const std::vector<Vec3> x = w.positions(w.deformableAt(0));
  double worst = 0;
  for (std::size_t i = 0; i + 1 < x.size(); i += 2)
    worst = std::max(worst, std::fabs(length(x[i] - x[i + 1]) - 1));
  return worst;
}

Spec springsSpec() {
  Spec spec;
  spec.name = "net-ratio";
  spec.doc =
      "Ten masses between two walls, joined by springs of 1e6 and 100 N/m in turn (figure 4 of the paper).";
  spec.arguments = {
      count("masses", 10, 2, 200, "masses"),
      quantity("ratio", 1e4, 1, 1e6, "1", "stiffness of every second spring over that of the others")};
  spec.build = buildSprings;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(peakProbe(1, {{"stiff_stretch_peak", stiffStretch}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{
        atMost("stiff_stretch_peak", .02, "stiff springs keep their length beside soft ones")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{5.5, -16, 0}, {5.5, 0, -3}}; };
  spec.travels = true;
  spec.steps = 600;
  spec.iterations = 5;
  spec.tags = {"soft", "ratio"};
  return spec;
}

// Three masses on two springs, the first held: the others swing (figure 2).

Scene buildSwing(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -20));
  scene.deformables.push_back(springChain(3, value(arguments, "ratio"), false));
  return scene;
}

Spec springSwingSpec() {
  Spec spec;
  spec.name = "spring-swing";
  spec.doc = "Two masses swing on springs of 1e6 and 100 N/m (figure 2 of the paper).";
  spec.arguments = {
      quantity("ratio", 1e4, 1, 1e6, "1", "stiffness of the upper spring over that of the lower")};
  spec.build = buildSwing;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(peakProbe(0, {{"stiff_stretch_peak", stiffStretch}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("stiff_stretch_peak", .02, "the stiff spring keeps its length")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{0, -6, -.5}, {0, 0, -.8}}; };
  spec.travels = true;
  spec.steps = 600;
  spec.iterations = 5;
  spec.tags = {"soft", "ratio"};
  return spec;
}

// A flag of springs on a pole of jointed segments (figure 5).

constexpr int kPoleSegments = 20;
constexpr double kSegment = .1;

Scene buildFlag(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, -1));
  for (int i = 0; i < kPoleSegments; ++i) {
    BodyDef segment = block({.015, .015, kSegment / 2}, {0, 0, kSegment * (i + .5)}, 1500);
    segment.name = "pole" + std::to_string(i);
    scene.bodies.push_back(segment);
    JointDef joint;
    joint.type = JointType::Fixed;
    joint.bodyA = i == 0 ? kWorld : i;
    joint.bodyB = i + 1;
    joint.anchorA = i == 0 ? Vec3{} : Vec3{0, 0, kSegment / 2};
    joint.anchorB = {0, 0, -kSegment / 2};
    scene.joints.push_back(joint);
  }
  const int columns = whole(arguments, "columns"), rows = whole(arguments, "rows");
  NetDef flag;
  flag.name = "flag";
  flag.masses = {value(arguments, "mass") / (columns * rows)};
  const double width = 1.2, height = .8, top = kPoleSegments * kSegment - kSegment / 2;
  const auto at = [&](int i, int j) { return i + j * columns; };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      flag.vertices.push_back({.02 + width * i / (columns - 1), 0, top - height * j / (rows - 1)});
  const double k = value(arguments, "stiffness");
  const auto spring = [&](int a, int b, double factor) { flag.edges.push_back({a, b, k * factor}); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      if (i + 1 < columns) spring(at(i, j), at(i + 1, j), 1);
      if (j + 1 < rows) spring(at(i, j), at(i, j + 1), 1);
      if (i + 1 < columns && j + 1 < rows) {
        spring(at(i, j), at(i + 1, j + 1), .3);
        spring(at(i + 1, j), at(i, j + 1), .3);
        flag.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        flag.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
      }
    }
  scene.deformables.push_back(flag);
  for (const int row : {0, rows - 1}) {
    AttachmentDef hook;
    hook.vertices = {at(0, row)};
    const double z = flag.vertices[std::size_t(at(0, row))].z;
    hook.body = 1 + std::min(kPoleSegments - 1, int(z / kSegment));
    scene.attachments.push_back(hook);
  }
  return scene;
}

Spec flagSpec() {
  Spec spec;
  spec.name = "flag";
  spec.doc =
      "A flag of springs, hooked at two corners to a pole of 20 segments on hard joints (figure 5 of the "
      "paper has angular springs).";
  spec.arguments = {count("columns", 50, 4, 400, "vertices along the flag"),
                    count("rows", 30, 4, 400, "vertices across it"),
                    quantity("stiffness", 2e3, 1, 1e6, "N/m", "of a spring"),
                    quantity("mass", .1, 1e-3, 100, "kg", "of the flag")};
  spec.build = buildFlag;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(
        endProbe({{"hook_gap_m",
                   [](const World& w) {
                     double gap = 0;
                     for (const AttachmentId id : w.attachments()) gap = std::max(gap, w.state(id).gap);
                     return gap;
                   }},
                  {"stretch", [](const World& w) { return largestStretch(w, 0); }},
                  {"pole_tip_m", [](const World& w) { return w.state(w.findBody("pole19")).position.z; }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("hook_gap_m", .01 * kSegment, "hooks hold within 1 % of a segment"),
                              atMost("joint_gap_max_m", .01 * kSegment, "and so do the joints of the pole"),
                              within("pole_tip_m", 1.8, 1.97, "the pole bends and stands")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.6, -3.4, 1.6}, {.5, 0, 1.1}}; };
  spec.steps = 300;
  spec.iterations = 10;
  spec.testArguments = {{"columns", 25}, {"rows", 15}};
  spec.tags = {"cloth", "ratio", "joint"};
  return spec;
}

// Capstan: a rope over a bar, half a turn; it slips where the loads differ by more than exp(mu pi).

constexpr double kBar = .2, kRope = .005, kFree = .5, kLightLoad = 1;

Scene buildCapstan(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  CableDef rope;
  rope.name = "rope";
  rope.radius = kRope;
  rope.youngsModulus = 1e8;
  rope.density = 300;  // a hundredth of the light load hangs on either side
  const double reach = kBar + kRope, mu = value(arguments, "friction");
  const int free = whole(arguments, "segments"), bent = int(free * std::numbers::pi * kBar / kFree);
  for (int i = 0; i <= free; ++i) rope.vertices.push_back({-reach, 0, -kFree + kFree * i / free});
  for (int i = 1; i < bent; ++i) {
    const double angle = std::numbers::pi * (1 - double(i) / bent);
    rope.vertices.push_back({reach * portable::cos(angle), 0, reach * portable::sin(angle)});
  }
  for (int i = 0; i <= free; ++i) rope.vertices.push_back({reach, 0, -kFree * i / free});
  rope.material = {mu, mu, 0};
  BodyDef bar;
  bar.name = "bar";
  bar.motion = Motion::Static;
  bar.shape = Shape::capsule(kBar, .5);
  bar.orientation = fromAxisAngle(Vec3{1, 0, 0}, std::numbers::pi / 2);
  bar.material = rope.material;
  scene.bodies.push_back(bar);
  for (const double side : {-1., 1.}) {
    BodyDef load;
    load.name = side < 0 ? "light" : "heavy";
    load.shape = Shape::sphere(.05);
    load.mass = side < 0 ? kLightLoad : kLightLoad * value(arguments, "load_ratio");
    load.position = {side * reach, 0, -kFree - .05};
    scene.bodies.push_back(load);
    AttachmentDef hook;
    hook.vertices = {side < 0 ? 0 : int(rope.vertices.size()) - 1};
    hook.body = int(scene.bodies.size()) - 1;
    scene.attachments.push_back(hook);
  }
  scene.deformables.push_back(rope);
  return scene;
}

Spec capstanSpec() {
  Spec spec;
  spec.name = "capstan";
  spec.doc =
      "Two loads hang on a rope over a bar, half a turn: it holds up to a ratio of exp(pi mu) of the loads, "
      "here 4 % below, and slips above.";
  spec.arguments = {count("segments", 20, 5, 400, "segments of each free end"),
                    quantity("friction", .3, 0, 2, "1", "of rope on bar"),
                    quantity("load_ratio", 2.46, .1, 100, "1", "heavy over light load")};
  spec.build = buildCapstan;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe({{"heavy_drop_m", [](const World& w) {
                                  return -(kFree + .05) - w.state(w.findBody("heavy")).position.z;
                                }}}));
    return probes;
  };
  spec.claims = [](const Arguments& arguments) {
    const bool holds = value(arguments, "load_ratio") <
                       portable::exp(std::numbers::pi * value(arguments, "friction"));
    return std::vector<Claim>{
        holds ? within("heavy_drop_m", -.02, .1, "friction holds the heavy load")
              : atLeast("heavy_drop_m", .4, "the heavy load pulls the light one up to the bar")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{0, -2.4, .1}, {0, 0, -.25}}; };
  spec.travels = true;
  spec.steps = 240;
  spec.iterations = 10;
  spec.tags = {"rope", "friction"};
  return spec;
}

}  // namespace

std::vector<Spec> softSheetSpecs() {
  const Spec capstan = capstanSpec();
  return {drapeSpec(),
          trampolineSpec(),
          springsSpec(),
          springSwingSpec(),
          flagSpec(),
          capstan,
          variant(capstan, "capstan-slips",
                  "The capstan with loads whose ratio is 5 % above the threshold: it slips.",
                  {{"load_ratio", 2.7}})};
}

}  // namespace rubble::scenes

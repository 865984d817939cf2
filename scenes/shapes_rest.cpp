/// Scenes of shapes that come to rest: an arch of wedges, a drop of every kind, a heap of pebbles, a bowl.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "families.h"
#include "math/portable.h"
#include "probes.h"
#include "shape_parts.h"

namespace rubble::scenes {
namespace {

constexpr double kPi = std::numbers::pi;

// A half circle of wedges. The least thickness that stands is 0.1075 of the mean radius (Milankovitch 1907).

constexpr double kArchRadius = 5;
constexpr double kArchWidth = 1;

Scene buildVoussoirs(const Arguments& arguments) {
  const int count = whole(arguments, "voussoirs");
  const double thickness = value(arguments, "thickness") * kArchRadius;
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  const double inner = kArchRadius - thickness / 2, outer = kArchRadius + thickness / 2;
  for (int i = 0; i < count; ++i) {
    std::vector<Vec3> points;
    const double middle = kPi * (i + .5) / count;
    const Vec3 center = kArchRadius * Vec3{portable::cos(middle), 0, portable::sin(middle)};
    for (const int side : {i, i + 1})
      for (const double r : {inner, outer})
        for (const double y : {-kArchWidth / 2, kArchWidth / 2}) {
          const double angle = kPi * side / count;
          points.push_back(Vec3{r * portable::cos(angle), y, r * portable::sin(angle)} - center);
        }
    BodyDef stone;
    stone.name = "voussoir" + std::to_string(i);
    stone.shape = Shape::hull(std::move(points));
    stone.density = 2400;
    stone.position = center;
    scene.bodies.push_back(std::move(stone));
  }
  // masonry does not slide
  setFriction(scene, .8);
  return scene;
}

Probes voussoirProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

std::vector<Claim> voussoirClaims(const Arguments& arguments) {
  constexpr double kLimit = .1075;
  if (value(arguments, "thickness") > kLimit)
    return {within("top_drop_m", -.02, .02, "the crown stays"),
            atMost("max_drift_m", .03, "every stone stays"),
            atMost("quarantined", 0, "every state stays finite")};
  return {atLeast("top_drop_m", 1, "the crown falls: no line of thrust lies within the arch"),
          atMost("quarantined", 0, "every state stays finite")};
}

// Every kind falls on every kind of ground.

Scene buildEveryShape(const Arguments& arguments) {
  const int layers = whole(arguments, "layers");
  Scene scene = emptyScene(kUpZ, 9.81);
  // a tray of triangles: a flat floor with a rim
  constexpr int kCells = 24;
  constexpr double kSpacing = .4;
  std::vector<double> heights;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i)
      heights.push_back(i == 0 || j == 0 || i == kCells || j == kCells ? 1.5 : 0);
  BodyDef floor;
  floor.name = "ground";
  floor.motion = Motion::Static;
  floor.shape = Shape::heightField(kCells + 1, kCells + 1, {kSpacing, kSpacing, 0}, std::move(heights));
  floor.position = {-kCells * kSpacing / 2, -kCells * kSpacing / 2, 0};
  scene.bodies.push_back(floor);
  std::vector<Shape> shapes;
  for (int k = 0; k < 36; ++k) shapes.push_back(mixedShape(.3, k));
  int index = 0;
  for (int layer = 0; layer < layers; ++layer)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i, ++index) {
        BodyDef body;
        body.shape = shapes[std::size_t(index * 7 % 36)];
        body.material.rollingFriction = body.material.torsionalFriction = .01;
        body.position = {1.0 * (i - 2.5) + .05 * (layer % 3), 1.0 * (j - 2.5) - .04 * (layer % 2),
                         .8 + .9 * layer};
        body.orientation = fromAxisAngle(normalize(Vec3{1, .3 * i, .2 * j + .1}), .5 * index);
        scene.bodies.push_back(body);
      }
  return scene;
}

Probes everyShapeProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(insideProbe({-4.8, -4.8, 0}, {4.8, 4.8, 10}));
  return probes;
}

std::vector<Claim> everyShapeClaims(const Arguments&) {
  return {within("inside_ratio", 1, 1, "all stay in the tray"),
          atMost("penetration_p99_m", .005, "they lie on one another"),
          atMost("max_speed_m_s", .1, "and come to rest"),
          atMost("quarantined", 0, "every state stays finite")};
}

// A bowl, free to move, given by its distances; pebbles in it.

constexpr double kBowlRadius = 1, kBowlWall = .15;

double bowlDistance(const Vec3& p) {
  // a shell of half a sphere on a foot
  const double shell = std::fabs(length(p) - kBowlRadius) - kBowlWall / 2;
  const double half = std::max(shell, p.z);
  const double r = portable::hypot(p.x, p.y);
  const double foot = std::max({r - .5, p.z + .9, -1.15 - p.z});
  return std::min(half, foot);
}

Scene buildBowl(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef bowl;
  bowl.name = "bowl";
  bowl.shape = distanceShape({-1.2, -1.2, -1.25}, {1.2, 1.2, .15}, .05, bowlDistance);
  bowl.position = {0, 0, 1.15};
  scene.bodies.push_back(bowl);
  const int count = whole(arguments, "things");
  for (int i = 0; i < count; ++i) {
    BodyDef body;
    body.shape = mixedShape(.16, i);
    body.density = 500;
    body.material.rollingFriction = .005;
    body.position = {.28 * (i % 3 - 1), .28 * (i / 3 % 3 - 1), 1.1 + .35 * (i / 9)};
    scene.bodies.push_back(body);
  }
  return scene;
}

Probes bowlProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(insideProbe({-1, -1, .2}, {1, 1, 2.5}));
  return probes;
}

std::vector<Claim> bowlClaims(const Arguments&) {
  return {within("inside_ratio", 1, 1, "everything is in the bowl, and the bowl stands"),
          atMost("penetration_p99_m", .01, "nothing sinks into it"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> shapeRestSpecs() {
  Spec arch;
  arch.name = "voussoir-arch";
  arch.doc =
      "A half circle of wedge-shaped stones without mortar; it stands if it is thicker than 0.1075 of its "
      "radius.";
  arch.arguments = {count("voussoirs", 15, 5, 99, "stones, an odd number has a keystone"),
                    quantity("thickness", .12, .05, .5, "1", "of the arch over its mean radius")};
  arch.build = buildVoussoirs;
  arch.probes = voussoirProbes;
  arch.claims = voussoirClaims;
  arch.camera = overview;
  arch.steps = 600;
  arch.iterations = 4;
  arch.tags = {"stack", "shape"};
  const Spec thin = variant(arch, "voussoir-arch-thin", "The same arch, too thin to stand.",
                            {{"thickness", .095}});

  Spec every = arch;
  every.name = "every-shape";
  every.doc =
      "Boxes, cylinders, cones, hulls, capsules, spheres, rounded boxes and compounds fall into a tray of "
      "triangles.";
  every.arguments = {count("layers", 4, 1, 40, "layers of 36 bodies")};
  every.build = buildEveryShape;
  every.probes = everyShapeProbes;
  every.claims = everyShapeClaims;
  every.steps = 480;
  every.testArguments = {{"layers", 2}};
  every.testSteps = 360;
  every.tags = {"shape"};

  Spec bowl = every;
  bowl.name = "bowl";
  bowl.doc =
      "Things fall into a bowl that stands on its foot: a moving hollow body, given by its distances on a "
      "lattice.";
  bowl.arguments = {count("things", 27, 1, 45, "bodies that fall into it")};
  bowl.build = buildBowl;
  bowl.probes = bowlProbes;
  bowl.claims = bowlClaims;
  bowl.steps = 360;
  bowl.testArguments = {{"things", 18}};
  bowl.testSteps = 240;
  return {arch, thin, every, bowl};
}

}  // namespace rubble::scenes

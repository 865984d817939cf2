/// Columns: equal cubes, heavy on light, cubes that double. y up and g 9.81; z up and g 10 in those from
/// avbd-demo3d.
#include <algorithm>

#include "build.h"
#include "families.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfCube{.5, .5, .5};

/// `levels` unit cubes, named "cube0" from the ground up.
Scene column(int levels, const Scale& scale) {
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  for (int i = 0; i < levels; ++i) {
    BodyDef cube = block(scale.length * kHalfCube, scale.length * Vec3{0, i + .5, 0}, scale.density);
    cube.name = "cube" + std::to_string(i);
    scene.bodies.push_back(cube);
  }
  return scene;
}

Probes standingProbes(const Arguments&, const Scene& scene) {
  Probes result;
  result.push_back(stackProbe(scene, kNoBound));
  return result;
}

Scene buildTower(const Arguments& arguments) {
  return column(whole(arguments, "levels"), scaleOf(arguments));
}

std::vector<Claim> towerClaims(const Arguments& arguments) {
  // Measured in avbd-demo3d with k_start = m/dt^2 at 4 iterations: 40 cubes rest 0.18 m down, 10 cubes 0.013
  // m. The error of a layer grows with the layers above it.
  const double height = whole(arguments, "levels") / 40.0;
  constexpr double kMost = .02;
  return standsClaims(std::min(.18 * height * height + .002, kMost) * scaleOf(arguments).length,
                      "no lower than in the authors' demo with k_start = m/dt^2, and by 20 mm at most");
}

Scene buildMass(const Arguments& arguments) {
  const int light = whole(arguments, "levels");
  Scene scene = column(light + 1, scaleOf(arguments));
  scene.bodies.back().name = "heavy";
  scene.bodies.back().density *= value(arguments, "ratio");
  return scene;
}

std::vector<Claim> massClaims(const Arguments& arguments) {
  const double ratio = value(arguments, "ratio");
  const double drop = ratio <= 100 ? .05 : ratio <= 1000 ? .1 : .5;
  return standsClaims(drop * scaleOf(arguments).length,
                      "the heavy cube stays up: under 50 mm at 100, 100 mm at 1000, half a cube above");
}

Scene buildStackRatio(const Arguments& arguments) {
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, .5 * scale.length));
  double bottom = .5;
  double edge = 1;
  for (int i = 0; i < whole(arguments, "levels"); ++i, edge *= 2) {
    BodyDef cube = block(scale.length * edge * kHalfCube, scale.length * Vec3{0, 0, bottom + edge / 2},
                         scale.density);
    cube.name = "cube" + std::to_string(i);
    scene.bodies.push_back(cube);
    bottom += edge;
  }
  setFriction(scene, .5);
  return scene;
}

std::vector<Claim> stackRatioClaims(const Arguments& arguments) {
  return standsClaims(.03 * scaleOf(arguments).length,
                      "the top rests within 0.03 of its place at 10 iterations");
}

// Cubes that fall on one another.

Scene buildDrop(const Arguments& arguments) {
  const int levels = whole(arguments, "levels");
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, .5));
  for (int i = 0; i < levels; ++i) {
    BodyDef cube = block(kHalfCube, {0, 0, 1 + 1.5 * i}, value(arguments, "density"));
    cube.name = "cube" + std::to_string(i);
    scene.bodies.push_back(cube);
  }
  setFriction(scene, .5);
  return scene;
}

std::vector<Claim> dropClaims(const Arguments& arguments) {
  const double fall = .5 * (whole(arguments, "levels") - 1);
  return {within("top_drop_m", fall - .01, fall + .02, "the top rests within 2 cm of its place"),
          atMost("max_speed_m_s", .05, "it stands still"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> towerSpecs() {
  Spec tower;
  tower.name = "tower";
  tower.doc = "A single column of unit cubes left alone for 10 s.";
  tower.arguments = stackArguments({count("levels", 10, 1, 200, "cubes in the column")});
  tower.build = buildTower;
  tower.probes = standingProbes;
  tower.claims = towerClaims;
  tower.camera = overview;
  tower.steps = 600;
  tower.iterations = 4;
  tower.testArguments = {{"levels", 10}};
  tower.testSteps = 300;
  tower.tags = {"stack"};

  Spec mass = tower;
  mass.name = "mass";
  mass.doc = "Ten unit cubes with one on top that is many times heavier, 10 s.";
  mass.arguments = stackArguments(
      {quantity("ratio", 100, 1, 1e6, "1", "density of the top cube over that of the others"),
       count("levels", 10, 1, 100, "light cubes")});
  mass.build = buildMass;
  mass.claims = massClaims;
  mass.testArguments = {};
  mass.testSteps = 600;
  mass.tags = {"stack", "mass-ratio"};

  Spec ratio = tower;
  ratio.name = "stack-ratio";
  ratio.doc = "Four cubes with edges 1, 2, 4 and 8, the smallest (1/512 of the largest) below (avbd-demo3d).";
  ratio.arguments = stackArguments(
      {count("levels", 4, 1, 8, "cubes; each has twice the edge of the one below")}, 1);
  ratio.build = buildStackRatio;
  ratio.claims = stackRatioClaims;
  ratio.iterations = 10;
  ratio.testArguments = {};
  ratio.testSteps = 600;
  ratio.tags = {"stack", "mass-ratio"};

  Spec drop = tower;
  drop.name = "drop-stack";
  drop.doc = "Ten cubes half a metre apart fall into a stack (avbd-demo3d).";
  drop.arguments = {count("levels", 10, 1, 100, "cubes"),
                    quantity("density", 1, 1e-3, 1e7, "kg/m3", "of a cube")};
  drop.build = buildDrop;
  drop.claims = dropClaims;
  drop.iterations = 10;
  drop.testArguments = {};
  drop.testSteps = 0;

  return {
      tower,
      testedInFull(variant(tower, "tower-20", "A column of 20 unit cubes, 10 s.", {{"levels", 20}})),
      testedInFull(variant(tower, "tower-40", "A column of 40 unit cubes, 10 s.", {{"levels", 40}})),
      testedInFull(variant(tower, "tower-80", "A column of 80 unit cubes, 10 s.", {{"levels", 80}})),
      mass,
      variant(mass, "mass-1000-on-40", "Forty cubes under one of 1,000 times their mass, 10 s.",
              {{"ratio", 1000}, {"levels", 40}}),
      variant(mass, "mass-100", "Ten cubes under one of 100 times their mass, 10 s.", {{"ratio", 100}}),
      variant(mass, "mass-1000", "Ten cubes under one of 1,000 times their mass, 10 s.", {{"ratio", 1000}}),
      variant(mass, "mass-10000", "Ten cubes under one of 10,000 times their mass, 10 s.",
              {{"ratio", 10000}}),
      ratio,
      drop};
}

}  // namespace rubble::scenes

/// Plane pyramids of unit cubes. y up, g 9.81.
#include "build.h"
#include "families.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr double kHalf = .5;                // half edge of a cube [m]
constexpr double kPitchX = 1, kPitchZ = 2;  // free space between pyramids of a field [m]

void addPyramid(Scene& scene, int base, const Vec3& at, const Scale& scale) {
  for (int i = 0; i < base; ++i)
    for (int j = i; j < base; ++j) {
      const Vec3 position{(i + 1) * kHalf + 2 * (j - i) * kHalf - kHalf * base, (2 * i + 1) * kHalf, 0};
      scene.bodies.push_back(
          block(scale.length * Vec3{kHalf, kHalf, kHalf}, scale.length * (position + at), scale.density));
    }
}

Scene buildField(const Arguments& arguments, int nx, int nz) {
  const int base = whole(arguments, "base");
  const Scale scale = scaleOf(arguments);
  Scene scene = emptyScene(kUpY, 9.81);
  scene.bodies.push_back(ground(kUpY));
  for (int ix = 0; ix < nx; ++ix)
    for (int iz = 0; iz < nz; ++iz)
      addPyramid(scene, base,
                 {(ix - .5 * (nx - 1)) * (2 * kHalf * base + kPitchX), 0,
                  (iz - .5 * (nz - 1)) * (2 * kHalf + kPitchZ)},
                 scale);
  return scene;
}

Scene buildOne(const Arguments& arguments) { return buildField(arguments, 1, 1); }
Scene buildMany(const Arguments& arguments) {
  return buildField(arguments, whole(arguments, "nx"), whole(arguments, "nz"));
}

Probes probes(const Arguments&, const Scene& scene) {
  Probes result;
  result.push_back(stackProbe(scene, kNoBound));
  return result;
}

std::vector<Claim> claims(const Arguments& arguments) {
  // The best engine measured: 0.171 m at base 50, 0.68 m at base 100. Half a cube is the limit of
  // bricks_lost.
  const double layers = whole(arguments, "base") / 50.0;
  return standsClaims((.17 * layers * layers + .005) * scaleOf(arguments).length,
                      "it stands, no lower than in the best engine measured");
}

// Bricks that fall into a pyramid from above their places, from avbd-demo3d (z up, g 10, density 1, friction
// 0.5).

Scene buildDrop(const Arguments& arguments) {
  const int rows = whole(arguments, "rows");
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows - row; ++column)
      scene.bodies.push_back(block({.5, .25, .25}, {1.01 * column + .5 * row - .5 * rows, 0, .85 * row + .5},
                                   value(arguments, "density")));
  setFriction(scene, .5);
  return scene;
}

std::vector<Claim> dropClaims(const Arguments& arguments) {
  // The top starts at 0.85 (rows - 1) + 0.5 and should rest at 0.5 (rows - 0.5).
  const double fall = .35 * (whole(arguments, "rows") - 1) + .25;
  return {within("top_drop_m", fall - .01, fall + .03, "the top rests within 3 cm of its place"),
          atMost("max_speed_m_s", .05, "it stands still"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> pyramidSpecs() {
  Spec pyramid;
  pyramid.name = "pyramid";
  pyramid.doc = "A plane pyramid of unit cubes left alone for 10 s (Box2D benchmark).";
  pyramid.arguments = stackArguments({count("base", 20, 1, 400, "cubes in the lowest layer")});
  pyramid.build = buildOne;
  pyramid.probes = probes;
  pyramid.claims = claims;
  pyramid.camera = overview;
  pyramid.steps = 600;
  pyramid.iterations = 4;
  pyramid.testArguments = {{"base", 10}};
  pyramid.testSteps = 300;
  pyramid.tags = {"stack"};

  Spec many = pyramid;
  many.name = "many-pyramids";
  many.doc =
      "A field of 14 x 14 pyramids of base 10: 10,780 cubes in 196 islands (Box2D benchmark, in space).";
  many.arguments = stackArguments({count("base", 10, 1, 100, "cubes in the lowest layer of a pyramid"),
                                   count("nx", 14, 1, 200, "pyramids along x"),
                                   count("nz", 14, 1, 200, "pyramids along z")});
  many.build = buildMany;
  many.steps = 200;
  many.testArguments = {{"base", 5}, {"nx", 2}, {"nz", 2}};
  many.testSteps = 120;
  many.tags = {"stack", "scale"};

  Spec drop = pyramid;
  drop.name = "drop-pyramid";
  drop.doc = "A pyramid of bricks that fall into their places from up to 5 m above (avbd-demo3d).";
  drop.arguments = {count("rows", 16, 1, 100, "rows of bricks"),
                    quantity("density", 1, 1e-3, 1e7, "kg/m3", "of a brick")};
  drop.build = buildDrop;
  drop.claims = dropClaims;
  drop.iterations = 10;
  drop.testArguments = {{"rows", 8}};
  drop.testSteps = 0;

  return {pyramid, variant(pyramid, "pyramid-50", "A pyramid of base 50: 1,275 cubes, 10 s.", {{"base", 50}}),
          variant(pyramid, "pyramid-100", "A pyramid of base 100: 5,050 cubes, 10 s.", {{"base", 100}}), many,
          drop};
}

}  // namespace rubble::scenes

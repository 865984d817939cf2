/// Jointed plates on a sheet of cloth: 35,000 bodies and 72,000 joints on 10,000 vertices, the counts of
/// figure 14 of Giles et al. 2025; forms, masses and stiffness, which the paper does not give, are our own.
#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

/// A plate is a lattice of cubes, each held to its neighbors by a ball joint in the middle of their faces.
constexpr int kPlateX = 5, kPlateY = 4, kPlateZ = 2;
constexpr double kPitch = .1,
                 kHalfCube = .049;  // [m]; vertices of the sheet, of radius 0.003 m, do not fit between cubes
constexpr double kCell = .1;        // of the sheet [m]
constexpr double kGroundLevel = -5;                                          // [m]
constexpr double kPlateSpaceX = .58, kPlateSpaceY = .48, kPlateSpaceZ = .4;  // [m]

void addPlate(Scene& scene, const Vec3& corner) {
  const int first = static_cast<int>(scene.bodies.size());
  const auto index = [&](int x, int y, int z) { return first + (z * kPlateY + y) * kPlateX + x; };
  for (int z = 0; z < kPlateZ; ++z)
    for (int y = 0; y < kPlateY; ++y)
      for (int x = 0; x < kPlateX; ++x) {
        scene.bodies.push_back(
            block({kHalfCube, kHalfCube, kHalfCube}, corner + kPitch * Vec3{x + .5, y + .5, z + .5}, 200));
        const auto join = [&](int other, const Vec3& towards) {
          scene.joints.push_back(
              ballJoint(index(x, y, z), -kPitch / 2 * towards, other, kPitch / 2 * towards));
        };
        if (x > 0) join(index(x - 1, y, z), {1, 0, 0});
        if (y > 0) join(index(x, y - 1, z), {0, 1, 0});
        if (z > 0) join(index(x, y, z - 1), {0, 0, 1});
      }
}

Scene buildPlates(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, kGroundLevel));
  const int cells = whole(arguments, "cells"), plates = whole(arguments, "plates");
  const double side = cells * kCell;
  ClothDef sheet = clothSheet({-side / 2, -side / 2, 0}, {side, 0, 0}, {0, side, 0}, cells, cells);
  sheet.name = "sheet";
  sheet.thickness = 6e-3;
  sheet.youngsModulus = 2e7;
  sheet.density = 500;
  sheet.fixed = verticesWhere(sheet, [side](const Vec3& x) {
    return std::max(std::fabs(x.x), std::fabs(x.y)) > side / 2 - .5 * kCell;
  });
  scene.deformables.push_back(sheet);
  // layers over the inner part of the sheet
  const int columns = std::max(1, static_cast<int>(.85 * side / kPlateSpaceX)),
            rows = std::max(1, static_cast<int>(.85 * side / kPlateSpaceY));
  for (int i = 0; i < plates; ++i) {
    const int x = i % columns, y = i / columns % rows, z = i / (columns * rows);
    // neighboring layers do not lie cube over cube
    const Vec3 shift{.03 * (z % 3), -.02 * (z % 4), .1};
    addPlate(scene, shift + Vec3{kPlateSpaceX * (x - .5 * columns), kPlateSpaceY * (y - .5 * rows),
                                 kPlateSpaceZ * z});
  }
  return scene;
}

/// Bodies whose center lies below the vertex of the sheet that is nearest to them as seen from above.
double bodiesThrough(const World& world, int cells) {
  const std::vector<Vec3> x = world.positions(world.deformableAt(0));
  constexpr int kReach = 4;  // the sheet sags inwards by less than so many cells
  double through = 0;
  for (const BodyId id : world.bodies()) {
    if (world.definition(id).motion != Motion::Dynamic) continue;
    const Vec3 p = world.state(id).position;
    const auto cellAt = [&](double a) {
      return std::clamp(static_cast<int>(std::lround(a / kCell + .5 * cells)), 0, cells);
    };
    const int ci = cellAt(p.x), cj = cellAt(p.y);
    double nearest = kNoBound, height = 0;
    for (int j = std::max(0, cj - kReach); j <= std::min(cells, cj + kReach); ++j)
      for (int i = std::max(0, ci - kReach); i <= std::min(cells, ci + kReach); ++i) {
        const Vec3& v = x[static_cast<std::size_t>(i + j * (cells + 1))];
        const double d = portable::hypot(v.x - p.x, v.y - p.y);
        if (d < nearest) nearest = d, height = v.z;
      }
    through += p.z < height;
  }
  return through;
}

Spec platesSpec() {
  Spec spec;
  spec.name = "plates-on-cloth";
  spec.doc =
      "875 plates of 40 jointed cubes each fall on a sheet of 10,000 vertices that is held at its edges "
      "(figure 14 of Giles et al. 2025).";
  spec.arguments = {count("cells", 99, 10, 400, "cells along an edge of the sheet, 0.1 m each"),
                    count("plates", 875, 1, 20000, "plates")};
  spec.build = buildPlates;
  spec.probes = [](const Arguments& arguments, const Scene&) {
    const int cells = whole(arguments, "cells");
    Probes probes;
    probes.push_back(
        endProbe({{"bodies_through", [cells](const World& w) { return bodiesThrough(w, cells); }},
                  {"sag_m", [](const World& w) { return -lowestVertex(w); }},
                  {"stretch", [](const World& w) { return largestStretch(w, 0); }}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("bodies_through", 0, "nothing passes through the sheet"),
                              atMost("joint_gap_max_m", .02 * kPitch, "joints hold within 2 % of a cube"),
                              atLeast("sag_m", .005, "the sheet carries them"),
                              atMost("stretch", 1.25, "and stretches little"),
                              atMost("quarantined", 0, "finite throughout")};
  };
  spec.camera = [](const Arguments& arguments, const Scene&) {
    const double side = kCell * whole(arguments, "cells");
    return Camera{{.75 * side, -1.0 * side, .7 * side}, {0, 0, -.05 * side}};
  };
  spec.steps = 600;
  spec.iterations = 10;
  spec.testArguments = {{"cells", 20}, {"plates", 8}};
  spec.testSteps = 240;
  spec.tags = {"cloth", "joint"};
  return spec;
}

}  // namespace

std::vector<Spec> softPlateSpecs() { return {platesSpec()}; }

}  // namespace rubble::scenes

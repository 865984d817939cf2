/// Closed sheets under pressure.
#include <cmath>
#include <map>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "soft_probes.h"

namespace rubble::scenes {
namespace {

constexpr double kRadius = .2, kThickness = 1e-3, kYoung = 1e6, kPoisson = .3;  // [m], [m], [Pa], [1]

/// A sphere of triangles: an icosahedron whose edges are halved `times` times, on the sphere.
ClothDef sphereSheet(const Vec3& center, double radius, int times) {
  ClothDef sheet;
  const double g = std::numbers::phi;
  for (const double a : {-1., 1.})
    for (const double b : {-g, g})
      sheet.vertices.push_back({0, a, b}), sheet.vertices.push_back({a, b, 0}),
          sheet.vertices.push_back({b, 0, a});
  // faces of the icosahedron: three corners whose distances are all 2
  const auto near = [&](std::size_t i, std::size_t j) {
    return std::fabs(length(sheet.vertices[i] - sheet.vertices[j]) - 2) < 1e-9;
  };
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
        const Vec3 &a = sheet.vertices[i], &b = sheet.vertices[j], &c = sheet.vertices[k];
        if (dot(cross(b - a, c - a), a) > 0)
          sheet.triangles.push_back({int(i), int(j), int(k)});
        else
          sheet.triangles.push_back({int(i), int(k), int(j)});
      }
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, isNew] = middles.emplace(std::minmax(a, b), int(sheet.vertices.size()));
      if (isNew)
        sheet.vertices.push_back((sheet.vertices[std::size_t(a)] + sheet.vertices[std::size_t(b)]) / 2);
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& t : sheet.triangles) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      finer.push_back({t[0], ab, ca}), finer.push_back({ab, t[1], bc}), finer.push_back({ca, bc, t[2]}),
          finer.push_back({ab, bc, ca});
    }
    sheet.triangles = std::move(finer);
    for (Vec3& x : sheet.vertices) x = normalize(x);
  }
  for (Vec3& x : sheet.vertices) x = center + radius * normalize(x);
  sheet.thickness = kThickness;
  sheet.youngsModulus = kYoung;
  sheet.poissonRatio = kPoisson;
  sheet.restFolded = true;
  return sheet;
}

/// Ratio of the radii of a thin sphere with and without pressure. Of a sheet of St. Venant-Kirchhoff material
/// stretched by L both ways the tension is T = E h / (1 - nu) (L^2 - 1) / 2, and p = 2 T / (L r): for small
/// strains the stress is p r / (2 h).
double inflatedRatio(double pressure) {
  // L^2 - 1 = 2 b L
  const double b = pressure * kRadius * (1 - kPoisson) / (2 * kYoung * kThickness);
  return b + std::sqrt(b * b + 1);
}

Scene buildBalloon(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 0);
  ClothDef ball = sphereSheet({0, 0, 0}, kRadius, whole(arguments, "fineness"));
  ball.name = "balloon";
  ball.pressure = value(arguments, "pressure");
  scene.deformables.push_back(ball);
  return scene;
}

Spec balloonSpec() {
  Spec spec;
  spec.name = "balloon";
  spec.doc = "Pressure in a thin sphere: its stress is p r / (2 h).";
  spec.arguments = {count("fineness", 3, 1, 7, "times that the edges of an icosahedron are halved"),
                    quantity("pressure", 500, 1, 1400, "Pa", "inside over outside")};
  spec.build = buildBalloon;
  spec.probes = [](const Arguments& arguments, const Scene& scene) {
    const double wanted = inflatedRatio(value(arguments, "pressure"));
    const double before = volumeInside(World(scene), 0);
    Probes probes;
    probes.push_back(endProbe(
        {{"strain_ratio",
          [=](const World& w) { return (portable::cbrt(volumeInside(w, 0) / before) - 1) / (wanted - 1); }},
         {"motion_j", motion}}));
    return probes;
  };
  spec.claims = [](const Arguments&) {
    return std::vector<Claim>{within("strain_ratio", .98, 1.02, "the strain of a thin sphere under pressure"),
                              atMost("motion_j", 1e-4, "it rests")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{.7, -.9, .4}, {0, 0, 0}}; };
  spec.steps = 240;
  spec.iterations = 10;
  spec.testArguments = {{"fineness", 2}};
  spec.tags = {"cloth"};
  return spec;
}

// Balloons that carry a plate.

Scene buildCushion(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ));
  for (int i = 0; i < 4; ++i) {
    ClothDef ball = sphereSheet({.5 * (i % 2) - .25, .5 * (i / 2) - .25, 1.02 * kRadius}, kRadius,
                                whole(arguments, "fineness"));
    ball.pressure = value(arguments, "pressure");
    ball.viscosity = 2000;
    scene.deformables.push_back(ball);
  }
  BodyDef plate = block({.5, .5, .02}, {0, 0, 2.2 * kRadius + .02}, 1000);
  plate.name = "plate";
  plate.mass = value(arguments, "mass");
  // guided, for on balls it would roll away
  plate.lockTranslation = {true, true, false};
  plate.lockRotation = {true, true, true};
  scene.bodies.push_back(plate);
  return scene;
}

Spec cushionSpec() {
  Spec spec;
  spec.name = "balloon-cushion";
  spec.doc = "A guided plate lies on four balloons, which are pressed flat under it.";
  spec.arguments = {count("fineness", 3, 1, 6, "times that the edges of an icosahedron are halved"),
                    quantity("pressure", 1000, 10, 10000, "Pa", "inside over outside"),
                    quantity("mass", 8, .1, 1000, "kg", "of the plate")};
  spec.build = buildCushion;
  spec.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(endProbe(
        {{"plate_height_m", [](const World& w) { return w.state(w.findBody("plate")).position.z - .02; }},
         {"motion_j", motion}}));
    return probes;
  };
  spec.claims = [](const Arguments& arguments) {
    const double height = 2 * kRadius * inflatedRatio(value(arguments, "pressure"));
    return std::vector<Claim>{
        within("plate_height_m", .78 * height, .97 * height, "the balloons are pressed flat, and carry it"),
        atMost("motion_j", .02, "it rests")};
  };
  spec.camera = [](const Arguments&, const Scene&) { return Camera{{1.3, -1.7, .8}, {0, 0, .2}}; };
  spec.steps = 360;
  spec.iterations = 10;
  spec.testArguments = {{"fineness", 1}};
  spec.tags = {"cloth", "contact"};
  return spec;
}

}  // namespace

std::vector<Spec> softPressureSpecs() { return {balloonSpec(), cushionSpec()}; }

}  // namespace rubble::scenes

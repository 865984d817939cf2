#pragma once
/// Shapes that stand on their base, and grounds of every kind, for tests of whole steps.
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/scenes.h"

namespace rubble::test {

/// A shape that can stand: how high its frame is over its base.
struct Standing {
  std::string name;
  Shape shape;
  double height;  ///< of the frame over the base [m]
  double top;     ///< of a flat top over the frame, 0: it has none [m]
};

inline std::vector<Vec3> prismCorners(int sides, double radius, double half) {
  std::vector<Vec3> points;
  for (int k = 0; k < sides; ++k)
    for (const double z : {-half, half}) {
      const double a = 2 * 3.14159265358979324 * k / sides;
      points.push_back({radius * std::cos(a), radius * std::sin(a), z});
    }
  return points;
}

inline std::vector<Standing> standingShapes() {
  return {
      {"box", Shape::box({.4, .3, .3}), .3, .3},
      {"roundedBox", Shape::box({.4, .3, .3}, .05), .3, .3},
      {"cylinder", Shape::cylinder(.35, .3), .3, .3},
      {"roundedCylinder", Shape::cylinder(.35, .3, .04), .3, .3},
      {"cone", Shape::cone(.35, .3), .3, 0},
      {"hull", Shape::hull(prismCorners(7, .4, .3)), .3, .3},
      {"pyramid", Shape::hull({{-.3, -.3, 0}, {.3, -.3, 0}, {.3, .3, 0}, {-.3, .3, 0}, {0, 0, .5}}), 0, 0},
      {"compound",
       Shape::compound({{Shape::box({.4, .1, .1}), {0, -.25, -.2}, {}},
                        {Shape::box({.4, .1, .1}), {0, .25, -.2}, {}},
                        {Shape::box({.4, .35, .1}), {0, 0, 0}, {}}}),
       .3, .1}};
}

/// Ground with its surface at z = 0: "plane", "box", "mesh" (triangles of 0.3 m) or "heights".
inline BodyDef groundOf(const std::string& kind, double friction = .6, double half = 6) {
  BodyDef def = ground(friction);
  constexpr double kCell = .3;
  const int n = static_cast<int>(2 * half / kCell) + 1;
  if (kind == "box") {
    def.shape = Shape::box({half, half, .5});
    def.position = {0, 0, -.5};
  } else if (kind == "mesh") {
    std::vector<Vec3> points;
    std::vector<std::array<int, 3>> triangles;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) points.push_back({i * kCell - half, j * kCell - half, 0});
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i) {
        const int a = j * n + i;
        triangles.push_back({a, a + 1, a + n + 1});
        triangles.push_back({a, a + n + 1, a + n});
      }
    def.shape = Shape::mesh(points, triangles);
  } else if (kind == "heights") {
    def.shape = Shape::heightField(
        n, n, {kCell, kCell, 0},
        std::vector<double>(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0));
    def.position = {-half, -half, 0};
  }
  return def;
}

inline const std::vector<std::string>& groundKinds() {
  static const std::vector<std::string> kinds = {"plane", "box", "mesh", "heights"};
  return kinds;
}

/// The scene rotated by q about the origin; gravity stays.
inline void turn(Scene& scene, const Quat& q) {
  for (BodyDef& body : scene.bodies) {
    body.position = rotate(q, body.position);
    body.orientation = normalize(q * body.orientation);
    body.velocity = rotate(q, body.velocity);
    body.angularVelocity = rotate(q, body.angularVelocity);
  }
}

}  // namespace rubble::test

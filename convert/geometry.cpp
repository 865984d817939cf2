#include "convert/geometry.h"

#include <cmath>
#include <numbers>

#include "cook/hull.h"

namespace rubble::convert {
namespace {

using Triangle = std::array<int, 3>;

Vec3 corner(const TriangleMesh& mesh, const Triangle& t, std::size_t k) {
  return mesh.vertices[static_cast<std::size_t>(t[k])];
}

/// Centroid of the triangles, weighted by their areas.
Vec3 surfaceCentroid(const TriangleMesh& mesh) {
  Vec3 sum;
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = corner(mesh, t, 0), b = corner(mesh, t, 1), c = corner(mesh, t, 2);
    const double twice = length(cross(b - a, c - a));
    sum += (a + b + c) * (twice / 3), area += twice;
  }
  return area > 0 ? sum / area : Vec3{};
}

/// Integrals over the surface.
SolidSums shellOf(const TriangleMesh& mesh) {
  SolidSums sums;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 v[3] = {corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2)}, all = v[0] + v[1] + v[2];
    const double area = length(cross(v[1] - v[0], v[2] - v[0])) / 2;
    SolidSums own{area, all * (area / 3), {}};
    constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (std::size_t k = 0; k < 6; ++k) {
      const int i = kPairs[k][0], j = kPairs[k][1];
      own.second[k] = area / 12 *
                      (all[i] * all[j] + v[0][i] * v[0][j] + v[1][i] * v[1][j] + v[2][i] * v[2][j]);
    }
    sums += own;
  }
  return sums;
}

}  // namespace

SolidSums massOf(const TriangleMesh& mesh, MeshMass kind, const std::string& path) {
  if (kind == MeshMass::Convex) return massOf(hullOf(mesh.vertices, path), MeshMass::Exact, path);
  if (kind == MeshMass::Shell) return shellOf(mesh);
  const Vec3 center = surfaceCentroid(mesh);
  SolidSums sums;
  for (const Triangle& t : mesh.triangles) {
    const SolidSums cone = tetrahedronSums(corner(mesh, t, 0) - center, corner(mesh, t, 1) - center,
                                           corner(mesh, t, 2) - center);
    const bool flipped = kind == MeshMass::Legacy && cone.volume < 0;
    sums += placed(cone, {}, {}, flipped ? -1 : 1);
  }
  return placed(sums, center, {}, 1);
}

TriangleMesh hullOf(const std::vector<Vec3>& points, const std::string& path) {
  const Hull hull = convexHull(points, path);
  TriangleMesh out;
  out.vertices = hull.vertices;
  for (const std::vector<int>& face : hull.faces)
    for (std::size_t k = 2; k < face.size(); ++k) out.triangles.push_back({face[0], face[k - 1], face[k]});
  return out;
}

std::optional<Shape> drawnMesh(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 a = corner(mesh, t, 0);
    return !(length(cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a)) > 0);
  });
  if (mesh.triangles.empty()) return std::nullopt;
  Shape shape = Shape::mesh(std::move(mesh.vertices), std::move(mesh.triangles));
  try {
    validate(shape, "mesh");
  } catch (const Error&) {
    return std::nullopt;
  }
  return shape;
}

Shape drawnEllipsoid(const Vec3& halfAxes) {
  constexpr int kSegments = 32;
  ShapeMesh ball = shapeMesh(Shape::sphere(1), kSegments);
  for (Vec3& point : ball.points) point = mul(point, halfAxes);
  return Shape::mesh(std::move(ball.points), std::move(ball.triangles));
}

Shape ellipsoidHull(const Vec3& halfAxes) {
  std::vector<Vec3> points = directions(static_cast<int>(kMostCorners) - 6);
  for (Vec3& point : points) point = mul(point, halfAxes);
  return Shape::hull(std::move(points));
}

MassProperties ellipsoidMass(const Vec3& halfAxes) {
  const Vec3 s = mul(halfAxes, halfAxes);
  const double mass = 4. / 3 * std::numbers::pi * halfAxes.x * halfAxes.y * halfAxes.z;
  return {mass, Vec3{s.y + s.z, s.x + s.z, s.x + s.y} * (mass / 5), {}, {}};
}

SolidSums sumsOfTensor(double mass, const std::array<double, 6>& tensor) {
  SolidSums out;
  out.volume = mass;
  const double half = (tensor[0] + tensor[1] + tensor[2]) / 2;
  out.second = {half - tensor[0], half - tensor[1], half - tensor[2], -tensor[3], -tensor[4], -tensor[5]};
  return out;
}

}  // namespace rubble::convert

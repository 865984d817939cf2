#pragma once
/// Deepest overlap of the bodies of a scene, by separating axes in double precision: independent of the
/// engine's collision code.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include <rubble/scene.h>

#include <rubble/mesh.h>
#include "cook/cook.h"

namespace rubble::scenes {

/// Depth of the shallowest separating axis of two boxes; negative when they are apart.
inline double boxOverlap(const BodyDef& a, const BodyDef& b) {
  const Mat3 ra = rotationMatrix(a.orientation), rb = rotationMatrix(b.orientation);
  const Vec3 offset = b.position - a.position;
  double least = 1e300;
  const auto test = [&](const Vec3& axis) {
    const double norm = length(axis);
    if (norm < 1e-6) return;
    const Vec3 n = axis / norm;
    const double reach = dot(abs(mulTransposed(ra, n)), a.shape.halfExtents) +
                         dot(abs(mulTransposed(rb, n)), b.shape.halfExtents);
    least = std::min(least, reach - std::fabs(dot(offset, n)));
  };
  for (int i = 0; i < 3; ++i) {
    test(ra.column(i));
    test(rb.column(i));
    for (int j = 0; j < 3; ++j) test(cross(ra.column(i), rb.column(j)));
  }
  return least;
}

/// Are the triangles of a shape the surface of a convex solid?
inline bool isConvex(const Shape& s) { return s.type < ShapeType::Compound && s.type != ShapeType::Plane; }

/// The least overlap of two convex solids along the normals of their triangles: at most what a separating
/// face leaves.
inline double faceOverlap(const BodyDef& a, const BodyDef& b) {
  const ShapeMesh ma = shapeMesh(a.shape, 24), mb = shapeMesh(b.shape, 24);
  const auto range = [](const BodyDef& body, const ShapeMesh& mesh, const Vec3& n, double& low,
                        double& high) {
    low = 1e300, high = -1e300;
    for (const Vec3& p : mesh.points) {
      const double h = dot(n, body.position + rotate(body.orientation, p));
      low = std::min(low, h), high = std::max(high, h);
    }
  };
  double least = 1e300;
  for (const auto& [body, mesh] : {std::pair{&a, &ma}, {&b, &mb}})
    for (const auto& t : mesh->triangles) {
      const auto at = [&](std::size_t k) { return mesh->points[std::size_t(t[k])]; };
      const Vec3 n = rotate(body->orientation, normalize(cross(at(1) - at(0), at(2) - at(0))));
      double lowA, highA, lowB, highB;
      range(a, ma, n, lowA, highA);
      range(b, mb, n, lowB, highB);
      least = std::min({least, highA - lowB, highB - lowA});
    }
  return least;
}

/// Depth of a box below a half space, or of a sphere in whatever it meets.
inline double overlap(const BodyDef& a, const BodyDef& b) {
  if (b.shape.type == ShapeType::Plane) return overlap(b, a);
  if (a.shape.type == ShapeType::Plane) {
    const Vec3 up = rotate(a.orientation, Vec3{0, 0, 1});
    double reach = b.shape.type == ShapeType::Box
                       ? dot(abs(rotateInverse(b.orientation, up)), b.shape.halfExtents)
                       : b.shape.radius;
    if (b.shape.type > ShapeType::Plane) {
      reach = -1e300;
      for (const Vec3& p : shapeMesh(b.shape, 24).points)
        reach = std::max(reach, -dot(up, rotate(b.orientation, p)));
    }
    return reach - dot(b.position - a.position, up);
  }
  if (a.shape.type > ShapeType::Plane || b.shape.type > ShapeType::Plane) {
    // bodies in a hollow are not measured
    if (!isConvex(a.shape) || !isConvex(b.shape)) return -1e300;
    return faceOverlap(a, b);
  }
  if (a.shape.type == ShapeType::Box && b.shape.type == ShapeType::Box) return boxOverlap(a, b);
  if (b.shape.type == ShapeType::Box) return overlap(b, a);
  if (a.shape.type == ShapeType::Sphere)
    return a.shape.radius + b.shape.radius - length(b.position - a.position);
  const Vec3 local = rotateInverse(a.orientation, b.position - a.position);
  Vec3 nearest = local;
  for (int i = 0; i < 3; ++i)
    nearest[i] = std::clamp(local[i], -a.shape.halfExtents[i], a.shape.halfExtents[i]);
  return b.shape.radius - length(local - nearest);
}

/// Over all pairs that may collide: not two static bodies, not two bodies of a joint without collision.
inline double deepestOverlap(const Scene& scene) {
  std::set<std::pair<int, int>> joined;
  for (const JointDef& joint : scene.joints)
    if (!joint.collide) joined.insert(std::minmax(joint.bodyA, joint.bodyB));
  const auto radius = [](const BodyDef& b) {
    if (b.shape.type == ShapeType::Box) return length(b.shape.halfExtents);
    if (b.shape.type <= ShapeType::Plane) return b.shape.radius;
    const CookedShape cooked = cook(b.shape);
    return cooked.radius + length(cooked.unit.center);
  };
  const auto at = [&](int i) -> const BodyDef& { return scene.bodies[std::size_t(i)]; };

  // Bodies by the size of their cell: small ones in a grid of twice their largest radius, few others against
  // all.
  std::vector<int> small, large;
  double typical = 0;
  for (const BodyDef& body : scene.bodies)
    if (body.motion == Motion::Dynamic)
      typical = typical == 0 ? radius(body) : std::min(typical, radius(body));
  for (int i = 0; i < int(scene.bodies.size()); ++i)
    (at(i).shape.type == ShapeType::Plane || radius(at(i)) > 4 * typical ? large : small).push_back(i);
  const double cell = 8 * typical;
  const auto key = [&](const Vec3& p, int dx, int dy, int dz) {
    const auto part = [&](double x, int d) {
      return std::uint64_t(std::int64_t(std::floor(x / cell)) + d + (1 << 20)) & 0x1fffff;
    };
    return part(p.x, dx) | part(p.y, dy) << 21 | part(p.z, dz) << 42;
  };
  std::unordered_map<std::uint64_t, std::vector<int>> grid;
  for (const int i : small) grid[key(at(i).position, 0, 0, 0)].push_back(i);

  double deepest = -1e300;
  const auto meet = [&](int i, int j) {
    const BodyDef &a = at(i), &b = at(j);
    if (a.motion == Motion::Static && b.motion == Motion::Static) return;
    const bool far = a.shape.type != ShapeType::Plane && b.shape.type != ShapeType::Plane &&
                     length(a.position - b.position) > radius(a) + radius(b) + 1e-3;
    if (!far && !joined.contains(std::minmax(i, j))) deepest = std::max(deepest, overlap(a, b));
  };
  for (const int i : small)
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz)
          if (const auto found = grid.find(key(at(i).position, dx, dy, dz)); found != grid.end())
            for (const int j : found->second)
              if (j > i) meet(i, j);
  for (const int i : large)
    for (int j = 0; j < int(scene.bodies.size()); ++j)
      if (j != i) meet(i, j);
  return deepest;
}

}  // namespace rubble::scenes

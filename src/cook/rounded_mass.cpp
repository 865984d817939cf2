/// The layer around a polyhedron consists of a prism on each face, a sector of a cylinder along each edge and
/// a sector of a ball at each vertex.
#include "cook/rounded_mass.h"
#include "math/portable.h"

#include <cmath>
#include <map>
#include <utility>

namespace rubble {

namespace {

/// Adds weight (a b^T + b a^T) / 2 to a second moment.
void addProduct(SolidSums& sums, const Vec3& a, const Vec3& b, double weight) {
  constexpr int kRow[6] = {0, 1, 2, 0, 0, 1}, kColumn[6] = {0, 1, 2, 1, 2, 2};
  for (std::size_t k = 0; k < 6; ++k) {
    const int i = kRow[k], j = kColumn[k];
    sums.second[k] += weight * (a[i] * b[j] + b[i] * a[j]) / 2;
  }
}

/// The tetrahedron of four points, of either orientation.
SolidSums tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const SolidSums s = tetrahedronSums(b - a, c - a, d - a);
  return placed(s, a, Quat{}, s.volume < 0 ? -1 : 1);
}

/// The arc between two unit vectors: cos(t) begin + sin(t) side for t from 0 to `angle`.
struct Arc {
  Arc(const Vec3& from, const Vec3& to) : begin(from) {
    const Vec3 across = cross(from, to);
    const double sine = length(across);
    angle = portable::atan2(sine, dot(from, to));
    if (sine > 0) axis = across / sine, side = cross(axis, from);
  }
  /// Integral of its points.
  Vec3 sum() const { return begin * portable::sin(angle) + side * (1 - portable::cos(angle)); }
  Vec3 begin, side, axis;
  double angle;
};

/// Sector of a cylinder: the points within `radius` of the edge from a to b in the directions of the arc.
SolidSums edgeSector(const Vec3& a, const Vec3& b, const Arc& arc, double radius) {
  const Vec3 along = b - a, middle = (a + b) * 0.5;
  const double size = length(along), r2 = radius * radius, area = arc.angle * r2 / 2,
               sine = portable::sin(arc.angle), cosine = portable::cos(arc.angle);
  const Vec3 first = arc.sum() * (radius * r2 / 3);  // of the section
  SolidSums s;
  s.volume = size * area;
  s.first = middle * s.volume + first * size;
  addProduct(s, middle, middle, s.volume);
  addProduct(s, along, along, s.volume / 12);
  addProduct(s, middle, first, 2 * size);
  const double second = size * r2 * r2 / 4;
  addProduct(s, arc.begin, arc.begin, second * (arc.angle + sine * cosine) / 2);
  addProduct(s, arc.side, arc.side, second * (arc.angle - sine * cosine) / 2);
  addProduct(s, arc.begin, arc.side, second * sine * sine);
  return s;
}

/// Solid angle of a triangle of unit vectors (Van Oosterom, Strackee 1983).
double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 2 * portable::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

/// Sector of a ball about x in the directions of a convex spherical polygon, counter-clockwise seen from
/// outside. Directions and their products are spherical harmonics of degree 1 and 2, whose integrals are
/// those of their normal derivatives over the arcs.
SolidSums vertexSector(const Vec3& x, const std::vector<Vec3>& corners, double radius) {
  const double r3 = radius * radius * radius / 3, r4 = radius * radius * radius * radius / 4,
               r5 = radius * radius * radius * radius * radius / 5;
  SolidSums s;
  Vec3 sum;  // of the directions
  double solid = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3& next = corners[(k + 1) % corners.size()];
    const Arc arc(corners[k], next);
    solid += solidAngle(corners[0], corners[k], next);
    sum += arc.axis * (arc.angle / 2);
    addProduct(s, arc.axis, arc.sum(), r5 / 3);
  }
  for (std::size_t k = 0; k < 3; ++k) s.second[k] += r5 * solid / 3;
  s.volume = r3 * solid;
  s.first = x * s.volume + sum * r4;
  addProduct(s, x, x, s.volume);
  addProduct(s, x, sum, 2 * r4);
  return s;
}

}  // namespace

SolidSums polyhedronSums(const Hull& hull) {
  SolidSums sums;
  for (const std::vector<int>& face : hull.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const auto at = [&](std::size_t i) { return hull.vertices[static_cast<std::size_t>(face[i])]; };
      sums += tetrahedronSums(at(0), at(k), at(k + 1));
    }
  return sums;
}

SolidSums roundedSums(const Hull& core, double radius) {
  SolidSums sums = polyhedronSums(core);
  if (!(radius > 0)) return sums;
  const auto at = [&](int vertex) { return core.vertices[static_cast<std::size_t>(vertex)]; };
  struct Side {
    std::size_t face;
    int before;  ///< the corner before the edge
  };
  std::map<std::pair<int, int>, Side> sides;  // of directed edges
  for (std::size_t f = 0; f < core.faces.size(); ++f) {
    const std::vector<int>& corners = core.faces[f];
    const Vec3 up = core.normals[f] * radius;
    const std::size_t n = corners.size();
    for (std::size_t k = 0; k < n; ++k)
      sides[{corners[k], corners[(k + 1) % n]}] = {f, corners[(k + n - 1) % n]};
    for (std::size_t k = 1; k + 1 < n; ++k) {
      const Vec3 a = at(corners[0]), b = at(corners[k]), c = at(corners[k + 1]);
      sums += tetrahedron(a, b, c, c + up);
      sums += tetrahedron(a, b, c + up, b + up);
      sums += tetrahedron(a, a + up, b + up, c + up);
    }
  }
  std::vector<bool> done(core.vertices.size());
  for (const auto& [edge, side] : sides) {
    const auto [a, b] = edge;
    if (a < b)
      sums += edgeSector(at(a), at(b), {core.normals[side.face], core.normals[sides.at({b, a}).face]},
                         radius);
    if (done[static_cast<std::size_t>(a)]) continue;
    done[static_cast<std::size_t>(a)] = true;
    // the faces around the vertex, counter-clockwise
    std::vector<Vec3> normals;
    for (int next = b;;) {
      const Side& s = sides.at({a, next});
      normals.push_back(core.normals[s.face]);
      next = s.before;
      if (next == b) break;
    }
    sums += vertexSector(at(a), normals, radius);
  }
  return sums;
}

Hull boxHull(const Vec3& h) {
  Hull out;
  for (int k = 0; k < 8; ++k)
    out.vertices.push_back({(k & 1) ? h.x : -h.x, (k & 2) ? h.y : -h.y, (k & 4) ? h.z : -h.z});
  for (int axis = 0; axis < 3; ++axis) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, w = 1 << axis;
    Vec3 n;
    n[axis] = 1;
    out.faces.push_back({w, w + u, w + u + v, w + v}), out.normals.push_back(n);
    out.faces.push_back({0, v, u + v, u}), out.normals.push_back(-n);
  }
  return out;
}

}  // namespace rubble

#include "cook/solid_cut.h"
#include "math/portable.h"

#include <algorithm>
#include <cmath>

namespace rubble {

namespace {

/// Directed edges of a cut: along the polygons in front of the plane.
using Edges = std::vector<std::pair<Vec3, Vec3>>;

/// Corners nearer to a plane than this share of their coordinates lie on it. Without that, a polygon in the
/// plane would be cut to and fro by round-off.
constexpr double kOnPlane = 1e-11;

double sideOf(const Plane& plane, const Vec3& x) {
  const double s = plane.distance(x);
  return std::fabs(s) <=
                 kOnPlane * (std::fabs(plane.offset) + std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z))
             ? 0
             : s;
}

/// Divides polygons by a plane.
void divide(const Polygons& from, const Plane& plane, Polygons& front, Polygons& back, Edges& edges) {
  std::vector<double> s;
  from.forEach([&](const Vec3* x, std::size_t n) {
    s.resize(n);
    bool hasFront = false, hasBack = false;
    for (std::size_t i = 0; i < n; ++i) {
      s[i] = sideOf(plane, x[i]);
      (s[i] >= 0 ? hasFront : hasBack) = true;
    }
    Vec3 leave, enter;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = i + 1 == n ? 0 : i + 1;
      (s[i] >= 0 ? front : back).corners.push_back(x[i]);
      if ((s[i] >= 0) == (s[j] >= 0)) continue;
      // From the front to the back: both polygons of an edge find the same point.
      const bool leaves = s[i] >= 0;
      const std::size_t a = leaves ? i : j, b = leaves ? j : i;
      const Vec3 at = x[a] + (x[b] - x[a]) * (s[a] / (s[a] - s[b]));
      front.corners.push_back(at), back.corners.push_back(at);
      (leaves ? leave : enter) = at;
    }
    if (hasFront) front.close();
    if (hasBack) back.close();
    if (hasFront && hasBack && !(leave == enter)) edges.emplace_back(leave, enter);
  });
}

/// Closes both sides of a cut.
void addCaps(const Edges& edges, Polygons& front, Polygons& back) {
  if (edges.empty()) return;
  const Vec3 apex = edges.front().first;
  for (const auto& [a, b] : edges) {
    if (a == apex || b == apex) continue;
    front.corners.insert(front.corners.end(), {apex, b, a});
    front.close();
    back.corners.insert(back.corners.end(), {apex, a, b});
    back.close();
  }
}

/// The edges of the cut through a convex cell as one polygon, seen from behind the plane.
void addConvexCap(const Edges& edges, const Plane& plane, Polygons& front) {
  if (edges.size() < 3) return;
  Vec3 middle;
  for (const auto& [a, b] : edges) middle += a;
  middle = middle / static_cast<double>(edges.size());
  const Vec3 u = normalize(edges[0].first - middle), v = cross(plane.normal, u);
  std::vector<std::pair<double, Vec3>> around;
  for (const auto& [a, b] : edges)
    around.emplace_back(portable::atan2(dot(a - middle, v), dot(a - middle, u)), a);
  // Clockwise about the normal, which points into the cell.
  std::sort(around.begin(), around.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [angle, x] : around) front.corners.push_back(x);
  front.close();
}

Polygons boxAround(const TriangleMesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& x : mesh.vertices)
    for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
  constexpr double kMargin = 0.01;
  const Vec3 margin = (high - low) * kMargin;
  low -= margin, high += margin;
  Polygons box;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isHigh : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int k = 0; k < 4; ++k) {
        // counter-clockwise from outside
        const int corner = isHigh ? k : 3 - k;
        Vec3 x;
        x[axis] = isHigh ? high[axis] : low[axis];
        x[u] = corner == 1 || corner == 2 ? high[u] : low[u];
        x[v] = corner >= 2 ? high[v] : low[v];
        box.corners.push_back(x);
      }
      box.close();
    }
  return box;
}

}  // namespace

void Polygons::close() {
  const std::size_t begin = ends.empty() ? 0 : static_cast<std::size_t>(ends.back());
  if (corners.size() < begin + 3) {
    corners.resize(begin);
    return;
  }
  ends.push_back(static_cast<int>(corners.size()));
}

double Polygons::volume() const {
  double six = 0;
  forEach([&](const Vec3* x, std::size_t n) {
    for (std::size_t k = 1; k + 1 < n; ++k) six += dot(x[0], cross(x[k], x[k + 1]));
  });
  return six / 6;
}

bool CutSurface::isInside(const Vec3& x) const {
  int winding = 0;
  const auto side = [&](const Vec3& a, const Vec3& b) {
    return (b.x - a.x) * (x.y - a.y) - (b.y - a.y) * (x.x - a.x);
  };
  // A half-open rule for the edges: an edge belongs to the triangle on one side of it.
  const auto isLeft = [&](const Vec3& a, const Vec3& b) {
    // the same number from both sides
    const bool isOrdered = a.x != b.x ? a.x < b.x : a.y < b.y;
    const double s = isOrdered ? side(a, b) : -side(b, a);
    return s > 0 || (s == 0 && isOrdered);
  };
  for (const auto& t : surface_->triangles) {
    const Vec3 &a = surface_->vertices[static_cast<std::size_t>(t[0])],
               &b = surface_->vertices[static_cast<std::size_t>(t[1])],
               &c = surface_->vertices[static_cast<std::size_t>(t[2])];
    if (std::max({a.z, b.z, c.z}) < x.z || std::max({a.x, b.x, c.x}) < x.x ||
        std::min({a.x, b.x, c.x}) > x.x || std::max({a.y, b.y, c.y}) < x.y || std::min({a.y, b.y, c.y}) > x.y)
      continue;
    const bool l0 = isLeft(a, b), l1 = isLeft(b, c), l2 = isLeft(c, a);
    if (l0 != l1 || l1 != l2) continue;
    const Vec3 n = cross(b - a, c - a);
    if (n.z == 0) continue;
    const double z = a.z - (n.x * (x.x - a.x) + n.y * (x.y - a.y)) / n.z;
    if (z > x.z) winding += l0 ? 1 : -1;
  }
  return winding > 0;
}

CutSolid::CutSolid(const CutSurface& whole) : whole_(&whole), cell_(boxAround(whole.mesh())) {
  const TriangleMesh& mesh = whole.mesh();
  for (const auto& t : mesh.triangles) {
    for (const int v : t) surface_.corners.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
    surface_.close();
  }
}

std::pair<CutSolid, CutSolid> CutSolid::cut(const Plane& plane) const {
  std::pair<CutSolid, CutSolid> out{CutSolid(), CutSolid()};
  auto& [front, back] = out;
  Edges edges, cellEdges;
  divide(surface_, plane, front.surface_, back.surface_, edges);
  divide(caps_, plane, front.caps_, back.caps_, edges);
  addCaps(edges, front.caps_, back.caps_);
  divide(cell_, plane, front.cell_, back.cell_, cellEdges);
  const Plane flipped{-plane.normal, -plane.offset};
  addConvexCap(cellEdges, plane, front.cell_), addConvexCap(cellEdges, flipped, back.cell_);
  for (CutSolid* side : {&front, &back}) side->whole_ = whole_, side->planes_ = planes_;
  front.planes_.push_back(plane), back.planes_.push_back(flipped);
  return out;
}

bool CutSolid::cutCell(Polygons& cell, const Plane& plane) {
  if (std::all_of(cell.corners.begin(), cell.corners.end(),
                  [&](const Vec3& x) { return sideOf(plane, x) >= 0; }))
    return false;
  Polygons front, back;
  Edges edges;
  divide(cell, plane, front, back, edges);
  addConvexCap(edges, plane, front);
  cell = std::move(front);
  return true;
}

std::vector<Vec3> CutSolid::hullPoints() const {
  std::vector<Vec3> points = surface_.corners;
  // A corner of the cell may lie on the surface itself, for planes go along edges. It counts if the solid is
  // next to it, towards the middle of a face or of the cell.
  constexpr double kStep = 1e-6;
  Vec3 middle;
  for (const Vec3& x : cell_.corners) middle += x / static_cast<double>(cell_.corners.size());
  cell_.forEach([&](const Vec3* x, std::size_t n) {
    Vec3 center;
    for (std::size_t k = 0; k < n; ++k) center += x[k] / static_cast<double>(n);
    for (std::size_t k = 0; k < n; ++k)
      if (whole_->isInside(x[k] + (center - x[k]) * kStep) ||
          whole_->isInside(x[k] + (middle - x[k]) * kStep))
        points.push_back(x[k]);
  });
  const auto before = [](const Vec3& a, const Vec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace rubble

#include "cook/convex_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <rubble/error.h>

#include "cook/hull.h"
#include "math/portable.h"

namespace rubble {

namespace {

/// Planes square to each axis of the world that are tried, evenly spaced over the solid.
constexpr int kAxisPlanes = 7;
/// Concave edges whose planes are tried.
constexpr std::size_t kConcaveEdges = 8;
/// Edges bent by less are flat [rad].
constexpr double kFlat = 0.05;
/// A cut gains much if it removes this share of the excess.
constexpr double kWorthwhile = 0.25;
/// A cut has to leave this share of a solid on either side.
constexpr double kLeastShare = 1e-4;

double volumeOfHull(const Hull& hull) {
  double six = 0;
  for (const std::vector<int>& face : hull.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      const auto at = [&](std::size_t i) { return hull.vertices[static_cast<std::size_t>(face[i])]; };
      six += dot(at(0), cross(at(k), at(k + 1)));
    }
  return six / 6;
}

/// An edge where a surface is concave, with the normals of its two triangles.
struct ConcaveEdge {
  Vec3 a, b, normalA, normalB;
  double weight;  ///< length times angle [m rad]
};

std::vector<ConcaveEdge> concaveEdges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::size_t> triangleOf;
  const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  const auto normalOf = [&](const std::array<int, 3>& t) {
    return normalize(cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])));
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      triangleOf[{mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]}] = i;
  std::vector<ConcaveEdge> out;
  for (const auto& [edge, i] : triangleOf) {
    const auto other = triangleOf.find({edge.second, edge.first});
    if (edge.first > edge.second || other == triangleOf.end()) continue;
    const Vec3 a = at(edge.first), b = at(edge.second), n = normalOf(mesh.triangles[i]),
               m = normalOf(mesh.triangles[other->second]);
    // Along the edge in the first triangle, whose inside is on the left.
    if (dot(cross(n, m), b - a) >= 0) continue;
    const double angle = portable::acos(std::clamp(dot(n, m), -1.0, 1.0));
    if (angle > kFlat) out.push_back({a, b, n, m, angle * length(b - a)});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const ConcaveEdge& p, const ConcaveEdge& q) { return p.weight > q.weight; });
  return out;
}

class Cutter {
 public:
  explicit Cutter(const TriangleMesh& mesh) : edges_(concaveEdges(mesh)) {}

  /// The cut after which the hulls exceed the solid least. Where none gains much at once, as at a ring, it is
  /// the one through the middle of the longest side. False if no plane cuts the solid.
  bool cut(const HulledSolid& from, HulledSolid& front, HulledSolid& back) const {
    double best = (1 - kWorthwhile) * from.excess();
    bool found = false;
    const std::vector<Plane> planes = candidates(from);
    const auto tryPlane = [&](const Plane& plane, double least) {
      auto [a, b] = from.solid.cut(plane);
      HulledSolid f = hulled(std::move(a)), g = hulled(std::move(b));
      if (f.hull.empty() || g.hull.empty() || f.volume < kLeastShare * from.volume ||
          g.volume < kLeastShare * from.volume)
        return;
      const double excess = f.excess() + g.excess();
      if (!(excess < least)) return;
      best = excess, found = true;
      front = std::move(f), back = std::move(g);
    };
    for (std::size_t k = 0; k + 1 < planes.size(); ++k) tryPlane(planes[k], best);
    if (!found) tryPlane(planes.back(), std::numeric_limits<double>::infinity());
    return found;
  }

 private:
  /// The last one halves the longest side.
  std::vector<Plane> candidates(const HulledSolid& from) const {
    Vec3 low = from.hull[0], high = low;
    for (const Vec3& x : from.hull)
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
    const double size = length(high - low);
    std::vector<Plane> planes;
    const auto add = [&](const Vec3& normal, const Vec3& point) {
      const double norm = length(normal);
      if (!(norm > 1e-12)) return;
      const Plane plane{normal / norm, dot(normal / norm, point)};
      constexpr double kSame = 1e-6;
      for (const Plane& other : planes)
        if (std::fabs(dot(plane.normal, other.normal)) > 1 - kSame &&
            std::fabs(other.distance(point)) < kSame * size)
          return;
      planes.push_back(plane);
    };
    std::size_t used = 0;
    for (const ConcaveEdge& edge : edges_) {
      const Vec3 middle = (edge.a + edge.b) * 0.5;
      const auto& cell = from.solid.planes();
      if (!std::all_of(cell.begin(), cell.end(), [&](const Plane& p) { return p.distance(middle) > 0; }))
        continue;
      add(edge.normalA, middle), add(edge.normalB, middle);
      add(cross(edge.b - edge.a, edge.normalA + edge.normalB), middle);
      if (++used == kConcaveEdges) break;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 1; k <= kAxisPlanes; ++k) {
        Vec3 normal;
        normal[axis] = 1;
        add(normal, low + (high - low) * (k / (kAxisPlanes + 1.0)));
      }
    const Vec3 side = high - low, middle = (low + high) * 0.5;
    Vec3 normal;
    normal[side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2] = 1;
    planes.push_back({normal, dot(normal, middle)});
    return planes;
  }

  std::vector<ConcaveEdge> edges_;
};

}  // namespace

HulledSolid hulled(CutSolid solid) {
  HulledSolid out{std::move(solid), {}, 0, 0};
  out.volume = out.solid.volume();
  const std::vector<Vec3> points = out.solid.hullPoints();
  if (!(out.volume > 0) || points.size() < 4) return out;
  try {
    Hull hull = convexHull(points, "part");
    out.hullVolume = volumeOfHull(hull);
    out.hull = std::move(hull.vertices);
  } catch (const Error&) {
    // Points in one plane have no hull.
  }
  return out;
}

void cutUntilConvex(std::vector<HulledSolid>& solids, double excess, std::size_t most) {
  if (solids.empty()) return;
  const Cutter cutter(solids.front().solid.whole().mesh());
  std::vector<bool> isFinal(solids.size(), false);
  for (;;) {
    double sum = 0, largest = 0;
    std::size_t worst = solids.size();
    for (std::size_t i = 0; i < solids.size(); ++i) {
      sum += solids[i].excess();
      if (!isFinal[i] && solids[i].excess() > largest) largest = solids[i].excess(), worst = i;
    }
    if (sum <= excess || solids.size() >= most || worst == solids.size()) return;
    HulledSolid front = solids[worst], back = front;
    if (!cutter.cut(solids[worst], front, back)) {
      isFinal[worst] = true;
      continue;
    }
    solids[worst] = std::move(front);
    solids.push_back(std::move(back));
    isFinal.push_back(false);
  }
}

std::vector<ConvexPart> convexParts(const TriangleMesh& surface, double concavity, int most,
                                    const Path& path) {
  if (!hasHulls()) throw Error(path, "a build with qhull (package libqhull-dev)", "one without");
  if (!(concavity > 0)) throw Error(path + ".concavity", "a number above 0", std::to_string(concavity));
  if (most < 1) throw Error(path + ".parts", "a number above 0", std::to_string(most));
  validateClosed(surface, path);
  const CutSurface whole(surface);
  std::vector<HulledSolid> solids;
  solids.push_back(hulled(CutSolid(whole)));
  cutUntilConvex(solids, concavity * solids[0].volume, static_cast<std::size_t>(most));
  std::vector<ConvexPart> parts;
  for (HulledSolid& solid : solids) parts.push_back({std::move(solid.hull), solid.hullVolume});
  return parts;
}

}  // namespace rubble

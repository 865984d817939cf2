/// Voronoi fracture of solids into convex pieces.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <rubble/error.h>

#include "cook/convex_parts.h"
#include "cook/hull.h"
#include "math/portable.h"

namespace rubble {

namespace {

/// Excess of the hulls of all pieces over the solid, as a share of its volume.
constexpr double kConcavity = 0.005;
/// Pieces below this share of the mean volume are slivers: they are left out.
constexpr double kSliver = 1e-3;
/// Further pieces that convexity may take, for each one that was wanted.
constexpr std::size_t kMostPerPiece = 4;
/// Points that are tried for each seed; the one farthest from the others is taken (Mitchell 1991).
constexpr int kTries = 8;
/// Faces of two pieces touch within this share of the size of a piece.
constexpr double kTouching = 1e-4;
/// Cosine of the angle that their normals may be apart.
constexpr double kParallel = 0.9999;
/// Contacts below this share of the squared size of a piece are small.
constexpr double kSmallContact = 0.15;
/// A gap that a lost sliver leaves, as a share of the size of a piece.
constexpr double kGap = 0.1;

std::vector<Vec3> seedsIn(const CutSurface& whole, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Vec3 low = whole.mesh().vertices[0], high = low;
  for (const Vec3& x : whole.mesh().vertices)
    for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
  const auto pointInside = [&] {
    // A solid fills some share of its box; one that fills less than 1e-6 has no inside worth breaking.
    constexpr int kMostTries = 1000000;
    for (int k = 0; k < kMostTries; ++k) {
      const Vec3 x = low + mul(high - low, Vec3{unit(), unit(), unit()});
      if (whole.isInside(x)) return x;
    }
    throw Error("surface", "a solid that fills 1e-6 of its box", "less");
  };
  std::vector<Vec3> seeds;
  for (int i = 0; i < count; ++i) {
    Vec3 best;
    double farthest = -1;
    for (int k = 0; k < kTries; ++k) {
      const Vec3 x = pointInside();
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& other : seeds) nearest = std::min(nearest, lengthSquared(x - other));
      if (nearest > farthest) farthest = nearest, best = x;
    }
    seeds.push_back(best);
  }
  return seeds;
}

/// Planes between a seed and its Voronoi neighbors; its side is in front.
std::vector<Plane> cellPlanes(const std::vector<Vec3>& seeds, std::size_t i, Polygons cell) {
  std::vector<std::size_t> order(seeds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return lengthSquared(seeds[a] - seeds[i]) < lengthSquared(seeds[b] - seeds[i]);
  });
  std::vector<Plane> planes;
  for (const std::size_t j : order) {
    const Vec3 way = seeds[i] - seeds[j];
    const double distance = length(way);
    if (!(distance > 0)) continue;
    double reach = 0;
    for (const Vec3& x : cell.corners) reach = std::max(reach, length(x - seeds[i]));
    if (distance / 2 > reach) break;
    const Vec3 n = way / distance;
    const Plane plane{n, dot(n, (seeds[i] + seeds[j]) * 0.5)};
    if (CutSolid::cutCell(cell, plane)) planes.push_back(plane);
  }
  return planes;
}

struct Box {
  Vec3 low, high;
  explicit Box(const std::vector<Vec3>& points) : low(points[0]), high(points[0]) {
    for (const Vec3& x : points)
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
  }
  bool reaches(const Box& b, double gap) const {
    for (int i = 0; i < 3; ++i)
      if (low[i] > b.high[i] + gap || b.low[i] > high[i] + gap) return false;
    return true;
  }
};

/// Overlap of a face of one hull and a face of another that lies on it: area [m2] and center; area 0 if none.
std::pair<double, Vec3> overlap(const Hull& a, std::size_t face, const Hull& b, std::size_t other) {
  std::vector<Vec3> polygon, next;
  for (const int v : b.faces[other]) polygon.push_back(b.vertices[static_cast<std::size_t>(v)]);
  const Vec3 n = a.normals[face];
  const std::vector<int>& around = a.faces[face];
  for (std::size_t k = 0; k < around.size(); ++k) {
    const Vec3 from = a.vertices[static_cast<std::size_t>(around[k])],
               to = a.vertices[static_cast<std::size_t>(around[(k + 1) % around.size()])],
               inward = cross(n, to - from);
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec3 &x = polygon[i], &y = polygon[(i + 1) % polygon.size()];
      const double s = dot(inward, x - from), t = dot(inward, y - from);
      if (s >= 0) next.push_back(x);
      if ((s >= 0) != (t >= 0)) next.push_back(x + (y - x) * (s / (s - t)));
    }
    polygon.swap(next);
    if (polygon.size() < 3) return {0, {}};
  }
  double area = 0;
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const double part = std::fabs(dot(n, cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]))) / 2;
    area += part;
    sum += (polygon[0] + polygon[k] + polygon[k + 1]) * (part / 3);
  }
  return {area, area > 0 ? sum / area : Vec3{}};
}

class ContactFinder {
 public:
  ContactFinder(Fracture& out, double size) : out_(out), size_(size) {
    for (const ConvexPart& piece : out.pieces) {
      hulls_.push_back(convexHull(piece.points, "piece"));
      boxes_.emplace_back(piece.points);
      rootOf_.push_back(static_cast<int>(rootOf_.size()));
    }
  }

  void run() {
    const auto count = static_cast<int>(hulls_.size());
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b)
        if (box(a).reaches(box(b), kTouching * size_)) findBetween(a, b);
    // Small contacts would carry as much as large ones and break first: they stay only where nothing else
    // holds a piece.
    std::stable_sort(small_.begin(), small_.end(),
                     [](const auto& p, const auto& q) { return p.area > q.area; });
    for (const Fracture::Contact& contact : small_)
      if (root(contact.a) != root(contact.b)) add(contact);
    // Pieces that only a sliver held are held by what is nearest.
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b)
        if (root(a) != root(b) && box(a).reaches(box(b), kGap * size_)) bridge(a, b);
  }

 private:
  const Box& box(int i) const { return boxes_[static_cast<std::size_t>(i)]; }
  const Hull& hull(int i) const { return hulls_[static_cast<std::size_t>(i)]; }
  int root(int i) const {
    while (rootOf_[static_cast<std::size_t>(i)] != i) i = rootOf_[static_cast<std::size_t>(i)];
    return i;
  }
  void add(const Fracture::Contact& contact) {
    out_.contacts.push_back(contact);
    rootOf_[static_cast<std::size_t>(root(contact.b))] = root(contact.a);
  }

  void findBetween(int a, int b) {
    Fracture::Contact best{a, b, {}, {}, 0};
    for (std::size_t f = 0; f < hull(a).faces.size(); ++f)
      for (std::size_t g = 0; g < hull(b).faces.size(); ++g) {
        const Vec3& n = hull(a).normals[f];
        if (dot(n, hull(b).normals[g]) > -kParallel) continue;
        const Vec3& x = hull(a).vertices[static_cast<std::size_t>(hull(a).faces[f][0])];
        const Vec3& y = hull(b).vertices[static_cast<std::size_t>(hull(b).faces[g][0])];
        if (std::fabs(dot(n, y - x)) > kTouching * size_) continue;
        const auto [area, middle] = overlap(hull(a), f, hull(b), g);
        if (area > best.area) best.area = area, best.center = middle, best.normal = n;
      }
    if (best.area > kSmallContact * size_ * size_)
      add(best);
    else if (best.area > kTouching * size_ * size_)
      small_.push_back(best);
  }

  void bridge(int a, int b) {
    double nearest = kGap * size_;
    Vec3 from, to;
    for (const Vec3& x : hull(a).vertices)
      for (const Vec3& y : hull(b).vertices)
        if (length(y - x) < nearest) nearest = length(y - x), from = x, to = y;
    if (nearest < kGap * size_)
      add({a, b, (from + to) * 0.5, normalize(to - from), kSmallContact * size_ * size_});
  }

  Fracture& out_;
  double size_;  ///< edge of a cube of the mean volume [m]
  std::vector<Hull> hulls_;
  std::vector<Box> boxes_;
  std::vector<Fracture::Contact> small_;
  std::vector<int> rootOf_;  ///< connected pieces have one root
};

}  // namespace

Fracture fracture(const TriangleMesh& surface, int count, std::uint64_t seed, const Path& path) {
  if (!hasHulls()) throw Error(path, "a build with qhull (package libqhull-dev)", "one without");
  if (count < 1) throw Error(path + ".pieces", "a number above 0", std::to_string(count));
  validateClosed(surface, path);
  const CutSurface whole(surface);
  const CutSolid solid(whole);
  const double volume = solid.volume();
  const std::vector<Vec3> seeds = seedsIn(whole, count, seed);
  std::vector<HulledSolid> solids;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    CutSolid piece = solid;
    for (const Plane& plane : cellPlanes(seeds, i, solid.cell())) piece = piece.cut(plane).first;
    HulledSolid one = hulled(std::move(piece));
    if (!one.hull.empty()) solids.push_back(std::move(one));
  }
  cutUntilConvex(solids, kConcavity * volume, kMostPerPiece * solids.size());

  Fracture out;
  const double mean = volume / count;
  out.lost = volume;
  for (HulledSolid& one : solids) {
    if (one.hull.empty() || one.hullVolume < kSliver * mean) continue;
    out.lost -= one.volume;
    out.pieces.push_back({std::move(one.hull), one.hullVolume});
  }
  out.lost = std::max(0.0, out.lost);
  ContactFinder(out, portable::cbrt(mean)).run();
  return out;
}

}  // namespace rubble

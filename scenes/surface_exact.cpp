#include "surface_exact.h"
#include "math/portable.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <unordered_map>

namespace rubble::scenes {
namespace {

struct Box {
  Vec3 low, high;
  bool meets(const Box& o) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > o.high[k] || o.low[k] > high[k]) return false;
    return true;
  }
};

/// Corners are numbered through all objects.
struct Parts {
  std::vector<Vec3> x;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 3>> triangles;

  explicit Parts(const std::vector<World::Surface>& surfaces) {
    std::set<std::array<int, 2>> unique;
    for (const World::Surface& s : surfaces) {
      const int first = int(x.size());
      x.insert(x.end(), s.vertices.begin(), s.vertices.end());
      const auto edge = [&](int a, int b) {
        unique.insert({first + std::min(a, b), first + std::max(a, b)});
      };
      for (const auto& t : s.triangles) {
        triangles.push_back({first + t[0], first + t[1], first + t[2]});
        for (std::size_t k = 0; k < 3; ++k) edge(t[k], t[(k + 1) % 3]);
      }
      if (s.triangles.empty())
        for (const auto& e : s.segments) edge(e[0], e[1]);
    }
    edges.assign(unique.begin(), unique.end());
  }
  const Vec3& at(int v) const { return x[std::size_t(v)]; }
  template <std::size_t N> Box box(const std::array<int, N>& v) const {
    Box b{at(v[0]), at(v[0])};
    for (const int corner : v)
      for (int k = 0; k < 3; ++k)
        b.low[k] = std::min(b.low[k], at(corner)[k]), b.high[k] = std::max(b.high[k], at(corner)[k]);
    return b;
  }
};

/// Is there an axis along which all of `p` lie on one side of all of `q`?
bool separated(const Vec3* p, int np, const Vec3* q, int nq, const Vec3& axis) {
  // products and sums of three terms of coordinates that are of the size of the parts
  constexpr double kRoundOff = 1e-14;
  double pLow = 1e300, pHigh = -1e300, qLow = 1e300, qHigh = -1e300, size = 0;
  for (int i = 0; i < np; ++i)
    pLow = std::min(pLow, dot(axis, p[i])), pHigh = std::max(pHigh, dot(axis, p[i])),
    size = std::max(size, length(p[i]));
  for (int i = 0; i < nq; ++i)
    qLow = std::min(qLow, dot(axis, q[i])), qHigh = std::max(qHigh, dot(axis, q[i])),
    size = std::max(size, length(q[i]));
  return std::max(pLow - qHigh, qLow - pHigh) > kRoundOff * size * length(axis);
}

bool meet(const Parts& parts, const std::array<int, 2>& edge, const std::array<int, 3>& triangle) {
  const Vec3& origin = parts.at(triangle[0]);
  const Vec3 t[3] = {{}, parts.at(triangle[1]) - origin, parts.at(triangle[2]) - origin};
  const Vec3 e[2] = {parts.at(edge[0]) - origin, parts.at(edge[1]) - origin};
  const Vec3 n = cross(t[1], t[2]), d = e[1] - e[0], side[3] = {t[1], t[2] - t[1], t[2]};
  if (separated(e, 2, t, 3, n) || separated(e, 2, t, 3, cross(n, d))) return false;
  for (const Vec3& s : side)
    if (separated(e, 2, t, 3, cross(d, s)) || separated(e, 2, t, 3, cross(n, s))) return false;
  return true;
}

/// Boxes by the cells that they overlap.
class Cells {
 public:
  explicit Cells(double size) : size_(size) {}
  void add(const Box& box, int index) {
    visit(box, [&](std::uint64_t key) { cells_[key].push_back(index); });
  }
  template <class Found> void seek(const Box& box, Found&& found) const {
    visit(box, [&](std::uint64_t key) {
      const auto cell = cells_.find(key);
      if (cell == cells_.end()) return;
      for (const int index : cell->second) found(index);
    });
  }

 private:
  template <class Visit> void visit(const Box& box, Visit&& visit) const {
    long low[3], high[3];
    for (int k = 0; k < 3; ++k)
      low[k] = std::lround(std::floor(box.low[k] / size_)),
      high[k] = std::lround(std::floor(box.high[k] / size_));
    for (long z = low[2]; z <= high[2]; ++z)
      for (long y = low[1]; y <= high[1]; ++y)
        for (long x = low[0]; x <= high[0]; ++x)
          visit(std::uint64_t(x) * 73856093u ^ std::uint64_t(y) * 19349663u ^ std::uint64_t(z) * 83492791u);
  }
  double size_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

double meanEdge(const Parts& parts) {
  double sum = 0;
  for (const auto& e : parts.edges) sum += length(parts.at(e[0]) - parts.at(e[1]));
  return parts.edges.empty() ? 1 : sum / double(parts.edges.size());
}

std::vector<World::Surface> surfacesOf(const World& world) {
  std::vector<World::Surface> out;
  for (const DeformableId id : world.deformables()) out.push_back(world.surface(id));
  return out;
}

double segmentDistance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // the least over s of the distance of a point of ab from cd is that of a convex function
  const auto fromOther = [&](double s) {
    const Vec3 p = a + (b - a) * s, e = d - c;
    const double t = std::clamp(dot(p - c, e) / std::max(dot(e, e), 1e-300), 0., 1.);
    return length(p - c - e * t);
  };
  double low = 0, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double u = low + (high - low) / 3, v = high - (high - low) / 3;
    if (fromOther(u) < fromOther(v))
      high = v;
    else
      low = u;
  }
  return fromOther((low + high) / 2);
}

}  // namespace

int countCrossings(const std::vector<World::Surface>& surfaces) {
  const Parts parts(surfaces);
  Cells cells(meanEdge(parts));
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < parts.triangles.size(); ++i) {
    boxes.push_back(parts.box(parts.triangles[i]));
    cells.add(boxes.back(), int(i));
  }
  int crossings = 0;
  std::vector<int> near;
  for (const auto& edge : parts.edges) {
    const Box box = parts.box(edge);
    near.clear();
    cells.seek(box, [&](int i) {
      if (box.meets(boxes[std::size_t(i)])) near.push_back(i);
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    for (const int i : near) {
      const auto& t = parts.triangles[std::size_t(i)];
      const bool shared = std::any_of(t.begin(), t.end(),
                                      [&](int v) { return v == edge[0] || v == edge[1]; });
      crossings += !shared && meet(parts, edge, t);
    }
  }
  return crossings;
}

int countCrossings(const World& world) { return countCrossings(surfacesOf(world)); }

double closestSegments(const World& world) {
  struct Segment {
    Vec3 a, b;
    int object, index;
    int around;  ///< segments of a ring; more than there are of an open line
    double radius;
  };
  std::vector<Segment> segments;
  double longest = 1e-9;
  int object = 0;
  for (const World::Surface& s : surfacesOf(world)) {
    const bool closed = !s.segments.empty() && s.segments.back()[1] == s.segments.front()[0];
    if (s.triangles.empty())
      for (std::size_t i = 0; i < s.segments.size(); ++i) {
        const Vec3 &a = s.vertices[std::size_t(s.segments[i][0])],
                   &b = s.vertices[std::size_t(s.segments[i][1])];
        segments.push_back({a, b, object, int(i), closed ? int(s.segments.size()) : 1 << 30, s.radius});
        longest = std::max(longest, length(a - b) + 2 * s.radius);
      }
    ++object;
  }
  const auto boxOf = [](const Segment& s) {
    Box b;
    for (int k = 0; k < 3; ++k)
      b.low[k] = std::min(s.a[k], s.b[k]) - s.radius, b.high[k] = std::max(s.a[k], s.b[k]) + s.radius;
    return b;
  };
  Cells cells(longest);
  for (std::size_t i = 0; i < segments.size(); ++i) cells.add(boxOf(segments[i]), int(i));
  double closest = 1e30;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& s = segments[i];
    cells.seek(boxOf(s), [&](int k) {
      const Segment& o = segments[std::size_t(k)];
      if (std::size_t(k) <= i) return;
      const int apart = std::abs(s.index - o.index);
      if (s.object == o.object && std::min(apart, s.around - apart) <= 2) return;
      closest = std::min(closest, segmentDistance(s.a, s.b, o.a, o.b) / (s.radius + o.radius));
    });
  }
  return closest;
}

double linkingNumber(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  const auto angle = [](const Vec3& u, const Vec3& v, const Vec3& w) {
    const double lu = length(u), lv = length(v), lw = length(w);
    return 2 * portable::atan2(dot(u, cross(v, w)),
                               lu * lv * lw + dot(u, v) * lw + dot(v, w) * lu + dot(w, u) * lv);
  };
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 &p = a[i], &q = a[(i + 1) % a.size()], &r = b[j], &s = b[(j + 1) % b.size()];
      // the parallelogram of differences, seen from the origin, as two triangles
      sum += angle(r - p, r - q, s - q) + angle(r - p, s - q, s - p);
    }
  return sum / (4 * std::numbers::pi);
}

}  // namespace rubble::scenes

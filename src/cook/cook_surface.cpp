#include <rubble/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "cook/checks.h"
#include "cook/cook.h"

namespace rubble::cooking {

namespace {

/// Faces that meet at less than this angle from flat count as one (3 degrees).
constexpr double kFlatCosine = .99863;
/// Twice the area of a triangle [m2]. Normals and closest points take its square in single precision, whose
/// numbers go from 1e-38 to 3e38.
constexpr double kLeastArea = 1e-18, kMostArea = 1e18;

struct Range {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(const Vec3& x) {
    for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
  }
  void add(const Range& r) { add(r.low), add(r.high); }
  Vec3 middle() const { return (low + high) * .5; }
};

Vec3 at(const std::vector<Vec3>& points, int i) { return points[static_cast<std::size_t>(i)]; }

void checkArea(const std::vector<Vec3>& points, const std::array<int, 3>& triangle, const Path& path) {
  const Vec3 a = at(points, triangle[0]);
  const double twice = length(cross(at(points, triangle[1]) - a, at(points, triangle[2]) - a));
  if (!(twice >= kLeastArea && twice <= kMostArea))
    throw Error(path,
                "triangles with an area of " + checks::text(kLeastArea / 2) + " to " +
                    checks::text(kMostArea / 2) + " [m2]",
                checks::text(twice / 2));
}

/// A bounding volume tree over triangles in depth-first order, one triangle per leaf.
class TreeBuilder {
 public:
  struct Node {
    Range box;
    int skip = 0;       ///< next node if this one is not entered
    int triangle = -1;  ///< index in the new order, -1: inner node
  };
  TreeBuilder(const std::vector<Range>& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, order_.size());
  }
  std::vector<Node> nodes;
  const std::vector<int>& order() const { return order_; }

 private:
  void build(std::size_t begin, std::size_t end) {
    const std::size_t own = nodes.size();
    nodes.emplace_back();
    Range box, middles;
    for (std::size_t i = begin; i < end; ++i) {
      const Range& b = boxes_[static_cast<std::size_t>(order_[i])];
      box.add(b);
      middles.add(b.middle());
    }
    if (end - begin == 1) {
      nodes[own].triangle = static_cast<int>(begin);
    } else {
      const Vec3 size = middles.high - middles.low;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      const std::size_t half = begin + (end - begin) / 2;
      const auto less = [&](int a, int b) {
        const double x = boxes_[static_cast<std::size_t>(a)].middle()[axis],
                     y = boxes_[static_cast<std::size_t>(b)].middle()[axis];
        return x != y ? x < y : a < b;
      };
      std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                       order_.begin() + static_cast<std::ptrdiff_t>(half),
                       order_.begin() + static_cast<std::ptrdiff_t>(end), less);
      build(begin, half);
      build(half, end);
    }
    nodes[own].box = box;
    nodes[own].skip = static_cast<int>(nodes.size());
  }

  const std::vector<Range>& boxes_;
  std::vector<int> order_;
};

void setBounds(CookedShape& out, const Range& box) {
  out.unit.center = box.middle();
  out.shape.half = (box.high - box.low) * .5;
  out.radius = length(out.shape.half);
}

}  // namespace

std::vector<int> touchableEdges(const std::vector<Vec3>& points,
                                const std::vector<std::array<int, 3>>& triangles, bool twoSided,
                                std::vector<int>* beyond) {
  // merge corners at equal positions
  std::map<std::array<double, 3>, int> places;
  std::vector<int> weld(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    weld[i] = places.try_emplace({points[i].x, points[i].y, points[i].z}, static_cast<int>(i)).first->second;

  struct Side {
    int triangle, edge;
  };
  std::map<std::pair<int, int>, std::vector<Side>> edges;
  const auto corner = [&](int t, int k) {
    return weld[static_cast<std::size_t>(
        triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k % 3)])];
  };
  const auto normal = [&](int t) {
    const Vec3 a = at(points, corner(t, 0));
    return normalize(cross(at(points, corner(t, 1)) - a, at(points, corner(t, 2)) - a));
  };
  const int count = static_cast<int>(triangles.size());
  for (int t = 0; t < count; ++t)
    for (int e = 0; e < 3; ++e) edges[std::minmax(corner(t, e), corner(t, e + 1))].push_back({t, e});

  if (beyond) {
    beyond->assign(3 * triangles.size(), -1);
    for (const auto& [ends, sides] : edges)
      for (std::size_t k = 0; k < 2 && sides.size() == 2; ++k)
        (*beyond)[static_cast<std::size_t>(3 * sides[k].triangle + sides[k].edge)] = corner(
            sides[1 - k].triangle, sides[1 - k].edge + 2);
  }
  std::vector<int> flags(triangles.size());
  // front faces, then back faces six bits higher
  for (int face = 0; face < (twoSided ? 2 : 1); ++face) {
    const int shift = 6 * face;
    std::vector<bool> touchable(points.size());
    for (const auto& [ends, sides] : edges) {
      bool active = true;
      if (sides.size() == 2) {
        const Vec3 n0 = normal(sides[0].triangle), n1 = normal(sides[1].triangle);
        const double opposite = dot(
            n0, at(points, corner(sides[1].triangle, sides[1].edge + 2)) - at(points, ends.first));
        active = dot(n0, n1) <= kFlatCosine && (face == 0 ? opposite < 0 : opposite > 0);
      }
      if (!active) continue;
      for (const Side& s : sides) flags[static_cast<std::size_t>(s.triangle)] |= 1 << (s.edge + shift);
      touchable[static_cast<std::size_t>(ends.first)] = touchable[static_cast<std::size_t>(
          ends.second)] = true;
    }
    for (int t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k)
        if (touchable[static_cast<std::size_t>(corner(t, k))])
          flags[static_cast<std::size_t>(t)] |= 8 << (k + shift);
  }
  return flags;
}

void addMesh(CookedShape& out, const Shape& shape, const Path& path) {
  const ShapeGeometry& g = *shape.geometry;
  Range whole;
  std::vector<Range> boxes(g.triangles.size());
  for (std::size_t t = 0; t < g.triangles.size(); ++t) {
    for (const int v : g.triangles[t]) boxes[t].add(at(g.points, v));
    checkArea(g.points, g.triangles[t], (path + ".triangles")[t]);
    whole.add(boxes[t]);
  }
  setBounds(out, whole);
  const TreeBuilder tree(boxes);
  std::vector<int> beyond;
  const std::vector<int> flags = touchableEdges(g.points, g.triangles, g.twoSided, &beyond);
  const int header = beginHeader(out, 6);
  const auto set = [&](int k, std::size_t value) {
    out.indices[static_cast<std::size_t>(header + k)] = static_cast<int>(value);
  };
  set(2, tree.nodes.size()), set(3, g.triangles.size()), set(4, g.points.size()), set(5, g.twoSided);
  out.shape.kind = ShapeKind::Mesh;
  out.shape.data = header;
  const Vec3 c = out.unit.center;
  for (const auto& node : tree.nodes) {
    const Vec3 low = node.box.low - c, high = node.box.high - c;
    out.vectors.push_back({low.x, low.y, low.z, 0});
    out.vectors.push_back({high.x, high.y, high.z, 0});
    out.indices.push_back(node.skip);
    out.indices.push_back(node.triangle);
  }
  for (const Vec3& p : g.points) out.vectors.push_back({p.x - c.x, p.y - c.y, p.z - c.z, 0});
  out.triangleOrder.assign(tree.order().begin(), tree.order().end());
  for (const int t : tree.order())
    for (const int v : g.triangles[static_cast<std::size_t>(t)]) out.indices.push_back(v);
  for (const int t : tree.order()) out.indices.push_back(flags[static_cast<std::size_t>(t)]);
  for (const int t : tree.order())
    for (int e = 0; e < 3; ++e) out.indices.push_back(beyond[static_cast<std::size_t>(3 * t + e)]);
}

void addHeightField(CookedShape& out, const Shape& shape, const Path& path) {
  const ShapeGeometry& g = *shape.geometry;
  const int nx = g.counts[0], ny = g.counts[1];
  Range whole;
  std::vector<Vec3> points;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      points.push_back({i * g.spacing.x, j * g.spacing.y, g.samples[static_cast<std::size_t>(j * nx + i)]});
      whole.add(points.back());
    }
  setBounds(out, whole);
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      const int a = j * nx + i;
      triangles.push_back({a, a + 1, a + nx + 1});
      triangles.push_back({a, a + nx + 1, a + nx});
    }
  for (const auto& triangle : triangles) checkArea(points, triangle, path + ".spacing");
  const std::vector<int> flags = touchableEdges(points, triangles, false);
  const int header = beginHeader(out, 4);
  out.indices[static_cast<std::size_t>(header) + 2] = nx;
  out.indices[static_cast<std::size_t>(header) + 3] = ny;
  out.shape.kind = ShapeKind::HeightField;
  out.shape.data = header;
  const Vec3 c = out.unit.center;
  out.vectors.push_back({g.spacing.x, g.spacing.y, whole.low.z - c.z, whole.high.z - c.z});
  out.vectors.push_back({-c.x, -c.y, 0, 0});
  for (std::size_t k = 0; k < g.samples.size(); k += 4) {
    const auto sample = [&](std::size_t i) { return i < g.samples.size() ? g.samples[i] - c.z : 0.0; };
    out.vectors.push_back({sample(k), sample(k + 1), sample(k + 2), sample(k + 3)});
  }
  out.indices.insert(out.indices.end(), flags.begin(), flags.end());
}

}  // namespace rubble::cooking

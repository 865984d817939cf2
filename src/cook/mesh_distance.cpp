/// Distance fields of closed surfaces: exact near the surface, elsewhere the distance to the nearest triangle
/// of a neighbor (Bridson's level sets by sweeping).
#include <algorithm>
#include <cmath>

#include <rubble/error.h>
#include <rubble/mesh.h>

#include "cook/solid_cut.h"

namespace rubble {

namespace {

/// Layers of samples around the surface with exact distances, and of samples around its box.
constexpr int kBand = 2, kMargin = 2;
constexpr int kLeastCells = 4, kMostCells = 256;

/// Distance from a point to a triangle [m] (Ericson 2005, 5.1.5).
double distanceTo(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return length(ap);
  if (d3 >= 0 && d4 <= d3) return length(bp);
  if (d6 >= 0 && d5 <= d6) return length(cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return length(ap - ab * (d1 / (d1 - d3)));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return length(ap - ac * (d2 / (d2 - d6)));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return length(bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  return length(ap - ab * (vb / sum) - ac * (vc / sum));
}

class Sampler {
 public:
  Sampler(const TriangleMesh& mesh, int cells) : mesh_(mesh) {
    Vec3 low = mesh.vertices[0], high = low;
    for (const Vec3& x : mesh.vertices)
      for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], x[i]), high[i] = std::max(high[i], x[i]);
    const Vec3 size = high - low;
    spacing_ = std::max({size.x, size.y, size.z}) / cells;
    origin_ = low - Vec3{1, 1, 1} * (kMargin * spacing_);
    for (int i = 0; i < 3; ++i)
      counts_[static_cast<std::size_t>(i)] = static_cast<int>(std::ceil(size[i] / spacing_ - 1e-9)) + 1 +
                                             2 * kMargin;
    const auto all = static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) *
                     static_cast<std::size_t>(counts_[2]);
    distance_.assign(all, std::numeric_limits<double>::infinity());
    nearest_.assign(all, -1);
  }

  Shape run() {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) sampleAround(t);
    for (int pass = 0; pass < 2; ++pass)
      for (int corner = 0; corner < 8; ++corner) sweep(corner & 1, corner & 2, corner & 4);
    const CutSurface whole(mesh_);
    for (int k = 0; k < counts_[2]; ++k)
      for (int j = 0; j < counts_[1]; ++j)
        for (int i = 0; i < counts_[0]; ++i)
          if (distance_[number(i, j, k)] < kBand * spacing_ || i == 0)
            setSign(whole, i, j, k);
          else
            distance_[number(i, j, k)] *= distance_[number(i - 1, j, k)] < 0 ? -1 : 1;
    return Shape::distanceField(counts_, origin_, spacing_, std::move(distance_));
  }

 private:
  std::size_t number(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(counts_[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(counts_[0]) +
           static_cast<std::size_t>(i);
  }
  Vec3 place(int i, int j, int k) const { return origin_ + Vec3(i, j, k) * spacing_; }

  void tryTriangle(int i, int j, int k, int t) {
    if (t < 0) return;
    const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)];
    const auto at = [&](std::size_t c) { return mesh_.vertices[static_cast<std::size_t>(corners[c])]; };
    const double d = distanceTo(place(i, j, k), at(0), at(1), at(2));
    const std::size_t n = number(i, j, k);
    if (d < distance_[n]) distance_[n] = d, nearest_[n] = t;
  }

  void sampleAround(int t) {
    std::array<int, 3> first, last;
    for (int axis = 0; axis < 3; ++axis) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const int v : mesh_.triangles[static_cast<std::size_t>(t)]) {
        const double x = mesh_.vertices[static_cast<std::size_t>(v)][axis];
        low = std::min(low, x), high = std::max(high, x);
      }
      const auto a = static_cast<std::size_t>(axis);
      first[a] = std::max(0, static_cast<int>((low - origin_[axis]) / spacing_) - kBand);
      last[a] = std::min(counts_[a] - 1, static_cast<int>((high - origin_[axis]) / spacing_) + kBand + 1);
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i) tryTriangle(i, j, k, t);
  }

  /// From one corner of the lattice to the opposite one.
  void sweep(bool backX, bool backY, bool backZ) {
    const auto at = [](bool back, int k, int count) { return back ? count - 1 - k : k; };
    for (int c = 0; c < counts_[2]; ++c)
      for (int b = 0; b < counts_[1]; ++b)
        for (int a = 0; a < counts_[0]; ++a) {
          const int i = at(backX, a, counts_[0]), j = at(backY, b, counts_[1]), k = at(backZ, c, counts_[2]);
          if (a > 0) tryTriangle(i, j, k, nearest_[number(backX ? i + 1 : i - 1, j, k)]);
          if (b > 0) tryTriangle(i, j, k, nearest_[number(i, backY ? j + 1 : j - 1, k)]);
          if (c > 0) tryTriangle(i, j, k, nearest_[number(i, j, backZ ? k + 1 : k - 1)]);
        }
  }

  void setSign(const CutSurface& whole, int i, int j, int k) {
    if (whole.isInside(place(i, j, k))) distance_[number(i, j, k)] *= -1;
  }

  const TriangleMesh& mesh_;
  double spacing_;
  Vec3 origin_;
  std::array<int, 3> counts_{};
  std::vector<double> distance_;
  std::vector<int> nearest_;
};

}  // namespace

Shape distanceFieldOf(const TriangleMesh& surface, int cells, const Path& path) {
  if (cells < kLeastCells || cells > kMostCells)
    throw Error(path + ".cells", std::to_string(kLeastCells) + " to " + std::to_string(kMostCells),
                std::to_string(cells));
  validateClosed(surface, path);
  return Sampler(surface, cells).run();
}

}  // namespace rubble

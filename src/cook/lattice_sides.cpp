#include "cook/lattice_sides.h"

#include <algorithm>
#include <cmath>

#include <rubble/error.h>

namespace rubble {

namespace {

constexpr int kMostLatticeCells = 1 << 26;
/// Offset of the lattice in cells [1]. It avoids that rows of the lattice contain corners and edges of
/// surfaces with round coordinates.
constexpr Vec3 kShift{.0137, .0071, .0193};

/// Tests whether the row along x through (y, z) crosses a triangle: 1 inward, -1 outward, 0 no. Both
/// triangles at an edge compute it from the same numbers, so no row passes between them.
int passes(const TriangleMesh& mesh, const std::array<int, 3>& t, double y, double z, double& x) {
  double side[3];
  int sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int from = t[k], to = t[(k + 1) % 3];
    const Vec3 &a = mesh.vertices[static_cast<std::size_t>(std::min(from, to))],
               &b = mesh.vertices[static_cast<std::size_t>(std::max(from, to))];
    const double own = (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
    const double sign = from < to ? 1 : -1;
    side[k] = sign * own;
    sum += (own >= 0 ? 1 : -1) * (from < to ? 1 : -1);
  }
  if (sum != 3 && sum != -3) return 0;
  const double all = side[0] + side[1] + side[2];
  if (all == 0) return 0;
  const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])].x; };
  // the edge function of an edge weights the opposite corner
  x = (side[0] * at(2) + side[1] * at(0) + side[2] * at(1)) / all;
  // counter-clockwise about x: the normal points along x, so the row leaves the solid
  return sum > 0 ? -1 : 1;
}

/// Parameter from 0 to 1 at which the segment `from`, `along` crosses a triangle; 2: no crossing.
double meets(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e1 = b - a, e2 = c - a, p = cross(along, e2);
  const double det = dot(e1, p);
  if (det == 0) return 2;
  const Vec3 s = from - a, q = cross(s, e1);
  // tolerance at the rim: a segment through an edge must not pass between its triangles
  constexpr double kRim = 1e-9;
  const double u = dot(s, p) / det, v = dot(along, q) / det, t = dot(e2, q) / det;
  return u >= -kRim && v >= -kRim && u + v <= 1 + kRim && t >= 0 && t <= 1 ? t : 2;
}

}  // namespace

SidesOfLattice::SidesOfLattice(const TriangleMesh& surface, double cell, const Path& path)
    : surface_(surface), cell_(cell) {
  Vec3 low = surface.vertices[static_cast<std::size_t>(surface.triangles[0][0])], high = low;
  for (const auto& t : surface.triangles)
    for (const int v : t)
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], surface.vertices[static_cast<std::size_t>(v)][axis]);
        high[axis] = std::max(high[axis], surface.vertices[static_cast<std::size_t>(v)][axis]);
      }
  first_ = low - cell * (Vec3{1, 1, 1} + kShift);
  double all = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = std::ceil((high[axis] - first_[axis]) / cell) + 1;
    all *= count;
    if (!(all < kMostLatticeCells))
      throw Error(path + ".cell",
                  "a width that gives fewer than " + std::to_string(kMostLatticeCells) + " cells",
                  std::to_string(cell) + " m");
    cells_[static_cast<std::size_t>(axis)] = static_cast<int>(count);
  }
  corners_ = (cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1);
  bucketTriangles();
}

std::array<int, 3> SidesOfLattice::indexOf(int point) const {
  const bool center = point >= corners_;
  const int i = center ? point - corners_ : point, nx = cells_[0] + (center ? 0 : 1),
            ny = cells_[1] + (center ? 0 : 1);
  return {i % nx, i / nx % ny, i / nx / ny};
}

Vec3 SidesOfLattice::place(int point) const {
  const std::array<int, 3> at = indexOf(point);
  const double half = point >= corners_ ? .5 : 0;
  return first_ + cell_ * Vec3{at[0] + half, at[1] + half, at[2] + half};
}

void SidesOfLattice::findSides(std::vector<signed char>& side) const {
  side.assign(static_cast<std::size_t>(points()), -1);
  markRows(false, side);
  markRows(true, side);
}

void SidesOfLattice::markRows(bool centers, std::vector<signed char>& side) const {
  const int more = centers ? 0 : 1, nx = cells_[0] + more, ny = cells_[1] + more, nz = cells_[2] + more;
  const double half = centers ? .5 : 0;
  struct Pass {
    double x;
    int way;
  };
  std::vector<std::vector<Pass>> rows(static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz));
  const auto rowOf = [&](int y, int z) -> std::vector<Pass>& {
    return rows[static_cast<std::size_t>(z) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)];
  };
  for (const auto& t : surface_.triangles) {
    const auto range = [&](int axis, int count) {
      double low = surface_.vertices[static_cast<std::size_t>(t[0])][axis], high = low;
      for (const int v : t)
        low = std::min(low, surface_.vertices[static_cast<std::size_t>(v)][axis]),
        high = std::max(high, surface_.vertices[static_cast<std::size_t>(v)][axis]);
      const auto index = [&](double a) {
        return static_cast<int>(std::floor((a - first_[axis]) / cell_ - half));
      };
      return std::pair{std::max(0, index(low)), std::min(count - 1, index(high) + 1)};
    };
    const auto [y0, y1] = range(1, ny);
    const auto [z0, z1] = range(2, nz);
    for (int z = z0; z <= z1; ++z)
      for (int y = y0; y <= y1; ++y) {
        Pass pass{};
        pass.way = passes(surface_, t, first_.y + cell_ * (y + half), first_.z + cell_ * (z + half), pass.x);
        if (pass.way != 0) rowOf(y, z).push_back(pass);
      }
  }
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y) {
      std::vector<Pass>& row = rowOf(y, z);
      std::sort(row.begin(), row.end(),
                [](const Pass& a, const Pass& b) { return a.x != b.x ? a.x < b.x : a.way > b.way; });
      int winding = 0;
      std::size_t next = 0;
      for (int x = 0; x < nx; ++x) {
        const double here = first_.x + cell_ * (x + half);
        for (; next < row.size() && row[next].x <= here; ++next) winding += row[next].way;
        if (winding > 0) side[static_cast<std::size_t>(number(centers, x, y, z))] = 1;
      }
    }
}

void SidesOfLattice::bucketTriangles() {
  const auto forEachBucket = [&](const std::array<int, 3>& t, auto&& visit) {
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      double a = surface_.vertices[static_cast<std::size_t>(t[0])][axis], b = a;
      for (const int v : t)
        a = std::min(a, surface_.vertices[static_cast<std::size_t>(v)][axis]),
        b = std::max(b, surface_.vertices[static_cast<std::size_t>(v)][axis]);
      low[axis] = std::max(0, static_cast<int>(std::floor((a - first_[axis]) / cell_)));
      high[axis] = std::min(cells_[static_cast<std::size_t>(axis)] - 1,
                            static_cast<int>(std::floor((b - first_[axis]) / cell_)));
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x)
          visit(static_cast<std::size_t>((z * cells_[1] + y) * cells_[0] + x));
  };
  bucketBegin_.assign(static_cast<std::size_t>(cellCount()) + 1, 0);
  for (const auto& t : surface_.triangles)
    forEachBucket(t, [&](std::size_t bucket) { ++bucketBegin_[bucket + 1]; });
  for (std::size_t k = 1; k < bucketBegin_.size(); ++k) bucketBegin_[k] += bucketBegin_[k - 1];
  bucketTriangle_.resize(static_cast<std::size_t>(bucketBegin_.back()));
  std::vector<int> fill(bucketBegin_.begin(), bucketBegin_.end() - 1);
  for (std::size_t i = 0; i < surface_.triangles.size(); ++i)
    forEachBucket(surface_.triangles[i], [&](std::size_t bucket) {
      bucketTriangle_[static_cast<std::size_t>(fill[bucket]++)] = static_cast<int>(i);
    });
}

Vec3 SidesOfLattice::cut(int inside, int outside) const {
  const Vec3 from = place(inside), along = place(outside) - from;
  int low[3], high[3];
  for (int axis = 0; axis < 3; ++axis) {
    // a segment along the border of two cells searches both
    constexpr double kBorder = 1e-6;
    const double a = (std::min(from[axis], from[axis] + along[axis]) - first_[axis]) / cell_,
                 b = (std::max(from[axis], from[axis] + along[axis]) - first_[axis]) / cell_;
    low[axis] = std::max(0, static_cast<int>(std::floor(a - kBorder)));
    high[axis] = std::min(cells_[static_cast<std::size_t>(axis)] - 1,
                          static_cast<int>(std::floor(b + kBorder)));
  }
  double nearest = 2;
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const auto bucket = static_cast<std::size_t>((z * cells_[1] + y) * cells_[0] + x);
        for (int k = bucketBegin_[bucket]; k < bucketBegin_[bucket + 1]; ++k) {
          const auto&
              t = surface_.triangles[static_cast<std::size_t>(bucketTriangle_[static_cast<std::size_t>(k)])];
          nearest = std::min(nearest, meets(from, along, surface_.vertices[static_cast<std::size_t>(t[0])],
                                            surface_.vertices[static_cast<std::size_t>(t[1])],
                                            surface_.vertices[static_cast<std::size_t>(t[2])]));
        }
      }
  // round-off may miss a surface that grazes an end
  return from + (nearest <= 1 ? nearest : .5) * along;
}

}  // namespace rubble

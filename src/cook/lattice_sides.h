#pragma once
/// A body-centered cubic lattice around a closed surface: inside test of its points, and intersections of its
/// edges with the surface.
#include <array>
#include <string>
#include <vector>

#include <rubble/mesh.h>

namespace rubble {

/// Point indices: corners of cells first, then centers of cells, x fastest.
class SidesOfLattice {
 public:
  /// Throws Error if there are too many cells.
  SidesOfLattice(const TriangleMesh& surface, double cell, const Path& path);

  int points() const { return corners_ + cellCount(); }
  Vec3 place(int point) const;

  /// 1 for each point with winding number 1 or more, otherwise -1.
  void findSides(std::vector<signed char>& side) const;
  /// The intersection of the segment from an inside point to an outside point that is nearest to the first.
  Vec3 cut(int inside, int outside) const;

  /// Calls visit(neighbor, is the edge one cell long?) for the neighbors of a point.
  template <class Visit> void forEachNeighbor(int point, Visit&& visit) const {
    const bool center = point >= corners_;
    const std::array<int, 3> at = indexOf(point);
    const auto tryPoint = [&](bool isCenter, int x, int y, int z, bool isLong) {
      const int more = isCenter ? 0 : 1;
      if (x < 0 || y < 0 || z < 0 || x >= cells_[0] + more || y >= cells_[1] + more || z >= cells_[2] + more)
        return;
      visit(number(isCenter, x, y, z), isLong);
    };
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        std::array<int, 3> to = at;
        to[static_cast<std::size_t>(axis)] += step;
        tryPoint(center, to[0], to[1], to[2], true);
      }
    // center (i, j, k) lies between the corners (i, j, k) and (i + 1, j + 1, k + 1)
    for (int k = 0; k < 8; ++k) {
      const int dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
      if (center)
        tryPoint(false, at[0] + dx, at[1] + dy, at[2] + dz, false);
      else
        tryPoint(true, at[0] - dx, at[1] - dy, at[2] - dz, false);
    }
  }

  /// Calls visit(center, center, corners of their face in order) for every two adjacent cells.
  template <class Visit> void forEachFace(Visit&& visit) const {
    for (int z = 0; z < cells_[2]; ++z)
      for (int y = 0; y < cells_[1]; ++y)
        for (int x = 0; x < cells_[0]; ++x)
          for (int axis = 0; axis < 3; ++axis) {
            std::array<int, 3> next{x, y, z};
            if (++next[static_cast<std::size_t>(axis)] >= cells_[static_cast<std::size_t>(axis)]) continue;
            const auto u = static_cast<std::size_t>((axis + 1) % 3),
                       v = static_cast<std::size_t>((axis + 2) % 3);
            std::array<int, 4> corners;
            for (std::size_t k = 0; k < 4; ++k) {
              std::array<int, 3> c = next;
              c[u] += k == 1 || k == 2, c[v] += k >= 2;
              corners[k] = number(false, c[0], c[1], c[2]);
            }
            visit(number(true, x, y, z), number(true, next[0], next[1], next[2]), corners);
          }
  }

 private:
  int cellCount() const { return cells_[0] * cells_[1] * cells_[2]; }
  std::array<int, 3> indexOf(int point) const;
  int number(bool center, int x, int y, int z) const {
    const int more = center ? 0 : 1;
    return (center ? corners_ : 0) + (z * (cells_[1] + more) + y) * (cells_[0] + more) + x;
  }
  void markRows(bool centers, std::vector<signed char>& side) const;
  void bucketTriangles();

  const TriangleMesh& surface_;
  double cell_;
  Vec3 first_;  ///< the lowest corner
  std::array<int, 3> cells_{};
  int corners_ = 0;
  std::vector<int> bucketBegin_, bucketTriangle_;  ///< triangles whose boxes overlap a cell
};

}  // namespace rubble

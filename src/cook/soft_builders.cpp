#include <algorithm>
#include <cmath>

#include <rubble/deformables.h>
#include <rubble/error.h>

namespace rubble {

namespace {

/// Lattice points, and six tetrahedra per cell along the paths from one corner to the opposite one.
/// startsHigh(axis, cell): the path starts at the high end of that axis. It depends on the position along
/// that axis only, so neighboring cells match.
template <class StartsHigh>
TetSolidDef lattice(const Vec3& corner, const Vec3& size, const std::array<int, 3>& cells,
                    StartsHigh&& startsHigh) {
  const auto [nx, ny, nz] = cells;
  const auto index = [&, nx = nx, ny = ny](const int(&at)[3]) {
    return at[0] + (nx + 1) * (at[1] + (ny + 1) * at[2]);
  };
  TetSolidDef d;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i)
        d.vertices.push_back(corner + Vec3{size.x * i / nx, size.y * j / ny, size.z * k / nz});
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int p = 0; p < 6; ++p) {
          std::array<int, 4> t;
          int at[3] = {i, j, k}, way[3];
          // odd permutations of axes are mirror images, and so is each reversed axis
          bool mirrored = p >= 3;
          for (int axis = 0; axis < 3; ++axis) {
            const bool down = startsHigh(axis, at[axis]);
            way[axis] = down ? -1 : 1;
            at[axis] += down;
            mirrored ^= down;
          }
          t[0] = index(at);
          for (int step = 0; step < 3; ++step) {
            at[kPaths[p][step]] += way[kPaths[p][step]];
            t[std::size_t(step + 1)] = index(at);
          }
          if (mirrored) std::swap(t[1], t[2]);
          d.tetrahedra.push_back(t);
        }
  return d;
}

}  // namespace

TetSolidDef tetBox(const Vec3& corner, const Vec3& size, const std::array<int, 3>& cells) {
  for (std::size_t k = 0; k < 3; ++k)
    if (cells[k] < 1 || !(size[int(k)] > 0))
      throw Error("tetBox", "a positive size and at least one cell each way", "others");
  return lattice(corner, size, cells, [](int, int) { return false; });
}

TetSolidDef tetBall(const Vec3& center, double radius, int cells) {
  if (cells < 2 || !(radius > 0))
    throw Error("tetBall", "a positive radius and at least two cells each way", "others");
  // Paths start at the cell corner nearest to the center, which all six tetrahedra share. Otherwise
  // tetrahedra at the edges of the cube would have all corners on the surface and be flat.
  TetSolidDef d = lattice({-1, -1, -1}, {2, 2, 2}, {cells, cells, cells},
                          [&](int, int cell) { return 2 * cell + 1 < cells; });
  for (Vec3& x : d.vertices) {
    // the shell at distance r from the center of the cube becomes the sphere of radius r
    const double shell = std::max({std::fabs(x.x), std::fabs(x.y), std::fabs(x.z)}), size = length(x);
    x = center + (size > 0 ? x * (radius * shell / size) : Vec3{});
  }
  return d;
}

ClothDef clothSheet(const Vec3& corner, const Vec3& u, const Vec3& v, int cellsU, int cellsV) {
  if (cellsU < 1 || cellsV < 1) throw Error("clothSheet", "at least one cell each way", "none");
  ClothDef d;
  const auto index = [&](int i, int j) { return i + j * (cellsU + 1); };
  for (int j = 0; j <= cellsV; ++j)
    for (int i = 0; i <= cellsU; ++i)
      d.vertices.push_back(corner + u * (double(i) / cellsU) + v * (double(j) / cellsV));
  for (int j = 0; j < cellsV; ++j)
    for (int i = 0; i < cellsU; ++i) {
      const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), e = index(i, j + 1);
      // diagonals alternate, so that no direction is stiffer
      if ((i + j) % 2 == 0) {
        d.triangles.push_back({a, b, c});
        d.triangles.push_back({a, c, e});
      } else {
        d.triangles.push_back({a, b, e});
        d.triangles.push_back({b, c, e});
      }
    }
  return d;
}

CableDef straightCable(const Vec3& from, const Vec3& to, int segments) {
  if (segments < 1) throw Error("straightCable", "at least one segment", std::to_string(segments));
  CableDef d;
  for (int i = 0; i <= segments; ++i) d.vertices.push_back(from + (to - from) * (double(i) / segments));
  return d;
}

}  // namespace rubble

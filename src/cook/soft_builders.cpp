#include <rubble/error.h>
#include <rubble/soft.h>

namespace rubble {

SoftDef softBox(const Vec3& corner, const Vec3& size, const std::array<int, 3>& cells) {
  for (std::size_t k = 0; k < 3; ++k)
    if (cells[k] < 1 || !(size[int(k)] > 0)) throw Error("softBox", "a positive size and at least one cell each way", "others");
  const auto [nx, ny, nz] = cells;
  const auto index = [&, nx = nx, ny = ny](int i, int j, int k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  SoftDef d;
  for (int k = 0; k <= nz; ++k)
    for (int j = 0; j <= ny; ++j)
      for (int i = 0; i <= nx; ++i) d.vertices.push_back(corner + Vec3{size.x * i / nx, size.y * j / ny, size.z * k / nz});
  // the six paths from one corner of a cell to the opposite one; cells fit to one another without mirroring
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int p = 0; p < 6; ++p) {
          std::array<int, 4> t;
          int at[3] = {i, j, k};
          t[0] = index(at[0], at[1], at[2]);
          for (int step = 0; step < 3; ++step) {
            ++at[kPaths[p][step]];
            t[std::size_t(step + 1)] = index(at[0], at[1], at[2]);
          }
          // odd permutations are mirror images
          if (p >= 3) std::swap(t[1], t[2]);
          d.tetrahedra.push_back(t);
        }
  return d;
}

ClothDef clothSheet(const Vec3& corner, const Vec3& u, const Vec3& v, int cellsU, int cellsV) {
  if (cellsU < 1 || cellsV < 1) throw Error("clothSheet", "at least one cell each way", "none");
  ClothDef d;
  const auto index = [&](int i, int j) { return i + j * (cellsU + 1); };
  for (int j = 0; j <= cellsV; ++j)
    for (int i = 0; i <= cellsU; ++i) d.vertices.push_back(corner + u * (double(i) / cellsU) + v * (double(j) / cellsV));
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

RodDef straightRod(const Vec3& from, const Vec3& to, int segments) {
  if (segments < 1) throw Error("straightRod", "at least one segment", std::to_string(segments));
  RodDef d;
  for (int i = 0; i <= segments; ++i) d.vertices.push_back(from + (to - from) * (double(i) / segments));
  return d;
}

}  // namespace rubble

#pragma once
/// Closed surfaces for tests.
#include <cmath>
#include <numbers>

#include <rubble/mesh.h>

namespace rubble::test {

/// A ring about z: tube radius r at distance R, n by m quadrilaterals of two triangles.
inline TriangleMesh torusMesh(double R, double r, int n, int m) {
  TriangleMesh out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      out.vertices.push_back(
          {(R + r * std::cos(b)) * std::cos(a), (R + r * std::cos(b)) * std::sin(a), r * std::sin(b)});
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const int a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m,
                d = i * m + (j + 1) % m;
      out.triangles.push_back({a, b, c}), out.triangles.push_back({a, c, d});
    }
  return out;
}

/// The unit cube from the origin.
inline TriangleMesh cubeMesh() {
  TriangleMesh out;
  for (int k = 0; k < 8; ++k) out.vertices.push_back({double(k & 1), double(k >> 1 & 1), double(k >> 2)});
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : kFaces)
    out.triangles.push_back({f[0], f[1], f[2]}), out.triangles.push_back({f[0], f[2], f[3]});
  return out;
}

}  // namespace rubble::test

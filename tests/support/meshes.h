#pragma once
/// Closed surfaces for tests.
#include <cmath>
#include <numbers>
#include <random>

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

/// A prism over a simple polygon that is counter-clockwise in the x-y plane and star-shaped about its first
/// corner, from z = 0 to `height`.
inline TriangleMesh prism(const std::vector<std::array<double, 2>>& polygon, double height) {
  TriangleMesh out;
  const int n = static_cast<int>(polygon.size());
  for (const double z : {0.0, height})
    for (const auto& [x, y] : polygon) out.vertices.push_back({x, y, z});
  for (int k = 1; k + 1 < n; ++k) {
    out.triangles.push_back({0, k + 1, k});
    out.triangles.push_back({n, n + k, n + k + 1});
  }
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    out.triangles.push_back({k, next, n + next});
    out.triangles.push_back({k, n + next, n + k});
  }
  return out;
}

/// An L of three unit cubes.
inline TriangleMesh ell() { return prism({{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}}, 1); }

/// A ball with bumps of a share of its radius, in `rings` bands; another for each seed.
inline TriangleMesh bumpyBall(double radius, double bumps, int rings, unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::array<std::array<double, 4>, 4> waves;
  for (auto& wave : waves) wave = {2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1, 6.3 * unit()};
  TriangleMesh out;
  const int around = 2 * rings;
  const auto add = [&](double polar, double azimuth) {
    const Vec3 n{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
    double height = 0;
    for (const auto& [x, y, z, phase] : waves) height += std::sin(5 * dot(n, Vec3{x, y, z}) + phase) / 4;
    out.vertices.push_back(n * (radius * (1 + bumps * height)));
  };
  add(0, 0);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) add(std::numbers::pi * i / rings, 2 * std::numbers::pi * j / around);
  add(std::numbers::pi, 0);
  const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
  const int last = static_cast<int>(out.vertices.size()) - 1;
  for (int j = 0; j < around; ++j) {
    out.triangles.push_back({0, at(1, j), at(1, j + 1)});
    out.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      out.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      out.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return out;
}

}  // namespace rubble::test

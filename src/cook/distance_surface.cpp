#include "cook/distance_surface.h"

#include <algorithm>
#include <cmath>

namespace rubble {

namespace {

double sampleAt(const ShapeGeometry& f, int i, int j, int k) {
  const std::size_t nx = static_cast<std::size_t>(f.counts[0]), ny = static_cast<std::size_t>(f.counts[1]);
  return f.samples[(static_cast<std::size_t>(k) * ny + static_cast<std::size_t>(j)) * nx +
                   static_cast<std::size_t>(i)];
}

}  // namespace

double distanceAt(const ShapeGeometry& f, const Vec3& point) {
  int cell[3];
  double t[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int cells = f.counts[static_cast<std::size_t>(axis)] - 1;
    const double x = std::clamp((point[axis] - f.origin[axis]) / f.spacing[axis], 0.0,
                                static_cast<double>(cells));
    cell[axis] = std::min(static_cast<int>(x), cells - 1);
    t[axis] = x - cell[axis];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
    const double weight = (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) * (dz ? t[2] : 1 - t[2]);
    sum += weight * sampleAt(f, cell[0] + dx, cell[1] + dy, cell[2] + dz);
  }
  return sum;
}

Vec3 distanceNormal(const ShapeGeometry& f, const Vec3& point) {
  const double h = .5 * f.spacing.x;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 d;
    d[axis] = h;
    g[axis] = distanceAt(f, point + d) - distanceAt(f, point - d);
  }
  return normalize(g);
}

ShapeMesh distanceSurface(const ShapeGeometry& f) {
  ShapeMesh mesh;
  const int nx = f.counts[0], ny = f.counts[1], nz = f.counts[2];
  const auto place = [&](double i, double j, double k) {
    return f.origin + Vec3{i * f.spacing.x, j * f.spacing.y, k * f.spacing.z};
  };
  std::vector<int> cornerOf(
      static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), -1);
  const auto cell = [&](int i, int j, int k) -> int& {
    return cornerOf[(static_cast<std::size_t>(k) * static_cast<std::size_t>(ny) +
                     static_cast<std::size_t>(j)) *
                        static_cast<std::size_t>(nx) +
                    static_cast<std::size_t>(i)];
  };
  for (int k = 0; k + 1 < nz; ++k)
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i) {
        // the mean of the points where the surface cuts edges of the cell
        Vec3 sum;
        int cuts = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (int edge = 0; edge < 4; ++edge) {
            int a[3] = {0, 0, 0};
            a[(axis + 1) % 3] = edge & 1, a[(axis + 2) % 3] = edge >> 1;
            int b[3] = {a[0], a[1], a[2]};
            b[axis] = 1;
            const double da = sampleAt(f, i + a[0], j + a[1], k + a[2]),
                         db = sampleAt(f, i + b[0], j + b[1], k + b[2]);
            if ((da < 0) == (db < 0)) continue;
            Vec3 x{i + double(a[0]), j + double(a[1]), k + double(a[2])};
            x[axis] += da / (da - db);
            sum += x;
            ++cuts;
          }
        if (cuts == 0) continue;
        Vec3 x = place(sum.x / cuts, sum.y / cuts, sum.z / cuts);
        // down the gradient to the surface
        for (int n = 0; n < 3; ++n) x -= distanceNormal(f, x) * distanceAt(f, x);
        cell(i, j, k) = static_cast<int>(mesh.points.size());
        mesh.points.push_back(x);
        mesh.normals.push_back(distanceNormal(f, x));
      }
  // one quad around each lattice edge that the surface cuts
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const int at[3] = {i, j, k}, counts[3] = {nx, ny, nz}, u = (axis + 1) % 3, v = (axis + 2) % 3;
          if (at[axis] + 1 >= counts[axis] || at[u] == 0 || at[v] == 0 || at[u] + 1 >= counts[u] ||
              at[v] + 1 >= counts[v])
            continue;
          int next[3] = {i, j, k};
          ++next[axis];
          const bool inside = sampleAt(f, i, j, k) < 0;
          if (inside == (sampleAt(f, next[0], next[1], next[2]) < 0)) continue;
          int corners[4];
          for (int c = 0; c < 4; ++c) {
            int q[3] = {i, j, k};
            if (c == 0 || c == 3) --q[u];
            if (c < 2) --q[v];
            corners[c] = cell(q[0], q[1], q[2]);
          }
          if (!inside) std::swap(corners[1], corners[3]);
          mesh.triangles.push_back({corners[0], corners[1], corners[2]});
          mesh.triangles.push_back({corners[0], corners[2], corners[3]});
        }
  return mesh;
}

}  // namespace rubble

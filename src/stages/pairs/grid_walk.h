#pragma once
/// Bodies along a path, by the grid of the broad phase.
#include "collision/sweep.h"
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// visit(body) for every body of a world whose box may touch a box of half extents `half` that moves from `x`
/// by `limit` times `d`. The visitor may lower the limit as it finds hits. Each body is visited once. Cells
/// are visited slab by slab along the main direction, so near bodies come first at each level. Several lanes
/// may share the bodies, each with its own limit: lane `lane` of `lanes` visits every `lanes`-th slab.
template <class Visit>
RUBBLE_HD void visitAlong(const SolverData& s, int world, const Vec3d& x, const Vec3d& d, const Vec3d& half,
                          double& limit, Visit&& visit, int lane = 0, int lanes = 1) {
  int m = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(d[k]) > std::fabs(d[m])) m = k;
  const int u = (m + 1) % 3, v = (m + 2) % 3;
  const auto tryEntry = [&](const GridEntry& e) {
    const Vec3d away = x - Vec3d(e.center);
    if (passes(away, d, half + Vec3d(e.half), limit)) visit(e.body);
  };
  const int incidences = s.bucketOffset[s.cells];
  for (int level = 0; level < kGridLevels; ++level) {
    if (s.counters->levelCount[level] == 0) continue;
    const int layer = layerOf(world, level);
    const double size = static_cast<double>(cellSize(level));
    Vec3d reach = half;
    for (int k = 0; k < 3; ++k)
      reach[k] += static_cast<double>(fromFloatBits(s.counters->levelHalf[level][k]));
    const auto cell = [&](double a) { return static_cast<int>(floor(clamp(a / size, -1e9, 1e9))); };
    const auto low = [&](int k, double t0, double t1) {
      return cell(min(x[k] + t0 * d[k], x[k] + t1 * d[k]) - reach[k]);
    };
    const auto high = [&](int k, double t0, double t1) {
      return cell(max(x[k] + t0 * d[k], x[k] + t1 * d[k]) + reach[k]);
    };
    // the part of the path that passes the cells in use
    double from = 0, until = limit;
    for (int k = 0; k < 3; ++k) {
      const auto& used = s.counters->levelReach[level];
      const double lowest = (kCellOrigin - used[0][k]) * size - reach[k] - x[k],
                   highest = (used[1][k] - kCellOrigin + 1.0) * size + reach[k] - x[k];
      if (d[k] != 0)
        from = max(from, min(lowest / d[k], highest / d[k])),
        until = min(until, max(lowest / d[k], highest / d[k]));
      else if (lowest > 0 || highest < 0)
        until = -1;
    }
    if (from > until) continue;
    const int first = low(m, from, until), last = high(m, from, until);
    // with more cells than entries a scan of the entries is cheaper
    const double cells = (double(last) - first + 1) * (2 * reach[u] / size + 2) * (2 * reach[v] / size + 2);
    if (cells > 2.0 * incidences + 64) {
      for (int k = lane; k < incidences; k += lanes)
        if (s.grid[k].layer == layer) tryEntry(s.grid[k]);
      continue;
    }
    const bool forward = d[m] >= 0;
    for (int n = lane; n <= last - first; n += lanes) {
      const int slab = forward ? first + n : last - n;
      double t0 = from, t1 = min(until, limit);
      if (d[m] != 0) {
        const double a = (slab * size - reach[m] - x[m]) / d[m],
                     b = ((slab + 1.0) * size + reach[m] - x[m]) / d[m];
        t0 = max(t0, min(a, b)), t1 = min(t1, max(a, b));
        if (t0 > t1) continue;
      }
      for (int cv = low(v, t0, t1); cv <= high(v, t0, t1); ++cv)
        for (int cu = low(u, t0, t1); cu <= high(u, t0, t1); ++cu) {
          int c[3];
          c[m] = slab, c[u] = cu, c[v] = cv;
          const int bucket = bucketOf(s, layer, c[0], c[1], c[2]);
          for (int k = s.bucketOffset[bucket]; k < s.bucketOffset[bucket + 1]; ++k) {
            const GridEntry& e = s.grid[k];
            // another cell may share the bucket
            const bool here = e.layer == layer && cellOf(e.center.x, cellSize(level)) == c[0] &&
                              cellOf(e.center.y, cellSize(level)) == c[1] &&
                              cellOf(e.center.z, cellSize(level)) == c[2];
            if (here) tryEntry(e);
          }
        }
    }
  }
  const int end = s.planesEnd(world);
  for (int k = s.planesBegin(world) + lane; k < end; k += lanes) visit(s.planeBody[k]);
}

}  // namespace rubble::RUBBLE_CORE

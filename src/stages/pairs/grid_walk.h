#pragma once
/// Bodies along a path, by the grid of the broad phase.
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// One worker that visits everything. Others share the bodies: worker `lane` of `count`, all in step.
struct OneLane {
  int lane = 0, count = 1;
  /// The least of all workers' numbers.
  RUBBLE_HD double least(double a) const { return a; }
};

/// The box of half extents `half` that moves from x by `limit` times d. A search may lower both as it finds
/// hits.
struct PathSearch {
  Vec3d x, d;        ///< [m]
  Vec3d half;        ///< [m]
  double limit = 1;  ///< fraction of d
};

/// The cells of a level of a world that a search crosses: slabs along the main axis of d, one after another.
class LevelWalk {
 public:
  RUBBLE_HD LevelWalk(const SolverData& s, const PathSearch& p, const Vec3d& inverse, int world, int level)
      : s_(s),
        p_(p),
        inverse_(inverse),
        level_(level),
        layer_(layerOf(world, level)),
        size_(static_cast<double>(cellSize(level))),
        perSize_(1 / size_) {
    for (int k = 1; k < 3; ++k)
      if (std::fabs(p.d[k]) > std::fabs(p.d[main_])) main_ = k;
    for (int k = 0; k < 3; ++k)
      reach_[k] = p.half[k] + static_cast<double>(fromFloatBits(s.counters->levelHalf[level][k]));
    // the part of the path that passes the cells in use
    until_ = p.limit;
    for (int k = 0; k < 3; ++k) {
      const auto& used = s.counters->levelReach[level];
      const double lowest = (kCellOrigin - used[0][k]) * size_ - reach_[k] - p.x[k],
                   highest = (used[1][k] - kCellOrigin + 1.0) * size_ + reach_[k] - p.x[k];
      const double a = lowest * inverse[k], b = highest * inverse[k];
      if (inverse[k] != 0)
        from_ = max(from_, min(a, b)), until_ = min(until_, max(a, b));
      else if (lowest > 0 || highest < 0)
        until_ = -1;
    }
    if (from_ > until_) return;
    first_ = low(main_, from_, until_), last_ = high(main_, from_, until_);
    // a slab is crossed within its thickness and the reach
    cells_ = double(last_) - first_ + 1;
    for (int k = 0; k < 3; ++k)
      if (k != main_) cells_ *= 2 * (reach_[k] + reach_[main_]) * perSize_ + 3;
  }

  RUBBLE_HD int slabs() const { return last_ - first_ + 1; }
  /// Bound of the number of cells in all slabs.
  RUBBLE_HD double cells() const { return cells_; }
  /// Fraction of d at which the path enters a slab.
  RUBBLE_HD double entry(int slab) const {
    const auto [a, b] = crossing(slab);
    return inverse_[main_] == 0 ? from_ : min(a, b);
  }

  /// look(entry) for the bodies in the cells of a slab.
  template <class Look> RUBBLE_HD void visit(int slab, Look&& look) const {
    double t0 = from_, t1 = min(until_, p_.limit);
    if (inverse_[main_] != 0) {
      const auto [a, b] = crossing(slab);
      t0 = max(t0, min(a, b)), t1 = min(t1, max(a, b));
    }
    if (t0 > t1) return;
    int lowest[3], highest[3];
    for (int k = 0; k < 3; ++k) lowest[k] = low(k, t0, t1), highest[k] = high(k, t0, t1);
    lowest[main_] = highest[main_] = number(slab);
    for (int z = lowest[2]; z <= highest[2]; ++z)
      for (int y = lowest[1]; y <= highest[1]; ++y) visitRow(lowest[0], highest[0], y, z, look);
  }

 private:
  struct Crossing {
    double a, b;
  };
  RUBBLE_HD int number(int slab) const { return p_.d[main_] >= 0 ? first_ + slab : last_ - slab; }
  RUBBLE_HD Crossing crossing(int slab) const {
    const double begin = number(slab) * size_ - p_.x[main_];
    return {(begin - reach_[main_]) * inverse_[main_], (begin + size_ + reach_[main_]) * inverse_[main_]};
  }
  RUBBLE_HD int cell(double a) const { return static_cast<int>(floor(clamp(a * perSize_, -1e9, 1e9))); }
  RUBBLE_HD int low(int k, double t0, double t1) const {
    return cell(p_.x[k] + min(t0 * p_.d[k], t1 * p_.d[k]) - reach_[k]);
  }
  RUBBLE_HD int high(int k, double t0, double t1) const {
    return cell(p_.x[k] + max(t0 * p_.d[k], t1 * p_.d[k]) + reach_[k]);
  }
  template <class Look> RUBBLE_HD void visitRow(int x0, int x1, int y, int z, Look&& look) const {
    const Real size = cellSize(level_);
    const RowOfCells row = rowOfCells(s_, layer_, x0, x1, y, z);
    const auto take = [&](const GridEntry& e) {
      if (e.layer != layer_) return;
      // cells of another row may share the bucket
      const int x = cellOf(e.center.x, size);
      if (x >= x0 && x <= x1 && cellOf(e.center.y, size) == y && cellOf(e.center.z, size) == z) look(e);
    };
    for (int k = row.begin; k < row.end; ++k) take(s_.grid[k]);
    for (int k = 0; k < row.wrapped; ++k) take(s_.grid[k]);
  }

  const SolverData& s_;
  const PathSearch& p_;
  const Vec3d& inverse_;
  int level_, layer_;
  double size_;     ///< of cells [m]
  double perSize_;  ///< exact, since sizes are powers of two [1/m]
  int main_ = 0, first_ = 0, last_ = -1;
  Vec3d reach_;
  double from_ = 0, until_ = 0, cells_ = 0;
};

/// visit(body) for every body of a world whose box may touch the moving box. Each body is visited once. In a
/// world of many, slab by slab at each level, so near bodies come first. share(): all workers take over the
/// narrowest search of one of them; then slabs beyond it are left out.
template <class Visit, class Share, class Lanes>
RUBBLE_HD void visitAlong(const SolverData& s, int world, const PathSearch& p, Visit&& visit, Share&& share,
                          const Lanes& lanes) {
  const Vec3d inverse = inverseOf(p.d);
  const auto look = [&](const GridEntry& e) {
    if (passes(p.x - Vec3d(e.center), inverse, p.half + Vec3d(e.half), p.limit)) visit(e.body);
  };
  const auto scan = [&](int body, const Bounds& b) { look(GridEntry{b.center, b.half, body, 0}); };
  const bool scanned = scanWorld(s, world, scan, lanes.lane, lanes.count);
  const int entries = s.bucketOffset[s.cells];
  for (int level = 0; !scanned && level < kGridLevels; ++level) {
    if (s.counters->levelCount[level] == 0) continue;
    share();
    const LevelWalk walk(s, p, inverse, world, level);
    // with more cells than entries a scan of the entries is cheaper
    if (walk.cells() > min(2.0 * entries + 64, static_cast<double>(s.cells))) {
      for (int k = lanes.lane; k < entries; k += lanes.count)
        if (s.grid[k].layer == layerOf(world, level)) look(s.grid[k]);
      continue;
    }
    const int slabs = walk.slabs();
    for (int slab = 0; slab < slabs && walk.entry(slab) <= p.limit; slab += lanes.count) {
      if (slab + lanes.lane < slabs) walk.visit(slab + lanes.lane, look);
      share();
    }
  }
  const int end = s.planesEnd(world);
  for (int k = s.planesBegin(world) + lanes.lane; k < end; k += lanes.count) visit(s.planeBody[k]);
}

}  // namespace rubble::RUBBLE_CORE

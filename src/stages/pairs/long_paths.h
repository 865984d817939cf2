#pragma once
/// Bodies with long paths: those that move farther in a step than they are wide, such as grains of a jet.
/// Swept boxes of such bodies overlap even if all of them move alike and none meets another. So their pairs
/// are found by their relative motion. Where a cell, which fits the paths, holds many of them, they are
/// searched for in subcells, which fit the bodies: in a frame that moves with the bodies of the cell their
/// paths are short, so a search visits few subcells.
#include "collision/sweep.h"
#include "stages/pairs/grid.h"

namespace rubble::RUBBLE_CORE {

/// Distance within which two bodies have a pair [m]. Rows of a pair reach as far as the smaller body is wide,
/// or as far as an impact may drive one of the two in a step, which is no more than its width for a body that
/// does not tunnel (pairMargin()). It also covers bodies that leave their paths by less than their radius
/// (leavesPath()).
RUBBLE_HD inline Real pathReach(Real radiusA, Real radiusB) { return kLongPath * max(radiusA, radiusB); }

/// Do two bodies come near one another at some time if both follow their paths? Their boxes at x^t are moved
/// by the relative path.
RUBBLE_HD inline bool pathsMeet(const SolverData& s, int i, int j) {
  const Bounds &a = s.bounds[i], &b = s.bounds[j];
  const Vec3 startA = a.center - Real(.5) * a.path, startB = b.center - Real(.5) * b.path;
  const Vec3 halfA = a.half - Real(.5) * abs(a.path), halfB = b.half - Real(.5) * abs(b.path);
  const Real reach = pathReach(s.params[i].radius, s.params[j].radius);
  return passes(Vec3d(startA - startB), inverseOf(Vec3d(a.path - b.path)),
                Vec3d(halfA + halfB + Vec3{reach, reach, reach}), 1);
}
/// Does the broad phase pair body i, which is in the grid, with body j or plane j, if they may collide?
RUBBLE_HD inline bool arePartners(const SolverData& s, int i, int j) {
  const Bounds &a = loadUnchanging(s.bounds[i]), &b = loadUnchanging(s.bounds[j]);
  if (b.level < 0)
    return s.params[j].kind != BodyKind::Removed && s.params[j].shape.kind == ShapeKind::Plane &&
           touchesPlane(s, j, a);
  return boundsTouch(a, b) && (!(isLongLevel(a.level) || isLongLevel(b.level)) || pathsMeet(s, i, j));
}

/// Raises the bounds of the paths in a cell by those of a body. Paths are rounded outward, by one to two of
/// these shares of the edge of the cell.
inline constexpr Real kPathSteps = 1024;
RUBBLE_HD inline void addPath(CellPaths& to, const Bounds& b, Real radius) {
  const Vec3 h = b.half - Real(.5) * abs(b.path);
  for (int k = 0; k < 3; ++k) {
    const int steps = cellOf(b.path[k], cellSize(b.level) / kPathSteps);
    atomicRaise(&to.most[0][k], kCellOrigin - (steps - 1));
    atomicRaise(&to.most[1][k], kCellOrigin + (steps + 2));
  }
  atomicRaise(&to.half, floatBits(max(h.x, max(h.y, h.z)) * Real(1.000001)));
  atomicRaise(&to.radius, floatBits(radius * Real(1.000001)));
}
/// Lowest and highest path in a cell along an axis [m].
RUBBLE_HD inline Real lowestPath(const CellPaths& paths, int level, int axis) {
  return static_cast<Real>(kCellOrigin - paths.most[0][axis]) * (cellSize(level) / kPathSteps);
}
RUBBLE_HD inline Real highestPath(const CellPaths& paths, int level, int axis) {
  return static_cast<Real>(paths.most[1][axis] - kCellOrigin) * (cellSize(level) / kPathSteps);
}

/// How many times a cell is halved into subcells: these are as wide as two of its bodies that have a pair at
/// one velocity are apart. 0: subcells save nothing.
RUBBLE_HD inline int halvings(const CellPaths& paths, int level, int x, int y, int z) {
  // the numbers of subcells must be exact
  constexpr int kMostHalvings = 10, kLeastHalvings = 2, kFar = 1 << 19;
  if (max(std::abs(x), max(std::abs(y), std::abs(z))) >= kFar) return 0;
  const Real radius = fromFloatBits(paths.radius),
             wide = 2 * fromFloatBits(paths.half) + pathReach(radius, radius);
  int n = 0;
  for (Real size = Real(.5) * cellSize(level); n < kMostHalvings && size >= wide; size *= Real(.5)) ++n;
  return n < kLeastHalvings ? 0 : n;
}
/// Edge of the subcells of a cell [m].
RUBBLE_HD inline Real subcellSize(int level, int halvings) {
  return powerOfTwo(sizeOf(level) - kMetreLevel - halvings);
}

/// Clears what a cell stores for long paths.
struct ClearCellPaths {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int cell) const {
    s.cellPaths[cell] = {};
    s.subcellFirst[cell] = 0;
  }
};
/// Sorts bodies into buckets, and bounds the long paths in each. The order inside a bucket is not fixed;
/// pairs are sorted later.
struct FillGrid {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounds& b = loadUnchanging(s.bounds[i]);
    if (b.level < 0) return;
    const int layer = layerOf(s.worldOf(i), b.level), bucket = bucketOf(s, layer, b.x, b.y, b.z);
    const int slot = s.bucketOffset[bucket] + atomicCount(&s.bucketCount[bucket], -1) - 1;
    s.grid[slot] = {b.center, b.half, i, layer};
    if (isLongLevel(b.level)) addPath(s.cellPaths[bucket], b, s.params[i].radius);
  }
};
/// Lists the bodies of each bucket of subcells. The order in a list is not fixed; pairs are sorted later.
/// Like FindPathNeighbors it runs over as many elements as there are buckets, more than bodies, and over none
/// where no path is long.
struct LinkSubcells {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (i >= s.bodies || !isLongLevel(s.bounds[i].level)) return;
    const Bounds& b = s.bounds[i];
    const int layer = layerOf(s.worldOf(i), b.level);
    const int n = halvings(s.cellPaths[bucketOf(s, layer, b.x, b.y, b.z)], b.level, b.x, b.y, b.z);
    if (n == 0) return;
    const Real size = subcellSize(b.level, n);
    const int bucket = bucketOf(s, layer, cellOf(b.center.x, size), cellOf(b.center.y, size),
                                cellOf(b.center.z, size));
    s.subcellNext[i] = atomicExchange(&s.subcellFirst[bucket], i + 1);
  }
};

/// One cell of a level.
struct CellAt {
  int level, layer, x, y, z;
  RUBBLE_HD bool holds(const Bounds& b) const { return b.level == level && b.x == x && b.y == y && b.z == z; }
};

/// What the boxes of bodies with long paths are compared with.
struct PathProbe {
  const Bounds& box;
  Real radius;   ///< of its body [m]
  bool follows;  ///< the body follows its path, and so do those that it searches
};

/// Largest distance of the center of a probe from those of the boxes in a cell that it may meet, along an
/// axis [m].
RUBBLE_HD inline Real reachInto(const SolverData& s, const CellAt& cell, const CellPaths& paths,
                                const PathProbe& probe, int axis) {
  const Bounds& b = probe.box;
  const Real swept = b.half[axis] + fromFloatBits(s.counters->levelHalf[cell.level][axis]);
  if (!probe.follows) return swept;
  // centers are those at half of the step, and relative paths lead half of their length away from there
  const Real path = b.path[axis], relative = max(path - lowestPath(paths, cell.level, axis),
                                                 highestPath(paths, cell.level, axis) - path);
  return min(swept, b.half[axis] - Real(.5) * std::fabs(path) + fromFloatBits(paths.half) +
                        pathReach(probe.radius, fromFloatBits(paths.radius)) + Real(.5) * relative);
}

/// look(j) for the bodies with long paths in a cell that a probe may meet, by subcells. Returns false,
/// without a look, if a scan of the `members` of its bucket is cheaper.
template <class Look>
RUBBLE_HD bool visitSubcells(const SolverData& s, const CellAt& cell, const PathProbe& probe, int members,
                             Look&& look) {
  constexpr int kFewMembers = 8;
  if (members <= kFewMembers) return false;
  const CellPaths& paths = s.cellPaths[bucketOf(s, cell.layer, cell.x, cell.y, cell.z)];
  const int n = halvings(paths, cell.level, cell.x, cell.y, cell.z), side = 1 << n;
  if (n == 0) return false;
  const Real size = subcellSize(cell.level, n);
  const int first[3] = {cell.x * side, cell.y * side, cell.z * side};
  int low[3], high[3];
  double cells = 1;
  for (int k = 0; k < 3; ++k) {
    const Real center = probe.box.center[k], reach = reachInto(s, cell, paths, probe, k);
    low[k] = max(cellOf(center - reach, size), first[k]);
    high[k] = min(cellOf(center + reach, size), first[k] + side - 1);
    if (low[k] > high[k]) return true;
    cells *= high[k] - low[k] + 1;
  }
  if (cells > members) return false;
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y) {
      // buckets of a row are adjacent
      const int row = bucketOf(s, cell.layer, low[0], y, z);
      for (int x = low[0]; x <= high[0]; ++x)
        for (int next = s.subcellFirst[(row + x - low[0]) & (s.cells - 1)]; next > 0;) {
          const int j = next - 1;
          next = s.subcellNext[j];
          // other cells may share the bucket
          const Bounds& other = s.bounds[j];
          if (cell.holds(other) && layerOf(s.worldOf(j), other.level) == cell.layer &&
              cellOf(other.center.x, size) == x && cellOf(other.center.y, size) == y &&
              cellOf(other.center.z, size) == z)
            look(j);
        }
    }
  return true;
}

}  // namespace rubble::RUBBLE_CORE

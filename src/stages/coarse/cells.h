#pragma once
/// The nested cells that bound aggregates (aggregates.h). Only the nodes of an aggregate determine its
/// boundary. Cell edges are the free-fall distance per step, g dt^2, times a power of two, and are the same
/// in all worlds. A scene that is scaled in length and time alike is therefore partitioned at the same
/// places.
#include <limits>

#include "stages/coarse/nodes.h"

namespace rubble::RUBBLE_CORE {

/// Edge of the finest cells over the bounding radius of the larger of two nodes [1], before rounding to a
/// power of two times g dt^2. Then the number of doublings of the edge from level to level.
inline constexpr double kFinestCell = 3.5;
inline constexpr int kCellDoublings = 3;

/// Do two points share a cell of edge 2^exponent g dt^2? At every exponent the world origin lies a third of
/// an edge inside its cell, so that scenes built about the origin are not split there.
RUBBLE_HD inline bool shareCell(const StepConstants& c, const Vec3d& a, const Vec3d& b, int exponent) {
  const double perEdge = std::ldexp(c.perFall, -exponent), shift = exponent % 2 == 0 ? 1. / 3 : 2. / 3;
  const auto same = [&](double x, double y) {
    return floor(x * perEdge + shift) == floor(y * perEdge + shift);
  };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

/// The finest level at which two nodes share a cell; they share all coarser ones too. kCoarseLevels if there
/// is none.
RUBBLE_HD inline int finestSharedLevel(const SolverData& s, int a, int b) {
  constexpr double kHalfDoubling = 1.41421356;
  const Vec3d at = placeOf(s, a), bt = placeOf(s, b);
  const StepConstants& step = s.step[worldOfNode(s, a)];
  const double larger = static_cast<double>(max(radiusOf(s, a), radiusOf(s, b)));
  const double edge = kHalfDoubling * kFinestCell * larger * step.perFall;
  // of two points, or where free fall has no bound: all nodes share cells without bound
  if (!(edge > 0 && edge <= std::numeric_limits<double>::max())) return 0;
  const int finest = std::ilogb(edge);
  int level = 0;
  while (level < kCoarseLevels && !shareCell(step, at, bt, finest + level * kCellDoublings)) ++level;
  return level;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The nested cubes that aggregates are cut by (aggregates.h). Only the nodes of an aggregate decide where it
/// ends: edges are the way of a fall in a step, g dt^2, times a power of two, and all worlds are cut alike.
/// One of another size, whose steps are longer as its falls are, is cut at the same places.
#include "stages/coarse/nodes.h"

namespace rubble::RUBBLE_CORE {

/// Edge of the finest cells over the bounding radius of the larger one of two nodes [1], before it is rounded
/// to a power of two times g dt^2; and how many times it is doubled from level to level.
inline constexpr double kFinestCell = 3.5;
inline constexpr int kCellDoublings = 3;

/// Do two points share a cell of edge 2^exponent g dt^2? The origin lies a third of a cell within its own, at
/// every exponent, so that scenes built about it are not cut there.
RUBBLE_HD inline bool shareCell(const StepConstants& c, const Vec3d& a, const Vec3d& b, int exponent) {
  const double perEdge = std::ldexp(c.perFall, -exponent), shift = exponent % 2 == 0 ? 1. / 3 : 2. / 3;
  const auto same = [&](double x, double y) {
    return floor(x * perEdge + shift) == floor(y * perEdge + shift);
  };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

/// The finest level at which two nodes share a cell, and so all coarser ones; kCoarseLevels if there is none.
RUBBLE_HD inline int finestSharedLevel(const SolverData& s, int a, int b) {
  constexpr double kHalfDoubling = 1.41421356;
  const Vec3d at = placeOf(s, a), bt = placeOf(s, b);
  const double larger = static_cast<double>(max(radiusOf(s, a), radiusOf(s, b)));
  const int finest = std::ilogb(kHalfDoubling * kFinestCell * larger * s.step.perFall);
  int level = 0;
  while (level < kCoarseLevels && !shareCell(s.step, at, bt, finest + level * kCellDoublings)) ++level;
  return level;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The nested cubes that groups are cut by (groups.h). Their edges are powers of two, and what they are nested in
/// is the same everywhere, so that only the members of a group decide where it ends.
#include "stages/members.h"

namespace rubble::RUBBLE_CORE {

/// Edge of the finest cells over the bounding radius of the larger one of two members, before it is rounded to a
/// power of two [1]; and how many times it is doubled from level to level.
inline constexpr Real kFinestCell = Real(3.5);
inline constexpr int kCellDoublings = 3;

/// Do two points share a cell of edge 2^exponent? The origin lies a third of a cell within its own, at every
/// exponent, so that scenes built about it are not cut there.
RUBBLE_HD inline bool shareCell(const Vec3d& a, const Vec3d& b, int exponent) {
  const double perEdge = std::ldexp(1., -exponent), shift = exponent % 2 == 0 ? 1. / 3 : 2. / 3;
  const auto same = [&](double x, double y) { return floor(x * perEdge + shift) == floor(y * perEdge + shift); };
  return same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z);
}

/// The finest level at which two members share a cell, and so all coarser ones; kCoarseLevels if there is none.
RUBBLE_HD inline int finestSharedLevel(const View& s, int a, int b) {
  constexpr Real kHalfDoubling = Real(1.41421356);
  const Vec3d at = placeOf(s, a), bt = placeOf(s, b);
  const int finest = std::ilogb(kFinestCell * kHalfDoubling * max(radiusOf(s, a), radiusOf(s, b)));
  int level = 0;
  while (level < kCoarseLevels && !shareCell(at, bt, finest + level * kCellDoublings)) ++level;
  return level;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The nested cubes that groups are cut by (groups.h).
#include "stages/members.h"

namespace rubble::RUBBLE_CORE {

/// Edge of the finest cells in base cells of the grid (about the bounding radius of a typical body), and the ratio from level to level.
inline constexpr Real kFinestGroup = 4;
inline constexpr int kGroupRatio = 8;

struct GroupCell {
  int x, y, z;
  RUBBLE_HD friend bool operator==(const GroupCell& a, const GroupCell& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

/// Cell of a member at the finest level.
RUBBLE_HD inline GroupCell finestCell(const View& s, int member) {
  const double size = static_cast<double>(kFinestGroup * s.baseCell);
  const auto cell = [&](double x) {
    constexpr double kFar = 1e9;
    // shifted, so that scenes built about the origin are not cut there at every level
    return static_cast<int>(floor(clamp(x / size, -kFar, kFar))) + 3 * kGroupRatio * kGroupRatio * kGroupRatio / 8 + 1;
  };
  const Vec3d p = placeOf(s, member);
  return {cell(p.x), cell(p.y), cell(p.z)};
}

/// The cell one level coarser.
RUBBLE_HD inline GroupCell coarserCell(const GroupCell& c) {
  const auto up = [](int fine) { return fine >= 0 ? fine / kGroupRatio : -((kGroupRatio - 1 - fine) / kGroupRatio); };
  return {up(c.x), up(c.y), up(c.z)};
}

/// The finest level at which two members share a cell, and so all coarser ones; kCoarseLevels if there is none.
RUBBLE_HD inline int finestSharedLevel(const View& s, int a, int b) {
  GroupCell ca = finestCell(s, a), cb = finestCell(s, b);
  int level = 0;
  for (; level < kCoarseLevels && !(ca == cb); ++level) ca = coarserCell(ca), cb = coarserCell(cb);
  return level;
}

}  // namespace rubble::RUBBLE_CORE

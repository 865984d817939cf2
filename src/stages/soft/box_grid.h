#pragma once
/// Hashed multi-level grids of swept boxes. A box lies in the cell of its center, on the finest level whose
/// cells are wide enough for it. A box with a long sweep therefore lies on a coarse level and does not
/// lengthen other searches.
#include "stages/pairs/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// A box that holds a vertex, an edge or a triangle during the step.
struct SweptBox {
  Vec3 center, half;  ///< [m]
};
RUBBLE_HD inline bool meets(const SweptBox& a, const Vec3& center, const Vec3& half) {
  return std::fabs(a.center.x - center.x) <= a.half.x + half.x &&
         std::fabs(a.center.y - center.y) <= a.half.y + half.y &&
         std::fabs(a.center.z - center.z) <= a.half.z + half.z;
}

/// BoxEntry::place: boxes of one kind, level and world.
RUBBLE_HD constexpr int boxPlace(int world, int kind, int level) {
  return kind + kBoxKinds * (level + kBoxLevels * world);
}

struct BoxGrid {
  Real cell;                  ///< edge of the finest cells [m]
  Real span;                  ///< boxes of a level are at most this many cells wide [1]
  int buckets;                ///< a power of two
  const int* offset;          ///< [buckets + 1] into incidence
  const BoxEntry* incidence;  ///< by bucket, in no fixed order

  RUBBLE_HD Real cellSize(int level) const { return cell * static_cast<Real>(1 << level); }
  RUBBLE_HD int levelOf(const Vec3& half) const {
    const Real size = 2 * max(half.x, max(half.y, half.z));
    int level = 0;
    while (level < kBoxLevels - 1 && !(size <= span * cellSize(level))) ++level;
    return level;
  }
  RUBBLE_HD int bucketOf(int place, int x, int y, int z) const {
    const std::uint32_t row = hash32(
        static_cast<std::uint32_t>(y) * 0x9e3779b1u ^
        hash32(static_cast<std::uint32_t>(z) * 64u + static_cast<std::uint32_t>(place)));
    return static_cast<int>((row + static_cast<std::uint32_t>(x)) & static_cast<std::uint32_t>(buckets - 1));
  }
  /// The entry of a box, and its bucket.
  RUBBLE_HD BoxEntry place(int world, int kind, const SweptBox& box, int item, int& bucket) const {
    const int level = levelOf(box.half), own = boxPlace(world, kind, level);
    const Real size = cellSize(level);
    bucket = bucketOf(own, cellOf(box.center.x, size), cellOf(box.center.y, size),
                      cellOf(box.center.z, size));
    return {box.center, box.half, item, own};
  }
};

/// Grid of surface features: a triangle is about as wide as the finest cells.
RUBBLE_HD inline BoxGrid featureGrid(const SolverData& s) {
  return {s.featureCell, Real(1), s.featureCells, s.featureOffset, s.featureEntry};
}
/// Grid of particles: cells are as wide as a particle, and falling particles stay on the finest level longer.
RUBBLE_HD inline BoxGrid particleGrid(const SolverData& s) {
  return {s.particleCell, Real(4), s.particleCells, s.particleOffset, s.particle};
}

/// Records which levels are in use, and their largest half extents.
RUBBLE_HD inline void noteBox(const SolverData& s, const BoxEntry& e) {
  const int kind = e.place % kBoxKinds, level = e.place / kBoxKinds % kBoxLevels;
  int* const levels = &s.counters->boxLevels[kind];
  if ((atomicLoad(levels) >> level & 1) == 0) atomicSet(levels, 1 << level);
  for (int k = 0; k < 3; ++k) {
    const int bits = floatBits(e.half[k] * Real(1.000001));
    int* const half = &s.counters->boxHalf[kind][level][k];
    if (bits > atomicLoad(half)) atomicRaise(half, bits);
  }
}

/// visit(x, y, z) for the cells of edge `size` that may hold the center of a box within `reach` of `center`;
/// share of worker `lane` of `lanes`. Returns false and visits no cell if there are more than `most`.
template <class Visit>
RUBBLE_HD bool forEachCell(const Vec3& center, const Vec3& reach, Real size, Real most, int lane, int lanes,
                           Visit&& visit) {
  if (!((2 * reach.x / size + 1) * (2 * reach.y / size + 1) * (2 * reach.z / size + 1) < most)) return false;
  const int x0 = cellOf(center.x - reach.x, size), x1 = cellOf(center.x + reach.x, size);
  const int y0 = cellOf(center.y - reach.y, size), y1 = cellOf(center.y + reach.y, size);
  const int z0 = cellOf(center.z - reach.z, size), z1 = cellOf(center.z + reach.z, size);
  for (int x = x0 + lane, y = y0, z = z0;; x += lanes) {
    while (x > x1) x -= x1 - x0 + 1, ++y;
    while (y > y1) y -= y1 - y0 + 1, ++z;
    if (z > z1) return true;
    visit(x, y, z);
  }
}

/// found(item) for the boxes of a kind in a world that touch the given one; share of worker `lane` of
/// `lanes`.
template <class Found>
RUBBLE_HD void seekBoxes(const SolverData& s, const BoxGrid& grid, int world, int kind, const SweptBox& box,
                         Found&& found, int lane = 0, int lanes = 1) {
  // A cell costs two random reads, an entry part of a sequential one. With more cells than this, a scan of
  // all entries is cheaper.
  constexpr Real kFewCells = 512, kEntriesPerCell = 8;
  const int all = grid.offset[grid.buckets], levels = s.counters->boxLevels[kind];
  const Real most = max(kFewCells, static_cast<Real>(all) / kEntriesPerCell);
  for (int level = 0; levels >> level != 0; ++level) {
    if ((levels >> level & 1) == 0) continue;
    const int place = boxPlace(world, kind, level);
    const Real size = grid.cellSize(level);
    Vec3 reach;
    for (int k = 0; k < 3; ++k) reach[k] = box.half[k] + fromFloatBits(s.counters->boxHalf[kind][level][k]);
    const auto look = [&](const BoxEntry& e) {
      if (e.place == place && meets(box, e.center, e.half)) found(e.item);
    };
    const bool done = forEachCell(box.center, reach, size, most, lane, lanes, [&](int x, int y, int z) {
      const int bucket = grid.bucketOf(place, x, y, z);
      for (int k = grid.offset[bucket]; k < grid.offset[bucket + 1]; ++k) {
        // another cell may share the bucket
        const BoxEntry& e = grid.incidence[k];
        if (cellOf(e.center.x, size) == x && cellOf(e.center.y, size) == y && cellOf(e.center.z, size) == z)
          look(e);
      }
    });
    for (int k = lane; !done && k < all; k += lanes) look(grid.incidence[k]);
  }
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Broad phase: a hashed multi-level grid. A body lies in the cell of its center, at the level that fits its
/// swept box. It searches its own level and all coarser ones. Buckets of cells with ascending x are adjacent
/// in memory.
#include "solver/inertia.h"
#include "stages/pairs/filter.h"
#include "stages/pairs/pair_parts.h"

namespace rubble::RUBBLE_CORE {

/// Largest half extent of a body of a level, in cells; and the allowance for rotation and motion in the
/// radius test [1].
inline constexpr Real kLevelFill = Real(1.35), kTurnedWay = Real(1.1);

/// Edge of the cells of a level [m]: powers of two.
RUBBLE_HD inline Real cellSize(int level) { return std::ldexp(Real(1), level - kMetreLevel); }

RUBBLE_HD inline int cellOf(Real x, Real size) {
  constexpr Real kFar = Real(1e9);
  return static_cast<int>(std::floor(clamp(x * (Real(1) / size), -kFar, kFar)));
}

/// Bodies of one layer are on one level and in one world.
RUBBLE_HD constexpr int layerOf(int world, int level) { return level + kGridLevels * world; }

RUBBLE_HD inline int bucketOf(const SolverData& s, int layer, int x, int y, int z) {
  // the layers of the first world have the numbers of their levels
  const std::uint32_t row = hash32(
      static_cast<std::uint32_t>(y) * 0x9e3779b1u ^
      hash32(static_cast<std::uint32_t>(z) * 32u + static_cast<std::uint32_t>(layer)));
  return static_cast<int>((row + static_cast<std::uint32_t>(x)) & static_cast<std::uint32_t>(s.cells - 1));
}

/// Detection margin of a body: half the smallest margin of a pair of equal bodies [m].
RUBBLE_HD inline Real ownMargin(const SolverData& s, const BodyParams& p) {
  return s.step->contactMargin * p.radius;
}

/// raise(most, value) for each maximum that is kept per level, with the value of a body: half extents and
/// cells.
template <class Raise> RUBBLE_HD void raiseExtents(const SolverData& s, const Bounds& b, Raise&& raise) {
  Counters& c = *s.counters;
  for (int k = 0; k < 3; ++k) raise(&c.levelHalf[b.level][k], floatBits(b.half[k] * Real(1.000001)));
  const int cell[3] = {b.x, b.y, b.z};
  for (int k = 0; k < 3; ++k)
    for (int side = 0; side < 2; ++side)
      raise(&c.levelReach[b.level][side][k], kCellOrigin + (side == 0 ? -cell[k] : cell[k]));
}

/// Displacement of a body in a step by its velocity and by the share of gravity that it followed in the last
/// step [m].
RUBBLE_HD inline Vec3 pathAhead(const SolverData& s, int i) {
  const Real dt = s.step->dt;
  const Vec3 v = s.velocity[i];
  if (s.params[i].kind != BodyKind::Dynamic) return dt * v;
  const Vec3 gravity = s.params[i].gravityScale * s.stepOf(i).gravity;
  return inertialDisplacement(v, followedShare(v, s.previousVelocity[i], gravity, dt) * gravity, dt);
}

/// Boxes at x^t, swept by the predicted motion and rotation, with the detection margin; and their cells.
struct ComputeBounds {
  static constexpr const char* kStage = "bounds";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!place(s, i)) return;
    const Bounds& b = s.bounds[i];
    if (int* members = &s.counters->levelCount[b.level]; atomicLoad(members) <= kListedBodies)
      list(s, b.level, atomicCount(members, 1), i);
    raiseExtents(s, b, [](int* most, int value) {
      if (value > atomicLoad(most)) atomicRaise(most, value);
    });
  }
  /// Stores body i as the k-th of its level.
  RUBBLE_HD static void list(const SolverData& s, int level, int k, int i) {
    if (k < kListedBodies) s.counters->levelBody[level][k] = i;
  }
  /// Everything but the maxima of the level. Returns false if the body is not in the grid.
  RUBBLE_HD static bool place(const SolverData& s, int i) {
    const BodyParams& p = s.params[i];
    Bounds& b = s.bounds[i];
    b.level = -1;
    if (p.kind == BodyKind::Removed || p.shape.kind == ShapeKind::Plane || isPaused(s, i)) return false;
    const Quat q = s.orientation[i];
    const Vec3 sweep = Real(.5) * pathAhead(s, i);
    const Vec3 x(s.position[i]);
    // Rotation moves the surface by at most the radius. The error of a single-precision center is added.
    const Real turn = min(s.step->dt * length(s.angularVelocity[i]), Real(1)) * p.radius;
    const Real roundOff = Real(2.4e-7) * (std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z));
    const Real grow = turn + ownMargin(s, p) + roundOff;
    // unpaired_impacts.h sweeps bodies that leave this box
    b.center = x + sweep;
    b.half = boundingHalf(p.shape, q) + abs(sweep) + Vec3{grow, grow, grow};
    int level = 0;
    const Real widest = max(kTurnedWay * p.radius, max(b.half.x, max(b.half.y, b.half.z)));
    Real size = cellSize(level);
    while (level < kGridLevels - 1 && widest > kLevelFill * size) ++level, size *= 2;
    b.level = level;
    b.x = cellOf(b.center.x, size), b.y = cellOf(b.center.y, size), b.z = cellOf(b.center.z, size);
    atomicCount(&s.bucketCount[bucketOf(s, layerOf(s.worldOf(i), level), b.x, b.y, b.z)], 1);
    return true;
  }
};

/// Sorts bodies into buckets. The order inside a bucket is not fixed; pairs are sorted later.
struct FillGrid {
  static constexpr const char* kStage = "grid";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounds& b = s.bounds[i];
    if (b.level < 0) return;
    const int layer = layerOf(s.worldOf(i), b.level), bucket = bucketOf(s, layer, b.x, b.y, b.z);
    const int slot = s.bucketOffset[bucket] + atomicCount(&s.bucketCount[bucket], -1) - 1;
    s.grid[slot] = {b.center, b.half, i, layer};
  }
};

/// visit(entry) for each body of a layer whose level has few bodies; share of worker `lane` of `lanes`.
/// Returns false if the level has many.
template <class Visit>
RUBBLE_HD bool visitListed(const SolverData& s, int layer, Visit&& visit, int lane = 0, int lanes = 1) {
  const int level = layer % kGridLevels, world = layer / kGridLevels;
  const int members = s.counters->levelCount[level];
  if (members > kListedBodies) return false;
  for (int k = lane; k < members; k += lanes) {
    const int body = s.counters->levelBody[level][k];
    if (s.worldOf(body) != world) continue;
    visit(GridEntry{s.bounds[body].center, s.bounds[body].half, body, layer});
  }
  return true;
}

/// Cells of a level that may contain the center of a body touching these bounds.
struct CellRange {
  int x0, x1, y0, y1, z0, z1;
  RUBBLE_HD bool empty() const { return x1 < x0 || y1 < y0 || z1 < z0; }
  RUBBLE_HD int rows() const { return (y1 - y0 + 1) * (z1 - z0 + 1); }
  RUBBLE_HD double cells() const {
    return (double(x1) - x0 + 1) * (double(y1) - y0 + 1) * (double(z1) - z0 + 1);
  }
};
RUBBLE_HD inline CellRange cellsAround(const SolverData& s, const Bounds& b, int level) {
  const Real size = cellSize(level);
  Vec3 reach;
  for (int k = 0; k < 3; ++k) reach[k] = b.half[k] + fromFloatBits(s.counters->levelHalf[level][k]);
  const auto& most = s.counters->levelReach[level];
  const auto low = [&](int k) { return max(cellOf(b.center[k] - reach[k], size), kCellOrigin - most[0][k]); };
  const auto high = [&](int k) {
    return min(cellOf(b.center[k] + reach[k], size), most[1][k] - kCellOrigin);
  };
  return {low(0), high(0), low(1), high(1), low(2), high(2)};
}

/// Entries of the buckets of a row of cells. They are contiguous, and wrap around after the last bucket.
struct RowOfCells {
  int begin, end;  ///< in the grid
  int wrapped;     ///< number of further entries at the beginning of the grid
};
RUBBLE_HD inline RowOfCells rowOfCells(const SolverData& s, int layer, int x0, int x1, int y, int z) {
  const int bucket = bucketOf(s, layer, x0, y, z), cells = x1 - x0 + 1, here = min(cells, s.cells - bucket);
  return {s.bucketOffset[bucket], s.bucketOffset[bucket + here],
          here < cells ? s.bucketOffset[cells - here] : 0};
}

/// Do two boxes (Bounds or GridEntry) touch?
template <class A, class B> RUBBLE_HD bool boundsTouch(const A& a, const B& b) {
  return !(std::fabs(a.center.x - b.center.x) > a.half.x + b.half.x) &&
         !(std::fabs(a.center.y - b.center.y) > a.half.y + b.half.y) &&
         !(std::fabs(a.center.z - b.center.z) > a.half.z + b.half.z);
}

/// The bodies of its own level that a body searches. InNumber: those of higher index. InPlace: those in later
/// cells in row order, and those of higher index in its own cell. Either way one of two bodies finds the
/// other; the latter visits half as many cells.
enum class Ahead { InNumber, InPlace };

/// found(other) for the bodies of a level whose bounds touch those of body i; share of worker `lane` of
/// `lanes`.
template <Ahead kAhead, class Found>
RUBBLE_HD void searchLevel(const SolverData& s, int i, const Bounds& b, int level, Found&& found, int lane,
                           int lanes) {
  const bool own = level == b.level;
  const int layer = layerOf(s.worldOf(i), level);
  const auto touches = [&](const GridEntry& e) { return boundsTouch(e, b); };
  const auto tryEntry = [&](const GridEntry& e) {
    if ((!own || e.body > i) && touches(e)) found(e.body);
  };
  if (visitListed(s, layer, tryEntry, lane, lanes)) return;
  const Real size = cellSize(level);
  const CellRange c = cellsAround(s, b, level);
  if (c.empty()) return;
  const bool inPlace = own && kAhead == Ahead::InPlace;
  // the first cell to visit
  const int x0 = inPlace ? b.x : c.x0, y0 = inPlace ? b.y : c.y0, z0 = inPlace ? b.z : c.z0;
  const auto tryCell = [&](const GridEntry& e, int x, int y, int z) {
    const bool ahead = !own || e.body > i || (inPlace && !(x == b.x && y == b.y && z == b.z));
    if (ahead && touches(e)) found(e.body);
  };
  // with more cells than buckets a scan of all bodies is cheaper, which bounds the cost of any speed
  if (c.cells() > s.cells) {
    for (int k = lane; k < s.bucketOffset[s.cells]; k += lanes) {
      const GridEntry& e = s.grid[k];
      if (e.layer != layer) continue;
      const int x = cellOf(e.center.x, size), y = cellOf(e.center.y, size), z = cellOf(e.center.z, size);
      if (!inPlace || z > z0 || (z == z0 && (y > y0 || (y == y0 && x >= x0)))) tryCell(e, x, y, z);
    }
    return;
  }
  const auto rowAt = [&](int y, int z) {
    return rowOfCells(s, layer, y == y0 && z == z0 ? x0 : c.x0, c.x1, y, z);
  };
  int y = y0, z = z0;
  const auto step = [&](int rows) {
    for (y += rows; y > c.y1; y -= c.y1 - c.y0 + 1) ++z;
    return z <= c.z1;
  };
  if (!step(lane)) return;
  RowOfCells next = rowAt(y, z);
  for (bool more = true; more;) {
    const RowOfCells row = next;
    const int rowY = y, rowZ = z, firstX = y == y0 && z == z0 ? x0 : c.x0;
    // the offsets of the next row are loaded before this row is processed
    more = step(lanes);
    if (more) next = rowAt(y, z);
    const auto visit = [&](const GridEntry& e) {
      if (e.layer != layer || !touches(e)) return;
      // cells of another row may share the bucket and would be visited twice
      const int x = cellOf(e.center.x, size);
      if (x >= firstX && x <= c.x1 && cellOf(e.center.y, size) == rowY && cellOf(e.center.z, size) == rowZ)
        tryCell(e, x, rowY, rowZ);
    };
    for (int k = row.begin; k < row.end; ++k) visit(s.grid[k]);
    for (int k = 0; k < row.wrapped; ++k) visit(s.grid[k]);
  }
}

/// found(plane) for the planes of a world that a box (Bounds or SweptBox) touches; share of worker `lane` of
/// `lanes`.
template <class Box, class Found>
RUBBLE_HD void searchPlanes(const SolverData& s, int world, const Box& b, Found&& found, int lane = 0,
                            int lanes = 1) {
  const int end = s.planesEnd(world);
  for (int k = s.planesBegin(world) + lane; k < end; k += lanes) {
    const int plane = s.planeBody[k];
    const Vec3 up = rotate(s.orientation[plane], Vec3{0, 0, 1});
    const Real height = dot(up, b.center - Vec3(s.position[plane]));
    if (height <= dot(abs(up), b.half)) found(plane);
  }
}
/// found(other) for all bodies whose bounds touch the box `way` of a motion of body i, which leaves its own
/// bounds.
template <class Found>
RUBBLE_HD void searchPath(const SolverData& s, int i, const Bounds& way, Found&& found, int lane, int lanes) {
  for (int level = 0; level < kGridLevels; ++level)
    if (s.counters->levelCount[level] > 0) searchLevel<Ahead::InNumber>(s, i, way, level, found, lane, lanes);
  searchPlanes(s, s.worldOf(i), way, found, lane, lanes);
}

/// found(other, otherOwns) for the bodies whose bounds touch those of body i: in its own level those ahead of
/// it, in coarser levels all. Share of worker `lane` of `lanes`.
template <Ahead kAhead, class Found>
RUBBLE_HD void searchBounds(const SolverData& s, int i, Found&& found, int lane = 0, int lanes = 1) {
  const BodyParams& p = s.params[i];
  if (p.kind == BodyKind::Removed || p.shape.kind == ShapeKind::Plane || isPaused(s, i)) return;
  const Bounds& b = s.bounds[i];
  for (int level = b.level; level < kGridLevels; ++level)
    searchLevel<kAhead>(
        s, i, b, level, [&](int other) { found(other, level == b.level && other < i); }, lane, lanes);
  searchPlanes(
      s, s.worldOf(i), b, [&](int plane) { found(plane, false); }, lane, lanes);
}
/// found(other) for the partners of body i: its bounds touch theirs, they may collide, and body i owns the
/// pair.
template <class Found>
RUBBLE_HD void searchPartners(const SolverData& s, int i, Found&& found, int lane = 0, int lanes = 1) {
  searchBounds<Ahead::InNumber>(
      s, i,
      [&](int other, bool) {
        if (mayCollide(s, i, other)) found(other);
      },
      lane, lanes);
}

/// Stores bodies with touching bounds with the owner of the pair. In one level that is the body of lower
/// index, else the one in the finer level. The first kPairSlots are stored, in no fixed order.
struct FindNeighbors {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { (*this)(s, i, 0, 1); }
  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD void operator()(const SolverData& s, int i, int lane, int lanes) const {
    searchBounds<Ahead::InPlace>(
        s, i,
        [&](int other, bool otherOwns) {
          const int owner = otherOwns ? other : i;
          const int slot = atomicCount(&s.pairCount[owner], 1);
          if (slot < kPairSlots) s.pairSlot[owner * kPairSlots + slot] = otherOwns ? i : other;
        },
        lane, lanes);
  }
};

/// Keeps the bodies that may collide as partners, and counts the pairs of parts. `kParts` false: no body has
/// parts, and the kernel stays small.
template <bool kParts> struct FindPairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int* const slots = s.pairSlot + i * kPairSlots;
    const int near = s.pairCount[i];
    if (!kParts && collidesWithAll(s, i)) return;
    int count = 0, partners = 0;
    const auto take = [&](int other) {
      const int without = count;
      if constexpr (kParts)
        forEachPartPair(s, i, other, [&](int, int) { ++count; });
      else
        ++count;
      if (count == without) return;
      if (partners < kPairSlots) slots[partners] = other;
      ++partners;
    };
    if (near > kPairSlots) {
      searchPartners(s, i, take);
    } else {
      for (int k = 0; k < near; ++k)
        if (const int other = slots[k]; mayCollide(s, i, other)) take(other);
    }
    s.pairCount[i] = count;
  }
};

/// Pairs sorted by owner, then by partner and parts.
template <bool kParts> struct WritePairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int begin = s.pairOffset[i], count = s.pairOffset[i + 1] - begin;
    const int* const slots = s.pairSlot + i * kPairSlots;
    if constexpr (!kParts) {
      if (count <= kPairSlots) {
        // one pair per partner: its rank is its place
        for (int k = 0; k < count; ++k) {
          const int other = slots[k];
          int place = begin;
          for (int j = 0; j < count; ++j) place += slots[j] < other;
          s.pair[place] = pairOf(s, i, other);
        }
        return;
      }
    }
    int n = 0;
    const auto insertPair = [&](const Pair& pair) {
      int k = begin + n++;
      for (; k > begin && before(pair, s.pair[k - 1]); --k) s.pair[k] = s.pair[k - 1];
      s.pair[k] = pair;
    };
    const auto insert = [&](int other) {
      if constexpr (kParts)
        forEachPartPair(s, i, other,
                        [&](int first, int second) { insertPair(pairOf(s, i, other, first, second)); });
      else
        insertPair(pairOf(s, i, other));
    };
    if (count > kPairSlots) return searchPartners(s, i, insert);
    // every partner has at least one pair, so there are no more partners than pairs
    int slot = 0;
    while (n < count) insert(slots[slot++]);
  }
};

}  // namespace rubble::RUBBLE_CORE

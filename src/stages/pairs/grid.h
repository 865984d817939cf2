#pragma once
/// The grid of the broad phase: hashed, with several levels. A body lies in the cell of its center, at the
/// level that fits its swept box. Buckets of cells with ascending x are adjacent in memory. Bodies with long
/// paths have levels of their own (long_paths.h).
#include "solver/inertia.h"
#include "stages/pairs/pair_parts.h"

namespace rubble::RUBBLE_CORE {

/// A path is long if it leads farther along an axis than this number of radii [1]. Of two bodies whose swept
/// boxes touch and whose paths are shorter, one is always within pairReach of the other (pathsMeet()).
inline constexpr Real kLongPath = 2;

/// Largest half extent of a body of a level, in cells; and the allowance for rotation and motion in the
/// radius test [1].
inline constexpr Real kLevelFill = Real(1.35), kTurnedWay = Real(1.1);

/// The size of the cells of a level: finer sizes have lower numbers. -1 for level -1.
RUBBLE_HD constexpr int sizeOf(int level) { return level % kGridSizes; }
/// Does a level hold the bodies with long paths?
RUBBLE_HD constexpr bool isLongLevel(int level) { return level >= kGridSizes; }

/// 2^k, for exponents that a normal float has.
RUBBLE_HD inline Real powerOfTwo(int k) {
  constexpr int kBias = 127, kMantissaBits = 23;
  return fromFloatBits((kBias + k) << kMantissaBits);
}
/// Edge of the cells of a level [m]: powers of two.
RUBBLE_HD inline Real cellSize(int level) { return powerOfTwo(sizeOf(level) - kMetreLevel); }

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
      hash32(static_cast<std::uint32_t>(z) * static_cast<std::uint32_t>(kGridLevels) +
             static_cast<std::uint32_t>(layer)));
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

/// The largest component of a path [m].
RUBBLE_HD inline Real longestSide(const Vec3& path) {
  return max(std::fabs(path.x), max(std::fabs(path.y), std::fabs(path.z)));
}
/// Displacement of a body in a step by its velocity and by the share of gravity that it followed in the last
/// step [m].
RUBBLE_HD inline Vec3 freePath(const SolverData& s, int i) {
  const Real dt = s.step->dt;
  const Vec3 v = s.velocity[i];
  if (s.params[i].kind != BodyKind::Dynamic) return dt * v;
  const Vec3 gravity = s.params[i].gravityScale * s.stepOf(i).gravity;
  return inertialDisplacement(v, followedShare(v, s.previousVelocity[i], gravity, dt) * gravity, dt);
}

/// Did continuous collision detection stop a body in the last step?
RUBBLE_HD inline bool wasStopped(const SolverData& s, int i) { return (s.pushed[i] & kStopped) != 0; }
/// The path of a body [m]. One that has just been stopped touches what stopped it, and their contact turns it
/// aside. It would leave a long path, so its path ends where that would become long.
RUBBLE_HD inline Vec3 pathAhead(const SolverData& s, int i) {
  const Vec3 path = freePath(s, i);
  if (!wasStopped(s, i)) return path;
  return path * min(Real(1), kLongPath * s.params[i].radius / longestSide(path));
}

/// Is a body in the grid in this step?
RUBBLE_HD inline bool isInGrid(const SolverData& s, int i) {
  const BodyParams& p = s.params[i];
  return p.kind != BodyKind::Removed && p.shape.kind != ShapeKind::Plane && !isPaused(s, i);
}

/// Boxes at x^t, swept by the predicted motion and rotation, with the detection margin; and their cells.
struct ComputeBounds {
  static constexpr const char* kStage = "bounds";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounds b = place(s, i);
    if (b.level < 0) return;
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
  /// Everything but the maxima of the level.
  RUBBLE_HD static Bounds place(const SolverData& s, int i) {
    const Bounds b = boundsNow(s, i);
    storeWhole(s.bounds[i], b);
    if (b.level >= 0)
      atomicCount(&s.bucketCount[bucketOf(s, layerOf(s.worldOf(i), b.level), b.x, b.y, b.z)], 1);
    return b;
  }

 private:
  RUBBLE_HD static Bounds boundsNow(const SolverData& s, int i) {
    const BodyParams& p = s.params[i];
    Bounds b{};
    b.level = -1;
    if (!isInGrid(s, i)) return b;
    const Quat q = s.orientation[i];
    b.path = pathAhead(s, i);
    const Vec3 sweep = Real(.5) * b.path;
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
    while (level < kGridSizes - 1 && widest > kLevelFill * size) ++level, size *= 2;
    b.level = level;
    if (!wasStopped(s, i) && longestSide(b.path) > kLongPath * p.radius) {
      b.level += kGridSizes;
      atomicRaise(&s.counters->pathCells, s.cells);
    }
    b.x = cellOf(b.center.x, size), b.y = cellOf(b.center.y, size), b.z = cellOf(b.center.z, size);
    return b;
  }
};

/// A world of up to so many bodies is scanned instead of its cells. Its bodies are neighbors in memory, and
/// threads that search for them at the same time read the same ones. A vertex looks into few cells.
inline constexpr int kScannedBodies = 128, kScannedByVertices = 16;

RUBBLE_HD inline bool isScanned(const SolverData& s, int world, int most = kScannedBodies) {
  return s.bodiesEnd(world) - s.bodiesBegin(world) <= most;
}

/// look(body, bounds) for the bodies of a world in the grid, if it has up to `most`; share of worker `lane`
/// of `lanes`. Returns false if it has more.
template <class Look>
RUBBLE_HD bool scanWorld(const SolverData& s, int world, Look&& look, int lane = 0, int lanes = 1,
                         int most = kScannedBodies) {
  if (!isScanned(s, world, most)) return false;
  for (int k = s.bodiesBegin(world) + lane, end = s.bodiesEnd(world); k < end; k += lanes)
    if (const Bounds& b = s.bounds[k]; b.level >= 0) look(k, b);
  return true;
}

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

/// Does a box (Bounds or SweptBox) touch the half space of a plane?
template <class Box> RUBBLE_HD bool touchesPlane(const SolverData& s, int plane, const Box& b) {
  const Vec3 up = rotate(s.orientation[plane], Vec3{0, 0, 1});
  return dot(up, b.center - Vec3(s.position[plane])) <= dot(abs(up), b.half);
}
/// Do two boxes (Bounds or GridEntry) touch?
template <class A, class B> RUBBLE_HD bool boundsTouch(const A& a, const B& b) {
  return !(std::fabs(a.center.x - b.center.x) > a.half.x + b.half.x) &&
         !(std::fabs(a.center.y - b.center.y) > a.half.y + b.half.y) &&
         !(std::fabs(a.center.z - b.center.z) > a.half.z + b.half.z);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Broad phase: the search for pairs in the grid. A body searches its own level and all coarser ones. Two
/// bodies are partners if their swept boxes touch and, with long paths, if they come near on these.
#include "stages/pairs/filter.h"
#include "stages/pairs/lasting_search.h"
#include "stages/pairs/long_paths.h"

namespace rubble::RUBBLE_CORE {

/// The bodies of a layer that a body searches. All: every one. InNumber: those of higher index. InPlace:
/// those in later cells in row order, and those of higher index in its own cell. By either of the last two,
/// one of two bodies of a layer finds the other; InPlace visits half as many cells.
enum class Ahead { All, InNumber, InPlace };

/// found(other) for the bodies of a level whose bounds touch b; share of worker `lane` of `lanes`. `b`: the
/// bounds of body i, or for Ahead::All any other box.
template <class Found>
RUBBLE_HD void searchLevel(const SolverData& s, int i, const Bounds& b, int level, Ahead which, Found&& found,
                           int lane, int lanes) {
  const int layer = layerOf(s.worldOf(i), level);
  const auto touches = [&](const GridEntry& e) { return boundsTouch(e, b); };
  const auto tryEntry = [&](const GridEntry& e) {
    if ((which == Ahead::All || e.body > i) && touches(e)) found(e.body);
  };
  if (visitListed(s, layer, tryEntry, lane, lanes)) return;
  const Real size = cellSize(level);
  const CellRange c = cellsAround(s, b, level);
  if (c.empty()) return;
  const bool inPlace = which == Ahead::InPlace;
  // the first cell to visit
  const int x0 = inPlace ? b.x : c.x0, y0 = inPlace ? b.y : c.y0, z0 = inPlace ? b.z : c.z0;
  const auto tryCell = [&](const GridEntry& e, int x, int y, int z) {
    const bool ahead = which == Ahead::All || e.body > i || (inPlace && !(x == b.x && y == b.y && z == b.z));
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
    if (const int plane = s.planeBody[k]; touchesPlane(s, plane, b)) found(plane);
  }
}
/// found(other) for the bodies with long paths in a level whose bounds touch those of a probe, which also
/// come near it if it follows its path. `which` and `i` as in searchLevel(); share of worker `lane` of
/// `lanes`.
template <class Found>
RUBBLE_HD void searchLongPaths(const SolverData& s, int i, const PathProbe& probe, int level, Ahead which,
                               Found&& found, int lane, int lanes) {
  const Bounds& b = probe.box;
  const int layer = layerOf(s.worldOf(i), level);
  const auto foundTouching = [&](int j) {
    if (!probe.follows || pathsMeet(s, i, j)) found(j);
  };
  const auto tryEntry = [&](const GridEntry& e) {
    if ((which == Ahead::All || e.body > i) && boundsTouch(e, b)) foundTouching(e.body);
  };
  if (visitListed(s, layer, tryEntry, lane, lanes)) return;
  const CellRange c = cellsAround(s, b, level);
  if (c.empty()) return;
  // with more cells than buckets a scan of all bodies is cheaper
  if (c.cells() > s.cells) return searchLevel(s, i, b, level, which, foundTouching, lane, lanes);
  const int wide = c.x1 - c.x0 + 1, deep = c.y1 - c.y0 + 1, cells = wide * c.rows();
  for (int k = lane; k < cells; k += lanes) {
    const CellAt cell{level, layer, c.x0 + k % wide, c.y0 + k / wide % deep, c.z0 + k / wide / deep};
    const bool own = cell.holds(b);
    if (which == Ahead::InPlace && !own &&
        !(cell.z != b.z   ? cell.z > b.z
          : cell.y != b.y ? cell.y > b.y
                          : cell.x > b.x))
      continue;
    const bool every = which == Ahead::All || (which == Ahead::InPlace && !own);
    const auto tryBody = [&](int j) {
      if ((every || j > i) && boundsTouch(s.bounds[j], b)) foundTouching(j);
    };
    const int bucket = bucketOf(s, layer, cell.x, cell.y, cell.z), begin = s.bucketOffset[bucket],
              end = s.bucketOffset[bucket + 1];
    if (visitSubcells(s, cell, probe, end - begin, tryBody)) continue;
    for (int entry = begin; entry < end; ++entry) {
      const GridEntry& e = s.grid[entry];
      // another cell may share the bucket
      if (e.layer == layer && (every || e.body > i) && boundsTouch(e, b) && cell.holds(s.bounds[e.body]))
        foundTouching(e.body);
    }
  }
}

/// found(other) for all bodies whose bounds touch the box `way`, in which body i is away from its path.
template <class Found>
RUBBLE_HD void searchWay(const SolverData& s, int i, const Bounds& way, Found&& found, int lane, int lanes) {
  const int world = s.worldOf(i);
  const auto scan = [&](int other, const Bounds& its) {
    if (boundsTouch(its, way)) found(other);
  };
  const bool scanned = scanWorld(s, world, scan, lane, lanes);
  for (int level = 0; !scanned && level < kGridLevels; ++level) {
    if (s.counters->levelCount[level] == 0) continue;
    if (isLongLevel(level))
      searchLongPaths(s, i, {way, s.params[i].radius, false}, level, Ahead::All, found, lane, lanes);
    else
      searchLevel(s, i, way, level, Ahead::All, found, lane, lanes);
  }
  searchPlanes(s, world, way, found, lane, lanes);
}

/// In a scan, is it body i, with the bounds `b`, that finds another body of a level, and not the other way?
RUBBLE_HD inline bool isAhead(int i, const Bounds& b, int other, int level) {
  return !isLongLevel(level) && (level > b.level || (level == b.level && other > i));
}

/// found(other) for the bodies whose boxes touch that of body i, if neither has a long path: in its own level
/// those of higher index, in coarser levels all. Share of worker `lane` of `lanes`.
template <class Found>
RUBBLE_HD void searchBounds(const SolverData& s, int i, Found&& found, int lane = 0, int lanes = 1) {
  if (!isInGrid(s, i)) return;
  const Bounds& b = s.bounds[i];
  if (isLongLevel(b.level)) return;
  const int world = s.worldOf(i);
  const auto scan = [&](int other, const Bounds& its) {
    if (isAhead(i, b, other, its.level) && boundsTouch(its, b)) found(other);
  };
  const bool scanned = scanWorld(s, world, scan, lane, lanes);
  for (int level = b.level; !scanned && level < kGridSizes; ++level)
    searchLevel(s, i, b, level, level == b.level ? Ahead::InNumber : Ahead::All, found, lane, lanes);
  searchPlanes(s, world, b, found, lane, lanes);
}
/// The same if one of the two has a long path.
template <Ahead kAhead, class Found>
RUBBLE_HD RUBBLE_OUT_OF_LINE void searchPaths(const SolverData& s, int i, Found&& found, int lane = 0,
                                              int lanes = 1) {
  if (i >= s.bodies || !isInGrid(s, i)) return;
  const Bounds& b = s.bounds[i];
  const bool isLong = isLongLevel(b.level);
  const int world = s.worldOf(i);
  const auto scan = [&](int other, const Bounds& its) {
    const int size = sizeOf(its.level), own = sizeOf(b.level);
    if (!(isLong || isLongLevel(its.level)) || size < own || (size == own && other <= i)) return;
    if (boundsTouch(its, b) && pathsMeet(s, i, other)) found(other, false);
  };
  const bool scanned = scanWorld(s, world, scan, lane, lanes);
  for (int size = sizeOf(b.level); !scanned && size < kGridSizes; ++size) {
    const bool same = size == sizeOf(b.level);
    const auto foundPartner = [&](int other) { found(other, same && other < i); };
    const auto foundBody = [&](int other) {
      if (pathsMeet(s, i, other)) foundPartner(other);
    };
    const auto which = [&](int level) {
      return level == b.level ? kAhead : same && kAhead == Ahead::InNumber ? kAhead : Ahead::All;
    };
    // of bodies with long and with short paths in cells of one size, in place the latter find the former
    const bool foundByOthers = same && kAhead == Ahead::InPlace;
    if (isLong && !foundByOthers) searchLevel(s, i, b, size, which(size), foundBody, lane, lanes);
    if (const int level = size + kGridSizes; s.counters->levelCount[level] > 0)
      searchLongPaths(s, i, {b, s.params[i].radius, true}, level, which(level), foundPartner, lane, lanes);
  }
  if (!isLong) return;
  searchPlanes(
      s, world, b, [&](int plane) { found(plane, false); }, lane, lanes);
}
/// found(other) for the partners of body i with which it may collide and owns the pair.
template <class Found>
RUBBLE_HD void searchPartners(const SolverData& s, int i, Found&& found, int lane = 0, int lanes = 1) {
  const auto foundPartner = [&](int other) {
    if (mayCollide(s, i, other)) found(other);
  };
  searchBounds(s, i, foundPartner, lane, lanes);
  if (s.counters->pathCells > 0)
    searchPaths<Ahead::InNumber>(
        s, i, [&](int other, bool) { foundPartner(other); }, lane, lanes);
}

/// Do so many more neighbors crowd a body that had `before`? It has more than slots from then on.
RUBBLE_HD constexpr bool crowds(int before, int more) {
  return before <= kPairSlots && before + more > kPairSlots;
}
/// Stores a neighbor with its owner. In cells of one size that is the body of lower index, else the one in
/// the finer cells. The first kPairSlots are stored, in no fixed order.
RUBBLE_HD inline void storeNeighbor(const SolverData& s, int i, int other, bool otherOwns) {
  const int owner = otherOwns ? other : i;
  const int slot = atomicCount(&s.neighborSearch[owner].found, 1);
  if (slot < kPairSlots) s.pairSlot[owner * kPairSlots + slot] = otherOwns ? i : other;
  if (crowds(slot, 1)) listCrowded(s, owner);
}
/// Stores what body i has found in a level, unless the other one finds it.
struct StoreFound {
  int i, level;  ///< of the body that searches
  RUBBLE_HD void operator()(const SolverData& s, int other, int its) const {
    if (other == i || !searchesMeet(s, i, other)) return;
    const bool owns = its > level || (its == level && other > i);
    if (owns || s.neighborSearch[other].isNew == 0) storeNeighbor(s, i, other, !owns);
  }
};
/// Finds the neighbors of the bodies that search, without long paths.
struct FindNeighbors {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int k) const { (*this)(s, k, 0, 1); }
  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD void operator()(const SolverData& s, int k, int lane, int lanes) const {
    const bool all = allSearch(s);
    find(s, all ? k : s.searcher[k], all, lane, lanes);
  }
  /// For body i. `all`: all bodies search.
  RUBBLE_HD static void find(const SolverData& s, int i, bool all, int lane, int lanes) {
    if (!isInGrid(s, i)) return;
    const Bounds& b = s.bounds[i];
    if (isLongLevel(b.level)) return;
    const int world = s.worldOf(i);
    const NeighborSearch& own = s.neighborSearch[i];
    const StoreFound store{i, b.level};
    // boxes of searches that begin together reach one slack beyond those of the bodies
    const Real slacks = all ? Real(1) : kMostSlacks;
    const bool scanned = scanWorld(
        s, world,
        [&](int other, const Bounds& its) {
          if (!isLongLevel(its.level)) store(s, other, its.level);
        },
        lane, lanes);
    for (int level = all ? b.level : 0; !scanned && level < kGridSizes; ++level) {
      const bool inPlace = all && level == b.level;
      searchLevel(
          s, i, searchBox(s, b, own, level, slacks), level, inPlace ? Ahead::InPlace : Ahead::All,
          [&](int other) {
            if (!inPlace) return store(s, other, level);
            if (searchesMeet(s, i, other)) storeNeighbor(s, i, other, other < i);
          },
          lane, lanes);
    }
    searchPlanes(
        s, world, own, [&](int plane) { storeNeighbor(s, i, plane, false); }, lane, lanes);
  }
};
/// Finds partners of which one has a long path. It is a separate kernel so that the other one stays small.
struct FindPathNeighbors {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { (*this)(s, i, 0, 1); }
  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD void operator()(const SolverData& s, int i, int lane, int lanes) const {
    searchPaths<Ahead::InPlace>(
        s, i, [&](int other, bool otherOwns) { storeNeighbor(s, i, other, otherOwns); }, lane, lanes);
  }
};

/// Finds the neighbors that are partners, and counts the pairs of parts. `kParts` false: no body has parts,
/// and the kernel stays small.
template <bool kParts> struct FindPairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    NeighborSearch& search = s.neighborSearch[i];
    const int found = search.found;
    std::uint32_t marked = 0;
    int count = 0;
    if (s.bounds[i].level >= 0) {
      int* const slots = s.pairSlot + i * kPairSlots;
      const auto take = [&](int other, int slot) {
        const int pairs = pairsWith(s, i, other);
        if (pairs > 0 && slot < kPairSlots) marked |= 1u << slot;
        count += pairs;
        return pairs > 0;
      };
      if (found > kPairSlots) {
        int partners = 0;
        searchPartners(s, i, [&](int other) {
          if (partners < kPairSlots) slots[partners] = other;
          if (take(other, partners)) ++partners;
        });
      } else {
        for (int k = 0; k < found; ++k)
          if (isPartner(s, i, slots[k])) take(slots[k], k);
      }
    }
    search.partners = marked;
    s.pairCount[i] = count;
  }
  /// Is a neighbor of a body in the grid its partner?
  RUBBLE_HD static bool isPartner(const SolverData& s, int i, int other) {
    return arePartners(s, i, other) && mayCollide(s, i, other);
  }
  RUBBLE_HD static int pairsWith(const SolverData& s, int i, int other) {
    if constexpr (!kParts) return 1;
    int count = 0;
    forEachPartPair(s, i, other, [&](int, int) { ++count; });
    return count;
  }
};

/// Pairs sorted by owner, then by partner and parts.
template <bool kParts> struct WritePairs {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int begin = s.pairOffset[i], count = s.pairOffset[i + 1] - begin;
    if constexpr (!kParts)
      if (count <= kPairSlots) return writeFew(s, i, begin);
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
    // every partner has at least one pair, so there are no more partners than pairs
    if (count > kPairSlots)
      searchPartners(s, i, insert);
    else
      forEachPartner(s, i, insert);
  }
  /// Up to kPairSlots pairs of a body, one per partner: the rank of a pair is its place.
  RUBBLE_HD static void writeFew(const SolverData& s, int i, int begin) {
    forEachPartner(s, i, [&](int partner) {
      int place = begin;
      forEachPartner(s, i, [&](int other) { place += other < partner; });
      s.pair[place] = pairOf(s, i, partner);
    });
  }

 private:
  /// visit(partner) for those in slots.
  template <class Visit> RUBBLE_HD static void forEachPartner(const SolverData& s, int i, Visit&& visit) {
    for (unsigned left = s.neighborSearch[i].partners; left != 0; left &= left - 1)
      visit(s.pairSlot[i * kPairSlots + lowestBit(left)]);
  }
};

}  // namespace rubble::RUBBLE_CORE

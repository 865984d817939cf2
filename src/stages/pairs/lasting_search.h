#pragma once
/// A search for neighbors lasts several steps. Bodies are searched for with some slack around their boxes,
/// and what was found holds for a body until its box leaves the one of its search. Then it alone searches
/// again: the other bodies forget it, and it finds all of its neighbors. Which neighbors touch is found in
/// each step, so pairs do not depend on when the last search was.
///
/// Two bodies are neighbors if the boxes of their searches touch. Of two bodies that search in the same step
/// one finds the other; of two of which one searches, that one does.
#include "stages/pairs/grid.h"

namespace rubble::RUBBLE_CORE {

/// How far beyond its box a body is searched for, in cells of its level [1]: far more than bodies at rest
/// move in a thousand steps, and so little that few boxes come near that do not touch.
inline constexpr Real kSearchSlack = Real(1) / 16;
/// The same for a level [m].
RUBBLE_HD inline Real searchSlack(int level) { return kSearchSlack * cellSize(level); }
/// Share of the slack that a box must keep to the one of its search: far more than round-off [1].
inline constexpr Real kSlackKept = Real(.25);
/// The box of a search may reach beyond that of its body by this number of slacks, else it does not hold
/// either: bodies that search alone look that far for it [1].
inline constexpr Real kMostSlacks = 2;
/// Steps that a search must last to be worth its slack.
inline constexpr Real kLeastSteps = 4;
/// Of so many bodies one may search alone. If more do, all search, which is cheaper: each pair is then looked
/// for from one side.
inline constexpr int kBodiesPerSearcher = 4;
/// A body that finds bodies in cells more levels finer than this visits many. A few such bodies search for
/// themselves; if there are more, all search.
inline constexpr int kFinerLevels = 3;

/// Does a body with these bounds move so far in a step that a search would not last?
RUBBLE_HD inline bool isRestless(const Bounds& b) {
  return b.level >= 0 && kLeastSteps * longestSide(b.path) > searchSlack(b.level);
}
/// Slack of a search that begins in this step, for a body with these bounds [m].
RUBBLE_HD inline Real slackNow(const SolverData& s, const Bounds& b) {
  return s.searchesAlways || isRestless(b) ? Real(0) : searchSlack(b.level);
}
/// The box in which a body with a search finds all bodies of a level that are its neighbors, and others.
/// `slacks`: by so many the boxes of their searches may reach beyond those of the bodies [1].
RUBBLE_HD inline Bounds searchBox(const SolverData& s, const Bounds& b, const NeighborSearch& own, int level,
                                  Real slacks) {
  const Real slack = s.searchesAlways ? Real(0) : slacks * searchSlack(level);
  Bounds box = b;
  box.center = own.center, box.half = own.half + Vec3{slack, slack, slack};
  return box;
}

/// NeighborSearch::layer of what is in no search, and of planes of world 0; those of world w have kPlanes -
/// w.
inline constexpr int kOutside = -1, kPlanes = -2;
/// What a search for the neighbors of body or plane i depends on in this step.
RUBBLE_HD inline NeighborSearch searchOf(const SolverData& s, int i) {
  NeighborSearch search{};
  search.layer = kOutside, search.bodies = s.bodies, search.isNew = 1;
  const Bounds& b = loadUnchanging(s.bounds[i]);
  if (b.level >= 0) {
    const Real slack = slackNow(s, b);
    search.layer = layerOf(s.worldOf(i), b.level);
    search.center = b.center, search.half = b.half + Vec3{slack, slack, slack};
  } else if (const BodyParams& p = s.params[i];
             p.kind != BodyKind::Removed && p.shape.kind == ShapeKind::Plane) {
    search.layer = kPlanes - s.worldOf(i);
    search.center = Vec3(s.position[i]), search.half = rotate(s.orientation[i], Vec3{0, 0, 1});
  }
  return search;
}
/// Begins a search for the neighbors of body or plane i.
RUBBLE_HD inline void beginSearch(const SolverData& s, int i) {
  storeWhole(s.neighborSearch[i], searchOf(s, i));
}
/// Does a search hold for a body with the bounds `b`, in the layer of that search?
RUBBLE_HD inline bool boxHolds(const Bounds& b, const NeighborSearch& then) {
  const Real slack = searchSlack(b.level), kept = kSlackKept * slack;
  const auto holds = [&](Real way, Real now, Real half) {
    return way + now <= half - kept && way + half <= now + kMostSlacks * slack;
  };
  const Vec3 way = abs(b.center - then.center);
  return holds(way.x, b.half.x, then.half.x) && holds(way.y, b.half.y, then.half.y) &&
         holds(way.z, b.half.z, then.half.z);
}
/// Does the last search hold for body or plane i? A long path is searched in each step.
RUBBLE_HD inline bool searchHolds(const SolverData& s, int i, const NeighborSearch& then) {
  const NeighborSearch now = searchOf(s, i);
  if (now.bodies != then.bodies || now.layer != then.layer) return false;
  const Bounds& b = loadUnchanging(s.bounds[i]);
  if (b.level >= 0) return !s.searchesAlways && !isLongLevel(b.level) && boxHolds(b, then);
  const Vec3 moved = abs(now.center - then.center) + abs(now.half - then.half);
  return moved.x + moved.y + moved.z == Real(0);
}

/// Does a body with these bounds visit many cells if it searches for itself?
RUBBLE_HD inline bool isCoarse(const SolverData& s, const Bounds& b) {
  if (isLongLevel(b.level)) return false;
  for (int level = 0; level < sizeOf(b.level) - kFinerLevels; ++level)
    if (s.counters->levelCount[level] > kListedBodies) return true;
  return false;
}
/// Do all bodies search in this step? Valid after BeginSearches.
RUBBLE_HD inline bool allSearch(const SolverData& s) {
  return s.searchesAlways || s.counters->allSearch != 0 ||
         s.counters->searchers > s.bodies / kBodiesPerSearcher;
}

/// Lists a body that has more neighbors than slots.
RUBBLE_HD inline void listCrowded(const SolverData& s, int i) {
  s.crowdedBody[atomicCount(&s.counters->crowded, 1)] = i;
}

/// Begins searches for bodies whose last one does not hold, and lists them. Of others it lists the crowded.
struct BeginSearches {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    NeighborSearch& search = s.neighborSearch[i];
    const NeighborSearch& last = loadUnchanging(search);
    if (searchHolds(s, i, last)) {
      if (last.isNew != 0) search.isNew = 0;
      if (last.found > kPairSlots) listCrowded(s, i);
      return;
    }
    beginSearch(s, i);
    const Bounds& b = s.bounds[i];
    // where there are many worlds some body always searches; a plane may meet all bodies
    const bool withAll = s.worlds > 1 || (b.level < 0 && search.layer != kOutside) ||
                         (isCoarse(s, b) && !listCoarse(s, i));
    if (withAll && atomicLoad(&s.counters->allSearch) == 0) atomicRaise(&s.counters->allSearch, 1);
    if (!allSearch(s)) s.searcher[atomicCount(&s.counters->searchers, 1)] = i;
  }

 private:
  /// Returns whether there was room.
  RUBBLE_HD static bool listCoarse(const SolverData& s, int i) {
    const int k = atomicCount(&s.counters->coarse, 1);
    if (k < kMostCoarse) s.counters->coarseBody[k] = i;
    return k < kMostCoarse;
  }
};

/// Begins the searches of the other bodies if all search. Else they forget the neighbors that search.
struct ForgetSearchers {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const bool all = allSearch(s);
    if (!all && s.counters->searchers == 0) return;
    if (i == 0) {
      s.counters->searched = all ? s.bodies : s.counters->searchers;
      if (all) s.counters->crowded = 0;
    }
    NeighborSearch& search = s.neighborSearch[i];
    if (search.isNew != 0) return;
    if (all)
      beginSearch(s, i);
    else
      forget(s, i, search);
  }

 private:
  RUBBLE_HD static void forget(const SolverData& s, int i, NeighborSearch& search) {
    if (search.found > kPairSlots) {
      // of those without a slot only that there are some is known
      search.found = kPairSlots + 1;
      return;
    }
    int* const slots = s.pairSlot + i * kPairSlots;
    int left = 0;
    for (int k = 0; k < search.found; ++k) {
      const int other = slots[k];
      if (s.neighborSearch[other].isNew != 0) continue;
      if (left != k) slots[left] = other;
      ++left;
    }
    if (left != search.found) search.found = left;
  }
};

/// Are two bodies neighbors?
RUBBLE_HD inline bool searchesMeet(const SolverData& s, int i, int j) {
  return boundsTouch(s.neighborSearch[i], s.neighborSearch[j]);
}

}  // namespace rubble::RUBBLE_CORE

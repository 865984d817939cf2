#pragma once
/// A search for neighbors lasts several steps. Bodies are searched for with some slack around their boxes,
/// and what was found holds until a box leaves the one of its search. Which neighbors touch is found in each
/// step, so pairs do not depend on when the last search was. While something moves so far that a search would
/// not last, searches have no slack.
#include "stages/pairs/grid.h"

namespace rubble::RUBBLE_CORE {

/// How far beyond its box a body is searched for, in cells of its level [1]: far more than bodies at rest
/// move in a thousand steps, and so little that few boxes come near that do not touch.
inline constexpr Real kSearchSlack = Real(1) / 16;
/// The same for a level [m].
RUBBLE_HD inline Real searchSlack(int level) { return kSearchSlack * cellSize(level); }
/// Share of the slack that a box must keep to the one of its search: far more than round-off [1].
inline constexpr Real kSlackKept = Real(.25);
/// Steps that a search must last to be worth its slack.
inline constexpr Real kLeastSteps = 4;

/// Does body i move so far in a step that a search would not last?
RUBBLE_HD inline bool isRestless(const SolverData& s, int i) {
  const Bounds& b = loadUnchanging(s.bounds[i]);
  return b.level >= 0 && kLeastSteps * longestSide(b.path) > searchSlack(b.level);
}
/// Slack of the search in this step, for a level [m].
RUBBLE_HD inline Real slackNow(const SolverData& s, int level) {
  const bool lasts = !s.searchesAlways && s.counters->pathCells == 0 && s.counters->restless == 0;
  return lasts ? searchSlack(level) : Real(0);
}

/// The box in which a body with the bounds `b` searches the bodies of a level.
RUBBLE_HD inline Bounds searchBox(const SolverData& s, const Bounds& b, int level) {
  const Real slack = slackNow(s, b.level) + slackNow(s, level);
  Bounds box = b;
  box.half += Vec3{slack, slack, slack};
  return box;
}

/// NeighborSearch::layer of what is in no search, and of planes of world 0; those of world w have kPlanes -
/// w.
inline constexpr int kOutside = -1, kPlanes = -2;
/// What a search for the neighbors of body or plane i depends on, with some slack around its box [m].
RUBBLE_HD inline NeighborSearch searchOf(const SolverData& s, int i, Real slack = 0) {
  const Bounds& b = loadUnchanging(s.bounds[i]);
  if (b.level >= 0)
    return {b.center, layerOf(s.worldOf(i), b.level), b.half + Vec3{slack, slack, slack}, s.bodies, 0, 0};
  const BodyParams& p = s.params[i];
  if (p.kind == BodyKind::Removed || p.shape.kind != ShapeKind::Plane)
    return {{0, 0, 0}, kOutside, {0, 0, 0}, s.bodies, 0, 0};
  return {
      Vec3(s.position[i]), kPlanes - s.worldOf(i), rotate(s.orientation[i], Vec3{0, 0, 1}), s.bodies, 0, 0};
}
/// Notes the search for the neighbors of body or plane i in this step.
RUBBLE_HD inline void noteSearch(const SolverData& s, int i) {
  storeWhole(s.neighborSearch[i], searchOf(s, i, slackNow(s, s.bounds[i].level)));
}
/// Does the last search hold for body i?
RUBBLE_HD inline bool searchHolds(const SolverData& s, int i) {
  const NeighborSearch now = searchOf(s, i), &then = loadUnchanging(s.neighborSearch[i]);
  const Bounds& b = loadUnchanging(s.bounds[i]);
  const bool inGrid = b.level >= 0;
  // a body that has left the grid has no pairs
  if (now.layer == kOutside) return true;
  if (now.bodies != then.bodies || now.layer != then.layer) return false;
  if (!inGrid) {
    const Vec3 moved = abs(now.center - then.center) + abs(now.half - then.half);
    return moved.x + moved.y + moved.z == Real(0);
  }
  const Real kept = kSlackKept * searchSlack(b.level);
  const Vec3 way = abs(now.center - then.center) + b.half;
  return way.x <= then.half.x - kept && way.y <= then.half.y - kept && way.z <= then.half.z - kept;
}

/// Finds out whether neighbors are searched in this step, if the last search does not hold for a body or a
/// path is long; and whether that search can last.
struct CheckNeighbors {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    int &searched = s.counters->searched, &restless = s.counters->restless;
    if (atomicLoad(&searched) == 0 && (s.searchesAlways || s.counters->pathCells > 0 || !searchHolds(s, i)))
      atomicRaise(&searched, 1);
    if (atomicLoad(&restless) == 0 && isRestless(s, i)) atomicRaise(&restless, 1);
  }
};

/// Neighbors that the last search has found for a body, before pairs of the step are counted in pairCount.
RUBBLE_HD inline int neighborsOf(const SolverData& s, int i) {
  return s.counters->searched != 0 ? s.pairCount[i] : s.neighborSearch[i].found;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Surfaces of deformable objects that do not cross in a step do not cross at its end.
///
/// Rows keep surfaces apart by their thickness, as well as a few iterations can. What they leave is checked
/// here: the way of every vertex from x^t to where the iterations have put it, a straight line, for meetings
/// of vertices with triangles and of edges with edges. Surfaces that start apart can not cross without such a
/// meeting (neighbours that share a corner can not either). Where two parts would come nearer than a part of
/// their distance, the approach of their nearest points ends at that time: opposite changes of the ways of
/// their corners, shared out by mass along the line between the points, as of an impact without rebound. All
/// such pairs at once, again and again; after kDeflections rounds the corners of those that are left go half
/// the way, then a quarter, and at last stay where they are, which is free of crossings. Where that lets
/// others meet, round after round, as in a tangle, whole objects stay, and at last all that is near to
/// anything: the rounds are bounded.
///
/// Nothing else bounds a motion: ways on which no parts meet are not touched, however long they are and
/// however near the parts lie. The velocity follows from where a vertex ends, as everywhere.
#include "stages/soft/feature_contacts.h"

namespace rubble::RUBBLE_CORE {

/// In a step two parts come no nearer than this share of their radii [1], or ...
inline constexpr Real kLeastSurfaceGap = Real(.25);
/// ... this share of their distance, if that is less [1].
inline constexpr Real kLeastSurfaceShare = Real(.8);
/// What a change adds to the distance at a meeting, in distances that the parts may come nearer by: else it
/// would be met again [1].
inline constexpr Real kClearance = Real(.2);
/// Rounds in which ways are changed, at most, and pairs for each vertex and edge of an object that may be
/// looked at in all of them: the more pairs a tangle has, the fewer rounds.
inline constexpr int kDeflections = 20, kDeflectedPairs = 32 * kDeflections;
/// Halvings of a way after which nothing of it is left, and rounds for that: to stop one vertex may let
/// others meet it.
inline constexpr int kMostHalvings = 3, kCuts = 8;
/// Rounds in which whole objects stay, before all that may meet anything does.
inline constexpr int kStays = 4;
/// No step has more rounds than these: what is not resolved then does not move, and nothing that stands still
/// crosses.
inline constexpr int kMostCrossingRounds = kDeflections + kCuts + kStays + 1;

/// Rounds of this step in which ways of the object of a vertex are changed.
RUBBLE_HD inline int deflections(const SolverData& s, int v) {
  const VertexRepair& object = s.vertexRepair[s.vertexParams[v].first];
  const Real most = static_cast<Real>(kDeflections),
             share = static_cast<Real>(object.owners) / static_cast<Real>(max(object.activePairs, 1));
  return static_cast<int>(clamp(kDeflectedPairs * share, Real(1), most));
}

/// Clears what the step before has left. Before the grid is filled: boxes hold all detours.
struct BeginCrossings {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    VertexRepair& r = s.vertexRepair[v];
    memset(static_cast<void*>(&r), 0, sizeof r);
    r.unit = longestDetour(s, v) / static_cast<Real>(FoundWay::kDetourUnits);
  }
};

/// found(feature) for the features that an owner may meet, whatever detours they take, for number `lane` of
/// `lanes`.
template <class Found>
RUBBLE_HD void searchNear(const SolverData& s, int owner, Found&& found, int lane = 0, int lanes = 1) {
  if (!ownsFeatures(s, owner)) return;
  int own[2];
  const int corners = ownerCorners(s, owner, own);
  const SweptBox box = sweptBox<FoundWay>(s, own, corners);
  const auto look = [&](int i) {
    if ((corners == 2 && s.vertices + i <= owner) || !mayMeet(s, own, corners, s.feature[i])) return;
    const NearParts p = nearParts(s, owner, kFeatureNode + i);
    Vec3 mean{0, 0, 0};
    for (const int v : p.v) mean += Real(.25) * foundWay(s, v);
    Real reach[2] = {0, 0};
    for (int k = 0; k < 4; ++k) {
      Real& most = reach[k < p.sideA ? 0 : 1];
      most = max(most, length(foundWay(s, p.v[k]) - mean) + longestDetour(s, p.v[k]));
    }
    const Real distance = length(p.gap);
    if (distance > Real(0) && distance - kLeastSurfaceGap * bothRadii(s, p) <= reach[0] + reach[1]) found(i);
  };
  if (corners == 1) {
    seekFeatures(s, FeatureKind::Triangle, box, look, lane, lanes);
  } else {
    seekFeatures(s, FeatureKind::BareEdge, box, look, lane, lanes);
    seekFeatures(s, FeatureKind::Edge, box, look, lane, lanes);
  }
}

struct FindNear {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    int count = 0;
    int* const slots = s.pointPairSlot + owner * kPointPairSlots;
    searchNear(s, owner, [&](int i) {
      if (count < kPointPairSlots) slots[count] = i;
      ++count;
    });
    s.nearCount[owner] = count;
  }
};
struct WriteNear {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    if (owner == 0) s.counters->crossingWork = max(s.vertices, s.counters->nearFeatures);
    int n = s.nearOffset[owner];
    const int count = s.nearOffset[owner + 1] - n;
    if (count > 0) {
      int own[2];
      ownerCorners(s, owner, own);
      VertexRepair& object = s.vertexRepair[s.vertexParams[own[0]].first];
      atomicCount(&object.owners, 1), atomicCount(&object.activePairs, count);
    }
    const auto write = [&](int feature) { s.nearFeature[n++] = {owner, feature, 0}; };
    if (count > kPointPairSlots) {
      searchNear(s, owner, write);
      return;
    }
    for (int k = 0; k < count; ++k) write(s.pointPairSlot[owner * kPointPairSlots + k]);
  }
};

/// The meeting of an owner with a feature, if there is one. `clear`: how much further apart they are to stay
/// [m].
RUBBLE_HD inline bool findCrossing(const SolverData& s, const NearFeature& near, NearParts& p,
                                   FeatureMeeting& m, Real& clear) {
  p = nearParts(s, near.owner, kFeatureNode + near.feature);
  const Real distance = length(p.gap),
             keep = min(kLeastSurfaceGap * bothRadii(s, p), kLeastSurfaceShare * distance);
  Vec3 move[4];
  for (int k = 0; k < 4; ++k) move[k] = foundWay(s, p.v[k]);
  m = firstMeeting(p.x, move, p.sideA, keep);
  clear = kClearance * (distance - keep);
  return m.meets;
}

/// Counts the meetings of each vertex.
struct CountCrossings {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    NearParts p;
    FeatureMeeting m;
    Real clear;
    const bool meets = findCrossing(s, s.nearFeature[i], p, m, clear);
    for (const int v : p.v) atomicSet(&s.vertexRepair[v].isActive, 1);
    if (!meets) return;
    s.nearFeature[i].meets = 1;
    atomicCount(&s.counters->crossings, 1);
    for (const int v : p.v) atomicCount(&s.vertexRepair[v].hits, 1);
  }
};

RUBBLE_HD inline void deflect(const SolverData& s, const NearParts& p, const FeatureMeeting& m, Real clear) {
  Real rate = 0, mobility = 0;
  int share = 1;
  for (int k = 0; k < 4; ++k) {
    const VertexParams& own = s.vertexParams[p.v[k]];
    rate += m.c[k] * dot(m.n, foundWay(s, p.v[k]));
    if (own.kind == VertexKind::Dynamic) mobility += m.c[k] * m.c[k] / own.mass;
    // changes of all meetings of a vertex add up
    share = max(share, s.vertexRepair[p.v[k]].before);
  }
  const Real change = ((Real(1) - m.time) * max(Real(0), -rate) + clear) /
                      (mobility * static_cast<Real>(share));
  if (!isFinite(change)) return;
  for (int k = 0; k < 4; ++k) {
    const VertexParams& own = s.vertexParams[p.v[k]];
    if (own.kind != VertexKind::Dynamic) continue;
    VertexRepair& r = s.vertexRepair[p.v[k]];
    const Vec3 move = (change * m.c[k] / own.mass) * m.n;
    for (int i = 0; i < 3; ++i) {
      constexpr Real kMost = static_cast<Real>(FoundWay::kDetourUnits);
      const int units = static_cast<int>(std::floor(clamp(move[i] / r.unit, -kMost, kMost) + Real(.5)));
      if (units != 0) atomicCount(&r.shift[i], units);
    }
  }
}

/// Takes the changes that the last round found. Called as often as there is crossingWork.
struct TakeWays {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (v >= s.vertices) return;
    VertexRepair& r = s.vertexRepair[v];
    Vec3 move{0, 0, 0};
    const bool stays = mustStay(s, v);
    if (r.hold != 0 || (stays && s.vertexMoved[v] != Vec3{0, 0, 0})) {
      if (r.held++ == 0) atomicCount(&s.counters->held, 1);
      move = (r.held < kMostHalvings && !stays ? Real(-.5) : Real(-1)) * s.vertexMoved[v];
    } else if (r.shift[0] != 0 || r.shift[1] != 0 || r.shift[2] != 0) {
      if (r.detour == Vec3{0, 0, 0}) atomicCount(&s.counters->deflected, 1);
      Vec3 wanted = r.detour + r.unit * Vec3{static_cast<Real>(r.shift[0]), static_cast<Real>(r.shift[1]),
                                             static_cast<Real>(r.shift[2])};
      // boxes of the grid hold no longer ones; a step that is cut to this is found again, and dealt with by
      // cutting ways
      const Real most = r.unit * static_cast<Real>(FoundWay::kDetourUnits), size = length(wanted);
      if (size > most) wanted = wanted * (most / size);
      move = wanted - r.detour;
      r.detour = wanted;
    }
    r.changed = move != Vec3{0, 0, 0};
    s.vertexMoved[v] += move;
    s.vertexPlace[v] += move;
    r.before = r.hits;
    r.hits = r.hold = r.shift[0] = r.shift[1] = r.shift[2] = 0;
  }
  RUBBLE_HD static bool mustStay(const SolverData& s, int v) {
    return s.vertexRepair[s.vertexParams[v].first].stays != 0 ||
           (s.vertexRepair[v].isActive != 0 &&
            s.counters->crossingRounds >= deflections(s, v) + kCuts + kStays);
  }
};

/// Finds what is left, and how to change it. Pairs that did not meet and whose ways are as they were are not
/// looked at again.
struct ProposeWays {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (i >= s.counters->nearFeatures) return;
    NearFeature& near = s.nearFeature[i];
    if (near.meets == 0 && !changed(s, near)) return;
    NearParts p;
    FeatureMeeting m;
    Real clear;
    near.meets = findCrossing(s, near, p, m, clear);
    if (near.meets == 0) return;
    atomicCount(&s.counters->crossings, 1);
    for (const int v : p.v) atomicCount(&s.vertexRepair[v].hits, 1);
    int most = kDeflections;
    for (const int v : p.v) most = min(most, deflections(s, v));
    const int rounds = s.counters->crossingRounds - most;
    if (rounds <= 0) return deflect(s, p, m, clear);
    for (const int v : p.v)
      if (rounds > kCuts)
        atomicSet(&s.vertexRepair[s.vertexParams[v].first].stays, 1);
      else if (isDynamicVertex(s, v))
        atomicRaise(&s.vertexRepair[v].hold, 1);
  }

 private:
  RUBBLE_HD static bool changed(const SolverData& s, const NearFeature& near) {
    int own[2];
    const int corners = ownerCorners(s, near.owner, own);
    const SurfaceFeature& f = s.feature[near.feature];
    int any = 0;
    for (int k = 0; k < corners; ++k) any |= s.vertexRepair[own[k]].changed;
    for (int k = 0; k < cornersOf(f); ++k) any |= s.vertexRepair[f.v[k]].changed;
    return any != 0;
  }
};

}  // namespace rubble::RUBBLE_CORE

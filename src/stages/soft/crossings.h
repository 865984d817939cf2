#pragma once
/// Continuous collision detection between surfaces: surfaces of deformable objects that do not cross at x^t
/// do not cross at the end of the step.
///
/// Rows keep surfaces apart by their thickness, as far as a few iterations converge. This pass checks what
/// remains: the straight motion of every vertex from x^t to its solved position, for vertex-triangle and
/// edge-edge impacts. Surfaces that start apart, neighbors that share a vertex included, cannot cross without
/// such an impact.
///
/// Where two features would come nearer than a share of their distance, the approach of their nearest points
/// ends at that time. The motions of their vertices change by an inelastic impulse along the line between the
/// points, shared by mass. All such pairs are processed at once, in several rounds. After kDeflections rounds
/// the vertices of the remaining pairs halve their motion repeatedly and finally stay at x^t, which is free
/// of crossings. If that causes further impacts, as in a tangle, whole objects stay, and finally everything
/// near another feature. The number of rounds is bounded.
///
/// Other motions do not change, however long they are and however near the features lie. The velocity follows
/// from the final position of a vertex.
#include "stages/soft/feature_contacts.h"

namespace rubble::RUBBLE_CORE {

/// In a step two features come no nearer than this share of their radii [1], or ...
inline constexpr Real kLeastSurfaceGap = Real(.25);
/// ... this share of their distance, if that is less [1].
inline constexpr Real kLeastSurfaceShare = Real(.8);
/// Clearance added at an impact, over the distance by which the features may approach [1]. Without it the
/// same impact would be found again.
inline constexpr Real kClearance = Real(.2);
/// Largest number of rounds that deflect motions. Also the number of pairs per vertex and edge of an object
/// that may be processed in all rounds: a tangle with more pairs gets fewer rounds.
inline constexpr int kDeflections = 20, kDeflectedPairs = 32 * kDeflections;
/// Halvings of a motion after which it is zero, and rounds for them. Stopping one vertex may cause impacts of
/// others.
inline constexpr int kMostHalvings = 3, kCuts = 8;
/// Rounds in which whole objects stay, before every vertex near a feature does.
inline constexpr int kStays = 4;
/// Largest number of rounds in a step. Vertices that are unresolved then do not move, and vertices at x^t do
/// not cross.
inline constexpr int kMostCrossingRounds = kDeflections + kCuts + kStays + 1;

/// Number of rounds in this step that deflect the object of a vertex.
RUBBLE_HD inline int deflections(const SolverData& s, int v) {
  const VertexRepair& object = s.vertexRepair[s.vertexParams[v].first];
  const Real most = static_cast<Real>(kDeflections),
             share = static_cast<Real>(object.owners) / static_cast<Real>(max(object.activePairs, 1));
  return static_cast<int>(clamp(kDeflectedPairs * share, Real(1), most));
}

/// Resets the state of a vertex. Runs before the grid is filled, because the boxes include all detours.
struct BeginCrossings {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    VertexRepair& r = s.vertexRepair[v];
    memset(static_cast<void*>(&r), 0, sizeof r);
    r.unit = longestDetour(s, v) / static_cast<Real>(FoundWay::kDetourUnits);
  }
};

/// found(feature) for the features that an owner may meet within their longest detours; share of worker
/// `lane` of `lanes`.
template <class Found>
RUBBLE_HD void searchNear(const SolverData& s, int owner, Found&& found, int lane = 0, int lanes = 1) {
  if (!seeksFeatures(s, owner)) return;
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
    seekFeatures(s, s.worldOfPoint(own[0]), FeatureKind::Triangle, box, look, lane, lanes);
  } else {
    seekFeatures(s, s.worldOfPoint(own[0]), FeatureKind::BareEdge, box, look, lane, lanes);
    seekFeatures(s, s.worldOfPoint(own[0]), FeatureKind::Edge, box, look, lane, lanes);
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

/// The impact of an owner and a feature, if there is one. `clear`: additional clearance [m].
RUBBLE_HD inline bool findCrossing(const SolverData& s, const NearFeature& near, NearParts& p,
                                   FeatureImpact& m, Real& clear) {
  p = nearParts(s, near.owner, kFeatureNode + near.feature);
  const Real distance = length(p.gap),
             keep = min(kLeastSurfaceGap * bothRadii(s, p), kLeastSurfaceShare * distance);
  Vec3 move[4];
  for (int k = 0; k < 4; ++k) move[k] = foundWay(s, p.v[k]);
  m = firstImpact(p.x, move, p.sideA, keep);
  clear = kClearance * (distance - keep);
  return m.meets;
}

/// Counts an impact, and notes that the world of a vertex has one in this round.
RUBBLE_HD inline void countCrossing(const SolverData& s, int v) {
  atomicCount(&s.counters->crossings, 1);
  atomicRaise(&s.crossingRound[s.worldOfPoint(v)], s.counters->crossingRounds + 1);
}
/// Had the world of a vertex an impact in the last round? Rounds go on as long as any world has one.
RUBBLE_HD inline bool hasCrossings(const SolverData& s, int v) {
  return s.worlds == 1 || s.crossingRound[s.worldOfPoint(v)] > s.counters->crossingRounds;
}

/// Counts the impacts of each vertex.
struct CountCrossings {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    NearParts p;
    FeatureImpact m;
    Real clear;
    const bool meets = findCrossing(s, s.nearFeature[i], p, m, clear);
    for (const int v : p.v) atomicSet(&s.vertexRepair[v].isActive, 1);
    if (!meets) return;
    s.nearFeature[i].meets = 1;
    countCrossing(s, p.v[0]);
    for (const int v : p.v) atomicCount(&s.vertexRepair[v].hits, 1);
  }
};

RUBBLE_HD inline void deflect(const SolverData& s, const NearParts& p, const FeatureImpact& m, Real clear) {
  Real rate = 0, mobility = 0;
  int share = 1;
  for (int k = 0; k < 4; ++k) {
    const VertexParams& own = s.vertexParams[p.v[k]];
    rate += m.c[k] * dot(m.n, foundWay(s, p.v[k]));
    if (own.kind == VertexKind::Dynamic) mobility += m.c[k] * m.c[k] / own.mass;
    // the changes of all impacts of a vertex add up
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

/// Applies the changes of the last round. Runs over crossingWork elements.
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
      // The boxes of the grid hold no longer detour. A detour that is clipped here is found again and
      // resolved by halving the motion.
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
           (s.vertexRepair[v].isActive != 0 && hasCrossings(s, v) &&
            s.counters->crossingRounds >= deflections(s, v) + kCuts + kStays);
  }
};

/// Finds the remaining impacts and their changes. Pairs without an impact whose motions did not change are
/// skipped.
struct ProposeWays {
  static constexpr const char* kStage = "crossings";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (i >= s.counters->nearFeatures) return;
    NearFeature& near = s.nearFeature[i];
    if (near.meets == 0 && !changed(s, near)) return;
    NearParts p;
    FeatureImpact m;
    Real clear;
    near.meets = findCrossing(s, near, p, m, clear);
    if (near.meets == 0) return;
    countCrossing(s, p.v[0]);
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

#pragma once
/// Surfaces of deformable objects that do not cross in a step do not cross at its end.
///
/// Rows keep surfaces apart by their thickness, as well as a few iterations can. What they leave is checked here: the way of every vertex from
/// x^t to where the iterations have put it, a straight line, for meetings of vertices with triangles and of edges with edges. Surfaces that
/// start apart can not cross without such a meeting (neighbours that share a corner can not either). Where two parts would come nearer than a
/// part of their distance, the approach of their nearest points ends at that time: opposite changes of the ways of their corners, shared out by
/// mass along the line between the points, as of an impact without rebound. All such pairs at once, again and again; after kDeflections rounds
/// the corners of those that are left go half the way, then a quarter, and at last stay where they are, which is free of crossings.
///
/// Nothing else bounds a motion: ways on which no parts meet are not touched, however long they are and however near the parts lie. The
/// velocity follows from where a vertex ends, as everywhere.
#include "stages/feature_contacts.h"

namespace rubble::RUBBLE_CORE {

/// In a step two parts come no nearer than this share of their radii [1], or ...
inline constexpr Real kLeastSurfaceGap = Real(.25);
/// ... this share of their distance, if that is less [1].
inline constexpr Real kLeastSurfaceShare = Real(.8);
/// What a change adds to the distance at a meeting, in distances that the parts may come nearer by: else it would be met again [1].
inline constexpr Real kClearance = Real(.2);
/// Rounds in which ways are changed; in those that follow they are cut.
inline constexpr int kDeflections = 40;
/// Halvings of a way after which nothing of it is left.
inline constexpr int kMostHalvings = 5;

/// Clears what the step before has left. Before the grid is filled: boxes hold all detours.
struct BeginCrossings {
  static constexpr const char* kName = "crossings";
  RUBBLE_HD void operator()(const View& s, int v) const {
    VertexRepair& r = s.vertexRepair[v];
    memset(static_cast<void*>(&r), 0, sizeof r);
    r.unit = longestDetour(s, v) / static_cast<Real>(FoundWay::kDetourUnits);
    if (v == 0) s.counters->owners = s.owners();
  }
};

/// The meeting of an owner with a feature, if there is one.
RUBBLE_HD inline bool findCrossing(const View& s, int owner, int feature, NearParts& p, FeatureMeeting& m, Real& clear) {
  p = nearParts(s, owner, kFeatureNode + feature);
  const Real distance = length(p.gap), keep = min(kLeastSurfaceGap * bothRadii(s, p), kLeastSurfaceShare * distance);
  // what crosses already can not be told apart by distances
  if (!(distance > Real(0))) return false;
  Vec3 move[4];
  for (int k = 0; k < 4; ++k) move[k] = s.vertexMoved[p.v[k]];
  m = firstMeeting(p.x, move, p.sideA, keep);
  clear = kClearance * (distance - keep);
  return m.meets;
}

RUBBLE_HD inline void deflect(const View& s, const NearParts& p, const FeatureMeeting& m, Real clear) {
  Real rate = 0, mobility = 0;
  int share = 1;
  for (int k = 0; k < 4; ++k) {
    const VertexParams& own = s.vertexParams[p.v[k]];
    rate += m.c[k] * dot(m.n, s.vertexMoved[p.v[k]]);
    if (own.kind == VertexKind::Dynamic) mobility += m.c[k] * m.c[k] / own.mass;
    // changes of all meetings of a vertex add up
    share = max(share, s.vertexRepair[p.v[k]].before);
  }
  const Real change = ((Real(1) - m.time) * max(Real(0), -rate) + clear) / (mobility * static_cast<Real>(share));
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

/// visit(parts, meeting, clearance) for every meeting of an owner's features with others.
template <class Visit>
RUBBLE_HD void visitCrossings(const View& s, int owner, Visit&& visit) {
  if (!ownsFeatures(s, owner)) return;
  int own[2];
  const int corners = ownerCorners(s, owner, own);
  const SweptBox box = sweptBox<FoundWay>(s, own, corners);
  const auto look = [&](int i) {
    if ((corners == 2 && s.vertices + i <= owner) || !mayMeet(s, own, corners, s.feature[i])) return;
    NearParts p;
    FeatureMeeting m;
    Real clear;
    if (findCrossing(s, owner, i, p, m, clear)) visit(p, m, clear);
  };
  if (corners == 1) {
    seekFeatures(s, FeatureKind::Triangle, box, look);
  } else {
    seekFeatures(s, FeatureKind::BareEdge, box, look);
    seekFeatures(s, FeatureKind::Edge, box, look);
  }
}

/// Counts the meetings of each vertex.
struct CountCrossings {
  static constexpr const char* kName = "crossings";
  RUBBLE_HD void operator()(const View& s, int owner) const {
    visitCrossings(s, owner, [&](const NearParts& p, const FeatureMeeting&, Real) {
      atomicCount(&s.counters->crossings, 1);
      for (const int v : p.v) atomicCount(&s.vertexRepair[v].hits, 1);
    });
  }
};

/// Takes the changes that the last round found. Every owner is called; those that are edges do nothing.
struct TakeWays {
  static constexpr const char* kName = "crossings";
  RUBBLE_HD void operator()(const View& s, int v) const {
    if (v >= s.vertices) return;
    VertexRepair& r = s.vertexRepair[v];
    Vec3 move{0, 0, 0};
    if (r.hold != 0) {
      if (r.held++ == 0) atomicCount(&s.counters->held, 1);
      move = (r.held < kMostHalvings ? Real(-.5) : Real(-1)) * s.vertexMoved[v];
    } else if (r.shift[0] != 0 || r.shift[1] != 0 || r.shift[2] != 0) {
      if (r.detour == Vec3{0, 0, 0}) atomicCount(&s.counters->deflected, 1);
      Vec3 wanted = r.detour + r.unit * Vec3{static_cast<Real>(r.shift[0]), static_cast<Real>(r.shift[1]), static_cast<Real>(r.shift[2])};
      // boxes of the grid hold no longer ones; a step that is cut to this is found again, and dealt with by cutting ways
      const Real most = r.unit * static_cast<Real>(FoundWay::kDetourUnits), size = length(wanted);
      if (size > most) wanted = wanted * (most / size);
      move = wanted - r.detour;
      r.detour = wanted;
    }
    s.vertexMoved[v] += move;
    s.vertexPlace[v] += move;
    r.before = r.hits;
    r.hits = r.hold = r.shift[0] = r.shift[1] = r.shift[2] = 0;
  }
};

/// Finds what is left, and how to change it.
struct ProposeWays {
  static constexpr const char* kName = "crossings";
  RUBBLE_HD void operator()(const View& s, int owner) const {
    const bool deflects = s.counters->crossingRounds <= kDeflections;
    visitCrossings(s, owner, [&](const NearParts& p, const FeatureMeeting& m, Real clear) {
      atomicCount(&s.counters->crossings, 1);
      for (const int v : p.v) {
        atomicCount(&s.vertexRepair[v].hits, 1);
        if (!deflects && isDynamicVertex(s, v)) atomicRaise(&s.vertexRepair[v].hold, 1);
      }
      if (deflects) deflect(s, p, m, clear);
    });
  }
};

}  // namespace rubble::RUBBLE_CORE

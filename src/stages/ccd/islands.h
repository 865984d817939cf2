#pragma once
/// CCD islands: bodies connected by rigid joints. Stopping one of them alone would open its joints by the
/// rest of its motion. The whole island therefore stops at the earliest time of impact of its bodies, and
/// all of them keep their velocities.
#include "stages/ccd/fast_bodies.h"
#include "stages/coarse/aggregates.h"

namespace rubble::RUBBLE_CORE {

/// Bodies of a CCD island share a root, as those of an aggregate do.
struct StartCcdIslands {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->fastBodies > 0) s.root[i] = i;
  }
};
template <class F> struct JoinCcdIslands {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (s.counters->fastBodies == 0 || !spec.isRigid || !active<F>(s, i)) return;
    if (!isDynamic(s, spec.a) || !isDynamic(s, spec.b)) return;
    unite(s.root, spec.a, spec.b);
    atomicRaise(&s.ccdPair[spec.a], kStopsWithIsland);
    atomicRaise(&s.ccdPair[spec.b], kStopsWithIsland);
  }
};
/// Value of ccdRound, in place of a round: the body is one of those that stop its CCD island.
inline constexpr int kOwnImpact = kCcdRounds + 1;

/// Passes the earliest stop to the root.
struct RaiseIslandShares {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->fastBodies == 0 || s.ccdPair[i] != kStopsWithIsland || s.ccdShareBits[i] == 0) return;
    atomicRaise(&s.ccdSeenBits[findRoot(s.root, i)], s.ccdShareBits[i]);
  }
};
struct StopCcdIslands {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->fastBodies == 0 || s.ccdPair[i] != kStopsWithIsland) return;
    const int root = findRoot(s.root, i), bits = s.ccdSeenBits[root];
    if (bits == 0) return;
    if (root == i) atomicCount(&s.counters->stopped, 1);
    s.ccdRound[i] = s.ccdShareBits[i] == bits ? kOwnImpact : 0;
    s.ccdShareBits[i] = bits;
    s.ccdMotion[i] = stoppedMotion(s, i, carrierOf(s, i));
  }
};

/// Has the body itself met what it stops at?
RUBBLE_HD inline bool hasOwnImpact(const SolverData& s, int i) {
  return s.ccdShareBits[i] != 0 && (s.ccdPair[i] != kStopsWithIsland || s.ccdRound[i] == kOwnImpact);
}

}  // namespace rubble::RUBBLE_CORE

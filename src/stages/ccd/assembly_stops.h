#pragma once
/// CCD islands (assemblies): bodies connected by rigid joints. Stopping one of them alone would open its
/// joints by the rest of its motion. The whole island therefore stops at the earliest time of impact of its
/// bodies, and all of them keep their velocities.
#include "stages/coarse/aggregates.h"

namespace rubble::RUBBLE_CORE {

/// Bodies of a CCD island share a root, as those of an aggregate do.
struct StartAssemblies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast > 0) s.root[i] = i;
  }
};
template <class F> struct JoinAssemblies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (s.counters->anyFast == 0 || !spec.isRigid || !active<F>(s, i)) return;
    if (!isDynamic(s, spec.a) || !isDynamic(s, spec.b)) return;
    unite(s.root, spec.a, spec.b);
    s.stopPair[spec.a] = s.stopPair[spec.b] = kStopsTogether;
  }
};
/// Value of stopRound, in place of a round: the body is one of those that stop its CCD island.
inline constexpr int kHasMet = kStopRounds;

/// Passes the earliest stop to the root.
struct RaiseStops {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopPair[i] != kStopsTogether || s.stopBits[i] == 0) return;
    atomicRaise(&s.stopSeen[findRoot(s.root, i)], s.stopBits[i]);
  }
};
struct StopAssemblies {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopPair[i] != kStopsTogether) return;
    const int leader = findRoot(s.root, i), bits = s.stopSeen[leader];
    if (bits == 0) return;
    if (leader == i) atomicCount(&s.counters->stopped, 1);
    s.stopRound[i] = s.stopBits[i] == bits ? kHasMet : 0;
    s.stopBits[i] = bits;
    const Real done = Real(1) - fromFloatBits(bits);
    s.ccdMotion[i] = {done * s.dx[i].dp, 0, done * s.dx[i].dw, 0};
  }
};

/// Has the body itself met what it stops at?
RUBBLE_HD inline bool hasMet(const SolverData& s, int i) {
  return s.stopBits[i] != 0 && (s.stopPair[i] != kStopsTogether || s.stopRound[i] == kHasMet);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Stops of bodies that joints hold together. One that stopped alone would tear its joints open by the rest
/// of its way; so an assembly stops as one, where the first of its bodies meets something, and all of them
/// keep their velocities.
#include "stages/coarse/aggregates.h"

namespace rubble::RUBBLE_CORE {

/// Bodies of an assembly have one leader, as those of a group.
struct StartAssemblies {
  static constexpr const char* kStage = "stops";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast > 0) s.root[i] = i;
  }
};
template <class F> struct JoinAssemblies {
  static constexpr const char* kStage = "stops";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (s.counters->anyFast == 0 || !spec.isRigid || !active<F>(s, i)) return;
    if (!isDynamic(s, spec.a) || !isDynamic(s, spec.b)) return;
    unite(s.root, spec.a, spec.b);
    s.stopPair[spec.a] = s.stopPair[spec.b] = kStopsTogether;
  }
};
/// In place of the round in which news came: the body is one of those at which its assembly stops.
inline constexpr int kHasMet = kStopRounds;

/// The leader learns of the first stop.
struct RaiseStops {
  static constexpr const char* kStage = "stops";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopPair[i] != kStopsTogether || s.stopBits[i] == 0) return;
    atomicRaise(&s.stopSeen[findRoot(s.root, i)], s.stopBits[i]);
  }
};
struct StopAssemblies {
  static constexpr const char* kStage = "stops";
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

/// Has a body met what it stops at, itself?
RUBBLE_HD inline bool hasMet(const SolverData& s, int i) {
  return s.stopBits[i] != 0 && (s.stopPair[i] != kStopsTogether || s.stopRound[i] == kHasMet);
}

}  // namespace rubble::RUBBLE_CORE

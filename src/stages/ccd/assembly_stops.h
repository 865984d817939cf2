#pragma once
/// Stops of bodies that joints hold together. One that stopped alone would tear its joints open by the rest of its way; so an assembly stops as
/// one, where the first of its bodies meets something, and all of them keep their velocities.
#include "stages/coarse/groups.h"

namespace rubble::RUBBLE_CORE {

/// Bodies of an assembly have one leader, as those of a group.
struct StartAssemblies {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->anyFast > 0) s.leader[i] = i;
  }
};
template <class F>
struct JoinAssemblies {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (s.counters->anyFast == 0 || !spec.holds || !active<F>(s, i)) return;
    if (!isDynamic(s, spec.a) || !isDynamic(s, spec.b)) return;
    unite(s.leader, spec.a, spec.b);
    s.stopPair[spec.a] = s.stopPair[spec.b] = kStopsTogether;
  }
};
/// In place of the round in which news came: the body is one of those at which its assembly stops.
inline constexpr int kHasMet = kStopRounds;

/// The leader learns of the first stop.
struct RaiseStops {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopPair[i] != kStopsTogether || s.stopBits[i] == 0) return;
    atomicRaise(&s.stopSeen[findLeader(s.leader, i)], s.stopBits[i]);
  }
};
struct StopAssemblies {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->anyFast == 0 || s.stopPair[i] != kStopsTogether) return;
    const int leader = findLeader(s.leader, i), bits = s.stopSeen[leader];
    if (bits == 0) return;
    if (leader == i) atomicCount(&s.counters->stopped, 1);
    s.stopRound[i] = s.stopBits[i] == bits ? kHasMet : 0;
    s.stopBits[i] = bits;
    const Real done = Real(1) - fromFloatBits(bits);
    s.stopped[i] = {done * s.moved[i].dp, 0, done * s.moved[i].dw, 0};
  }
};

/// Has a body met what it stops at, itself?
RUBBLE_HD inline bool hasMet(const View& s, int i) {
  return s.stopBits[i] != 0 && (s.stopPair[i] != kStopsTogether || s.stopRound[i] == kHasMet);
}

}  // namespace rubble::RUBBLE_CORE

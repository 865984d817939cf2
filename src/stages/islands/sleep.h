#pragma once
/// Sleeping. An island is a set of dynamic bodies connected by broad-phase pairs and joints. It is larger
/// than a set of touching bodies, so no awake body is ever near a sleeping one. An island sleeps when all its
/// bodies have been still for sleepDelay. Sleeping islands are left out of rows, aggregates, colors and
/// iterations; their manifolds are kept with their multipliers. An island wakes as a whole, before rows are
/// built, if a moving body comes near, if one of its bodies is edited or pushed, or if its pairs change.
#include "stages/bodies/incidence.h"

namespace rubble::RUBBLE_CORE {

/// Wakes islands near a moving body, or with a new pair.
struct WakeByPairs {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const bool owner = s.asleep[p.owner] != 0, other = s.asleep[p.other] != 0;
    if ((!owner && !other) || isSensor(s, p.owner) || isSensor(s, p.other)) return;
    if (!moves(s, p.owner) && !moves(s, p.other) && findOldPair(s, i) >= 0) return;
    if (owner) atomicRaise(&s.islandFlag[s.asleep[p.owner] - 1], 1);
    if (other) atomicRaise(&s.islandFlag[s.asleep[p.other] - 1], 1);
  }
};

template <class F> struct WakeByJoints {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& joint = s.specsOf<F>()[i];
    if (!joint.alive || s.jointsOf<F>()[i].broken) return;
    const auto wake = [&](int body, int other) {
      if (body == kWorldBody || other == kWorldBody || s.asleep[body] == 0) return;
      if (moves(s, other)) atomicRaise(&s.islandFlag[s.asleep[body] - 1], 1);
    };
    for (int side = 0; side < kSides<F>; ++side)
      for (int k = 0; k < kSides<F>; ++k)
        if (k != side) wake(bodyOf(joint, side), bodyOf(joint, k));
  }
};

/// Wakes bodies on which a force acts or that have a velocity, and all bodies if wakeAll is set.
struct WakeByForces {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.asleep[i] == 0) return;
    const Vec3 none{0, 0, 0};
    if (s.stepOf(i).wakeAll || s.force[i] != none || s.torque[i] != none || s.velocity[i] != none ||
        s.angularVelocity[i] != none)
      atomicRaise(&s.islandFlag[s.asleep[i] - 1], 1);
  }
};

struct WakeBodies {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.asleep[i] == 0 || s.islandFlag[s.asleep[i] - 1] == 0) return;
    s.asleep[i] = 0;
    s.stillTime[i] = 0;
    // PredictBodies skipped the sleeping body
    PredictBodies{}(s, i);
  }
};

/// Every body starts as its own island. Updates how long it has been still.
struct StartIslands {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    s.island[i] = i;
    if (!isDynamic(s, i)) return;
    const BodyParams& p = s.params[i];
    const Real speed = length(s.velocity[i]) + length(s.angularVelocity[i]) * p.radius;
    const bool still = speed < stillSpeed(s.stepOf(i), 2 * p.radius);
    s.stillTime[i] = still ? s.stillTime[i] + s.step->dt : Real(0);
  }
};

struct JoinIslandsByPairs {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    if (isDynamic(s, p.owner) && isDynamic(s, p.other)) unite(s.island, p.owner, p.other);
  }
};
template <class F> struct JoinIslandsByJoints {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& joint = s.specsOf<F>()[i];
    if (!active<F>(s, i)) return;
    for (int side = 1; side < kSides<F>; ++side)
      for (int k = 0; k < side; ++k)
        if (isDynamic(s, bodyOf(joint, k)) && isDynamic(s, bodyOf(joint, side)))
          unite(s.island, bodyOf(joint, k), bodyOf(joint, side));
  }
};

/// Flags islands that stay awake: a body has not been still long enough, or a moving kinematic body is near.
struct FindRestless {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (isDynamic(s, i) && s.stillTime[i] < s.step->sleepDelay)
      atomicRaise(&s.islandFlag[findRoot(s.island, i)], 1);
  }
};
struct FindMovedIslands {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = s.pair[i];
    const auto keepAwake = [&](int body, int other) {
      if (isDynamic(s, body) && s.params[other].kind == BodyKind::Kinematic && moves(s, other))
        atomicRaise(&s.islandFlag[findRoot(s.island, body)], 1);
    };
    keepAwake(p.owner, p.other), keepAwake(p.other, p.owner);
  }
};

struct FallAsleep {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.params[i].kind != BodyKind::Dynamic) return;
    if (s.asleep[i] == 0) {
      const int island = findRoot(s.island, i);
      if (s.islandFlag[island] != 0) return;
      s.asleep[i] = island + 1;
      s.velocity[i] = s.angularVelocity[i] = s.previousVelocity[i] = {0, 0, 0};
    }
    atomicCount(&s.counters->asleep, 1);
  }
};

}  // namespace rubble::RUBBLE_CORE

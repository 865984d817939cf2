#pragma once
/// The momenta of islands that nothing holds.
///
/// Sweeps leave the two bodies of a row at poses of which one is older, and turn them by angles that rows
/// know to first order: what one body is given is not quite what is taken from the other. An island, bodies
/// that rows of this step connect, of which none acts on anything that does not move by its forces, has to
/// have the momenta that it would have had without rows,
///
///   sum m (v - v_y) = 0        sum (p x m v + S) - (p^t x m v_y + S_y) = 0
///
/// with v_y, S_y velocity and spin momentum at the inertial target. What is left of the two sums is taken
/// from the velocities as a rigid motion of the island about its centre of mass. That is the least change in
/// the metric of its masses, and changes no relative velocity of points that touch.
///
/// If the island then had more kinetic energy than at its targets, and where it has joints than before the
/// repair too, the motion of its bodies against that of a rigid whole is reduced to what is left for it.
/// Such a motion has no momenta, and no joint sees it reduced.
///
/// Bodies of the coarsest group (aggregates.h) are connected already, so few rows are left to unite. Sums are
/// of whole numbers, so that their order does not matter (IslandSums).
#include <limits>

#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Forest of the bodies that rows connect: that of the coarsest groups, or one of its own.
RUBBLE_HD inline int* islandForest(const SolverData& s) { return s.root + atLevel(s, kCoarseLevels - 1, 0); }

struct StartIslandForest {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { islandForest(s)[i] = i; }
};

/// What rows do with an island, as bits.
inline constexpr int kHeld = 1;    ///< they act on something that is no body of the forest
inline constexpr int kJoined = 2;  ///< there are joints, which may have springs and drives

/// Does a joint act on something that is no body of the forest?
template <class F> RUBBLE_HD bool isJointHeld(const SolverData& s, std::uint32_t code) {
  if constexpr (F::kGrounded) return true;
  if constexpr (isCarried<F>()) {
    const JointSpec<F>& spec = s.specsOf<F>()[jointIndex<F>(code)];
    for (int side = 0; side < kSides<F>; ++side)
      if (!isDynamic(s, bodyOf(spec, side))) return true;
  }
  return false;
}
RUBBLE_HD inline int bondsOf(const SolverData& s, const Incidence& incidence) {
  const int type = constraintType(incidence.code);
  if (incidence.other < 0 || type > JointTypes::kSize) return kHeld;
  if (type == kContactType) return 0;
  bool held = false;
  forEachType(JointTypes{}, [&]<class F>() {
    if (type == typeIndex<F>(JointTypes{}) + 1) held = isJointHeld<F>(s, incidence.code);
  });
  return held ? kHeld : kJoined;
}

/// Unites bodies that rows connect beyond the coarsest groups, and finds those that something holds.
struct JoinMomentumIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isDynamic(s, i)) {
      s.islandBonds[i] = kHeld;
      return;
    }
    s.islandMassLength[i] = floatBits(s.params[i].mass * 2 * s.params[i].radius);
    int bonds = s.target[i].locks != 0 ? kHeld : 0;
    for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) {
      const Incidence incidence = s.incidence[k];
      bonds |= bondsOf(s, incidence);
      if (incidence.depth == kCoarseLevels && incidence.other > i && incidence.other < s.bodies)
        unite(islandForest(s), i, incidence.other);
    }
    s.islandBonds[i] = bonds;
  }
};

/// The island of each body, and what rows do with it.
struct FindMomentumIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int root = findRoot(islandForest(s), i);
    s.rowIsland[i] = root;
    if (root == i || !isDynamic(s, i)) return;
    const int own = s.islandBonds[i];
    if (own != 0) atomicSet(&s.islandBonds[root], own);
    if (const int heavy = s.islandMassLength[i]; heavy > s.islandMassLength[root])
      atomicRaise(&s.islandMassLength[root], heavy);
  }
};

/// Islands that nothing holds: their leaders have a place, all others -1.
struct NumberFreeIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (isDynamic(s, i)) s.islandMassLength[i] = s.islandMassLength[s.rowIsland[i]];
    const bool leads = s.rowIsland[i] == i && (s.islandBonds[i] & kHeld) == 0;
    const bool isFree = leads && s.incidenceOffset[i + 1] > s.incidenceOffset[i];
    s.islandSlot[i] = isFree ? atomicCount(&s.counters->freeIslands, 1) : -1;
  }
};
struct BeginFreeIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->freeIslands == 0 || s.islandSlot[i] < 0) return;
    IslandSums sums{};
    sums.root = i;
    s.islandSums[s.islandSlot[i]] = sums;
  }
};
/// The place of the island of a body, -1: something holds it, or it has no rows.
RUBBLE_HD inline int freeIslandOf(const SolverData& s, int i) {
  return s.counters->freeIslands > 0 && isDynamic(s, i) ? s.islandSlot[s.rowIsland[i]] : -1;
}

/// What a body adds to the sums of its island. Places and velocities are those against where the leader is,
/// and how it would go.
RUBBLE_HD inline MomentumSums momentaOf(const SolverData& s, int root, int i) {
  const BodyTarget& target = s.target[i];
  const bool stopped = s.stopBits[i] != 0;
  const Vec3 principal = s.params[i].inertia, way = stopped ? s.ccdMotion[i].dp : s.dx[i].dp;
  const Quat q = s.orientation[i], start = conjugate(stopped ? expRotation(s.ccdMotion[i].dw) : s.dq[i]) * q;
  const Vec3 frame = s.step.inverseDt * s.target[root].y.p, w = s.angularVelocity[i];
  Vec3 freeVelocity = s.step.inverseDt * target.y.p - frame;
  const Vec3 v = s.velocity[i] - frame;
  if (stopped) freeVelocity -= unusedPush(s, i, s.previousVelocity[i], s.step.inverseDt * s.dx[i].dp);
  const Vec3 freeSpin = s.step.inverseDt * logRotation(target.y.q);
  const Real m = target.mass.mass;
  const Vec3 after(s.position[i] - s.position[root]), before = after - way, given = m * (v - freeVelocity);
  const Vec3 spin = angularMomentum(q, w, principal, s.step.dt);
  const Sym3 inertia = rotateDiagonal(q, principal);
  MomentumSums own;
  own.mass = m;
  own.place = m * after;
  own.givenLinear = given;
  own.givenAngular = cross(before, given) + m * cross(way, v + frame) +
                     (spin - freeMomentum(start, freeSpin, principal, s.step.dt));
  own.linear = m * v;
  own.angular = m * cross(after, v) + spin;
  own.inertia = inertia;
  addPointInertia(own.inertia, after, m);
  own.freeEnergy = Real(.5) *
                   (m * dot(freeVelocity, freeVelocity) + dot(freeSpin, target.mass.inertia * freeSpin));
  own.energy = Real(.5) * (m * dot(v, v) + dot(w, inertia * w));
  return own;
}

/// act(sums, k, term) for the terms that a body adds to its island, if nothing holds that.
template <class Act> RUBBLE_HD void forEachMomentum(const SolverData& s, int i, Act&& act) {
  const int slot = freeIslandOf(s, i);
  if (slot < 0) return;
  MomentumSums own = momentaOf(s, s.rowIsland[i], i);
  int k = 0;
  forEachTerm(own, [&](Real& term) { act(s.islandSums[slot], k++, term); });
}

/// The largest terms of each island.
struct MeasureMomenta {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    forEachMomentum(s, i, [](IslandSums& sums, int k, Real term) {
      const int bits = floatBits(std::fabs(term));
      if (bits > sums.largest[k]) atomicRaise(&sums.largest[k], bits);
    });
  }
};
struct SumMomenta {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    forEachMomentum(s, i, [](IslandSums& sums, int k, Real term) {
      if (term != Real(0) && sums.isKnown(k)) atomicSum(&sums.sum[k], sums.inUnits(k, term));
    });
  }
};

/// Energies that differ by less than this share are the same [1].
inline constexpr Real kSameEnergy = sizeof(Real) == 8 ? Real(1e-11) : Real(2e-6);

/// The rigid motion that gives an island its momenta back. `origin` of the sums.
RUBBLE_HD inline IslandRepair repairOf(const MomentumSums& sum, const Vec3d& origin, int bonds) {
  const Vec3 centre = sum.place / sum.mass;
  Sym3 inertia = sum.inertia;
  addPointInertia(inertia, centre, -sum.mass);
  const auto spin = [&](const Vec3& angular, const Vec3& linear) {
    return solve(Block3{inertia, angular - cross(centre, linear)});
  };
  IslandRepair r{};
  r.centre = origin + Vec3d(centre);
  r.velocity = sum.linear / sum.mass, r.spin = spin(sum.angular, sum.linear);
  r.addVelocity = -(sum.givenLinear / sum.mass), r.addSpin = -spin(sum.givenAngular, sum.givenLinear);
  const auto rigid = [&](const Vec3& v, const Vec3& w) {
    return Real(.5) * (sum.mass * dot(v, v) + dot(w, inertia * w));
  };
  const Real loose = max(sum.energy - rigid(r.velocity, r.spin), Real(0));
  const Real most = bonds & kJoined ? max(sum.energy, sum.freeEnergy) : sum.freeEnergy;
  const Real whole = rigid(r.velocity + r.addVelocity, r.spin + r.addSpin);
  if (whole + loose > most * (1 + kSameEnergy) && loose > Real(0))
    r.loss = Real(1) - std::sqrt(clamp((most - whole) / loose, Real(0), Real(1)));
  r.active = isFinite(r.addVelocity) && isFinite(r.addSpin) && isFinite(r.loss);
  return r;
}

/// Sums of an island that nothing holds, and what it is short of.
struct RepairIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int slot) const {
    const IslandSums& sums = s.islandSums[slot];
    MomentumSums sum;
    int k = 0;
    forEachTerm(sum, [&](Real& term) {
      term = sums.isKnown(k) ? sums.sumOf(k) : std::numeric_limits<Real>::quiet_NaN();
      ++k;
    });
    s.islandRepair[slot] = repairOf(sum, s.position[sums.root], s.islandBonds[sums.root]);
  }
};

/// Gives bodies their part of what their islands are short of.
struct RepairBodies {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int slot = freeIslandOf(s, i);
    if (slot < 0 || !s.islandRepair[slot].active) return;
    const IslandRepair& r = s.islandRepair[slot];
    const int root = s.rowIsland[i];
    const Vec3 principal = s.params[i].inertia, spin = s.angularVelocity[i];
    const Quat q = s.orientation[i];
    const Sym3 inertia = rotateDiagonal(q, principal);
    const Vec3 arm(s.position[i] - r.centre);
    Vec3 v = r.addVelocity + cross(r.addSpin, arm), turn = r.addSpin, given = inertia * r.addSpin;
    if (r.loss > Real(0)) {
      v -= r.loss * (s.velocity[i] - s.step.inverseDt * s.target[root].y.p - r.velocity - cross(r.spin, arm));
      turn -= r.loss * (spin - r.spin);
      given -= r.loss * (angularMomentum(q, spin, principal, s.step.dt) - inertia * r.spin);
    }
    const Vec3 change = spinChange(rotateInverse(q, spin), rotateInverse(q, given), rotateInverse(q, turn),
                                   kUnreached, principal, s.step.dt);
    Vec3 w = spin + rotate(q, change);
    limitSpin(w, s.step.dt);
    s.velocity[i] += v;
    s.angularVelocity[i] = w;
  }
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Conservation of momentum of free islands.
///
/// A sweep evaluates a row for its two bodies at different iterates, and rotations enter rows to first order.
/// Therefore the impulse on one body does not exactly balance that on the other. An island is a set of bodies
/// that rows of this step connect. If none of its rows acts on a body that is not dynamic, it must have the
/// momenta that it would have without rows:
///
///   sum m (v - v_y) = 0        sum (p x m v + S) - (p^t x m v_y + S_y) = 0
///
/// v_y, S_y: velocity and spin angular momentum at the inertial target. The residuals of the two sums are
/// removed from the velocities as a rigid motion of the island about its center of mass. That is the smallest
/// change in the mass metric, and it changes no relative velocity of touching points.
///
/// The kinetic energy of the island must then not exceed that at its inertial targets; with joints, nor that
/// before the repair if it is larger. Otherwise the motion relative to the rigid motion is scaled down. The
/// relative motion has no momenta, and scaling it violates no joint.
///
/// Bodies of the coarsest aggregates (aggregates.h) are connected already, so few rows remain for union-find.
/// Sums use integers, so their order does not matter (IslandSums).
#include <limits>

#include "stages/ccd/carriers.h"
#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Union-find forest of the bodies that rows connect: that of the coarsest aggregates, or a separate one.
RUBBLE_HD inline int* islandForest(const SolverData& s) { return s.root + atLevel(s, kCoarseLevels - 1, 0); }

struct StartIslandForest {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { islandForest(s)[i] = i; }
};

/// Properties of the rows of an island, as bits.
inline constexpr int kHeld = 1;    ///< a row acts on a body outside the forest, or on the world
inline constexpr int kJoined = 2;  ///< there are joints, which may have springs and drives

/// Does a joint act on a body outside the forest, or on the world?
template <class F> RUBBLE_HD bool isJointHeld(const SolverData& s, std::uint32_t code) {
  if constexpr (F::kGrounded) return true;
  if constexpr (hasFrameBodies<F>()) {
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

/// Unites bodies that rows connect beyond the coarsest aggregates, and flags those that are held.
struct JoinMomentumIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isDynamic(s, i)) {
      s.islandBonds[i] = kHeld;
      return;
    }
    s.islandMassLength[i] = floatBits(s.params[i].mass * 2 * s.params[i].radius);
    int bonds = s.target[i].locks != 0 ? kHeld : 0;
    visitIncidences(s, i, [&](const Incidence& incidence) {
      bonds |= bondsOf(s, incidence);
      if (incidence.depth == kCoarseLevels && incidence.other > i && incidence.other < s.bodies)
        unite(islandForest(s), i, incidence.other);
    });
    s.islandBonds[i] = bonds;
  }
};

/// The island of each body, and the bits of its rows.
struct FindMomentumIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int root = findRoot(islandForest(s), i);
    s.rowIsland[i] = root;
    if (root == i || !isDynamic(s, i)) return;
    // most bodies find the bits of their own there already
    if (const int own = s.islandBonds[i]; (own & ~atomicLoad(&s.islandBonds[root])) != 0)
      atomicSet(&s.islandBonds[root], own);
    if (const int heavy = s.islandMassLength[i]; heavy > atomicLoad(&s.islandMassLength[root]))
      atomicRaise(&s.islandMassLength[root], heavy);
  }
};

/// Numbers the free islands: islandSlot of their roots; -1 for all other bodies.
struct NumberFreeIslands {
  static constexpr const char* kStage = "momentum";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int root = s.rowIsland[i];
    if (isDynamic(s, i) && root != i) s.islandMassLength[i] = s.islandMassLength[root];
    const bool leads = root == i && (s.islandBonds[i] & kHeld) == 0;
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
/// The slot of the island of a body, -1 if the island is held or has no rows.
RUBBLE_HD inline int freeIslandOf(const SolverData& s, int i) {
  return s.counters->freeIslands > 0 && isDynamic(s, i) ? s.islandSlot[s.rowIsland[i]] : -1;
}

/// Contribution of a body to the sums of its island. Positions and velocities are relative to those of the
/// root at its inertial target.
RUBBLE_HD inline MomentumSums momentaOf(const SolverData& s, int root, int i) {
  const BodyTarget& target = s.target[i];
  const bool stopped = s.ccdShareBits[i] != 0;
  const Vec3 principal = s.params[i].inertia, way = stopped ? s.ccdMotion[i].dp : s.dx[i].dp;
  // a carrier moves all that it carries alike, which turns nothing
  const bool carried = stopped && lastCarrierOf(s, i) >= 0;
  const Vec3 ownWay = carried ? (Real(1) - fromFloatBits(s.ccdShareBits[i])) * s.dx[i].dp : way;
  const Quat q = s.orientation[i], start = conjugate(stopped ? expRotation(s.ccdMotion[i].dw) : s.dq[i]) * q;
  const Vec3 frame = s.step->inverseDt * s.target[root].y.p, w = s.angularVelocity[i];
  Vec3 freeVelocity = s.step->inverseDt * target.y.p - frame;
  const Vec3 v = s.velocity[i] - frame;
  if (stopped) freeVelocity -= unusedPush(s, i, s.previousVelocity[i], s.step->inverseDt * s.dx[i].dp);
  const Vec3 freeSpin = s.step->inverseDt * logRotation(target.y.q);
  const Real m = target.mass.mass;
  const Vec3 after(s.position[i] - s.position[root]), before = after - way, given = m * (v - freeVelocity);
  const Vec3 spin = angularMomentum(q, w, principal, s.step->dt);
  const Sym3 inertia = rotateDiagonal(q, principal);
  MomentumSums own;
  own.mass = m;
  own.place = m * after;
  own.givenLinear = given;
  own.givenAngular = cross(before, given) + m * cross(ownWay, v + frame) +
                     (spin - freeMomentum(start, freeSpin, principal, s.step->dt));
  own.linear = m * v;
  own.angular = m * cross(after, v) + spin;
  own.inertia = inertia;
  addPointInertia(own.inertia, after, m);
  own.freeEnergy = Real(.5) *
                   (m * dot(freeVelocity, freeVelocity) + dot(freeSpin, target.mass.inertia * freeSpin));
  own.energy = Real(.5) * (m * dot(v, v) + dot(w, inertia * w));
  return own;
}

/// act(sums, k, term) for the terms that a body adds to its island, if the island is free.
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
      if (bits > atomicLoad(&sums.largest[k])) atomicRaise(&sums.largest[k], bits);
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

/// Relative difference below which energies count as equal [1].
inline constexpr Real kSameEnergy = sizeof(Real) == 8 ? Real(1e-11) : Real(2e-6);

/// The rigid motion that restores the momenta of an island. `origin`: reference point of the sums.
RUBBLE_HD inline IslandRepair repairOf(const MomentumSums& sum, const Vec3d& origin, int bonds) {
  const Vec3 center = sum.place / sum.mass;
  Sym3 inertia = sum.inertia;
  addPointInertia(inertia, center, -sum.mass);
  const auto spin = [&](const Vec3& angular, const Vec3& linear) {
    return solve(Block3{inertia, angular - cross(center, linear)});
  };
  IslandRepair r{};
  r.center = origin + Vec3d(center);
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

/// Evaluates the sums of a free island and its repair.
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

/// Applies the repair of an island to its bodies.
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
    const Vec3 arm(s.position[i] - r.center);
    Vec3 v = r.addVelocity + cross(r.addSpin, arm), turn = r.addSpin, given = inertia * r.addSpin;
    if (r.loss > Real(0)) {
      v -= r.loss *
           (s.velocity[i] - s.step->inverseDt * s.target[root].y.p - r.velocity - cross(r.spin, arm));
      turn -= r.loss * (spin - r.spin);
      given -= r.loss * (angularMomentum(q, spin, principal, s.step->dt) - inertia * r.spin);
    }
    const Vec3 change = spinChange(rotateInverse(q, spin), rotateInverse(q, given), rotateInverse(q, turn),
                                   kUnreached, principal, s.step->dt);
    Vec3 w = spin + rotate(q, change);
    limitSpin(w, s.step->dt);
    s.velocity[i] += v;
    s.angularVelocity[i] = w;
  }
};

}  // namespace rubble::RUBBLE_CORE

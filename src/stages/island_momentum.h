#pragma once
/// The end of a body's step, and the momenta of islands that nothing holds.
///
/// Sweeps leave the two bodies of a row at poses of which one is older, and turn them by angles that rows
/// know to first order: what one body is given is not quite what is taken from the other. An island, bodies
/// that rows of this step connect, of which none acts on anything that does not move by its forces, has to
/// have the momenta that it would have had without rows,
///
///   sum m (v - v_y) = 0        sum p^t x m (v - v_y) + dL = 0
///
/// with v_y the velocities of the inertial targets and dL what each body's spin has beyond its target's
/// (solver/inertia.h). p^t x m v is p x m v at the end of the step, for a body goes along v. What is left of
/// the two sums is taken from the velocities as a rigid motion of the island about its centre of mass at the
/// end of the step. That is the least change in the metric of its masses, and changes no relative velocity
/// of points that touch.
///
/// If the island then had more kinetic energy than both with the spins and velocities of its targets and
/// before the repair, the motion of its bodies against that of a rigid whole is reduced to what is left for
/// it. Such a motion has no momenta, and no joint sees it reduced.
///
/// Bodies of the coarsest group (groups.h) are connected already, so few rows are left to unite. Sums go by
/// group and then by number.
#include "stages/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Pose and velocities of a dynamic body at the end of a step, as its rows left them. One that was stopped
/// on its way keeps its momenta.
struct BodyEnd {
  Quat q;
  Vec3 move;     ///< since x^t [m]
  Vec3 v, w;     ///< [m/s], [rad/s]
  bool limited;  ///< the spin is at its ceiling
};
/// Keeps a spin below what a step can tell.
RUBBLE_HD inline bool limitSpin(Vec3& w, Real dt) {
  const Real turn = length(w) * dt;
  if (!(turn > kMaxSpinPerStep)) return false;
  w *= kMaxSpinPerStep / turn;
  return true;
}
RUBBLE_HD inline BodyEnd endOf(const View& s, int i) {
  const StepConstants& c = s.step;
  const Displacement& d = s.moved[i];
  const bool stopped = s.stopBits[i] != 0;
  const Quat start = s.orientation[i], x = s.turned[i];
  BodyEnd end;
  end.q = normalize((stopped ? expRotation(s.stopped[i].dw) : x) * start);
  end.move = stopped ? s.stopped[i].dp : d.dp;
  end.v = c.inverseDt * d.dp;
  if (stopped) end.v -= unusedPush(s, i, end.v);
  if (c.literalRotations) {
    end.w = c.inverseDt * (Real(2) * shortArc(x).v);
    end.limited = limitSpin(end.w, c.dt);
    return end;
  }
  const Vec3 inertia = s.params[i].inertia;
  const BodyTarget& target = s.target[i];
  end.w = (target.locks >> 3) != 0 ? c.inverseDt * d.dw
                                   : spinAfterRows(start, x, d.dw, target.y.q, inertia, c.dt);
  if (stopped) end.w = spinAt(end.q, x * start, end.w, inertia, c.dt);
  end.limited = limitSpin(end.w, c.dt);
  return end;
}

/// Forest of the bodies that rows connect: that of the coarsest groups, or one of its own.
RUBBLE_HD inline int* islandForest(const View& s) { return s.leader + atLevel(s, kCoarseLevels - 1, 0); }

struct StartIslandForest {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const { islandForest(s)[i] = i; }
};

/// Does a row block act on something that is no body of the forest?
template <class F> RUBBLE_HD bool isJointHeld(const View& s, std::uint32_t code) {
  if constexpr (F::kGrounded) return true;
  if constexpr (isCarried<F>()) {
    const JointSpec<F>& spec = s.specsOf<F>()[jointIndex<F>(code)];
    for (int side = 0; side < kSides<F>; ++side)
      if (!isDynamic(s, bodyOf(spec, side))) return true;
  }
  return false;
}
RUBBLE_HD inline bool isHeld(const View& s, const Entry& entry) {
  const int type = entryType(entry.code);
  if (type == kContactType) return entry.other < 0;
  if (entry.other < 0 || type > JointTypes::kSize) return true;
  bool held = false;
  forEachType(JointTypes{}, [&]<class F>() {
    if (type == typeIndex<F>(JointTypes{}) + 1) held = isJointHeld<F>(s, entry.code);
  });
  return held;
}

/// Unites bodies that rows connect beyond the coarsest groups, and finds those that something holds.
struct JoinMomentumIslands {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    s.islandFirst[i] = -1;
    if (!isDynamic(s, i)) {
      s.islandHeld[i] = 1;
      return;
    }
    bool held = s.target[i].locks != 0;
    for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) {
      const Entry entry = s.entry[k];
      held |= isHeld(s, entry);
      if (entry.depth == kCoarseLevels && entry.other > i && entry.other < s.bodies)
        unite(islandForest(s), i, entry.other);
    }
    s.islandHeld[i] = held;
  }
};

/// The coarsest group of a body, -1: none.
RUBBLE_HD inline int coarsestGroup(const View& s, int i) {
  return s.step.coarseCorrection ? s.groupOf[atLevel(s, kCoarseLevels - 1, i)] : -1;
}

/// Puts `i` on the list that begins at `first`, in no order.
RUBBLE_HD inline void pushOnList(int* first, int* next, int i) {
  for (int old = *first;;) {
    next[i] = old;
    const int seen = atomicClaim(first, old, i);
    if (seen == old) return;
    old = seen;
  }
}

/// What an island consists of: coarsest groups, each by its first member, and bodies that are in none.
struct ListIslandParts {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int root = findLeader(islandForest(s), i);
    s.rowIsland[i] = root;
    if (!isDynamic(s, i)) return;
    if (s.islandHeld[i] != 0 && root != i) atomicSet(&s.islandHeld[root], 1);
    const int group = coarsestGroup(s, i);
    const bool isPart =
        group >= 0 ? s.member[s.memberOffset[group]] == i : s.entryOffset[i + 1] > s.entryOffset[i];
    if (isPart) pushOnList(&s.islandFirst[root], s.islandNext, i);
  }
};

/// Sorts a list by number: merges runs of doubled length. Returns its first element.
RUBBLE_HD inline int sortList(int* next, int first) {
  for (int run = 1;; run *= 2) {
    int left = first, tail = -1, merges = 0;
    for (; left >= 0; ++merges) {
      int right = left, leftSize = 0, rightSize = run;
      for (; leftSize < run && right >= 0; ++leftSize) right = next[right];
      while (leftSize > 0 || (rightSize > 0 && right >= 0)) {
        const bool takesLeft = leftSize > 0 && (rightSize == 0 || right < 0 || left < right);
        int& from = takesLeft ? left : right;
        --(takesLeft ? leftSize : rightSize);
        if (tail < 0)
          first = from;
        else
          next[tail] = from;
        tail = from;
        from = next[from];
      }
      left = right;
    }
    next[tail] = -1;
    if (merges <= 1) return first;
  }
}

/// Adds a body to the sums of its island. Places and velocities are those against where the leader was at
/// x^t, and how it would go.
RUBBLE_HD inline void addMomenta(const View& s, int root, int i, MomentumSums& sum) {
  const BodyEnd end = endOf(s, i);
  const BodyTarget& target = s.target[i];
  const Vec3 principal = s.params[i].inertia, frame = s.step.inverseDt * s.target[root].y.p;
  const Real m = target.mass.mass;
  const Vec3 before(s.position[i] - s.position[root]), after = before + end.move;
  const Vec3 free = s.step.inverseDt * target.y.p - frame, v = end.v - frame,
             given = m * (s.step.inverseDt * (s.moved[i].dp - target.y.p));
  const Vec3 freeSpin = s.step.inverseDt * logRotation(target.y.q),
             spin = angularMomentum(end.q, end.w, principal, s.step.dt);
  const Sym3 inertia = rotateDiagonal(end.q, principal);
  sum.mass += m;
  sum.place += m * after;
  sum.givenLinear += given;
  sum.givenAngular +=
      cross(before, given) + (spin - freeMomentum(s.orientation[i], freeSpin, principal, s.step.dt));
  sum.linear += m * v;
  sum.angular += m * cross(after, v) + spin;
  sum.inertia += inertia;
  addPointInertia(sum.inertia, after, m);
  sum.freeEnergy += Real(.5) * (m * dot(free, free) + dot(freeSpin, target.mass.inertia * freeSpin));
  sum.energy += Real(.5) * (m * dot(v, v) + dot(end.w, inertia * end.w));
}

/// Sums of the coarsest groups, a chunk each.
struct SumMomenta {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Chunk& chunk = s.chunk[i];
    const int first = s.member[s.memberOffset[chunk.group]];
    if (first >= s.bodies || s.islandHeld[s.rowIsland[first]] != 0) return;
    MomentumSums sum{};
    for (int k = chunk.begin; k < chunk.end; ++k)
      if (s.member[k] < s.bodies) addMomenta(s, s.rowIsland[first], s.member[k], sum);
    s.chunkMomenta[i] = sum;
  }
};

/// Energies that differ by less than this share are the same [1].
inline constexpr Real kSameEnergy = sizeof(Real) == 8 ? Real(1e-14) : Real(2e-6);

/// The rigid motion that gives an island its momenta back. `origin` of the sums.
RUBBLE_HD inline IslandRepair repairOf(const MomentumSums& sum, const Vec3d& origin) {
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
  const Real loose = max(sum.energy - rigid(r.velocity, r.spin), Real(0)),
             most = max(sum.energy, sum.freeEnergy);
  const Real whole = rigid(r.velocity + r.addVelocity, r.spin + r.addSpin);
  if (whole + loose > most * (1 + kSameEnergy) && loose > Real(0))
    r.loss = Real(1) - std::sqrt(clamp((most - whole) / loose, Real(0), Real(1)));
  r.acts = isFinite(r.addVelocity) && isFinite(r.addSpin) && isFinite(r.loss);
  return r;
}

/// Sums of an island that nothing holds, and what it is short of.
struct RepairIslands {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int root) const {
    if (s.islandFirst[root] < 0 || s.islandHeld[root] != 0) return;
    const int first = sortList(s.islandNext, s.islandFirst[root]);
    MomentumSums sum{};
    for (int i = first; i >= 0; i = s.islandNext[i]) {
      const int group = coarsestGroup(s, i);
      if (group < 0) {
        addMomenta(s, root, i, sum);
        continue;
      }
      for (int k = s.group[group].chunkBegin; k < s.group[group].chunkEnd; ++k) sum += s.chunkMomenta[k];
    }
    s.islandRepair[root] = repairOf(sum, s.position[root]);
  }
};

/// Gives a body its part of what its island is short of.
RUBBLE_HD inline void repair(const View& s, int i, BodyEnd& end) {
  const int root = s.rowIsland[i];
  if (s.islandHeld[root] != 0 || s.islandFirst[root] < 0) return;
  const IslandRepair& r = s.islandRepair[root];
  if (!r.acts) return;
  const Vec3 principal = s.params[i].inertia;
  const Sym3 inertia = rotateDiagonal(end.q, principal);
  const Vec3 arm(s.position[i] + Vec3d(end.move) - r.centre);
  Vec3 v = r.addVelocity + cross(r.addSpin, arm), given = inertia * r.addSpin;
  if (r.loss > Real(0)) {
    const Vec3 loose = end.v - s.step.inverseDt * s.target[root].y.p - r.velocity - cross(r.spin, arm);
    v -= r.loss * loose;
    given -= r.loss * (angularMomentum(end.q, end.w, principal, s.step.dt) - inertia * r.spin);
  }
  end.v += v;
  end.w += rotate(
      end.q, spinChange(rotateInverse(end.q, end.w), rotateInverse(end.q, given), principal, s.step.dt));
  end.limited |= limitSpin(end.w, s.step.dt);
}

/// Velocities and the new pose. A body whose state is not finite stays where it was, at rest.
struct FinishBodies {
  static constexpr const char* kName = "velocity";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const StepConstants& c = s.step;
    const BodyKind kind = s.params[i].kind;
    if (kind == BodyKind::Removed || kind == BodyKind::Static || isAsleep(s, i)) return;
    if (kind == BodyKind::Kinematic) {
      s.position[i] += Vec3d(s.moved[i].dp);
      s.orientation[i] = normalize(s.turned[i] * s.orientation[i]);
      return;
    }
    BodyEnd end = endOf(s, i);
    if (!c.literalRotations) repair(s, i, end);
    if (!isFinite(end.v) || !isFinite(end.w)) {
      atomicCount(&s.counters->quarantined, 1);
      s.velocity[i] = s.spin[i] = s.previousVelocity[i] = {0, 0, 0};
      return;
    }
    if (end.limited) atomicCount(&s.counters->spinLimited, 1);
    s.previousVelocity[i] = s.velocity[i];
    s.velocity[i] = end.v;
    s.spin[i] = end.w;
    s.correction[i] = s.nextCorrection[i];
    noteUnfinished(s, i, s.moved[i]);
    s.position[i] += Vec3d(end.move);
    s.orientation[i] = end.q;
  }
};

}  // namespace rubble::RUBBLE_CORE

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
/// Bodies of the coarsest group (groups.h) are connected already, so few rows are left to unite. Sums go by
/// group and then by number.
#include "stages/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Forest of the bodies that rows connect: that of the coarsest groups, or one of its own.
RUBBLE_HD inline int* islandForest(const View& s) { return s.leader + atLevel(s, kCoarseLevels - 1, 0); }

struct StartIslandForest {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const { islandForest(s)[i] = i; }
};

/// What rows do with an island, as bits.
inline constexpr int kHeld = 1;    ///< they act on something that is no body of the forest
inline constexpr int kJoined = 2;  ///< there are joints, which may have springs and drives

/// Does a joint act on something that is no body of the forest?
template <class F> RUBBLE_HD bool isJointHeld(const View& s, std::uint32_t code) {
  if constexpr (F::kGrounded) return true;
  if constexpr (isCarried<F>()) {
    const JointSpec<F>& spec = s.specsOf<F>()[jointIndex<F>(code)];
    for (int side = 0; side < kSides<F>; ++side)
      if (!isDynamic(s, bodyOf(spec, side))) return true;
  }
  return false;
}
RUBBLE_HD inline int bondsOf(const View& s, const Entry& entry) {
  const int type = entryType(entry.code);
  if (entry.other < 0 || type > JointTypes::kSize) return kHeld;
  if (type == kContactType) return 0;
  bool held = false;
  forEachType(JointTypes{}, [&]<class F>() {
    if (type == typeIndex<F>(JointTypes{}) + 1) held = isJointHeld<F>(s, entry.code);
  });
  return held ? kHeld : kJoined;
}

/// Unites bodies that rows connect beyond the coarsest groups, and finds those that something holds.
struct JoinMomentumIslands {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    s.islandFirst[i] = -1;
    if (!isDynamic(s, i)) {
      s.islandBonds[i] = kHeld;
      return;
    }
    int bonds = s.target[i].locks != 0 ? kHeld : 0;
    for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) {
      const Entry entry = s.entry[k];
      bonds |= bondsOf(s, entry);
      if (entry.depth == kCoarseLevels && entry.other > i && entry.other < s.bodies)
        unite(islandForest(s), i, entry.other);
    }
    s.islandBonds[i] = bonds;
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
    if (s.islandBonds[i] != 0 && root != i) atomicSet(&s.islandBonds[root], s.islandBonds[i]);
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

/// Adds a body to the sums of its island. Places and velocities are those against where the leader is, and
/// how it would go.
RUBBLE_HD inline void addMomenta(const View& s, int root, int i, MomentumSums& sum) {
  const BodyTarget& target = s.target[i];
  const bool stopped = s.stopBits[i] != 0;
  const Vec3 principal = s.params[i].inertia, way = stopped ? s.stopped[i].dp : s.moved[i].dp;
  const Quat q = s.orientation[i],
             start = conjugate(stopped ? expRotation(s.stopped[i].dw) : s.turned[i]) * q;
  const Vec3 frame = s.step.inverseDt * s.target[root].y.p, w = s.spin[i];
  Vec3 freeVelocity = s.step.inverseDt * target.y.p - frame;
  const Vec3 v = s.velocity[i] - frame;
  if (stopped) freeVelocity -= unusedPush(s, i, s.previousVelocity[i], s.step.inverseDt * s.moved[i].dp);
  const Vec3 freeSpin = s.step.inverseDt * logRotation(target.y.q);
  const Real m = target.mass.mass;
  const Vec3 after(s.position[i] - s.position[root]), before = after - way, given = m * (v - freeVelocity);
  const Vec3 spin = angularMomentum(q, w, principal, s.step.dt);
  const Sym3 inertia = rotateDiagonal(q, principal);
  sum.mass += m;
  sum.place += m * after;
  sum.givenLinear += given;
  sum.givenAngular += cross(before, given) + m * cross(way, v + frame) +
                      (spin - freeMomentum(start, freeSpin, principal, s.step.dt));
  sum.linear += m * v;
  sum.angular += m * cross(after, v) + spin;
  sum.inertia += inertia;
  addPointInertia(sum.inertia, after, m);
  sum.freeEnergy +=
      Real(.5) * (m * dot(freeVelocity, freeVelocity) + dot(freeSpin, target.mass.inertia * freeSpin));
  sum.energy += Real(.5) * (m * dot(v, v) + dot(w, inertia * w));
}

/// Sums of the coarsest groups, a chunk each.
struct SumMomenta {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Chunk& chunk = s.chunk[i];
    const int first = s.member[s.memberOffset[chunk.group]];
    if (first >= s.bodies || (s.islandBonds[s.rowIsland[first]] & kHeld) != 0) return;
    MomentumSums sum{};
    for (int k = chunk.begin; k < chunk.end; ++k)
      if (s.member[k] < s.bodies) addMomenta(s, s.rowIsland[first], s.member[k], sum);
    s.chunkMomenta[i] = sum;
  }
};

/// Energies that differ by less than this share are the same [1].
inline constexpr Real kSameEnergy = sizeof(Real) == 8 ? Real(1e-14) : Real(2e-6);

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
  r.acts = isFinite(r.addVelocity) && isFinite(r.addSpin) && isFinite(r.loss);
  return r;
}

/// Islands of more parts, bodies near one another in a cloud of debris, keep what the sweeps leave: one thread adds them up.
inline constexpr int kMostIslandParts = 16;

/// Sums of an island that nothing holds, and what it is short of.
struct RepairIslands {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int root) const {
    if (s.islandFirst[root] < 0 || (s.islandBonds[root] & kHeld) != 0) return;
    s.islandRepair[root].acts = 0;
    int parts = 0;
    for (int i = s.islandFirst[root]; i >= 0 && parts <= kMostIslandParts; i = s.islandNext[i]) ++parts;
    if (parts > kMostIslandParts) return;
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
    s.islandRepair[root] = repairOf(sum, s.position[root], s.islandBonds[root]);
  }
};

/// Gives bodies their part of what their islands are short of.
struct RepairBodies {
  static constexpr const char* kName = "momentum";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int root = s.rowIsland[i];
    if ((s.islandBonds[root] & kHeld) != 0 || s.islandFirst[root] < 0 || !s.islandRepair[root].acts) return;
    const IslandRepair& r = s.islandRepair[root];
    const Vec3 principal = s.params[i].inertia, spin = s.spin[i];
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
    s.spin[i] = w;
  }
};

}  // namespace rubble::RUBBLE_CORE

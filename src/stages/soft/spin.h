#pragma once
/// Conservation of the angular momentum of free solids.
///
/// The rows of a step act at its end, x = x^t + d, and change velocities from v to d / dt. Angular momentum
/// also depends on x:
///
///   sum m x x d/dt = sum m x^t x v  +  sum m x x (d/dt - v)  +  sum m d x v
///                    (before)          (moment of all forces)   (numerical error of the time step)
///
/// Positions and velocities are relative to the center of mass. The last sum is -(w dt)^2 of the angular
/// momentum of an object that rotates by w dt per step. It is removed at the end as a rigid rotation w of
/// velocities with I w = -sum m d x v. The correction is limited so that the angular momentum does not exceed
/// both that before and that after the step; a torn object therefore gains none.
#include "stages/coarse/soft_nodes.h"

namespace rubble::RUBBLE_CORE {

/// Sheets and ropes are excluded: where they hang on attachments, the restored spin would tear them off.
RUBBLE_HD inline bool keepsSpin(const SolverData& s, const SoftNode& softNode) {
  return softNode.cluster >= 0 && inSolid(s, softNode.first);
}

/// Sums of one of the finest clusters.
struct SumSpins {
  static constexpr const char* kStage = "spin";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Cluster& c = s.cluster[i];
    ClusterMotion& motion = s.clusterMotion[i];
    SpinSums sum{};
    for (int k = c.begin; k < c.end; ++k) addVertex(s, s.clusterMember[k], motion.center, sum);
    motion.spin = sum;
  }
  RUBBLE_HD static void addVertex(const SolverData& s, int v, const Vec3& center, SpinSums& sum) {
    const Real m = s.vertexParams[v].mass;
    const Vec3 place = s.vertexPlace[v] - center, moved = s.vertexMoved[v], velocity = s.vertexVelocity[v];
    addPointInertia(sum.inertia, place, m);
    sum.place += m * place;
    sum.moved += m * moved;
    sum.lost += m * cross(moved, velocity);
    sum.before += m * cross(place, velocity);
    sum.after += m * cross(place, moved);
  }
};

/// Sums of a whole object, and the rotation of its velocities: `step.ang` of its largest cluster about
/// `center`, the center of mass.
struct FindSpins {
  static constexpr const char* kStage = "spin";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!keepsSpin(s, s.softNode[i])) return;
    ClusterMotion& whole = s.clusterMotion[s.softNode[i].cluster];
    const SpinSums sum = sumOf(s, s.cluster[s.softNode[i].cluster], whole);
    const Real mass = whole.mass;
    const Vec3 center = sum.place / mass, moved = sum.moved / mass;
    Sym3 inertia = sum.inertia;
    addPointInertia(inertia, center, -mass);
    const Vec3 lost = sum.lost - mass * cross(moved, whole.velocity);
    const Vec3 before = sum.before - sum.lost - mass * cross(center - moved, whole.velocity);
    const Vec3 after = s.step->inverseDt * (sum.after - mass * cross(center, moved));
    // collinear masses have no moment of inertia about their line
    constexpr Real kLeast = Real(1e-5);
    const Real least = kLeast * (inertia.xx + inertia.yy + inertia.zz);
    inertia.xx += least, inertia.yy += least, inertia.zz += least;
    const Vec3 turn = solve(Block3{inertia, -keptShare(before, after, lost) * lost});
    whole.center += center;
    whole.step.ang = isFinite(turn) ? turn : Vec3{0, 0, 0};
  }
  RUBBLE_HD static SpinSums sumOf(const SolverData& s, const Cluster& c, const ClusterMotion& whole) {
    SpinSums sum{};
    for (int k = c.sliceBegin; k < c.sliceEnd; ++k) {
      const ClusterMotion& part = s.clusterMotion[k];
      const Vec3 shift = part.center - whole.center;
      // shift of the reference point, for positions s + shift
      sum.inertia += part.spin.inertia;
      addPointInertia(sum.inertia, shift + part.spin.place / part.mass, part.mass);
      addPointInertia(sum.inertia, part.spin.place / part.mass, -part.mass);
      sum.place += part.spin.place + part.mass * shift;
      sum.moved += part.spin.moved;
      sum.lost += part.spin.lost;
      sum.before += part.spin.before + part.mass * cross(shift, part.velocity);
      sum.after += part.spin.after + cross(shift, part.spin.moved);
    }
    return sum;
  }
  /// The largest share in [0, 1] with |after - share lost| <= max(|before|, |after|).
  RUBBLE_HD static Real keptShare(const Vec3& before, const Vec3& after, const Vec3& lost) {
    const Real a = dot(lost, lost), b = dot(after, lost),
               c = dot(after, after) - max(dot(before, before), dot(after, after));
    if (!(a > Real(0))) return 0;
    // the larger root of a t^2 - 2 b t + c
    return clamp((b + std::sqrt(max(b * b - a * c, Real(0)))) / a, Real(0), Real(1));
  }
};

/// Velocity that the spin correction of its object adds to a vertex [m/s].
RUBBLE_HD inline Vec3 spinOf(const SolverData& s, int v) {
  const int softNode = s.vertexParams[v].softNode;
  if (softNode < 0 || !keepsSpin(s, s.softNode[softNode])) return {0, 0, 0};
  const ClusterMotion& whole = s.clusterMotion[s.softNode[softNode].cluster];
  return cross(whole.step.ang, s.vertexPlace[v] - whole.center);
}

/// Computes velocities and new positions. A vertex whose state is not finite keeps its position, at rest.
struct FinishVertices {
  static constexpr const char* kStage = "velocity";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isDynamicVertex(s, v)) return;
    const Vec3 moved = s.vertexMoved[v], velocity = s.step->inverseDt * moved + spinOf(s, v);
    if (!hasLength(moved) || !isFinite(velocity)) {
      atomicCount(&s.counters->quarantined, 1);
      s.vertexVelocity[v] = s.vertexOldVelocity[v] = {0, 0, 0};
      return;
    }
    s.vertexOldVelocity[v] = s.vertexVelocity[v];
    s.vertexVelocity[v] = velocity;
    s.vertexPosition[v] += Vec3d(moved);
  }
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Gathers stage inputs of four bodies, constraints or joints into the lanes of SIMD registers, and scatters
/// the results.
#include <cstddef>

#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

/// Indices of four elements, one per lane.
using Lane4 = int[kLanes];

/// Elements [4 k, 4 k + 4) of four structs of reals.
template <class T>
RUBBLE_NEAR Quad<Real4> gatherNumbers(const T* a, const T* b, const T* c, const T* d, int k = 0) {
  const auto at = [&](const T* p) { return reinterpret_cast<const Real*>(p) + 4 * k; };
  return LaneAccess<Real4>::gatherQuad(at(a), at(b), at(c), at(d));
}
template <class T> RUBBLE_NEAR Quad<Real4> gatherNumbers(Array<T> table, const Lane4& i, int k = 0) {
  return gatherNumbers(table + i[0], table + i[1], table + i[2], table + i[3], k);
}
RUBBLE_NEAR Vec3T<Real4> vectorOf(const Quad<Real4>& q) { return {q.x, q.y, q.z}; }
RUBBLE_NEAR QuatT<Real4> quaternionOf(const Quad<Real4>& q) { return {q.x, {q.y, q.z, q.w}}; }

/// A block padded to a multiple of four reals.
struct PaddedBlock {
  Block6 block;
  Real pad = 0;
};
inline constexpr int kBlockQuads = sizeof(PaddedBlock) / (4 * sizeof(Real));
static_assert(sizeof(Block6) == 27 * sizeof(Real) && sizeof(Block6T<Real4>) == 27 * sizeof(Real4));

RUBBLE_NEAR void gatherBlocks(const PaddedBlock (&in)[kLanes], Block6T<Real4>& out) {
  auto* const to = reinterpret_cast<Real4Aliased*>(&out);
  for (int k = 0; k < kBlockQuads; ++k) {
    const Quad<Real4> q = gatherNumbers(&in[0], &in[1], &in[2], &in[3], k);
    to[4 * k] = q.x, to[4 * k + 1] = q.y, to[4 * k + 2] = q.z;
    if (k + 1 < kBlockQuads) to[4 * k + 3] = q.w;
  }
}
RUBBLE_NEAR void scatterBlocks(const Block6T<Real4>& in, PaddedBlock (&out)[kLanes]) {
  const auto* const from = reinterpret_cast<const Real4Aliased*>(&in);
  const auto at = [&](int lane, int k) { return reinterpret_cast<Real*>(&out[lane]) + 4 * k; };
  for (int k = 0; k < kBlockQuads; ++k) {
    const Real4 last = k + 1 < kBlockQuads ? from[4 * k + 3] : from[4 * k];
    LaneAccess<Real4>::scatterQuad(at(0, k), at(1, k), at(2, k), at(3, k),
                                   {from[4 * k], from[4 * k + 1], from[4 * k + 2], last});
  }
}

/// Displacement and rotation since x^t of four bodies.
RUBBLE_NEAR PoseT<Real4> gatherPoses(const SolverData& s, const Lane4& body) {
  return {vectorOf(gatherNumbers(s.dx, body)), quaternionOf(gatherNumbers(s.dq, body))};
}
/// Inertia and inertial targets of four bodies.
struct TargetLanes {
  MassMatrixT<Real4> mass;
  PoseT<Real4> y;
};
RUBBLE_NEAR TargetLanes gatherTargets(const SolverData& s, const Lane4& body) {
  static_assert(offsetof(BodyTarget, y) == 7 * sizeof(Real) &&
                offsetof(BodyTarget, locks) == 14 * sizeof(Real));
  const Quad<Real4> q[4] = {gatherNumbers(s.target, body, 0), gatherNumbers(s.target, body, 1),
                            gatherNumbers(s.target, body, 2), gatherNumbers(s.target, body, 3)};
  return {{q[0].x, {q[0].y, q[0].z, q[0].w, q[1].x, q[1].y, q[1].z}},
          {{q[1].w, q[2].x, q[2].y}, {q[2].z, {q[2].w, q[3].x, q[3].y}}}};
}

/// Sets the iterates of four bodies to x. Returns false without a write if a rotation is large. `step2`,
/// `turn2`: as in Displacement.
RUBBLE_NEAR bool placeTogether(const SolverData& s, const Lane4& body, const PoseT<Real4>& x, Real4 step2,
                               Real4 turn2) {
  const QuatT<Real4> q = shortArc(x.q);
  const Real4 u2 = dot(q.v, q.v);
  if (!allOf(u2 < LaneAccess<Real4>::splat(kSmallTurn2))) return false;
  const Vec3T<Real4> turn = logOfSmall(q, u2);
  const auto scatter = [&]<class T>(Array<T> table, int k, const Quad<Real4>& v) {
    const auto at = [&](int lane) { return reinterpret_cast<Real*>(table + body[lane]) + 4 * k; };
    LaneAccess<Real4>::scatterQuad(at(0), at(1), at(2), at(3), v);
  };
  scatter(s.dq, 0, {x.q.s, x.q.v.x, x.q.v.y, x.q.v.z});
  scatter(s.dx, 0, {x.p.x, x.p.y, x.p.z, step2});
  scatter(s.dx, 1, {turn.x, turn.y, turn.z, turn2});
  return true;
}

/// Inputs of four ball joints in a sweep. Poses are relative to x^t, that of A relative to the center of B.
struct BallLanes {
  Anchors<Real4> levers;
  PoseT<Real4> a, b;
  Real4 lambda[3], shift[3];
  GroupLaw<Real4> law;
  GroupRows<AnchorRows::kRows>* rows[kLanes];  ///< source of each lane
};

/// Returns whether this is an active ball joint between two bodies with held anchors.
RUBBLE_NEAR bool isPlainBall(const SolverData& s, int index) {
  const Joint<BallJoint>& joint = s.jointsOf<BallJoint>()[index];
  return joint.end[0].body != kWorldBody && joint.end[1].body != kWorldBody && (joint.acting & 1) != 0;
}
/// Returns whether the constraint of this code is such a joint.
RUBBLE_NEAR bool isPlainBall(const SolverData& s, std::uint32_t code) {
  if (constraintType(code) != typeIndex<BallJoint>(JointTypes{}) + 1) return false;
  return isPlainBall(s, constraintIndex(code));
}

RUBBLE_NEAR BallLanes gatherBalls(const SolverData& s, const Lane4& index) {
  using Rows = GroupRows<AnchorRows::kRows>;
  static_assert(offsetof(Rows, state) == 6 * sizeof(Real) && sizeof(Rows) >= 12 * sizeof(Real) &&
                sizeof(JointEnd) == 4 * sizeof(Real));
  Joint<BallJoint>* const joints = s.jointsOf<BallJoint>();
  BallLanes j;
  Lane4 a, b;
  const PivotFrame* frame[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    Joint<BallJoint>& joint = joints[index[lane]];
    frame[lane] = &joint;
    a[lane] = joint.end[0].body, b[lane] = joint.end[1].body;
    j.rows[lane] = &partOf<0>(joint.parts);
  }
  const auto leverOf = [&](int k) {
    return vectorOf(
        gatherNumbers(&frame[0]->end[k], &frame[1]->end[k], &frame[2]->end[k], &frame[3]->end[k]));
  };
  j.levers = {leverOf(0), leverOf(1)};
  const auto gatherRows = [&](int k) { return gatherNumbers(j.rows[0], j.rows[1], j.rows[2], j.rows[3], k); };
  const Quad<Real4> first = gatherRows(0), second = gatherRows(1), third = gatherRows(2);
  j.lambda[0] = first.x, j.lambda[1] = first.y, j.lambda[2] = first.z;
  j.shift[0] = first.w, j.shift[1] = second.x, j.shift[2] = second.y;
  j.law = {second.z, second.w, third.x};
  j.a = gatherPoses(s, a), j.b = gatherPoses(s, b);
  j.a.p = vectorOf(
              gatherNumbers(&frame[0]->offset, &frame[1]->offset, &frame[2]->offset, &frame[3]->offset)) +
          j.a.p;
  return j;
}

/// Adds four ball joints to the block of one body each (accumulatePivot for four lanes).
inline void accumulateBalls(const SolverData& s, const std::uint32_t (&code)[kLanes], Block6T<Real4>& block,
                            const Vec3T<Real4>& shift) {
  const auto side = [&](int lane) { return static_cast<Real>(constraintSide(code[lane])); };
  const BallLanes j = gatherBalls(s, {constraintIndex(code[0]), constraintIndex(code[1]),
                                      constraintIndex(code[2]), constraintIndex(code[3])});
  Real4 error[3], force[3], hessian;
  heldErrors<AnchorRows>(j.shift, j.levers, NoMemory{}, j.a, j.b, error);
  cutForce<3>(j.law, error, j.lambda, force, 3, hessian);
  AnchorRows::accumulate(j.levers, j.a, j.b,
                         Real4{side(0), side(1), side(2), side(3)} == LaneAccess<Real4>::splat(0), shift,
                         force, hessian, block);
}

}  // namespace rubble::RUBBLE_CORE

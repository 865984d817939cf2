#pragma once
/// What every joint shares: two bodies, groups of rows, and the loops over them. A joint type F declares
///
///   kRows, kGroups   its rows and which of them share a stiffness and a bound
///   Data             authored constants
///   constraint       C(x), for the poses of A and B in a common frame
///   jacobian         dC/dx of A (side 0) or B (side 1), rotations in world axes on the left
///   curvature        column norms of sum F d2C/dx2 of that body
///
/// and everything else follows: warm start, primal, dual, breakage, incidence, tests.
#include "forces/contact.h"
#include "solver/dual.h"

namespace rubble::RUBBLE_CORE {

/// In place of a body index: the fixed world.
inline constexpr int kWorldBody = -1;

/// F::kGroups[g], for device code too, where a static array has no address.
template <class F>
RUBBLE_HD constexpr RowGroup rowGroup(int g) {
  struct Table {
    RowGroup groups[F::kGroupCount]{};
    constexpr Table() {
      for (int i = 0; i < F::kGroupCount; ++i) groups[i] = F::kGroups[i];
    }
  };
  constexpr Table table;
  return table.groups[g];
}

/// One joint of type F: authored data, state that lasts from step to step, and what a step works with.
template <class F>
struct Joint {
  typename F::Data data;
  int a, b;                          ///< bodies, or kWorldBody
  bool alive, broken;
  Real bound[F::kGroupCount];        ///< break threshold of each group [N], [N m]
  Real compliance[F::kGroupCount];   ///< 1 / K_mat, 0 hard
  Real lambda[F::kRows];             ///< [N], [N m]
  Real k[F::kGroupCount];            ///< 0 before the first step
  GroupState group[F::kGroupCount];  ///< of this step
  Real c0[F::kRows];                 ///< alpha C(x^t)
  Vec3 offset;                       ///< p_A - p_B at x^t [m]; the step works in the frame with origin p_B^t
};

/// C(x) - alpha C(x^t)
template <class F>
RUBBLE_HD void regularisedError(const Joint<F>& joint, const Pose& a, const Pose& b, Real (&error)[F::kRows]) {
  F::constraint(joint.data, a, b, error);
  for (int i = 0; i < F::kRows; ++i) error[i] -= joint.c0[i];
}

/// Row inertia of a group: mass [kg] or moment of inertia with lever [kg m2] of the lighter dynamic body.
struct JointBody {
  Real mass;        ///< 0: not dynamic
  Vec3 inertia;     ///< principal moments
};
RUBBLE_HD inline Real rowInertia(const JointBody& body, RowUnit unit, Real lever2) {
  if (unit == RowUnit::Linear) return body.mass;
  return min(min(body.inertia.x, body.inertia.y), body.inertia.z) + body.mass * lever2 / 3;
}

/// Warm start of all rows at x^t. `stepPose` of both bodies in the joint's frame.
template <class F>
RUBBLE_HD void beginJoint(const StepConstants& c, Joint<F>& joint, const Pose& a, const Pose& b, const JointBody& bodyA, const JointBody& bodyB,
                          Real length) {
  Real error[F::kRows];
  F::constraint(joint.data, a, b, error);
  for (int g = 0; g < F::kGroupCount; ++g) {
    const RowGroup group = rowGroup<F>(g);
    Real inertia = 0;
    if (bodyA.mass > Real(0)) inertia = rowInertia(bodyA, group.unit, F::lever2(joint.data, 0));
    if (bodyB.mass > Real(0)) {
      const Real other = rowInertia(bodyB, group.unit, F::lever2(joint.data, 1));
      inertia = inertia > Real(0) ? min(inertia, other) : other;
    }
    GroupState& state = joint.group[g];
    const Real compliance = joint.compliance[g];
    const bool hard = compliance == Real(0);
    StiffnessRule rule = jointRule(c, startStiffness(c, inertia), group.unit == RowUnit::Linear ? length : Real(1));
    const bool ramp = !hard && !c.compliantRows;
    if (ramp) {
      rule.policy = StiffnessPolicy::Ramp;
      rule.limit = min(rule.limit, Real(1) / compliance);
      rule.start = min(rule.start, rule.limit);
    }
    Real size2 = 0;
    for (int i = group.begin; i < group.begin + group.count; ++i) {
      joint.lambda[i] = ramp ? Real(0) : warmMultiplier(c, joint.lambda[i], hard);
      joint.c0[i] = hard ? c.alpha * error[i] : Real(0);
      size2 += joint.lambda[i] * joint.lambda[i];
    }
    const Real k = joint.k[g] > Real(0) ? warmStiffness(c, rule, joint.k[g], std::sqrt(size2)) : coldStart(rule.start).k;
    const Real ceiling = group.unit == RowUnit::Linear ? c.maxMultiplier : c.maxMultiplier * length;
    state = {k, ramp ? Real(0) : compliance, min(joint.bound[g], ceiling), rule, !ramp};
  }
}

/// Adds all rows of a joint to the block of one of its bodies (side 0: A, 1: B).
template <class F>
RUBBLE_HD void stampJoint(const Joint<F>& joint, const Pose& a, const Pose& b, int side, Block6& block) {
  Real error[F::kRows], force[F::kRows];
  Vec6 j[F::kRows];
  regularisedError(joint, a, b, error);
  F::jacobian(joint.data, a, b, side, j);
  for (int g = 0; g < F::kGroupCount; ++g) {
    const RowGroup group = rowGroup<F>(g);
    Real groupRows[F::kRows], hessian;
    groupForce<F::kRows>(joint.group[g], error + group.begin, joint.lambda + group.begin, groupRows, group.count, hessian);
    for (int i = 0; i < group.count; ++i) {
      force[group.begin + i] = groupRows[i];
      stampRow(block, j[group.begin + i], groupRows[i], hessian);
    }
  }
  stampCurvature(block, F::curvature(joint.data, a, b, side, force));
}

template <class F>
RUBBLE_HD void updateJointDuals(Joint<F>& joint, const Pose& a, const Pose& b) {
  Real error[F::kRows];
  regularisedError(joint, a, b, error);
  for (int g = 0; g < F::kGroupCount; ++g)
    updateGroup<F::kRows>(joint.group[g], error + rowGroup<F>(g).begin, joint.lambda + rowGroup<F>(g).begin, rowGroup<F>(g).count);
}

/// Keeps the stiffness for the next step; a joint whose force has reached a break threshold is broken from now on: returns true.
template <class F>
RUBBLE_HD bool endJoint(Joint<F>& joint) {
  bool broke = false;
  for (int g = 0; g < F::kGroupCount; ++g) {
    const RowGroup group = rowGroup<F>(g);
    joint.k[g] = joint.group[g].k;
    Real size2 = 0;
    for (int i = group.begin; i < group.begin + group.count; ++i) size2 += joint.lambda[i] * joint.lambda[i];
    // the force was cut to the bound, so "reached" is up to round-off
    broke |= size2 >= joint.bound[g] * joint.bound[g] * (Real(1) - Real(1e-5));
  }
  joint.broken |= broke;
  return broke;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// What turns, once an iteration. Rows that depend on the rotation of A relative to B alone (limits, drives
/// and friction of angles, axes that stay parallel) are angles, roots and quotients of quaternions, and every
/// sweep asks for them from both bodies, and every level of groups again. They are found before the sweep,
/// and are linear in what the joint has turned since (forces/joint_accumulation.h) until the next one; laws
/// of force, bounds and limits stay as they are. What is left out is of second order in the steps of one
/// iteration, and the next one begins without it. Groups of an iteration have them from the sweep before.
#include "stages/bodies/blocks.h"

namespace rubble::RUBBLE_CORE {

/// A part of a joint each.
template <class F> struct LinearizeAngularRows {
  static constexpr const char* kStage = "joint turns";
  static constexpr int kPerJoint = hasAngularRows<F>() ? F::Parts::kCount : 0;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PartIndex at = partAt<F>(s, k);
    const JointSpec<F>& spec = s.specsOf<F>()[at.joint];
    const Joint<F>& joint = s.jointsOf<F>()[at.joint];
    // no sweep and no group asks for those of a tree that is solved exactly
    const int body = spec.a != kWorldBody && isDynamic(s, spec.a) ? spec.a : spec.b;
    if (!joint.active || inExactTree(s, body)) return;
    if constexpr (hasAngularRows<F>()) {
      if (at.part > 0 && !turnActs<F>(joint.acting, at.part)) return;
      const SidePose<F> a = poseOfA(s, spec, joint), b = poseOfB(s, spec, joint);
      const Quat turnedA = poseSinceStart(s, spec.a).q, turnedB = poseSinceStart(s, spec.b).q;
      JointAngularRows<F>& turns = s.angularRowsOf<F>()[at.joint];
      if (at.part == 0) turns.from = turnsFrom(turnedA, turnedB);
      forEachPart<F>([&]<int I, class P>() {
        if constexpr (isTurn<F, P>())
          for (int k = 0; I == at.part && k < turnLaws<F, P>(); ++k)
            storeVectorized(turns.law[firstTurnLaw<F, I>() + k], [&](AngularRows& rows) {
              return linearizeTurn<F, I, P>(spec, joint, a, b, turnedB, k, rows);
            });
      });
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

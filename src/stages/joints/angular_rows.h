#pragma once
/// Linearization of angular rows, once per iteration. Rows that depend only on the rotation of A relative to
/// B (limits, drives and friction of angles, parallel axes) involve angles, roots and quotients of
/// quaternions. Each sweep evaluates them for both bodies, and each aggregate level does again.
///
/// They are evaluated once before the sweep and are linear in the joint rotation since then
/// (forces/joint_accumulation.h). Force laws, bounds and limits are not linearized. The error is of second
/// order in the steps of one iteration and does not accumulate. Aggregates use the linearization of the
/// preceding sweep.
#include "stages/bodies/blocks.h"

namespace rubble::RUBBLE_CORE {

/// One thread per joint part.
template <class F> struct LinearizeAngularRows {
  static constexpr const char* kStage = "angular rows";
  static constexpr int kPerJoint = hasAngularRows<F>() ? F::Parts::kCount : 0;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PartIndex at = partAt<F>(s, k);
    const JointSpec<F>& spec = s.specsOf<F>()[at.joint];
    const Joint<F>& joint = s.jointsOf<F>()[at.joint];
    // no sweep or aggregate evaluates the joints of exactly solved trees
    const int body = spec.a != kWorldBody && isDynamic(s, spec.a) ? spec.a : spec.b;
    if (!joint.active || inExactTree(s, body)) return;
    if constexpr (hasAngularRows<F>()) {
      if (at.part > 0 && !turnActs<F>(joint.acting, at.part)) return;
      const SidePose<F> a = poseOfA(s, spec, joint), b = poseOfB(s, spec, joint);
      const Quat turnedA = poseSinceStart(s, spec.a).q, turnedB = poseSinceStart(s, spec.b).q;
      JointAngularRows<F>& turns = s.angularRowsOf<F>()[at.joint];
      if (at.part == 0) turns.from = turnsFrom(turnedA, turnedB);
      forEachPart<F>([&]<int I, class P>() {
        if constexpr (isAngular<F, P>())
          for (int k = 0; I == at.part && k < angularLaws<F, P>(); ++k)
            storeVectorized(turns.law[firstAngularLaw<F, I>() + k], [&](AngularRows& rows) {
              return linearizeAngularRow<F, I, P>(spec, joint, a, b, turnedB, k, rows);
            });
      });
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

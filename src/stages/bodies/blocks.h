#pragma once
/// A common interface to constraints of every type: the bodies on which they act.
#include "stages/joints/joints.h"

namespace rubble::RUBBLE_CORE {

/// visit(body, side, other) for the dynamic bodies of a constraint between a and b.
template <class Visit> RUBBLE_HD void visitSides(const SolverData& s, int a, int b, Visit&& visit) {
  const bool da = isDynamic(s, a), db = isDynamic(s, b);
  if (da) visit(a, 0, db ? b : -1);
  if (db) visit(b, 1, da ? a : -1);
}

/// Is a tree solved exactly in this step, because it has neither loops nor contacts? Its own block is then
/// the only one that moves its bodies.
RUBBLE_HD inline bool isExact(const SolverData& s, const TreeNode& node) {
  return node.exact && s.treeContacts[node.tree] == kTouchesNothing;
}
RUBBLE_HD inline bool inExactTree(const SolverData& s, int body) {
  const int node = s.plan.jointTrees ? s.nodeOfBody[body] : -1;
  return node >= 0 && isExact(s, s.treeNode[node]);
}
/// Marks the trees with contacts in this step.
struct MarkTouchedTrees {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const auto touch = [&](int body) {
      if (s.nodeOfBody[body] >= 0)
        atomicSet(&s.treeContacts[s.treeNode[s.nodeOfBody[body]].tree], kHasContacts);
    };
    touch(s.rowBodies[i].a), touch(s.rowBodies[i].b);
  }
};

/// The two bodies of a constraint (contact or joint), and whether it is active in this step.
struct BlockBodies {
  int a, b;
  bool active;
};
struct ContactBlocks {
  static constexpr int kType = kContactType;
  /// Is the constraint invariant under a rigid motion of both bodies?
  static constexpr bool kRelative = true;
  RUBBLE_HD static BlockBodies bodies(const SolverData& s, int i) {
    return {s.rowBodies[i].a, s.rowBodies[i].b, true};
  }
  template <class Visit> RUBBLE_HD static void visitIncidences(const SolverData& s, int i, Visit&& visit) {
    visitSides(s, s.rowBodies[i].a, s.rowBodies[i].b,
               [&](int body, int side, int other) { visit(body, constraintCode(kType, i, side), other); });
  }
  /// Level of the aggregates at which the constraint unites its bodies.
  RUBBLE_HD static int joinLevel(const SolverData& s, int i) { return s.joinLevel[i]; }
};
template <class F> struct JointBlocks {
  static constexpr int kType = typeIndex<F>(JointTypes{}) + 1;
  static constexpr bool kRelative = !F::kGrounded && !hasFrameBodies<F>();
  RUBBLE_HD static BlockBodies bodies(const SolverData& s, int i) {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    return {spec.a, spec.b, s.jointsOf<F>()[i].active != 0};
  }
  /// visit(body, code, other) for the incidences of the joint's dynamic bodies.
  template <class Visit> RUBBLE_HD static void visitIncidences(const SolverData& s, int i, Visit&& visit) {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (!s.jointsOf<F>()[i].active) return;
    if constexpr (hasFrameBodies<F>()) {
      const auto takesPart = [&](int side) {
        return isDynamic(s, bodyOf(spec, side)) && isFirstSide(spec, side);
      };
      for (int side = 0; side < kSides<F>; ++side) {
        if (!takesPart(side)) continue;
        int link = 0;
        for (int k = 0; k < kSides<F>; ++k)
          if (k != side && takesPart(k))
            visit(bodyOf(spec, side), jointCode<F>(i, side, link++), bodyOf(spec, k));
        if (link == 0) visit(bodyOf(spec, side), jointCode<F>(i, side), -1);
      }
    } else {
      visitSides(s, spec.a, spec.b,
                 [&](int body, int side, int other) { visit(body, jointCode<F>(i, side), other); });
    }
  }
  RUBBLE_HD static int joinLevel(const SolverData& s, int i) {
    const int level = rigidLevel(s, i);
    return level < kCoarseLevels && inExactTree(s, s.specsOf<F>()[i].a) ? kCoarseLevels : level;
  }
  /// The same, were no tree solved exactly.
  RUBBLE_HD static int rigidLevel(const SolverData& s, int i) {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    const bool unites = spec.isRigid && spec.a != kWorldBody && spec.b != kWorldBody;
    return unites ? s.jointsOf<F>()[i].sharedLevel : kCoarseLevels;
  }
};

}  // namespace rubble::RUBBLE_CORE

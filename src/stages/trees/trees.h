#pragma once
/// Direct solve of joint trees: one more block of the same descent, whose unknowns are all bodies connected
/// by joints.
///
/// A body-by-body sweep propagates a correction by one body, and aggregates move rigidly, while a chain
/// bends. Where joints form a tree, the Newton step [S 3] in the unknowns of all its bodies costs little more
/// than one step per body. Bodies with at most two remaining neighbors are eliminated, each of which leaves
/// at most one new coupling; back substitution follows. Loops that close in this way (rings, ladders,
/// four-bars) are solved along with the rest. Bodies that always keep three neighbors (nets) are left to
/// other blocks and count as fixed here. Bodies of one elimination level are not neighbors, so a level is one
/// kernel, and a chain of N bodies takes about log2 N levels.
///
/// A tree without loops and contacts is solved exactly, and by this block alone. All other trees share their
/// rows, and so the objective of the descent, with sweeps and aggregates.
///
/// Rows that leave the tree enter as in a body's own block. A contact between two bodies of trees is not
/// coupled in this block although both move. The bound of coarse.h holds for it: its Hessian counts twice.
#include "forces/joint_tree.h"
#include "stages/bodies/incidence.h"

namespace rubble::RUBBLE_CORE {

/// Marks the trees that are in contact with, or attached to, deformable objects.
struct MarkSoftTrees {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    // deformable objects come last in the incidence list, attachments before contacts
    const int i = s.treeNode[n].body;
    if (i < 0) return;
    int touches = kTouchesNothing;
    for (int k = s.incidenceOffset[i + 1] - 1; k >= s.incidenceOffset[i]; --k) {
      const int type = constraintType(s.incidence[k].code);
      if (type <= JointTypes::kSize) break;
      touches = type == kBodyAttachmentType ? kHoldsVertices : kHasContacts;
    }
    if (touches != kTouchesNothing) atomicRaise(&s.treeContacts[s.treeNode[n].tree], touches);
  }
};

RUBBLE_HD inline bool movesInTree(const SolverData& s, int body) {
  return body >= 0 && body < s.bodies && s.nodeOfBody[body] >= 0;
}

/// Weight of the Hessian of a contact [1].
RUBBLE_HD inline Real contactWeight(const SolverData& s, const Incidence& incidence) {
  return movesInTree(s, incidence.other) ? Real(2) : Real(1);
}

/// The node of a body that its tree may move, -1 if there is none.
RUBBLE_HD inline int movingNode(const SolverData& s, int body) {
  return body != kWorldBody && isDynamic(s, body) ? s.nodeOfBody[body] : -1;
}

/// How a tree is solved when trees with contacts are solved by `how`.
RUBBLE_HD inline TreeSolve treeSolveOf(const SolverData& s, const TreeNode& node, TreeSolve how) {
  return isExact(s, node) ? TreeSolve::Exact : node.exact ? how : TreeSolve::Own;
}
/// A tree in which no body rotates by more than this in a solve is skipped in the next one [rad]. What that
/// would correct is of second order in it, or a limit violated by no more than twice as much. kTreeAtRest:
/// after the first solve. kTreeSettled: after a repeated one, which meets few new limits.
inline constexpr Real kTreeAtRest = Real(.002), kTreeSettled = Real(.01);

/// The trees that take part in a solve. Trees attached to deformable objects are solved before the last
/// sweep, because vertices do not see the high stiffness of the exactly solved joints. All others are solved
/// after it.
enum class TreesOf { Any, Attached, Rest };
RUBBLE_HD inline bool holdsVertices(const SolverData& s, int tree) {
  return s.treeContacts[tree] == kHoldsVertices;
}

/// Begins a solve. Trees that are solved exactly, or have no limits, need no repeated solve.
struct BeginTrees {
  static constexpr const char* kStage = "trees";
  TreeSolve how;
  TreesOf of;
  Real atRest;  ///< largest rotation in the preceding solve that needs no repeated one [rad]
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (node.tree != n) return;
    const bool out = of != TreesOf::Any && holdsVertices(s, n) != (of == TreesOf::Attached);
    const bool done = !node.limited || isExact(s, node) || fromFloatBits(s.treeMaxRotation[n]) < atRest;
    s.treeConverged[n] = out || (how == TreeSolve::Again && done);
    s.treeMaxRotation[n] = 0;
  }
};

/// Linearizes the rows of all joints of trees. One thread per joint part.
template <class F> struct FindTreeRows {
  static constexpr const char* kStage = "tree rows";
  static constexpr int kPerJoint = F::Parts::kCount;
  TreeSolve how;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PartIndex at = partAt<F>(s, k);
    const JointSpec<F>& spec = s.specsOf<F>()[at.joint];
    const Joint<F>& joint = s.jointsOf<F>()[at.joint];
    if (!joint.active) return;
    int n = -1;
    for (int side = 0; side < kSides<F> && n < 0; ++side) n = movingNode(s, bodyOf(spec, side));
    if (n < 0 || s.treeConverged[s.treeNode[n].tree]) return;
    const TreeSolve own = spec.isRigid ? treeSolveOf(s, s.treeNode[n], how) : TreeSolve::Own;
    const SidePose<F> a = poseOfA(s, spec, joint), b = poseOfB(s, spec, joint);
    TreePart<kSides<F>>& to = s.treeRowsOf<F>()[at.joint].part[at.part];
    to.count = 0;
    const StepConstants c = s.stepOf(spec.a, spec.b);
    storeFirstBytes(to, [&](TreePart<kSides<F>>& part) {
      forEachPart<F>([&]<int I, class P>() {
        if (I == at.part) findTreePart<F, I, P>(c, spec, joint, a, b, own, part);
      });
      return part.bytes();
    });
  }
};

/// Records the side of a joint whose body is a parent of the node.
RUBBLE_HD inline void noteCoupling(const TreeNode& node, int side, int n, TreeCoupling& to) {
  for (int t = 0; t < 2; ++t)
    if (n >= 0 && node.parent[t] == n) to.side[t] = side;
}
/// The sides of the joint of an incidence whose bodies are the parents of a node.
template <class F>
RUBBLE_HD TreeCoupling couplingOf(const SolverData& s, const TreeNode& node, const Incidence& incidence) {
  TreeCoupling to{{-1, -1}};
  const int side = jointSide<F>(incidence.code);
  if constexpr (hasFrameBodies<F>()) {
    const JointSpec<F>& spec = s.specsOf<F>()[jointIndex<F>(incidence.code)];
    for (int other = 0; other < kSides<F>; ++other) {
      const int body = bodyOf(spec, other);
      if (other != side && body != bodyOf(spec, side) && isFirstSide(spec, other))
        noteCoupling(node, other, movingNode(s, body), to);
    }
  } else if (incidence.other >= 0) {
    noteCoupling(node, 1 - side, s.nodeOfBody[incidence.other], to);
  }
  return to;
}
template <class F>
RUBBLE_HD RUBBLE_OUT_OF_LINE void accumulateJointOfNode(const SolverData& s, int n,
                                                        const Incidence& incidence, TreeBlock& w) {
  accumulateTreeRows<F>(s.treeRowsOf<F>()[jointIndex<F>(incidence.code)], jointSide<F>(incidence.code),
                        couplingOf<F>(s, s.treeNode[n], incidence), w.h, w.x, w.e);
}

/// Decouples an axis of a body that is fixed or locked.
RUBBLE_HD inline void decouple(TreeBlock& w, int axis) {
  for (int k = 0; k < 6; ++k) {
    if (k != axis) w.h.m[axis][k] = w.h.m[k][axis] = 0;
    w.e[0].m[axis][k] = w.e[1].m[axis][k] = 0;
  }
  w.x.v[axis] = 0;
}

/// Is the body of a node fixed in this solve?
RUBBLE_HD inline bool stands(const SolverData& s, const TreeNode& node) {
  return !isDynamic(s, node.body) || s.treeConverged[node.tree] != 0;
}

/// The block of each body of a tree without its joints: inertia, rows that leave the tree, and contacts
/// within it.
template <class L> struct AssembleTreeBodies {
  static constexpr const char* kStage = "tree rows";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    TreeBlock& w = s.treeWork[n];
    clear(w.h), clear(w.x), clear(w.e[0]), clear(w.e[1]);
    if (stands(s, node)) {
      for (int k = 0; k < 6; ++k) w.h.m[k][k] = 1;
      return;
    }
    const int i = node.body, end = s.incidenceOffset[i + 1];
    Block6 block;
    PointSums<L> points;
    startBlock(s, i, block);
    for (int k = s.incidenceOffset[i]; k < end && constraintType(s.incidence[k].code) == kContactType; ++k) {
      const Real weight = contactWeight(s, s.incidence[k]);
      points.add(s, s.incidence[k].code, weight);
      if (s.rolls) addRolling(s, s.incidence[k].code, block, weight);
    }
    points.addTo(block);
    // rows of deformable objects come last
    for (int k = end; k > s.incidenceOffset[i] && constraintType(s.incidence[k - 1].code) > JointTypes::kSize;
         --k)
      addSoftRows(s, s.incidence[k - 1].code, block);
    addBlock(w.h, w.x, block);
  }
};

/// Adds joints to the diagonal blocks, and to the couplings with the parents of a node.
struct AssembleTreeJoints {
  static constexpr const char* kStage = "tree rows";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (stands(s, node)) return;
    TreeBlock& w = s.treeWork[n];
    for (int k = s.incidenceOffset[node.body]; k < s.incidenceOffset[node.body + 1]; ++k) {
      const Incidence& incidence = s.incidence[k];
      forEachType(JointTypes{}, [&]<class F>() {
        if (constraintType(incidence.code) == typeIndex<F>(JointTypes{}) + 1 && !isLink<F>(incidence.code))
          accumulateJointOfNode<F>(s, n, incidence, w);
      });
    }
    lockAxesOf(s, node, w);
  }
  RUBBLE_HD static void lockAxesOf(const SolverData& s, const TreeNode& node, TreeBlock& w) {
    const int locks = s.target[node.body].locks;
    for (int axis = 0; axis < 6; ++axis)
      if (locks >> axis & 1) decouple(w, axis);
    for (int side = 0; side < 2; ++side) {
      const int far = node.parent[side] >= 0 ? s.target[s.treeNode[node.parent[side]].body].locks : 0;
      for (int axis = 0; axis < 6; ++axis)
        if (far >> axis & 1)
          for (double(&row)[6] : w.e[side].m) row[axis] = 0;
    }
  }
};

/// A kernel over nodes, run over those of one level of the large trees. `begin`: first of them in levelNode.
template <class Kernel> struct InLevel {
  static constexpr const char* kStage = Kernel::kStage;
  int begin;
  RUBBLE_HD void operator()(const SolverData& s, int k) const { Kernel{}(s, s.levelNode[begin + k]); }
};

/// Eliminates a node after its children.
struct EliminateNode {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    for (int child = node.childBegin; child < node.childEnd; ++child) {
      const int from = s.treeChild[child] >> 1, side = s.treeChild[child] & 1;
      const TreeWork& o = s.treeWork[from];
      subtractProduct(w.h, o.e[side], o.w[side]);
      subtractProduct(w.x, o.e[side], o.x);
      const int far = s.treeNode[from].parent[1 - side];
      for (int t = 0; t < 2; ++t)
        if (far >= 0 && node.parent[t] == far) subtractProduct(w.e[t], o.e[side], o.w[1 - side]);
    }
    factor(w.h);
    solveFactored(w.h, w.x);
    for (int t = 0; t < 2; ++t) {
      if (node.parent[t] < 0) continue;
      w.w[t] = w.e[t];
      solveFactored(w.h, w.w[t]);
    }
  }
};

/// Back substitution: the step of a node whose parents are solved. Raises the largest rotation of its tree.
struct SubstituteNode {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    for (int t = 0; t < 2; ++t) {
      if (node.parent[t] < 0) continue;
      const Long6& x = s.treeWork[node.parent[t]].x;
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) w.x.v[i] -= w.w[t].m[i][j] * x.v[j];
    }
    noteRotation(s, node.tree, w.x);
  }
  RUBBLE_HD static void noteRotation(const SolverData& s, int tree, const Long6& x) {
    const Vec6 dx = shorter(x, 1);
    const bool finite = isFinite(dx.lin) && isFinite(dx.ang);
    atomicRaise(&s.treeMaxRotation[tree], floatBits(finite ? length(dx.ang) : kNoRotation));
  }
  /// Stands for a step that is not finite; larger than any rotation [rad].
  static constexpr Real kNoRotation = Real(1e30);
};

/// Share of its step that a tree takes [1]: no body rotates by more than kLargestRotation, and a step that is
/// not finite is rejected.
RUBBLE_HD inline double treeShare(int turnBits) {
  const double turn = static_cast<double>(fromFloatBits(turnBits));
  if (turn >= .5 * static_cast<double>(SubstituteNode::kNoRotation)) return 0;
  return turn > static_cast<double>(kLargestRotation) ? static_cast<double>(kLargestRotation) / turn : 1;
}

/// Applies the steps of the bodies.
struct MoveTrees {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    move(s, n, treeShare(s.treeMaxRotation[s.treeNode[n].tree]));
  }
  RUBBLE_HD static void move(const SolverData& s, int n, double share) {
    const TreeNode& node = s.treeNode[n];
    const int i = node.body;
    if (!isDynamic(s, i) || s.treeConverged[node.tree] || !(share > 0)) return;
    const Pose x = retract({s.dx[i].dp, s.dq[i]}, shorter(s.treeWork[n].x, share));
    s.dq[i] = x.q;
    s.dx[i] = {x.p, 0, logRotation(x.q), 0};
  }
};

/// Solves a small tree in one thread: joints, all levels, and the steps of its bodies.
struct SolveTree {
  static constexpr const char* kStage = "trees";
  RUBBLE_HD void operator()(const SolverData& s, int tree) const {
    const auto [begin, end] = s.smallTree[tree];
    if (begin == end || s.treeConverged[begin]) return;
    for (int n = begin; n < end; ++n) AssembleTreeJoints{}(s, n);
    for (int n = begin; n < end; ++n) EliminateNode{}(s, n);
    for (int n = end - 1; n >= begin; --n) SubstituteNode{}(s, n);
    for (int n = begin; n < end; ++n) MoveTrees{}(s, n);
  }
};

/// Updates the multipliers of joints that the tree has solved exactly. One thread per joint part.
template <class F> struct TakeTreeForces {
  static constexpr const char* kStage = "tree forces";
  static constexpr int kPerJoint = F::Parts::kCount;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PartIndex at = partAt<F>(s, k);
    // couplings with frame bodies are not held exactly, so the tree finds no multipliers for them
    if (hasFrameBodies<F>() || !s.jointsOf<F>()[at.joint].active) return;
    const JointSpec<F>& spec = s.specsOf<F>()[at.joint];
    const int a = movingNode(s, spec.a), b = movingNode(s, spec.b), any = a >= 0 ? a : b;
    if (any < 0 || !isExact(s, s.treeNode[any]) || s.treeConverged[s.treeNode[any].tree]) return;
    const double share = treeShare(s.treeMaxRotation[s.treeNode[any].tree]);
    if (!(share > 0)) return;
    const Long6 still{}, &dxA = a >= 0 ? s.treeWork[a].x : still, &dxB = b >= 0 ? s.treeWork[b].x : still;
    forEachPart<F>([&]<int I, class P>() {
      if (I == at.part)
        takeTreeForces<P>(loadVectorized(s.treeRowsOf<F>()[at.joint].part[I]),
                          partOf<I>(s.jointsOf<F>()[at.joint].parts), dxA, dxB, share);
    });
  }
};

/// Number of solves of trees with limits at the end of the last iteration. A limit that the first solve
/// reaches is held by the next one.
inline constexpr int kLastTreeSolves = 3;
RUBBLE_HD inline int lastTreeSolves(const SolverData& s) { return s.treeLimits != 0 ? kLastTreeSolves : 1; }

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Projection of joints: closes joints of trees that are open at the end of a step by more than at its
/// beginning. It translates bodies without rotation and without change of velocity. Such gaps have two
/// causes:
///
/// Bodies stopped by CCD within a step (fast_bodies.h) stop on the straight line between their positions. The
/// ends of a body that rotates by w move on arcs, which deviate by w^2 r / 8 from that line in the middle of
/// the step. Also, the last Newton step of a tree is linear in rotations, which are large in impacts.
///
///   least  sum_i m_i |e_i|^2 + sum_j k |e_A - e_B + g_j|^2 / 2,     k = kTreeStiffness times the lighter
///          mass of the joint
///
/// e_i: translation of body i; g_j: gap of joint j. The three axes share one scalar elimination in the order
/// of trees.h. Bodies with a locked axis do not move. The center of mass of a free tree does not move either,
/// unless a contact or the limit kClosingWay restricts one of its bodies.
#include <limits>
#include <type_traits>

#include "stages/ccd/islands.h"
#include "stages/trees/trees.h"

namespace rubble::RUBBLE_CORE {

/// Trees with a joint gap above this share of L are projected [1].
inline constexpr Real kOpenGap = Real(1e-3);

/// Distance of the anchors of a joint at the end of the step, less the part of the initial gap that the step
/// leaves uncorrected [m]. 0 for joints that do not hold their anchors, or whose force is at its bound.
template <class F>
RUBBLE_HD RUBBLE_OUT_OF_LINE Vec3 addedGap(const SolverData& s, const JointSpec<F>& spec,
                                           const Joint<F>& joint) {
  Vec3 gap{0, 0, 0};
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (std::is_same_v<P, AnchorRows>) {
      const auto& rows = partOf<I>(joint.parts);
      if (partOf<I>(spec.parts).mode != GroupMode::Hold || rows.state.compliance > Real(0) ||
          !rows.state.keepsMultiplier)
        return;
      const Vec3 load{rows.lambda[0], rows.lambda[1], rows.lambda[2]};
      if (!(length(load) < rows.state.bound * (Real(1) - kAtBound))) return;
      const Pose a = stillPose(s, spec.a, Vec3(jointOrigin(s, spec.a) - jointOrigin(s, spec.b))),
                 b = stillPose(s, spec.b, {0, 0, 0});
      Real c[P::kRows];
      P::constraint(spec.data, joint.memory, a, b, c);
      gap = {c[0] - rows.shift[0], c[1] - rows.shift[1], c[2] - rows.shift[2]};
    }
  });
  return gap;
}

/// The node of a body that the projection may move, -1 if there is none. Bodies that CCD has just stopped at
/// another body do not move.
RUBBLE_HD inline int projectionNode(const SolverData& s, int body) {
  if (body == kWorldBody || !isDynamic(s, body)) return -1;
  if ((s.target[body].locks & 7) != 0 || hasOwnImpact(s, body)) return -1;
  const int node = s.nodeOfBody[body];
  return node >= 0 && s.treeNode[node].exact ? node : -1;
}

/// Largest translation of a body over half its thickness [1]. A larger one could move the body through what
/// supports it. Rows, contacts included, correct the remaining gap.
inline constexpr Real kClosingWay = Real(.5);

template <class F> struct FindTreesToProject {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    if (!spec.isRigid || !active<F>(s, i)) return;
    const int a = projectionNode(s, spec.a), node = a >= 0 ? a : projectionNode(s, spec.b);
    if (node < 0) return;
    const Joint<F>& joint = s.jointsOf<F>()[i];
    const Vec3 gap = addedGap(s, spec, joint);
    s.treeRowsOf<F>()[i].gap = gap;
    const int tree = s.treeNode[node].tree;
    if (!holdsVertices(s, tree) && length(gap) > kOpenGap * joint.length)
      atomicSet(&s.treeNeedsProjection[tree], 1);
  }
};

template <class F>
RUBBLE_HD void accumulateGap(const SolverData& s, const TreeNode& node, int index, int side,
                             ProjectionLink& link) {
  const JointSpec<F>& spec = s.specsOf<F>()[index];
  if (!spec.isRigid || !active<F>(s, index)) return;
  const int other = bodyOf(spec, 1 - side), to = projectionNode(s, other);
  const Real own = s.params[node.body].mass;
  const double k = kTreeStiffness * static_cast<double>(to >= 0 ? min(own, s.params[other].mass) : own);
  const Vec3d gap(s.treeRowsOf<F>()[index].gap);
  link.h += k;
  link.x += (side == 0 ? -k : k) * gap;
  for (int t = 0; t < 2; ++t)
    if (to >= 0 && node.parent[t] == to) link.e[t] -= k;
}

struct AssembleLinks {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink link{1, {0, 0}, {0, 0}, {0, 0, 0}};
    if (projectionNode(s, node.body) == n) {
      link.h = static_cast<double>(s.params[node.body].mass);
      for (int k = s.incidenceOffset[node.body]; k < s.incidenceOffset[node.body + 1]; ++k) {
        const std::uint32_t code = s.incidence[k].code;
        forEachType(JointTypes{}, [&]<class F>() {
          if constexpr (!hasFrameBodies<F>())
            if (constraintType(code) == typeIndex<F>(JointTypes{}) + 1)
              accumulateGap<F>(s, node, jointIndex<F>(code), jointSide<F>(code), link);
        });
      }
    }
    s.projectionLink[n] = link;
  }
};

/// As EliminateNode, for scalars.
struct EliminateLink {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink& link = s.projectionLink[n];
    for (int child = node.childBegin; child < node.childEnd; ++child) {
      const int from = s.treeChild[child] >> 1, side = s.treeChild[child] & 1,
                far = s.treeNode[from].parent[1 - side];
      const ProjectionLink& o = s.projectionLink[from];
      link.h -= o.e[side] * o.w[side];
      link.x -= o.e[side] * o.x;
      for (int t = 0; t < 2; ++t)
        if (far >= 0 && node.parent[t] == far) link.e[t] -= o.e[side] * o.w[1 - side];
    }
    link.x = link.x / link.h;
    for (int t = 0; t < 2; ++t) link.w[t] = link.e[t] / link.h;
  }
};

/// As SubstituteNode, for scalars.
struct SubstituteLink {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink& link = s.projectionLink[n];
    for (int t = 0; t < 2; ++t)
      if (node.parent[t] >= 0) link.x -= link.w[t] * s.projectionLink[node.parent[t]].x;
  }
};

/// Solves a small tree in one thread: assembly and all levels.
struct ProjectTree {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int tree) const {
    const auto [begin, end] = s.smallTree[tree];
    if (begin == end || s.treeNeedsProjection[begin] == 0) return;
    for (int n = begin; n < end; ++n) AssembleLinks{}(s, n);
    for (int n = begin; n < end; ++n) EliminateLink{}(s, n);
    for (int n = end - 1; n >= begin; --n) SubstituteLink{}(s, n);
  }
};

/// Distance by which a body may approach the other body of a contact [m]. If both are dynamic, each gets half
/// of the gap.
RUBBLE_HD inline Real roomBefore(const SolverData& s, const ContactRows& r) {
  const Manifold& m = s.manifold[r.manifold];
  const Vec3 t = centerDistance(s, r.a, r.b);
  Real deepest = -std::numeric_limits<Real>::max();
  for (int k = 0; k < m.count; ++k)
    deepest = max(deepest, pointAt(m, k, r.n, s.orientation[r.a], s.orientation[r.b], t).depth);
  return max(-deepest, Real(0)) * (isDynamic(s, r.a) && isDynamic(s, r.b) ? Real(.5) : Real(1));
}

/// Clips a translation of a body by its contacts so that it does not enter what it touches.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Vec3 keptOut(const SolverData& s, int body, Vec3 way) {
  constexpr int kPasses = 2;                    // sliding along one contact may run into another
  const Real slack = Real(1e-4) * length(way);  // above the round-off of the subtraction
  for (int pass = 0; pass <= kPasses; ++pass)
    for (int k = s.incidenceOffset[body]; k < s.incidenceOffset[body + 1]; ++k) {
      const std::uint32_t code = s.incidence[k].code;
      if (constraintType(code) != kContactType) continue;
      const ContactRows& r = s.contact[constraintIndex(code)];
      const Vec3 out = constraintSide(code) == 0 ? -r.n : r.n;
      const Real excess = -dot(way, out) - roomBefore(s, r);
      if (!(excess > slack)) continue;
      if (pass == kPasses) return {0, 0, 0};
      way += excess * out;
    }
  return way;
}

/// Limits the translation of a body. All bodies still have their uncorrected positions.
struct LimitProjection {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    Vec3d& x = s.projectionLink[n].x;
    if (projectionNode(s, node.body) != n || !isFinite(Vec3(x))) {
      x = {0, 0, 0};
      return;
    }
    const Real most = kClosingWay * innerRadiusOf(s.shapeTables(), s.params[node.body].shape);
    const Real way = length(Vec3(x));
    x = Vec3d(keptOut(s, node.body, Vec3(x) * (way > most ? most / way : Real(1))));
  }
};
struct ApplyProjection {
  static constexpr const char* kStage = "joint projection";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    const Vec3d x = s.projectionLink[n].x;
    if (x == Vec3d{0, 0, 0}) return;
    s.position[node.body] += x;
    // keeps the stored displacement of the step consistent
    (s.ccdShareBits[node.body] != 0 ? s.ccdMotion : s.dx)[node.body].dp += Vec3(x);
  }
};

}  // namespace rubble::RUBBLE_CORE

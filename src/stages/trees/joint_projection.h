#pragma once
/// Joints of trees that are open at the end of a step, beyond what they inherited, are closed by moving
/// bodies without turning them, and without a change of velocity. Two things open them. Bodies that stop in
/// the middle of a step (fast_bodies.h) stop on the straight line between their places, while the ends of one
/// that turns by w go on arcs, w^2 r / 8 beside it in the middle of the step. And the last Newton step of a
/// tree is linear in rotations, which are large where limbs are struck.
///
///   least  sum_i m_i |e_i|^2 + sum_j k |e_A - e_B + g_j|^2 / 2,     k = kTreeStiffness times the lighter
///          mass of the joint
///
/// e_i: motion of body i, g_j: what joint j is open by. Its three axes are one and the same elimination of
/// numbers, in the order of trees.h, and what is held by the world, or with an axis locked, stays. The centre
/// of mass of a free tree stays where it is, unless a contact or a limit holds a body of it back.
#include <limits>
#include <type_traits>

#include "stages/ccd/assembly_stops.h"
#include "stages/trees/trees.h"

namespace rubble::RUBBLE_CORE {

/// Trees with a joint open by more than this share of L are closed [1].
inline constexpr Real kOpenGap = Real(1e-3);

/// How far the anchors of a joint are apart at the end of the step, less what was left alone of the gap that
/// it began with [m]; 0 where they are not held, or with a force at its bound.
template <class F>
RUBBLE_HD RUBBLE_APART Vec3 addedGap(const SolverData& s, const JointSpec<F>& spec, const Joint<F>& joint) {
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

/// The node of a body that closing may move, -1: none. One that has just stopped at another stays there.
RUBBLE_HD inline int projectionNode(const SolverData& s, int body) {
  if (body == kWorldBody || !isDynamic(s, body)) return -1;
  if ((s.target[body].locks & 7) != 0 || hasMet(s, body)) return -1;
  const int node = s.nodeOfBody[body];
  return node >= 0 && s.treeNode[node].exact ? node : -1;
}

/// A body is moved by no more than this share of half its thickness [1]: further it could leave what holds
/// it. Rows close the rest, contacts among them.
inline constexpr Real kClosingWay = Real(.5);

template <class F> struct FindTreesToProject {
  static constexpr const char* kStage = "closing";
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
  static constexpr const char* kStage = "closing";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink link{1, {0, 0}, {0, 0}, {0, 0, 0}};
    if (projectionNode(s, node.body) == n) {
      link.h = static_cast<double>(s.params[node.body].mass);
      for (int k = s.incidenceOffset[node.body]; k < s.incidenceOffset[node.body + 1]; ++k) {
        const std::uint32_t code = s.incidence[k].code;
        forEachType(JointTypes{}, [&]<class F>() {
          if constexpr (!isCarried<F>())
            if (constraintType(code) == typeIndex<F>(JointTypes{}) + 1)
              accumulateGap<F>(s, node, jointIndex<F>(code), jointSide<F>(code), link);
        });
      }
    }
    s.projectionLink[n] = link;
  }
};

/// As EliminateNode.
struct EliminateLink {
  static constexpr const char* kStage = "closing";
  int begin;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const TreeNode& node = s.treeNode[begin + k];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink& link = s.projectionLink[begin + k];
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

/// As SubstituteNode.
struct SubstituteLink {
  static constexpr const char* kStage = "closing";
  int begin;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const TreeNode& node = s.treeNode[begin + k];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    ProjectionLink& link = s.projectionLink[begin + k];
    for (int t = 0; t < 2; ++t)
      if (node.parent[t] >= 0) link.x -= link.w[t] * s.projectionLink[node.parent[t]].x;
  }
};

/// All rounds of a small tree.
struct ProjectTree {
  static constexpr const char* kStage = "closing";
  RUBBLE_HD void operator()(const SolverData& s, int tree) const {
    const int begin = s.treeOffset[tree], end = s.treeOffset[tree + 1];
    if (s.treeNeedsProjection[s.treeNode[s.treeMember[begin]].tree] == 0) return;
    for (int k = begin; k < end; ++k) AssembleLinks{}(s, s.treeMember[k]);
    for (int k = begin; k < end; ++k) EliminateLink{0}(s, s.treeMember[k]);
    for (int k = end - 1; k >= begin; --k) SubstituteLink{0}(s, s.treeMember[k]);
  }
};

/// How far a body may go into the other one of a contact; of a gap between two that move each has half. [m]
RUBBLE_HD inline Real roomBefore(const SolverData& s, const ContactRows& r) {
  const Manifold& m = s.manifold[r.manifold];
  const Vec3 t = centreDistance(s, r.a, r.b);
  Real deepest = -std::numeric_limits<Real>::max();
  for (int k = 0; k < m.count; ++k)
    deepest = max(deepest, pointAt(m, k, r.n, s.orientation[r.a], s.orientation[r.b], t).depth);
  return max(-deepest, Real(0)) * (isDynamic(s, r.a) && isDynamic(s, r.b) ? Real(.5) : Real(1));
}

/// What the contacts of a body leave of a way: into what it touches it does not go.
RUBBLE_HD RUBBLE_APART inline Vec3 keptOut(const SolverData& s, int body, Vec3 way) {
  constexpr int kPasses = 2;                    // what one contact turns aside another one may have to stop
  const Real slack = Real(1e-4) * length(way);  // more than the round-off of what is taken away
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

/// How far a body of a tree is moved: all are still where they were.
struct LimitProjection {
  static constexpr const char* kStage = "closing";
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
  static constexpr const char* kStage = "closing";
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (s.treeNeedsProjection[node.tree] == 0) return;
    const Vec3d x = s.projectionLink[n].x;
    // a body may have several nodes, of which one moves it
    if (x == Vec3d{0, 0, 0}) return;
    s.position[node.body] += x;
    // the way that it has made in the step
    (s.stopBits[node.body] != 0 ? s.ccdMotion : s.dx)[node.body].dp += Vec3(x);
  }
};

}  // namespace rubble::RUBBLE_CORE

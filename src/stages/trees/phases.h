#pragma once
/// Joint trees: all bodies connected by joints form one block.
#include "stages/executor.h"
#include "stages/trees/joint_projection.h"
#include "stages/trees/trees.h"

namespace rubble::RUBBLE_CORE::trees {

/// Number of nodes that trees solve in this step.
inline int nodesOf(const SolverData& s) { return s.plan.jointTrees ? s.treeNodes : 0; }
/// Nodes of one level of the large trees.
inline int nodesAt(const SolverData& s, int level) { return s.levelBegin[level + 1] - s.levelBegin[level]; }
inline int largeNodes(const SolverData& s) { return s.levelBegin[kTreeLevels]; }

template <Executor E> void clear(E& e) {
  const int nodes = nodesOf(e.view());
  e.clear(&SolverData::treeContacts, nodes);
  e.clear(&SolverData::treeNeedsProjection, nodes);
}

/// Finds the trees that touch other bodies.
template <Executor E> void prepare(E& e) {
  if (nodesOf(e.view()) > 0) e.forEach(MarkTouchedTrees{}, &Counters::manifolds);
}

/// Finds the trees that touch deformable objects, once incidence lists exist.
template <Executor E> void findSoftTrees(E& e) {
  if (e.view().vertices > 0) e.forEach(MarkSoftTrees{}, nodesOf(e.view()));
}

/// One solve of all trees. Trees with contacts are solved exactly only if no other block moves their bodies
/// afterwards. `atRest`: of BeginTrees.
template <Executor E> void solveOnce(E& e, TreeSolve how, TreesOf of, Real atRest = 0) {
  const SolverData& s = e.view();
  e.forEach(BeginTrees{how, of, atRest}, s.treeNodes);
  forEachJoint<FindTreeRows>(e, how);
  e.beside(AssembleTreeBodies<typename E::Lane>{}, s.treeNodes);
  e.forEach(SolveTree{}, s.smallTrees);
  e.forEach(InLevel<AssembleTreeJoints>{0}, largeNodes(s));
  for (int r = 0; r < s.treeLevels; ++r) e.forEach(InLevel<EliminateNode>{s.levelBegin[r]}, nodesAt(s, r));
  for (int r = s.treeLevels; r-- > 0;) e.forEach(InLevel<SubstituteNode>{s.levelBegin[r]}, nodesAt(s, r));
  e.forEach(InLevel<MoveTrees>{0}, largeNodes(s));
  if (how != TreeSolve::Again) forEachJoint<TakeTreeForces>(e);
}

/// One solve before the sweep over bodies. In the last iteration only the trees attached to deformable
/// objects.
template <Executor E> void solve(E& e, bool last) {
  if (nodesOf(e.view()) == 0) return;
  if (!last)
    solveOnce(e, TreeSolve::Own, TreesOf::Any);
  else if (e.view().attachments > 0)
    solveOnce(e, TreeSolve::Own, TreesOf::Attached);
}

/// The solves of all other trees, after the last sweep.
template <Executor E> void solveLast(E& e) {
  if (nodesOf(e.view()) == 0) return;
  solveOnce(e, TreeSolve::Exact, TreesOf::Rest);
  for (int k = 1; k < lastTreeSolves(e.view()); ++k)
    solveOnce(e, TreeSolve::Again, TreesOf::Rest, k == 1 ? kTreeAtRest : kTreeSettled);
}

/// Projects joints that are open at the end of the step.
template <Executor E> void finish(E& e) {
  const SolverData& s = e.view();
  const int nodes = nodesOf(s);
  if (nodes == 0) return;
  forEachJoint<FindTreesToProject>(e);
  e.forEach(ProjectTree{}, s.smallTrees);
  e.forEach(InLevel<AssembleLinks>{0}, largeNodes(s));
  for (int r = 0; r < s.treeLevels; ++r) e.forEach(InLevel<EliminateLink>{s.levelBegin[r]}, nodesAt(s, r));
  for (int r = s.treeLevels; r-- > 0;) e.forEach(InLevel<SubstituteLink>{s.levelBegin[r]}, nodesAt(s, r));
  e.forEach(LimitProjection{}, nodes);
  e.forEach(ApplyProjection{}, nodes);
}

}  // namespace rubble::RUBBLE_CORE::trees

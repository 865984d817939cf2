#pragma once
/// The coarse correction: block descent on rigid motions of aggregates.
#include "stages/coarse/coarse.h"
#include "stages/coarse/soft_nodes.h"
#include "stages/executor.h"
#include "stages/joints/phases.h"

namespace rubble::RUBBLE_CORE::coarse {

/// Runs a kernel over contacts and attachments of vertices, as constraints that connect nodes of aggregates.
template <template <class> class Kernel, Executor E, class... Args>
void forEachSoftBlock(E& e, Args... args) {
  e.forEach(Kernel<PointContactBlocks>{args...}, &Counters::pointPairs);
  e.forEach(Kernel<AttachmentBlocks>{args...}, e.view().attachments);
}

template <Executor E> void clear(E& e) {
  const SolverData& s = e.view();
  if (s.plan.coarseCorrection) e.clear(&SolverData::nodeCount, s.nodes() * kCoarseLevels);
}

/// Finds the aggregates from the poses at x^t: the number of that of each node.
template <Executor E> void findAggregates(E& e) {
  const SolverData& s = e.view();
  if (!s.plan.coarseCorrection) return;
  const int nodes = s.nodes(), all = nodes * kCoarseLevels;
  const bool softNodes = s.softNodes > 0;
  e.beside(StartAggregates{}, nodes);
  if (softNodes) forEachSoftBlock<FindJoinLevels>(e);
  for (int level = 0; level < kCoarseLevels; ++level) {
    e.forEach(JoinAggregates<ContactBlocks>{level}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() {
      e.beside(JoinAggregates<JointBlocks<F>>{level}, s.joints[typeIndex<F>(JointTypes{})]);
    });
    if (softNodes) forEachSoftBlock<JoinSoftNodes>(e, level);
    e.forEach(FlattenAggregates{level}, nodes);
  }
  e.forEach(FindRoots{}, all);
  e.scan(&SolverData::isRoot, &SolverData::aggregateIndex, all, &Counters::aggregates, Per::Aggregate);
  e.forEach(NumberAggregates{}, all);
  if (s.vertices > 0) forEachSoftBlock<FindDepths>(e);
}

/// Lists the nodes of the aggregates, and finds their centers and inertia.
template <Executor E> void listAggregates(E& e) {
  const SolverData& s = e.view();
  if (!s.plan.coarseCorrection) return;
  const int all = s.nodes() * kCoarseLevels;
  e.groupByKey(StartAggregates::kStage, &SolverData::aggregateOf, all, &SolverData::aggregateOffset,
               &SolverData::aggregateNode, &Counters::aggregates);
  e.scan(&SolverData::aggregateSlices, &SolverData::sliceOffset, &Counters::aggregates, &Counters::slices,
         Per::Slice);
  e.forEach(FindLevels{}, kCoarseLevels + 1);
  e.forEach(BeginAggregates{}, &Counters::aggregates);
  e.forEach(MakeSlices{}, &Counters::slices);
  if (s.locked) e.forEach(LockAggregates{}, all);
  forEachJoint<MarkJointedAggregates>(e);
  e.forEach(SumInertia{}, &Counters::slices);
  e.forEach(PlaceAggregates{}, &Counters::aggregates);
}

/// Finds the boundary constraints of the aggregates from the incidence lists.
template <Executor E> void findBoundaries(E& e) {
  if (!e.view().plan.coarseCorrection) return;
  e.forEach(CountBoundary{}, &Counters::slices);
  e.scan(&SolverData::boundaryCount, &SolverData::boundaryOffset, &Counters::slices, &Counters::boundary,
         Per::Boundary);
  e.forEach(FillBoundary{}, &Counters::slices);
}

/// Sums what soft nodes contribute to the aggregates of a level.
template <Executor E> void sumSoftNodes(E& e, int level) {
  if (e.view().objects > 0) e.forEach(SumSoftNodePart{level}, e.view().clusterBegin[1]);
  e.forEach(SumSoftNode{level}, e.view().softNodes);
}

/// One step of the aggregates of a level: of all, or only of those `With` soft nodes.
template <class Stage> using WithAny = Stage;
template <template <class> class With, Executor E> void solveLevel(E& e, int level) {
  const bool softNodes = e.view().softNodes > 0;
  if (softNodes) sumSoftNodes(e, level);
  e.forEachIn(With<SumSlice<typename E::Lane>>{}, &SolverData::levelSlice, level);
  e.forEachIn(With<SolveAggregate>{}, &SolverData::levelAggregate, level);
  e.forEachIn(With<MoveSlice>{}, &SolverData::levelSlice, level);
  if (softNodes) e.forEach(MoveSoftNodes{level}, e.view().vertices);
}

/// One sweep over the aggregates, from coarse to fine. Even iterations sweep all levels but the finest, odd
/// ones the fine levels.
template <Executor E> void solve(E& e, int iteration) {
  if (!e.view().plan.coarseCorrection) return;
  if (iteration == 0) joints::linearize(e);
  const bool even = iteration % 2 == 0;
  for (int level = (even ? kCoarseLevels : kFineLevels) - 1; level >= (even ? 1 : 0); --level)
    solveLevel<WithAny>(e, level);
}

/// Gives aggregates with soft nodes the momentum of the forces on them. It differs after the last sweep, so
/// they take one more step at all levels, and another one at the coarsest, because a step is under-relaxed.
template <Executor E> void keepMomentum(E& e) {
  if (!e.view().plan.coarseCorrection || e.view().softNodes == 0) return;
  for (int level = kCoarseLevels - 1; level >= 0; --level) solveLevel<WithSoftNodes>(e, level);
  solveLevel<WithSoftNodes>(e, kCoarseLevels - 1);
}

}  // namespace rubble::RUBBLE_CORE::coarse

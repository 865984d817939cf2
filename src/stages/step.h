#pragma once
/// The step on one page: algorithm 1 of the method, written once over an Executor. What runs in parallel, and where, is its business.
#include "stages/assembly_stops.h"
#include "stages/bounce.h"
#include "stages/closing.h"
#include "stages/coarse.h"
#include "stages/coloring.h"
#include "stages/island_momentum.h"
#include "stages/late_stops.h"
#include "stages/rare_contacts.h"
#include "stages/rare_stops.h"
#include "stages/sleep.h"
#include "stages/soft_step.h"
#include "stages/trees.h"
#include "stages/turns.h"

namespace rubble::RUBBLE_CORE {

/// What an executor offers. A kernel is a functor f(View, index); `Counter` is a field of Counters.
///
///   forEach(kernel, n)                      n known before the step: bodies, joints
///   forEach(kernel, counter)                n counted in this step
///   beside(kernel, n or counter)            as forEach, for a kernel that has nothing to do with the one before it, nor with one that stands beside that
///   forEachIn(kernel, offsets, k)           the range [offsets[k], offsets[k + 1])
///   clear(array, n)                         zeros
///   scan(counts, offsets, n[, counter, per])  exclusive sums, the total behind the last one and in the counter, and room for that many
///   group(keys, n, offsets, order, counter) indices modulo members() by key, ascending; keys below 0 are left out; the counter has the number of keys.
///                                           No key is found at two levels: index / members()
///   require(per, counter)                   room for that many before they are written: nothing is dropped
///   rounds(take, propose, counter, left, turn)  takes turns of two kernels over as many as are counted, until `propose` leaves `left` at
///                                           zero; `turn` counts them
///   forEachColor(kernel, vertexKernel)      colour by colour, over its bodies and its vertices
///   lodgeRows()                             contact rows take the place of the old manifolds
///   keepManifolds()                         manifolds of this step are the old ones of the next
///   Lane                                    Real or Real4: points that one call treats side by side
template <class E>
concept Executor = requires(E e, View& v) {
  typename E::Lane;
  e.forEach(PredictBodies{}, 1);
  e.forEach(BuildContactRows{}, &Counters::pairs);
  e.clear(&View::pairCount, 1);
  e.scan(&View::pairCount, &View::pairOffset, 1, &Counters::pairs, Per::Pair);
  e.require(Per::Color, &Counters::colors);
  e.rounds(TakeColors{}, ProposeColors{}, &Counters::clashing, &Counters::clashes, &Counters::rounds);
  e.forEachColor(SolveBody<typename E::Lane>{}, SolveVertex{});
  e.forEachIn(SolveGroup{}, &View::levelGroup, 0);
  e.group(&View::groupOf, 1, &View::memberOffset, &View::member, &Counters::groups);
};

/// Kernel over the joints of every type, which do not wait for one another: over each joint, or over so many of its parts as it says by `kPerJoint`
/// (stages/joints.h).
template <template <class> class Kernel, Executor E, class... Args>
void forEachJoint(E& e, Args... args) {
  bool first = true;
  forEachType(JointTypes{}, [&]<class F>() {
    int elements = e.view().joints[typeIndex<F>(JointTypes{})];
    if constexpr (requires { Kernel<F>::kPerJoint; }) elements *= Kernel<F>::kPerJoint;
    if (elements == 0) return;
    if (first) e.forEach(Kernel<F>{args...}, elements);
    else e.beside(Kernel<F>{args...}, elements);
    first = false;
  });
}

template <Executor E>
void findPairs(E& e) {
  const int bodies = e.view().bodies, cells = e.view().cells;
  e.clear(&View::bucketCount, cells);
  e.forEach(ComputeBounds{}, bodies);
  e.scan(&View::bucketCount, &View::bucketOffset, cells);
  e.forEach(FillGrid{}, bodies);
  const bool parts = e.view().rareShapes;
  e.clear(&View::pairCount, bodies);
  e.forEach(FindNeighbors{}, bodies);
  if (parts) e.forEach(FindPairs<true>{}, bodies);
  else e.forEach(FindPairs<false>{}, bodies);
  e.scan(&View::pairCount, &View::pairOffset, bodies, &Counters::pairs, Per::Pair);
  if (parts) e.forEach(WritePairs<true>{}, bodies);
  else e.forEach(WritePairs<false>{}, bodies);
}

/// Islands that something disturbs.
template <Executor E>
void wakeIslands(E& e) {
  const int bodies = e.view().bodies;
  e.clear(&View::islandFlag, bodies);
  e.forEach(WakeByForces{}, bodies);
  e.forEach(WakeByPairs{}, &Counters::pairs);
  if (e.view().vertices > 0) forEachSoftNeighbor<WakeBySoft>(e);
  forEachJoint<WakeByJoints>(e);
  e.forEach(WakeBodies{}, bodies);
}

/// Islands that have come to rest.
template <Executor E>
void sleepIslands(E& e) {
  const int bodies = e.view().bodies;
  e.clear(&View::islandFlag, bodies);
  e.forEach(StartIslands{}, bodies);
  e.forEach(JoinIslandsByPairs{}, &Counters::pairs);
  forEachJoint<JoinIslandsByJoints>(e);
  e.forEach(FindRestless{}, bodies);
  e.forEach(FindMovedIslands{}, &Counters::pairs);
  if (e.view().vertices > 0) forEachSoftNeighbor<KeepAwakeBySoft>(e);
  e.forEach(FallAsleep{}, bodies);
}

template <Executor E>
void findContacts(E& e) {
  e.clear(&View::agitation, e.view().bodies);
  e.forEach(FindAgitation{}, &Counters::pairs);
  e.forEach(FindNearPairs{}, &Counters::pairs);
  e.forEach(TestFreshPairs{}, &Counters::freshPairs);
  e.scan(&View::isNear, &View::nearPairOffset, &Counters::pairs, &Counters::nearPairs, Per::NearPair);
  e.forEach(ListNearPairs{}, &Counters::pairs);
  e.forEach(RecycleManifolds{}, &Counters::nearPairs);
  e.forEach(TestPairs{}, &Counters::tested);
  if (e.view().rareShapes) e.forEach(TestRarePairs{}, &Counters::tested);
  e.scan(&View::hasRows, &View::rowOffset, &Counters::nearPairs, &Counters::manifolds, Per::Manifold);
  if (e.view().rolls) {
    e.forEach(CountRolling{}, 1);
    e.require(Per::Rolling, &Counters::rollers);
    e.forEach(BuildRolling{}, &Counters::rollers);
  }
  e.lodgeRows();
  e.forEach(BuildContactRows{}, &Counters::nearPairs);
  if (e.view().bounces) {
    e.forEach(CountBounces{}, 1);
    e.require(Per::Bounce, &Counters::bounceRows);
  }
}

/// Groups of the coarse correction, from the poses at x^t.
template <Executor E>
void findGroups(E& e) {
  const int members = e.view().members(), all = members * kCoarseLevels;
  const bool lumps = e.view().lumps > 0;
  e.clear(&View::memberCount, all);
  e.forEach(StartGroups{}, members);
  if (lumps) forEachSoftBlock<FindJoinLevels>(e);
  for (int level = 0; level < kCoarseLevels; ++level) {
    e.forEach(JoinGroups<ContactBlocks>{level}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() { e.beside(JoinGroups<JointBlocks<F>>{level}, e.view().joints[typeIndex<F>(JointTypes{})]); });
    if (lumps) forEachSoftBlock<JoinLumps>(e, level);
    e.forEach(FlattenGroups{level}, members);
  }
  e.forEach(FindLeaders{}, all);
  e.scan(&View::leads, &View::groupIndex, all, &Counters::groups, Per::Group);
  e.forEach(NumberGroups{}, all);
  if (e.view().vertices > 0) forEachSoftBlock<FindDepths>(e);
  e.group(&View::groupOf, all, &View::memberOffset, &View::member, &Counters::groups);
  e.scan(&View::groupChunks, &View::chunkOffset, &Counters::groups, &Counters::chunks, Per::Chunk);
  e.forEach(FindLevels{}, kCoarseLevels + 1);
  e.forEach(BeginGroups{}, &Counters::groups);
  e.forEach(MakeChunks{}, &Counters::chunks);
  if (e.view().locked) e.forEach(LockGroups{}, all);
  forEachJoint<MarkJoinedGroups>(e);
}

/// Their centres and inertia, and the rows that leave them.
template <Executor E>
void prepareGroups(E& e) {
  e.forEach(SumInertia{}, &Counters::chunks);
  e.forEach(PlaceGroups{}, &Counters::groups);
  e.forEach(CountExternals{}, &Counters::chunks);
  e.scan(&View::externalCount, &View::externalOffset, &Counters::chunks, &Counters::externals, Per::External);
  e.forEach(FillExternals{}, &Counters::chunks);
}

/// One step of the groups of a level: of all, or of those `With` lumps.
template <class Stage>
using WithAny = Stage;
template <template <class> class With, Executor E>
void correctLevel(E& e, int level) {
  const bool lumps = e.view().lumps > 0;
  if (lumps) sumLumps(e, level);
  e.forEachIn(With<SumChunk<typename E::Lane>>{}, &View::levelChunk, level);
  e.forEachIn(With<SolveGroup>{}, &View::levelGroup, level);
  e.forEachIn(With<MoveChunk>{}, &View::levelChunk, level);
  if (lumps) e.forEach(MoveLumps{level}, e.view().vertices);
}
/// One sweep over the groups, from coarse to fine: all levels but the finest in even iterations, the fine ones in odd.
template <Executor E>
void correctGroups(E& e, int iteration) {
  const bool even = iteration % 2 == 0;
  for (int level = (even ? kCoarseLevels : kFineLevels) - 1; level >= (even ? 1 : 0); --level) correctLevel<WithAny>(e, level);
}

/// The last sweep leaves groups with lumps at another momentum than what acts on them gives them: one more step of these groups, at all levels, and
/// another one of the largest, since a step goes four fifths of the way.
template <Executor E>
void keepMomentum(E& e) {
  for (int level = kCoarseLevels - 1; level >= 0; --level) correctLevel<WithLumps>(e, level);
  correctLevel<WithLumps>(e, kCoarseLevels - 1);
}

/// One step of all bodies that hang together by joints. Trees with contacts are solved exactly where no other block moves their bodies afterwards.
template <Executor E>
void correctTrees(E& e, TreeSolve how, TreesOf of) {
  const View& s = e.view();
  const int nodes = treeNodes(s);
  e.forEach(BeginTrees{how, of}, nodes);
  forEachJoint<FindTreeRows>(e, how);
  e.beside(AssembleTreeBodies<typename E::Lane>{}, nodes);
  if (s.smallTrees) {
    e.forEach(SolveTree{}, s.trees);
  } else {
    e.forEach(AssembleTreeJoints{}, nodes);
    for (int r = 0; r < s.treeRounds; ++r) e.forEach(EliminateNode{s.treeBegin[r]}, s.treeBegin[r + 1] - s.treeBegin[r]);
    for (int r = s.treeRounds - 1; r >= 0; --r) e.forEach(SubstituteNode{s.treeBegin[r]}, s.treeBegin[r + 1] - s.treeBegin[r]);
    e.forEach(MoveTrees{}, nodes);
  }
  if (how != TreeSolve::Again)
    forEachJoint<TakeTreeForces>(e);
}

/// Joints that are open at the end of the step.
template <Executor E>
void closeTrees(E& e) {
  const View& s = e.view();
  const int nodes = treeNodes(s);
  e.clear(&View::treeOpen, nodes);
  forEachJoint<FindOpenTrees>(e);
  if (s.smallTrees) {
    e.forEach(CloseTree{}, s.trees);
  } else {
    e.forEach(AssembleLinks{}, nodes);
    const auto inRound = [&](int r) { return s.treeBegin[r + 1] - s.treeBegin[r]; };
    for (int r = 0; r < s.treeRounds; ++r) e.forEach(EliminateLink{s.treeBegin[r]}, inRound(r));
    for (int r = s.treeRounds - 1; r >= 0; --r) e.forEach(SubstituteLink{s.treeBegin[r]}, inRound(r));
  }
  e.forEach(LimitClosing{}, nodes);
  e.forEach(MoveClosed{}, nodes);
}

template <Executor E>
void findIncidence(E& e) {
  const int bodies = e.view().bodies;
  const auto forEachBlock = [&]<template <class> class Kernel>() {
    e.forEach(Kernel<ContactBlocks>{}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() { e.beside(Kernel<JointBlocks<F>>{}, e.view().joints[typeIndex<F>(JointTypes{})]); });
  };
  const bool soft = e.view().vertices > 0;
  e.clear(&View::entryCount, bodies);
  forEachBlock.template operator()<CountEntries>();
  if (soft) countSoftEntries(e);
  e.scan(&View::entryCount, &View::entryOffset, bodies, &Counters::entries, Per::Entry);
  forEachBlock.template operator()<FillEntries>();
  if (soft) fillSoftEntries(e);
  e.forEach(SortEntries{}, bodies);
}

template <Executor E>
void colorNodes(E& e) {
  const int bodies = e.view().bodies, vertices = e.view().vertices;
  e.forEach(FindClashes{}, bodies);
  e.forEach(FindVertexClashes{}, vertices);
  e.rounds(TakeColors{}, ProposeColors{}, &Counters::clashing, &Counters::clashes, &Counters::rounds);
  e.require(Per::Color, &Counters::colors);
  e.clear(&View::colorCount, &Counters::colors);
  e.forEach(CountColors{}, bodies);
  e.scan(&View::colorCount, &View::colorOffset, &Counters::colors);
  e.forEach(FillColors{}, bodies);
  if (vertices > 0) listVertexColors(e);
}

/// Fast bodies stop where they meet others.
template <Executor E>
void stopFastBodies(E& e) {
  e.forEach(FindFast{}, e.view().bodies);
  e.require(Per::Pair, &Counters::swept);
  const bool joints = e.view().hasJoints();
  if (joints) {
    e.forEach(StartAssemblies{}, e.view().bodies);
    forEachJoint<JoinAssemblies>(e);
  }
  for (int round = 0; round < kStopRounds; ++round) {
    if (round > 0) e.forEach(NoteStops{round}, e.view().bodies);
    e.forEach(FindStops{round}, &Counters::swept);
    if (e.view().rareShapes) e.forEach(FindRareStops{round}, &Counters::swept);
    if (round == 0) e.forEach(FindLateStops{}, e.view().bodies);
  }
  if (joints) {
    e.forEach(RaiseStops{}, e.view().bodies);
    e.forEach(StopAssemblies{}, e.view().bodies);
  }
  e.forEach(ChooseStops{}, &Counters::swept);
  e.forEach(StopBodies{}, &Counters::swept);
  e.forEach(StopLateBodies{}, e.view().bodies);
}

/// Islands that nothing holds get back what they are short of.
template <Executor E>
void keepIslandMomenta(E& e) {
  const int bodies = e.view().bodies;
  const bool groups = e.view().step.coarseCorrection;
  if (!groups) e.forEach(StartIslandForest{}, bodies);
  e.forEach(JoinMomentumIslands{}, bodies);
  e.forEach(FindMomentumIslands{}, bodies);
  e.forEach(NumberFreeIslands{}, bodies);
  e.require(Per::FreeIsland, &Counters::freeIslands);
  e.forEach(BeginFreeIslands{}, bodies);
  e.forEach(MeasureMomenta{}, bodies);
  e.forEach(SumMomenta{}, bodies);
  e.forEach(RepairIslands{}, &Counters::freeIslands);
  e.forEach(RepairBodies{}, bodies);
}

/// One step of dt. Everything before the iterations happens at x^t and moves no body beyond its initial guess.
template <Executor E>
void step(E& e) {
  using L = typename E::Lane;
  const int bodies = e.view().bodies, vertices = e.view().vertices;

  e.forEach(PredictBodies{}, bodies);
  findPairs(e);
  if (vertices > 0) findVertexPairs(e);
  if (e.view().step.sleeping) wakeIslands(e);
  findContacts(e);
  forEachJoint<BeginJoints>(e);
  if (vertices > 0) beginVertices(e);
  const int nodes = e.view().step.jointTrees ? treeNodes(e.view()) : 0;
  if (nodes > 0) {
    e.clear(&View::treeTouched, nodes);
    e.forEach(MarkTouchedTrees{}, &Counters::manifolds);
  }
  if (e.view().step.coarseCorrection) findGroups(e);
  findIncidence(e);
  if (nodes > 0 && vertices > 0) e.forEach(MarkSoftTrees{}, nodes);
  colorNodes(e);
  e.forEach(PredictVertices{}, vertices);
  if (vertices > 0) e.forEach(MarkDormantPoints{}, &Counters::pointPairs);
  if (e.view().step.coarseCorrection) prepareGroups(e);
  if (e.view().step.coarseCorrection && vertices > 0) placeClusters(e);

  const bool lines = e.view().step.jointTrees && e.view().lines > 0;
  for (int n = 0; n < e.view().step.iterations; ++n) {
    if (n == 0 && e.view().step.coarseCorrection) forEachJoint<LinearizeTurns>(e);
    if (e.view().step.coarseCorrection) correctGroups(e, n);
    if (e.view().step.coarseCorrection && vertices > 0) correctClusters(e);
    const bool last = n + 1 == e.view().step.iterations;
    if (nodes > 0 && !last) correctTrees(e, TreeSolve::Own, TreesOf::Any);
    if (nodes > 0 && last && vertices > 0) correctTrees(e, TreeSolve::Own, TreesOf::Deformables);
    if (lines) correctLines(e);
    forEachJoint<LinearizeTurns>(e);
    e.forEachColor(SolveBody<L>{}, SolveVertex{});
    if (!last && accelerates(e)) e.forEach(AccelerateVertices{n, accelerationOf(e.view().step.acceleration, n)}, vertices);
    if (last && e.view().step.coarseCorrection && e.view().lumps > 0) keepMomentum(e);
    for (int k = 0; last && nodes > 0 && k < lastTreeSolves(e.view()); ++k)
      correctTrees(e, k == 0 ? TreeSolve::Exact : TreeSolve::Again, TreesOf::Rest);
    if (!last) e.forEach(UpdateContactDuals<L>{}, &Counters::manifolds);
    else e.forEach(FinishContacts<L>{}, &Counters::manifolds);
    if (e.view().rolls) e.forEach(UpdateRollingDuals{}, &Counters::manifolds);
    forEachJoint<UpdateJointDuals>(e);
    if (vertices > 0) updateSoftDuals(e);
  }

  e.forEach(FindCorrections{}, bodies);
  if (e.view().features > 0) keepApart(e);
  forEachJoint<FinishJoints>(e);
  if (vertices > 0) finishSoftRows(e);
  stopFastBodies(e);
  if (e.view().bounces) findBounces(e);
  e.forEach(FinishBodies{}, bodies);
  if (e.view().bounces) actBounces(e);
  if (nodes > 0) closeTrees(e);
  if (!e.view().step.literalRotations) keepIslandMomenta(e);
  if (e.view().lumps > 0) keepSpin(e);
  e.forEach(FinishVertices{}, vertices);
  if (e.view().step.sleeping) sleepIslands(e);
  e.keepManifolds();
}

}  // namespace rubble::RUBBLE_CORE

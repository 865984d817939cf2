#pragma once
/// The coarse correction: block descent on rigid motions of groups of bodies.
#include "stages/executor.h"
#include "stages/coarse/lumps.h"
#include "stages/coarse/coarse.h"
#include "stages/joints/phases.h"

namespace rubble::RUBBLE_CORE::coarse {

/// Kernel over contacts and attachments of vertices, as blocks that join members of groups.
template <template <class> class Kernel, Executor E, class... Args>
void forEachSoftBlock(E& e, Args... args) {
  e.forEach(Kernel<PointContactBlocks>{args...}, &Counters::pointPairs);
  e.forEach(Kernel<AttachmentBlocks>{args...}, e.view().attachments);
}

/// Groups from the poses at x^t.
template <Executor E>
void findGroups(E& e) {
  const View& s = e.view();
  if (!s.step.coarseCorrection) return;
  const int members = s.members(), all = members * kCoarseLevels;
  const bool lumps = s.lumps > 0;
  e.clear(&View::memberCount, all);
  e.forEach(StartGroups{}, members);
  if (lumps) forEachSoftBlock<FindJoinLevels>(e);
  for (int level = 0; level < kCoarseLevels; ++level) {
    e.forEach(JoinGroups<ContactBlocks>{level}, &Counters::manifolds);
    forEachType(JointTypes{}, [&]<class F>() { e.beside(JoinGroups<JointBlocks<F>>{level}, s.joints[typeIndex<F>(JointTypes{})]); });
    if (lumps) forEachSoftBlock<JoinLumps>(e, level);
    e.forEach(FlattenGroups{level}, members);
  }
  e.forEach(FindLeaders{}, all);
  e.scan(&View::leads, &View::groupIndex, all, &Counters::groups, Per::Group);
  e.forEach(NumberGroups{}, all);
  if (s.vertices > 0) forEachSoftBlock<FindDepths>(e);
  e.group(&View::groupOf, all, &View::memberOffset, &View::member, &Counters::groups);
  e.scan(&View::groupChunks, &View::chunkOffset, &Counters::groups, &Counters::chunks, Per::Chunk);
  e.forEach(FindLevels{}, kCoarseLevels + 1);
  e.forEach(BeginGroups{}, &Counters::groups);
  e.forEach(MakeChunks{}, &Counters::chunks);
  if (s.locked) e.forEach(LockGroups{}, all);
  forEachJoint<MarkJoinedGroups>(e);
}

/// Centers and inertia of the groups, and the rows that leave them.
template <Executor E>
void prepare(E& e) {
  if (!e.view().step.coarseCorrection) return;
  e.forEach(SumInertia{}, &Counters::chunks);
  e.forEach(PlaceGroups{}, &Counters::groups);
  e.forEach(CountExternals{}, &Counters::chunks);
  e.scan(&View::externalCount, &View::externalOffset, &Counters::chunks, &Counters::externals, Per::External);
  e.forEach(FillExternals{}, &Counters::chunks);
}

/// What the groups of a level see of lumps.
template <Executor E>
void sumLumps(E& e, int level) {
  if (e.view().objects > 0) e.forEach(SumLumpPart{level}, e.view().clusterBegin[1]);
  e.forEach(SumLump{level}, e.view().lumps);
}

/// One step of the groups of a level: of all, or of those `With` lumps.
template <class Stage>
using WithAny = Stage;
template <template <class> class With, Executor E>
void solveLevel(E& e, int level) {
  const bool lumps = e.view().lumps > 0;
  if (lumps) sumLumps(e, level);
  e.forEachIn(With<SumChunk<typename E::Lane>>{}, &View::levelChunk, level);
  e.forEachIn(With<SolveGroup>{}, &View::levelGroup, level);
  e.forEachIn(With<MoveChunk>{}, &View::levelChunk, level);
  if (lumps) e.forEach(MoveLumps{level}, e.view().vertices);
}

/// One sweep over the groups, from coarse to fine: all levels but the finest in even iterations, the fine ones in odd.
template <Executor E>
void solve(E& e, int iteration) {
  if (!e.view().step.coarseCorrection) return;
  if (iteration == 0) joints::linearize(e);
  const bool even = iteration % 2 == 0;
  for (int level = (even ? kCoarseLevels : kFineLevels) - 1; level >= (even ? 1 : 0); --level) solveLevel<WithAny>(e, level);
}

/// The last sweep leaves groups with lumps at another momentum than what acts on them gives them: one more step of these groups, at all levels, and
/// another one of the largest, since a step goes four fifths of the way.
template <Executor E>
void keepMomentum(E& e) {
  if (!e.view().step.coarseCorrection || e.view().lumps == 0) return;
  for (int level = kCoarseLevels - 1; level >= 0; --level) solveLevel<WithLumps>(e, level);
  solveLevel<WithLumps>(e, kCoarseLevels - 1);
}

}  // namespace rubble::RUBBLE_CORE::coarse

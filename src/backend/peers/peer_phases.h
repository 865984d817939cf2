#pragma once
/// What ranks exchange in a step (backend/division.h), over a machine M that runs kernels and barriers:
///
///   tables(), data()          of this rank
///   each(kernel, n)           kernel(tables, i) for i < n; n may be a counter
///   eachOld(kernel)           for the pairs of the last step
///   selectOld(list, test)     makes the list of those with test(tables, k)
///   eachOf(list, kernel)      for the elements of a list
///   select(list, test, n)     makes the list of all i < n with test(tables, i)
///   selectOf(list, from, test)
///                             for all k of a list with test(tables, k): the list of test.of(tables, k)
///   join(list, more)          makes the list of what beginningOf(list) and another one have
///   barrier()                 waits for all ranks; what was stored before it is visible after it
///   barrierIf(counter)        the same if the counter is not zero. It is equal on all ranks.
///   kCountsNear               counters count near elements, and not only those that this rank counts
///   storesAtOnce()            kernels of the step store what they compute (Storing), where that is possible
///
/// A rank may be one interval between barriers ahead of another. Each exchange says why nobody reads in the
/// interval what it stores. Kernels that store (kPosts) come last before a barrier: where letters lack room,
/// they alone run again.
#include "backend/division.h"
#include "backend/peers/peer_kernels.h"
#include "backend/peers/peer_owners.h"

namespace rubble::RUBBLE_CORE::peers {

template <class M, class F> void eachJointType(M& m, F&& f) {
  const SolverData& s = m.tables();
  if (!s.hasJoints()) return;
  forEachType(JointTypes{}, [&]<class Force>() {
    if (const int n = s.joints[typeIndex<Force>(JointTypes{})]; n > 0) f.template operator()<Force>(n);
  });
}

/// Begins a step.
template <class M> void findHomes(M& m) { m.each(MoveCut{m.data()}, 1); }
/// All ranks have cleared their counts of pairs, and found what they can, when a barrier precedes.
template <class M> void shareFound(M& m) {
  const PeerData p = m.data();
  if (!p.home().cut) return;
  m.barrier();
  m.each(GivePartners{{p}}, m.tables().bodies);
  m.barrier();
}
/// Counts of bodies at home elsewhere, which their own rank alone has read since it was given partners.
template <class M> void sharePairCounts(M& m) {
  if (!m.data().home().cut) return;
  m.each(SharePairCounts{{{m.data()}}}, m.tables().bodies);
  m.barrier();
}
/// Pairs, or partners: the last reader is in the step before.
template <class M> void sharePartners(M& m) {
  const SolverData& s = m.tables();
  if (!m.data().home().cut) return;
  m.each(SharePartners{{{m.data()}}}, &Counters::pairs);
  m.barrier();
  if (!s.generalShapes) m.each(TakePartners{{m.data()}}, s.bodies);
}

/// Finds owners. Stores old manifolds and joints, which the stages before do not read. A rank that has met no
/// other one in this step may still be at the edits before it, so a barrier precedes.
template <class M> void beginStep(M& m) {
  const SolverData& s = m.tables();
  const PeerData p = m.data();
  m.each(FindHomes{p}, s.bodies);
  if (s.vertices > 0) {
    m.each(ShareAttachedBodies{p}, s.attachments);
    m.each(ShareTouchedBodies{p}, &Counters::pointPairs);
  }
  m.each(ShareTrees{p}, s.treeNodes);
  m.each(UnifyTrees{p}, s.treeNodes);
  m.each(CompareOwners{p}, s.bodies);
  if (!p.home().cut) m.barrier();
  m.selectOld(PeerList::MigratingPairs, MigratingPair{p});
  eachJointType(m, [&]<class F>(int n) { m.each(CountMigratedJoints<F>{p}, n); });
  m.eachOf(PeerList::MigratingPairs, MigratePairs{p});
  eachJointType(m, [&]<class F>(int n) { m.each(MigrateJoints<F>{p}, n); });
  m.barrier();
  m.select(PeerList::Pairs, NearPair{p}, &Counters::pairs);
  eachJointType(m, [&]<class F>(int n) { m.select(listOfJoints<F>(PeerJoints::Own), NearJoint<F>{p}, n); });
}

/// Flags of pairs and manifolds, to ranks that do not find them: the last reader is in the step before.
template <class M> void shareActivity(M& m) {
  if (!m.storesAtOnce()) m.eachOf(PeerList::Pairs, ShareActivity{{{m.data()}}});
  m.barrier();
}
template <class M> void listActivePairs(M& m) {
  m.selectOf(PeerList::ActivePairs, PeerList::Pairs, NearActivePair{m.data()});
}
template <class M> void shareTouches(M& m) {
  if constexpr (M::kCountsNear) m.eachOf(PeerList::ActivePairs, CountContacts{{m.data()}});
  m.eachOf(PeerList::ActivePairs, ShareTouches{{{m.data()}}});
  m.barrier();
}
template <class M> void shareRows(M& m) {
  const PeerData p = m.data();
  m.each(FindRowBodies{{p}}, &Counters::activePairs);
  m.selectOf(PeerList::OwnRows, PeerList::ActivePairs, NearRow{});
  m.eachOf(PeerList::OwnRows, ShareJoinLevel{{{p}}});
  if (m.tables().bounces) m.each(ShareWhetherBouncing{{{p}}}, 1);
  m.barrier();
  if (m.tables().bounces) m.each(TakeWhetherBouncing{{p}}, 1);
  if (!m.tables().plan.coarseCorrection) return;
  // with two ranks there are no others
  if (p.ranks > 2) m.select(PeerList::CrossRows, CrossRow{p}, &Counters::manifolds);
  m.join(PeerList::JoinedRows, PeerList::CrossRows);
}

/// Each level has its own memory, which only the exchange of the same level in the step before has read.
template <class M> void shareRoots(M& m, int level) {
  const PeerData p = m.data();
  m.each(ShareRoots{{{p}}, level}, m.tables().bodies);
  m.barrier();
  m.each(JoinSharedRoots{{p}, level}, m.tables().bodies);
}
/// Counts of slices: the last reader is in the step before.
template <class M> void shareBoundary(M& m) {
  m.eachOf(PeerList::Slices, ShareBoundary{{{m.data()}}});
  m.barrier();
}

/// What this rank evaluates and sees in the iterations. Asks for rows and joints of slices at a border, which
/// nobody reads before the second barrier. Sights and questions of a step are cleared after they are read,
/// and a barrier follows before others store the next ones.
template <class M> void plan(M& m) {
  const SolverData& s = m.tables();
  const PeerData p = m.data();
  const bool coarse = s.plan.coarseCorrection;
  m.select(PeerList::Bodies, OwnBody{p}, s.bodies);
  if (coarse) {
    m.each(FindSliceOwners{{p}}, &Counters::slices);
    m.select(PeerList::Slices, OwnSlice{p}, &Counters::slices);
    m.eachOf(PeerList::Slices, SeeSlices{{p}});
    m.select(PeerList::ExtraRows, ExtraRow{p}, &Counters::manifolds);
  }
  m.join(PeerList::Rows, PeerList::ExtraRows);
  eachJointType(m, [&]<class F>(int n) {
    if (coarse) m.select(listOfJoints<F>(PeerJoints::Extra), ExtraJoint<F>{p}, n);
    m.join(listOfJoints<F>(PeerJoints::All), listOfJoints<F>(PeerJoints::Extra));
    m.eachOf(listOfJoints<F>(PeerJoints::Own), SeeJoints<F>{{p}});
  });
  m.select(PeerList::Ghosts, Ghost{p}, s.bodies);
  if (coarse) {
    m.eachOf(PeerList::ExtraRows, AskExtraRows{{{p}}});
    eachJointType(
        m, [&]<class F>(int) { m.eachOf(listOfJoints<F>(PeerJoints::Extra), AskExtraJoints<F>{{{p}}}); });
  }
  m.eachOf(PeerList::Ghosts, ShareSight{{{p}}});
  m.barrier();
  m.eachOf(PeerList::Bodies, FindSeers{{p}});
  m.selectOf(PeerList::SharedBodies, PeerList::Bodies, SharedBody{p});
  if (!coarse) return;
  m.eachOf(PeerList::OwnRows, GiveRows{{{p}}});
  eachJointType(m, [&]<class F>(int) { m.eachOf(listOfJoints<F>(PeerJoints::Own), GiveJoints<F>{{{p}}}); });
  m.barrier();
  m.eachOf(PeerList::OwnRows, ForgetRowAskers{{p}});
  eachJointType(m,
                [&]<class F>(int) { m.eachOf(listOfJoints<F>(PeerJoints::Own), ForgetJointAskers<F>{{p}}); });
  m.join(PeerList::SeenBodies, PeerList::Ghosts);
  m.each(BeginAggregateSight{{p}}, &Counters::aggregates);
  m.each(MixSlices{{p}}, &Counters::slices);
  m.eachOf(PeerList::SharedBodies, SeeAggregates{{p}});
  m.eachOf(PeerList::Ghosts, SeeAggregates{{p}});
  m.select(PeerList::SeenSlices, SeenSlice{p}, &Counters::slices);
  m.select(PeerList::MixedSlices, MixedSlice{p}, &Counters::slices);
  m.select(PeerList::SentSlices, SentSlice{p}, &Counters::slices);
}

/// Before the first level of aggregates in a step: their sums are the memory of the sums of inertia.
template <class M> void beginSums(M& m) { m.barrier(); }
/// The next sums of a level come after the exchange of another level or color.
template <class M> void shareSums(M& m, int level) {
  m.eachOf(PeerList::SentSlices, ShareSums{{{m.data()}}, level});
  m.barrier();
}
/// Before the first color: linearized rows read all poses. Bodies of one color do not see one another.
template <class M> void beginColors(M& m) { m.barrier(); }
/// Aggregates and rows read all poses, so a barrier precedes.
template <class M> void shareTreePoses(M& m) {
  m.barrier();
  m.eachOf(PeerList::Bodies, ShareTreePoses{{{m.data()}}});
  m.barrier();
}
/// Aggregates and rows read all displacements until then.
template <class M> void beginMotion(M& m) { m.barrier(); }
template <class M> void shareMotion(M& m) {
  if (!m.storesAtOnce()) m.eachOf(PeerList::Bodies, ShareMotion{{{m.data()}}});
  m.barrier();
}
/// From here on owners store rows, manifolds and joints that others have not evaluated.
template <class M> void shareBreaks(M& m) {
  const PeerData p = m.data();
  if (!m.tables().hasJoints()) return;
  eachJointType(m, [&]<class F>(int) { m.eachOf(listOfJoints<F>(PeerJoints::Own), CountBreaks<F>{{p}}); });
  eachJointType(m, [&]<class F>(int) { m.eachOf(listOfJoints<F>(PeerJoints::Own), ShareBreaks<F>{{{p}}}); });
  m.each(ShareWhatBroke{{{p}}}, 1);
  m.barrier();
  m.each(TakeBreaks{{p}, M::kCountsNear}, 1);
}
template <class M> void shareFastPairs(M& m) {
  m.eachOf(PeerList::Pairs, ShareFastPairs{{{m.data()}}});
  m.barrierIf(&Counters::fastBodies);
}
template <class M> void shareBounces(M& m) {
  m.each(ShareBounces{{{m.data()}}}, &Counters::bounceRows);
  m.barrierIf(&Counters::bounceRows);
}
/// Others may still clear their flags, so a barrier precedes.
template <class M> void shareProjections(M& m) {
  m.barrier();
  m.each(ShareProjections{{{m.data()}}}, m.tables().treeNodes);
  m.barrier();
}
/// Ends a step.
template <class M> void shareCounts(M& m) {
  const PeerData p = m.data();
  m.each(CountPart{{p}}, 1);
  m.each(ShareCountsOfStep{{{p}}}, 1);
  m.barrier();
  m.each(TakeCounts{{p}}, 1);
}

/// The exchanges that need nothing but the machine.
template <class M> void share(M& m, Share what, int which) {
  switch (what) {
    case Share::None:
    case Share::ColorPoses:
    case Share::NodePoses:
      return;
    case Share::Homes:
      return findHomes(m);
    case Share::Found:
      return shareFound(m);
    case Share::PairCounts:
      return sharePairCounts(m);
    case Share::Partners:
      return sharePartners(m);
    case Share::Owners:
      return beginStep(m);
    case Share::Activity:
      return shareActivity(m);
    case Share::Touches:
      return shareTouches(m);
    case Share::Rows:
      return shareRows(m);
    case Share::Roots:
      return shareRoots(m, which);
    case Share::Boundary:
      return shareBoundary(m);
    case Share::SliceSums:
      return shareSums(m, which);
    case Share::TreePoses:
      return shareTreePoses(m);
    case Share::MotionBegins:
      return beginMotion(m);
    case Share::Motion:
      return shareMotion(m);
    case Share::Breaks:
      return shareBreaks(m);
    case Share::FastPairs:
      return shareFastPairs(m);
    case Share::BounceRows:
      return shareBounces(m);
    case Share::Gaps:
      return shareProjections(m);
    case Share::Counts:
      return shareCounts(m);
  }
}

/// Between steps: all ranks get the state of all pairs and joints. The counters are those of the last step.
template <class M> void gatherState(M& m) {
  const PeerData p = m.data();
  m.barrier();
  m.eachOld(GatherPairs{p});
  m.each(GatherRows{p}, &Counters::manifolds);
  eachJointType(m, [&]<class F>(int n) { m.each(GatherJoints<F>{p}, n); });
  m.barrier();
}

}  // namespace rubble::RUBBLE_CORE::peers

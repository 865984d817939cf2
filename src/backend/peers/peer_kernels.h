#pragma once
/// Kernels of a divided step: what a rank evaluates and sees, and what it stores into the tables of others.
#include "backend/peers/peer_data.h"
#include "stages/ccd/fast_bodies.h"
#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

/// A kernel of one rank: its stage, and the data of the rank.
struct PeerKernel {
  static constexpr const char* kStage = "ranks";
  PeerData p;
};
/// One that stores into the tables of others. It may run twice before the barrier.
struct PeerPost : PeerKernel {
  static constexpr bool kPosts = true;
};

/// This rank needs the pose of a body, or of those of a constraint.
RUBBLE_HD inline void see(const SolverData& s, const PeerData& p, int body) {
  if (body >= 0 && body < s.bodies && !p.isMine(p.owner[body])) mark(p.sightOf(p.rank, body));
}
RUBBLE_HD inline void see(const SolverData& s, const PeerData& p, const PeerEnds& ends) {
  for (int k = 0; k < ends.count; ++k) see(s, p, ends.body[k]);
}

/// A kernel whose elements then store what they have computed into the tables of others. Stores wait for
/// the connection, and the kernel for memory: together they take the time of the longer one.
template <class Kernel, class Stores> struct Storing {
  static constexpr const char* kStage = Kernel::kStage;
  Kernel kernel;
  Stores stores;
  RUBBLE_HD void operator()(const SolverData& s, int i) const { kernel(s, i), stores(s, i); }
};

// Pairs. Each rank searches for the partners of the bodies at home, and has all pairs in the end.

/// Partners of bodies at home elsewhere.
struct GivePartners : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    give(s, i, [](int* counter, int n) { return atomicCount(counter, n); });
  }
  /// add(counter, n) adds to a counter of another rank.
  template <class Add> RUBBLE_HD void give(const SolverData& s, int i, Add&& add) const {
    // others add to the counters of bodies at home
    if (p.home().has(i)) return;
    const int found = s.neighborSearch[i].found;
    if (found == 0) return;
    const PeerTables to = peerTables(p, p.homeOf(i));
    const int first = add(&to.s.neighborSearch[i].found, found);
    if (crowds(first, found)) to.put(to.s.crowdedBody[add(&to.s.counters->crowded, 1)], i);
    for (int k = 0; k < min(found, kPairSlots - first); ++k)
      to.put(to.s.pairSlot[i * kPairSlots + first + k], s.pairSlot[i * kPairSlots + k]);
  }
};
struct SharePairCounts : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!p.home().has(i)) return;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.s.pairCount[i], s.pairCount[i]); });
  }
};
/// By pair. Pairs of primitive shapes follow from their bodies.
struct SharePartners : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (k < s.pairOffset[p.cut->begin[p.rank]] || k >= s.pairOffset[p.cut->begin[p.rank + 1]]) return;
    forEachPeer(p, [&](const PeerTables& to) {
      if (s.generalShapes)
        to.put(to.s.pair[k], s.pair[k]);
      else
        to.put(to.p.sharedPartner[k], s.pair[k].other);
    });
  }
};
struct TakePartners : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.home().has(i)) return;
    for (int k = s.pairOffset[i]; k < s.pairOffset[i + 1]; ++k) s.pair[k] = pairOf(s, i, p.sharedPartner[k]);
  }
};

// Contacts.

/// Near pairs.
struct ShareActivity : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PeerEnds ends = endsOfPair(s.pair[k]);
    if (ownerOf(p, ends) != p.rank) return;
    forEachOnlooker(p, ends, [&](const PeerTables& to) { to.put(to.s.isActive[k], s.isActive[k]); });
  }
};
/// New near pairs.
struct ShareNewActivity : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int t) const { ShareActivity{{{p}}}(s, s.newPair[t]); }
};
/// Near active pairs.
struct ShareTouches : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const PeerEnds ends = endsOfManifold(s, i);
    if (ownerOf(p, ends) != p.rank) return;
    forEachOnlooker(p, ends, [&](const PeerTables& to) { to.put(to.s.hasRows[i], s.hasRows[i]); });
  }
};
/// Rows of all ranks, as edges of the graph of constraints.
struct FindRowBodies : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0) return;
    const OrderedPair o = ordered(s.pair[s.activePair[i]]);
    s.rowBodies[s.rowOffset[i]] = {o.a, o.b, i};
  }
};
/// Own rows.
struct ShareJoinLevel : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    const PeerEnds ends = endsOfRow(s, row);
    see(s, p, ends);
    if (ownerOf(p, ends) != p.rank) return;
    forEachOnlooker(p, ends, [&](const PeerTables& to) { to.put(to.s.joinLevel[row], s.joinLevel[row]); });
  }
};
struct ShareWhetherBouncing : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    p.sums[p.rank].bounces = s.counters->bounces;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.p.sums[p.rank].bounces, p.sums[p.rank].bounces); });
  }
};
struct TakeWhetherBouncing : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    for (int r = 0; r < p.ranks; ++r) s.counters->bounces = max(s.counters->bounces, p.sums[r].bounces);
  }
};

// Aggregates. Each rank joins its rows, and then the sets that others have found. A row between two ranks
// may lead farther on both sides, so a third one joins it, too.

/// Own bodies whose set has grown at this level.
struct ShareRoots : PeerPost {
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.owner[i] != p.rank) return;
    const int root = findRoot(s.root + atLevel(s, level, 0), i),
              before = level == 0 ? i : s.aggregateOf[atLevel(s, level - 1, i)];
    if (root == before) return;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.p.sharedRootOf(level, i), root + 1); });
  }
};
struct JoinSharedRoots : PeerKernel {
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.isMine(p.owner[i])) return;
    const int root = p.sharedRootOf(level, i) - 1;
    if (root < 0) return;
    unite(s.root + atLevel(s, level, 0), i, root);
    p.sharedRootOf(level, i) = 0;
  }
};

// What a rank evaluates and sees.

/// A slice belongs to the owner of its middle node. That rank evaluates all of its constraints.
struct FindSliceOwners : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Slice& slice = s.slice[i];
    const int node = s.aggregateNode[slice.begin + (slice.end - slice.begin) / 2];
    p.sliceOwner[i] = node < s.bodies ? p.owner[node] : kEveryPeer;
  }
};
/// For own slices: sees their bodies and the bodies of their boundary constraints, and marks the
/// constraints that act on no body of this rank.
struct SeeSlices : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const { (*this)(s, i, 0, 1); }
  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD void operator()(const SolverData& s, int i, int lane, int lanes) const {
    const Slice& slice = s.slice[i];
    const Aggregate& aggregate = s.aggregate[slice.aggregate];
    // nodes ascend, and without trees all bodies between the cuts are of this rank
    const PeerHome home{p.cut, p.rank};
    if (s.treeNodes == 0 && home.has(s.aggregateNode[slice.begin]) &&
        home.has(s.aggregateNode[slice.end - 1]))
      return;
    for (int k = slice.begin + lane; k < slice.end; k += lanes) {
      const int body = s.aggregateNode[k];
      // all constraints of own bodies are near
      if (body >= s.bodies || p.isMine(p.owner[body])) continue;
      see(s, p, body);
      visitBoundaryOf(s, aggregate, body, [&](const BoundaryConstraint& c) { seeConstraint(s, c.code); });
    }
  }

 private:
  RUBBLE_HD void seeConstraint(const SolverData& s, std::uint32_t code) const {
    if (constraintType(code) == kContactType) {
      const int row = constraintIndex(code);
      const PeerEnds ends = endsOfRow(s, row);
      see(s, p, ends);
      if (!actsHere(p, ends)) mark(p.extraRow[row]);
      return;
    }
    forEachType(JointTypes{}, [&]<class F>() {
      constexpr int kType = typeIndex<F>(JointTypes{});
      if (constraintType(code) != kType + 1) return;
      const PeerEnds ends = endsOfJoint<F>(s, jointIndex<F>(code));
      see(s, p, ends);
      if (!actsHere(p, ends)) mark(p.extraJoint[kType][jointIndex<F>(code)]);
    });
  }
};
/// The bodies of own joints. Those of own rows are seen by ShareJoinLevel.
template <class F> struct SeeJoints : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.jointsOf<F>()[i].active) see(s, p, endsOfJoint<F>(s, i));
  }
};
/// Asks the owners for rows of own slices, which are listed and need no mark any more.
struct AskExtraRows : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    p.extraRow[row] = 0;
    const int from = ownerOf(p, endsOfRow(s, row));
    if (from < 0) return;
    const PeerTables to = peerTables(p, from);
    to.put(to.p.askersOf(row)[p.rank], std::uint8_t{1});
  }
};
template <class F> struct AskExtraJoints : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    p.extraJoint[typeIndex<F>(JointTypes{})][i] = 0;
    const int from = ownerOf(p, endsOfJoint<F>(s, i));
    if (from < 0) return;
    const PeerTables to = peerTables(p, from);
    to.put(to.p.askersOf<F>(i)[p.rank], std::uint8_t{1});
  }
};
/// Calls f(tables) for each rank that has asked for an element.
template <class F> RUBBLE_HD void forEachAsker(const PeerData& p, const std::uint8_t* askers, F&& f) {
  for (int r = 0; r < p.ranks; ++r)
    if (askers[r]) f(peerTables(p, r));
}
/// Own rows as they are at the beginning of the iterations, to those that ask.
struct GiveRows : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    forEachAsker(p, p.askersOf(row), [&](const PeerTables& to) {
      to.put(to.s.contact[row], s.contact[row]);
      if (!s.rolls) return;
      const int m = s.rowBodies[row].manifold;
      to.put(to.s.rolling[m], s.rolling[m]);
    });
  }
};
template <class F> struct GiveJoints : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    forEachAsker(p, p.askersOf<F>(i),
                 [&](const PeerTables& to) { to.put(to.s.jointsOf<F>()[i], s.jointsOf<F>()[i]); });
  }
};
/// After the barrier: nobody asks any more.
struct ForgetRowAskers : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int row) const {
    for (int r = 0; r < p.ranks; ++r) p.askersOf(row)[r] = 0;
  }
};
template <class F> struct ForgetJointAskers : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    for (int r = 0; r < p.ranks; ++r) p.askersOf<F>(i)[r] = 0;
  }
};
/// Tells the owners of ghosts who sees them.
struct ShareSight : PeerPost {
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    const PeerTables to = peerTables(p, p.owner[i]);
    to.put(to.p.sightOf(p.rank, i), std::uint8_t{1});
  }
};
/// Own bodies.
struct FindSeers : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    if (p.owner[i] != p.rank) return;
    unsigned seers = 0;
    for (int r = 0; r < p.ranks; ++r)
      if (r != p.rank && p.sightOf(r, i)) seers |= 1u << r;
    p.seenBy[i] = seers;
  }
};
/// Aggregates that move a body that this rank sees, and among them those that are not of this rank alone.
/// Those with soft nodes move everywhere.
struct BeginAggregateSight : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    p.sees[i] = p.mixed[i] = s.aggregate[i].soft != 0;
  }
};
/// By slice: this rank or another one has its sum.
struct MixSlices : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.isMine(p.sliceOwner[i])) mark(p.sees[s.slice[i].aggregate]);
    if (p.sliceOwner[i] != p.rank) mark(p.mixed[s.slice[i].aggregate]);
  }
};
/// Ghosts and shared bodies. The owner of a slice sees its bodies, so all other own bodies lie in own slices.
struct SeeAggregates : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int body) const {
    const bool mixed = p.owner[body] != p.rank || p.seenBy[body] != 0;
    for (int level = 0; level < kCoarseLevels; ++level) {
      const int aggregate = s.aggregateOf[atLevel(s, level, body)];
      if (aggregate < 0) continue;
      mark(p.sees[aggregate]);
      if (mixed) mark(p.mixed[aggregate]);
    }
  }
};

/// Own slices: tables of all ranks grow alike if all count the constraints of all slices.
struct ShareBoundary : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.sliceOwner[i] != p.rank) return;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.s.boundaryCount[i], s.boundaryCount[i]); });
  }
};

// The iterations.

/// The pose of an own body, to the ranks that see it.
RUBBLE_HD inline void sharePose(const SolverData& s, const PeerData& p, int body) {
  forEachOf(p, p.seenBy[body], [&](const PeerTables& to) {
    to.put(to.s.dx[body], s.dx[body]), to.put(to.s.dq[body], s.dq[body]);
  });
}
/// For the bodies of one color, `body`[k].
struct ShareColor : PeerPost {
  const int* body;
  RUBBLE_HD void operator()(const SolverData& s, int k) const { sharePose(s, p, body[k]); }
};
/// Own bodies.
struct ShareTreePoses : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.nodeOfBody[i] >= 0) sharePose(s, p, i);
  }
};
/// Sent slices.
struct ShareSums : PeerPost {
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.aggregate[s.slice[i].aggregate].level != level) return;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.s.slice[i].sum, s.slice[i].sum); });
  }
};

// The end of a step.

/// Own bodies.
struct ShareMotion : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.owner[i] < 0) return;
    forEachPeer(p, [&](const PeerTables& to) {
      to.put(to.s.dx[i], s.dx[i]), to.put(to.s.dq[i], s.dq[i]);
      to.put(to.s.nextCorrection[i], s.nextCorrection[i]), to.put(to.s.fast[i], s.fast[i]);
    });
  }
};
/// Near joints.
template <class F> struct CountBreaks : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Joint<F>& joint = s.jointsOf<F>()[i];
    if (!joint.broken || !joint.active) return;
    atomicCount(&p.sums[p.rank].brokenNear, 1);
    if (p.counts(NearJoint<F>{p}.ownerOf(s, i))) atomicCount(&p.sums[p.rank].broken, 1);
  }
};
template <class F> struct ShareBreaks : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Joint<F>& joint = s.jointsOf<F>()[i];
    if (!joint.broken) return;
    const PeerEnds ends = endsOfJoint<F>(s, i);
    if (ownerOf(p, ends) != p.rank) return;
    forEachOnlooker(p, ends,
                    [&](const PeerTables& to) { to.put(to.s.jointsOf<F>()[i].broken, joint.broken); });
  }
};
/// Continuous collision detection runs everywhere and reads the contacts of fast bodies. Near pairs.
struct ShareFastPairs : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (s.counters->fastBodies == 0 || !s.isActive[k] || !mayImpact(s, ordered(s.pair[k]))) return;
    const PeerEnds ends = endsOfPair(s.pair[k]);
    if (ownerOf(p, ends) != p.rank) return;
    const int m = s.activePairOffset[k];
    const int row = s.rowOffset[m];
    forEachOnlooker(p, ends, [&](const PeerTables& to) {
      to.put(to.s.manifold[m], s.manifold[m]);
      if (s.generalShapes && s.hasRows[m]) to.put(to.s.contact[row], s.contact[row]);
    });
  }
};
/// Restitution runs everywhere and reads all contacts, in steps in which any contact bounces.
struct ShareBounces : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    const PeerEnds ends = endsOfRow(s, row);
    if (ownerOf(p, ends) != p.rank) return;
    const int m = s.rowBodies[row].manifold;
    forEachOnlooker(p, ends, [&](const PeerTables& to) {
      to.put(to.s.contact[row], s.contact[row]), to.put(to.s.bounce[row], s.bounce[row]);
      to.put(to.s.manifold[m], s.manifold[m]);
      if (s.rolls) to.put(to.s.rolling[m], s.rolling[m]);
    });
  }
};
/// The displacements by which joint projection moves bodies, of own trees.
struct ShareProjections : PeerPost {
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (node.body < 0 || p.owner[node.body] != p.rank || s.treeNeedsProjection[node.tree] == 0) return;
    forEachPeer(p, [&](const PeerTables& to) {
      to.put(to.s.projectionLink[n], s.projectionLink[n]);
      if (node.tree == n) to.put(to.s.treeNeedsProjection[n], s.treeNeedsProjection[n]);
    });
  }
};
struct ShareWhatBroke : PeerPost {
  RUBBLE_HD void operator()(const SolverData&, int) const {
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.p.sums[p.rank].broken, p.sums[p.rank].broken); });
  }
};
/// `countsNear`: the counter of the step has all near joints that broke, and else those that this rank
/// counts.
struct TakeBreaks : PeerKernel {
  bool countsNear;
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    const PeerSums& own = p.sums[p.rank];
    s.counters->broken -= countsNear ? own.brokenNear : own.broken;
    for (int r = 0; r < p.ranks; ++r) s.counters->broken += p.sums[r].broken;
  }
};
/// Near active pairs that another rank counts, where the counters of the step have them.
struct CountContacts : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0 || p.counts(NearActivePair{p}.ownerOf(s, i))) return;
    const Manifold& m = s.manifold[i];
    PeerSums::Counts& own = p.sums[p.rank].counts;
    atomicCount(&own.contacts, countPoints(m.activePoints));
    if (m.recycled) atomicCount(&own.recycled, 1);
  }
};
/// Ends the part of this rank. What CountContacts counted is of others.
struct CountPart : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    PeerSums::Counts& own = p.sums[p.rank].counts;
    own.contacts = s.counters->contacts - own.contacts;
    own.recycled = s.counters->recycled - own.recycled;
    own.failedSolves = s.counters->failedSolves, own.boundedSteps = s.counters->boundedSteps;
    own.bodies = p.listed[static_cast<int>(PeerList::Bodies)];
    own.ghosts = p.listed[static_cast<int>(PeerList::Ghosts)];
    own.rows = p.listed[static_cast<int>(PeerList::Rows)];
    own.migrated += p.listed[static_cast<int>(PeerList::MigratingPairs)];
    p.cut->holdsAll = 0;
  }
};
struct ShareCountsOfStep : PeerPost {
  RUBBLE_HD void operator()(const SolverData&, int) const {
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.p.sums[p.rank].counts, p.sums[p.rank].counts); });
  }
};
struct TakeCounts : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    Counters& c = *s.counters;
    c.contacts = c.recycled = c.failedSolves = c.boundedSteps = 0;
    for (int r = 0; r < p.ranks; ++r) {
      const PeerSums::Counts& of = p.sums[r].counts;
      c.contacts += of.contacts, c.recycled += of.recycled;
      c.failedSolves += of.failedSolves, c.boundedSteps += of.boundedSteps;
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

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

// Contacts.

struct ShareActivity : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (NearPair{p}.ownerOf(s, k) != p.rank) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) { to.isActive[k] = s.isActive[k]; });
  }
};
struct ShareTouches : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (NearActivePair{p}.ownerOf(s, i) != p.rank) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) { to.hasRows[i] = s.hasRows[i]; });
  }
};
/// Rows of all ranks, as nodes of the graph of constraints.
struct ShareRow : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0) return;
    const int row = s.rowOffset[i];
    const OrderedPair o = ordered(s.pair[s.activePair[i]]);
    s.rowBodies[row] = {o.a, o.b, i};
    if (NearActivePair{p}.ownerOf(s, i) != p.rank) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) { to.joinLevel[row] = s.joinLevel[row]; });
  }
};
struct ShareWhetherBouncing : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    p.sums[p.rank].bounces = s.counters->bounces;
    forEachPeer(
        p, [&](const SolverData&, const PeerData& to) { to.sums[p.rank].bounces = s.counters->bounces; });
  }
};
struct TakeWhetherBouncing : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    for (int r = 0; r < p.ranks; ++r) s.counters->bounces = max(s.counters->bounces, p.sums[r].bounces);
  }
};

// What a rank evaluates and sees.

struct SeeNothing : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int i) const { p.sightOf(p.rank, i) = 0, p.seenBy[i] = 0; }
};
struct ClearExtraRows : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int row) const { p.extraRow[row] = 0; }
};
template <class F> struct ClearExtraJoints : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    p.extraJoint[typeIndex<F>(JointTypes{})][i] = 0;
  }
};
/// A slice belongs to the owner of its middle node. That rank evaluates all of its constraints.
struct FindSliceOwners : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Slice& slice = s.slice[i];
    const int node = s.aggregateNode[slice.begin + (slice.end - slice.begin) / 2];
    p.sliceOwner[i] = node < s.bodies ? p.owner[node] : kEveryPeer;
  }
};
RUBBLE_HD inline void see(const SolverData& s, const PeerData& p, int body) {
  if (body >= 0 && body < s.bodies && !p.isMine(p.owner[body])) p.sightOf(p.rank, body) = 1;
}
/// For own slices: sees their bodies and the bodies of their boundary constraints, and marks the
/// constraints that act on no body of this rank.
struct SeeSlices : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Slice& slice = s.slice[i];
    const int level = s.aggregate[slice.aggregate].level;
    for (int k = slice.begin; k < slice.end; ++k) {
      const int body = s.aggregateNode[k];
      // all constraints of own bodies are near
      if (body >= s.bodies || p.isMine(p.owner[body])) continue;
      see(s, p, body);
      visitBoundaryOf(s, body, level, [&](std::uint32_t code) { seeConstraint(s, code); });
    }
  }

 private:
  RUBBLE_HD void seeConstraint(const SolverData& s, std::uint32_t code) const {
    if (constraintType(code) == kContactType) {
      const int row = constraintIndex(code);
      see(s, p, s.rowBodies[row].a), see(s, p, s.rowBodies[row].b);
      if (!actsHere(p, endsOfRow(s, row))) p.extraRow[row] = 1;
      return;
    }
    forEachType(JointTypes{}, [&]<class F>() {
      constexpr int kType = typeIndex<F>(JointTypes{});
      if (constraintType(code) != kType + 1) return;
      const PeerEnds ends = endsOfJoint<F>(s, jointIndex<F>(code));
      for (int side = 0; side < ends.count; ++side) see(s, p, ends.body[side]);
      if (!actsHere(p, ends)) p.extraJoint[kType][jointIndex<F>(code)] = 1;
    });
  }
};
/// The neighbors of own bodies.
struct SeeNeighbors : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) see(s, p, s.incidence[k].other);
  }
};
/// Rows of own slices as their owners have them at the beginning of the iterations.
struct TakeExtraRows : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    const int from = ownerOf(p, endsOfRow(s, row));
    if (from < 0) return;
    const SolverData& owner = p.at[from].s;
    s.contact[row] = owner.contact[row];
    if (s.rolls) s.rolling[s.rowBodies[row].manifold] = owner.rolling[s.rowBodies[row].manifold];
  }
};
template <class F> struct TakeExtraJoints : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int from = ownerOf(p, endsOfJoint<F>(s, i));
    if (from >= 0) s.jointsOf<F>()[i] = p.at[from].s.template jointsOf<F>()[i];
  }
};
/// Tells the owners of bodies who sees them.
struct ShareSight : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isDynamic(s, i) || p.isMine(p.owner[i])) return;
    p.at[p.owner[i]].p.sightOf(p.rank, i) = p.sightOf(p.rank, i);
    if (p.sightOf(p.rank, i)) atomicCount(&p.sums[p.rank].ghosts, 1);
  }
};
/// Own bodies.
struct FindSeers : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    if (p.owner[i] != p.rank) return;
    int seers = 0;
    for (int r = 0; r < p.ranks; ++r)
      if (r != p.rank && p.sightOf(r, i)) seers |= 1 << r;
    p.seenBy[i] = seers;
  }
};
/// Aggregates that move a body that this rank sees, and those that are not of this rank alone. Those with
/// soft nodes move everywhere.
struct BeginAggregateSight : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    p.sees[i] = p.mixed[i] = s.aggregate[i].soft != 0;
  }
};
/// By slice: another rank has its sum.
struct MixSlices : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.sliceOwner[i] != p.rank) p.mixed[s.slice[i].aggregate] = 1;
  }
};
/// By node and level.
struct SeeAggregates : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int aggregate = s.aggregateOf[t], node = t % s.nodes();
    if (aggregate < 0 || node >= s.bodies) return;
    const bool own = p.owner[node] == p.rank;
    if (own || p.isSeen(node)) p.sees[aggregate] = 1;
    if (!own || p.seenBy[node] != 0) p.mixed[aggregate] = 1;
  }
};

// The iterations.

/// Calls f(tables) for each rank that sees an own body.
template <class F> RUBBLE_HD void forEachSeer(const PeerData& p, int body, F&& f) {
  for (int seers = p.seenBy[body], r = 0; seers != 0; seers >>= 1, ++r)
    if (seers & 1) f(p.at[r].s);
}
RUBBLE_HD inline void sharePose(const SolverData& s, const PeerData& p, int body) {
  forEachSeer(p, body, [&](const SolverData& to) { to.dx[body] = s.dx[body], to.dq[body] = s.dq[body]; });
}
/// For the bodies of one color, `body`[k].
struct ShareColor : PeerKernel {
  const int* body;
  RUBBLE_HD void operator()(const SolverData& s, int k) const { sharePose(s, p, body[k]); }
};
/// Own bodies.
struct ShareTreePoses : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.nodeOfBody[i] >= 0) sharePose(s, p, i);
  }
};
/// Sent slices.
struct ShareSums : PeerKernel {
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.aggregate[s.slice[i].aggregate].level != level) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) { to.slice[i].sum = s.slice[i].sum; });
  }
};

// The end of a step.

/// Own bodies.
struct ShareMotion : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (p.owner[i] < 0) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) {
      to.dx[i] = s.dx[i], to.dq[i] = s.dq[i];
      to.nextCorrection[i] = s.nextCorrection[i], to.fast[i] = s.fast[i];
    });
  }
};
/// Near joints.
template <class F> struct ShareBreaks : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Joint<F>& joint = s.jointsOf<F>()[i];
    if (!joint.broken) return;
    const int owner = NearJoint<F>{p}.ownerOf(s, i);
    if (joint.active) {
      atomicCount(&p.sums[p.rank].brokenNear, 1);
      if (p.counts(owner)) atomicCount(&p.sums[p.rank].broken, 1);
    }
    if (owner != p.rank) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) { to.jointsOf<F>()[i].broken = 1; });
  }
};
/// Continuous collision detection runs everywhere and reads the contacts of fast bodies. Near pairs.
struct ShareFastPairs : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (s.counters->fastBodies == 0 || !s.isActive[k] || !mayImpact(s, ordered(s.pair[k])) ||
        NearPair{p}.ownerOf(s, k) != p.rank)
      return;
    const int m = s.activePairOffset[k];
    forEachPeer(p, [&](const SolverData& to, const PeerData&) {
      to.manifold[m] = s.manifold[m];
      if (s.generalShapes && s.hasRows[m]) to.contact[s.rowOffset[m]] = s.contact[s.rowOffset[m]];
    });
  }
};
/// Restitution runs everywhere and reads all contacts, in steps in which any contact bounces.
struct ShareBounces : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    if (ownerOf(p, endsOfRow(s, row)) != p.rank) return;
    const int m = s.rowBodies[row].manifold;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) {
      to.contact[row] = s.contact[row], to.bounce[row] = s.bounce[row], to.manifold[m] = s.manifold[m];
      if (s.rolls) to.rolling[m] = s.rolling[m];
    });
  }
};
/// The displacements by which joint projection moves bodies, of own trees.
struct ShareProjections : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    const TreeNode& node = s.treeNode[n];
    if (node.body < 0 || p.owner[node.body] != p.rank || s.treeNeedsProjection[node.tree] == 0) return;
    forEachPeer(p, [&](const SolverData& to, const PeerData&) {
      to.projectionLink[n] = s.projectionLink[n];
      if (node.tree == n) to.treeNeedsProjection[n] = s.treeNeedsProjection[n];
    });
  }
};
struct ShareSumsOfStep : PeerKernel {
  RUBBLE_HD void operator()(const SolverData&, int) const {
    forEachPeer(p, [&](const SolverData&, const PeerData& to) { to.sums[p.rank] = p.sums[p.rank]; });
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
/// Near active pairs: those that this rank counts, or with `others` those that another rank does.
struct CountContacts : PeerKernel {
  bool others;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0 || p.counts(NearActivePair{p}.ownerOf(s, i)) == others) return;
    const Manifold& m = s.manifold[i];
    atomicCount(&p.sums[p.rank].contacts, countPoints(m.activePoints));
    if (m.recycled) atomicCount(&p.sums[p.rank].recycled, 1);
  }
};
/// `countsNear`: the counters of the step have all near contacts; then CountContacts counted those of others.
struct CountPart : PeerKernel {
  bool countsNear;
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    PeerSums& own = p.sums[p.rank];
    if (countsNear) {
      own.contacts = s.counters->contacts - own.contacts;
      own.recycled = s.counters->recycled - own.recycled;
    }
    own.failedSolves = s.counters->failedSolves, own.boundedSteps = s.counters->boundedSteps;
    own.bodies = p.listed[static_cast<int>(PeerList::Bodies)];
    own.rows = p.listed[static_cast<int>(PeerList::Rows)];
  }
};
struct TakeCounts : PeerKernel {
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    Counters& c = *s.counters;
    c.contacts = c.recycled = c.failedSolves = c.boundedSteps = 0;
    for (int r = 0; r < p.ranks; ++r) {
      const PeerSums& of = p.sums[r];
      c.contacts += of.contacts, c.recycled += of.recycled;
      c.failedSolves += of.failedSolves, c.boundedSteps += of.boundedSteps;
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Owners of bodies, and the state of pairs and joints that new owners need.
#include "backend/peers/peer_data.h"
#include "stages/soft/body_corners.h"

namespace rubble::RUBBLE_CORE {

/// Cost of a body without constraints, in constraints.
inline constexpr int kPeerBodyCost = 2;
/// Least number of steps between cuts by imbalance.
inline constexpr int kPeerPause = 8;

/// Moves the cut, by one thread. Costs are those of the last step: 2 per body and 1 per constraint. Also
/// begins the sums of the step.
struct MoveCut {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD static std::int64_t costBefore(const SolverData& s, int body) {
    return std::int64_t{kPeerBodyCost} * body + max(s.incidenceOffset[body], 0);
  }
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    PeerCut& cut = *p.cut;
    cut.changed = 0, ++cut.since;
    cut.knownBefore = cut.known, cut.known = s.bodies;
    p.sums[p.rank] = {};
    if (!isDue(s)) return;
    cut.since = 0, cut.bodies = s.bodies;
    const std::int64_t all = costBefore(s, s.bodies);
    cut.begin[0] = 0;
    for (int r = 1; r < p.ranks; ++r) {
      int low = cut.begin[r - 1], high = s.bodies;
      while (low < high) {
        const int middle = low + (high - low) / 2;
        if (costBefore(s, middle) * p.ranks < all * r)
          low = middle + 1;
        else
          high = middle;
      }
      cut.begin[r] = low;
    }
    cut.begin[p.ranks] = s.bodies;
  }

 private:
  RUBBLE_HD bool isDue(const SolverData& s) const {
    const PeerCut& cut = *p.cut;
    if (cut.bodies != s.bodies) return true;
    if (cut.interval > 0) return cut.since >= cut.interval;
    if (cut.since < kPeerPause) return false;
    std::int64_t most = 0;
    for (int r = 0; r < p.ranks; ++r)
      most = max(most, costBefore(s, cut.begin[r + 1]) - costBefore(s, cut.begin[r]));
    const double mean = static_cast<double>(costBefore(s, s.bodies)) / p.ranks;
    return static_cast<double>(most) > (1 + cut.maxImbalance) * mean;
  }
};

struct FindHomes {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    // nobody has the state of a body that is new
    p.ownerBefore[i] = i < p.cut->knownBefore ? p.owner[i] : kEveryPeer;
    p.movesBefore[i] = p.moves[i];
    // sights of the last step
    p.seenBy[i] = 0;
    for (int k = 0; k < p.ranks; ++k) p.sightOf(k, i) = 0;
    // columns are solved by every rank
    p.owner[i] = columnBefore(s, i) != 0 ? kEveryPeer : p.homeOf(i);
    p.moves[i] = s.params[i].kind == BodyKind::Dynamic;
  }
};
/// Bodies that touch deformable objects are solved by every rank, as these objects are.
struct ShareAttachedBodies {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (const int body = s.attachment[k].body; body >= 0 && body < s.bodies) mark(p.owner[body], kEveryPeer);
  }
};
struct ShareTouchedBodies {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PointPair& pair = s.pointPair[k];
    if (pair.other < kVertexNode && pair.other >= 0 && pair.other < s.bodies)
      mark(p.owner[pair.other], kEveryPeer);
    if (pair.vertex >= s.vertices + s.edges) mark(p.owner[bodyOfOwner(s, pair.vertex)], kEveryPeer);
  }
};
/// All bodies of a joint tree have one owner, that of its root. By node, without roots.
struct ShareTrees {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    if (const TreeNode& node = s.treeNode[n];
        node.tree != n && node.body >= 0 && p.owner[node.body] == kEveryPeer)
      mark(p.owner[s.treeNode[node.tree].body], kEveryPeer);
  }
};
struct UnifyTrees {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int n) const {
    if (const TreeNode& node = s.treeNode[n]; node.tree != n && node.body >= 0)
      p.owner[node.body] = p.owner[s.treeNode[node.tree].body];
  }
};
struct CompareOwners {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData&, int i) const {
    if (p.owner[i] != p.ownerBefore[i] || p.moves[i] != p.movesBefore[i]) mark(p.cut->changed);
  }
};

/// Stores the state of an old pair into the tables of all ranks.
RUBBLE_HD inline void shareOldPair(const SolverData& s, const PeerData& p, int k) {
  const int m = manifoldOfOld(s, k);
  forEachPeer(p, [&](const PeerTables& to) {
    to.put(to.s.oldPairTest[k], s.oldPairTest[k]);
    if (m < 0) return;
    to.put(to.s.oldManifold[m], s.oldManifold[m]);
    if (s.rolledBefore) to.put(to.s.oldRolling[m], s.oldRolling[m]);
  });
}
template <class F> RUBBLE_HD void shareJoint(const SolverData& s, const PeerData& p, int i) {
  forEachPeer(p, [&](const PeerTables& to) { to.put(to.s.jointsOf<F>()[i], s.jointsOf<F>()[i]); });
}

/// Is it for this rank to give the state of a constraint to new owners?
RUBBLE_HD inline bool migrates(const PeerData& p, const PeerEnds& ends) {
  return p.cut->changed != 0 && p.cut->holdsAll == 0 && hasNewOwner(p, ends) &&
         ownerOf(p, p.ownerBefore, p.movesBefore, ends) == p.rank;
}
/// Test of old pairs.
struct MigratingPair {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int k) const {
    // in most steps no body has a new owner, and no pair is read
    return p.cut->changed != 0 && migrates(p, endsOfPair(s.oldPair[k]));
  }
};
/// To all ranks.
struct MigratePairs {
  static constexpr const char* kStage = "owners";
  static constexpr bool kPosts = true;
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int k) const { shareOldPair(s, p, k); }
};
template <class F> struct MigrateJoints {
  static constexpr const char* kStage = "owners";
  static constexpr bool kPosts = true;
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (migrates(p, endsOfJoint<F>(s, i))) shareJoint<F>(s, p, i);
  }
};
/// How many of them there are. Pairs are counted by their list.
template <class F> struct CountMigratedJoints {
  static constexpr const char* kStage = "owners";
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (migrates(p, endsOfJoint<F>(s, i))) atomicCount(&p.sums[p.rank].counts.migrated, 1);
  }
};

/// Between steps: the state that this rank has for others.
struct GatherPairs {
  static constexpr const char* kStage = "owners";
  static constexpr bool kPosts = true;
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (ownerOf(p, endsOfPair(s.oldPair[k])) == p.rank) shareOldPair(s, p, k);
  }
};
/// The rows of the last step, whose manifolds are the old ones now.
struct GatherRows {
  static constexpr const char* kStage = "owners";
  static constexpr bool kPosts = true;
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int row) const {
    const Pair& pair = s.oldPair[s.activePair[s.rowBodies[row].manifold]];
    if (ownerOf(p, endsOfPair(pair)) != p.rank) return;
    forEachPeer(p, [&](const PeerTables& to) { to.put(to.s.contact[row], s.contact[row]); });
  }
};
template <class F> struct GatherJoints {
  static constexpr const char* kStage = "owners";
  static constexpr bool kPosts = true;
  PeerData p;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (ownerOf(p, endsOfJoint<F>(s, i)) == p.rank) shareJoint<F>(s, p, i);
  }
};

}  // namespace rubble::RUBBLE_CORE

#include "backend/distributed/rank_division.h"

#include <algorithm>

#include "backend/distributed/rank_ends.h"

namespace rubble::RUBBLE_CORE {

Division::Part RankDivision::part(Cut cut, int n, int which) {
  switch (cut) {
    case Cut::Whole:
    case Cut::Homes:  // each rank finds all pairs, and joins all rows
    case Cut::JoinedRows:
      return {nullptr, n, n};
    case Cut::Pairs:
      return pairs_.part();
    case Cut::ActivePairs:
      if (!activeListed_) listActive();
      return active_.part();
    case Cut::Tested:
      lister_.list(tested_, n, [&](int k) { return takeOf(ownerOfManifold(data().tested[k])); });
      return tested_.part();
    default:
      if (!planned_) plan();
      return planned(cut, n, which);
  }
}

Division::Part RankDivision::planned(Cut cut, int n, int which) {
  const SolverData& s = data();
  const auto all = [](const RankPart& list) { return Part{list.index.data(), list.size(), list.size()}; };
  switch (cut) {
    case Cut::Rows:
      return all(rows_);
    case Cut::OwnRows:
      return all(ownRows_);
    case Cut::Bodies:
      return own_.part();
    case Cut::Slices:
      // slices of other ranks have no constraints here
      std::fill_n(&s.boundaryCount[0], n, 0);
      return slices_.part();
    case Cut::LevelSlices:
      return levelSlices_.part(which);
    case Cut::SeenAggregates:
      return all(seenAggregates_);
    case Cut::SeenSlices:
      return all(seenSlices_);
    case Cut::LevelAggregates:
      return levelAggregates_.part(which);
    case Cut::LevelMoves:
      return movingSlices_.part(which);
    case Cut::Joints:
      return jointPart(joints_[which].all, joints_[which].allParts, n / s.joints[which]);
    case Cut::OwnJoints:
      return jointPart(joints_[which].own, joints_[which].ownParts, n / s.joints[which]);
    case Cut::TreeNodes:
      return all(treeNodes_);
    case Cut::SmallTrees:
      return all(smallTrees_);
    default:
      lister_.list(levelNodes_, n, [&](int k) {
        return isMine(ownerOfNode(s.levelNode[which + k])) ? Take::Counted : Take::No;
      });
      return levelNodes_.part();
  }
}

/// `parts`: the elements of `list` with several parts per joint, once they have been listed in a step.
Division::Part RankDivision::jointPart(const RankPart& list, RankPart& parts, int perJoint) {
  if (perJoint == 1) return list.part();
  if (parts.size() != list.size() * perJoint) lister_.listParts(parts, list, perJoint);
  return parts.part();
}

Division::Part RankDivision::color(int color) {
  if (!planned_) plan();
  return colors_.part(color);
}

void RankDivision::listActive() {
  const SolverData& s = data();
  activeListed_ = true;
  lister_.list(active_, s.counters->activePairs, [&](int i) {
    return pairNear_[std::size_t(s.activePair[i])] ? takeOf(ownerOfManifold(i)) : Take::No;
  });
}

void RankDivision::share(Share what, int which) {
  const SolverData& s = data();
  switch (what) {
    case Share::None:
    case Share::Homes:
    case Share::Found:
    case Share::PairCounts:
    case Share::Partners:
    case Share::Roots:
    case Share::Boundary:
    case Share::MotionBegins:
      return;
    case Share::Owners:
      return beginStep();
    case Share::Activity:
      return courier_.gatherSmall<1>(s.isActive, s.counters->pairs,
                                     [&](int i) { return pairOwner_[std::size_t(i)]; });
    case Share::Touches:
      return courier_.gatherSmall<1>(s.hasRows, s.counters->activePairs,
                                     [&](int i) { return ownerOfManifold(i); });
    case Share::Rows:
      return shareRows();
    case Share::SliceSums:
      // one array of sums would be shorter, but slices are few
      return courier_.swap(sliceSums_[std::size_t(which)], &s.slice[0]);
    case Share::NodePoses:
      if (!std::exchange(nodesMoved_, false)) return;
      return courier_.swap(nodePoses_, &s.dx[0], &s.dq[0]);
    case Share::ColorPoses:
      nodesMoved_ = true;
      return courier_.swap(colorPoses_[std::size_t(which)], &s.dx[0], &s.dq[0]);
    case Share::TreePoses:
      nodesMoved_ = true;
      return courier_.swap(treePoses_, &s.dx[0], &s.dq[0]);
    case Share::Motion:
      return courier_.gather(bodies_, &s.dx[0], &s.dq[0], &s.nextCorrection[0], &s.fast[0]);
    case Share::Breaks:
      return shareBreaks();
    case Share::FastPairs:
      return shareFastPairs();
    case Share::BounceRows:
      return shareBounces();
    case Share::Gaps:
      return shareGaps();
    case Share::Counts:
      return shareCounts();
  }
}

/// Rows of all ranks, as nodes of the graph of constraints.
void RankDivision::shareRows() {
  const SolverData& s = data();
  lister_.list(
      ownRows_, s.counters->activePairs,
      [&](int i) {
        if (s.hasRows[i] == 0) return Take::No;
        const OrderedPair o = ordered(s.pair[s.activePair[i]]);
        s.rowBodies[s.rowOffset[i]] = {o.a, o.b, i};
        return pairNear_[std::size_t(s.activePair[i])] ? Take::Counted : Take::No;
      },
      [&](int i) { return s.rowOffset[i]; });
  static_assert(kNoTouch < 16);
  courier_.gatherSmall<4>(s.joinLevel, s.counters->manifolds, [&](int row) { return ownerOfRow(row); });
  if (!s.bounces) return;
  for (const int bounces : courier_.gatherValue(s.counters->bounces))
    s.counters->bounces = std::max(s.counters->bounces, bounces);
}

void RankDivision::shareBreaks() {
  const SolverData& s = data();
  if (!s.hasJoints()) return;
  // elements and attachments that broke are counted everywhere
  int own = 0, all = 0;
  forEachType(JointTypes{}, [&]<class F>() {
    const RankPart& list = joints_[typeIndex<F>(JointTypes{})].own;
    for (int k = 0; k < list.counted; ++k) {
      const Joint<F>& joint = s.jointsOf<F>()[list.index[std::size_t(k)]];
      own += joint.active && joint.broken;
    }
  });
  for (const int count : courier_.gatherValue(own)) all += count;
  s.counters->broken += all - own;
  if (all == 0) return;
  // a flag by joint; owners are known to all
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    const int n = s.joints[kType];
    scratch_.resize(static_cast<std::size_t>(n));
    Joint<F>* const joints = s.jointsOf<F>();
    for (int i = 0; i < n; ++i) scratch_[std::size_t(i)] = joints[i].broken != 0;
    courier_.gatherSmall<1>(scratch_.data(), n, [&](int i) { return joints_[kType].rank[std::size_t(i)]; });
    for (int i = 0; i < n; ++i)
      if (scratch_[std::size_t(i)]) joints[i].broken = 1;
  });
}

/// Continuous collision detection runs everywhere and reads the contacts of fast bodies.
void RankDivision::shareFastPairs() {
  const SolverData& s = data();
  if (s.counters->fastBodies == 0) return;
  RankLists manifolds(static_cast<std::size_t>(ranks())), rows(static_cast<std::size_t>(ranks()));
  for (int k = 0; k < s.counters->pairs; ++k) {
    const int owner = pairOwner_[std::size_t(k)], m = s.activePairOffset[k];
    if (owner < 0 || !s.isActive[k] || !mayImpact(s, ordered(s.pair[k]))) continue;
    manifolds[std::size_t(owner)].push_back(m);
    if (s.generalShapes && s.hasRows[m]) rows[std::size_t(owner)].push_back(s.rowOffset[m]);
  }
  courier_.gather(manifolds, &s.manifold[0]);
  courier_.gather(rows, &s.contact[0]);
}

/// Restitution runs everywhere and reads all contacts, in steps in which any contact bounces.
void RankDivision::shareBounces() {
  const SolverData& s = data();
  RankLists rows(static_cast<std::size_t>(ranks()));
  for (int row = 0; row < s.counters->bounceRows; ++row)
    if (const int owner = ownerOfRow(row); owner >= 0) rows[std::size_t(owner)].push_back(row);
  courier_.gather(rows, &s.contact[0], &s.bounce[0]);
  for (std::vector<int>& list : rows)
    for (int& row : list) row = s.rowBodies[row].manifold;
  courier_.gather(rows, &s.manifold[0]);
  if (s.rolls) courier_.gather(rows, &s.rolling[0]);
}

/// The displacements by which joint projection moves bodies.
void RankDivision::shareGaps() {
  const SolverData& s = data();
  courier_.gatherSmall<1>(s.treeNeedsProjection, s.treeNodes, [&](int n) {
    return s.treeNode[n].body >= 0 && s.treeNode[n].tree == n ? ownerOfNode(n) : kEveryRank;
  });
  RankLists nodes(static_cast<std::size_t>(ranks()));
  for (int n = 0; n < s.treeNodes; ++n)
    if (const int owner = ownerOfNode(n); owner >= 0 && s.treeNeedsProjection[s.treeNode[n].tree] != 0)
      nodes[std::size_t(owner)].push_back(n);
  courier_.gather(nodes, &s.projectionLink[0]);
}

void RankDivision::shareCounts() {
  const SolverData& s = data();
  static constexpr int Counters::*kCounted[] = {&Counters::contacts, &Counters::recycled,
                                                &Counters::failedSolves, &Counters::boundedSteps};
  struct Counts {
    int sums[std::size(kCounted)];
    RankReport rank;
  } own{};
  for (std::size_t k = 0; k < std::size(kCounted); ++k)
    own.sums[k] = std::exchange(s.counters->*kCounted[k], 0);
  own.rank.bodies = own_.size();
  own.rank.ghosts = static_cast<int>(nodes_.size() + ghosts_.size());
  own.rank.rows = rows_.size();
  own.rank.migrated = migrated_;
  reports_.clear();
  for (const Counts& counts : courier_.gatherValue(own)) {
    for (std::size_t k = 0; k < std::size(kCounted); ++k) s.counters->*kCounted[k] += counts.sums[k];
    reports_.push_back(counts.rank);
  }
  imbalance_ = imbalanceOf(reports_);
}

void RankDivision::gatherState() {
  if (std::exchange(holdsAll_, true)) return;
  const SolverData& s = data();
  const std::size_t n = static_cast<std::size_t>(ranks());
  RankLists pairs(n), manifolds(n), rows(n);
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k) {
    const int owner = pairOwner_[std::size_t(k)];
    if (owner < 0) continue;
    pairs[std::size_t(owner)].push_back(k);
    if (const int m = manifoldOfOld(s, k); m >= 0) manifolds[std::size_t(owner)].push_back(m);
  }
  courier_.gather(pairs, &s.oldPairTest[0]);
  courier_.gather(manifolds, &s.oldManifold[0]);
  if (s.counters->rollers > 0) courier_.gather(manifolds, &s.oldRolling[0]);
  for (int row = 0; row < s.counters->manifolds; ++row) {
    const int owner = pairOwner_[std::size_t(s.activePair[s.rowBodies[row].manifold])];
    if (owner >= 0) rows[std::size_t(owner)].push_back(row);
  }
  courier_.gather(rows, &s.contact[0]);
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    RankLists joints(n);
    for (std::size_t i = 0; i < joints_[kType].rank.size(); ++i)
      if (const int owner = joints_[kType].rank[i]; owner >= 0)
        joints[std::size_t(owner)].push_back(static_cast<int>(i));
    courier_.gather(joints, s.jointsOf<F>());
  });
}

}  // namespace rubble::RUBBLE_CORE

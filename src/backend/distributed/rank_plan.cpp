// What a rank evaluates in the iterations of a step, and the poses and sums that ranks exchange for it.
#include <algorithm>

#include "backend/distributed/rank_division.h"
#include "backend/distributed/rank_ends.h"
#include "stages/coarse/coarse.h"

namespace rubble::RUBBLE_CORE {

void RankDivision::plan() {
  planned_ = true, nodesMoved_ = false;
  nodes_.clear();
  seen_.assign(static_cast<std::size_t>(data().bodies), kUnseen);
  findOwn();
  findSlices();
  ask();
  listColors();
  listTrees();
}

/// The moving bodies of each rank.
void RankDivision::findOwn() {
  const SolverData& s = data();
  clearLists(bodies_, ranks());
  own_.clear();
  for (int i = 0; i < s.bodies; ++i) {
    if (!isDynamic(s, i)) continue;
    const int owner = owner_[std::size_t(i)];
    if (owner >= 0) bodies_[std::size_t(owner)].push_back(i);
    if (!isMine(owner)) continue;
    seen_[std::size_t(i)] = kOwn;
    sortIn(own_, others_, i, owner);
  }
  finishList(own_, others_);
}

/// A slice belongs to the rank that owns most of its bodies. That rank evaluates all of its constraints.
void RankDivision::findSlices() {
  const SolverData& s = data();
  slices_.clear();
  for (RankPart& list : levelSlices_) list.clear();
  const int slices = s.plan.coarseCorrection ? s.counters->slices : 0;
  sliceOwner_.resize(static_cast<std::size_t>(slices));
  std::vector<int> votes(static_cast<std::size_t>(ranks()));
  for (int i = 0; i < slices; ++i) {
    const Slice& slice = s.slice[i];
    std::ranges::fill(votes, 0);
    const auto forEachBody = [&](auto&& f) {
      for (int k = slice.begin; k < slice.end; ++k)
        if (s.aggregateNode[k] < s.bodies) f(s.aggregateNode[k]);
    };
    forEachBody([&](int body) {
      if (owner_[std::size_t(body)] >= 0) ++votes[std::size_t(owner_[std::size_t(body)])];
    });
    const auto most = std::ranges::max_element(votes);
    const int owner = *most > 0 ? static_cast<int>(most - votes.begin()) : kEveryRank;
    sliceOwner_[std::size_t(i)] = owner;
    if (!isMine(owner)) continue;
    slices_.index.push_back(i);
    levelSlices_[s.aggregate[slice.aggregate].level].index.push_back(i);
    forEachBody([&](int body) {
      if (seen_[std::size_t(body)] != kUnseen) return;
      seen_[std::size_t(body)] = kNode;
      nodes_.push_back(body);
    });
  }
  slices_.counted = static_cast<int>(slices_.index.size());
  for (RankPart& list : levelSlices_) list.counted = static_cast<int>(list.index.size());
}

/// Boundary constraints of own slices that act on no body of this rank. `rows`, `joints`: by owner.
void RankDivision::findConstraints(RankLists& rows, std::vector<RankLists>& joints) {
  const SolverData& s = data();
  extraRows_.clear();
  std::vector<int> extra[kTypes];
  const auto see = [&](int body) {
    if (body < 0 || body >= s.bodies || seen_[std::size_t(body)] != kUnseen || !isDynamic(s, body)) return;
    seen_[std::size_t(body)] = kNode;
    nodes_.push_back(body);
  };
  const auto visit = [&](std::uint32_t code) {
    if (constraintType(code) == kContactType) {
      const int row = constraintIndex(code);
      see(s.rowBodies[row].a), see(s.rowBodies[row].b);
      if (!pairNear_[std::size_t(s.activePair[s.rowBodies[row].manifold])]) extraRows_.push_back(row);
      return;
    }
    forEachType(JointTypes{}, [&]<class F>() {
      constexpr int kType = typeIndex<F>(JointTypes{});
      if (constraintType(code) != kType + 1) return;
      const int joint = jointIndex<F>(code);
      std::ranges::for_each(endsOf<F>(s, joint), see);
      if (!joints_[kType].near[std::size_t(joint)]) extra[kType].push_back(joint);
    });
  };
  for (const int i : slices_.index) {
    const Slice& slice = s.slice[i];
    for (int k = slice.begin; k < slice.end; ++k) {
      const int body = s.aggregateNode[k];
      // all constraints of own bodies are near
      if (body < s.bodies && seen_[std::size_t(body)] != kOwn)
        visitBoundaryOf(s, body, s.aggregate[slice.aggregate].level, visit);
    }
  }
  const auto unique = [](std::vector<int>& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  unique(extraRows_);
  for (const int row : extraRows_) rows[std::size_t(ownerOfRow(row))].push_back(row);
  for (int type = 0; type < kTypes; ++type) {
    unique(extra[type]);
    JointParts& parts = joints_[type];
    for (const int i : extra[type])
      joints[std::size_t(type)][std::size_t(parts.rank[std::size_t(i)])].push_back(i);
    parts.all = parts.own;
    parts.all.index.insert(parts.all.index.end(), extra[type].begin(), extra[type].end());
    parts.ownParts.clear(), parts.allParts.clear();
  }
  rows_ = ownRows_;
  rows_.insert(rows_.end(), extraRows_.begin(), extraRows_.end());
}

/// Bodies of other ranks whose poses this rank needs, by owner.
void RankDivision::findGhosts(RankLists& ghosts, RankLists& nodes) {
  const SolverData& s = data();
  ghosts_.clear();
  for (const int i : own_.index)
    for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) {
      const int other = s.incidence[k].other;
      if (other < 0 || other >= s.bodies) continue;
      if (Seen(seen_[std::size_t(other)]) != kUnseen && Seen(seen_[std::size_t(other)]) != kNode) continue;
      seen_[std::size_t(other)] = kGhost;
      ghosts_.push_back(other);
    }
  std::erase_if(nodes_, [&](int i) { return seen_[std::size_t(i)] != kNode; });
  const auto list = [&](std::vector<int>& bodies, RankLists& to) {
    std::ranges::sort(bodies);
    for (const int i : bodies) to[std::size_t(owner_[std::size_t(i)])].push_back(i);
  };
  list(ghosts_, ghosts), list(nodes_, nodes);
}

/// Aggregates that move a body that this rank sees, and the slices of other ranks whose sums they need.
/// Aggregates with soft nodes move everywhere.
void RankDivision::findAggregates(RankLists& slices) {
  const SolverData& s = data();
  for (int level = 0; level < kCoarseLevels; ++level) aggregates_[level].clear(), moving_[level].clear();
  seenAggregates_.clear(), seenSlices_.clear();
  if (sliceOwner_.empty()) return;
  for (int level = 0; level < kCoarseLevels; ++level) {
    for (int g = s.levelAggregate[level]; g < s.levelAggregate[level + 1]; ++g) {
      const Aggregate& aggregate = s.aggregate[g];
      bool seen = aggregate.soft != 0;
      for (int i = aggregate.sliceBegin; i < aggregate.sliceEnd; ++i) {
        const Slice& slice = s.slice[i];
        const auto isSeen = [&](int k) {
          const int node = s.aggregateNode[k];
          return node < s.bodies && seen_[std::size_t(node)] != kUnseen;
        };
        bool moves = false;
        for (int k = slice.begin; k < slice.end && !moves; ++k) moves = isSeen(k);
        if (moves) moving_[level].index.push_back(i);
        seen |= moves;
      }
      if (!seen) continue;
      seenAggregates_.push_back(g);
      sortIn(aggregates_[level], others_, g, sliceOwner_[std::size_t(aggregate.sliceBegin)]);
      for (int i = aggregate.sliceBegin; i < aggregate.sliceEnd; ++i) {
        seenSlices_.push_back(i);
        const int owner = sliceOwner_[std::size_t(i)];
        if (!isMine(owner)) slices[std::size_t(owner)].push_back(i);
      }
    }
    finishList(aggregates_[level], others_);
    moving_[level].counted = static_cast<int>(moving_[level].index.size());
  }
}

/// Asks the owners for bodies, rows, slices and joints, and fetches rows and joints as they begin the step.
void RankDivision::ask() {
  const SolverData& s = data();
  enum { kGhosts, kNodes, kRows, kSlices, kJoints };
  std::vector<RankLists> needs(kJoints + kTypes, RankLists(static_cast<std::size_t>(ranks())));
  std::vector<RankLists> joints(kTypes, RankLists(static_cast<std::size_t>(ranks())));
  findConstraints(needs[kRows], joints);
  findGhosts(needs[kGhosts], needs[kNodes]);
  findAggregates(needs[kSlices]);
  std::ranges::move(joints, needs.begin() + kJoints);
  const std::vector<RankTraffic> traffic = courier_.ask(std::move(needs));

  courier_.swap(traffic[kRows], &s.contact[0]);
  if (s.rolls) {
    RankTraffic rolling = traffic[kRows];
    for (RankLists* lists : {&rolling.give, &rolling.take})
      for (std::vector<int>& list : *lists)
        for (int& row : list) row = s.rowBodies[row].manifold;
    courier_.swap(rolling, &s.rolling[0]);
  }
  forEachType(JointTypes{}, [&]<class F>() {
    courier_.swap(traffic[std::size_t(kJoints + typeIndex<F>(JointTypes{}))], s.jointsOf<F>());
  });

  // the traffic of a color, of a level, and of trees
  const int colors = s.counters->colors;
  colorPoses_.resize(static_cast<std::size_t>(colors)), sliceSums_.resize(kCoarseLevels);
  for (RankTraffic& t : colorPoses_) t.clear(ranks());
  for (RankTraffic& t : sliceSums_) t.clear(ranks());
  treePoses_.clear(ranks());
  const auto split = [&](const RankLists& bodies, const RankLists& slices, RankLists RankTraffic::*side) {
    for (std::size_t r = 0; r < bodies.size(); ++r) {
      for (const int i : bodies[r]) {
        if (isSwept(s, i)) (colorPoses_[std::size_t(s.color[i])].*side)[r].push_back(i);
        if (s.plan.jointTrees && s.nodeOfBody[i] >= 0) (treePoses_.*side)[r].push_back(i);
      }
      for (const int i : slices[r])
        (sliceSums_[std::size_t(s.aggregate[s.slice[i].aggregate].level)].*side)[r].push_back(i);
    }
  };
  split(traffic[kGhosts].give, traffic[kSlices].give, &RankTraffic::give);
  split(traffic[kGhosts].take, traffic[kSlices].take, &RankTraffic::take);
  nodePoses_ = traffic[kNodes];
}

void RankDivision::listColors() {
  const SolverData& s = data();
  colors_.resize(static_cast<std::size_t>(s.counters->colors));
  for (RankPart& list : colors_) list.clear();
  const auto list = [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      if (const int i = own_.index[std::size_t(k)]; isSwept(s, i))
        colors_[std::size_t(s.color[i])].index.push_back(i);
  };
  list(0, own_.counted);
  for (RankPart& color : colors_) color.counted = static_cast<int>(color.index.size());
  list(own_.counted, static_cast<int>(own_.index.size()));
}

void RankDivision::listTrees() {
  const SolverData& s = data();
  treeNodes_.clear(), smallTrees_.clear();
  for (int n = 0; n < s.treeNodes; ++n)
    if (s.treeNode[n].body >= 0 && isMine(ownerOfNode(n))) treeNodes_.push_back(n);
  for (int t = 0; t < s.smallTrees; ++t)
    if (s.smallTree[t].begin < s.smallTree[t].end && isMine(ownerOfNode(s.smallTree[t].begin)))
      smallTrees_.push_back(t);
}

}  // namespace rubble::RUBBLE_CORE

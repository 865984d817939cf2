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

/// The elements of a list that satisfy a test, in its order.
template <class Test> void RankDivision::filter(RankPart& to, const RankPart& from, Test&& test) {
  const auto at = [&](int k) { return from.index[std::size_t(k)]; };
  lister_.list(
      to, from.size(), [&](int k) { return test(at(k)) ? Take::Counted : Take::No; }, at);
}

/// The moving bodies of each rank.
void RankDivision::findOwn() {
  const SolverData& s = data();
  lister_.list(own_, s.bodies, [&](int i) {
    const int owner = owner_[std::size_t(i)];
    if (!isMine(owner) || !isDynamic(s, i)) return Take::No;
    seen_[std::size_t(i)] = kOwn;
    return takeOf(owner);
  });
  lister_.group(ownerBodies_, s.bodies, ranks(),
                [&](int i) { return isDynamic(s, i) ? owner_[std::size_t(i)] : -1; });
  bodies_.resize(static_cast<std::size_t>(ranks()));
  for (int r = 0; r < ranks(); ++r) {
    const Part part = ownerBodies_.part(r);
    bodies_[std::size_t(r)].assign(part.index, part.index + part.count);
  }
}

/// A slice belongs to the rank that owns most of its bodies. That rank evaluates all of its constraints.
void RankDivision::findSlices() {
  const SolverData& s = data();
  const int slices = s.plan.coarseCorrection ? s.counters->slices : 0;
  sliceOwner_.resize(static_cast<std::size_t>(slices));
  const auto forEachBody = [&](int i, auto&& f) {
    for (int k = s.slice[i].begin; k < s.slice[i].end; ++k)
      if (s.aggregateNode[k] < s.bodies) f(s.aggregateNode[k]);
  };
  forEachOfRanges(
      slices, rangesFor(slices * kSliceNodes, lister_.threads()), [&](std::size_t, int begin, int end) {
        std::vector<int> votes(static_cast<std::size_t>(ranks()));
        for (int i = begin; i < end; ++i) {
          std::ranges::fill(votes, 0);
          forEachBody(i, [&](int body) {
            if (owner_[std::size_t(body)] >= 0) ++votes[std::size_t(owner_[std::size_t(body)])];
          });
          const auto most = std::ranges::max_element(votes);
          sliceOwner_[std::size_t(i)] = *most > 0 ? static_cast<int>(most - votes.begin()) : kEveryRank;
        }
      });
  lister_.list(slices_, slices,
               [&](int i) { return isMine(sliceOwner_[std::size_t(i)]) ? Take::Counted : Take::No; });
  lister_.group(levelSlices_, slices_, kCoarseLevels,
                [&](int i) { return s.aggregate[s.slice[i].aggregate].level; });
  filter(borderSlices_, slices_, [&](int i) {
    bool others = false;
    forEachBody(i, [&](int body) { others |= seen_[std::size_t(body)] == kUnseen; });
    return others;
  });
  for (const int i : borderSlices_.index)
    forEachBody(i, [&](int body) {
      if (seen_[std::size_t(body)] != kUnseen) return;
      seen_[std::size_t(body)] = kNode;
      nodes_.push_back(body);
    });
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
  for (const int i : borderSlices_.index) {
    const Slice& slice = s.slice[i];
    for (int k = slice.begin; k < slice.end; ++k) {
      const int body = s.aggregateNode[k];
      // all constraints of own bodies are near
      if (body < s.bodies && seen_[std::size_t(body)] != kOwn)
        visitBoundaryOf(s, s.aggregate[slice.aggregate], body,
                        [&](const BoundaryConstraint& c) { visit(c.code); });
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
  rows_.index.insert(rows_.index.end(), extraRows_.begin(), extraRows_.end());
}

/// Bodies of other ranks whose poses this rank needs, by owner.
void RankDivision::findGhosts(RankLists& ghosts, RankLists& nodes) {
  const SolverData& s = data();
  ghosts_.clear();
  const auto forEachGhost = [&](int i, auto&& f) {
    for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) {
      const int other = s.incidence[k].other;
      if (other < 0 || other >= s.bodies) continue;
      if (const Seen seen = Seen(seen_[std::size_t(other)]); seen == kUnseen || seen == kNode) f(other);
    }
  };
  filter(border_, own_, [&](int i) {
    bool any = false;
    forEachGhost(i, [&](int) { any = true; });
    return any;
  });
  for (const int i : border_.index)
    forEachGhost(i, [&](int other) {
      seen_[std::size_t(other)] = kGhost;
      ghosts_.push_back(other);
    });
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
  const int all = static_cast<int>(sliceOwner_.size());
  sliceMoves_.resize(sliceOwner_.size());
  forEachOfMany(all, lister_.threads(), [&](int i) {
    const int* const nodes = &s.aggregateNode[0];
    sliceMoves_[std::size_t(i)] = std::any_of(
        nodes + s.slice[i].begin, nodes + s.slice[i].end,
        [&](int node) { return node < s.bodies && seen_[std::size_t(node)] != kUnseen; });
  });
  const int aggregates = all > 0 ? s.counters->aggregates : 0;
  isSeen_.resize(static_cast<std::size_t>(aggregates));
  lister_.list(seenAggregates_, aggregates, [&](int g) {
    const Aggregate& aggregate = s.aggregate[g];
    const auto moves = sliceMoves_.begin();
    const bool seen = aggregate.soft != 0 ||
                      std::any_of(moves + aggregate.sliceBegin, moves + aggregate.sliceEnd,
                                  [](std::uint8_t any) { return any != 0; });
    isSeen_[std::size_t(g)] = seen;
    return seen ? takeOf(sliceOwner_[std::size_t(aggregate.sliceBegin)]) : Take::No;
  });
  lister_.group(levelAggregates_, seenAggregates_, kCoarseLevels,
                [&](int g) { return s.aggregate[g].level; });
  lister_.list(seenSlices_, all,
               [&](int i) { return isSeen_[std::size_t(s.slice[i].aggregate)] ? Take::Counted : Take::No; });
  lister_.group(movingSlices_, seenSlices_, kCoarseLevels, [&](int i) {
    return sliceMoves_[std::size_t(i)] ? s.aggregate[s.slice[i].aggregate].level : -1;
  });
  for (const int i : seenSlices_.index)
    if (const int owner = sliceOwner_[std::size_t(i)]; !isMine(owner))
      slices[std::size_t(owner)].push_back(i);
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
  lister_.group(colors_, own_, s.counters->colors, [&](int i) { return isSwept(s, i) ? s.color[i] : -1; });
}

void RankDivision::listTrees() {
  const SolverData& s = data();
  lister_.list(treeNodes_, s.treeNodes, [&](int n) {
    return s.treeNode[n].body >= 0 && isMine(ownerOfNode(n)) ? Take::Counted : Take::No;
  });
  lister_.list(smallTrees_, s.smallTrees, [&](int t) {
    const int begin = s.smallTree[t].begin;
    return begin < s.smallTree[t].end && isMine(ownerOfNode(begin)) ? Take::Counted : Take::No;
  });
}

}  // namespace rubble::RUBBLE_CORE

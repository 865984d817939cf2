#include "backend/distributed/peer_division.h"

#include <algorithm>
#include <array>
#include <string>

namespace rubble::RUBBLE_CORE {

namespace {

PeerBox boxOf(LetterBox& letters) {
  const auto grow = [](PeerBox& box, int needed) {
    LetterBox& to = *static_cast<LetterBox*>(box.owner);
    to.resize(std::max<std::size_t>(2 * to.size(), static_cast<std::size_t>(needed) + 1));
    box = boxOf(to);
  };
  return {reinterpret_cast<PeerBoxHead*>(letters.data()), letters.data() + 1,
          static_cast<int>(letters.size()) - 1, grow, &letters};
}

}  // namespace

PeerDivision::PeerDivision(HostTables& tables, Transport& transport, const RankOptions& options, int threads)
    : tables_(tables),
      transport_(transport),
      courier_(transport),
      exchange_(options.exchange),
      ranks_(static_cast<std::size_t>(transport.ranks())),
      sums_(static_cast<std::size_t>(transport.ranks())),
      lister_(threads) {
  if (transport.ranks() > kMostPeers)
    throw Error("ranks.count", "at most " + std::to_string(kMostPeers) + " ranks that store or send letters",
                std::to_string(transport.ranks()));
  data_.rank = transport.rank(), data_.ranks = transport.ranks();
  data_.at = ranks_.data(), data_.cut = &cut_, data_.sums = sums_.data(), data_.listed = listed_;
  cut_.interval = options.cutInterval, cut_.maxImbalance = options.maxImbalance;
  if (exchange_ == RankExchange::Letters) {
    out_.resize(ranks_.size(), LetterBox(1)), in_.resize(ranks_.size()), boxes_.resize(ranks_.size());
    for (std::size_t r = 0; r < ranks_.size(); ++r) boxes_[r] = boxOf(out_[r]);
    data_.box = boxes_.data();
  }
  restart();
}

void PeerDivision::fit() {
  const SolverData& s = tables();
  const auto size = [](auto& array, std::size_t n, auto*& to) {
    if (array.size() < n) array.resize(n);
    to = array.data();
  };
  const auto capacity = [&](Per per) { return static_cast<std::size_t>(tables_.capacity(per)); };
  const std::size_t bodies = capacity(Per::Body);
  data_.stride = static_cast<int>(bodies);
  size(owner_, bodies, data_.owner), size(ownerBefore_, bodies, data_.ownerBefore);
  size(moves_, bodies, data_.moves), size(movesBefore_, bodies, data_.movesBefore);
  size(seen_, bodies * static_cast<std::size_t>(data_.ranks), data_.seen);
  size(seenBy_, bodies, data_.seenBy);
  size(sharedRoot_, bodies * kCoarseLevels, data_.sharedRoot);
  size(sliceOwner_, static_cast<std::size_t>(s.counters->slices), data_.sliceOwner);
  size(sees_, static_cast<std::size_t>(s.counters->aggregates), data_.sees);
  size(mixed_, static_cast<std::size_t>(s.counters->aggregates), data_.mixed);
  size(extraRow_, static_cast<std::size_t>(s.counters->manifolds), data_.extraRow);
  // others store into these
  const std::size_t ranks = static_cast<std::size_t>(data_.ranks);
  size(sharedPartner_, capacity(Per::Pair), data_.sharedPartner);
  size(rowAskers_, capacity(Per::Manifold) * ranks, data_.rowAskers);
  for (int type = 0; type < JointTypes::kSize; ++type) {
    size(extraJoint_[type], static_cast<std::size_t>(s.joints[type]), data_.extraJoint[type]);
    size(jointAskers_[type], capacity(perJoint(type)) * ranks, data_.jointAskers[type]);
  }
}

template <class Test> PeerDivision::Take PeerDivision::takeOf(const Test& test, int element) const {
  if constexpr (requires { test.ownerOf(tables(), element); })
    if (!data_.counts(test.ownerOf(tables(), element))) return Take::Other;
  return Take::Counted;
}
template <class Test> void PeerDivision::select(PeerList list, const Test& test, int n) {
  lister_.list(of(list), n, [&](int i) { return test(tables(), i) ? takeOf(test, i) : Take::No; });
  listedIn(list);
}
template <class Test> void PeerDivision::selectOf(PeerList list, PeerList from, const Test& test) {
  const RankPart& all = of(from);
  const auto at = [&](int k) { return all.index[std::size_t(k)]; };
  const auto elementOf = [&](int k) { return test.of(tables(), at(k)); };
  lister_.list(
      of(list), all.size(),
      [&](int k) { return test(tables(), at(k)) ? takeOf(test, elementOf(k)) : Take::No; }, elementOf);
  listedIn(list);
}
void PeerDivision::join(PeerList list, PeerList more) {
  of(list).join(of(beginningOf(list)), of(more));
  listedIn(list);
}

/// All bodies between the cuts.
Division::Part PeerDivision::partOfHomes(int n) {
  const PeerHome home = data_.home();
  if (!home.cut) return {nullptr, n, n};
  const int begin = home.cut->begin[data_.rank], end = home.cut->begin[data_.rank + 1];
  if (homes_.size() != end - begin || (end > begin && homes_.index.front() != begin)) {
    homes_.index.resize(static_cast<std::size_t>(end - begin));
    std::iota(homes_.index.begin(), homes_.index.end(), begin);
    homes_.counted = homes_.size();
  }
  return homes_.part();
}

template <class Mine> Division::Part PeerDivision::partBy(RankPart& list, int n, Mine&& mine) {
  lister_.list(list, n, [&](int i) { return mine(i) ? Take::Counted : Take::No; });
  return list.part();
}

/// The elements of a list of joints, with several parts per joint.
Division::Part PeerDivision::partOfJoints(PeerJoints kind, int n, int type) {
  const PeerList list = listOfJoints(kind, type);
  const int perJoint = n / tables().joints[type];
  if (perJoint == 1) return of(list).part();
  RankPart& parts = jointParts_[static_cast<int>(list)];
  if (parts.size() != of(list).size() * perJoint) lister_.listParts(parts, of(list), perJoint);
  return parts.part();
}

int PeerDivision::ownerOfNode(int n) const {
  const int body = tables().treeNode[n].body;
  return body < 0 ? kEveryPeer : data_.owner[body];
}

Division::Part PeerDivision::part(Cut cut, int n, int which) {
  const SolverData& s = tables();
  if (cut > Cut::Tested) plan();
  switch (cut) {
    case Cut::Whole:
      return {nullptr, n, n};
    case Cut::Homes:
      return partOfHomes(n);
    case Cut::Tested:  // this rank lists near pairs only
      lister_.list(tested_, n, [&](int k) { return takeOf(NearActivePair{data_}, s.tested[k]); });
      return tested_.part();
    case Cut::ActivePairs:
      if (!std::exchange(activeListed_, true)) peers::listActivePairs(*this);
      [[fallthrough]];
    case Cut::Pairs:
    case Cut::JoinedRows:
    case Cut::Rows:
    case Cut::OwnRows:
    case Cut::Bodies:
    case Cut::Slices:
    case Cut::SeenSlices:
      return of(peerListOf(cut)).part();
    case Cut::LevelSlices:
      return levelSlices_.part(which);
    case Cut::LevelMoves:
      return levelMoves_.part(which);
    case Cut::SeenAggregates: {
      const int all = seenAggregates_.size();
      return {seenAggregates_.index.data(), all, all};
    }
    case Cut::LevelAggregates:
      return levelAggregates_.part(which);
    case Cut::Joints:
      return partOfJoints(PeerJoints::All, n, which);
    case Cut::OwnJoints:
      return partOfJoints(PeerJoints::Own, n, which);
    case Cut::TreeNodes:
      return treeNodes_.part();
    case Cut::LevelNodes:
      return partBy(levelNodes_, n, [&](int k) { return data_.isMine(ownerOfNode(s.levelNode[which + k])); });
    case Cut::SmallTrees:
      return smallTrees_.part();
  }
  return {};
}

Division::Part PeerDivision::color(int color) {
  plan();
  if (color == 0) settle(), peers::beginColors(*this);
  return colors_.part(color);
}

void PeerDivision::plan() {
  if (std::exchange(planned_, true)) return;
  settle();
  fit();
  peers::plan(*this);
  const SolverData& s = tables();
  const auto colorOf = [&](int i) { return isSwept(s, i) ? s.color[i] : -1; };
  lister_.group(colors_, of(PeerList::Bodies), s.counters->colors, colorOf);
  lister_.group(sharedColors_, of(PeerList::SharedBodies), s.counters->colors, colorOf);
  if (s.plan.coarseCorrection) planAggregates();
  partBy(treeNodes_, s.treeNodes,
         [&](int k) { return s.treeNode[k].body >= 0 && data_.isMine(ownerOfNode(k)); });
  partBy(smallTrees_, s.smallTrees, [&](int k) {
    const SmallTree& tree = s.smallTree[k];
    return tree.begin < tree.end && data_.isMine(ownerOfNode(tree.begin));
  });
}

/// Slices and aggregates by level.
void PeerDivision::planAggregates() {
  const SolverData& s = tables();
  const auto levelOf = [&](int slice) { return s.aggregate[s.slice[slice].aggregate].level; };
  const auto moves = [&](int slice) {
    const int* const nodes = &s.aggregateNode[0];
    return std::any_of(nodes + s.slice[slice].begin, nodes + s.slice[slice].end,
                       [&](int node) { return isSeen(node); });
  };
  lister_.group(levelSlices_, of(PeerList::Slices), kCoarseLevels, levelOf);
  lister_.group(levelMoves_, of(PeerList::SeenSlices), kCoarseLevels,
                [&](int slice) { return moves(slice) ? levelOf(slice) : -1; });
  lister_.list(seenAggregates_, s.counters->aggregates, [&](int i) {
    if (data_.sees[i] == 0) return Take::No;
    return data_.counts(data_.sliceOwner[s.aggregate[i].sliceBegin]) ? Take::Counted : Take::Other;
  });
  lister_.group(levelAggregates_, seenAggregates_, kCoarseLevels,
                [&](int i) { return s.aggregate[i].level; });
}

void PeerDivision::share(Share what, int which) {
  if (what == Share::None) return;
  if (what == Share::Homes) {
    planned_ = activeListed_ = summed_ = atRest_ = false;
    for (RankPart& list : lists_) list.clear();
    for (RankPart& list : jointParts_) list.clear();
    std::ranges::fill(listed_, 0);
  }
  settle();
  switch (what) {
    case Share::NodePoses:  // all that see a body have its pose
      if (!std::exchange(summed_, tables().plan.coarseCorrection)) peers::beginSums(*this);
      return;
    case Share::ColorPoses: {
      const Part shared = sharedColors_.part(which);
      each(ShareColor{{data_}, shared.index}, shared.count);
      return barrier();
    }
    case Share::Counts:
      // the tables of the next step
      swaps_ = atRest_ = true;
      peers::shareCounts(*this);
      swaps_ = false;
      reports_.clear();
      for (const PeerSums& of : sums_)
        reports_.push_back({.bodies = of.counts.bodies,
                            .ghosts = of.counts.ghosts,
                            .rows = of.counts.rows,
                            .migrated = of.counts.migrated});
      return;
    default:
      return peers::share(*this, what, which);
  }
}

void PeerDivision::gatherState() {
  if (std::exchange(cut_.holdsAll, 1)) return;
  settle();
  peers::gatherState(*this);
}

void PeerDivision::settle() {
  for (int per = 0; per < kPerCount; ++per)
    if (capacities_.empty() || capacities_[std::size_t(per)] != tables_.capacity(static_cast<Per>(per))) {
      fit();
      return barrier();
    }
}

void PeerDivision::barrier() {
  capacities_.resize(kPerCount);
  for (int per = 0; per < kPerCount; ++per)
    capacities_[std::size_t(per)] = tables_.capacity(static_cast<Per>(per));
  PeerRank own{tables(), data_};
  if (swaps_) {
    std::swap(own.s.manifold, own.s.oldManifold), std::swap(own.s.oldPairTest, own.s.pairTest);
    std::swap(own.s.rolling, own.s.oldRolling);
  }
  // in a step ranks store rows only where they will lie
  if (!atRest_ || swaps_)
    own.s.contact = arrayOf(reinterpret_cast<ContactRows*>(static_cast<Manifold*>(own.s.oldManifold)),
                            static_cast<std::size_t>(tables_.capacity(Per::ActivePair)));
  passTurn();
  if (data_.box) exchangeLetters();
  std::ranges::copy(courier_.gatherValue(own), ranks_.begin());
  ++turn_;
  if (exchange_ == RankExchange::StoresInTurns && !atRest_) takeTurn();
}

/// Sends all boxes, and does what the letters of others say.
void PeerDivision::exchangeLetters() {
  std::array<int, kMostPeers> counts{};
  for (std::size_t r = 0; r < boxes_.size(); ++r) counts[r] = boxes_[r].head->count;
  const auto all = courier_.gatherValue(counts);
  std::vector<Transport::Send> sends;
  std::vector<Transport::Receive> receives;
  for (std::size_t r = 0; r < boxes_.size(); ++r) {
    in_[r].resize(static_cast<std::size_t>(all[r][static_cast<std::size_t>(data_.rank)]));
    const std::span letters(boxes_[r].letter, static_cast<std::size_t>(counts[r]));
    if (!letters.empty()) sends.push_back({static_cast<int>(r), std::as_bytes(letters)});
    if (!in_[r].empty()) receives.push_back({static_cast<int>(r), std::as_writable_bytes(std::span(in_[r]))});
  }
  transport_.exchange(sends, receives);
  for (std::size_t r = 0; r < boxes_.size(); ++r) {
    std::ranges::for_each(in_[r], [](const PeerLetter& letter) { deliver(letter); });
    in_[r].clear(), boxes_[r].head->count = 0;
  }
}

namespace {

/// The rank that comes next after `rank` in the interval after a barrier, or -1. Odd intervals go backward.
int after(int rank, int ranks, int turn, bool forward) {
  const int first = turn / 2 % ranks, step = (turn % 2 == 0) == forward ? 1 : ranks - 1;
  const int end = forward == (turn % 2 == 0) ? (first + ranks - 1) % ranks : first;
  return rank == end ? -1 : (rank + step) % ranks;
}

}  // namespace

void PeerDivision::passTurn() {
  if (!std::exchange(hasTurn_, false)) return;
  if (const int next = after(data_.rank, data_.ranks, turn_, true); next >= 0) {
    RankTraffic token;
    token.clear(data_.ranks);
    token.give[std::size_t(next)] = {0};
    courier_.swap(token, &turn_);
  }
}
void PeerDivision::takeTurn() {
  hasTurn_ = true;
  if (const int before = after(data_.rank, data_.ranks, turn_, false); before >= 0) {
    RankTraffic token;
    token.clear(data_.ranks);
    token.take[std::size_t(before)] = {0};
    courier_.swap(token, &turn_);
  }
}

}  // namespace rubble::RUBBLE_CORE

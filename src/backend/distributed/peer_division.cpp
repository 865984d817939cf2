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

PeerDivision::PeerDivision(HostTables& tables, Transport& transport, const RankOptions& options)
    : tables_(tables),
      transport_(transport),
      courier_(transport),
      exchange_(options.exchange),
      ranks_(static_cast<std::size_t>(transport.ranks())),
      sums_(static_cast<std::size_t>(transport.ranks())) {
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

template <class Test> void PeerDivision::add(List& to, const Test& test, int i) {
  to.index.push_back(i);
  if constexpr (requires { test.ownerOf(tables(), i); })
    if (!data_.counts(test.ownerOf(tables(), i))) to.other.push_back(i);
}
template <class Test> void PeerDivision::select(PeerList list, const Test& test, int n) {
  List& to = lists_[static_cast<int>(list)];
  for (int i = 0; i < n; ++i)
    if (test(tables(), i)) add(to, test, i);
  listed_[static_cast<int>(list)] = static_cast<int>(to.index.size());
}
template <class Test> void PeerDivision::selectOf(PeerList list, PeerList from, const Test& test) {
  List& to = lists_[static_cast<int>(list)];
  for (const int k : elements(from))
    if (test(tables(), k)) add(to, test, test.of(tables(), k));
  listed_[static_cast<int>(list)] = static_cast<int>(to.index.size());
}
void PeerDivision::join(PeerList list, PeerList more) {
  List& to = lists_[static_cast<int>(list)];
  const List& then = lists_[static_cast<int>(more)];
  to = lists_[static_cast<int>(beginningOf(list))];
  to.index.insert(to.index.end(), then.index.begin(), then.index.end());
  to.other.insert(to.other.end(), then.other.begin(), then.other.end());
  listed_[static_cast<int>(list)] = static_cast<int>(to.index.size());
}

template <class Test> Division::Part PeerDivision::partOf(const List& list, Test&& test) {
  part_.clear(), spare_.clear();
  auto other = list.other.begin();
  for (const int i : list.index) {
    const bool counts = other == list.other.end() || *other != i;
    if (!counts) ++other;
    if (test(i)) (counts ? part_ : spare_).push_back(i);
  }
  const int counted = static_cast<int>(part_.size());
  part_.insert(part_.end(), spare_.begin(), spare_.end());
  return {part_.data(), counted, static_cast<int>(part_.size())};
}

Division::Part PeerDivision::partOf(PeerList list) {
  return partOf(lists_[static_cast<int>(list)], [](int) { return true; });
}

template <class Mine> Division::Part PeerDivision::partBy(int n, Mine&& mine) {
  part_.clear();
  for (int i = 0; i < n; ++i)
    if (mine(i)) part_.push_back(i);
  return {part_.data(), static_cast<int>(part_.size()), static_cast<int>(part_.size())};
}

/// The elements of a list of joints, with several parts per joint.
Division::Part PeerDivision::partOfJoints(PeerJoints kind, int n, int type) {
  Part joints = partOf(listOfJoints(kind, type));
  const int perJoint = n / tables().joints[type];
  if (perJoint == 1) return joints;
  spare_.clear();
  for (const int i : part_)
    for (int k = 0; k < perJoint; ++k) spare_.push_back(i * perJoint + k);
  part_.swap(spare_);
  return {part_.data(), joints.counted * perJoint, static_cast<int>(part_.size())};
}

int PeerDivision::ownerOfNode(int n) const {
  const int body = tables().treeNode[n].body;
  return body < 0 ? kEveryPeer : data_.owner[body];
}

Division::Part PeerDivision::part(Cut cut, int n, int which) {
  const SolverData& s = tables();
  const auto levelOf = [&](int slice) { return s.aggregate[s.slice[slice].aggregate].level; };
  if (cut > Cut::Tested) plan();
  switch (cut) {
    case Cut::Whole:
    case Cut::Tested:  // this rank lists near pairs only
      return {nullptr, n, n};
    case Cut::Homes:
      return partBy(n, [&](int i) { return data_.home().has(i); });
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
      return partOf(peerListOf(cut));
    case Cut::LevelSlices:
      return partOf(lists_[static_cast<int>(PeerList::Slices)], [&](int i) { return levelOf(i) == which; });
    case Cut::LevelMoves:
      return partOf(lists_[static_cast<int>(PeerList::SeenSlices)], [&](int i) {
        return levelOf(i) == which &&
               std::any_of(&s.aggregateNode[0] + s.slice[i].begin, &s.aggregateNode[0] + s.slice[i].end,
                           [&](int node) { return isSeen(node); });
      });
    case Cut::SeenAggregates:
      return partBy(n, [&](int i) { return data_.sees[i] != 0; });
    case Cut::LevelAggregates: {
      List all;
      for (int i = s.levelAggregate[which]; i < s.levelAggregate[which + 1]; ++i) {
        if (data_.sees[i] == 0) continue;
        all.index.push_back(i);
        if (!data_.counts(data_.sliceOwner[s.aggregate[i].sliceBegin])) all.other.push_back(i);
      }
      return partOf(all, [](int) { return true; });
    }
    case Cut::Joints:
      return partOfJoints(PeerJoints::All, n, which);
    case Cut::OwnJoints:
      return partOfJoints(PeerJoints::Own, n, which);
    case Cut::TreeNodes:
      return partBy(n, [&](int k) { return s.treeNode[k].body >= 0 && data_.isMine(ownerOfNode(k)); });
    case Cut::LevelNodes:
      return partBy(n, [&](int k) { return data_.isMine(ownerOfNode(s.levelNode[which + k])); });
    case Cut::SmallTrees:
      return partBy(n, [&](int k) {
        const SmallTree& tree = s.smallTree[k];
        return tree.begin < tree.end && data_.isMine(ownerOfNode(tree.begin));
      });
  }
  return {};
}

Division::Part PeerDivision::color(int color) {
  plan();
  if (color == 0) settle(), peers::beginColors(*this);
  const SolverData& s = tables();
  const Part part = partOf(lists_[static_cast<int>(PeerList::Bodies)],
                           [&](int i) { return isSwept(s, i) && s.color[i] == color; });
  colorList_ = part_;
  return part;
}

void PeerDivision::plan() {
  if (std::exchange(planned_, true)) return;
  settle();
  fit();
  peers::plan(*this);
}

void PeerDivision::share(Share what, int which) {
  if (what == Share::None) return;
  if (what == Share::Homes) {
    planned_ = activeListed_ = summed_ = atRest_ = false;
    for (List& list : lists_) list.index.clear(), list.other.clear();
    std::ranges::fill(listed_, 0);
  }
  settle();
  switch (what) {
    case Share::NodePoses:  // all that see a body have its pose
      if (!std::exchange(summed_, tables().plan.coarseCorrection)) peers::beginSums(*this);
      return;
    case Share::ColorPoses:
      each(ShareColor{{data_}, colorList_.data()}, static_cast<int>(colorList_.size()));
      return barrier();
    case Share::Counts:
      // the tables of the next step
      swaps_ = atRest_ = true;
      peers::shareCounts(*this);
      swaps_ = false;
      reports_.clear();
      for (const PeerSums& of : sums_)
        reports_.push_back(
            {.bodies = of.bodies, .ghosts = of.ghosts, .rows = of.rows, .migrated = of.migrated});
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

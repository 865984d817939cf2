// The beginning of a step: who owns the bodies, pairs and joints, and the state that new owners need.
#include <algorithm>
#include <bit>

#include "backend/distributed/rank_division.h"
#include "backend/distributed/rank_ends.h"
#include "stages/pairs/order.h"
#include "stages/soft/body_corners.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Least number of steps between cuts by imbalance, and most after cuts that did not help.
constexpr int kLeastPause = 8, kMostPause = 1024;
/// Cost of a body without contacts, in contacts.
constexpr int kBodyCost = 2;
/// Deviation of the cost of a part that a cut between larger cells may cause [1].
constexpr double kCutSlack = .06;

}  // namespace

void RankDivision::beginStep() {
  planned_ = activeListed_ = false;
  migrated_ = 0;
  std::swap(owner_, ownerBefore_), std::swap(moves_, movesBefore_);
  std::swap(pairOwner_, pairOwnerBefore_), std::swap(pairNear_, pairNearBefore_);
  findOwners();
  ownersMoved_ = owner_ != ownerBefore_ || moves_ != movesBefore_;
  classifyPairs();
  classifyJoints();
  const bool jointsMoved = std::ranges::any_of(joints_,
                                               [](const JointParts& j) { return j.rank != j.rankBefore; });
  if (!holdsAll_ && (ownersMoved_ || jointsMoved)) migrate();
  holdsAll_ = false;
}

bool RankDivision::needsCut() {
  ++sinceCut_;
  if (!isCut_) return true;
  if (options_.cutInterval > 0) return sinceCut_ >= options_.cutInterval;
  return imbalance_ > options_.maxImbalance && sinceCut_ >= std::max(kLeastPause, cutPause_);
}

/// Cell of a body on a Morton curve through the cells of aggregates (stages/coarse/cells.h): these are nested
/// blocks of the curve at every level. Bodies without a position come last.
std::uint64_t RankDivision::cellOnCurve(int i) const {
  const SolverData& s = data();
  if (!hasPlace(s, i)) return ~std::uint64_t{0};
  // the cells of one exponent lie off those of the next finer one by 1 and 0 in turn
  constexpr double kShift = 1. / 3;
  constexpr std::uint64_t kOffset = 0x155555, kMost = 0x1fffff;
  static_assert(kCurveCell == 16, "an even exponent, for this shift");
  const double perEdge = s.stepOf(i).perFall / kCurveCell;
  const auto cell = [&](double x) {
    const double place = std::floor(x * perEdge + kShift) + static_cast<double>(kOffset);
    return spreadBits(static_cast<std::uint64_t>(std::clamp(place, 0., static_cast<double>(kMost))));
  };
  const Vec3d& x = s.position[i];
  return cell(x.x) | cell(x.y) << 1 | cell(x.z) << 2;
}

/// Cuts the curve through all bodies into parts of equal cost, up to a few percent, where it crosses between
/// the largest cells. A joint tree has one place on the curve.
void RankDivision::cutBodies() {
  const SolverData& s = data();
  const std::size_t bodies = static_cast<std::size_t>(s.bodies);
  const auto bodyOf = [&](std::size_t i) {
    const int node = s.treeNodes > 0 ? s.nodeOfBody[i] : -1;
    return node >= 0 ? s.treeNode[s.treeNode[node].tree].body : static_cast<int>(i);
  };
  struct Place {
    std::uint64_t key;
    std::int64_t cost;  ///< then of all before it
  };
  std::vector<Place> places(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    const bool moves = s.params[i].kind == BodyKind::Dynamic;
    const int rows = isCut_ && moves && !isAsleep(s, static_cast<int>(i))
                         ? s.incidenceOffset[i + 1] - s.incidenceOffset[i]
                         : 0;
    places[i] = {cellOnCurve(bodyOf(i)), moves ? kBodyCost + rows : 0};
  }
  isCut_ = true, sinceCut_ = 0;
  home_.clear();
  cutKey_.assign(static_cast<std::size_t>(ranks() - 1), ~std::uint64_t{0});
  if (places.empty()) return;
  std::ranges::sort(places, {}, &Place::key);
  std::int64_t all = 0;
  for (Place& place : places) all += std::exchange(place.cost, all);
  for (std::size_t r = 0; r < cutKey_.size(); ++r) {
    const double share = static_cast<double>(all) / ranks(), ideal = share * static_cast<double>(r + 1);
    std::uint64_t widest = 0;
    double nearest = 0;
    const double slack = kCutSlack * share;
    const auto first = std::ranges::lower_bound(places, ideal - slack, {},
                                                [](const Place& p) { return static_cast<double>(p.cost); });
    // bodies of one cell stay together
    for (auto p = std::max(first, places.begin() + 1); p < places.end(); ++p) {
      const double off = std::abs(static_cast<double>(p->cost) - ideal);
      if (static_cast<double>(p->cost) > ideal + slack && widest > 0) break;
      const std::uint64_t step = std::bit_floor(p->key ^ (p - 1)->key);
      if (step < widest || step == 0 || (step == widest && off >= nearest)) continue;
      widest = step, nearest = off, cutKey_[r] = p->key;
    }
  }
}

/// Bodies that are new since the cut go where their place on the curve belongs.
void RankDivision::findOwners() {
  const SolverData& s = data();
  const std::size_t bodies = static_cast<std::size_t>(s.bodies);
  if (needsCut()) {
    // a cut that does not help is not repeated soon
    cutPause_ = sinceCut_ <= 2 * cutPause_ ? std::min(2 * cutPause_, kMostPause) : kLeastPause;
    cutBodies();
  }
  for (std::size_t i = home_.size(); i < bodies; ++i) {
    const auto after = std::ranges::upper_bound(cutKey_, cellOnCurve(static_cast<int>(i)));
    home_.push_back(static_cast<int>(after - cutKey_.begin()));
  }
  home_.resize(bodies);
  owner_ = home_;
  moves_.resize(bodies);
  forEachOfMany(s.bodies, lister_.threads(), [&](int i) {
    moves_[std::size_t(i)] = s.params[i].kind == BodyKind::Dynamic;
    // columns are solved by every rank
    if (columnBefore(s, i) != 0) owner_[std::size_t(i)] = kEveryRank;
  });
  shareDeformables();
  unifyTrees();
}

/// Bodies that touch deformable objects are solved by every rank, as these objects are.
void RankDivision::shareDeformables() {
  const SolverData& s = data();
  if (s.vertices == 0) return;
  const auto share = [&](int body) {
    if (body >= 0 && body < s.bodies) owner_[std::size_t(body)] = kEveryRank;
  };
  for (int k = 0; k < s.attachments; ++k) share(s.attachment[k].body);
  for (int k = 0; k < s.counters->pointPairs; ++k) {
    const PointPair& p = s.pointPair[k];
    if (p.other < kVertexNode) share(p.other);
    if (p.vertex >= s.vertices + s.edges) share(bodyOfOwner(s, p.vertex));
  }
}

/// All bodies of a joint tree have one owner.
void RankDivision::unifyTrees() {
  const SolverData& s = data();
  const auto forEachNode = [&](auto&& f) {
    for (int n = 0; n < s.treeNodes; ++n)
      if (const TreeNode& node = s.treeNode[n]; node.body >= 0)
        f(owner_[std::size_t(node.body)], owner_[std::size_t(s.treeNode[node.tree].body)]);
  };
  forEachNode([](int own, int& tree) {
    if (own == kEveryRank) tree = kEveryRank;
  });
  forEachNode([](int& own, int tree) { own = tree; });
}

void RankDivision::classifyPairs() {
  const SolverData& s = data();
  const std::size_t pairs = static_cast<std::size_t>(s.counters->pairs);
  pairOwner_.resize(pairs), pairNear_.resize(pairs);
  lister_.list(pairs_, s.counters->pairs, [&](int i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const int ends[] = {s.pair[i].owner, s.pair[i].other};
    pairOwner_[k] = ownerOf(ends), pairNear_[k] = actsHere(ends);
    return pairNear_[k] ? takeOf(pairOwner_[k]) : Take::No;
  });
}

void RankDivision::classifyJoints() {
  const SolverData& s = data();
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    JointParts& joints = joints_[kType];
    const std::size_t n = static_cast<std::size_t>(s.joints[kType]);
    std::swap(joints.rank, joints.rankBefore), std::swap(joints.near, joints.nearBefore);
    joints.rank.resize(n), joints.near.resize(n);
    lister_.list(joints.own, s.joints[kType], [&](int i) {
      const std::size_t k = static_cast<std::size_t>(i);
      const auto ends = endsOf<F>(s, i);
      joints.rank[k] = ownerOf(ends), joints.near[k] = actsHere(ends);
      return joints.near[k] ? takeOf(joints.rank[k]) : Take::No;
    });
  });
}

/// Fetches the state of pairs and joints that this rank owns now and did not before.
void RankDivision::migrate() {
  const SolverData& s = data();
  std::vector<RankLists> needs(1 + kTypes, RankLists(static_cast<std::size_t>(ranks())));
  const auto need = [&](int old) {
    if (old < 0 || pairNearBefore_[std::size_t(old)]) return;
    needs[0][std::size_t(pairOwnerBefore_[std::size_t(old)])].push_back(old);
  };
  for (const int k : pairs_.index) {
    const Pair& p = s.pair[k];
    if (!s.oneWay) {
      need(findOldPair(s, k));
      continue;
    }
    // one-way surfaces also read the contacts of parts that no longer make a pair
    if (k > 0 && sameBodies(s.pair[k - 1], p)) continue;
    for (int old = s.oldPairOffset[p.owner]; old < s.oldPairOffset[p.owner + 1]; ++old)
      if (s.oldPair[old].other == p.other) need(old);
  }
  for (int type = 0; type < kTypes; ++type) {
    const JointParts& joints = joints_[type];
    for (const int i : joints.own.index) {
      const std::size_t k = static_cast<std::size_t>(i);
      if (k >= joints.nearBefore.size() || joints.nearBefore[k]) continue;
      needs[std::size_t(1 + type)][std::size_t(joints.rankBefore[k])].push_back(i);
    }
  }
  for (const RankLists& lists : needs)
    for (const std::vector<int>& list : lists) migrated_ += static_cast<int>(list.size());
  const std::vector<RankTraffic> traffic = courier_.ask(std::move(needs));
  courier_.swap(traffic[0], &s.oldPairTest[0]);
  RankTraffic manifolds;
  manifolds.clear(ranks());
  for (std::size_t r = 0; r < std::size_t(ranks()); ++r) {
    const auto manifoldsOf = [&](const std::vector<int>& pairs, std::vector<int>& out) {
      for (const int k : pairs)
        if (const int m = manifoldOfOld(s, k); m >= 0) out.push_back(m);
    };
    manifoldsOf(traffic[0].give[r], manifolds.give[r]);
    manifoldsOf(traffic[0].take[r], manifolds.take[r]);
  }
  courier_.swap(manifolds, &s.oldManifold[0]);
  if (s.rolls && s.rolledBefore) courier_.swap(manifolds, &s.oldRolling[0]);
  forEachType(JointTypes{},
              [&]<class F>() { courier_.swap(traffic[1 + typeIndex<F>(JointTypes{})], s.jointsOf<F>()); });
}

}  // namespace rubble::RUBBLE_CORE

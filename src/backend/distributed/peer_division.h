#pragma once
/// The division of a step among ranks that store into one another's tables, as threads or by letters. It is
/// the scheme of several GPUs (backend/peers/peer_phases.h) on the CPU, where all of it is tested.
#include <vector>

#include <rubble/ranks.h>

#include "backend/distributed/rank_lists.h"
#include "backend/distributed/rank_part.h"
#include "backend/distributed/world_division.h"
#include "backend/peers/peer_phases.h"
#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// The head and letters of a box.
using LetterBox = std::vector<PeerLetter>;

class PeerDivision final : public WorldDivision {
 public:
  /// Both must outlive the division. Without letters ranks are threads of one process: the transport carries
  /// pointers. `threads`: of this rank, which run the calls below.
  PeerDivision(HostTables& tables, Transport& transport, const RankOptions& options, int threads);

  Part part(Cut cut, int n, int which) override;
  Part color(int color) override;
  void share(Share what, int which) override;
  void gatherState() override;
  void restart() override { cut_.holdsAll = 1, cut_.bodies = 0; }
  const std::vector<RankReport>& reports() const override { return reports_; }

  // The machine of peer_phases.h.
  static constexpr bool kCountsNear = false;
  static constexpr bool storesAtOnce() { return false; }
  const SolverData& tables() const { return tables_.view(); }
  const PeerData& data() const { return data_; }
  template <class Kernel> void each(const Kernel& kernel, int n) {
    run<Kernel>(n, [&](int i) { kernel(tables(), i); });
  }
  template <class Kernel> void each(const Kernel& kernel, int Counters::*n) {
    each(kernel, tables().counters->*n);
  }
  template <class Kernel> void eachOld(const Kernel& kernel) {
    each(kernel, tables().oldPairOffset[tables().bodies]);
  }
  template <class Kernel> void eachOf(PeerList list, const Kernel& kernel) {
    const int* const index = of(list).index.data();
    run<Kernel>(of(list).size(), [&](int k) { kernel(tables(), index[k]); });
  }
  template <class Test> void select(PeerList list, const Test& test, int n);
  template <class Test> void select(PeerList list, const Test& test, int Counters::*n) {
    select(list, test, tables().counters->*n);
  }
  template <class Test> void selectOld(PeerList list, const Test& test) {
    select(list, test, tables().oldPairOffset[tables().bodies]);
  }
  template <class Test> void selectOf(PeerList list, PeerList from, const Test& test);
  void join(PeerList list, PeerList more);
  void barrier();
  void barrierIf(int Counters::*counter) {
    if (tables().counters->*counter != 0) barrier();
  }

 private:
  using Take = RankLister::Take;
  /// Calls f(i) for i < n on the threads of this rank. Letters are written one after the other.
  template <class Kernel, class F> void run(int n, F&& f) {
    bool posts = false;
    if constexpr (requires { Kernel::kPosts; }) posts = data_.box;
    forEachOfMany(n, posts ? 1 : lister_.threads(), f);
  }
  RankPart& of(PeerList list) { return lists_[static_cast<int>(list)]; }
  void listedIn(PeerList list) { listed_[static_cast<int>(list)] = of(list).size(); }
  /// Does this rank run an element that satisfies a test, and does it count it?
  template <class Test> Take takeOf(const Test& test, int element) const;
  bool isSeen(int node) const { return node < tables().bodies && data_.isSeen(node); }
  int ownerOfNode(int n) const;
  /// Grows the arrays of this rank to the present sizes.
  void fit();
  void plan();
  void planAggregates();
  /// If tables have grown since the last barrier: grows what belongs to them, and another barrier, since
  /// others must not store into the old ones.
  void settle();
  void exchangeLetters();
  void passTurn();
  void takeTurn();
  Part partOfHomes(int n);
  Part partOfJoints(PeerJoints kind, int n, int type);
  template <class Mine> Part partBy(RankPart& list, int n, Mine&& mine);

  HostTables& tables_;
  Transport& transport_;
  RankCourier courier_;
  RankExchange exchange_;
  PeerData data_;
  PeerCut cut_{};
  std::vector<PeerRank> ranks_;
  std::vector<PeerSums> sums_;
  std::vector<int> owner_, ownerBefore_, sliceOwner_, sharedRoot_, sharedPartner_;
  std::vector<unsigned> seenBy_;
  std::vector<std::uint8_t> moves_, movesBefore_, seen_, sees_, mixed_, extraRow_,
      extraJoint_[JointTypes::kSize], rowAskers_, jointAskers_[JointTypes::kSize];
  std::vector<LetterBox> out_, in_;  ///< by rank
  std::vector<PeerBox> boxes_;
  RankLister lister_;
  RankPart lists_[kPeerLists], jointParts_[kPeerLists];  ///< the second: by part of a joint
  int listed_[kPeerLists] = {};
  // more lists of this rank; those of the plan begin with the groups
  RankPart homes_, tested_, levelNodes_;
  RankGroups colors_, sharedColors_, levelSlices_, levelMoves_, levelAggregates_;
  RankPart seenAggregates_, treeNodes_, smallTrees_;
  std::vector<int> capacities_;  ///< of the tables at the last barrier
  bool planned_ = false, activeListed_ = false, summed_ = false, swaps_ = false, atRest_ = true;
  bool hasTurn_ = false;
  int turn_ = 0;  ///< barriers so far
  std::vector<RankReport> reports_;
};

}  // namespace rubble::RUBBLE_CORE

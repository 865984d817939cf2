#pragma once
/// The division of a step among ranks that store into one another's tables, as threads or by letters. It is
/// the scheme of several GPUs (backend/peers/peer_phases.h) on the CPU, where all of it is tested.
#include <vector>

#include <rubble/ranks.h>

#include "backend/distributed/rank_lists.h"
#include "backend/distributed/world_division.h"
#include "backend/peers/peer_phases.h"
#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// The head and letters of a box.
using LetterBox = std::vector<PeerLetter>;

class PeerDivision final : public WorldDivision {
 public:
  /// Both must outlive the division. Without letters ranks are threads of one process: the transport carries
  /// pointers.
  PeerDivision(HostTables& tables, Transport& transport, const RankOptions& options);

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
    for (int i = 0; i < n; ++i) kernel(tables(), i);
  }
  template <class Kernel> void each(const Kernel& kernel, int Counters::*n) {
    each(kernel, tables().counters->*n);
  }
  template <class Kernel> void eachOld(const Kernel& kernel) {
    each(kernel, tables().oldPairOffset[tables().bodies]);
  }
  template <class Kernel> void eachOf(PeerList list, const Kernel& kernel) {
    for (const int i : elements(list)) kernel(tables(), i);
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
  struct List {
    std::vector<int> index;
    std::vector<int> other;  ///< of these, those that another rank counts, in the same order
  };
  /// Adds element `i` of a list; `test` selects it.
  template <class Test> void add(List& to, const Test& test, int i);
  const std::vector<int>& elements(PeerList list) const { return lists_[static_cast<int>(list)].index; }
  bool isSeen(int node) const { return node < tables().bodies && data_.isSeen(node); }
  int ownerOfNode(int n) const;
  /// Grows the arrays of this rank to the present sizes.
  void fit();
  void plan();
  /// If tables have grown since the last barrier: grows what belongs to them, and another barrier, since
  /// others must not store into the old ones.
  void settle();
  void exchangeLetters();
  void passTurn();
  void takeTurn();
  /// Elements of a list that satisfy a test, as a part; those that this rank counts come first.
  template <class Test> Part partOf(const List& list, Test&& test);
  Part partOf(PeerList list);
  Part partOfJoints(PeerJoints kind, int n, int type);
  template <class Mine> Part partBy(int n, Mine&& mine);

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
  List lists_[kPeerLists];
  int listed_[kPeerLists] = {};
  std::vector<int> capacities_;  ///< of the tables at the last barrier
  std::vector<int> part_, colorList_, spare_;
  bool planned_ = false, activeListed_ = false, summed_ = false, swaps_ = false, atRest_ = true;
  bool hasTurn_ = false;
  int turn_ = 0;  ///< barriers so far
  std::vector<RankReport> reports_;
};

}  // namespace rubble::RUBBLE_CORE

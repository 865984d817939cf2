#pragma once
/// The division of a step among ranks (backend/division.h). Tables have the same indices on all ranks.
/// What is cheap runs everywhere on the same numbers. What is costly runs only for the bodies of a rank, and
/// for the constraints that act on them. Decisions go by ids and by numbers that all ranks have, so results
/// do not depend on the number of ranks, nor on who owns what (docs/distributed.md).
#include <memory>

#include <rubble/ranks.h>

#include "backend/distributed/rank_lists.h"
#include "backend/distributed/rank_part.h"
#include "backend/distributed/world_division.h"
#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// Owner of bodies that every rank solves: those that touch deformable objects.
inline constexpr int kEveryRank = -1;

class RankDivision final : public WorldDivision {
 public:
  /// Both must outlive the division. `threads`: of this rank, which run the calls below.
  RankDivision(HostTables& tables, Transport& transport, const RankOptions& options, int threads)
      : tables_(tables),
        transport_(transport),
        courier_(transport, threads),
        options_(options),
        lister_(threads) {}

  Part part(Cut cut, int n, int which) override;
  Part color(int color) override;
  void share(Share what, int which) override;

  void gatherState() override;
  void restart() override { holdsAll_ = true, isCut_ = false; }
  const std::vector<RankReport>& reports() const override { return reports_; }

 private:
  static constexpr int kTypes = JointTypes::kSize;
  using Take = RankLister::Take;
  /// What a rank has to do with a body.
  enum Seen : std::uint8_t {
    kUnseen,
    kOwn,
    kNode,  ///< of another rank; only aggregates and their constraints need its pose
    kGhost  ///< of another rank; constraints of own bodies need its pose
  };
  /// Joints of one type.
  struct JointParts {
    std::vector<int> rank;           ///< by joint
    std::vector<std::uint8_t> near;  ///< by joint: 1: acts on a body of this rank
    std::vector<int> rankBefore;
    std::vector<std::uint8_t> nearBefore;
    RankPart own, all;            ///< near joints; these and those of slices
    RankPart ownParts, allParts;  ///< the same by part of a joint; empty until they are needed
  };

  const SolverData& data() const { return tables_.view(); }
  int me() const { return courier_.rank(); }
  int ranks() const { return courier_.ranks(); }
  bool isMine(int owner) const { return owner == me() || owner == kEveryRank; }
  /// Does this rank count an element of that owner?
  bool counts(int owner) const { return owner == me() || (owner == kEveryRank && me() == 0); }
  /// Of an element of this rank.
  Take takeOf(int owner) const { return counts(owner) ? Take::Counted : Take::Other; }
  /// Owner of a constraint, and whether it acts on a body of this rank.
  template <class Bodies> int ownerOf(const Bodies& bodies) const;
  template <class Bodies> bool actsHere(const Bodies& bodies) const;
  int ownerOfManifold(int i) const { return pairOwner_[std::size_t(data().activePair[i])]; }
  int ownerOfRow(int row) const { return ownerOfManifold(data().rowBodies[row].manifold); }
  int ownerOfNode(int n) const {
    return data().treeNode[n].body < 0 ? kEveryRank : owner_[std::size_t(data().treeNode[n].body)];
  }

  // rank_owners.cpp: the beginning of a step
  void beginStep();
  bool needsCut();
  std::uint64_t cellOnCurve(int body) const;
  void cutBodies();
  void findOwners();
  void shareDeformables();
  void unifyTrees();
  void classifyPairs();
  void classifyJoints();
  void migrate();

  // rank_plan.cpp: what a rank evaluates and sees in the iterations
  template <class Test> void filter(RankPart& to, const RankPart& from, Test&& test);
  void plan();
  void findOwn();
  void findSlices();
  void findConstraints(RankLists& rows, std::vector<RankLists>& joints);
  void findGhosts(RankLists& ghosts, RankLists& nodes);
  void findAggregates(RankLists& slices);
  void listColors();
  void listTrees();
  void ask();

  // rank_division.cpp
  Part planned(Cut cut, int n, int which);
  Part jointPart(const RankPart& list, RankPart& parts, int perJoint);
  void shareRows();
  void shareBreaks();
  void shareFastPairs();
  void shareBounces();
  void shareGaps();
  void shareCounts();
  void listActive();

  HostTables& tables_;
  Transport& transport_;
  RankCourier courier_;
  RankOptions options_;

  // owners
  bool isCut_ = false;       ///< `home_` belongs to the present order of bodies
  bool holdsAll_ = true;     ///< this rank has the state of all pairs and joints
  bool ownersMoved_ = true;  ///< since the last step
  int sinceCut_ = 0, cutPause_ = 0;
  double imbalance_ = 0;
  std::vector<std::uint64_t> cutKey_;     ///< places on the curve where the parts of ranks 1, 2, ... begin
  std::vector<int> home_;                 ///< by body: rank by the cut
  std::vector<int> owner_, ownerBefore_;  ///< by body: rank, or kEveryRank
  std::vector<std::uint8_t> moves_, movesBefore_;  ///< by body: 1: dynamic, asleep or not
  std::vector<int> pairOwner_, pairOwnerBefore_;
  std::vector<std::uint8_t> pairNear_, pairNearBefore_;
  RankPart pairs_, active_;
  bool activeListed_ = false;
  JointParts joints_[kTypes];
  int migrated_ = 0;

  // plan
  RankLister lister_;
  bool planned_ = false;
  RankLists bodies_;  ///< moving bodies of each rank, without those that every rank solves
  std::vector<std::uint8_t> seen_;
  RankPart own_;
  std::vector<int> nodes_, ghosts_;  ///< kNode and kGhost
  std::vector<int> sliceOwner_;
  std::vector<std::uint8_t> sliceMoves_, isSeen_;  ///< by slice and by aggregate: 1: a body of it is seen
  std::vector<int> extraRows_;
  RankPart ownRows_, rows_;
  RankPart slices_, borderSlices_;  ///< its slices; those with bodies of other ranks
  RankPart seenAggregates_, seenSlices_;
  RankGroups levelSlices_, levelAggregates_, movingSlices_, colors_, ownerBodies_;
  std::vector<RankTraffic> colorPoses_, sliceSums_;
  RankTraffic treePoses_, nodePoses_;
  bool nodesMoved_ = false;  ///< since the last exchange of their poses
  RankPart treeNodes_, smallTrees_, levelNodes_, tested_, border_;
  std::vector<int> scratch_;
  std::vector<RankReport> reports_;
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Division of a step among ranks: which elements of each kernel a rank runs, and what the ranks exchange
/// before and after it. The table at the end of this file is the whole division; kernels that it does not
/// name run in full on every rank (docs/distributed.md).
#include "stages/step.h"

namespace rubble::RUBBLE_CORE {

/// The elements that a rank runs.
enum class Cut {
  Whole,
  Homes,            ///< the bodies between its cuts, of any kind and whoever solves them
  Pairs,            ///< broad-phase pairs that touch a body of the rank
  ActivePairs,      ///< the same, of the active pairs
  JoinedRows,       ///< contact rows of its bodies, and those between bodies of two other ranks
  Tested,           ///< the list `tested`, which is of this rank already
  Rows,             ///< contact rows that the rank evaluates: of its bodies and of its slices
  OwnRows,          ///< contact rows of its bodies
  Bodies,           ///< its bodies
  Slices,           ///< its slices, of all levels
  LevelSlices,      ///< its slices of one level
  SeenAggregates,   ///< aggregates that move a body which the rank sees
  LevelAggregates,  ///< the same, of one level
  SeenSlices,       ///< their slices
  LevelMoves,       ///< slices of one level with such a body
  Joints,           ///< joints that the rank evaluates, by parts
  OwnJoints,        ///< joints of its bodies, by parts
  TreeNodes,        ///< nodes of its joint trees
  LevelNodes,       ///< the same, of one level of the large trees
  SmallTrees,       ///< its small trees
};

/// What ranks exchange.
enum class Share {
  None,
  Homes,         ///< begins a step: ranges of bodies
  Found,         ///< partners that a rank has found for bodies of other ranges
  PairCounts,    ///< `pairCount` of all bodies
  Partners,      ///< all pairs
  Owners,        ///< owners of bodies, and old manifolds for new owners
  Activity,      ///< `isActive` of all pairs
  Touches,       ///< `hasRows` of all active pairs
  Rows,          ///< `rowBodies` and `joinLevel` of all rows
  Roots,         ///< roots of aggregates of a level, which each rank has found from its rows
  Boundary,      ///< `boundaryCount` of all slices
  SliceSums,     ///< sums of the slices of a level, to the ranks that see a body of their aggregates
  ColorPoses,    ///< poses of the bodies of a color, to the ranks that see them
  NodePoses,     ///< poses of other bodies of slices, to the ranks that own the slices
  TreePoses,     ///< poses of the bodies of joint trees, likewise
  MotionBegins,  ///< nobody reads displacements any more
  Motion,        ///< displacements of all bodies at the end of the iterations
  Breaks,        ///< the joints that broke
  FastPairs,     ///< manifolds of the pairs of fast bodies
  BounceRows,    ///< all contact rows, if any contact bounces
  Gaps,          ///< joint projections of trees that need one
  Counts,        ///< ends a step: counters that ranks counted in parts
};

/// How the executor of one rank divides its step.
class Division {
 public:
  /// The first `counted` elements count toward the report of the step; another rank counts the others.
  struct Part {
    const int* index;  ///< null: elements 0 to count - 1
    int counted, count;
  };

  virtual ~Division() = default;
  /// Elements of [0, n) for this rank. `which`: level, joint type, or first node of a tree level.
  virtual Part part(Cut cut, int n, int which) = 0;
  /// The bodies of a color that this rank solves.
  virtual Part color(int color) = 0;
  virtual void share(Share what, int which) = 0;
};

/// Division of a kernel.
template <class Kernel> struct Divided {
  static constexpr Cut kCut = Cut::Whole;
  static constexpr Share kBefore = Share::None, kAfter = Share::None;
  static int which(const Kernel&) { return 0; }
};
template <class Kernel> constexpr bool isDivided() {
  using D = Divided<Kernel>;
  return D::kCut != Cut::Whole || D::kBefore != Share::None || D::kAfter != Share::None;
}
/// For specializations of Divided.
template <Cut kC, Share kB = Share::None, Share kA = Share::None, int kW = 0> struct DividedBy {
  static constexpr Cut kCut = kC;
  static constexpr Share kBefore = kB, kAfter = kA;
  template <class Kernel> static int which(const Kernel&) { return kW; }
};
template <Cut kC, class F, Share kB = Share::None>
using DividedJoints = DividedBy<kC, kB, Share::None, typeIndex<F>(JointTypes{})>;
struct DividedLevel : DividedBy<Cut::LevelNodes> {
  template <class Kernel> static int which(const InLevel<Kernel>& kernel) { return kernel.begin; }
};

// broad phase
template <> struct Divided<FindNeighbors> : DividedBy<Cut::Homes, Share::Homes> {};
template <> struct Divided<FindPathNeighbors> : DividedBy<Cut::Homes> {};
template <bool kParts>
struct Divided<FindPairs<kParts>> : DividedBy<Cut::Homes, Share::Found, Share::PairCounts> {};
template <bool kParts>
struct Divided<WritePairs<kParts>> : DividedBy<Cut::Homes, Share::None, Share::Partners> {};
// contacts
template <> struct Divided<FindImpactSpeedBounds> : DividedBy<Cut::Whole, Share::Owners> {};
template <> struct Divided<FindActivePairs> : DividedBy<Cut::Pairs> {};
template <> struct Divided<TestNewPairs> : DividedBy<Cut::Whole, Share::None, Share::Activity> {};
template <class L> struct Divided<RecycleManifolds<L>> : DividedBy<Cut::ActivePairs> {};
template <> struct Divided<TestPairs> : DividedBy<Cut::Tested> {};
template <> struct Divided<TestGeneralPairs> : DividedBy<Cut::Tested> {};
template <> struct Divided<DecideOneWay> : DividedBy<Cut::ActivePairs> {};
template <> struct Divided<BuildRolling> : DividedBy<Cut::ActivePairs> {};
template <class L>
struct Divided<BuildContactRows<L>> : DividedBy<Cut::ActivePairs, Share::None, Share::Rows> {};
template <> struct Divided<AddArcs> : DividedBy<Cut::ActivePairs> {};
template <class L> struct Divided<UpdateContactDuals<L>> : DividedBy<Cut::Rows, Share::NodePoses> {};
template <> struct Divided<UpdateRollingDuals> : DividedBy<Cut::Rows> {};
template <class L> struct Divided<FinishContacts<L>> : DividedBy<Cut::OwnRows> {};
template <> struct Divided<FindCorrections> : DividedBy<Cut::Bodies, Share::MotionBegins, Share::Motion> {};
// joints and joint trees
template <class F>
struct Divided<LinearizeAngularRows<F>> : DividedJoints<Cut::Joints, F, Share::NodePoses> {};
template <class F> struct Divided<UpdateJointDuals<F>> : DividedJoints<Cut::Joints, F, Share::NodePoses> {};
template <class F> struct Divided<FinishJoints<F>> : DividedJoints<Cut::OwnJoints, F> {};
template <class F> struct Divided<FindTreeRows<F>> : DividedJoints<Cut::OwnJoints, F> {};
template <class F> struct Divided<TakeTreeForces<F>> : DividedJoints<Cut::OwnJoints, F> {};
template <class F> struct Divided<FindTreesToProject<F>> : DividedJoints<Cut::OwnJoints, F> {};
template <class L> struct Divided<AssembleTreeBodies<L>> : DividedBy<Cut::TreeNodes> {};
template <> struct Divided<SolveTree> : DividedBy<Cut::SmallTrees> {};
template <> struct Divided<ProjectTree> : DividedBy<Cut::SmallTrees> {};
template <> struct Divided<LimitProjection> : DividedBy<Cut::TreeNodes, Share::None, Share::Gaps> {};
template <class Kernel> struct Divided<InLevel<Kernel>> : DividedLevel {};
template <> struct Divided<InLevel<MoveTrees>> : DividedLevel {
  static constexpr Share kAfter = Share::TreePoses;
};
// aggregates
template <> struct Divided<JoinAggregates<ContactBlocks>> : DividedBy<Cut::JoinedRows> {};
template <> struct Divided<FlattenAggregates> : DividedBy<Cut::Whole, Share::Roots> {
  static int which(const FlattenAggregates& kernel) { return kernel.level; }
};
template <> struct Divided<SumInertia> : DividedBy<Cut::SeenSlices> {};
template <> struct Divided<PlaceAggregates> : DividedBy<Cut::SeenAggregates> {};
template <> struct Divided<CountBoundary> : DividedBy<Cut::Slices, Share::None, Share::Boundary> {};
template <> struct Divided<FillBoundary> : DividedBy<Cut::Slices> {};
template <class L>
struct Divided<SumSlice<L>> : DividedBy<Cut::LevelSlices, Share::NodePoses, Share::SliceSums> {};
template <> struct Divided<SolveAggregate> : DividedBy<Cut::LevelAggregates> {};
template <> struct Divided<MoveSlice> : DividedBy<Cut::LevelMoves> {};
template <class Stage> struct Divided<WithSoftNodes<Stage>> : Divided<Stage> {};
// end of the step
template <> struct Divided<FlagFast> : DividedBy<Cut::Whole, Share::Breaks, Share::FastPairs> {};
template <> struct Divided<FindBounces> : DividedBy<Cut::Whole, Share::BounceRows> {};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Per-body records other than the plain state arrays: parameters, filters, pairs, incidences, aggregates,
/// islands and the counters of a step.
#include "collision/lattice.h"
#include "collision/manifold.h"
#include "forces/forces.h"
#include "forces/rolling.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

enum class BodyKind : int { Removed, Static, Kinematic, Dynamic };

/// Authored once; read-only in a step. There is no padding, because hashes cover every byte.
struct BodyParams {
  ShapeData shape;
  BodyKind kind;
  int surface;   ///< material in the shared table; -1: the coefficients below with the default combine rules
  Real mass;     ///< [kg]; 0 unless dynamic
  Vec3 inertia;  ///< principal moments, body axes [kg m2]
  Real radius;   ///< bounding sphere [m]
  Real muStatic, muDynamic;
  Real restitution;
  Real gravityScale;
};
static_assert(sizeof(BodyParams) == sizeof(ShapeData) + 2 * sizeof(int) + 9 * sizeof(Real));

/// A material with all its coefficients.
struct SurfaceData {
  Real muStatic, muDynamic, restitution;
  std::uint32_t frictionCombine : 8;  ///< rubble::Combine
  std::uint32_t kind : 24;            ///< 1 + the first material of this name in the table; 0: it has no name
  int restitutionCombine;             ///< rubble::Combine
  Real rolling, torsional;            ///< rolling and torsional resistance: lever of the resisting moment [m]
  Vec3 velocity;                      ///< surface velocity of a conveyor, body axes [m/s]
  Vec3 oneWay;                        ///< side of a one-way surface that holds: unit, body axes; 0: all sides
};

/// Coefficients of contacts between materials of two kinds.
struct MaterialRule {
  int world;
  int low, high;  ///< SurfaceData::kind
  int given;      ///< bit k: coefficient k replaces the mixture
  Real muStatic, muDynamic, restitution, rolling, torsional;
};

/// Properties that few bodies have; read once per step.
struct BodyExtras {
  Real linearDamping, angularDamping;  ///< [1/s]
  int locks;   ///< bits 0-2: no translation along world x, y, z; bits 3-5: no rotation about them
  int traits;  ///< bits 1 << BodyTrait
};

/// Optional features of bodies. The world counts the bodies that have each, so that stages can be skipped.
enum class BodyTrait { GeneralShape, Rolls, Bounces, Locked, Filtered };
inline constexpr int kBodyTraits = 5;
struct TraitCounts {
  int bodies[kBodyTraits] = {};
  RUBBLE_HD int& operator[](BodyTrait t) { return bodies[static_cast<int>(t)]; }
  RUBBLE_HD int operator[](BodyTrait t) const { return bodies[static_cast<int>(t)]; }
  /// Adds `change` to the count of every trait whose bit is set.
  void count(int traits, int change) {
    for (int t = 0; t < kBodyTraits; ++t) bodies[t] += (traits >> t & 1) * change;
  }
};

/// What happened to a body in the last step, as bits of SolverData::pushed. The number of bodies of its
/// column (state/columns.h) is stored above them.
enum LastStep : int {
  kForced = 1,   ///< a user force acted
  kStopped = 2,  ///< continuous collision detection cut its motion short
};
inline constexpr int kColumnShift = 2;

/// Collision filter of a body (CollisionFilter), and whether it is a sensor.
struct BodyFilter {
  std::uint32_t layers, mask;
  int group;
  int sensor;
};

/// Ids of two bodies of one world that do not collide; -1, -1: an empty element of the hash table.
struct ExcludedPair {
  int low, high, world = 0;
  RUBBLE_HD constexpr bool operator==(const ExcludedPair& o) const {
    return low == o.low && high == o.high && world == o.world;
  }
  constexpr auto operator<=>(const ExcludedPair&) const = default;
};

/// World AABB swept over the step, with its cell in the grid of its level.
struct alignas(4 * sizeof(Real)) Bounds {
  // what is needed of another body comes first, in 32 bytes
  Vec3 center;  ///< [m]
  int level;    ///< -1: not in the grid (planes, removed bodies)
  Vec3 half;    ///< half extents [m]
  int x;        ///< cell
  Vec3 path;    ///< predicted displacement in the step [m]
  int y, z;
};

/// What the last search for the neighbors of a body depended on, and what it found
/// (stages/pairs/lasting_search.h). All 0: there was none.
struct alignas(4 * sizeof(Real)) NeighborSearch {
  Vec3 center;             ///< of its bounds, or the position of a plane [m]
  int layer;               ///< of its grid entry; negative: it had none
  Vec3 half;               ///< of its bounds with the slack of that search [m], or the normal of a plane
  int bodies;              ///< SolverData::bodies
  int found;               ///< neighbors that it owns; more than kPairSlots: they are searched in each step
  std::uint32_t partners;  ///< bit k: slot k is a partner in this step
  int isNew;               ///< 1: the search began in this step
};

/// Bounds of the long paths in a bucket of the grid (stages/pairs/long_paths.h); all 0: there are none.
struct alignas(32) CellPaths {
  int most[2][3];  ///< kCellOrigin minus the lowest path and plus the highest, in kPathSteps of the cell
  int half;        ///< largest half extent of the boxes at x^t, as the bits of a float [m]
  int radius;      ///< largest bounding radius, likewise [m]
};

/// A body as stored in its grid bucket.
struct alignas(8 * sizeof(Real)) GridEntry {
  Vec3 center, half;  ///< of its Bounds [m]
  int body;
  int layer;  ///< level + kGridLevels * world
};

/// Two parts of bodies whose swept AABBs overlap. The owner is the body of the finer grid level; within one
/// level it is the body of lower index. `first` and `second` are defined in stages/pairs/pair_parts.h and are
/// 0 for two primitive shapes.
struct alignas(16) Pair {
  int owner, other;
  std::uint32_t ownerIsA : 1;  ///< the owner has the lower id
  std::uint32_t first : 31;
  int second;
};

/// A pair that CCD sweeps.
struct SweptPair {
  int pair;
  int toiBits;  ///< share of the motion left at the time of impact, as the bits of a float; 0: no impact
};
static_assert(sizeof(Pair) == 4 * sizeof(int));
/// Order of the pairs of one owner.
RUBBLE_HD constexpr bool before(const Pair& a, const Pair& b) {
  return a.other != b.other   ? a.other < b.other
         : a.first != b.first ? a.first < b.first
                              : a.second < b.second;
}
RUBBLE_HD constexpr bool samePair(const Pair& a, const Pair& b) {
  return a.other == b.other && a.first == b.first && a.second == b.second;
}

/// One constraint that acts on a body, seen from that body.
struct Incidence {
  std::uint32_t code;  ///< sort key: constraint type (5 bits), index (26 bits), side (1 bit)
  int other;           ///< the other dynamic body or vertex (kVertexNode + index), or -1
  int depth;  ///< number of coarse levels, counted from the finest, at which the two bodies are in different
              ///< aggregates
};
inline constexpr int kContactType = 0;  ///< joint type i is i + 1
RUBBLE_HD constexpr std::uint32_t constraintCode(int type, int index, int side) {
  return static_cast<std::uint32_t>(type) << 27 | static_cast<std::uint32_t>(index) << 1 |
         static_cast<std::uint32_t>(side);
}
RUBBLE_HD constexpr int constraintType(std::uint32_t code) { return static_cast<int>(code >> 27); }
/// A code of no existing type.
inline constexpr std::uint32_t kNoConstraint = 0xffffffffu;
RUBBLE_HD constexpr int constraintIndex(std::uint32_t code) {
  return static_cast<int>((code & 0x07ffffffu) >> 1);
}
RUBBLE_HD constexpr int constraintSide(std::uint32_t code) { return static_cast<int>(code & 1u); }

/// Incidence code of a joint. A joint with frame bodies has up to four bodies. Each has one incidence that
/// acts, plus up to two (`link` 1, 2) that only name its other neighbors.
template <class F> RUBBLE_HD constexpr std::uint32_t jointCode(int index, int side, int link = 0) {
  constexpr int kType = typeIndex<F>(JointTypes{}) + 1;
  return hasFrameBodies<F>() ? constraintCode(kType, 8 * index + 2 * side + link / 2, link % 2)
                             : constraintCode(kType, index, side);
}
template <class F> RUBBLE_HD constexpr int jointIndex(std::uint32_t code) {
  return hasFrameBodies<F>() ? constraintIndex(code) / 8 : constraintIndex(code);
}
template <class F> RUBBLE_HD constexpr int jointSide(std::uint32_t code) {
  return hasFrameBodies<F>() ? constraintIndex(code) / 2 % 4 : constraintSide(code);
}
template <class F> RUBBLE_HD constexpr bool isLink(std::uint32_t code) {
  return hasFrameBodies<F>() && (constraintIndex(code) % 2 != 0 || constraintSide(code) != 0);
}

/// Inertial target and mass matrix of a body in this step. Aligned for vectorized loads and stores.
struct alignas(4 * sizeof(Real)) BodyTarget {
  MassMatrix mass;
  Pose y;      ///< displacement [m] and rotation relative to x^t
  int locks;   ///< of BodyExtras
  int unused;  ///< 0
};

/// Restitution state of a contact (stages/bounces/bounce.h).
struct Bounce {
  Vec3 before[kLanes];   ///< multipliers of the points at the start of the step: normal, tangents [N]
  Real impulse[kLanes];  ///< impulse that the step added to the normal rows [N s]
  Real start, change;    ///< closing speed at x^t, and its change by forces weighted by the loads [m/s]
  Real gap, end;  ///< gap at x^t and at the end of the step, weighted likewise; negative: penetration [m]
  Real time;      ///< time of impact; negative: none [s]
  int carries, state;  ///< 1: its load changed as in an impact; BounceState
};
struct BodyMotion {
  Vec3 v, w;  ///< [m/s], [rad/s]
};

/// What contact rows connect. Stages that need only the graph of constraints read this and no rows.
struct RowBodies {
  int a, b;      ///< bodies, a < b
  int manifold;  ///< index of the manifold of the rows
};

/// Support that a contact gives to one of its bodies, evaluated at the end of a step
/// (stages/bodies/corrections.h).
struct Support {
  Vec3 correction;  ///< displacement of B relative to A along the normal that corrects their penetration in
                    ///< one step [m]
  Real weight;      ///< force on B against gravity; negative: the contact supports A [N]
};

/// Levels of aggregates of bodies and soft nodes, finest first (stages/coarse/aggregates.h).
inline constexpr int kCoarseLevels = 4;
/// In place of a level: the contact neither touches nor stops an approach in this step.
inline constexpr int kNoTouch = kCoarseLevels + 1;
/// Number of fine levels. Odd iterations sweep these; even iterations sweep all others.
inline constexpr int kFineLevels = 2;

/// An aggregate of bodies and soft nodes that the coarse correction moves as one rigid body.
struct Aggregate {
  Vec3d center;    ///< center of mass [m]
  Block6 inertia;  ///< inertial Hessian of its bodies about the center; its force part is unused
  Vec6 step;       ///< solution of the last coarse solve [m, rad]
  int level;
  int locks;   ///< locked axes of its bodies, as in BodyExtras
  int joined;  ///< 1: contains rigid joints; its bodies then move about their present poses (coarse.h)
  int soft;    ///< 1: contains soft nodes; the aggregate then has no rotation
  int sliceBegin, sliceEnd;
};

/// A constraint between a body of a slice and one outside its aggregate.
struct alignas(16) BoundaryConstraint {
  std::uint32_t code;  ///< incidence code, on the side of the body in the slice
  Vec3 shift;          ///< from the center of the aggregate to that body, both at x^t [m]
};

/// A part of an aggregate: the unit of parallel summation.
struct Slice {
  int aggregate;
  int begin, end;  ///< in aggregateNode
  Block6 sum;
};
inline constexpr int kSliceNodes = 64;

/// Sums over an island, or a part of it, about a fixed point, in a frame that moves with the root body
/// (stages/islands/island_momentum.h).
struct MomentumSums {
  Real mass;                       ///< [kg]
  Real freeEnergy, energy;         ///< kinetic energy of the inertial targets and of the iterates [J]
  Vec3 place;                      ///< first mass moment at the end of the step [kg m]
  Vec3 givenLinear, givenAngular;  ///< momenta added by rows [kg m/s, kg m2/s]
  Vec3 linear, angular;            ///< momenta of the iterates
  Sym3 inertia;                    ///< [kg m2]
};
inline constexpr int kMomentumTerms = sizeof(MomentumSums) / sizeof(Real);
/// Calls act(term) for each scalar of the sums.
template <class Act> RUBBLE_HD void forEachTerm(MomentumSums& m, Act&& act) {
  act(m.mass), act(m.freeEnergy), act(m.energy);
  const auto actOnVector = [&](Vec3& v) { act(v.x), act(v.y), act(v.z); };
  actOnVector(m.place), actOnVector(m.givenLinear), actOnVector(m.givenAngular);
  actOnVector(m.linear), actOnVector(m.angular);
  Sym3& i = m.inertia;
  act(i.xx), act(i.yy), act(i.zz), act(i.xy), act(i.xz), act(i.yz);
}
/// MomentumSums in fixed point, so that sums do not depend on the order. The unit is 2^-kTermBits of a power
/// of two above every term of its kind, so that 2^22 terms fit one sum.
struct IslandSums {
  static constexpr int kTermBits = 40;
  std::int64_t sum[kMomentumTerms];
  int largest[kMomentumTerms];  ///< largest term, as the bits of a float
  int root;                     ///< root body of the island

  /// Are all terms finite?
  RUBBLE_HD bool isKnown(int k) const { return largest[k] >> 23 < 255; }
  RUBBLE_HD std::int64_t inUnits(int k, Real term) const {
    return std::llrint(std::ldexp(static_cast<double>(term), shift(k)));
  }
  RUBBLE_HD Real sumOf(int k) const {
    return static_cast<Real>(std::ldexp(static_cast<double>(sum[k]), -shift(k)));
  }

 private:
  /// Exponent of the fixed-point unit: a float with exponent bits e is below 2^(e - 126).
  RUBBLE_HD int shift(int k) const { return kTermBits - (largest[k] >> 23) + 126; }
};
/// Momentum correction of an island at the end of a step. Velocities are in the frame of MomentumSums.
struct IslandRepair {
  Vec3d center;               ///< center of mass at the end of the step [m]
  Vec3 velocity, spin;        ///< rigid motion that has the momenta of the iterates [m/s, rad/s]
  Vec3 addVelocity, addSpin;  ///< correction of that rigid motion
  Real loss;                  ///< share of the motion relative to it that is removed [1]
  int active;                 ///< 0: the sums are not finite
};

/// Sizes of the cells of the grid. Cells of size k have an edge of 2^(k - kMetreLevel) m: a fixed ladder, not
/// a scale of the scene.
inline constexpr int kGridSizes = 32;
inline constexpr int kMetreLevel = 16;
/// Grid levels: one of each size, and another one of each size for bodies with long paths.
inline constexpr int kGridLevels = 2 * kGridSizes;
/// Bias of cell coordinates; larger than any cell index.
inline constexpr int kCellOrigin = 1 << 30;
/// A level with at most this many bodies keeps them in a list, so that queries need not visit many cells to
/// find a few bodies.
inline constexpr int kListedBodies = 8;
/// At most so many bodies search for neighbors in many cells at a time (stages/pairs/lasting_search.h).
inline constexpr int kMostCoarse = 8;

/// Counters of a step. A `required` counter may exceed its capacity; the tables then grow and the step runs
/// again.
struct Counters {
  int pairs, activePairs, manifolds, incidences, colors;
  int pathCells;  ///< buckets that store long paths: all of the grid, or none
  int searchers;  ///< bodies whose last search for neighbors does not hold; not all if there are many
  int allSearch;  ///< 1: all bodies search in this step, however many searchers there are
  int searched;   ///< bodies that search: the searchers, or all
  int crowded;    ///< bodies with more neighbors than slots
  int coarse, coarseBody[kMostCoarse];  ///< searchers that visit many cells, unless all search
  int contacts, recycled, newPairs, tested;
  int aggregates, slices, boundary;
  int clashing, clashes, rounds;  ///< nodes that need a new color, color conflicts left, and coloring rounds
  int fastBodies;                 ///< those that need CCD: they move far, or are pressed into another
  int searchedBodies;             ///< those of them that CCD searches for others without a pair
  int swept;                      ///< pairs of which CCD lists those of fast bodies: all, or none
  int sweptPairs;                 ///< those that it has listed
  int arcs;                       ///< 1: points of a body go on arcs (stages/contacts/arcs.h)
  int carriers;                   ///< 1: a body moves that may carry others (stages/ccd/carriers.h)
  int ccdImpacts, ccdRounds;      ///< not 0: the last search of CCD found impacts; number of later searches
  int stopped;                    ///< bodies whose motion CCD cut short
  int asleep;                     ///< bodies asleep after this step
  int quarantined, failedSolves, boundedSteps, spinLimited, broken;
  int unfinished;  ///< largest motion of a body in the last sweep over its bounding diameter, as the bits of
                   ///< a float [1]
  int pointPairs, pointContacts, pointIncidences;
  int bounces, bounceRows;  ///< 1: a contact with restitution closes fast; contacts, if one does
  int bounceSpread, bounceSpreads, bounceBound, bounceBounds, bounceLeft,
      bounceRounds;  ///< restitution rounds: work left, and number of rounds
  int bouncesLeft;   ///< contacts that still close after the last restitution round
  int columnNodes;   ///< bodies of all columns
  int freeIslands;   ///< islands that no row connects to the world or to a non-dynamic body
  int rollers;       ///< active pairs, if some material has rolling resistance
  int nearFeatures;  ///< candidate pairs of features whose swept motions may meet
  int crossingWork;  ///< the same count, but at least the number of vertices
  int crossings,
      crossingRounds;        ///< pairs of features that would come too near, and rounds to resolve them
  int deflected, held;       ///< vertices whose motion was deflected or cut for that
  int boxLevels[kBoxKinds];  ///< bit mask of the used levels of the box grids
  int boxHalf[kBoxKinds][kBoxLevels][3];  ///< largest half extents, as bits like levelHalf [m]
  int levelCount[kGridLevels];  ///< bodies of a level; counted up to a little more than kListedBodies
  int levelBody[kGridLevels][kListedBodies];  ///< the first of them, in no fixed order
  int levelHalf[kGridLevels][3];  ///< largest half extents of a level, as the bits of non-negative floats [m]
  int levelReach[kGridLevels][2][3];  ///< used cells: kCellOrigin minus the lowest, and plus the highest
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// What is kept of a body, besides its arrays of state.
#include "collision/lattice.h"
#include "collision/manifold.h"
#include "forces/forces.h"
#include "forces/rolling.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

enum class BodyKind : int { Removed, Static, Kinematic, Dynamic };

/// Authored once; read-only in a step. No bytes lie between or behind the members: hashes take all of them.
struct BodyParams {
  ShapeData shape;
  BodyKind kind;
  int surface;   ///< its material in the shared table, -1: the numbers below with the usual rules
  Real mass;     ///< [kg]; 0 unless dynamic
  Vec3 inertia;  ///< principal moments, body axes [kg m2]
  Real radius;   ///< bounding sphere [m]
  Real muStatic, muDynamic;
  Real restitution;
  Real gravityScale;
};
static_assert(sizeof(BodyParams) == sizeof(ShapeData) + 2 * sizeof(int) + 9 * sizeof(Real));

/// A material in full.
struct SurfaceData {
  Real muStatic, muDynamic, restitution;
  int frictionCombine, restitutionCombine;  ///< rubble::Combine
  Real rolling, torsional;                  ///< levers of the moments that resist [m]
  Vec3 velocity;                            ///< of a belt, body axes [m/s]
};

/// What few bodies have: read once a step.
struct BodyExtras {
  Real linearDamping, angularDamping;  ///< [1/s]
  int locks;   ///< bits 0-2: no translation along world x, y, z; bits 3-5: no rotation about them
  int traits;  ///< bits 1 << BodyTrait
};

/// What few bodies have, and stages ask for at once: the world counts the bodies that have each.
enum class BodyTrait { GeneralShape, Rolls, Bounces, Locked, Filtered };
inline constexpr int kBodyTraits = 5;
struct TraitCounts {
  int bodies[kBodyTraits] = {};
  RUBBLE_HD int& operator[](BodyTrait t) { return bodies[static_cast<int>(t)]; }
  RUBBLE_HD int operator[](BodyTrait t) const { return bodies[static_cast<int>(t)]; }
  /// `change` more bodies have the traits of these bits.
  void count(int traits, int change) {
    for (int t = 0; t < kBodyTraits; ++t) bodies[t] += (traits >> t & 1) * change;
  }
};

/// Which bodies meet (CollisionFilter), and whether they push.
struct BodyFilter {
  std::uint32_t layers, mask;
  int group;
  int sensor;
};

/// World-aligned box swept over the step, with its cell in the grid of its level.
struct Bounds {
  Vec3 centre, half;  ///< [m]
  int level;          ///< -1: not in the grid (planes, removed bodies)
  int x, y, z;        ///< cell
};

/// A body in its place in the grid.
struct alignas(8 * sizeof(Real)) GridEntry {
  Vec3 centre, half;  ///< of its bounds [m]
  int body;
  int level;
};

/// Two parts of bodies whose swept boxes meet. The pair belongs to the body of the finer grid level; of two
/// in one level to that of lower index. What first and second are is said in stages/pairs/pair_parts.h; of
/// two plain shapes both are 0.
struct alignas(16) Pair {
  int owner, other;
  std::uint32_t ownerIsA : 1;  ///< the owner has the lower id
  std::uint32_t first : 31;
  int second;
};
static_assert(sizeof(Pair) == 4 * sizeof(int));
/// Pairs of one owner are in this order.
RUBBLE_HD constexpr bool before(const Pair& a, const Pair& b) {
  return a.other != b.other   ? a.other < b.other
         : a.first != b.first ? a.first < b.first
                              : a.second < b.second;
}
RUBBLE_HD constexpr bool samePair(const Pair& a, const Pair& b) {
  return a.other == b.other && a.first == b.first && a.second == b.second;
}

/// One row block that acts on a body, seen from it.
struct Incidence {
  std::uint32_t code;  ///< sorted: force type (5 bits), index (26 bits), side (1 bit)
  int other;           ///< the other dynamic body or vertex (kVertexNode + index), or -1
  int depth;  ///< coarse levels at which the two bodies are in different groups (nested: the finest ones)
};
inline constexpr int kContactType = 0;  ///< joint type i is i + 1
RUBBLE_HD constexpr std::uint32_t constraintCode(int type, int index, int side) {
  return static_cast<std::uint32_t>(type) << 27 | static_cast<std::uint32_t>(index) << 1 |
         static_cast<std::uint32_t>(side);
}
RUBBLE_HD constexpr int constraintType(std::uint32_t code) { return static_cast<int>(code >> 27); }
RUBBLE_HD constexpr int constraintIndex(std::uint32_t code) {
  return static_cast<int>((code & 0x07ffffffu) >> 1);
}
RUBBLE_HD constexpr int constraintSide(std::uint32_t code) { return static_cast<int>(code & 1u); }

/// Entries of joints. One with carriers has up to four bodies; each has an incidence that acts and, as it has
/// several neighbours there, up to two more that only tell of these (`link` 1, 2).
template <class F> RUBBLE_HD constexpr std::uint32_t jointCode(int index, int side, int link = 0) {
  constexpr int kType = typeIndex<F>(JointTypes{}) + 1;
  return isCarried<F>() ? constraintCode(kType, 8 * index + 2 * side + link / 2, link % 2)
                        : constraintCode(kType, index, side);
}
template <class F> RUBBLE_HD constexpr int jointIndex(std::uint32_t code) {
  return isCarried<F>() ? constraintIndex(code) / 8 : constraintIndex(code);
}
template <class F> RUBBLE_HD constexpr int jointSide(std::uint32_t code) {
  return isCarried<F>() ? constraintIndex(code) / 2 % 4 : constraintSide(code);
}
template <class F> RUBBLE_HD constexpr bool isLink(std::uint32_t code) {
  return isCarried<F>() && (constraintIndex(code) % 2 != 0 || constraintSide(code) != 0);
}

/// Where a body would go without constraints, and its inertia, in this step. Aligned, so that it is read and
/// written in few pieces.
struct alignas(4 * sizeof(Real)) BodyTarget {
  MassMatrix mass;
  Pose y;      ///< displacement [m] and rotation relative to x^t
  int locks;   ///< of BodyExtras
  int unused;  ///< 0
};

/// What a contact has to do with an impact (stages/bounces/bounce.h).
struct Bounce {
  Vec3 before[kLanes];   ///< multipliers with which the points began the step: normal, tangents [N]
  Real impulse[kLanes];  ///< what the step added to the impulses of the normal rows [N s]
  Real start, change;  ///< closing speed at x^t, and what forces add to it, by the loads of the points [m/s]
  Real gap, end;       ///< gap at x^t and at the end of the step, below 0 in one another, likewise [m]
  Real time;           ///< until it acts, below 0: it does not [s]
  int carries, state;  ///< its load changed as in an impact; BounceState
};
struct BodyMotion {
  Vec3 v, w;  ///< [m/s], [rad/s]
};

/// What a contact does to bear one of its bodies, as found at the end of a step
/// (stages/bodies/corrections.h).
struct Support {
  Vec3 correction;  ///< of B against A along the normal: what is corrected of their penetration in a step [m]
  Real weight;      ///< force on B against gravity; below 0: it bears A [N]
};

/// Levels of aggregates of bodies and soft nodes, from fine to coarse (stages/coarse/aggregates.h).
inline constexpr int kCoarseLevels = 4;
/// The finest of them, which odd iterations sweep; even ones sweep all but the finest.
inline constexpr int kFineLevels = 2;

/// A aggregate of bodies and soft nodes that the coarse correction moves as one.
struct Aggregate {
  Vec3d centre;    ///< centre of mass [m]
  Block6 inertia;  ///< Hessian of the inertia of its bodies about the centre; no force
  Vec6 step;       ///< motion found by the last solve [m, rad]
  int level;
  int locks;   ///< motions that one of its bodies must not make, as in BodyExtras
  int joined;  ///< 1: joints hold some of its bodies together, and all move about their present places
               ///< (coarse.h)
  int soft;    ///< 1: there are soft nodes, and the aggregate does not turn
  int sliceBegin, sliceEnd;
};

/// A part of an aggregate that one worker sums over.
struct Slice {
  int aggregate;
  int begin, end;  ///< in aggregateNode
  Block6 sum;
};
inline constexpr int kSliceNodes = 32;

/// Sums over an island, or a part of it, about a fixed point and in a frame that goes on with its leader
/// (stages/islands/island_momentum.h).
struct MomentumSums {
  Real mass;                       ///< [kg]
  Real freeEnergy, energy;         ///< kinetic, of the inertial targets and of the iterates [J]
  Vec3 place;                      ///< first moment of the masses at the end of the step [kg m]
  Vec3 givenLinear, givenAngular;  ///< momenta that rows have given [kg m/s, kg m2/s]
  Vec3 linear, angular;            ///< momenta of the iterates
  Sym3 inertia;                    ///< [kg m2]
};
inline constexpr int kMomentumTerms = sizeof(MomentumSums) / sizeof(Real);
/// act(term) for each number of the sums.
template <class Act> RUBBLE_HD void forEachTerm(MomentumSums& m, Act&& act) {
  act(m.mass), act(m.freeEnergy), act(m.energy);
  const auto actOnVector = [&](Vec3& v) { act(v.x), act(v.y), act(v.z); };
  actOnVector(m.place), actOnVector(m.givenLinear), actOnVector(m.givenAngular);
  actOnVector(m.linear), actOnVector(m.angular);
  Sym3& i = m.inertia;
  act(i.xx), act(i.yy), act(i.zz), act(i.xy), act(i.xz), act(i.yz);
}
/// The same as whole numbers, whose sums do not depend on the order: in units of 2^-kTermBits of a power of
/// two that no term of its kind reaches, so that 2^22 of them fit a sum.
struct IslandSums {
  static constexpr int kTermBits = 40;
  std::int64_t sum[kMomentumTerms];
  int largest[kMomentumTerms];  ///< of the terms, as the bits of a float
  int root;                     ///< the body that leads the island

  /// Are all terms finite?
  RUBBLE_HD bool isKnown(int k) const { return largest[k] >> 23 < 255; }
  RUBBLE_HD std::int64_t inUnits(int k, Real term) const {
    return std::llrint(std::ldexp(static_cast<double>(term), shift(k)));
  }
  RUBBLE_HD Real sumOf(int k) const {
    return static_cast<Real>(std::ldexp(static_cast<double>(sum[k]), -shift(k)));
  }

 private:
  /// Power of two of the units: a float with the exponent bits e is below 2^(e - 126).
  RUBBLE_HD int shift(int k) const { return kTermBits - (largest[k] >> 23) + 126; }
};
/// What an island is given at the end of a step. Velocities in the same frame.
struct IslandRepair {
  Vec3d centre;               ///< of mass, at the end of the step [m]
  Vec3 velocity, spin;        ///< of the rigid motion that has the momenta of the iterates [m/s, rad/s]
  Vec3 addVelocity, addSpin;  ///< added to it
  Real loss;                  ///< share of all other motion that is taken away [1]
  int active;                 ///< 0: the sums are not finite
};

/// Levels of the grid: cells of level k have an edge of 2^(k - kMetreLevel) m, a ladder and no scale.
inline constexpr int kGridLevels = 32;
inline constexpr int kMetreLevel = 16;
/// More than any cell of the grid is from the first.
inline constexpr int kCellOrigin = 1 << 30;
/// A level with no more bodies than this lists them: nobody looks for a ball or the ground in a hundred
/// cells.
inline constexpr int kListedBodies = 8;

/// Numbers that a step counts. `required` fields may exceed the room there is; then the step is begun again
/// with more.
struct Counters {
  int pairs, activePairs, manifolds, incidences, colors;
  int contacts, recycled, newPairs, tested;
  int aggregates, slices, boundary;
  int clashing, clashes, rounds;  ///< nodes that choose a colour, those left to choose again, rounds of that
  int anyFast;                    ///< 1: a body goes far, or is pressed into another
  int swept;                      ///< pairs to be searched for fast bodies: all, or none
  int stopped;                    ///< bodies that stopped at an impact
  int asleep;                     ///< bodies that sleep after this step
  int quarantined, failedSolves, boundedSteps, spinLimited, broken;
  int unfinished;  ///< largest motion of a body in the last sweep over its bounding diameter, as the bits of
                   ///< a float [1]
  int pointPairs, pointContacts, pointIncidences;
  int bounces, bounceRows;  ///< 1: a contact with restitution closes fast; contacts, if one does
  int bounceSpread, bounceSpreads, bounceBound, bounceBounds, bounceLeft,
      bounceTurns;   ///< of its rounds: what is left to do, and how many there were
  int bouncesLeft;   ///< contacts that still close after the last round
  int freeIslands;   ///< bodies that rows connect and nothing holds
  int rollers;       ///< near pairs, where some material has rolling friction
  int nearFeatures;  ///< pairs of features that may meet on their ways
  int crossingWork;  ///< as many, and at least as many as there are vertices
  int crossings,
      crossingRounds;        ///< pairs of features that would come too near, and rounds until there are none
  int deflected, held;       ///< vertices whose way was changed, or cut, for that
  int boxLevels[kBoxKinds];  ///< levels of the grids of boxes in use, a bit each
  int boxHalf[kBoxKinds][kBoxLevels][3];  ///< largest half extents, as bits like levelHalf [m]
  int levelCount[kGridLevels];            ///< bodies of a level, counted up to kListedBodies and a few more
  int levelBody[kGridLevels][kListedBodies];  ///< the first of them, in no fixed order
  int levelHalf[kGridLevels][3];  ///< largest half extents of a level, as the bits of non-negative floats [m]
  int levelReach[kGridLevels][2]
                [3];  ///< cells of a level in use: kCellOrigin less the lowest, and plus the highest
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// What the arrays of SolverData have one element per, and how long their content stays valid.
#include "forces/forces.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

/// What an array has one element per.
enum class Per {
  Body,
  BodySlot,
  NodeLevel,
  Member,  ///< a node of an aggregate, at all levels
  Pair,
  ActivePair,
  Manifold,
  Incidence,
  Cell,
  PathCell,
  Color,
  Aggregate,
  Slice,
  Boundary,
  Level,
  Plane,
  Exclusion,
  ShapeVector,
  ShapeIndex,
  ShapePart,
  Surface,
  MaterialRule,
  Rolling,
  Bounce,
  FreeIsland,
  ColumnNode,
  TreeNode,
  TreeChild,
  SmallTree,
  Vertex,
  PointOwner,
  PointOwnerSlot,
  NearFeature,
  Feature,
  FeatureCell,
  Neighbor,
  ElementRef,
  TetraCorner,
  PointPair,
  PointIncidence,
  ParticleCell,
  Attachment,
  Cluster,
  ClusterRef,
  SoftNode,
  Strand,
  StrandVertex,
  Node,
  World,
  FirstElement,
  FirstJoint = FirstElement + ElementTypes::kSize
};
/// Element types take consecutive values from FirstElement on, joint types from FirstJoint on.
inline constexpr int kPerCount = static_cast<int>(Per::FirstJoint) + JointTypes::kSize;

/// How long the content of an array stays valid:
///   Authored   written by edits
///   Derived    computed on the host from authored data
///   Batch      written by edits, as parameters are; no part of the state of a world
///   State      kept from step to step
///   Work       valid inside one step
///   Unordered  like Work; the order of its elements, or what is left of counters and beyond the members of a
///              list, is not fixed and does not influence results
enum class Lifetime { Authored, Derived, Batch, State, Work, Unordered };
/// Does a snapshot keep such an array?
constexpr bool isKept(Lifetime life) { return life == Lifetime::Authored || life == Lifetime::State; }

/// Pairs that a body may own before the broad phase runs again with more room.
inline constexpr int kPairSlots = 20;

constexpr Per perJoint(int type) { return static_cast<Per>(static_cast<int>(Per::FirstJoint) + type); }
/// Index of the joint type of `per`, or -1.
constexpr int jointTypeOf(Per per) {
  return per < Per::FirstJoint ? -1 : static_cast<int>(per) - static_cast<int>(Per::FirstJoint);
}

template <class F> constexpr Per perElement() {
  return static_cast<Per>(static_cast<int>(Per::FirstElement) + typeIndex<F>(ElementTypes{}));
}

}  // namespace rubble::RUBBLE_CORE

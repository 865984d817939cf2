#pragma once
/// What arrays of the engine have elements of, and how long their content matters.
#include "forces/forces.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

/// What an array has one element of.
enum class Per {
  Body,
  BodySlot,
  NodeLevel,
  Pair,
  ActivePair,
  Manifold,
  Incidence,
  Cell,
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
  Rolling,
  Bounce,
  FreeIsland,
  TreeNode,
  TreeChild,
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
  FirstElement,
  FirstJoint = FirstElement + ElementTypes::kSize
};
/// The element types follow one another from FirstElement on, the joint types from FirstJoint on.
inline constexpr int kPerCount = static_cast<int>(Per::FirstJoint) + JointTypes::kSize;

/// How long its content matters: authored (written by edits), derived (by the host from what is authored),
/// state (from step to step), work (inside one step), unordered (work whose order of elements is not fixed
/// and has no influence on results).
enum class Lifetime { Authored, Derived, State, Work, Unordered };

/// Candidates that a body may own before its pairs are searched a second time.
inline constexpr int kPairSlots = 20;

constexpr Per perJoint(int type) { return static_cast<Per>(static_cast<int>(Per::FirstJoint) + type); }
/// The joint type that a kind of element is one of, or -1.
constexpr int jointTypeOf(Per per) {
  return per < Per::FirstJoint ? -1 : static_cast<int>(per) - static_cast<int>(Per::FirstJoint);
}

template <class F> constexpr Per perElement() {
  return static_cast<Per>(static_cast<int>(Per::FirstElement) + typeIndex<F>(ElementTypes{}));
}

}  // namespace rubble::RUBBLE_CORE

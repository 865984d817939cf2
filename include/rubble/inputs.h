#pragma once
/// The calls that change a world, as data. World::setInputSink() passes on each of them, so that a log of all
/// can be replayed (io/input_log.h, docs/determinism.md). Members have the meaning of the arguments of the
/// call, and are valid while the sink runs.
#include <functional>
#include <span>
#include <variant>

#include <rubble/arrays.h>
#include <rubble/ids.h>
#include <rubble/params.h>
#include <rubble/scene.h>

namespace rubble {
struct BodyState;
class Snapshot;
}  // namespace rubble

namespace rubble::inputs {

struct Step {};
struct AddBodies {
  std::span<const BodyDef> bodies;
};
struct RemoveBodies {
  std::span<const BodyId> ids;
};
struct SetCollide {
  BodyId a, b;
  bool collide;
};
struct SetStates {
  std::span<const BodyId> ids;
  std::span<const BodyState> states;
};
struct SetTarget {
  BodyId id;
  Vec3 position;
  Quat orientation;
};
struct ApplyForces {
  std::span<const BodyId> ids;
  std::span<const Vec3> forces;
  std::span<const Vec3> torques;  ///< may be empty
};
struct ApplyImpulses {
  std::span<const BodyId> ids;
  std::span<const Vec3> impulses;
};
struct Wake {
  BodyId id;
};
struct SortBodies {};
struct Scatter {
  StateArray which;
  const ArrayView& rows;
  const ArrayView& values;
};
/// Also of setMaterial() and other changes of a definition.
struct SetBodyDefinition {
  BodyId id;
  const BodyDef& body;
};
struct ScatterJoints {
  JointArray which;
  const ArrayView& rows;
  const ArrayView& values;
};
struct AddJoint {
  const JointDef& joint;
  BodyId a, b, frameBodyA, frameBodyB;
};
struct RemoveJoint {
  JointId id;
};
/// Also of setLimits() and other changes of a definition.
struct SetDefinition {
  JointId id;
  const JointDef& joint;
};
struct AddDeformable {
  const Deformable& deformable;
};
struct SetDeformableDefinition {
  DeformableId id;
  const Deformable& deformable;
};
struct RemoveDeformable {
  DeformableId id;
};
struct AddAttachment {
  const AttachmentDef& attachment;
  DeformableId object;
  BodyId body;
  DeformableId otherObject;
};
struct RemoveAttachment {
  AttachmentId id;
};
struct SetVertices {
  DeformableId id;
  std::span<const Vec3> positions, velocities;
};
struct ApplyVertexForce {
  DeformableId id;
  int vertex;
  Vec3 force;
};
struct SetParams {
  const Params& params;
};
struct SetGravity {
  Vec3 gravity;
};
/// Also of the end of a rule (`removed`).
struct SetMaterialPair {
  const MaterialPair& pair;
  bool removed = false;
};
struct TakeSnapshot {
  const Snapshot& snapshot;
};
struct Restore {
  const Snapshot& snapshot;
};

using Call = std::variant<Step, AddBodies, RemoveBodies, SetCollide, SetStates, SetTarget, ApplyForces,
                          ApplyImpulses, Wake, SortBodies, Scatter, AddJoint, RemoveJoint, SetDefinition,
                          AddDeformable, RemoveDeformable, AddAttachment, RemoveAttachment, SetVertices,
                          ApplyVertexForce, SetParams, SetGravity, TakeSnapshot, Restore, ScatterJoints,
                          SetBodyDefinition, SetMaterialPair, SetDeformableDefinition>;
using Sink = std::function<void(const Call&)>;

}  // namespace rubble::inputs

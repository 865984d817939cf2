#pragma once
/// A running simulation.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rubble/arrays.h>
#include <rubble/error.h>
#include <rubble/events.h>
#include <rubble/ids.h>
#include <rubble/inputs.h>
#include <rubble/log.h>
#include <rubble/memory.h>
#include <rubble/params.h>
#include <rubble/query.h>
#include <rubble/ranks.h>
#include <rubble/report.h>
#include <rubble/scene.h>
#include <rubble/streams.h>
#include <rubble/tasks.h>

namespace rubble {

struct BodyState {
  Vec3 position;         ///< of the shape frame, world [m]
  Quat orientation;      ///< body -> world
  Vec3 velocity;         ///< of the center of mass [m/s]
  Vec3 angularVelocity;  ///< world axes [rad/s]
};

/// Sum of all contacts of the last step on a body.
struct ContactLoad {
  Vec3 force;           ///< [N]
  Vec3 torque;          ///< about its center of mass [N m]
  double residual = 0;  ///< largest remaining penetration [m]
  int points = 0;
};

/// State of a joint axis, in the order of JointDef::axes. Forces act on A along the axis: positive forces
/// increase `position`.
struct JointAxisState {
  double position = 0;    ///< [m], [rad]; angles count whole revolutions
  double speed = 0;       ///< [m/s], [rad/s]
  double limitForce = 0;  ///< [N], [N m]
  double driveForce = 0;
  double frictionForce = 0;
  double motorForce = 0;  ///< of armature, damping and JointAxis::motorForce
};

/// State of a joint after the last step.
struct JointState {
  /// Linear constraint error [m]: distance of the anchors, or excess over a length.
  double gap = 0;
  double angle = 0;                  ///< angular constraint error [rad]
  Vec3 force;                        ///< on body B, at its anchor [N]
  Vec3 torque;                       ///< on body B, about its anchor [N m]
  std::vector<JointAxisState> axes;  ///< the axes of the joint type
  bool broken = false;
};

/// A contact of a vertex in the last step, with a body or with another vertex.
struct VertexContact {
  DeformableId object;
  int vertex;
  BodyId body;               ///< BodyId{}: contact with a vertex
  DeformableId otherObject;  ///< DeformableId{}: contact with a body
  int otherVertex;
  /// Unit vector from the body to the vertex, or from the vertex to the other vertex.
  Vec3 normal;
  double depth;  ///< > 0: penetration [m]
  Vec3 force;    ///< on the vertex; for two vertices on the other one [N]
};

struct WorldOptions {
  /// "cpu", "reference" (double precision), "distributed", "backward" and "lockstep" (they check "cpu"), or
  /// another name that backends() returns.
  std::string backend = "cpu";
  int threads = 0;    ///< 0: one per core
  RankOptions ranks;  ///< distributed only
  Params params;
  bool timings = true;  ///< measure stage times
  /// Collect the events of each step. On a GPU this copies its contacts to the host.
  bool events = false;
  LogSink log = {};  ///< empty: no log
  /// "cpu", "reference" and Worlds of them: a scheduler of the host, in place of `threads`.
  TaskSystem tasks = {};
  /// "cpu", "reference" and Worlds of them: an allocator of the host for the tables.
  MemorySystem memory = {};
  /// Of a CPU: one of instructionSets() (rubble/info.h); empty: the last of them. All give the same bits.
  std::string instructionSet = {};
};

/// The complete state of a world. A restored world continues bit for bit, if its backend is the same. The
/// state stays on the device on a GPU. A snapshot is immutable, and copies share its data.
class Snapshot {
 public:
  struct Data;
  std::shared_ptr<const Data> data;

  /// The snapshot as bytes, for a file: a save game. Throws Error for one of a world of Worlds, and for
  /// joints or elements whose type is an extension.
  std::vector<std::byte> bytes() const;
  /// Throws Error unless the bytes are whole and of this version and table layout of Rubble. A checksum finds
  /// damage, not malice: load files from trusted sources only.
  static Snapshot fromBytes(std::span<const std::byte> bytes);
};

/// A world belongs to one thread at a time. Different worlds may be used at once. Where memory ends, a call
/// throws OutOfMemory: an edit has changed nothing then, and a step has kept poses and velocities.
class World {
 public:
  /// Throws Error if the scene, the options or the parameters are invalid.
  explicit World(const Scene& scene, const WorldOptions& options = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Advances the world by params().dt, after the scripted events of the scene that are due. Throws Error for
  /// an event that names what is not there; the next call goes on after it. Throws OutOfMemory if memory
  /// cannot be allocated. If stepCount() is unchanged, the world has kept its state but lost its contacts,
  /// which the next step detects again. Else the step is complete, and only its report and its events are
  /// lost.
  StepReport step();
  /// Applies the scripted events that are due, as calls of this interface, so that changes before the next
  /// step find them done. Snapshots hold events that are not due yet.
  void runEvents();

  const Params& params() const;
  void setParams(const Params& params);
  Vec3 gravity() const;
  void setGravity(const Vec3& gravity);
  /// Adds a rule for two named materials, in place of the one they had. Materials of these names may come
  /// later.
  void setMaterialPair(const MaterialPair& pair);
  /// Throws Error if the two names have no rule.
  void removeMaterialPair(const std::string& a, const std::string& b);
  const std::vector<MaterialPair>& materialPairs() const;
  std::int64_t stepCount() const;
  double time() const;  ///< [s]

  // Bodies. Every call throws Error for an id that is not alive.
  BodyId addBody(const BodyDef& body);
  void removeBody(BodyId id);  ///< removes its joints as well
  /// Enables or disables collision between two bodies. A joint between them may disable it as well.
  void setCollide(BodyId a, BodyId b, bool collide);
  bool alive(BodyId id) const;
  std::vector<BodyId> bodies() const;              ///< bodies that are alive, by index
  BodyId findBody(const std::string& name) const;  ///< throws Error if no body has that name
  BodyId bodyAt(int sceneIndex) const;             ///< body of Scene::bodies[sceneIndex]
  const BodyDef& definition(BodyId id) const;
  MassProperties massOf(BodyId id) const;
  BodyState state(BodyId id) const;
  void setState(BodyId id, const BodyState& state);
  /// Replaces the definition from the next step on. Pose and velocities of the definition are ignored: the
  /// body moves on as a rigid body, but a static body has no velocity. Contacts and multipliers are kept
  /// unless the shape changes. Joints and attachments keep their anchors in the shape frame. The name must be
  /// unchanged.
  void setDefinition(BodyId id, const BodyDef& body);
  // Single fields of the definition, likewise.
  void setMaterial(BodyId id, const Material& material);
  void setFilter(BodyId id, const CollisionFilter& filter);
  void setMotion(BodyId id, Motion motion);
  void setMass(BodyId id, double mass);  ///< [kg]; scales the inertia unless BodyDef::inertia gives it
  void setShape(BodyId id, const Shape& shape);
  void setDamping(BodyId id, double linear, double angular);  ///< [1/s]
  void setGravityScale(BodyId id, double scale);              ///< [1]
  void setLocks(BodyId id, const std::array<bool, 3>& translation, const std::array<bool, 3>& rotation);
  void setSensor(BodyId id, bool sensor);
  void setUserData(BodyId id, std::uint64_t userData);
  std::uint64_t userData(BodyId id) const;

  // Shapes. Bodies with equal shapes share one: the same type, sizes, geometry object and userData. It is
  // freed with its last use, which is a body or a call of addShape(), and its place in the tables is used
  // again. Every call throws Error for an id that is not alive.
  /// Adds a use of a shape, and cooks it if it is new. Throws Error with the path of an invalid field.
  ShapeId addShape(const Shape& shape);
  /// Takes back one call of addShape(). Throws Error if there is none.
  void removeShape(ShapeId id);
  bool alive(ShapeId id) const;
  std::vector<ShapeId> shapes() const;  ///< shapes that are alive, by index
  ShapeId shapeOf(BodyId id) const;
  /// For BodyDef::shape, setShape() and queries.
  const Shape& definition(ShapeId id) const;
  int useCount(ShapeId id) const;  ///< bodies and calls of addShape()
  /// Shape::userData of a part of a compound, or of the whole body.
  std::uint64_t shapeUserData(BodyId id, int part = 0) const;

  /// Material of a part of a compound, or of the whole body.
  Material materialOf(BodyId id, int part = 0) const;
  std::vector<JointId> jointsOf(BodyId id) const;         ///< its joints and those it is the frame body of
  std::vector<ContactPoint> contactsOf(BodyId id) const;  ///< of the last step
  /// Of the center of mass [m/s] and about it, world axes [rad/s].
  void setVelocity(BodyId id, const Vec3& velocity, const Vec3& angularVelocity);
  /// Kinematic bodies: sets the pose to reach in the next step.
  void setTarget(BodyId id, const Vec3& position, const Quat& orientation);
  void applyForce(BodyId id, const Vec3& force);  ///< at the center of mass, for the next step [N]
  void applyForceAt(BodyId id, const Vec3& force, const Vec3& point);      ///< [N], at a world point [m]
  void applyTorque(BodyId id, const Vec3& torque);                         ///< for the next step [N m]
  void applyImpulse(BodyId id, const Vec3& impulse);                       ///< at the center of mass [N s]
  void applyImpulseAt(BodyId id, const Vec3& impulse, const Vec3& point);  ///< [N s], at a world point [m]
  void applyAngularImpulse(BodyId id, const Vec3& impulse);                ///< world axes [N m s]

  // Batched edits: element k of each list is one call of the functions above. The whole list is checked
  // first, so an Error changes nothing. On a GPU all edits between two steps are one upload, without
  // synchronization.
  std::vector<BodyId> addBodies(std::span<const BodyDef> bodies);
  void removeBodies(std::span<const BodyId> ids);
  void setStates(std::span<const BodyId> ids, std::span<const BodyState> states);
  /// `torques` may be empty.
  void applyForces(std::span<const BodyId> ids, std::span<const Vec3> forces,
                   std::span<const Vec3> torques = {});
  void applyImpulses(std::span<const BodyId> ids, std::span<const Vec3> impulses);

  // State of all bodies as arrays. Row BodyId::index is that body. Rows of removed bodies keep their last
  // values. Positions are those of the center of mass, orientations those of the principal axes.
  // MassProperties gives both in the shape frame.
  /// A read-only view of an array, with all edits applied. Use scatter() to write. The view is valid until
  /// bodies are added, removed or sorted, or a snapshot is restored. Steps and other edits only change its
  /// content; edits appear at the latest in the next step.
  ArrayView array(StateArray which) const;
  /// A counter that changes when array views become invalid.
  std::int64_t epoch() const;
  /// Sorts the bodies in memory along a space-filling curve, with the next step. Ids, states and contacts are
  /// unchanged. It improves locality after many bodies were added in random order or have mixed.
  /// Params::sortInterval repeats it.
  void sortBodies();
  /// Writes row k of `values` to row rows[k] of an array; Force and Torque accumulate.
  /// `rows`: shape (n, 1), "<i4", without duplicates. `values`: shape (n, 3 or 4), "<f4" or "<f8". Both are
  /// host memory or, with the backend "cuda", both device memory. Device memory is read in the order of
  /// values.stream, so later work on that stream may overwrite it. Rows without a body are ignored. Values on
  /// the device are not checked: a step quarantines bodies that are not finite. Orientations are normalized.
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values);
  // Streams that read arrays of the backend "cuda". Once an array was taken, all writes (steps, scatter(),
  // edits, and the next array() of joints or sensors) come after the work so far of the legacy default
  // stream, and before its later work. They wait on the device, never on the host.
  /// Where the arrays are, and the stream of the engine.
  DeviceStream deviceStream() const;
  /// Orders another stream as the default one, while the result exists. The stream must exist until then, and
  /// is given as ArrayView::stream. Null for 0 and for arrays in host memory. The result may end in any
  /// thread.
  std::shared_ptr<void> addReader(std::uintptr_t stream) const;

  // Joints, sensors and vertices as arrays, in the memory of the backend. A view is valid until the next call
  // for the same array, or a call that adds or removes bodies, joints or deformable objects.
  /// An axis of a joint.
  struct Axis {
    JointId joint;
    int axis;  ///< index in JointDef::axes
  };
  /// The axes of all joints, in the order of the rows of a JointArray.
  std::vector<Axis> axes() const;
  ArrayView array(JointArray which) const;
  ArrayView array(SensorArray which) const;
  /// setVertices() and applyVertexForce() write.
  ArrayView array(VertexArray which) const;
  int firstVertex(DeformableId id) const;  ///< row of the first vertex of an object in a VertexArray
  /// Writes targets of drives, or adds forces for the next step, and wakes the bodies of the joints. As
  /// scatter() of states, with `values` of shape (n, 1). Definitions of joints do not change: setDefinition()
  /// and the calls that edit it replace targets by those of the definition.
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values);
  /// Sum of the contact forces of the last step between the two bodies of each pair, on the second one, world
  /// axes [N]: 3 numbers per pair. Valid until the next call.
  ArrayView contactForces(std::span<const std::array<BodyId, 2>> pairs) const;

  // Asynchronous copies of poses to the host, for rendering or learning.
  /// Starts a copy of the present poses and returns immediately. Following steps do not wait for it. At most
  /// two copies may be pending; a third call throws Error.
  void beginPoses();
  /// Returns whether the oldest pending copy is complete. Never waits.
  bool posesReady() const;
  /// Waits for the oldest pending copy and returns it. It stays valid until the second beginPoses() after the
  /// one that started it.
  PoseFrame takePoses();

  // Joints.
  /// Adds a joint between `a` and `b` (BodyId{}: the world). bodyA, bodyB and the frame bodies of the
  /// definition are ignored. `frameBodyA` and `frameBodyB` are the frame bodies of gears and racks.
  JointId addJoint(const JointDef& joint, BodyId a, BodyId b, BodyId frameBodyA = {}, BodyId frameBodyB = {});
  void removeJoint(JointId id);
  bool alive(JointId id) const;
  std::vector<JointId> joints() const;
  JointId findJoint(const std::string& name) const;
  const JointDef& definition(JointId id) const;
  std::array<BodyId, 2> bodiesOf(JointId id) const;       ///< A and B; BodyId{}: the world
  std::array<BodyId, 2> frameBodiesOf(JointId id) const;  ///< frame bodies; BodyId{}: the world
  JointState state(JointId id) const;
  /// Replaces the definition from the next step on: limits, drives, lengths, stiffnesses, frames. The type
  /// must be unchanged. Bodies, multipliers and the broken flag are kept. Quantities measured when the joint
  /// was made (a negative length, axes of gears) are kept as well.
  void setDefinition(JointId id, const JointDef& joint);
  void setUserData(JointId id, std::uint64_t userData);
  std::uint64_t userData(JointId id) const;
  /// Sets the drive of an axis. Throws Error if the joint does not have that axis.
  void setTargetPosition(JointId id, int axis, double position);  ///< [m], [rad]
  void setTargetSpeed(JointId id, int axis, double speed);        ///< [m/s], [rad/s]
  void setMotorForce(JointId id, int axis, double force);         ///< JointAxis::motorForce [N], [N m]
  void setLimits(JointId id, int axis, double min, double max);
  void setLength(JointId id, double length);                      ///< distance, rope, spring, pulley [m]
  void setDriveOrientation(JointId id, const Quat& orientation);  ///< swing-twist
  /// Drags a body by a point (world [m]) with a mouse joint, whose target setDragTarget() moves. The
  /// stiffness gives the mass of the body `frequency` [1/s] with critical damping, and the force is at most
  /// `maxForce` [N]. removeJoint() ends the drag.
  JointId addDragJoint(BodyId id, const Vec3& point, double maxForce, double frequency = 5);
  void setDragTarget(JointId id, const Vec3& target);  ///< world [m]

  // Deformable objects. Every call throws Error for an id that is not alive.
  DeformableId addDeformable(const Deformable& deformable);
  void removeDeformable(DeformableId id);  ///< removes its attachments as well
  bool alive(DeformableId id) const;
  std::vector<DeformableId> deformables() const;  ///< objects that are alive, by index
  DeformableId findDeformable(const std::string& name) const;
  DeformableId deformableAt(int sceneIndex) const;  ///< object of Scene::deformables[sceneIndex]
  const Deformable& definition(DeformableId id) const;
  /// Replaces the definition from the next step on. The kind, the name and the number of vertices must be
  /// unchanged. `start` and the velocities are ignored. Vertices keep position, velocity and contacts.
  /// Elements of the same vertices keep multipliers, tears and plastic strain; where there is plastic strain,
  /// `vertices` no longer gives the rest shape.
  void setDefinition(DeformableId id, const Deformable& deformable);
  void setUserData(DeformableId id, std::uint64_t userData);
  std::uint64_t userData(DeformableId id) const;
  int vertexCount(DeformableId id) const;
  std::vector<Vec3> positions(DeformableId id) const;   ///< of its vertices [m]
  std::vector<Vec3> velocities(DeformableId id) const;  ///< [m/s]
  std::vector<double> masses(DeformableId id) const;    ///< of its vertices; 0: fixed [kg]
  /// Sets the state of all vertices. Each span has vertexCount() elements. Contacts and multipliers are kept.
  void setVertices(DeformableId id, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  void applyVertexForce(DeformableId id, int vertex, const Vec3& force);  ///< for the next step [N]
  /// Geometry for rendering: triangles without torn ones, outward if the surface is closed. Objects without
  /// triangles have spheres or line segments.
  struct Surface {
    DeformableId id;
    std::vector<Vec3> vertices;  ///< [m]
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 2>> segments;  ///< of rods and nets, without broken ones
    double radius = 0;                         ///< of the spheres or the line [m]
    bool spheres = false;                      ///< each vertex is rendered as a sphere
  };
  Surface surface(DeformableId id) const;

  /// Adds an attachment between `object` and `body` (BodyId{}: the world), or `otherObject` (DeformableId{}:
  /// none). Object and body indices of the definition are ignored.
  AttachmentId addAttachment(const AttachmentDef& attachment, DeformableId object, BodyId body,
                             DeformableId otherObject = {});
  void removeAttachment(AttachmentId id);
  bool alive(AttachmentId id) const;
  std::vector<AttachmentId> attachments() const;
  JointState state(AttachmentId id) const;  ///< gap, force on the vertices, broken
  /// The two sides of an attachment.
  struct AttachmentEnds {
    DeformableId object;
    DeformableId otherObject;  ///< DeformableId{}: not a vertex-vertex attachment
    BodyId body;               ///< BodyId{}: the world, or a vertex-vertex attachment
    Vec3 anchor;               ///< in the body frame, or in the world [m]
  };
  AttachmentEnds endsOf(AttachmentId id) const;
  std::vector<VertexContact> vertexContacts() const;

  // Measures.
  Quality quality() const;
  std::vector<ContactPoint> contacts() const;
  ContactLoad contactLoad(BodyId id) const;
  /// Solver states of all bodies, in the order of bodies(), or of the vertices of an object.
  std::vector<SolverState> solverStates() const;
  std::vector<SolverState> solverStates(DeformableId id) const;
  /// Events of the last step. Empty unless WorldOptions::events is set, and after a restore or a reset.
  const Events& events() const;
  /// Sleeping (Params::sleeping). Edits and applied forces wake a body and its island automatically.
  bool asleep(BodyId id) const;
  void wake(BodyId id);
  // One query; each has a call for many below, which costs less per query.
  RayHit castRay(const RayQuery& ray);
  std::vector<RayHit> castRayAll(const RayQuery& ray);
  CastHit castShape(const CastQuery& cast);
  std::vector<BodyId> overlap(const OverlapQuery& shape);
  ClosestHit closestPoint(const ClosestQuery& point);
  // Batched queries (query.h).
  std::vector<RayHit> castRays(std::span<const RayQuery> rays);
  /// The same without an allocation. `hits`: as many as rays.
  void castRays(std::span<const RayQuery> rays, std::span<RayHit> hits);
  /// First hits of rays that are arrays. On a device nothing comes to the host, and nothing waits for it:
  /// rays are read and hits are written in the order of the streams, as by scatter().
  RayHitArrays castRayArrays(const RayArrays& rays);
  std::vector<CastHit> castShapes(std::span<const CastQuery> casts);
  std::vector<std::vector<BodyId>> overlaps(
      std::span<const OverlapQuery> shapes);  ///< bodies of each query, by slot
  std::vector<ClosestHit> closestPoints(std::span<const ClosestQuery> points);
  // All hits of each query: the first one of each part of each body, and of each deformable object, by
  // fraction; then bodies before objects, by slot and part. The host answers them. On a GPU they copy the
  // world to it.
  std::vector<std::vector<RayHit>> castRaysAll(std::span<const RayQuery> rays);
  std::vector<std::vector<CastHit>> castShapesAll(std::span<const CastQuery> casts);
  std::vector<std::vector<OverlapHit>> overlapsAll(std::span<const OverlapQuery> shapes);

  /// Memory of the tables of the engine, on the device or host [bytes].
  std::size_t memoryBytes() const;
  /// Reserves table memory for `count` elements of a kind, so that steps need not grow it. Kinds: "pairs",
  /// "activePairs", "manifolds", "rollers", "incidences", "colors", "aggregates", "slices", "boundary",
  /// "pointPairs", "pointIncidences", "nearFeatures" and others that StepReport::grown names. Results do not
  /// depend on it.
  void reserve(const std::string& kind, int count);
  /// Hash of the persistent state: equal states have equal hashes.
  std::uint64_t hash() const;
  /// Hashes of the single tables of that state, in a fixed order: to find what differs between two worlds.
  std::vector<TableHash> tableHashes() const;
  /// Passes on every call that changes this world from now on, after it succeeded. The sink may read the
  /// world. What it throws leaves the call, which has taken effect. Empty: none.
  void setInputSink(inputs::Sink sink);

  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

  /// lockstep only: the first difference found, or "".
  std::string firstDifference() const;

 private:
  friend class Worlds;
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Throws Error if parameters or the number of threads are invalid.
void validate(const WorldOptions& options);

/// Backends of this build that this machine can run.
std::vector<std::string> backends();

}  // namespace rubble

#pragma once
/// A running simulation.
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rubble/arrays.h>
#include <rubble/error.h>
#include <rubble/events.h>
#include <rubble/ids.h>
#include <rubble/params.h>
#include <rubble/query.h>
#include <rubble/report.h>
#include <rubble/scene.h>

namespace rubble {

struct BodyState {
  Vec3 position;         ///< of the shape's frame, world [m]
  Quat orientation;      ///< body -> world
  Vec3 velocity;         ///< of the centre of mass [m/s]
  Vec3 angularVelocity;  ///< world axes [rad/s]
};

/// What all contacts of the last step do to a body.
struct ContactLoad {
  Vec3 force;           ///< [N]
  Vec3 torque;          ///< about its centre [N m]
  double residual = 0;  ///< deepest penetration that is left [m]
  int points = 0;
};

/// An axis of a joint, in the order of JointDef::axes. Forces act along it on A, so that they raise
/// `position` where they are positive.
struct JointAxisState {
  double position = 0;    ///< [m], [rad], counted over whole turns
  double speed = 0;       ///< [m/s], [rad/s]
  double limitForce = 0;  ///< [N], [N m]
  double driveForce = 0;
  double frictionForce = 0;
};

/// A joint after the last step.
struct JointState {
  double gap = 0;    ///< error of what is held or limited in metres: distance of the anchors, excess of a
                     ///< length [m]
  double angle = 0;  ///< error of what is held or limited in angles [rad]
  Vec3 force;        ///< on body B, at its anchor [N]
  Vec3 torque;       ///< on body B, about its anchor [N m]
  std::vector<JointAxisState> axes;  ///< those that the type has
  bool broken = false;
};

/// A contact of a vertex in the last step: with a body, or with a vertex of a deformable object.
struct VertexContact {
  SoftId object;
  int vertex;
  BodyId body;         ///< BodyId{}: none
  SoftId otherObject;  ///< SoftId{}: none
  int otherVertex;
  Vec3 normal;   ///< unit, from the body to the vertex, or from the vertex to the other one
  double depth;  ///< > 0: penetration [m]
  Vec3 force;    ///< on the vertex, or on the other vertex [N]
};

struct WorldOptions {
  std::string
      backend = "cpu";  ///< "cpu", "reference" (double precision), "lockstep", or one named by backends()
  int threads = 0;      ///< 0: one a core
  Params params;
  bool timings = true;  ///< measure stages
  bool events = false;  ///< collect the events of each step; on a device this fetches its contacts after each
                        ///< step
};

/// The whole state of a world, to go on from bit for bit, in that world or in another one of the same
/// backend. On a GPU it stays on the device. It does not change when the world goes on, and copies share it.
class Snapshot {
 public:
  struct Data;
  std::shared_ptr<const Data> data;
};

class World {
 public:
  /// Throws Error if the scene, the options or the parameters are not valid.
  explicit World(const Scene& scene, const WorldOptions& options = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// One step of params().dt. Events of the scene are not run here: see rubble::scenes::Runner. Throws Error
  /// where there is no memory for the tables that it needs; the world is then as before but for its contacts,
  /// which the next step finds anew.
  StepReport step();

  const Params& params() const;
  void setParams(const Params& params);
  Vec3 gravity() const;
  void setGravity(const Vec3& gravity);
  std::int64_t stepCount() const;
  double time() const;  ///< [s]

  // Bodies. Every call with an id that is not alive throws Error.
  BodyId add(const BodyDef& body);
  void remove(BodyId id);  ///< with its joints
  /// Do the two collide with one another? (They do not if a joint between them says so.)
  void setCollide(BodyId a, BodyId b, bool collide);
  bool alive(BodyId id) const;
  std::vector<BodyId> bodies() const;          ///< alive ones, by index
  BodyId find(const std::string& name) const;  ///< throws Error if there is none
  BodyId bodyAt(int sceneIndex) const;         ///< body of Scene::bodies[sceneIndex]
  const BodyDef& definition(BodyId id) const;
  MassProperties massOf(BodyId id) const;
  BodyState state(BodyId id) const;
  void setState(BodyId id, const BodyState& state);
  /// Kinematic bodies: be at this pose after the next step.
  void setTarget(BodyId id, const Vec3& position, const Quat& orientation);
  void applyForce(BodyId id, const Vec3& force);  ///< at the centre, for the next step [N]
  void applyForceAt(BodyId id, const Vec3& force, const Vec3& point);  ///< [N], world point [m]
  void applyTorque(BodyId id, const Vec3& torque);                     ///< for the next step [N m]
  void applyImpulse(BodyId id, const Vec3& impulse);                   ///< at the centre, at once [N s]

  // Many bodies at once: what the calls above do, for element k of every list. The whole list is checked
  // first: an Error changes nothing. On a GPU all edits between two steps travel together, in one upload, and
  // nothing waits for the device.
  std::vector<BodyId> addBodies(std::span<const BodyDef> bodies);
  void removeBodies(std::span<const BodyId> ids);
  void setStates(std::span<const BodyId> ids, std::span<const BodyState> states);
  /// `torques` may be empty: none.
  void applyForces(std::span<const BodyId> ids, std::span<const Vec3> forces,
                   std::span<const Vec3> torques = {});
  void applyImpulses(std::span<const BodyId> ids, std::span<const Vec3> impulses);

  // State of all bodies as arrays. Row BodyId::index belongs to that body; rows of removed bodies hold what
  // was there last. Positions and orientations are those of the centre of mass and of the principal axes:
  // MassProperties says where these lie in the frame of the shape.
  /// The array as the engine keeps it, with all edits made so far. Read-only: scatter() writes. It stays
  /// where it is until the next edit that adds or removes bodies, restores a snapshot or sorts the bodies;
  /// steps and other edits change its content only, an edit by the next step at the latest.
  ArrayView array(StateArray which) const;
  /// Counts what ends the life of views.
  std::int64_t epoch() const;
  /// Puts the bodies in an order in memory with the next step: those that are near one another in space are
  /// so in memory then. Ids, states and contacts stay. It pays where many bodies were added in no order of
  /// space, or have mixed (Params::sortInterval does it again and again).
  void sortBodies();
  /// Row k of `values` becomes row rows[k] of an array; to Force and Torque it is added. `rows`: shape (n,
  /// 1), "<i4", each at most once; `values`: shape (n, 3 or 4), "<f4" or "<f8". Both lie on the host or, for
  /// backend "cuda", both on the device: then they are read in the order of values.stream, and work that is
  /// enqueued there later may overwrite them. Rows that are no body's are left out. Numbers on the device are
  /// not checked: a body that gets others than finite ones is quarantined by the step. Orientations are
  /// normalised.
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values);

  // Poses for a picture or a learner on the host while the world steps on.
  /// Begins to copy the present poses; returns at once, and the next steps do not wait. Two copies may be
  /// under way; a third throws Error.
  void beginPoses();
  /// Has the oldest copy under way ended? Never waits.
  bool posesReady() const;
  /// The oldest copy under way, waiting for its end. It stays valid until the second beginPoses() after the
  /// one that began it.
  PoseFrame takePoses();

  // Joints.
  /// bodyA and bodyB of the definition are ignored: the ids say which (BodyId{} is the world).
  /// Likewise of carriers, which gears and racks may have.
  JointId addJoint(const JointDef& joint, BodyId a, BodyId b, BodyId carrierA = {}, BodyId carrierB = {});
  void remove(JointId id);
  bool alive(JointId id) const;
  std::vector<JointId> joints() const;
  JointId findJoint(const std::string& name) const;
  const JointDef& definition(JointId id) const;
  std::array<BodyId, 2> bodiesOf(JointId id) const;    ///< A and B; BodyId{}: the world
  std::array<BodyId, 2> carriersOf(JointId id) const;  ///< of the axes of A and B; BodyId{}: the world
  JointState state(JointId id) const;
  /// Has another definition from the next step on: limits, drives, lengths, stiffnesses, frames. Its type
  /// must stay, and it keeps its bodies, its multipliers and whether it is broken. What is measured when a
  /// joint is made (a length below 0, axes of gears) stays as it was.
  void setDefinition(JointId id, const JointDef& joint);
  /// The drive of an axis. Throws Error for an axis that the joint does not have.
  void setTargetPosition(JointId id, int axis, double position);  ///< [m], [rad]
  void setTargetSpeed(JointId id, int axis, double speed);        ///< [m/s], [rad/s]
  void setLimits(JointId id, int axis, double min, double max);
  void setLength(JointId id, double length);                      ///< distance, rope, spring, pulley [m]
  void setDriveOrientation(JointId id, const Quat& orientation);  ///< swing-twist
  /// Draws a point of a body (world [m]) to where it is now, and from then on to where moveGrab says, with a
  /// stiffness that swings the body's mass at `frequency` [1/s] without overshoot, and `maxForce` [N] at
  /// most. Ends with remove().
  JointId grab(BodyId id, const Vec3& point, double maxForce, double frequency = 5);
  void moveGrab(JointId id, const Vec3& target);  ///< world [m]

  // Deformable objects. Every call with an id that is not alive throws Error.
  SoftId add(const Deformable& deformable);
  void remove(SoftId id);  ///< with its attachments
  bool alive(SoftId id) const;
  std::vector<SoftId> deformables() const;  ///< alive ones, by index
  SoftId findDeformable(const std::string& name) const;
  SoftId deformableAt(int sceneIndex) const;  ///< object of Scene::deformables[sceneIndex]
  const Deformable& definition(SoftId id) const;
  int vertexCount(SoftId id) const;
  std::vector<Vec3> positions(SoftId id) const;   ///< of its vertices [m]
  std::vector<Vec3> velocities(SoftId id) const;  ///< [m/s]
  std::vector<double> masses(SoftId id) const;    ///< of its vertices, 0: fixed [kg]
  /// As many as it has vertices. Contacts and multipliers are kept.
  void setVertices(SoftId id, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  void applyVertexForce(SoftId id, int vertex, const Vec3& force);  ///< for the next step [N]
  /// What is drawn of it: triangles (outward where it is closed; torn ones left out) or, without any, spheres
  /// or a line.
  struct Surface {
    SoftId id;
    std::vector<Vec3> vertices;  ///< [m]
    std::vector<std::array<int, 3>> triangles;
    std::vector<std::array<int, 2>> segments;  ///< of rods and nets; broken ones left out
    double radius = 0;                         ///< of the spheres or of the line [m]
    bool spheres = false;                      ///< every vertex is a sphere
  };
  Surface surface(SoftId id) const;

  /// Attachments; object and body indices of the definition are ignored: the ids say which (BodyId{}: the
  /// world; SoftId{}: no seam).
  AttachmentId addAttachment(const AttachmentDef& attachment, SoftId object, BodyId body,
                             SoftId otherObject = {});
  void remove(AttachmentId id);
  bool alive(AttachmentId id) const;
  std::vector<AttachmentId> attachments() const;
  JointState state(AttachmentId id) const;  ///< gap, force on the vertices, broken
  /// What an attachment holds together.
  struct AttachmentEnds {
    SoftId object;
    SoftId otherObject;  ///< SoftId{}: no seam
    BodyId body;         ///< BodyId{}: the world, or a seam
    Vec3 anchor;         ///< in the frame of the body, or in the world [m]
  };
  AttachmentEnds endsOf(AttachmentId id) const;
  std::vector<VertexContact> vertexContacts() const;

  // Measures.
  Quality quality() const;
  std::vector<ContactPoint> contacts() const;
  ContactLoad contactLoad(BodyId id) const;
  /// Of all bodies, in the order of bodies(); of the vertices of a deformable object.
  std::vector<SolverState> solverStates() const;
  std::vector<SolverState> solverStates(SoftId id) const;
  /// Of the last step, if WorldOptions::events is set.
  const Events& events() const;
  /// Sleeping (Params::sleeping). An edit or a push wakes a body with its island by itself.
  bool asleep(BodyId id) const;
  void wake(BodyId id);
  // Queries, a batch at a time (query.h).
  std::vector<RayHit> castRays(std::span<const RayQuery> rays);
  std::vector<CastHit> castShapes(std::span<const CastQuery> casts);
  std::vector<std::vector<BodyId>> overlaps(std::span<const OverlapQuery> shapes);  ///< of each by slot
  std::vector<ClosestHit> closestPoints(std::span<const ClosestQuery> points);

  /// Bytes of the engine's tables on the device or host.
  std::size_t memoryBytes() const;
  /// Makes room in the engine's tables for `count` elements of a kind that only steps count, so that they
  /// need not grow: "pairs", "activePairs", "manifolds", "rollers", "incidences", "colors", "aggregates",
  /// "slices", "boundary", "pointPairs", "pointIncidences", "nearFeatures" and others that
  /// StepReport::grown names. It never changes a result.
  void reserve(const std::string& kind, int count);
  /// A hash of the persistent state; equal states have equal hashes.
  std::uint64_t hash() const;

  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

  /// lockstep only: the first difference found ("" if none).
  std::string firstDifference() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Backends of this build that can run on this machine.
std::vector<std::string> backends();

}  // namespace rubble

#pragma once
/// What a World asks of a backend, free of the precision that the backend works in.
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rubble/world.h>

#include "collision/cooked_shape.h"
#include "forces/soft_model.h"

namespace rubble {

/// A body with its state, in the frame of the engine: about the centre of mass, along the principal axes. `kind`: 0 removed, 1 static, 2 kinematic, 3 dynamic.
struct EngineBody {
  int kind = 0;
  CookedData shape;      ///< `data` counts from the beginning of the engine's tables
  double radius = 0;     ///< of the sphere about the origin that holds it [m]
  Material material;
  int surface = -1;      ///< place among the materials of setSurfaces, -1: one of two frictions and a restitution with the usual rules
  MassProperties mass;
  double gravityScale = 1;
  double linearDamping = 0, angularDamping = 0;
  int locks = 0;  ///< bits 0-2: translation along x, y, z; bits 3-5: rotation about them
  CollisionFilter filter;
  bool sensor = false;
  BodyState state;
};

/// Joint types of the engine, in the order of JointTypes. Several types of an author may be one of them.
enum class EngineJointType { Ball, Fixed, Hinge, Slider, Distance, Universal, SwingTwist, SixDof, Gear, Rack, Pulley };
inline constexpr int kEngineJointTypes = 11;

/// Rows that are held together: off, held, friction towards the start of the step, or held where a length has no direction (forces/distance.h).
struct EngineGroup {
  enum class Mode { Off, Hold, Friction, Point };
  Mode mode = Mode::Hold;
  double stiffness = kHard, damping = 0, bound = kHard;
};

/// A joint between body slots (kWorld: none). Groups and axes are those of its parts, in their order.
struct EngineJoint {
  EngineJointType type = EngineJointType::Ball;
  int a = kWorld, b = kWorld;
  int carrierA = kWorld, carrierB = kWorld;  ///< gears, racks: bodies in which the axes lie
  bool alive = false;
  bool holds = true;                 ///< the bodies hang together
  Vec3 anchorA, anchorB;
  Quat frameA, frameB, aToB;
  Quat baseA, baseB;                 ///< gears, racks: the axes in their carriers
  Vec3 pointA, pointB, direction;    ///< pulleys: in the world; racks: in the carrier
  double ratio = 1;
  Quat driveTarget;
  double coneY = 1, coneZ = 1;
  std::vector<EngineGroup> groups;
  std::vector<JointAxis> axes;
  double breakForce = kUnbreakable, breakTorque = kUnbreakable;
  int turned = 0;                    ///< six-dof: the author's axis i + turned (modulo 3) is axis i here
};

struct EngineContact {
  int a, b;
  Vec3 position, normal, force;
  double depth;
};

/// Contact of a vertex with a body, or with another vertex (body -1).
struct EngineVertexContact {
  int vertex, body, otherVertex;
  Vec3 normal;  ///< towards the vertex, or to the other one
  Vec3 force;   ///< on the vertex, or on the other one [N]
  double depth;
};

/// Two bodies that touch, a < b.
struct EngineTouch {
  int a, b;
  bool sensor;
};

/// A query (rubble/query.h); body slots.
struct EngineQuery {
  enum Kind { Ray, Cast, Overlap, Closest };
  Kind kind = Ray;
  std::shared_ptr<const CookedShape> shape;  ///< of a cast and an overlap
  Vec3 position;         ///< of its frame in the engine
  Quat orientation;
  Vec3 move;
  double reach = 0;
  std::uint32_t layers = 0, mask = 0;
  bool sensors = false;
  int ignore = -1;
};
struct EngineHit {
  int body;          ///< -1: none
  double fraction;   ///< of the move; closest point: distance [m]
  Vec3 position, normal;
};

struct EngineSettings {
  Params params;
  Vec3 gravity;
  bool wakeAll = false;  ///< for the next step: nothing sleeps on
};

/// What an engine keeps of its state. Another engine takes it by its bytes.
class EngineSnapshot {
 public:
  virtual ~EngineSnapshot() = default;
  virtual std::vector<std::byte> bytes() const = 0;
};

/// Copies of poses from a device to the host beside the steps; see World::beginPoses.
class PoseCopies {
 public:
  virtual ~PoseCopies() = default;
  /// Into buffer 0 or 1, which nobody waits for.
  virtual void begin(int buffer) = 0;
  virtual bool ready(int buffer) const = 0;
  virtual void wait(int buffer) = 0;
  virtual ArrayView position(int buffer) const = 0;
  virtual ArrayView orientation(int buffer) const = 0;
};

/// Slots of ids (BodyId::index), and ids of slots.
struct BodyOrder {
  std::span<const int> slotOf, idOf;
};

/// All that it is told and tells of bodies is by slot; arrays of state, what is scattered into them, copies of poses and exclusions are by id. Who
/// knows bodies by their ids asks an OrderedEngine.
class Engine {
 public:
  virtual ~Engine() = default;

  virtual void configure(const EngineSettings& settings) = 0;
  /// At least so many slots; new ones are removed bodies.
  virtual void setBodyCount(int slots) = 0;
  virtual void setBody(int slot, const EngineBody& body) = 0;
  /// Contacts of a slot are forgotten: it is another body from now on, or none.
  virtual void forgetContacts(int slot) = 0;
  /// Appends the tables of a shape, with the materials of its parts (places among those of setSurfaces, -1: that of the body).
  virtual void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) = 0;
  virtual void setSurfaces(const std::vector<Material>& surfaces) = 0;
  virtual void setPlanes(const std::vector<int>& slots) = 0;
  virtual void setJointCount(int type, int slots) = 0;
  virtual void setJoint(int slot, const EngineJoint& joint) = 0;
  /// Only what is authored changes: the joint keeps its multipliers.
  virtual void editJoint(int slot, const EngineJoint& joint) = 0;
  /// Pairs (low, high) of ids that do not collide, sorted.
  virtual void setExclusions(const std::vector<std::pair<int, int>>& pairs) = 0;

  /// All deformable objects and attachments, in an order that leaves those that were there in theirs. Their state is kept.
  virtual void setSoft(const std::vector<EngineSoftObject>& objects, const std::vector<EngineAttachment>& attachments) = 0;
  virtual void vertexStates(int first, std::span<Vec3> positions, std::span<Vec3> velocities) const = 0;
  virtual void setVertexStates(int first, std::span<const Vec3> positions, std::span<const Vec3> velocities) = 0;
  virtual void addVertexForce(int vertex, const Vec3& force) = 0;
  /// Of `count` elements of a type from `first` on: 1 those that have not broken.
  virtual void elementsAlive(int type, int first, std::span<char> alive) const = 0;
  virtual JointState attachmentState(int index) const = 0;
  virtual std::vector<EngineVertexContact> vertexContacts() const = 0;

  virtual BodyState state(int slot) const = 0;
  virtual void setState(int slot, const BodyState& state) = 0;
  virtual void addForce(int slot, const Vec3& force, const Vec3& torque) = 0;
  /// Slots differ from one another.
  virtual void addVelocities(std::span<const int> slots, std::span<const Vec3> changes) = 0;
  virtual void forgetContactsOf(std::span<const int> slots) {
    for (const int slot : slots) forgetContacts(slot);
  }

  /// With all edits in it.
  virtual ArrayView array(StateArray which) = 0;
  /// As World::scatter; shapes and types are checked, and that memory is where this engine can read it.
  virtual void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) = 0;
  /// Null: array() is host memory.
  virtual PoseCopies* poseCopies() { return nullptr; }
  /// Room for what steps count; false if there is no such kind.
  virtual bool reserve(const std::string& kind, int count) = 0;

  virtual void step(StepReport& report) = 0;

  /// Which body is where. A body has the slot of its id until sortBodies().
  virtual BodyOrder order() const = 0;
  /// Slots along a curve through space (stages/order.h).
  virtual void sortBodies() = 0;

  virtual Quality quality() const = 0;
  /// By slot.
  virtual void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const = 0;
  virtual std::vector<EngineContact> contacts() const = 0;
  virtual std::vector<EngineTouch> touches() const = 0;
  /// Slots of bodies that sleep, rising.
  virtual std::vector<int> sleepers() const = 0;
  virtual bool isAsleep(int slot) const = 0;
  virtual std::vector<EngineHit> query(std::span<const EngineQuery> queries) = 0;
  virtual std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) = 0;
  virtual JointState jointState(int type, int slot) const = 0;
  /// (type, slot) of all joints that are broken.
  virtual std::vector<std::pair<int, int>> brokenJoints() const = 0;
  virtual std::size_t memoryBytes() const = 0;
  virtual std::uint64_t hash() const = 0;
  virtual std::vector<std::byte> save() const = 0;
  virtual void load(std::span<const std::byte> data) = 0;
  virtual std::shared_ptr<const EngineSnapshot> snapshot() const;
  virtual void restore(const EngineSnapshot& snapshot) { load(snapshot.bytes()); }
  virtual std::string firstDifference() const { return {}; }
};

/// Is the CUDA backend built, and is there a device that it can use?
bool cudaReady();
/// Null unless cudaReady(). `timings`: measure stages.
std::unique_ptr<Engine> makeCudaEngine(bool timings);

namespace f32 {
std::unique_ptr<Engine> makeCpuEngine(int threads, bool timings);
std::unique_ptr<Engine> makeLockstepEngine(int threads);
}  // namespace f32
namespace f64 {
std::unique_ptr<Engine> makeCpuEngine(int threads, bool timings);
}

}  // namespace rubble

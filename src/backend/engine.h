#pragma once
/// Interface between a World and a backend, independent of the solver precision.
#include <string>

#include "tables/records.h"

namespace rubble {

/// State of an engine. Engines of other types accept it as bytes.
class EngineSnapshot {
 public:
  virtual ~EngineSnapshot() = default;
  virtual std::vector<std::byte> bytes() const = 0;
};

/// Asynchronous copies of poses from a device to the host; see World::beginPoses.
class PoseCopies {
 public:
  virtual ~PoseCopies() = default;
  /// Copies into buffer 0 or 1, which no reader uses.
  virtual void begin(int buffer) = 0;
  virtual bool ready(int buffer) const = 0;
  virtual void wait(int buffer) = 0;
  virtual ArrayView position(int buffer) const = 0;
  virtual ArrayView orientation(int buffer) const = 0;
};

/// A backend. Bodies are addressed by slot. State arrays, scatter(), pose copies and exclusions are addressed
/// by id. OrderedEngine addresses everything by id.
class Engine {
 public:
  virtual ~Engine() = default;

  virtual void configure(const EngineSettings& settings) = 0;
  /// Makes at least that many slots. New slots are removed bodies.
  virtual void setBodyCount(int slots) = 0;
  virtual void setBody(int slot, const EngineBody& body) = 0;
  /// Clears the contacts of a slot, which is reused or freed.
  virtual void forgetContacts(int slot) = 0;
  /// Appends the tables of a shape. `partSurfaces`: materials of its parts as indices into those of
  /// setSurfaces, -1: that of the body.
  virtual void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) = 0;
  virtual void setSurfaces(const std::vector<Material>& surfaces) = 0;
  virtual void setPlanes(const std::vector<int>& slots) = 0;
  virtual void setJointCount(int type, int slots) = 0;
  virtual void setJoint(int slot, const EngineJoint& joint) = 0;
  /// Changes authored data only: the joint keeps its multipliers.
  virtual void editJoint(int slot, const EngineJoint& joint) = 0;
  /// Pairs (low, high) of ids that do not collide, sorted.
  virtual void setExclusions(const std::vector<std::pair<int, int>>& pairs) = 0;

  /// Sets all deformable objects and attachments. Existing ones keep their relative order and their state.
  virtual void setSoft(const std::vector<EngineSoftObject>& objects,
                       const std::vector<EngineAttachment>& attachments) = 0;
  virtual void vertexStates(int first, std::span<Vec3> positions, std::span<Vec3> velocities) const = 0;
  virtual void setVertexStates(int first, std::span<const Vec3> positions,
                               std::span<const Vec3> velocities) = 0;
  virtual void addVertexForce(int vertex, const Vec3& force) = 0;
  /// For `count` elements of a type from `first` on: 1 if not broken.
  virtual void elementsAlive(int type, int first, std::span<char> alive) const = 0;
  virtual JointState attachmentState(int index) const = 0;
  virtual std::vector<EngineVertexContact> vertexContacts() const = 0;

  virtual BodyState state(int slot) const = 0;
  virtual void setState(int slot, const BodyState& state) = 0;
  virtual void addForce(int slot, const Vec3& force, const Vec3& torque) = 0;
  /// Slots are distinct.
  virtual void addVelocities(std::span<const int> slots, std::span<const Vec3> changes) = 0;
  virtual void forgetContactsOf(std::span<const int> slots) {
    for (const int slot : slots) forgetContacts(slot);
  }

  /// Includes all edits.
  virtual ArrayView array(StateArray which) = 0;
  /// As World::scatter. Shapes and types are checked already, and the memory is accessible to this engine.
  virtual void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) = 0;
  /// Null: array() is host memory.
  virtual PoseCopies* poseCopies() { return nullptr; }
  /// Reserves table memory for a counted kind. Returns false if the kind does not exist.
  virtual bool reserve(const std::string& kind, int count) = 0;

  virtual void step(StepReport& report) = 0;

  /// The order of the bodies. A body has the slot of its id until sortBodies().
  virtual BodyOrder order() const = 0;
  /// Sorts the slots along a space-filling curve (stages/pairs/order.h).
  virtual void sortBodies() = 0;

  virtual Quality quality() const = 0;
  /// By slot.
  virtual void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const = 0;
  virtual std::vector<EngineContact> contacts() const = 0;
  virtual std::vector<EngineTouch> touches() const = 0;
  /// Slots of sleeping bodies, ascending.
  virtual std::vector<int> sleepers() const = 0;
  virtual bool isAsleep(int slot) const = 0;
  virtual std::vector<EngineHit> query(std::span<const EngineQuery> queries) = 0;
  virtual std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) = 0;
  virtual JointState jointState(int type, int slot) const = 0;
  /// (type, slot) of all broken joints.
  virtual std::vector<std::pair<int, int>> brokenJoints() const = 0;
  virtual std::size_t memoryBytes() const = 0;
  virtual std::uint64_t hash() const = 0;
  virtual std::vector<std::byte> save() const = 0;
  virtual void load(std::span<const std::byte> data) = 0;
  virtual std::shared_ptr<const EngineSnapshot> snapshot() const;
  virtual void restore(const EngineSnapshot& snapshot) { load(snapshot.bytes()); }
  virtual std::string firstDifference() const { return {}; }
};

/// Returns whether the CUDA backend is built and has a usable device.
bool cudaReady();
/// Null unless cudaReady(). `timings`: measure stage times.
std::unique_ptr<Engine> makeCudaEngine(bool timings);

namespace f32 {
std::unique_ptr<Engine> makeCpuEngine(int threads, bool timings);
std::unique_ptr<Engine> makeLockstepEngine(int threads);
}  // namespace f32
namespace f64 {
std::unique_ptr<Engine> makeCpuEngine(int threads, bool timings);
}

}  // namespace rubble

#pragma once
/// What a World asks of a backend, free of the precision that the backend works in.
#include <string>

#include "tables/records.h"

namespace rubble {

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

/// All that it is told and tells of bodies is by slot; arrays of state, what is scattered into them, copies
/// of poses and exclusions are by id. Who knows bodies by their ids asks an OrderedEngine.
class Engine {
 public:
  virtual ~Engine() = default;

  virtual void configure(const EngineSettings& settings) = 0;
  /// At least so many slots; new ones are removed bodies.
  virtual void setBodyCount(int slots) = 0;
  virtual void setBody(int slot, const EngineBody& body) = 0;
  /// Contacts of a slot are forgotten: it is another body from now on, or none.
  virtual void forgetContacts(int slot) = 0;
  /// Appends the tables of a shape, with the materials of its parts (places among those of setSurfaces, -1:
  /// that of the body).
  virtual void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) = 0;
  virtual void setSurfaces(const std::vector<Material>& surfaces) = 0;
  virtual void setPlanes(const std::vector<int>& slots) = 0;
  virtual void setJointCount(int type, int slots) = 0;
  virtual void setJoint(int slot, const EngineJoint& joint) = 0;
  /// Only what is authored changes: the joint keeps its multipliers.
  virtual void editJoint(int slot, const EngineJoint& joint) = 0;
  /// Pairs (low, high) of ids that do not collide, sorted.
  virtual void setExclusions(const std::vector<std::pair<int, int>>& pairs) = 0;

  /// All deformable objects and attachments, in an order that leaves those that were there in theirs. Their
  /// state is kept.
  virtual void setSoft(const std::vector<EngineSoftObject>& objects,
                       const std::vector<EngineAttachment>& attachments) = 0;
  virtual void vertexStates(int first, std::span<Vec3> positions, std::span<Vec3> velocities) const = 0;
  virtual void setVertexStates(int first, std::span<const Vec3> positions,
                               std::span<const Vec3> velocities) = 0;
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
  /// Slots along a curve through space (stages/pairs/order.h).
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

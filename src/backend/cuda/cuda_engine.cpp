#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <utility>

#include "backend/cpu/cpu_engine.h"
#include "backend/cuda/device_poses.h"
#include "backend/cuda/mirror.h"
#include "stages/pairs/order.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// An engine whose tables are on the device. Its host tables are synchronized on demand.
class CudaEngine final : public Engine, private PoseCopies {
 public:
  explicit CudaEngine(bool timings) : stepper_(timings) {}

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    settingsChanged_ = true;
    host().view().step->gravity = Vec3(settings.gravity);
  }
  void setBodyCount(int slots) override {
    const int before = host().view().bodies;
    RUBBLE_CORE::setBodyCount(host(), slots);
    mirror_.bodiesAdded(before);
  }
  void setBody(int slot, const EngineBody& body) override {
    count(slot, -1);
    RUBBLE_CORE::setBody(host(), slot, body);
    count(slot, 1);
    mirror_.bodyWritten(slot);
  }
  void forgetContacts(int slot) override { mirror_.forgetContacts(slot); }
  void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) override {
    RUBBLE_CORE::addShape(host(), shape, partSurfaces);
    mirror_.listsWritten();
  }
  void setSurfaces(const std::vector<Material>& surfaces) override {
    RUBBLE_CORE::setSurfaces(host(), surfaces);
    mirror_.listsWritten();
  }
  void setPlanes(const std::vector<int>& slots) override {
    RUBBLE_CORE::setPlanes(host(), slots);
    mirror_.listsWritten();
  }
  void setJointCount(int type, int slots) override { RUBBLE_CORE::setJointCount(host(), type, slots); }
  void setJoint(int slot, const EngineJoint& joint) override {
    RUBBLE_CORE::setJoint(host(), slot, joint);
    mirror_.jointWritten(static_cast<int>(joint.type), slot);
  }
  void editJoint(int slot, const EngineJoint& joint) override {
    RUBBLE_CORE::editJoint(host(), slot, joint);
    mirror_.specWritten(static_cast<int>(joint.type), slot);
  }
  void setExclusions(const std::vector<std::pair<int, int>>& pairs) override {
    RUBBLE_CORE::setExclusions(host(), pairs);
    mirror_.listsWritten();
  }
  // edits of deformable objects are rare and rewrite lists of all objects: fetch everything, edit, upload
  // everything
  void setSoft(const std::vector<EngineSoftObject>& objects,
               const std::vector<EngineAttachment>& attachments) override {
    mirror_.fetchAll();
    RUBBLE_CORE::setSoft(host(), objects, attachments);
    mirror_.allWritten();
  }
  void vertexStates(int first, std::span<rubble::Vec3> positions,
                    std::span<rubble::Vec3> velocities) const override {
    vertexStatesOf(fetched(), first, positions, velocities);
  }
  void setVertexStates(int first, std::span<const rubble::Vec3> positions,
                       std::span<const rubble::Vec3> velocities) override {
    mirror_.fetchAll();
    RUBBLE_CORE::setVertexStates(host(), first, positions, velocities);
    mirror_.allWritten();
  }
  void addVertexForce(int vertex, const rubble::Vec3& force) override {
    mirror_.fetchAll();
    host().view().vertexForce[vertex] += Vec3(force);
    mirror_.allWritten();
  }
  void elementsAlive(int type, int first, std::span<char> alive) const override {
    elementsAliveOf(fetched(), type, first, alive);
  }
  JointState attachmentState(int index) const override { return attachmentStateOf(fetched(), index); }
  std::vector<EngineVertexContact> vertexContacts() const override { return vertexContactsOf(fetched()); }
  BodyState state(int slot) const override {
    mirror_.fetchState(slot);
    return bodyState(host(), slot);
  }
  void setState(int slot, const BodyState& state) override {
    setBodyState(host(), slot, state);
    mirror_.stateWritten(slot);
  }
  void addVelocities(std::span<const int> slots, std::span<const rubble::Vec3> changes) override {
    for (std::size_t k = 0; k < slots.size(); ++k) mirror_.addVelocity(slots[k], changes[k]);
  }
  void addForce(int slot, const rubble::Vec3& force, const rubble::Vec3& torque) override {
    mirror_.beforeForce();
    host().view().force[slot] += Vec3(force);
    host().view().torque[slot] += Vec3(torque);
    mirror_.forceWritten(slot);
  }

  ArrayView array(StateArray which) override { return mirror_.array(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    mirror_.scatter(which, rows, values);
  }
  bool reserve(const std::string& kind, int count) override {
    return reserveKind(stepper_.tables(), kind, count);
  }

  PoseCopies* poseCopies() override { return this; }
  void begin(int buffer) override {
    mirror_.flush();
    // the sizes in the device's SolverData are those of the last step
    SolverData view = stepper_.tables().view();
    view.bodies = host().view().bodies, view.ordered = host().view().ordered;
    poses_.begin(buffer, view, host().bodyIds, stepper_.stream());
  }
  bool ready(int buffer) const override { return poses_.ready(buffer); }
  void wait(int buffer) override { poses_.wait(buffer); }
  ArrayView position(int buffer) const override { return poses_.position(buffer); }
  ArrayView orientation(int buffer) const override { return poses_.orientation(buffer); }

  void step(StepReport& report) override;

  BodyOrder order() const override { return orderOf(host()); }
  void sortBodies() override;

  Quality quality() const override { return qualityOf(fetched()); }
  void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const override {
    solverStatesOf(fetched(), bodies, vertices);
  }
  std::vector<EngineContact> contacts() const override { return contactsOf(fetched()); }
  std::vector<EngineTouch> touches() const override { return touchesOf(fetched()); }
  std::vector<int> sleepers() const override { return sleepersOf(fetched()); }
  bool isAsleep(int slot) const override {
    mirror_.fetchState(slot);
    return host().view().asleep[slot] != 0;
  }
  /// Runs on the host with the same functors, over fetched states. A batch costs a copy and no launch.
  std::vector<EngineHit> query(std::span<const EngineQuery> queries) override {
    mirror_.fetchAll();
    return runQueries(host(), queries);
  }
  std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) override {
    mirror_.fetchAll();
    return runOverlaps(host(), queries);
  }
  JointState jointState(int type, int slot) const override { return jointStateOf(fetched(), type, slot); }
  std::vector<std::pair<int, int>> brokenJoints() const override { return brokenJointsOf(fetched()); }
  /// Device memory.
  std::size_t memoryBytes() const override { return stepper_.bytes(); }
  std::uint64_t hash() const override { return hashBytes(save()); }
  std::vector<std::byte> save() const override { return saveState(fetched(), previousDt_); }
  void load(std::span<const std::byte> data) override;
  /// With vertices through the host: device snapshots contain only bodies and joints.
  std::shared_ptr<const EngineSnapshot> snapshot() const override {
    return host().view().vertices > 0 ? Engine::snapshot() : mirror_.snapshot(previousDt_);
  }
  void restore(const EngineSnapshot& snapshot) override;

 private:
  HostTables& host() const { return mirror_.host(); }
  const HostTables& fetched() const {
    mirror_.fetchAll();
    return mirror_.host();
  }
  void prepareConstants();
  /// Updates the body counts when a body is added or removed.
  void count(int slot, int change) {
    const BodyKind kind = host().view().params[slot].kind;
    if (kind != BodyKind::Removed) bodyCount_ += change;
    if (kind == BodyKind::Dynamic) dynamicCount_ += change;
  }
  void countBodies() {
    bodyCount_ = dynamicCount_ = 0;
    for (int slot = 0; slot < host().view().bodies; ++slot) count(slot, 1);
  }

  CudaStepper stepper_;
  mutable Mirror mirror_{stepper_};  ///< mutable: reads fetch from the device
  DevicePoses poses_;
  EngineSettings settings_;
  bool settingsChanged_ = true;
  int bodyCount_ = 0, dynamicCount_ = 0;
  double previousDt_ = 0;
  double preparedFor_ = -1;  ///< previousDt_ of the prepared constants
};

/// Recomputes the constants of the step only if they may differ. A CUDA graph is reused while they are
/// bitwise equal.
void CudaEngine::prepareConstants() {
  if (!settingsChanged_ && preparedFor_ == previousDt_) return;
  const Counters last = *host().view().counters;
  beginStep(host().view(), settings_, previousDt_);
  *host().view().counters = last;
  settingsChanged_ = false;
  preparedFor_ = previousDt_;
}

void CudaEngine::step(StepReport& report) {
  nvtxRangePushA("rubble step");
  if (planTrees(host())) mirror_.derivedWritten();
  host().view().bodiesMove = dynamicCount_ > 0;
  for (int k = 0; k < settings_.params.substeps; ++k) {
    mirror_.flush();
    prepareConstants();
    mirror_.stepped(stepper_.step(host().view(), report));
    host().view().rolledBefore = host().view().rolls;
    previousDt_ = settings_.params.dt / settings_.params.substeps;
  }
  mirror_.endForces();
  mirror_.followArrays();
  settingsChanged_ |= std::exchange(settings_.wakeAll, false);
  nvtxRangePop();

  SolverData counts = host().view();
  counts.bodies = 0;
  reportCounters(counts, report);
  report.bodies = bodyCount_;
}

void CudaEngine::sortBodies() {
  mirror_.flush();
  prepareConstants();
  stepper_.sortBodies(host().view(), mirror_.oldPairs());
  mirror_.bodiesSorted();
}

void CudaEngine::load(std::span<const std::byte> data) {
  loadState(host(), previousDt_, data);
  mirror_.allWritten();
  countBodies();
}

void CudaEngine::restore(const EngineSnapshot& snapshot) {
  const auto* const own = dynamic_cast<const DeviceSnapshot*>(&snapshot);
  if (!own) return load(snapshot.bytes());
  if (host().view().vertices > 0) setSoft({}, {});
  mirror_.restore(*own);
  previousDt_ = own->previousDt;
  countBodies();
}

}  // namespace

std::unique_ptr<Engine> makeCudaEngine(bool timings) { return std::make_unique<CudaEngine>(timings); }

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// An engine whose tables are on the device. Its host tables are synchronized on demand.
#include <memory>
#include <optional>
#include <utility>

#include "backend/cuda/device_poses.h"
#include "backend/cuda/device_queries.h"
#include "backend/cuda/mirror.h"
#include "backend/device_arrays.h"
#include "tables/exclusions.h"
#include "tables/host_queries.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {

class CudaEngine final : public ObservableEngine,
                         public BatchEngine,
                         private PoseCopies,
                         private DeviceArrays {
 public:
  explicit CudaEngine(const CudaOptions& options) : stepper_(options) {}

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    settingsChanged_ = true;
    host().view().step->gravity = Vec3(settings.gravity);
  }
  void apply(std::span<const Edit> edits) override {
    queries_.moved();
    for (const Edit& edit : edits) std::visit([this](const auto& e) { write(e); }, edit);
  }
  const TableReader& read(Fetch what, int id) override {
    switch (what) {
      case Fetch::Body:
        mirror_.fetchState(slotOf(host(), id));
        break;
      case Fetch::Vertices:
        mirror_.fetchVertices();
        break;
      case Fetch::All:
        mirror_.fetchAll();
    }
    return reader_;
  }

  ArrayView array(StateArray which) override { return mirror_.array(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    queries_.moved();
    mirror_.scatter(which, rows, values);
  }
  void setJointRows(const JointRows& rows) override { mirror_.setJointRows(rows); }
  ArrayView array(JointArray which) override { return mirror_.array(which); }
  ArrayView array(SensorArray which) override { return mirror_.array(which); }
  ArrayView array(VertexArray which) override { return mirror_.array(which); }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    return mirror_.contactForces(pairs);
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    mirror_.scatter(which, rows, values);
  }
  bool reserve(const std::string& kind, int count) override {
    return reserveKind(stepper_.tables(), kind, count);
  }

  DeviceArrays* deviceArrays() override { return this; }
  DeviceStream deviceStream() const override {
    return {mirror_.order().device(), reinterpret_cast<std::uintptr_t>(stepper_.stream())};
  }
  std::shared_ptr<void> addReader(std::uintptr_t stream) override {
    return mirror_.order().addReader(reinterpret_cast<cudaStream_t>(stream));
  }

  PoseCopies* poseCopies() override { return this; }
  void begin(int buffer) override { poses_.begin(buffer, present(), host().bodyIds, stepper_.stream()); }
  bool ready(int buffer) const override { return poses_.ready(buffer); }
  void wait(int buffer) override { poses_.wait(buffer); }
  ArrayView position(int buffer) const override { return poses_.position(buffer); }
  ArrayView orientation(int buffer) const override { return poses_.orientation(buffer); }

  void step(StepReport& report) override;

  void sortBodies() override;
  std::span<EngineQuery> queryRoom(std::size_t n) override { return queries_.room(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override {
    return queries_.hits(present(), host().view().step, asked, stepper_.stream());
  }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    return queries_.overlaps(present(), host().view().step, asked, stepper_.stream());
  }
  RayHitArrays castRays(const EngineRays& rays) override {
    return mirror_.castRays(rays, [&](const SolverData& device) {
      return queries_.hits(device, host().view().step, rays, stepper_.stream());
    });
  }
  EngineAllHits allHits(const EngineQueries& asked) override {
    mirror_.fetchAll();
    return hostQueries_.allHits(host(), asked);
  }
  void observe(KernelObserver observer) override { stepper_.observe(std::move(observer)); }
  const HostTables& tablesNow() override;
  /// Device memory.
  std::size_t memoryBytes() const override { return stepper_.bytes(); }
  std::vector<TableHash> tableHashes() override {
    mirror_.fetchAll();
    return hashTables(host(), hashOf);
  }
  /// With vertices through the host: device snapshots contain only bodies and joints. Also on several GPUs.
  std::shared_ptr<const EngineSnapshot> snapshot() override;
  void restore(const EngineSnapshot& snapshot) override;

  // One rank of a world on several GPUs. Sums have one order then, on any number of them.
  void divide(Transport& transport, const RankOptions& options) {
    stepper_.divide(transport, options);
    divided_ = true;
  }
  void gatherState() {
    mirror_.flush();
    if (stepper_.gatherState(host().view())) mirror_.gathered();
  }
  void settle() { mirror_.flush(); }
  void restart() { stepper_.restart(); }
  std::vector<RankReport> reports() const { return stepper_.reports(); }

  // Worlds of a batch (cuda_batch.cpp). With vertices their states go through the host.
  BatchEngine* batch() override { return this; }
  void setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) override;
  const WorldSettings& settingsOf(int world) const override {
    return worlds_[static_cast<std::size_t>(world)];
  }
  void setSettings(int world, const WorldSettings& settings) override;
  void stepWorlds(StepReport& report, std::span<const char> paused) override;
  const TableReader& readWorld(int world) override;
  std::vector<std::byte> takeWorld(int world) override;
  void putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) override;

 private:
  HostTables& host() { return mirror_.host(); }
  /// The tables of the device with all edits. The sizes in its own SolverData are those of the last step.
  SolverData present() {
    mirror_.flush();
    return onDevice(host().view(), stepper_.tables().view());
  }

  void write(const SetBody& e);
  void write(const AddBodies& e) {
    for (int k = 0; k < e.count; ++k) write(e.at(k));
  }
  void write(const SetBodyState& e) {
    const int slot = slotOf(host(), e.id);
    setBodyState(host(), slot, e.state);
    mirror_.stateWritten(slot);
  }
  void write(const AddForce& e) {
    mirror_.beforeForce();
    RUBBLE_CORE::apply(host(), e);
    mirror_.forceWritten(slotOf(host(), e.id));
  }
  void write(const AddVelocity& e) { mirror_.addVelocity(slotOf(host(), e.id), e.change); }
  void write(const ForgetContacts& e) { mirror_.forgetContacts(e.ids); }
  void write(const AddShape& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.shapeWritten(e.place);
  }
  void write(const DropShape&) {}
  void write(const SetSurfaces& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.listWritten(Per::Surface), mirror_.listWritten(Per::MaterialRule);
  }
  void write(const SetPlanes& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.listWritten(Per::Plane);
    if (!e.firstOfWorld.empty()) mirror_.listWritten(Per::World);
  }
  void write(const SetJoint& e) {
    RUBBLE_CORE::apply(host(), e);
    const int type = static_cast<int>(e.joint.type);
    e.keepsState ? mirror_.specWritten(type, e.slot) : mirror_.jointWritten(type, e.slot);
  }
  void write(const SetExcluded& e) {
    setExcluded(host(), e.a, e.b, e.excluded, &mirror_.exclusionsWritten(), e.world);
  }
  /// Rewrites the lists of all objects: everything is fetched, edited and uploaded.
  void write(const SetDeformables& e) {
    mirror_.fetchAll();
    RUBBLE_CORE::apply(host(), e);
    mirror_.allWritten();
  }
  void write(const SetVertices& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.verticesWritten(e.first, static_cast<int>(e.positions.size()));
  }
  void write(const AddVertexForce& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.vertexForceWritten(e.vertex);
  }

  void prepareConstants();
  void stepOthers(StepReport& report);
  /// Notes in the settings of the worlds that they have taken a step.
  void endStepOfWorlds();
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
  Mirror mirror_{stepper_};
  HostReader reader_{mirror_.host()};
  DevicePoses poses_;
  DeviceQueries queries_;
  HostQueries hostQueries_;
  std::unique_ptr<HostTables> seen_;  ///< of tablesNow()
  std::vector<ContactRows> seenRows_;
  MostWritten seenMost_;
  EngineSettings settings_;
  bool settingsChanged_ = true;
  int bodyCount_ = 0, dynamicCount_ = 0;
  double previousDt_ = 0;
  double preparedFor_ = -1;  ///< previousDt_ of the prepared constants

  std::vector<WorldSettings> worlds_;  ///< of a batch
  std::vector<WorldPart> parts_;
  std::vector<int> changedWorlds_;  ///< worlds whose settings have changed
  std::optional<HostReader> worldReader_;
  bool divided_ = false;    ///< this is one of several ranks
  bool hasPaused_ = false;  ///< some step has left out worlds; from then on all steps have this ability
};

}  // namespace rubble::RUBBLE_CORE

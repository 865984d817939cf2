#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <utility>

#include "backend/cpu/cpu_engine.h"
#include "backend/cuda/device_poses.h"
#include "backend/cuda/device_queries.h"
#include "backend/cuda/mirror.h"
#include "tables/exclusions.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// An engine whose tables are on the device. Its host tables are synchronized on demand.
class CudaEngine final : public ObservableEngine, private PoseCopies {
 public:
  explicit CudaEngine(bool timings) : stepper_(timings) {}

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
  bool reserve(const std::string& kind, int count) override {
    return reserveKind(stepper_.tables(), kind, count);
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
    return queries_.hits(present(), *host().view().step, asked, stepper_.stream());
  }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    return queries_.overlaps(present(), *host().view().step, asked, stepper_.stream());
  }
  void observe(KernelObserver observer) override { stepper_.observe(std::move(observer)); }
  const HostTables& tablesNow() override;
  /// Device memory.
  std::size_t memoryBytes() const override { return stepper_.bytes(); }
  std::vector<TableHash> tableHashes() override {
    mirror_.fetchAll();
    return hashTables(host(), hashOf);
  }
  /// With vertices through the host: device snapshots contain only bodies and joints.
  std::shared_ptr<const EngineSnapshot> snapshot() override;
  void restore(const EngineSnapshot& snapshot) override;

 private:
  HostTables& host() { return mirror_.host(); }
  /// The tables of the device with all edits. The sizes in its own SolverData are those of the last step.
  SolverData present() {
    mirror_.flush();
    return onDevice(host().view(), stepper_.tables().view());
  }

  void write(const SetBody& e);
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
    mirror_.shapesAppended();
  }
  void write(const SetSurfaces& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.listWritten(Per::Surface);
  }
  void write(const SetPlanes& e) {
    RUBBLE_CORE::apply(host(), e);
    mirror_.listWritten(Per::Plane);
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
  std::unique_ptr<HostTables> seen_;  ///< of tablesNow()
  std::vector<ContactRows> seenRows_;
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
  queries_.moved();
  nvtxRangePushA("rubble step");
  host().trees.update(host(), mirror_.treeChanges());
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

const HostTables& CudaEngine::tablesNow() {
  if (!seen_) seen_ = std::make_unique<HostTables>();
  const SolverData& device = stepper_.tables().view();
  for (int k = 0; k < kPerCount; ++k)
    seen_->reserve(static_cast<Per>(k), stepper_.tables().capacity(static_cast<Per>(k)));
  seenRows_.resize(static_cast<std::size_t>(stepper_.tables().capacity(Per::Manifold)));
  SolverData& to = seen_->view();
  to = onDevice(device, to);
  const auto copy = [](void* here, const void* there, std::size_t bytes) {
    checkCuda(cudaMemcpy(here, there, bytes, cudaMemcpyDeviceToHost), "cudaMemcpy of tables");
  };
  copy(to.counters, device.counters, sizeof(Counters));
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    // rows have memory of their own here
    if constexpr (std::is_same_v<T, ContactRows>) to.contact = seenRows_.data();
    copy(to.*array.member, device.*array.member, sizeof(T) * elementsWritten(*seen_, array.per));
  });
  return *seen_;
}

void CudaEngine::sortBodies() {
  queries_.moved();
  mirror_.flush();
  prepareConstants();
  stepper_.sortBodies(host().view(), mirror_.oldPairs());
  mirror_.bodiesSorted();
}

void CudaEngine::write(const SetBody& e) {
  if (e.keepsState) mirror_.fetchAll();  // the upload holds the state too
  const int before = host().view().bodies;
  setBodyCount(host(), e.id + 1);
  mirror_.bodiesAdded(before);
  const int slot = slotOf(host(), e.id);
  count(slot, -1);
  (e.keepsState ? editBody : setBody)(host(), slot, e.body);
  count(slot, 1);
  mirror_.bodyWritten(slot);
}

std::shared_ptr<const EngineSnapshot> CudaEngine::snapshot() {
  if (host().view().vertices == 0) return mirror_.snapshot(previousDt_);
  mirror_.fetchAll();
  return std::make_shared<SavedState>(saveState(host(), previousDt_));
}

void CudaEngine::restore(const EngineSnapshot& snapshot) {
  queries_.moved();
  const auto* const own = dynamic_cast<const DeviceSnapshot*>(&snapshot);
  if (own) {
    if (host().view().vertices > 0) write(SetDeformables{});
    mirror_.restore(*own);
    previousDt_ = own->previousDt;
  } else {
    loadState(host(), previousDt_, snapshot.bytes());
    mirror_.allWritten();
  }
  countBodies();
}

}  // namespace

std::unique_ptr<Engine> makeCudaEngine(bool timings) { return std::make_unique<CudaEngine>(timings); }

}  // namespace rubble::RUBBLE_CORE

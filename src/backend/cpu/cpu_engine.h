#pragma once
/// An engine whose tables are in host memory.
#include <optional>

#include "backend/cpu/cpu_executor.h"
#include "backend/cpu/host_arrays.h"
#include "backend/cpu/host_joint_rows.h"
#include "backend/observable_engine.h"
#include "solver/settings.h"
#include "tables/host_queries.h"
#include "tables/host_reader.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

/// Instantiated in cpu_step.cpp only: the step dominates the compile time of the library.
extern template void step(CpuExecutor&);

/// Plans the joint trees of edited bodies and joints.
void planTrees(HostTables& tables);

/// Copies the counters of a step to its report.
void reportCounters(const SolverData& s, StepReport& report);
/// Adds what a substep has counted and the next one does not.
void noteSubstep(const Counters& c, StepReport& report);

/// Sets counters and constants of the next step.
void beginStep(SolverData& s, const EngineSettings& settings, double previousDt);

/// Engine::sortBodies() for the tables of an executor, with the constants of the next step.
void sortBodiesOf(CpuExecutor& executor);

/// Serializes or restores the complete state of a host engine: its tables and its last time step.
std::vector<std::byte> saveState(const HostTables& tables, double previousDt);
void loadState(HostTables& tables, double& previousDt, std::span<const std::byte> data);

class CpuEngine final : public ObservableEngine, public BatchEngine {
 public:
  explicit CpuEngine(const CpuOptions& options)
      : executor_(options.threads, options.timings, options.tasks, options.memory),
        variant_(options.variant) {
    if (options.backward) executor_.takeBackward();
  }

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    tables().view().step->gravity = Vec3(settings.gravity);
  }
  void apply(std::span<const Edit> edits) override { RUBBLE_CORE::apply(tables(), edits); }
  void step(StepReport& report) override;
  void sortBodies() override {
    RUBBLE_CORE::beginStep(tables().view(), settings_, previousDt_);
    sortBodiesOf(executor_);
  }
  const TableReader& read(Fetch, int) override { return reader_; }
  std::span<EngineQuery> queryRoom(std::size_t n) override { return queries_.room(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override {
    std::span<const EngineHit> out;
    executor_.run([&] { out = queries_.hits(tables(), asked); });
    return out;
  }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    EngineOverlaps out;
    executor_.run([&] { out = queries_.overlaps(tables(), asked); });
    return out;
  }
  EngineAllHits allHits(const EngineQueries& asked) override {
    EngineAllHits out;
    executor_.run([&] { out = queries_.allHits(tables(), asked); });
    return out;
  }
  ArrayView array(StateArray which) override { return arrays_.view(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    scatterRows(tables(), which, rows, values);
    arrays_.follow();
  }
  void setJointRows(const JointRows& rows) override { jointRows_.set(rows); }
  ArrayView array(JointArray which) override { return jointRows_.view(tables(), which); }
  ArrayView array(SensorArray which) override { return jointRows_.view(tables(), which); }
  ArrayView array(VertexArray which) override { return rowsOf(which, tables().view()); }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override {
    return jointRows_.contactForces(tables(), pairs);
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override {
    jointRows_.scatter(tables(), which, rows, values);
    arrays_.follow();
  }
  bool reserve(const std::string& kind, int count) override { return reserveKind(tables(), kind, count); }
  std::size_t memoryBytes() const override { return executor_.tables().bytes(); }
  std::vector<TableHash> tableHashes() override { return hashTables(tables(), hashOf); }
  std::shared_ptr<const EngineSnapshot> snapshot() override {
    return std::make_shared<SavedState>(saveState(tables(), previousDt_));
  }
  void restore(const EngineSnapshot& snapshot) override {
    loadState(tables(), previousDt_, snapshot.bytes());
  }
  BatchEngine* batch() override { return this; }
  void setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) override;
  const WorldSettings& settingsOf(int world) const override {
    return worlds_[static_cast<std::size_t>(world)];
  }
  void setSettings(int world, const WorldSettings& settings) override {
    worlds_[static_cast<std::size_t>(world)] = settings;
    tables().view().step[world].gravity = Vec3(settings.gravity);
  }
  void stepWorlds(StepReport& report, std::span<const char> paused) override;
  const TableReader& readWorld(int world) override {
    return worldReader_.emplace(executor_.tables(), &parts_[static_cast<std::size_t>(world)]);
  }
  std::vector<std::byte> takeWorld(int world) override {
    return RUBBLE_CORE::takeWorld(tables(), parts_[static_cast<std::size_t>(world)]);
  }
  void putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) override {
    prepareToPut(worlds, states)();
  }
  std::function<void()> prepareToPut(std::span<const int> worlds,
                                     std::span<const std::span<const std::byte>> states) override;
  std::function<void()> backup() override;
  void observe(KernelObserver observer) override { executor_.observe(std::move(observer)); }
  const HostTables& tablesNow() override { return executor_.tables(); }
  HostTables& tables() { return executor_.tables(); }
  /// Most ranges that loops have use for, and a call whose loops run on the threads of this engine.
  int threads() const { return executor_.threads(); }
  void run(FunctionRef<void()> f) { executor_.run(f); }
  /// As CpuExecutor::divide.
  void divide(Division* division) {
    executor_.divide(division);
    divided_ = division != nullptr;
    executor_.view().searchesAlways |= divided_;
  }

 private:
  void takeStep(StepReport& report);
  void beginStep();

  CpuExecutor executor_;
  void (*const variant_)(f32::CpuExecutor&);
  HostReader reader_{executor_.tables()};
  HostArrays arrays_{executor_.tables()};
  HostJointRows jointRows_;
  HostQueries queries_;
  EngineSettings settings_;
  double previousDt_ = 0;
  bool divided_ = false;
  std::vector<WorldSettings> worlds_;  ///< of a batch
  std::vector<WorldPart> parts_;
  std::optional<HostReader> worldReader_;
};

}  // namespace rubble::RUBBLE_CORE

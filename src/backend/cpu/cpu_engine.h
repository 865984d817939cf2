#pragma once
/// An engine whose tables are in host memory.
#include "backend/cpu/cpu_executor.h"
#include "backend/cpu/host_arrays.h"
#include "backend/engine.h"
#include "solver/settings.h"
#include "tables/soft_edit.h"
#include "tables/state_rows.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

/// Instantiated in cpu_engine.cpp only: the step dominates the compile time of the library.
extern template void step(CpuExecutor&);

/// Copies the counters of a step to its report.
void reportCounters(const SolverData& s, StepReport& report);

/// Sets counters and constants of the next step.
void beginStep(SolverData& s, const EngineSettings& settings, double previousDt);

/// Engine::sortBodies() for the tables of an executor, with the constants of the next step.
void sortBodiesOf(CpuExecutor& executor);

/// Serializes or restores the complete state of a host engine: its tables and its last time step.
std::vector<std::byte> saveState(const HostTables& tables, double previousDt);
void loadState(HostTables& tables, double& previousDt, std::span<const std::byte> data);

class CpuEngine final : public Engine {
 public:
  CpuEngine(int threads, bool timings) : executor_(threads, timings) {}

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    tables().view().step->gravity = Vec3(settings.gravity);
  }
  void setBodyCount(int slots) override { RUBBLE_CORE::setBodyCount(tables(), slots); }
  void setBody(int slot, const EngineBody& body) override { RUBBLE_CORE::setBody(tables(), slot, body); }
  void forgetContacts(int slot) override { RUBBLE_CORE::forgetContacts(tables(), slot); }
  void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) override {
    RUBBLE_CORE::addShape(tables(), shape, partSurfaces);
  }
  void setSurfaces(const std::vector<Material>& surfaces) override {
    RUBBLE_CORE::setSurfaces(tables(), surfaces);
  }
  void setPlanes(const std::vector<int>& slots) override { RUBBLE_CORE::setPlanes(tables(), slots); }
  void setJointCount(int type, int slots) override { RUBBLE_CORE::setJointCount(tables(), type, slots); }
  void setJoint(int slot, const EngineJoint& joint) override { RUBBLE_CORE::setJoint(tables(), slot, joint); }
  void editJoint(int slot, const EngineJoint& joint) override {
    RUBBLE_CORE::editJoint(tables(), slot, joint);
  }
  void setExclusions(const std::vector<std::pair<int, int>>& pairs) override {
    RUBBLE_CORE::setExclusions(tables(), pairs);
  }
  void setSoft(const std::vector<EngineSoftObject>& objects,
               const std::vector<EngineAttachment>& attachments) override {
    RUBBLE_CORE::setSoft(tables(), objects, attachments);
  }
  void vertexStates(int first, std::span<rubble::Vec3> positions,
                    std::span<rubble::Vec3> velocities) const override {
    vertexStatesOf(tables(), first, positions, velocities);
  }
  void setVertexStates(int first, std::span<const rubble::Vec3> positions,
                       std::span<const rubble::Vec3> velocities) override {
    RUBBLE_CORE::setVertexStates(tables(), first, positions, velocities);
  }
  void addVertexForce(int vertex, const rubble::Vec3& force) override {
    tables().view().vertexForce[vertex] += Vec3(force);
  }
  void elementsAlive(int type, int first, std::span<char> alive) const override {
    elementsAliveOf(tables(), type, first, alive);
  }
  JointState attachmentState(int index) const override { return attachmentStateOf(tables(), index); }
  std::vector<EngineVertexContact> vertexContacts() const override { return vertexContactsOf(tables()); }
  BodyState state(int slot) const override { return bodyState(tables(), slot); }
  void setState(int slot, const BodyState& state) override { setBodyState(tables(), slot, state); }
  void addForce(int slot, const rubble::Vec3& force, const rubble::Vec3& torque) override;
  void addVelocities(std::span<const int> slots, std::span<const rubble::Vec3> changes) override {
    for (std::size_t k = 0; k < slots.size(); ++k) addVelocity(tables(), slots[k], changes[k]);
  }
  void forgetContactsOf(std::span<const int> slots) override {
    RUBBLE_CORE::forgetContactsOf(tables(), slots);
  }
  ArrayView array(StateArray which) override { return arrays_.view(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    scatterRows(tables(), which, rows, values);
    arrays_.follow();
  }
  bool reserve(const std::string& kind, int count) override { return reserveKind(tables(), kind, count); }
  void step(StepReport& report) override;
  BodyOrder order() const override { return orderOf(tables()); }
  void sortBodies() override {
    beginStep(tables().view(), settings_, previousDt_);
    sortBodiesOf(executor_);
  }
  Quality quality() const override { return qualityOf(tables()); }
  void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const override {
    solverStatesOf(tables(), bodies, vertices);
  }
  std::vector<EngineContact> contacts() const override { return contactsOf(tables()); }
  std::vector<EngineTouch> touches() const override { return touchesOf(tables()); }
  std::vector<int> sleepers() const override { return sleepersOf(tables()); }
  bool isAsleep(int slot) const override { return tables().view().asleep[slot] != 0; }
  std::vector<EngineHit> query(std::span<const EngineQuery> queries) override {
    return runQueries(tables(), queries);
  }
  std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) override {
    return runOverlaps(tables(), queries);
  }
  JointState jointState(int type, int slot) const override { return jointStateOf(tables(), type, slot); }
  std::vector<std::pair<int, int>> brokenJoints() const override { return brokenJointsOf(tables()); }
  std::size_t memoryBytes() const override { return tables().bytes(); }
  std::uint64_t hash() const override { return hashBytes(save()); }
  std::vector<std::byte> save() const override { return saveState(tables(), previousDt_); }
  void load(std::span<const std::byte> data) override { loadState(tables(), previousDt_, data); }

 private:
  void takeStep(StepReport& report);
  HostTables& tables() { return executor_.tables(); }
  const HostTables& tables() const { return executor_.tables(); }

  CpuExecutor executor_;
  HostArrays arrays_{executor_.tables()};
  EngineSettings settings_;
  double previousDt_ = 0;
};

}  // namespace rubble::RUBBLE_CORE

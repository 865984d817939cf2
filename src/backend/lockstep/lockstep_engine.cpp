#include "backend/lockstep/lockstep_pair.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// One thread next to many threads. Measures and arrays are those of the first executor.
class LockstepEngine final : public Engine {
 public:
  explicit LockstepEngine(int threads) : pair_(1, threads) {}

  void configure(const EngineSettings& settings) override {
    settings_ = settings;
    both([&](HostTables& t) { t.view().step->gravity = Vec3(settings.gravity); });
  }
  void setBodyCount(int slots) override {
    both([&](HostTables& t) { RUBBLE_CORE::setBodyCount(t, slots); });
  }
  void setBody(int slot, const EngineBody& body) override {
    both([&](HostTables& t) { RUBBLE_CORE::setBody(t, slot, body); });
  }
  void forgetContacts(int slot) override {
    both([&](HostTables& t) { RUBBLE_CORE::forgetContacts(t, slot); });
  }
  void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) override {
    both([&](HostTables& t) { RUBBLE_CORE::addShape(t, shape, partSurfaces); });
  }
  void setSurfaces(const std::vector<Material>& surfaces) override {
    both([&](HostTables& t) { RUBBLE_CORE::setSurfaces(t, surfaces); });
  }
  void setPlanes(const std::vector<int>& slots) override {
    both([&](HostTables& t) { RUBBLE_CORE::setPlanes(t, slots); });
  }
  void setJointCount(int type, int slots) override {
    both([&](HostTables& t) { RUBBLE_CORE::setJointCount(t, type, slots); });
  }
  void setJoint(int slot, const EngineJoint& joint) override {
    both([&](HostTables& t) { RUBBLE_CORE::setJoint(t, slot, joint); });
  }
  void editJoint(int slot, const EngineJoint& joint) override {
    both([&](HostTables& t) { RUBBLE_CORE::editJoint(t, slot, joint); });
  }
  void setExclusions(const std::vector<std::pair<int, int>>& pairs) override {
    both([&](HostTables& t) { RUBBLE_CORE::setExclusions(t, pairs); });
  }
  void setSoft(const std::vector<EngineSoftObject>& objects,
               const std::vector<EngineAttachment>& attachments) override {
    both([&](HostTables& t) { RUBBLE_CORE::setSoft(t, objects, attachments); });
  }
  void vertexStates(int first, std::span<rubble::Vec3> positions,
                    std::span<rubble::Vec3> velocities) const override {
    vertexStatesOf(this->first(), first, positions, velocities);
  }
  void setVertexStates(int first, std::span<const rubble::Vec3> positions,
                       std::span<const rubble::Vec3> velocities) override {
    both([&](HostTables& t) { RUBBLE_CORE::setVertexStates(t, first, positions, velocities); });
  }
  void addVertexForce(int vertex, const rubble::Vec3& force) override {
    both([&](HostTables& t) { t.view().vertexForce[vertex] += Vec3(force); });
  }
  void elementsAlive(int type, int first, std::span<char> alive) const override {
    elementsAliveOf(this->first(), type, first, alive);
  }
  JointState attachmentState(int index) const override { return attachmentStateOf(first(), index); }
  std::vector<EngineVertexContact> vertexContacts() const override { return vertexContactsOf(first()); }
  BodyState state(int slot) const override { return bodyState(first(), slot); }
  void setState(int slot, const BodyState& state) override {
    both([&](HostTables& t) { setBodyState(t, slot, state); });
  }
  void addForce(int slot, const rubble::Vec3& force, const rubble::Vec3& torque) override {
    both([&](HostTables& t) {
      t.view().force[slot] += Vec3(force);
      t.view().torque[slot] += Vec3(torque);
    });
  }
  void addVelocities(std::span<const int> slots, std::span<const rubble::Vec3> changes) override {
    both([&](HostTables& t) {
      for (std::size_t k = 0; k < slots.size(); ++k) addVelocity(t, slots[k], changes[k]);
    });
  }
  void forgetContactsOf(std::span<const int> slots) override {
    both([&](HostTables& t) { RUBBLE_CORE::forgetContactsOf(t, slots); });
  }
  /// Of the first executor: views are read-only.
  ArrayView array(StateArray which) override { return arrays_.view(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    both([&](HostTables& t) { scatterRows(t, which, rows, values); });
    arrays_.follow();
  }
  bool reserve(const std::string& kind, int count) override {
    bool known = false;
    both([&](HostTables& t) { known = reserveKind(t, kind, count); });
    return known;
  }
  void step(StepReport& report) override {
    try {
      takeStep(report);
    } catch (const std::bad_alloc&) {
      both(abandonStep);
      throw;
    }
  }
  void takeStep(StepReport& report) {
    both([](HostTables& t) { planTrees(t); });
    for (int k = 0; k < settings_.params.substeps; ++k) {
      both([&](HostTables& t) { beginStep(t.view(), settings_, previousDt_); });
      pair_.step(report.step);
      both([](HostTables& t) { t.view().rolledBefore = t.view().rolls; });
      previousDt_ = settings_.params.dt / settings_.params.substeps;
    }
    both(endForces);
    settings_.wakeAll = false;
    reportCounters(first().view(), report);
    report.stages = pair_.a().takeTimes();
    pair_.b().takeTimes();
    report.grown = pair_.a().takeGrown();
    pair_.b().takeGrown();
    arrays_.follow();
  }
  BodyOrder order() const override { return orderOf(first()); }
  void sortBodies() override {
    both([&](HostTables& t) { beginStep(t.view(), settings_, previousDt_); });
    pair_.sortBodies();
  }
  Quality quality() const override { return qualityOf(first()); }
  void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const override {
    solverStatesOf(first(), bodies, vertices);
  }
  std::vector<EngineContact> contacts() const override { return contactsOf(first()); }
  std::vector<EngineTouch> touches() const override { return touchesOf(first()); }
  std::vector<int> sleepers() const override { return sleepersOf(first()); }
  bool isAsleep(int slot) const override { return first().view().asleep[slot] != 0; }
  std::vector<EngineHit> query(std::span<const EngineQuery> queries) override {
    runQueries(pair_.b().tables(), queries);
    return runQueries(pair_.a().tables(), queries);
  }
  std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) override {
    runOverlaps(pair_.b().tables(), queries);
    return runOverlaps(pair_.a().tables(), queries);
  }
  JointState jointState(int type, int slot) const override { return jointStateOf(first(), type, slot); }
  std::vector<std::pair<int, int>> brokenJoints() const override { return brokenJointsOf(first()); }
  std::size_t memoryBytes() const override { return 2 * first().bytes(); }
  std::uint64_t hash() const override { return hashBytes(save()); }
  std::vector<std::byte> save() const override { return saveState(first(), previousDt_); }
  void load(std::span<const std::byte> data) override {
    both([&](HostTables& t) { loadState(t, previousDt_, data); });
  }
  std::string firstDifference() const override { return pair_.firstDifference(); }

 private:
  template <class F> void both(F&& f) {
    f(pair_.a().tables());
    f(pair_.b().tables());
  }
  const HostTables& first() const { return pair_.a().tables(); }

  LockstepPair pair_;
  HostArrays arrays_{pair_.a().tables()};
  EngineSettings settings_;
  double previousDt_ = 0;
};

}  // namespace

std::unique_ptr<Engine> makeLockstepEngine(int threads) { return std::make_unique<LockstepEngine>(threads); }

}  // namespace rubble::RUBBLE_CORE

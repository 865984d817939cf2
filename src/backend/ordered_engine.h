#pragma once
/// An engine that addresses bodies by id, whatever their order in the tables, and that sorts them
/// periodically.
#include "backend/engine.h"

namespace rubble {

class OrderedEngine final : public Engine {
 public:
  explicit OrderedEngine(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}

  /// Sorts with the next step, whether or not it is due.
  void sortSoon() { due_ = true; }

  // By id.
  void setBody(int id, const EngineBody& body) override { engine_->setBody(slot(id), body); }
  void forgetContacts(int id) override { engine_->forgetContacts(slot(id)); }
  void forgetContactsOf(std::span<const int> ids) override { engine_->forgetContactsOf(slots(ids)); }
  void setPlanes(const std::vector<int>& ids) override { engine_->setPlanes(slots(ids)); }
  void setJoint(int joint, const EngineJoint& def) override { engine_->setJoint(joint, inSlots(def)); }
  void editJoint(int joint, const EngineJoint& def) override { engine_->editJoint(joint, inSlots(def)); }
  void setSoft(const std::vector<EngineSoftObject>& objects,
               const std::vector<EngineAttachment>& attachments) override;
  BodyState state(int id) const override { return engine_->state(slot(id)); }
  void setState(int id, const BodyState& state) override { engine_->setState(slot(id), state); }
  void addForce(int id, const Vec3& force, const Vec3& torque) override {
    engine_->addForce(slot(id), force, torque);
  }
  void addVelocities(std::span<const int> ids, std::span<const Vec3> changes) override {
    engine_->addVelocities(slots(ids), changes);
  }
  bool isAsleep(int id) const override { return engine_->isAsleep(slot(id)); }
  std::vector<int> sleepers() const override;
  void solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const override;
  std::vector<EngineContact> contacts() const override;
  std::vector<EngineTouch> touches() const override;
  std::vector<EngineVertexContact> vertexContacts() const override;
  std::vector<EngineHit> query(std::span<const EngineQuery> queries) override;
  std::vector<std::vector<int>> overlaps(std::span<const EngineQuery> queries) override;

  /// Sorts the bodies first if that is due.
  void step(StepReport& report) override;

  // Forwarded unchanged.
  void configure(const EngineSettings& settings) override {
    sortInterval_ = settings.params.sortInterval;
    engine_->configure(settings);
  }
  void setBodyCount(int bodies) override { engine_->setBodyCount(bodies); }
  void addShape(const CookedShape& shape, const std::vector<int>& partSurfaces) override {
    engine_->addShape(shape, partSurfaces);
  }
  void setSurfaces(const std::vector<Material>& surfaces) override { engine_->setSurfaces(surfaces); }
  void setJointCount(int type, int joints) override { engine_->setJointCount(type, joints); }
  void setExclusions(const std::vector<std::pair<int, int>>& pairs) override {
    engine_->setExclusions(pairs);
  }
  void vertexStates(int first, std::span<Vec3> positions, std::span<Vec3> velocities) const override {
    engine_->vertexStates(first, positions, velocities);
  }
  void setVertexStates(int first, std::span<const Vec3> positions,
                       std::span<const Vec3> velocities) override {
    engine_->setVertexStates(first, positions, velocities);
  }
  void addVertexForce(int vertex, const Vec3& force) override { engine_->addVertexForce(vertex, force); }
  void elementsAlive(int type, int first, std::span<char> alive) const override {
    engine_->elementsAlive(type, first, alive);
  }
  JointState attachmentState(int index) const override { return engine_->attachmentState(index); }
  ArrayView array(StateArray which) override { return engine_->array(which); }
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override {
    engine_->scatter(which, rows, values);
  }
  PoseCopies* poseCopies() override { return engine_->poseCopies(); }
  bool reserve(const std::string& kind, int count) override { return engine_->reserve(kind, count); }
  BodyOrder order() const override { return engine_->order(); }
  void sortBodies() override { engine_->sortBodies(); }
  Quality quality() const override { return engine_->quality(); }
  JointState jointState(int type, int joint) const override { return engine_->jointState(type, joint); }
  std::vector<std::pair<int, int>> brokenJoints() const override { return engine_->brokenJoints(); }
  std::size_t memoryBytes() const override { return engine_->memoryBytes(); }
  std::uint64_t hash() const override { return engine_->hash(); }
  std::vector<std::byte> save() const override { return engine_->save(); }
  void load(std::span<const std::byte> data) override { engine_->load(data); }
  std::shared_ptr<const EngineSnapshot> snapshot() const override { return engine_->snapshot(); }
  void restore(const EngineSnapshot& snapshot) override { engine_->restore(snapshot); }
  std::string firstDifference() const override { return engine_->firstDifference(); }

 private:
  /// Negative ids (no body) are unchanged.
  int slot(int id) const { return id < 0 ? id : engine_->order().slotOf[static_cast<std::size_t>(id)]; }
  int idOf(int slot) const { return slot < 0 ? slot : engine_->order().idOf[static_cast<std::size_t>(slot)]; }
  std::vector<int> slots(std::span<const int> ids) const;
  EngineJoint inSlots(EngineJoint joint) const;
  std::vector<EngineQuery> inSlots(std::span<const EngineQuery> queries) const;

  std::unique_ptr<Engine> engine_;
  bool due_ = false;
  int sortInterval_ = 0;
};

}  // namespace rubble

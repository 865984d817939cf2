#pragma once
/// Reads tables in host memory.
#include "tables/reader.h"
#include "tables/table_edit.h"
#include "tables/world_state.h"

namespace rubble::RUBBLE_CORE {

/// Reads all bodies, or one world of a batch in its own numbers.
class HostReader final : public TableReader {
 public:
  explicit HostReader(const HostTables& tables, const WorldPart* world = nullptr)
      : tables_(tables), world_(world) {}

  BodyState state(int id) const override { return bodyState(tables_, placeOf(id)); }
  bool isAsleep(int id) const override { return data().asleep[placeOf(id)] != 0; }
  std::vector<int> sleepers() const override;
  std::vector<EngineContact> contacts() const override;
  std::vector<EngineTouch> touches() const override;
  JointState jointState(int type, int slot) const override;
  std::vector<std::pair<int, int>> brokenJoints() const override;
  Quality quality() const override;
  std::vector<SolverState> bodySolverStates() const override;
  std::vector<SolverState> vertexSolverStates() const override;
  void vertexStates(int first, std::span<rubble::Vec3> positions,
                    std::span<rubble::Vec3> velocities) const override;
  std::vector<EngineVertexContact> vertexContacts() const override;
  JointState attachmentState(int index) const override;
  std::vector<char> elementsAlive(int type, int first, int count) const override;

 private:
  const SolverData& data() const { return tables_.view(); }
  int placeOf(int id) const { return world_ ? world_->firstBody + id : slotOf(tables_, id); }
  int bodiesBegin() const { return world_ ? world_->firstBody : 0; }
  int bodiesEnd() const { return world_ ? world_->firstBody + world_->bodies : data().bodies; }
  int verticesBegin() const { return world_ ? world_->firstVertex : 0; }
  int verticesEnd() const { return world_ ? world_->firstVertex + world_->vertices : data().vertices; }
  int attachmentsBegin() const { return world_ ? world_->firstAttachment : 0; }
  int attachmentsEnd() const {
    return world_ ? world_->firstAttachment + world_->attachments : data().attachments;
  }
  int slotOfJoint(int type, int slot) const {
    return world_ ? world_->joints[type][static_cast<std::size_t>(slot)] : slot;
  }
  int jointSlots(int type) const {
    return world_ ? static_cast<int>(world_->joints[type].size()) : data().joints[type];
  }
  /// The owners of point pairs.
  std::vector<OwnerRange> pointOwners() const {
    return world_ ? pointOwnersOf(data(), *world_) : std::vector<OwnerRange>{{0, data().owners()}};
  }
  void addSoftQuality(Quality& quality, std::vector<double>& depths, int& joints) const;

  const HostTables& tables_;
  const WorldPart* world_;  ///< null: all
};

}  // namespace rubble::RUBBLE_CORE

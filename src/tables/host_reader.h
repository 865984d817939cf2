#pragma once
/// Reads tables in host memory.
#include "tables/reader.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

class HostReader final : public TableReader {
 public:
  explicit HostReader(const HostTables& tables) : tables_(tables) {}

  BodyState state(int id) const override { return bodyState(tables_, slotOf(tables_, id)); }
  bool isAsleep(int id) const override { return data().asleep[slotOf(tables_, id)] != 0; }
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
  void addSoftQuality(Quality& quality, std::vector<double>& depths, int& joints) const;

  const HostTables& tables_;
};

}  // namespace rubble::RUBBLE_CORE

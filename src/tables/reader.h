#pragma once
/// What a World reads of the tables, by ids of bodies. Independent of the solver precision.
#include "tables/records.h"

namespace rubble {

class TableReader {
 public:
  virtual ~TableReader() = default;
  virtual BodyState state(int id) const = 0;
  virtual bool isAsleep(int id) const = 0;
  /// Ids of sleeping bodies, ascending.
  virtual std::vector<int> sleepers() const = 0;
  /// Contacts of the last step at the present poses.
  virtual std::vector<EngineContact> contacts() const = 0;
  virtual std::vector<EngineTouch> touches() const = 0;
  virtual JointState jointState(int type, int slot) const = 0;
  /// (type, slot) of all broken joints.
  virtual std::vector<std::pair<int, int>> brokenJoints() const = 0;
  virtual Quality quality() const = 0;
  virtual std::vector<SolverState> bodySolverStates() const = 0;
  virtual std::vector<SolverState> vertexSolverStates() const = 0;

  virtual void vertexStates(int first, std::span<Vec3> positions, std::span<Vec3> velocities) const = 0;
  virtual std::vector<EngineVertexContact> vertexContacts() const = 0;
  virtual JointState attachmentState(int index) const = 0;
  /// For `count` elements of a type from `first` on: 1 if not broken.
  virtual std::vector<char> elementsAlive(int type, int first, int count) const = 0;
};

}  // namespace rubble

#pragma once
/// Tables in host memory, with what only edits need to know of them.
#include <algorithm>
#include <bit>

#include "state/solver_tables.h"
#include "tables/host_memory.h"
#include "tables/tree_plan.h"

namespace rubble::RUBBLE_CORE {

/// Slots of a table for `ids` elements. A reserve of up to a 32nd lets additions leave the number of slots,
/// on which captured steps depend, as it is.
inline int slotsFor(int ids) {
  const int grain = std::max(1, static_cast<int>(std::bit_floor(static_cast<unsigned>(ids))) / 32);
  return (ids + grain - 1) / grain * grain;
}

struct HostTables : SolverTables<HostMemory> {
  explicit HostTables(const MemorySystem& memory = {}) : SolverTables(HostMemory(memory)) {}

  int bodyIds = 0;                                         ///< slots beyond are a reserve of removed bodies
  int jointIds[JointTypes::kSize] = {};                    ///< the same for each joint type
  int shapeVectors = 0, shapeIndices = 0, shapeParts = 0;  ///< ends of the shared tables
  int excludedPairs = 0;
  std::vector<ExcludedPair> movingPairs;  ///< while the table of excluded pairs grows
  TreePlan trees;

  /// Number of bodies with each trait. Setting it updates the flags of the SolverData.
  const TraitCounts& traits() const { return traits_; }
  void setTraits(const TraitCounts& traits) {
    SolverData& s = view();
    if (&traits != &traits_) traits_ = traits;
    s.generalShapes = traits[BodyTrait::GeneralShape] > 0,
    s.rolls = traits[BodyTrait::Rolls] > 0 || rulesRoll_;
    s.bounces = traits[BodyTrait::Bounces] > 0 || rulesBounce_, s.locked = traits[BodyTrait::Locked] > 0;
    s.filtered = traits[BodyTrait::Filtered] > 0;
  }
  /// Do pair rules give rolling or torsional friction, and restitution?
  void setRules(bool roll, bool bounce) {
    rulesRoll_ = roll, rulesBounce_ = bounce;
    setTraits(traits_);
  }
  /// Rolling rows for which a saved state needs memory, if `traits` are those of its bodies: one per manifold
  /// if anything may roll in the next step or has rolled in the last one.
  int rollingRows(const TraitCounts& traits, int activePairs, int rollers) const {
    const bool roll = traits[BodyTrait::Rolls] > 0 || rulesRoll_ || rollers > 0;
    return roll ? std::max(activePairs, rollers) : 0;
  }

 private:
  TraitCounts traits_;
  bool rulesRoll_ = false, rulesBounce_ = false;
};

}  // namespace rubble::RUBBLE_CORE

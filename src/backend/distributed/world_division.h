#pragma once
/// The division of a world that steps many times.
#include <vector>

#include <rubble/ranks.h>

#include "backend/division.h"

namespace rubble::RUBBLE_CORE {

class WorldDivision : public Division {
 public:
  /// Gathers the state of all pairs and joints, which each rank has for its own bodies only. All ranks call
  /// it.
  virtual void gatherState() = 0;
  /// The tables were replaced or sorted. All ranks have the whole state.
  virtual void restart() = 0;
  /// Of the last step, by rank, without times and bytes.
  virtual const std::vector<RankReport>& reports() const = 0;
};

}  // namespace rubble::RUBBLE_CORE

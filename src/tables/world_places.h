#pragma once
/// Where the worlds of a batch lie in the tables.
#include <vector>

#include "tables/host_tables.h"
#include "tables/world_state.h"

namespace rubble::RUBBLE_CORE {

/// Moves the bodies of all ids in the tables to the places at which `ids` lists them. Bodies of one world
/// keep their order. With std::bad_alloc nothing is changed.
void placeBodies(HostTables& tables, const std::vector<int>& ids);

/// Gives the worlds their elements, with their bodies consecutive. `spare`: bodies of no world, which come
/// last. Returns the elements of each world. With std::bad_alloc nothing is changed.
std::vector<WorldPart> placeWorlds(HostTables& tables, std::span<const WorldLayout> worlds,
                                   std::span<const int> spare);

/// Sets the constants of a step of a world: those of the first one, with its own gravity and last time step.
void setConstants(const SolverData& s, const EngineSettings& settings, int world, const WorldSettings& own);

}  // namespace rubble::RUBBLE_CORE

#pragma once
#include <vector>

#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// Moves the bodies of all ids in the tables to the places at which `ids` lists them. Bodies of one world
/// keep their order.
void placeBodies(HostTables& tables, const std::vector<int>& ids);

}  // namespace rubble::RUBBLE_CORE

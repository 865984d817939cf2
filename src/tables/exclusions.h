#pragma once
/// Pairs of bodies that do not collide, as a hash table with linear probing (stages/pairs/filter.h reads it).
#include <vector>

#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// Adds or removes a pair of ids. `changed` receives the written elements, or every element after growth.
void setExcluded(HostTables& tables, int a, int b, bool excluded, std::vector<int>& changed, int world = 0);
/// Makes these the only pairs.
void loadExclusions(HostTables& tables, const std::vector<ExcludedPair>& pairs);
/// All pairs (low, high), sorted.
std::vector<ExcludedPair> excludedPairs(const SolverData& s);

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Pairs of bodies that do not collide, as a hash table with linear probing (stages/pairs/filter.h reads it).
#include <vector>

#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// Reserves memory for so many more pairs.
void reserveExclusions(HostTables& tables, int more);
/// Reserves memory for as many pairs after clearExclusions().
void reserveLoadedExclusions(HostTables& tables, int pairs);
/// Adds or removes a pair of ids. `changed` receives the written elements, or every element after growth.
void setExcluded(HostTables& tables, int a, int b, bool excluded, std::vector<int>* changed = nullptr,
                 int world = 0);
/// Empties the table, and makes it as large as so many pairs need.
void clearExclusions(HostTables& tables, int pairs);
/// All pairs (low, high), sorted.
std::vector<ExcludedPair> excludedPairs(const SolverData& s);

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Invariants of the tables between steps. Checked builds and fuzzers test them after each step.
#include <string>

#include "tables/host_tables.h"

namespace rubble::RUBBLE_CORE {

/// The first invariant that the tables violate after a step, with table and element, or "". `whole`: they
/// have the manifolds of all pairs; a rank has those of its part.
std::string firstViolation(const HostTables& tables, bool whole);

}  // namespace rubble::RUBBLE_CORE

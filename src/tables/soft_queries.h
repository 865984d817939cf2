#pragma once
/// Queries against deformable objects, on the host.
#include "tables/records.h"

namespace rubble::RUBBLE_CORE {

/// The first hit of each query on each object, or the nearest piece of each, ascending in fraction and
/// object: hits as those of Engine::allHits(), with the slot of the object in place of a body, and the index
/// of the piece in `triangle`. Sheets are hit from both sides.
std::vector<std::vector<EngineHit>> softHits(const EngineQueries& asked, const EngineSoftTargets& targets);

}  // namespace rubble::RUBBLE_CORE

// Many worlds in the tables of a host engine.
#include "backend/cpu/cpu_engine.h"
#include "tables/exclusions.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

void CpuEngine::setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) {
  worlds_.reserve(worlds.size());
  parts_ = placeWorlds(tables(), worlds, spare);
  worlds_.resize(worlds.size());
  arrays_.follow();
}

void CpuEngine::stepWorlds(StepReport& report, std::span<const char> paused) {
  SolverData& s = tables().view();
  std::vector<int> still;
  for (std::size_t w = 0; w < paused.size(); ++w)
    if ((s.paused[w] = paused[w]) != 0) still.push_back(static_cast<int>(w));
  // a step skips most of the work for paused worlds, and afterwards their states are put back
  std::vector<std::vector<std::byte>> states(still.size());
  executor_.run([&] { forEachTask(still.size(), [&](std::size_t k) { states[k] = takeWorld(still[k]); }); });
  std::vector<WorldChange> changes;
  for (std::size_t k = 0; k < still.size(); ++k) changes.push_back({still[k], states[k]});
  s.pausing = !still.empty();
  try {
    step(report);
  } catch (...) {
    s.pausing = false;
    putWithoutContacts(tables(), parts_, changes);
    throw;
  }
  s.pausing = false;
  if (still.empty()) return;
  try {
    RUBBLE_CORE::putWorlds(tables(), parts_, changes);
  } catch (const std::bad_alloc&) {
    putWithoutContacts(tables(), parts_, changes);
    throw LostPausedContacts();
  }
  arrays_.follow();
}

std::function<void()> CpuEngine::prepareToPut(std::span<const int> worlds,
                                              std::span<const std::span<const std::byte>> states) {
  std::vector<WorldChange> changes;
  for (std::size_t k = 0; k < worlds.size(); ++k) changes.push_back({worlds[k], states[k]});
  return [this, prepared = std::make_shared<WorldsToPut>(tables(), parts_, changes)] {
    prepared->put();
    arrays_.follow();
  };
}

std::function<void()> CpuEngine::backup() {
  const SolverData& s = tables().view();
  struct Backup {
    std::vector<std::byte> state;
    std::vector<int> worldOfBody;
    std::vector<ExcludedPair> excluded;  // saved states have no worlds of them
    std::vector<WorldSettings> worlds;
    std::vector<WorldPart> parts;
    int bodies;
  };
  auto kept = std::make_shared<Backup>(Backup{saveTables(tables()), copyOf(s.worldOfBody, s.bodies),
                                              excludedPairs(s), worlds_, parts_, s.bodies});
  return [this, kept] {
    tables().view().bodies = kept->bodies;  // also where the attempt has made them fewer
    reloadTables(tables(), kept->state);
    std::ranges::copy(kept->worldOfBody, &tables().view().worldOfBody[0]);
    clearExclusions(tables(), static_cast<int>(kept->excluded.size()));
    for (const ExcludedPair& pair : kept->excluded)
      setExcluded(tables(), pair.low, pair.high, true, nullptr, pair.world);
    worlds_.swap(kept->worlds), parts_.swap(kept->parts);
    arrays_.follow();
  };
}

}  // namespace rubble::RUBBLE_CORE

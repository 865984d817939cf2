// Many worlds in the tables of a host engine.
#include "backend/cpu/cpu_engine.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

void CpuEngine::setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) {
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
  s.pausing = !still.empty();
  try {
    step(report);
  } catch (...) {
    s.pausing = false;
    throw;
  }
  s.pausing = false;
  if (!still.empty()) putWorlds(still, std::vector<std::span<const std::byte>>(states.begin(), states.end()));
}

void CpuEngine::putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) {
  std::vector<WorldChange> changes;
  for (std::size_t k = 0; k < worlds.size(); ++k) changes.push_back({worlds[k], states[k]});
  RUBBLE_CORE::putWorlds(tables(), parts_, changes);
  arrays_.follow();
}

}  // namespace rubble::RUBBLE_CORE

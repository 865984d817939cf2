// Many worlds in the tables of a device.
#include <algorithm>

#include "backend/cuda/cuda_engine.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

void CudaEngine::setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) {
  queries_.moved();
  mirror_.fetchAll();
  parts_ = placeWorlds(host(), worlds, spare);
  worlds_.resize(worlds.size());
  settingsChanged_ = true;
  mirror_.allWritten();
}

void CudaEngine::setSettings(int world, const WorldSettings& settings) {
  worlds_[static_cast<std::size_t>(world)] = settings;
  host().view().step[world].gravity = Vec3(settings.gravity);
  changedWorlds_.push_back(world);
}

void CudaEngine::endStepOfWorlds() {
  const SolverData& s = host().view();
  for (std::size_t w = 0; w < worlds_.size(); ++w) {
    WorldSettings& own = worlds_[w];
    if ((s.pausing && s.paused[w] != 0) || (!own.wakeAll && own.previousDt == previousDt_)) continue;
    own.previousDt = previousDt_, own.wakeAll = false;
    changedWorlds_.push_back(static_cast<int>(w));
  }
}

void CudaEngine::stepWorlds(StepReport& report, std::span<const char> paused) {
  const SolverData& s = host().view();
  bool any = false, changed = false;
  for (std::size_t w = 0; w < worlds_.size(); ++w) {
    const int now = !paused.empty() && paused[w] != 0;
    any |= now != 0, changed |= s.paused[w] != now;
    s.paused[w] = now;
  }
  if (changed) mirror_.pausedWritten();
  // once set it stays, so that a mask changes no captured step
  hasPaused_ |= any;
  // an Error leaves it unset, too
  struct Pausing {
    bool& flag;
    ~Pausing() { flag = false; }
  } const pausing{host().view().pausing = hasPaused_};
  const StreamOrder::Writing writing(mirror_.order());
  if (any)
    stepOthers(report);
  else
    step(report);
}

/// A step skips most of the work for paused worlds. Afterwards their states are put back.
void CudaEngine::stepOthers(StepReport& report) {
  SolverData& s = host().view();
  if (s.vertices == 0) {
    mirror_.keepWorlds();
    step(report);
    mirror_.putBackPaused();
    return;
  }
  mirror_.fetchAll();
  std::vector<int> still;
  std::vector<std::vector<std::byte>> states;
  for (int w = 0; w < s.worlds; ++w)
    if (s.paused[w] != 0)
      still.push_back(w),
          states.push_back(RUBBLE_CORE::takeWorld(host(), parts_[static_cast<std::size_t>(w)]));
  step(report);
  putWorlds(still, std::vector<std::span<const std::byte>>(states.begin(), states.end()));
}

const TableReader& CudaEngine::readWorld(int world) {
  const WorldPart& part = parts_[static_cast<std::size_t>(world)];
  mirror_.fetchWorld(world, part);
  return worldReader_.emplace(host(), &part);
}

std::vector<std::byte> CudaEngine::takeWorld(int world) {
  const WorldPart& part = parts_[static_cast<std::size_t>(world)];
  mirror_.fetchWorld(world, part);
  return RUBBLE_CORE::takeWorld(host(), part);
}

void CudaEngine::putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) {
  queries_.moved();
  std::vector<WorldChange> changes;
  for (std::size_t k = 0; k < worlds.size(); ++k) changes.push_back({worlds[k], states[k]});
  if (host().view().vertices > 0) {
    mirror_.fetchAll();
    RUBBLE_CORE::putWorlds(host(), parts_, changes);
    mirror_.allWritten();
    countBodies();
    return;
  }
  const StreamOrder::Writing writing(mirror_.order());
  mirror_.flush();
  const auto countAll = [&](int change) {
    for (const int world : worlds) {
      const WorldPart& part = parts_[static_cast<std::size_t>(world)];
      for (int slot = part.firstBody; slot < part.firstBody + part.bodies; ++slot) count(slot, change);
    }
  };
  countAll(-1);
  const BodyContacts contacts = putElements(host(), parts_, changes);
  countAll(1);
  mirror_.worldsWritten(parts_, changes, contacts);
}

}  // namespace rubble::RUBBLE_CORE

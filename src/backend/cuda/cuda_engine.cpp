#include "backend/cuda/cuda_engine.h"

#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <numeric>

#include "backend/cpu/cpu_engine.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

/// Recomputes the constants of the step only if they may differ.
void CudaEngine::prepareConstants() {
  SolverData& s = host().view();
  if (settingsChanged_ || preparedFor_ != previousDt_) {
    const Counters last = *s.counters;
    beginStep(s, settings_, previousDt_);
    *s.counters = last;
    settingsChanged_ = false;
    preparedFor_ = previousDt_;
    changedWorlds_.resize(std::max<std::size_t>(1, worlds_.size()));
    std::iota(changedWorlds_.begin(), changedWorlds_.end(), 0);
  }
  if (changedWorlds_.empty()) return;
  for (const int w : changedWorlds_)
    if (!worlds_.empty()) setConstants(s, settings_, w, worlds_[static_cast<std::size_t>(w)]);
  mirror_.constantsWritten(changedWorlds_);
  changedWorlds_.clear();
}

void CudaEngine::step(StepReport& report) {
  queries_.moved();
  const StreamOrder::Writing writing(mirror_.order());
  nvtxRangePushA("rubble step");
  host().trees.update(host(), mirror_.treeChanges());
  host().view().bodiesMove = dynamicCount_ > 0;
  host().view().fixedOrder |= divided_, host().view().searchesAlways |= divided_;
  for (int k = 0; k < settings_.params.substeps; ++k) {
    prepareConstants();
    mirror_.flush();
    mirror_.stepped(stepper_.step(host().view(), report));
    noteSubstep(*host().view().counters, report);
    host().view().rolledBefore = host().view().rolls;
    previousDt_ = settings_.params.dt / settings_.params.substeps;
    endStepOfWorlds();
  }
  mirror_.endForces();
  mirror_.followArrays();
  settingsChanged_ |= std::exchange(settings_.wakeAll, false);
  nvtxRangePop();

  SolverData counts = host().view();
  counts.bodies = 0;
  reportCounters(counts, report);
  report.bodies = bodyCount_;
}

const HostTables& CudaEngine::tablesNow() {
  const DeviceTables& tables = stepper_.tables();
  const SolverData& device = tables.view();
  const auto room = [&](int k) { return tables.capacity(static_cast<Per>(k)); };
  bool fit = seen_ != nullptr;
  for (int k = 0; k < kPerCount; ++k) fit = fit && seen_->capacity(static_cast<Per>(k)) == room(k);
  if (!fit) {
    // made anew: tables that have room grow by half more than they are asked to, beyond those of the device
    seen_ = std::make_unique<HostTables>();
    for (int k = 0; k < kPerCount; ++k) seen_->reserve(static_cast<Per>(k), room(k));
  }
  seenRows_.resize(static_cast<std::size_t>(tables.capacity(Per::Manifold)));
  SolverData& to = seen_->view();
  to = onDevice(device, to);
  const auto copy = [](void* here, const void* there, std::size_t bytes) {
    checkCuda(cudaMemcpy(here, there, bytes, cudaMemcpyDeviceToHost), "cudaMemcpy of tables");
  };
  copy(to.counters, device.counters, sizeof(Counters));
  std::size_t number = 0;
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    // rows have memory of their own here
    if constexpr (std::is_same_v<T, ContactRows>) to.contact = seenRows_.data();
    copy(to.*array.member, device.*array.member, sizeof(T) * seenMost_.of(*seen_, array, number++));
  });
  return *seen_;
}

void CudaEngine::sortBodies() {
  queries_.moved();
  const StreamOrder::Writing writing(mirror_.order());
  prepareConstants();
  mirror_.flush();
  stepper_.sortBodies(host().view(), mirror_.oldPairs());
  mirror_.bodiesSorted();
}

void CudaEngine::write(const SetBody& e) {
  if (e.keepsState) mirror_.fetchAll();  // the upload holds the state too
  const int before = host().view().bodies;
  setBodyCount(host(), e.id + 1);
  mirror_.bodiesAdded(before);
  const int slot = slotOf(host(), e.id);
  count(slot, -1);
  (e.keepsState ? setBodyParams : setBody)(host(), slot, e.body);
  if (e.number >= 0) host().view().idOf[slot] = e.number, host().view().worldOfBody[slot] = e.world;
  count(slot, 1);
  e.keepsState ? mirror_.bodyParamsWritten(slot) : mirror_.bodyWritten(slot);
}

std::shared_ptr<const EngineSnapshot> CudaEngine::snapshot() {
  if (host().view().vertices == 0 && !divided_) return mirror_.snapshot(previousDt_);
  mirror_.fetchAll();
  return std::make_shared<SavedState>(saveState(host(), previousDt_));
}

void CudaEngine::restore(const EngineSnapshot& snapshot) {
  queries_.moved();
  const auto* const own = dynamic_cast<const DeviceSnapshot*>(&snapshot);
  if (own) {
    if (host().view().vertices > 0) write(SetDeformables{});
    mirror_.restore(*own);
    previousDt_ = own->previousDt;
  } else {
    loadState(host(), previousDt_, snapshot.bytes());
    mirror_.allWritten();
  }
  countBodies();
}

std::unique_ptr<Engine> makeCudaEngine(const CudaOptions& options) {
  return std::make_unique<CudaEngine>(options);
}

}  // namespace rubble::RUBBLE_CORE

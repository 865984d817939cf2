#include "backend/cpu/cpu_engine.h"

#include "stages/pairs/order.h"
#include "tables/table_check.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

void beginStep(SolverData& s, const EngineSettings& settings, double previousDt) {
  *s.counters = {};
  s.plan = stepPlan(settings.params);
  *s.step = stepConstants(settings.params, settings.gravity, previousDt);
  s.step->wakeAll = settings.wakeAll;
}

void noteSubstep(const Counters& c, StepReport& report) {
  const auto raise = [](auto& most, auto value) { most = std::max(most, value); };
  report.brokenJoints += c.broken;
  report.quarantined += c.quarantined;
  report.failedSolves += c.failedSolves;
  report.boundedSteps += c.boundedSteps;
  report.surfaceTests += static_cast<std::int64_t>(c.nearFeatures) * (1 + c.crossingRounds);
  raise(report.surfaceRounds, c.crossingRounds);
  raise(report.deflectedVertices, c.deflected);
  raise(report.heldVertices, c.held);
  raise(report.stoppedBodies, c.stopped);
  raise(report.spinLimited, c.spinLimited);
  raise(report.colorRounds, c.rounds);
  raise(report.clashes, c.clashes);
  raise(report.unfinishedMotion, static_cast<double>(fromFloatBits(c.unfinished)));
}

void reportCounters(const SolverData& s, StepReport& report) {
  const Counters& c = *s.counters;
  for (int i = 0; i < s.bodies; ++i) report.bodies += s.params[i].kind != BodyKind::Removed;
  report.pairs = c.pairs;
  report.manifolds = c.manifolds;
  report.contacts = c.contacts;
  report.vertices = s.vertices;
  report.vertexContacts = c.pointContacts;
  report.recycled = c.recycled;
  report.colors = c.colors;
  report.sleepingBodies = c.asleep;
  report.unsettledImpacts = c.bouncesLeft;
}

void planTrees(HostTables& tables) {
  TreeChanges changes;
  tables.trees.update(tables, changes);
}

void CpuEngine::step(StepReport& report) {
  try {
    takeStep(report);
  } catch (const std::bad_alloc&) {
    abandonStep(tables());
    executor_.takeTimes(), executor_.takeGrown();
    throw;
  }
}

void CpuEngine::beginStep() {
  SolverData& s = executor_.view();
  RUBBLE_CORE::beginStep(s, settings_, previousDt_);
  for (std::size_t w = 0; w < worlds_.size(); ++w)
    setConstants(s, settings_, static_cast<int>(w), worlds_[w]);
}

/// Steps by a variant of the core in float, where one is given (CpuOptions).
template <class Executor> static void stepBy(void (*variant)(f32::CpuExecutor&), Executor& executor) {
  if constexpr (std::is_same_v<Executor, f32::CpuExecutor>)
    if (variant) return variant(executor);
  rubble::RUBBLE_CORE::step(executor);
}

void CpuEngine::takeStep(StepReport& report) {
  SolverData& s = executor_.view();
  planTrees(tables());
  executor_.run([&] {
    for (int k = 0; k < settings_.params.substeps; ++k) {
      beginStep();
      stepBy(variant_, executor_);
      noteSubstep(*s.counters, report);
      s.rolledBefore = s.rolls;
      previousDt_ = settings_.params.dt / settings_.params.substeps;
      for (std::size_t w = 0; w < worlds_.size(); ++w)
        if (!s.pausing || s.paused[w] == 0) worlds_[w].previousDt = previousDt_, worlds_[w].wakeAll = false;
    }
  });
  endForces(tables());
  settings_.wakeAll = false;
  reportCounters(s, report);
  RUBBLE_ASSERT_NONE(firstViolation(tables(), !divided_));
  report.stages = executor_.takeTimes();
  report.grown = executor_.takeGrown();
  arrays_.follow();
}

void sortBodiesOf(CpuExecutor& executor) {
  const SolverData& s = executor.view();
  executor.run([&] { rubble::RUBBLE_CORE::sortBodies(executor, s.oldPairOffset[s.bodies]); });
  executor.endRooms();
  executor.view().ordered = inOtherOrder(executor.view());
  executor.tables().trees.touchAll();
}

std::vector<std::byte> saveState(const HostTables& tables, double previousDt) {
  std::vector<std::byte> out = saveTables(tables);
  const auto* dt = reinterpret_cast<const std::byte*>(&previousDt);
  out.insert(out.end(), dt, dt + sizeof previousDt);
  return out;
}

void loadState(HostTables& tables, double& previousDt, std::span<const std::byte> data) {
  loadTables(tables, data.first(data.size() - sizeof previousDt));
  std::memcpy(&previousDt, data.data() + data.size() - sizeof previousDt, sizeof previousDt);
}

std::uint64_t tableLayout() {
  std::string text;
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (isKept(array.life)) text += std::string(array.name) + " " + std::to_string(sizeof(T)) + ",";
  });
  return hashOf(std::as_bytes(std::span(text)));
}

std::unique_ptr<Engine> makeCpuEngine(const CpuOptions& options) {
  return std::make_unique<CpuEngine>(options);
}

}  // namespace rubble::RUBBLE_CORE

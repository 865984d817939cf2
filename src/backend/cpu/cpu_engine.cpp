#include "backend/cpu/cpu_engine.h"

namespace rubble::RUBBLE_CORE {

void beginStep(View& s, const EngineSettings& settings, double previousDt) {
  *s.counters = {};
  s.step = stepConstants(settings.params, settings.gravity, settings.maxMassLength, previousDt);
  // cells as wide as a typical body's bounding sphere is high: it shares its level however it turns
  s.baseCell = static_cast<Real>(settings.typicalRadius * 1.1) / kLevelFill;
}

void reportCounters(const View& s, StepReport& report) {
  const Counters& c = *s.counters;
  for (int i = 0; i < s.bodies; ++i) report.bodies += s.params[i].kind != BodyKind::Removed;
  report.pairs = c.pairs;
  report.manifolds = c.manifolds;
  report.contacts = c.contacts;
  report.recycled = c.recycled;
  report.colors = c.colors;
  report.colorRounds = c.rounds;
  report.clashes = c.clashes;
  report.brokenJoints = c.broken;
  report.quarantined = c.quarantined;
  report.spinLimited = c.spinLimited;
}

void CpuEngine::addForce(int slot, const rubble::Vec3& force, const rubble::Vec3& torque) {
  const View& s = executor_.view();
  s.force[slot] += Vec3(force);
  s.torque[slot] += Vec3(torque);
}

void CpuEngine::step(StepReport& report) {
  View& s = executor_.view();
  executor_.run([&] {
    for (int k = 0; k < settings_.params.substeps; ++k) {
      beginStep(s, settings_, previousDt_);
      rubble::RUBBLE_CORE::step(executor_);
      previousDt_ = settings_.params.dt / settings_.params.substeps;
    }
  });
  reportCounters(s, report);
  report.stages = executor_.takeTimes();
}

std::vector<std::byte> CpuEngine::save() const {
  std::vector<std::byte> out = saveTables(tables());
  const auto* dt = reinterpret_cast<const std::byte*>(&previousDt_);
  out.insert(out.end(), dt, dt + sizeof previousDt_);
  return out;
}

void CpuEngine::load(std::span<const std::byte> data) {
  loadTables(executor_.tables(), data.first(data.size() - sizeof previousDt_));
  std::memcpy(&previousDt_, data.data() + data.size() - sizeof previousDt_, sizeof previousDt_);
}

std::unique_ptr<Engine> makeCpuEngine(int threads) { return std::make_unique<CpuEngine>(threads); }

}  // namespace rubble::RUBBLE_CORE

#include "backend/distributed/rank_engine.h"

#include <chrono>

namespace rubble::RUBBLE_CORE {

void RankEngine::step(StepReport& report) {
  using Clock = std::chrono::steady_clock;
  guarded([&] {
    const Transport::Traffic before = transport_->traffic();
    const auto begin = Clock::now();
    cpu_.step(report);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    const Transport::Traffic now = transport_->traffic();
    RankReport own;
    own.exchangeMs = now.ms - before.ms;
    own.ownMs = ms - own.exchangeMs;
    own.bytes = now.bytes - before.bytes, own.messages = now.messages - before.messages;
    own.memoryBytes = static_cast<std::int64_t>(cpu_.memoryBytes());
    report.ranks = RankCourier(*transport_).gatherValue(own);
    for (std::size_t r = 0; r < report.ranks.size(); ++r) {
      const RankReport& counts = division_.reports()[r];
      RankReport& to = report.ranks[r];
      to.bodies = counts.bodies, to.ghosts = counts.ghosts;
      to.rows = counts.rows, to.migrated = counts.migrated;
    }
  });
}

}  // namespace rubble::RUBBLE_CORE

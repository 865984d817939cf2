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
    RankReport own = division_.reports()[static_cast<std::size_t>(rank())];
    own.exchangeMs = now.ms - before.ms;
    own.ownMs = ms - own.exchangeMs;
    own.bytes = now.bytes - before.bytes, own.messages = now.messages - before.messages;
    own.memoryBytes = static_cast<std::int64_t>(cpu_.memoryBytes());
    report.ranks = RankCourier(*transport_).gatherValue(own);
  });
}

}  // namespace rubble::RUBBLE_CORE

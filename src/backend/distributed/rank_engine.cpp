#include "backend/distributed/rank_engine.h"

#include <chrono>

#include "backend/cpu/cpu_engine.h"
#include "backend/distributed/peer_division.h"
#include "backend/distributed/rank_division.h"

namespace rubble::RUBBLE_CORE {

namespace {

class CpuRank final : public DividedEngine {
 public:
  CpuRank(Transport& transport, const RankOptions& options, const CpuOptions& cpu) : cpu_(cpu) {
    if (options.exchange == RankExchange::Messages)
      division_ = std::make_unique<RankDivision>(cpu_.tables(), transport, options, cpu_.threads());
    else
      division_ = std::make_unique<PeerDivision>(cpu_.tables(), transport, options, cpu_.threads());
    cpu_.divide(division_.get());
  }
  ObservableEngine& engine() override { return cpu_; }
  void gatherState() override {
    cpu_.run([&] { division_->gatherState(); });
  }
  void sortWhole() override {
    cpu_.divide(nullptr);
    cpu_.sortBodies();
    cpu_.divide(division_.get());
    restart();
  }
  void restart() override { division_->restart(); }
  std::vector<RankReport> reports() const override { return division_->reports(); }

 private:
  CpuEngine cpu_;
  std::unique_ptr<WorldDivision> division_;
};

}  // namespace

std::unique_ptr<DividedEngine> makeCpuRank(Transport& transport, const RankOptions& options,
                                           const CpuOptions& cpu) {
  return std::make_unique<CpuRank>(transport, options, cpu);
}

void RankEngine::step(StepReport& report) {
  using Clock = std::chrono::steady_clock;
  guarded([&] {
    const Transport::Traffic before = transport_->traffic();
    const auto begin = Clock::now();
    own().step(report);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    const Transport::Traffic now = transport_->traffic();
    RankReport part = divided_->reports()[static_cast<std::size_t>(rank())];
    part.exchangeMs = now.ms - before.ms;
    part.ownMs = ms - part.exchangeMs;
    part.bytes = now.bytes - before.bytes, part.messages = now.messages - before.messages;
    part.memoryBytes = static_cast<std::int64_t>(own().memoryBytes());
    report.ranks = RankCourier(*transport_).gatherValue(part);
  });
}

}  // namespace rubble::RUBBLE_CORE

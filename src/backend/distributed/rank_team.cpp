#include "backend/distributed/rank_team.h"

#include <rubble/info.h>

#include "backend/cuda_team.h"
#include "backend/distributed/rank_processes.h"

#include <thread>

namespace rubble::RUBBLE_CORE {

namespace {

int threadsOfRank(int threads, int ranks) {
  const int all = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, all / ranks);
}

}  // namespace

RankTeam::RankTeam(const RankOptions& options, const Maker& make) : hub_(options.count, options.timeout) {
  ranks_.resize(static_cast<std::size_t>(options.count));
  std::vector<std::jthread> threads;
  for (int r = 0; r < options.count; ++r)
    threads.emplace_back([&, r] {
      std::unique_ptr<Transport> transport = hub_.join(r);
      try {
        Transport& end = *transport;
        ranks_[static_cast<std::size_t>(r)] = std::make_unique<RankEngine>(std::move(transport), make(end));
      } catch (const std::exception& error) {
        hub_.join(r)->fail(error.what());
      }
    });
  threads.clear();
  requireWhole();
}

RankTeam::RankTeam(const RankOptions& options, int threads, bool timings)
    : RankTeam(options, [&](Transport& transport) {
        return makeCpuRank(transport, options, threadsOfRank(threads, options.count),
                           timings && transport.rank() == 0);
      }) {}

void RankTeam::requireWhole() const {
  if (const std::string failure = hub_.failure(); !failure.empty()) throw RankFailure(failure);
}

void RankTeam::together(const std::function<void(RankEngine&)>& f) {
  requireWhole();
  const auto run = [&](RankEngine& rank) {
    try {
      callOf(rank, f);
    } catch (const std::exception& error) {
      rank.fail(error.what());  // unless another one failed first
    } catch (...) {
      rank.fail("an unknown error");
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t r = 1; r < ranks_.size(); ++r) others.emplace_back([&, r] { run(*ranks_[r]); });
  run(*ranks_.front());
  others.clear();
  requireWhole();
}

void RankTeam::step(StepReport& report) {
  whole_ = false;
  std::vector<StepReport> reports(ranks_.size(), report);
  together([&](RankEngine& rank) { rank.step(reports[static_cast<std::size_t>(rank.rank())]); });
  report = std::move(reports.front());
}

std::unique_ptr<Engine> makeDistributedEngine(const RankOptions& ranks, int threads, bool timings) {
  if (!ranks.devices.empty()) {
    if (!cudaReady()) throw Error("ranks.devices", "a machine and a build with CUDA", cudaStatus());
    return makeCudaTeam(ranks, timings);
  }
  if (const RankProcesses& processes = rankProcesses(); ranks.count == 0 && processes.transport) {
    std::unique_ptr<Transport> transport = processes.transport(ranks.timeout);
    std::unique_ptr<DividedEngine> divided = makeCpuRank(*transport, ranks, threads, timings);
    return std::make_unique<RankEngine>(std::move(transport), std::move(divided));
  }
  RankOptions options = ranks;
  options.count = std::max(1, options.count);
  return std::make_unique<RankTeam>(options, threads, timings);
}

}  // namespace rubble::RUBBLE_CORE

#include "backend/distributed/rank_team.h"

#include "backend/distributed/rank_processes.h"

#include <thread>

namespace rubble::RUBBLE_CORE {

namespace {

int threadsOfRank(int threads, int ranks) {
  const int all = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, all / ranks);
}

}  // namespace

RankTeam::RankTeam(const RankOptions& options, int threads, bool timings)
    : hub_(options.count, options.timeout) {
  for (int r = 0; r < options.count; ++r)
    ranks_.push_back(std::make_unique<RankEngine>(hub_.join(r), options,
                                                  threadsOfRank(threads, options.count), timings && r == 0));
}

void RankTeam::requireWhole() const {
  if (const std::string failure = hub_.failure(); !failure.empty()) throw RankFailure(failure);
}

void RankTeam::together(const std::function<void(RankEngine&)>& f) {
  requireWhole();
  const auto run = [&](RankEngine& rank) {
    try {
      f(rank);
    } catch (const std::exception& error) {
      rank.fail(error.what());  // unless another one failed first
    } catch (...) {
      rank.fail("an unknown error");
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t r = 1; r < ranks_.size(); ++r) others.emplace_back([&, r] { run(*ranks_[r]); });
  run(first());
  others.clear();
  requireWhole();
}

void RankTeam::step(StepReport& report) {
  std::vector<StepReport> reports(ranks_.size(), report);
  together([&](RankEngine& rank) { rank.step(reports[static_cast<std::size_t>(rank.rank())]); });
  report = std::move(reports.front());
}

std::unique_ptr<Engine> makeDistributedEngine(const RankOptions& ranks, int threads, bool timings) {
  if (const RankProcesses& processes = rankProcesses(); ranks.count == 0 && processes.transport)
    return std::make_unique<RankEngine>(processes.transport(ranks.timeout), ranks, threads, timings);
  RankOptions options = ranks;
  options.count = std::max(1, options.count);
  return std::make_unique<RankTeam>(options, threads, timings);
}

}  // namespace rubble::RUBBLE_CORE

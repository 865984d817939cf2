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

RankThreads::RankThreads(int ranks) {
  for (int r = 1; r < ranks; ++r) threads_.emplace_back([this, r] { work(r); });
}

RankThreads::~RankThreads() {
  {
    const std::lock_guard lock(mutex_);
    stops_ = true;
  }
  begins_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void RankThreads::run(const std::function<void(int)>& task) {
  {
    const std::lock_guard lock(mutex_);
    task_ = &task, ++runs_, left_ = static_cast<int>(threads_.size());
  }
  begins_.notify_all();
  task(0);
  std::unique_lock lock(mutex_);
  ends_.wait(lock, [this] { return left_ == 0; });
}

void RankThreads::work(int rank) {
  for (unsigned done = 0;; ++done) {
    std::unique_lock lock(mutex_);
    begins_.wait(lock, [&] { return stops_ || runs_ != done; });
    if (stops_) return;
    lock.unlock();
    (*task_)(rank);
    lock.lock();
    if (--left_ == 0) ends_.notify_one();
  }
}

RankTeam::RankTeam(const RankOptions& options, const Maker& make)
    : hub_(options.count, options.timeout), threads_(options.count) {
  ranks_.resize(static_cast<std::size_t>(options.count));
  threads_.run([&](int r) {
    std::unique_ptr<Transport> transport = hub_.join(r);
    try {
      Transport& end = *transport;
      ranks_[static_cast<std::size_t>(r)] = std::make_unique<RankEngine>(std::move(transport), make(end));
    } catch (const std::exception& error) {
      hub_.join(r)->fail(error.what());
    }
  });
  requireWhole();
}

RankTeam::RankTeam(const RankOptions& options, const CpuOptions& cpu)
    : RankTeam(options, [&](Transport& transport) {
        return makeCpuRank(transport, options,
                           {.threads = threadsOfRank(cpu.threads, options.count),
                            .timings = cpu.timings && transport.rank() == 0,
                            .variant = cpu.variant});
      }) {}

void RankTeam::requireWhole() const {
  if (const std::string failure = hub_.failure(); !failure.empty()) throw RankFailure(failure);
}

void RankTeam::together(const std::function<void(RankEngine&)>& f) {
  requireWhole();
  threads_.run([&](int r) {
    RankEngine& own = rank(r);
    try {
      callOf(own, f);
    } catch (const std::exception& error) {
      own.fail(error.what());  // unless another one failed first
    } catch (...) {
      own.fail("an unknown error");
    }
  });
  requireWhole();
}

void RankTeam::step(StepReport& report) {
  whole_ = edited_ = false;
  std::vector<StepReport> reports(ranks_.size(), report);
  together([&](RankEngine& rank) { rank.step(reports[static_cast<std::size_t>(rank.rank())]); });
  report = std::move(reports.front());
}

std::unique_ptr<Engine> makeDistributedEngine(const RankOptions& ranks, const CpuOptions& cpu) {
  const RankProcesses processes = rankProcesses();
  if (!ranks.devices.empty()) {
    if (!cudaReady()) throw Error("ranks.devices", "a machine and a build with CUDA", cudaStatus());
    if (!processes.transport) return makeCudaTeam(ranks, cpu.timings);
    if (ranks.devices.size() > 1)
      throw Error("ranks.devices", "one GPU in each of several processes",
                  std::to_string(ranks.devices.size()));
    return makeCudaRank(processes.transport(ranks.timeout), ranks, cpu.timings);
  }
  if (ranks.count == 0 && processes.transport) {
    if (ranks.exchange == RankExchange::Stores || ranks.exchange == RankExchange::StoresInTurns)
      throw Error("ranks.exchange", "messages or letters between processes", "stores");
    std::unique_ptr<Transport> transport = processes.transport(ranks.timeout);
    std::unique_ptr<DividedEngine> divided = makeCpuRank(*transport, ranks, cpu);
    return std::make_unique<RankEngine>(std::move(transport), std::move(divided));
  }
  RankOptions options = ranks;
  options.count = std::max(1, options.count);
  return std::make_unique<RankTeam>(options, cpu);
}

}  // namespace rubble::RUBBLE_CORE

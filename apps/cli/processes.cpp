#include "apps/cli/processes.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <rubble/ranks.h>
#include <rubble/socket_ranks.h>

#include "apps/cli/system.h"
#include "backend/distributed/rank_processes.h"
#include "platform/system.h"

#if RUBBLE_HAS_MPI
#include <rubble/mpi.h>
#else
namespace rubble {
class MpiRanks {};
}  // namespace rubble
#endif

namespace rubble::cli {

namespace {

int processRank = 0, processCount = 1;
/// Where processes other than the first write; empty: not made yet.
std::filesystem::path aside;

}  // namespace

Processes::Processes() = default;
Processes::~Processes() {
  std::error_code ignored;
  if (!aside.empty()) std::filesystem::remove_all(aside, ignored);
}

bool Processes::isFirst() { return processRank == 0; }

int Processes::localRank() {
  if (processCount == 1) return -1;
  for (const char* name : {"LOCAL_RANK", "OMPI_COMM_WORLD_LOCAL_RANK", "MPI_LOCALRANKID", "SLURM_LOCALID"})
    if (const char* const value = std::getenv(name)) return std::atoi(value);
  return processRank;
}

int Processes::threads() {
  const char* const count = processCount > 1 ? std::getenv("LOCAL_WORLD_SIZE") : nullptr;
  return count ? std::max(1, threadCount(0) / std::max(1, std::atoi(count))) : 0;
}

void Processes::join() {
#if RUBBLE_HAS_MPI
  if (MpiRanks::launched()) {
    mpi_ = std::make_unique<MpiRanks>();
    processRank = mpi_->rank(), processCount = mpi_->count();
  }
#endif
  if (!mpi_ && SocketRanks::launched()) {
    sockets_ = std::make_unique<SocketRanks>();
    processRank = sockets_->rank(), processCount = sockets_->count();
  }
  if (processRank > 0 && !std::freopen(platform::kNullFile, "w", stdout)) processRank = 0;
}
void Processes::fail([[maybe_unused]] const std::string& why) {
#if RUBBLE_HAS_MPI
  if (mpi_ && mpi_->count() > 1) mpi_->abort(why);
#endif
}

std::unique_ptr<Transport> Processes::transport() {
  const RankProcesses processes = rankProcesses();
  return processes.transport ? processes.transport(RankOptions().timeout) : nullptr;
}

std::string outputOfProcess(const std::string& file) {
  if (file.empty() || file == "-" || Processes::isFirst()) return file;
  const std::filesystem::path path(file);
  if (aside.empty()) {
    aside = std::filesystem::temp_directory_path() /
            ("rubble-" + std::to_string(std::random_device{}()) + "-rank-" + std::to_string(processRank));
    std::filesystem::create_directories(aside);
  }
  return (aside / path.filename()).string();
}

}  // namespace rubble::cli

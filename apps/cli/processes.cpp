#include "apps/cli/processes.h"

#include <cstdio>
#include <filesystem>
#include <random>

#include <rubble/socket_ranks.h>

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

int processRank = 0;
/// Where processes other than the first write; empty: not made yet.
std::filesystem::path aside;

}  // namespace

Processes::Processes() = default;
Processes::~Processes() {
  std::error_code ignored;
  if (!aside.empty()) std::filesystem::remove_all(aside, ignored);
}

bool Processes::isFirst() { return processRank == 0; }

void Processes::join() {
#if RUBBLE_HAS_MPI
  if (MpiRanks::launched()) {
    mpi_ = std::make_unique<MpiRanks>();
    processRank = mpi_->rank();
  }
#endif
  if (!mpi_ && SocketRanks::launched()) {
    sockets_ = std::make_unique<SocketRanks>();
    processRank = sockets_->rank();
  }
  if (processRank > 0 && !std::freopen(platform::kNullFile, "w", stdout)) processRank = 0;
}
void Processes::fail([[maybe_unused]] const std::string& why) {
#if RUBBLE_HAS_MPI
  if (mpi_ && mpi_->count() > 1) mpi_->abort(why);
#endif
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

#include "apps/cli/processes.h"

#include <cstdio>
#include <filesystem>
#include <random>

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

#if RUBBLE_HAS_MPI
void Processes::join() {
  if (!MpiRanks::launched()) return;
  ranks_ = std::make_unique<MpiRanks>();
  processRank = ranks_->rank();
  if (processRank > 0 && !std::freopen(platform::kNullFile, "w", stdout)) processRank = 0;
}
void Processes::fail(const std::string& why) {
  if (ranks_ && ranks_->count() > 1) ranks_->abort(why);
}
#else
void Processes::join() {}
void Processes::fail(const std::string&) {}
#endif

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

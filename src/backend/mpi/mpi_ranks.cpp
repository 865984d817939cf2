#include <rubble/mpi.h>

#define OMPI_SKIP_MPICXX 1  // the C interface alone
#include <mpi.h>

#include <chrono>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "backend/distributed/rank_processes.h"

namespace rubble {

namespace {

[[noreturn]] void abortAll(int rank, const std::string& why) {
  std::fprintf(stderr, "rubble: rank %d failed: %s\n", rank, why.c_str());
  std::fflush(stderr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

/// Messages of one world, apart from those of others.
class MpiTransport final : public Transport {
 public:
  explicit MpiTransport(double timeout) : timeout_(timeout) {
    MPI_Comm_dup(MPI_COMM_WORLD, &comm_);
    MPI_Comm_rank(comm_, &rank_), MPI_Comm_size(comm_, &ranks_);
  }
  ~MpiTransport() override { MPI_Comm_free(&comm_); }

  int rank() const override { return rank_; }
  int ranks() const override { return ranks_; }
  /// A process that others wait for cannot leave without them: all end.
  void fail(const std::string& why) noexcept override { abortAll(rank_, why); }

 private:
  void swap(std::span<const Send> sends, std::span<const Receive> receives) override {
    requests_.clear(), peers_.clear();
    // messages longer than an int counts go in several
    const auto parts = [&](int peer, std::size_t bytes, auto&& post) {
      for (std::size_t at = 0; at < bytes; at += kMost) {
        requests_.emplace_back(), peers_.push_back(peer);
        post(at, static_cast<int>(std::min(kMost, bytes - at)));
      }
    };
    for (const Receive& r : receives)
      parts(r.from, r.bytes.size(), [&](std::size_t at, int count) {
        MPI_Irecv(r.bytes.data() + at, count, MPI_BYTE, r.from, 0, comm_, &requests_.back());
      });
    for (const Send& s : sends)
      parts(s.to, s.bytes.size(), [&](std::size_t at, int count) {
        MPI_Isend(s.bytes.data() + at, count, MPI_BYTE, s.to, 0, comm_, &requests_.back());
      });
    wait();
  }

  void swapAll(std::span<const std::byte> own, std::span<std::byte> all,
               std::span<const std::size_t> sizes) override {
    if (all.size() > kMost) return Transport::swapAll(own, all, sizes);
    std::vector<int> counts(sizes.begin(), sizes.end()), at(sizes.size(), 0);
    for (std::size_t r = 1; r < at.size(); ++r) at[r] = at[r - 1] + counts[r - 1];
    requests_.resize(1), peers_.assign(1, -1);
    MPI_Iallgatherv(own.data(), static_cast<int>(own.size()), MPI_BYTE, all.data(), counts.data(), at.data(),
                    MPI_BYTE, comm_, &requests_[0]);
    wait();
  }

  void wait() {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(timeout_);
    for (int tries = 0;; ++tries) {
      int done = 0;
      MPI_Testall(static_cast<int>(requests_.size()), requests_.data(), &done, MPI_STATUSES_IGNORE);
      if (done) return;
      if (tries < kSpins) continue;
      // the other process may need this core
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      if (Clock::now() > end) throw RankFailure(silent());
    }
  }
  std::string silent() const {
    for (std::size_t k = 0; k < requests_.size(); ++k)
      if (requests_[k] != MPI_REQUEST_NULL && peers_[k] >= 0)
        return "rank " + std::to_string(peers_[k]) + " does not answer";
    return "a rank does not answer";
  }

  static constexpr std::size_t kMost = INT_MAX;
  static constexpr int kSpins = 1000;
  double timeout_;
  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, ranks_ = 1;
  std::vector<MPI_Request> requests_;
  std::vector<int> peers_;  ///< of each request; -1: all
};

}  // namespace

bool MpiRanks::launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
    if (std::getenv(name)) return true;
  return false;
}

MpiRanks::MpiRanks() {
  requireNoProcesses();
  int level = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level) != MPI_SUCCESS)
    throw Error("MPI cannot be initialized");
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_), MPI_Comm_size(MPI_COMM_WORLD, &count_);
  joinProcesses({count_, [](double timeout) { return std::make_unique<MpiTransport>(timeout); }});
}

MpiRanks::~MpiRanks() {
  leaveProcesses();
  MPI_Finalize();
}

void MpiRanks::abort(const std::string& why) { abortAll(rank_, why); }

}  // namespace rubble

#pragma once
/// Ranks: threads or processes that share one world (backend "distributed").
#include <algorithm>
#include <cstdint>
#include <vector>

namespace rubble {

/// How ranks exchange poses, sums and rows.
enum class RankExchange {
  Messages,
  Stores,         ///< into one another's memory; ranks are threads of this process
  StoresInTurns,  ///< the same, one rank at a time, in an order that changes: finds reads that come too late
  Letters         ///< the same stores, sent as letters: ranks need not reach one another's memory
};

/// How a world is divided among ranks. Results do not depend on it.
struct RankOptions {
  /// Ranks as threads of this process. 0: the processes that mpirun started, or one rank.
  int count = 0;
  /// Steps after which bodies are divided anew. 0: when the costs of ranks differ by more than maxImbalance.
  int cutInterval = 0;
  /// Largest cost of a rank over the mean of all, less 1, above which bodies are divided anew [1].
  double maxImbalance = .15;
  RankExchange exchange = RankExchange::Messages;
  /// GPUs of this process that step the world together, one rank each; one that is named twice has two ranks.
  /// `count` does not matter then, and they store into one another's memory unless `exchange` is Letters. Of
  /// several processes each names one GPU, counted round those that it sees, and letters go between them.
  /// Empty: ranks are on the CPU.
  std::vector<int> devices = {};
  /// Letters between GPUs go through NCCL, if its library is found and each rank has a GPU of its own. Else
  /// they go through the host.
  bool nccl = true;
  /// Longest wait for another rank; then the step throws Error [s].
  double timeout = 60;
};

/// What a step cost one rank.
struct RankReport {
  double ownMs = 0;              ///< time of the step without exchanges [ms]
  double exchangeMs = 0;         ///< time in exchanges, waiting included [ms]
  std::int64_t bytes = 0;        ///< sent
  std::int64_t messages = 0;     ///< sent
  int bodies = 0;                ///< dynamic bodies that the rank solves
  int ghosts = 0;                ///< bodies of other ranks whose poses it receives
  int rows = 0;                  ///< contact manifolds that it evaluates
  int migrated = 0;              ///< pairs and joints whose state it received from an earlier owner
  std::int64_t memoryBytes = 0;  ///< tables, as reserved [bytes]
};

/// Largest cost of a rank over the mean, less 1 [1]. The cost is the number of its bodies and rows.
inline double imbalanceOf(const std::vector<RankReport>& ranks) {
  double most = 0, sum = 0;
  for (const RankReport& rank : ranks) {
    const double cost = static_cast<double>(rank.bodies) + static_cast<double>(rank.rows);
    most = std::max(most, cost), sum += cost;
  }
  return sum > 0 ? most * static_cast<double>(ranks.size()) / sum - 1 : 0;
}

}  // namespace rubble

#pragma once
/// Worlds shared by processes that mpirun started. Link rubble::mpi.
#include <string>

namespace rubble {

/// MPI for the time of its life. While it exists, a World with the backend "distributed" and ranks.count 0 is
/// shared by all processes, which make the same calls in the same order.
class MpiRanks {
 public:
  /// Did mpirun start this process?
  static bool launched();

  /// Initializes MPI. Throws Error if that fails.
  MpiRanks();
  /// Waits for all processes and ends MPI.
  ~MpiRanks();
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  /// Ends all processes after an error in this one. `why` is written to standard error.
  [[noreturn]] void abort(const std::string& why);

 private:
  int rank_ = 0, count_ = 1;
};

}  // namespace rubble

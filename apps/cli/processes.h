#pragma once
/// The processes of one run. Under mpirun all run the same command; the first one prints and writes files.
#include <memory>
#include <string>

namespace rubble {
class MpiRanks;
}

namespace rubble::cli {

class Processes {
 public:
  Processes();
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  /// Joins the processes that mpirun started with this one, if it did. All but the first lose their standard
  /// output. Throws Error if that fails.
  void join();
  /// Ends all other processes, and this one, if there are others.
  void fail(const std::string& why);
  /// Is this the process that prints and writes files?
  static bool isFirst();

 private:
  std::unique_ptr<MpiRanks> ranks_;
};

/// The file itself in the first process. In the others, which compute the same, a file that nobody keeps.
std::string outputOfProcess(const std::string& file);

}  // namespace rubble::cli

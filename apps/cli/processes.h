#pragma once
/// The processes of one run. Under mpirun, torchrun and the like all run the same command; the first one
/// prints and writes files.
#include <memory>
#include <string>

namespace rubble {
class MpiRanks;
class SocketRanks;
class Transport;
}  // namespace rubble

namespace rubble::cli {

class Processes {
 public:
  Processes();
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  /// Joins the processes that were started with this one, by mpirun or with the variables of SocketRanks. All
  /// but the first lose their standard output. Throws Error if that fails.
  void join();
  /// Ends all other processes of MPI, and this one. Those that are connected by sockets learn of its end.
  void fail(const std::string& why);
  /// Is this the process that prints and writes files?
  static bool isFirst();
  /// Number of this process on its host, as what started it says; -1: it is the only one.
  static int localRank();
  /// Threads of this process in place of 0: its share of the cores, where torchrun has started several on
  /// this host. mpirun binds processes to cores instead. 0: all that it may run on.
  static int threads();
  /// The end of this process in an exchange with the others, who make the same call; null: it is the only
  /// one.
  static std::unique_ptr<Transport> transport();

 private:
  std::unique_ptr<MpiRanks> mpi_;
  std::unique_ptr<SocketRanks> sockets_;
};

/// The file itself in the first process. In the others, which compute the same, a file that nobody keeps.
std::string outputOfProcess(const std::string& file);

}  // namespace rubble::cli

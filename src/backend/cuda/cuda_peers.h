#pragma once
/// The part of one GPU in a world that several GPUs step together (backend/peers/). Each has an engine, and a
/// host thread or a process. This header is plain host code; device code is behind it.
#include <memory>
#include <vector>

#include <rubble/ranks.h>

#include "backend/cuda/device_memory.h"
#include "backend/distributed/transport.h"
#include "backend/division.h"
#include "backend/peers/peer_kernels.h"

namespace rubble::RUBBLE_CORE {

class KernelLauncher;
struct Count;

class CudaPeers {
 public:
  /// The transport carries addresses between the host threads. It must outlive this object.
  CudaPeers(DeviceTables& tables, cudaStream_t stream, Transport& transport, const RankOptions& options);
  ~CudaPeers();

  // On the host, between steps and when a step stops.
  /// Reserves as many elements as the tables have.
  void reserve();
  /// Exchanges the addresses of all tables. All ranks call it after tables may have grown. `place`: of the
  /// addresses on the device: the parity of a step, and kBetweenSteps more between steps.
  void meet(int place);
  static constexpr int kBetweenSteps = 2, kPlaces = 4;
  /// Waits for all ranks, each of which calls it when its kernels have ended. Before that others may still
  /// read and store here.
  void awaitAll();
  /// Every kernel of a step has run.
  void hasStepped() { isLoaded_ = true; }
  /// For a step that has stopped for something that is not a table: makes room for letters. Throws
  /// RankFailure if a device did not answer. Returns what there is more room for, or null: it is a table.
  const char* makeRoom(int lacking, int needed);
  /// Waits for the end of the work under way.
  void await();
  /// May steps be captured in graphs?
  bool captured() const;
  /// Changes whenever a captured step would not be the same any more.
  int version() const;
  /// The tables were replaced or sorted. All ranks have the whole state.
  void restart();
  std::vector<RankReport> reports() const;
  std::size_t bytes() const;

  // In the order of the stream: operations of a step.
  void use(KernelLauncher& launcher) { launcher_ = &launcher; }
  /// A walk through the step begins.
  void begin();
  void share(Share what, int which = 0);
  /// What ranks see, once per step.
  void plan();
  /// Trees of other ranks count as converged.
  void closeOtherTrees();
  /// Before the first color of a sweep. `limit`: colors that are launched.
  void beginColors(int limit);
  /// Stores the poses of one color.
  void shareColor(int color);
  /// Between steps, after meet(): gives the state of all pairs and joints to all ranks.
  void gatherState();
  /// Returns whether all ranks have that state.
  bool holdsAll() const { return holdsAll_; }

  const PeerData& data() const { return data_; }
  /// A list: its elements and, in device memory, their number.
  const int* elements(PeerList list) const { return data_.list[static_cast<int>(list)]; }
  const int* countOf(PeerList list) const { return data_.listed + static_cast<int>(list); }
  /// Lists near active pairs, once per step.
  void listActivePairs();

  // The machine of peer_phases.h.
  static constexpr bool kCountsNear = true;
  /// Not where they post letters: for want of room these kernels may run again.
  bool storesAtOnce() const { return data_.box == nullptr; }
  /// run(kernel), which also stores what it computes if that is possible.
  template <class Stores, class Kernel, class Run> void withStores(const Kernel& kernel, Run&& run) const {
    if (storesAtOnce())
      run(Storing<Kernel, Stores>{kernel, Stores{{{data_}}}});
    else
      run(kernel);
  }
  const SolverData& tables() const { return tables_.view(); }
  template <class Kernel> void each(const Kernel& kernel, int n);
  template <class Kernel> void each(const Kernel& kernel, int Counters::*n);
  template <class Kernel> void eachOld(const Kernel& kernel);
  template <class Kernel> void eachOf(PeerList list, const Kernel& kernel);
  template <class Test> void select(PeerList list, const Test& test, int n);
  template <class Test> void select(PeerList list, const Test& test, int Counters::*n);
  template <class Test> void selectOld(PeerList list, const Test& test);
  template <class Test> void selectOf(PeerList list, PeerList from, const Test& test);
  void join(PeerList list, PeerList more);
  void barrier();
  void barrierIf(int Counters::*counter);

 private:
  struct Impl;
  Count countedList(PeerList list) const;
  Count oldPairs() const;
  template <class Test> void launchSelect(PeerList list, const Test& test, const Count& n, int most);
  void meetIf(const int* condition);
  template <class Launch> void launchBarrier(Launch&& launch);
  template <class Kernel> bool beginsKernel();
  void enterExchange(Share what, int which);
  void exchangeLetters();
  int mostOf(PeerList list) const;

  DeviceTables& tables_;
  cudaStream_t stream_;
  KernelLauncher* launcher_ = nullptr;
  PeerData data_;
  std::unique_ptr<Impl> impl_;
  bool planned_ = false, activeListed_ = false, summed_ = false, holdsAll_ = true;
  bool isLoaded_ = false;  ///< kernels of a step are on the device
  int exchange_ = 0;       ///< kind of the present exchange
  int firstPost_ = -1;     ///< operation that first posted letters since the last exchange; -1: none
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Launches the operations of a step that order, count and list elements.
#include <cub/device/device_radix_sort.cuh>

#include <algorithm>
#include <bit>

#include "backend/cuda/kernel_launcher.cuh"
#include "backend/cuda/long_list_kernels.cuh"
#include "backend/cuda/scan_kernel.cuh"

namespace rubble::RUBBLE_CORE {

class ScanLauncher : protected KernelLauncher {
 protected:
  ScanLauncher(DeviceTables& tables, cudaStream_t stream, int processors)
      : KernelLauncher(tables, stream, processors) {}

  std::size_t scratchBytes() const {
    return scratch_.size() + sortedKeys_.size() + indices_.size() + cleared_.size();
  }
  void beginOperations(const EnqueueOptions& options = {}) {
    KernelLauncher::beginOperations(options);
    tiles_ = 0;
  }
  /// Notes the sizes of all operations from now on.
  void beginSizes() { grouped_ = keyBits_ = 0; }
  /// Allocates scratch memory for operations of these sizes.
  void reserveSizes() {
    std::size_t sortBytes = 0;
    if (grouped_ > 0) sortPairs(nullptr, sortBytes, nullptr, nullptr, grouped_, keyBits_);
    scratch_.reserve(sortBytes);
    sortedKeys_.reserve(sizeof(int) * static_cast<std::size_t>(grouped_));
    indices_.reserve(sizeof(int) * static_cast<std::size_t>(grouped_));
    reserveCleared(sizeof(ScanWord) * static_cast<std::size_t>(tiles_));
  }

  void clear(Array<int> SolverData::*array, int n) {
    if (begins() && n > 0) clearNext(view().*array, nullptr, n);
  }
  void clear(Array<int> SolverData::*array, int Counters::*n) {
    if (begins()) clearNext(view().*array, counter(n), capacityOf(n));
  }

  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int n) {
    scanTo(countsAt(counts, n), view().*offsets);
  }
  /// Offsets beyond the last element also receive the total.
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int Counters::*n) {
    scanTo(countsAt(counts, n), view().*offsets);
  }
  template <class N>
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, N n, int Counters::*total,
            Per per) {
    count(total, per);
    scanTo(countsAt(counts, n), view().*offsets, [&] { return RoomCheck{counter(total), roomFor(per)}; });
  }

  /// A stable sort. Skipped keys come after the last valid one.
  void groupByKey(const char* stage, Array<int> SolverData::*keys, int n, Array<int> SolverData::*offsets,
                  Array<int> SolverData::*order, int Counters::*keyCount) {
    // one more value than keys distinguishes them from -1
    const int keyBits = std::bit_width(static_cast<unsigned>(capacityOf(keyCount)));
    grouped_ = std::max(grouped_, n), keyBits_ = std::max(keyBits_, keyBits);
    if (!begins()) return;
    enterStage(stage);
    if (n > 0) {
      beside_ = true;  // nothing else uses them
      launch(WriteIndices{reinterpret_cast<int*>(indices_.data()), view().nodes()}, {n, nullptr}, n,
             "indices");
      beside_ = false;
      std::size_t bytes = scratch_.size();
      sortPairs(scratch_.data(), bytes, view().*keys, view().*order, n, keyBits);
      afterKernel_ = false;
    }
    launch(FindFirst{reinterpret_cast<const int*>(sortedKeys_.data()), n, view().*offsets},
           {1, counter(keyCount)}, capacityOf(keyCount) + 1, "offsets");
  }

  void require(Per per, int Counters::*c) {
    count(c, per);
    if (begins()) checkNext({counter(c), roomFor(per)});
  }

  LongList listOf(const DeviceBuffer& list) const {
    int* const first = reinterpret_cast<int*>(list.data());
    return {first, first + 1};
  }
  void startList(const DeviceBuffer& list) {
    if (begins()) clearNext(listOf(list).count, nullptr, 1);
  }
  /// Reserves space for all elements that can have more than `parts` parts.
  static void reserveList(DeviceBuffer& list, int most, int parts) {
    list.reserve(sizeof(int) * (2 + static_cast<std::size_t>(most / parts)));
  }

  Room roomFor(Per per) const { return {static_cast<int>(per), tables_.capacity(per), operation()}; }
  int limitOf(int n) const { return n; }
  int limitOf(int Counters::*n) const { return capacityOf(n); }

 private:
  CountAt countsAt(Array<int> SolverData::*counts, int n) const { return {view().*counts, nullptr, n, n}; }
  CountAt countsAt(Array<int> SolverData::*counts, int Counters::*n) const {
    return {view().*counts, counter(n), 0, capacityOf(n)};
  }

  static RoomCheck noTotal() { return {}; }
  /// Each scan of a step has tiles of its own, for they are cleared once. Without a total it takes over the
  /// check of room that precedes it.
  template <class Total = RoomCheck (*)()>
  void scanTo(const CountAt& in, int* offsets, const Total& total = noTotal) {
    const int first = tiles_, count = scanTilesFor(in.limit);
    tiles_ += count;
    if (!begins()) return;
    if (kFirstCleared + sizeof(ScanWord) * static_cast<std::size_t>(tiles_) > clearedBytes_)
      throw std::logic_error("CudaExecutor: a scan for which there is no scratch memory");
    ScanWord* const tiles = reinterpret_cast<ScanWord*>(cleared_.data() + kFirstCleared) + first;
    RoomCheck check = total();
    const bool stores = check.counter != nullptr;
    if (!stores && clears_.count == 0) check = std::exchange(check_, {});
    launchNext(scanCounts, {count, kScanThreads}, "scan", in, offsets, tiles, check, stores, control_);
  }

  void sortPairs(void* scratch, std::size_t& bytes, const int* keys, int* order, int n, int keyBits) const {
    checkCuda(cub::DeviceRadixSort::SortPairs(scratch, bytes, reinterpret_cast<const unsigned*>(keys),
                                              reinterpret_cast<unsigned*>(sortedKeys_.data()),
                                              reinterpret_cast<const int*>(indices_.data()), order, n, 0,
                                              keyBits, stream_),
              "sort");
  }

  DeviceBuffer scratch_, sortedKeys_, indices_;
  int grouped_ = 0, keyBits_ = 0;  ///< of the largest groupByKey() of this step [elements, bits]
  int tiles_ = 0;                  ///< of all scans of this step so far
  static_assert(kFirstCleared % alignof(ScanWord) == 0);
};

}  // namespace rubble::RUBBLE_CORE

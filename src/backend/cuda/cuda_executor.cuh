#pragma once
/// The executor for CUDA: the step as kernels of one stream. Every call enqueues work and returns. Counts
/// stay on the device.
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include <algorithm>
#include <bit>
#include <limits>

#include "backend/cuda/aggregate_kernels.cuh"
#include "backend/cuda/cluster_kernels.cuh"
#include "backend/cuda/color_kernels.cuh"
#include "backend/cuda/contact_kernels.cuh"
#include "backend/cuda/kernel_launcher.cuh"
#include "backend/cuda/pair_kernels.cuh"
#include "backend/cuda/point_kernels.cuh"
#include "backend/cuda/strand_kernels.cuh"
#include "backend/cuda/strict_kernels.cuh"
#include "backend/cuda/tree_kernels.cuh"

namespace rubble::RUBBLE_CORE {

class CudaExecutor : private KernelLauncher {
 public:
  using Lane = Real;
  /// As in CpuExecutor: a guard that is not reached by a proper coloring.
  static constexpr int kMaxRounds = 10000;

  CudaExecutor(DeviceTables& tables, cudaStream_t stream) : KernelLauncher(tables, stream) {
    std::fill(std::begin(perOf_), std::end(perOf_), -1);
    // subsets of pairs and active pairs: no capacity of their own
    perOf_[indexOf(&Counters::newPairs)] = static_cast<int>(Per::Pair);
    perOf_[indexOf(&Counters::tested)] = static_cast<int>(Per::ActivePair);
  }
  CudaExecutor(const CudaExecutor&) = delete;
  CudaExecutor& operator=(const CudaExecutor&) = delete;

  const Control* control() const { return control_; }
  /// Returns whether the number of elements of this kind is counted on the device.
  bool counted(Per per) const {
    return std::find(std::begin(perOf_), std::end(perOf_), static_cast<int>(per)) != std::end(perOf_);
  }
  std::size_t scratchBytes() const {
    return scratch_.size() + sortedKeys_.size() + indices_.size() + tickets_.size() + highDegree_.size() +
           longSlices_.size();
  }

  /// Allocates scratch memory for the scans and sorts of a step, which must not allocate.
  void reserveScratch() {
    scanned_ = grouped_ = 0;
    EnqueueOptions nothing;
    nothing.from = std::numeric_limits<int>::max();
    if (walk(nothing)) tables_.swapManifolds();
    std::size_t scanBytes = 0, sortBytes = 0;
    exclusiveSum(nullptr, scanBytes, CountAt{}, nullptr, scanned_ + 1);
    if (grouped_ > 0) sortPairs(nullptr, sortBytes, nullptr, nullptr, grouped_);
    scratch_.reserve(std::max(scanBytes, sortBytes));
    sortedKeys_.reserve(sizeof(int) * static_cast<std::size_t>(grouped_));
    indices_.reserve(sizeof(int) * static_cast<std::size_t>(grouped_));
    tickets_.reserve(sizeof(int) * static_cast<std::size_t>(tables_.capacity(Per::Slice)) * kSumLevels);
    colorBins_.reserve(sizeof(int) * 2 * kColorBins);
    reserveList(highDegree_, tables_.capacity(Per::Incidence), kLongIncidences);
    reserveList(longSlices_, tables_.capacity(Per::Boundary), kLongRounds * kSmallWidth / kLanes);
  }

  /// Enqueues the step from an operation on, and performs swapManifolds of the tables on the host. Returns
  /// whether that was called.
  bool enqueue(const EnqueueOptions& options) {
    if (options.from == 0)
      checkCuda(cudaMemsetAsync(view().counters, 0, sizeof(Counters), stream_), "cudaMemsetAsync");
    checkCuda(cudaMemsetAsync(control_, 0, sizeof(Control), stream_), "cudaMemsetAsync");
    return walk(options);
  }

  // Executor interface.
  using KernelLauncher::observe;
  using KernelLauncher::view;

  template <class Kernel, class N> void forEach(const Kernel& kernel, N n) {
    announce(Kernel::kStage, kernelName<Kernel>());
    run(kernel, n);
  }
  template <class Kernel> void forEachIn(const Kernel& kernel, Array<int> SolverData::*offsets, int k) {
    announce(Kernel::kStage, kernelName<Kernel>());
    runIn(kernel, offsets, k);
  }

  /// Launches its kernel when the previous one has started. The kernel waits for the previous one at its end.
  template <class Kernel, class N> void beside(const Kernel& kernel, N n) {
    beside_ = true;
    forEach(kernel, n);
    beside_ = false;
  }

  template <class Kernel> void run(const Kernel& kernel, int n) {
    if (!begins() || n <= 0) return;
    enterStage(Kernel::kStage);
    launch(onDevice(kernel), {n, nullptr}, n, Kernel::kStage);
  }
  template <class Kernel> void run(const Kernel& kernel, int Counters::*n) {
    if (!begins()) return;
    enterStage(Kernel::kStage);
    launch(onDevice(kernel), {0, counter(n)}, capacityOf(n), Kernel::kStage);
  }

  /// Grid size for a range whose length is known on the device only. It assumes ranges that hold one element
  /// per few nodes. Kernels accept any grid size.
  int blocksForRange(int width) const {
    constexpr int kMembersPerElement = 16;
    return blocksFor(view().nodes() / kMembersPerElement + 1, width);
  }
  template <class Kernel> void runIn(const Kernel& kernel, Array<int> SolverData::*offsets, int k) {
    if (!begins()) return;
    enterStage(Kernel::kStage);
    using Type = DeviceKernel<Kernel>;
    launchNext(runRange<Type>, {blocksForRange(widthOf<Type>()), kThreads}, Kernel::kStage, view(),
               onDevice(kernel), view().*offsets, k, Gate{control_});
  }
  /// Fused kernels: the last tile that sums a slice continues with the next stage of its aggregate.
  void run(const SumInertia& kernel, int Counters::*n) {
    if constexpr (kStrict)
      run<SumInertia>(kernel, n);
    else
      run(SumInertiaByTile{tree()}, n);
  }
  void run(const PlaceAggregates& kernel, int Counters::*n) {
    if constexpr (kStrict) run<PlaceAggregates>(kernel, n);
  }
  void runIn(const SumSlice<Real>& kernel, Array<int> SolverData::*offsets, int level) {
    if constexpr (kStrict)
      runIn<SumSlice<Real>>(kernel, offsets, level);
    else if (sliceWidth(view(), level) == kSmallWidth)
      sumLevel<kSmallWidth>(level);
    else
      sumLevel<kWarp>(level);
  }
  template <class Kernel>
  requires(!kStrict &&
           (std::same_as<Kernel, SolveAggregate> ||
            std::same_as<Kernel, WithSoftNodes<SolveAggregate>>)) void runIn(const Kernel&,
                                                                             Array<int> SolverData::*, int) {}
  void runIn(const MoveSlice&, Array<int> SolverData::*, int level) {
    run(MoveNode{level}, view().bodiesMove ? view().bodies : 0);
  }
  void runIn(const WithSoftNodes<SumSlice<Real>>& kernel, Array<int> SolverData::*offsets, int level) {
    if constexpr (kStrict)
      runIn<WithSoftNodes<SumSlice<Real>>>(kernel, offsets, level);
    else
      sumLevel<kWarp>(level, true);
  }
  void runIn(const WithSoftNodes<MoveSlice>&, Array<int> SolverData::*, int level) {
    run(MoveNode{level, true}, view().bodiesMove ? view().bodies : 0);
  }

  void run(const SolveCluster& kernel, int n) {
    if constexpr (kStrict) return run<SolveCluster>(kernel, n);
    // register use limits these kernels to a quarter of the device's threads
    const int lanes = lanesFor<8, 16, kWarp, 128, 512>(n, residentThreads() / 4);
    withLanes<8, 16, kWarp>(lanes, [&]<int kLanes>() { run(SolveClusterByTile<kLanes>{kernel.level}, n); });
    withLanes<128, 512>(lanes, [&]<int kLanes>() { solveFewClusters<kLanes>(kernel.level, n); });
  }

  void run(const SumSoftNodePart& kernel, int n) {
    if constexpr (kStrict)
      run<SumSoftNodePart>(kernel, n);
    else if (view().features > 0 || view().fixedOrder)
      run(SumSoftNodePartByTile<true>{kernel}, n);
    else
      run(SumSoftNodePartByTile<false>{kernel}, n);
  }
  /// One thread per particle. One block or warp per object, depending on their number.
  void run(const SumSoftNode& kernel, int n) {
    if constexpr (kStrict) return run<SumSoftNode>(kernel, n);
    if (!begins() || n <= 0) return;
    enterStage(SumSoftNode::kStage);
    const int objects = view().objects;
    if (objects > 0)
      withLanes<kWarp, 256>(lanesFor<kWarp, 256>(objects, residentThreads()), [&]<int kLanes>() {
        launchNext(sumSoftNodes<kLanes>, {objects, kLanes}, SumSoftNode::kStage, view(), kernel.level,
                   Gate{control_});
      });
    if (n > objects)
      launch(SumParticle{kernel, objects}, {n - objects, nullptr}, n - objects, SumSoftNode::kStage);
  }

  void run(const SolveTree& kernel, int n) {
    if constexpr (kStrict) return run<SolveTree>(kernel, n);
    if (!begins() || n <= 0) return;
    enterStage(SolveTree::kStage);
    launchNext(solveTrees, {n, kTreeThreads}, SolveTree::kStage, view(), Gate{control_});
  }

  /// Several lanes share the search of one body where bodies do not fill the device.
  template <template <int> class ByTile, class Search> void search(const Search& kernel, int n) {
    withLanes<1, 2, 8>(lanesFor<1, 2, 8>(n, residentThreads()), [&]<int kLanes>() {
      if constexpr (kLanes == 1)
        run<Search>(kernel, n);
      else
        run(ByTile<kLanes>{}, n);
    });
  }
  void run(const FindNeighbors& kernel, int n) { search<FindNeighborsByTile>(kernel, n); }
  void run(const FindUnpairedImpacts& kernel, int n) { search<FindUnpairedImpactsByTile>(kernel, n); }
  void run(const FindPairs<false>& kernel, int n) { search<FindPairsByTile>(kernel, n); }

  /// Stages in which a few elements have very many parts.
  void run(const WritePairs<false>&, int n) { runByWarp(WritePairsByWarp{}, n); }
  void run(const FindClashes&, int n) { runByWarp(FindClashesByWarp{}, n); }
  void run(const SortIncidences&, int n) {
    startList(highDegree_, SortIncidences::kStage);
    runByWarp(SortIncidencesByWarp{listOf(highDegree_)}, n);
    if (!begun() || n <= 0) return;
    launchNext(sortHighDegree, {processors_, kSortThreads}, SortIncidences::kStage, view(),
               listOf(highDegree_), Gate{control_});
  }
  void run(const FillBoundary& kernel, int Counters::*n) {
    if constexpr (kStrict) return run<FillBoundary>(kernel, n);
    startList(longSlices_, FillBoundary::kStage);
    run(FillBoundaryByTile{listOf(longSlices_)}, n);
  }

  void run(const CountColors&, int n) { countByColor<ColoredBodies>(n); }
  void run(const FillColors&, int n) { launchByColor(fillColors<ColoredBodies>, FillColors::kStage, n); }
  void run(const CountVertexColors&, int n) { countByColor<ColoredVertices>(n); }
  void run(const FillVertexColors&, int n) {
    launchByColor(fillColors<ColoredVertices>, FillVertexColors::kStage, n);
  }

  void clear(Array<int> SolverData::*array, int n) {
    if (begins() && n > 0) launch(FillArray{view().*array, 0}, {n, nullptr}, n, "clear");
  }
  void clear(Array<int> SolverData::*array, int Counters::*n) {
    if (begins()) launch(FillArray{view().*array, 0}, {0, counter(n)}, capacityOf(n), "clear");
  }

  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int n) {
    scanTo({view().*counts, nullptr, n, n}, view().*offsets);
  }
  /// Offsets beyond the last element also receive the total.
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, int Counters::*n) {
    scanTo({view().*counts, counter(n), 0, capacityOf(n)}, view().*offsets);
  }
  template <class N>
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, N n, int Counters::*total,
            Per per) {
    const int limit = limitOf(n);
    scan(counts, offsets, n);
    perOf_[indexOf(total)] = static_cast<int>(per);
    if (!begun()) return;
    launchNext(keepTotal, {1, 1}, "keepTotal", control_, view().*offsets, limit, counter(total),
               roomFor(per));
  }

  /// A stable sort. Skipped keys come after the last valid one.
  void groupByKey(Array<int> SolverData::*keys, int n, Array<int> SolverData::*offsets,
                  Array<int> SolverData::*order, int Counters::*keyCount) {
    grouped_ = std::max(grouped_, n);
    if (!begins()) return;
    if (n > 0) {
      launch(WriteIndices{reinterpret_cast<int*>(indices_.data()), view().nodes()}, {n, nullptr}, n,
             "indices");
      std::size_t bytes = scratch_.size();
      sortPairs(scratch_.data(), bytes, view().*keys, view().*order, n);
      afterKernel_ = false;
    }
    launch(FindFirst{reinterpret_cast<const int*>(sortedKeys_.data()), n, view().*offsets},
           {1, counter(keyCount)}, capacityOf(keyCount) + 1, "offsets");
  }

  void require(Per per, int Counters::*count) {
    perOf_[indexOf(count)] = static_cast<int>(per);
    if (!begins()) return;
    launchNext(requireRoom, {1, 1}, "requireRoom", control_, counter(count), roomFor(per));
  }

  /// A single launch with grid-wide barriers between the kernels.
  template <class Take, class Propose>
  void rounds(const Take& take, const Propose& propose, int Counters::*count, int Counters::*left,
              int Counters::*turn) {
    if (observer_) return roundsOneByOne(take, propose, count, left, turn);
    if (!begins()) return;
    enterStage(Take::kStage);
    cudaLaunchAttribute together{};
    together.id = cudaLaunchAttributeCooperative;
    together.val.cooperative = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(static_cast<unsigned>(processors_));
    config.blockDim = dim3(kRoundThreads);
    config.stream = stream_;
    config.attrs = &together;
    config.numAttrs = 1;
    const int* const n = counter(count);
    checkCuda(cudaLaunchKernelEx(&config, runRounds<Take, Propose>, view(), take, InBatches<Propose>{propose},
                                 n, counter(left), counter(turn), kMaxRounds, Gate{control_}),
              "rounds");
    afterKernel_ = false;
  }

  /// The same from the host, so that each kernel is announced. It counts as one operation, as above: a step
  /// that stops later is resumed by number.
  template <class Take, class Propose>
  void roundsOneByOne(const Take& take, const Propose& propose, int Counters::*count, int Counters::*left,
                      int Counters::*turn) {
    if (!begins()) return;
    const int next = operation_;
    Counters c;
    const auto copy = [&](void* to, const void* from, cudaMemcpyKind kind) {
      checkCuda(cudaMemcpyAsync(to, from, sizeof(int), kind, stream_), "cudaMemcpyAsync");
      checkCuda(cudaStreamSynchronize(stream_), "rounds");
      afterKernel_ = false;
    };
    while (true) {
      copy(&(c.*count), counter(count), cudaMemcpyDeviceToHost);
      copy(&(c.*left), counter(left), cudaMemcpyDeviceToHost);
      copy(&(c.*turn), counter(turn), cudaMemcpyDeviceToHost);
      operation_ = next;
      if (c.*left == 0 || c.*turn >= kMaxRounds) return;
      forEach(take, c.*count);
      c.*left = 0, ++(c.*turn);
      copy(counter(left), &(c.*left), cudaMemcpyHostToDevice);
      copy(counter(turn), &(c.*turn), cudaMemcpyHostToDevice);
      forEach(propose, c.*count);
    }
  }

  /// One launch for each of the first colors, and one for all others.
  void forEachColor(const SolveBody<Real>&, const SolveVertex&) {
    announce(SolveBody<Real>::kStage, kernelName<SolveBody<Real>>());
    if (!begins() || view().bodies + view().vertices == 0) return;
    enterStage(SolveBody<Real>::kStage);
    if constexpr (kStrict) {
      for (int c = 0; c < options_.colors; ++c) {
        launchNext(solveColorStrictly, {blocksFor(std::max(view().bodies, view().vertices)), kThreads},
                   SolveBody<Real>::kStage, view(), c, control_);
      }
      launchNext(solveTailStrictly, {1, kThreads}, SolveBody<Real>::kStage, view(), options_.colors,
                 control_);
      return;
    }
    // as many blocks as are resident at once, whatever the size of the color
    const bool bodies = view().bodies > 0 && (view().bodiesMove || view().fixedOrder);
    const int held = kSolveBlocks * processors_;
    const int vertexBlocks = std::min((view().vertices * kVertexLanes + kSolveThreads - 1) / kSolveThreads,
                                      held / kVertexShare);
    const int bodyBlocks = std::min((view().bodies + kTailBodies - 1) / kTailBodies, held - vertexBlocks);
    // A color starts while the previous one is being solved and reads ahead what no sweep writes. The first
    // one starts after everything else has ended.
    afterKernel_ = false;
    for (int c = 0; c < options_.colors; ++c) {
      if (bodies)
        solveColorsFrom(c, kHighDegreeBlocks + vertexBlocks + bodyBlocks, {kHighDegreeBlocks, vertexBlocks});
      else if (view().vertices > 0)
        launchNext(
            solveVertexColor,
            {std::min(blocksFor(view().vertices, kVertexLanes), kVertexBlocks * processors_), kThreads},
            SolveVertex::kStage, view(), c, SolveThreads::of(view(), processors_).vertices, control_);
    }
    solveColorsFrom(options_.colors, 1, {0, 0});
  }

  /// Begins work between steps, whose kernels belong to no graph and no stage.
  void beginWork() {
    checkCuda(cudaMemsetAsync(control_, 0, sizeof(Control), stream_), "cudaMemsetAsync");
    options_ = {};
    operation_ = 0;
    stage_ = nullptr;
    kept_ = afterKernel_ = false;
  }
  void endWork() { enterStage(nullptr); }
  /// Other work was enqueued after the last kernel of this executor.
  void interrupted() { afterKernel_ = false; }

  void aliasRows() { tables_.aliasRows(); }

  void swapManifolds() {
    tables_.swapManifolds();
    kept_ = !kept_;
  }

 private:
  bool walk(const EnqueueOptions& options) {
    options_ = options;
    operation_ = 0;
    stage_ = nullptr;
    kept_ = afterKernel_ = false;
    step(*this);
    enterStage(nullptr);
    return kept_;
  }

  /// With null scratch memory it only computes the number of bytes needed.
  void exclusiveSum(void* scratch, std::size_t& bytes, const CountAt& in, int* out, int n) const {
    const auto counts = thrust::make_transform_iterator(thrust::make_counting_iterator(0), in);
    checkCuda(cub::DeviceScan::ExclusiveSum(scratch, bytes, counts, out, n, stream_), "scan");
  }

  void sortPairs(void* scratch, std::size_t& bytes, const int* keys, int* order, int n) const {
    // keys are fewer than n: these bits distinguish them from -1
    const int bits = std::bit_width(static_cast<unsigned>(n));
    checkCuda(cub::DeviceRadixSort::SortPairs(scratch, bytes, reinterpret_cast<const unsigned*>(keys),
                                              reinterpret_cast<unsigned*>(sortedKeys_.data()),
                                              reinterpret_cast<const int*>(indices_.data()), order, n, 0,
                                              bits, stream_),
              "sort");
  }

  void scanTo(const CountAt& in, int* offsets) {
    scanned_ = std::max(scanned_, in.limit);
    if (!begins()) return;
    // one element more than counts: the total follows the last one
    std::size_t bytes = scratch_.size();
    exclusiveSum(scratch_.data(), bytes, in, offsets, in.limit + 1);
    afterKernel_ = false;
  }

  template <class Kernel> void launchByColor(Kernel* kernel, const char* name, int n) {
    if (!begins() || n <= 0) return;
    enterStage(name);
    launchNext(kernel, {(n + kColorNodes - 1) / kColorNodes, kThreads}, name, view(), colorBins(),
               Gate{control_});
  }
  template <class Nodes> void countByColor(int n) {
    if (begins())
      launch(FillArray{colorBins().population, 0}, {2 * kColorBins, nullptr}, 2 * kColorBins, "clear");
    launchByColor(countColors<Nodes>, CountColors::kStage, n);
  }

  template <int kBlockThreads> void solveFewClusters(int level, int n) {
    if (!begins() || n <= 0) return;
    enterStage(SolveCluster::kStage);
    launchNext(solveClusters<kBlockThreads>, {n, kBlockThreads}, SolveCluster::kStage, view(), level,
               Gate{control_});
  }

  template <int kTile> void sumLevel(int level, bool softOnly = false) {
    if (!begins()) return;
    enterStage(SumSlice<Real>::kStage);
    launchNext(hasFewJoints(view(), residentThreads()) ? sumSlices<kTile, true> : sumSlices<kTile, false>,
               {processors_ + blocksForRange(kTile), kThreads}, SumSlice<Real>::kStage, view(), tree(),
               listOf(longSlices_), processors_, level, softOnly, Gate{control_});
  }

  void solveColorsFrom(int color, int count, ColorBlocks blocks) {
    launchNext(solveColorsOf(view(), residentThreads()), {count, kSolveThreads}, SolveBody<Real>::kStage,
               view(), color, listOf(highDegree_), blocks, SolveThreads::of(view(), processors_), control_);
  }

  ColorBins colorBins() const {
    int* const first = reinterpret_cast<int*>(colorBins_.data());
    return {first, first + kColorBins};
  }
  LongList listOf(const DeviceBuffer& list) const {
    int* const first = reinterpret_cast<int*>(list.data());
    return {first, first + 1};
  }
  void startList(const DeviceBuffer& list, const char* stage) {
    if (!begins()) return;
    enterStage(stage);
    launch(FillArray{listOf(list).count, 0}, {1, nullptr}, 1, "clear");
  }
  /// One warp per kWarp of n bodies.
  template <class Kernel> void runByWarp(const Kernel& kernel, int n) { run(kernel, warpsFor(n)); }
  /// Reserves space for all elements that can have more than `parts` parts.
  static void reserveList(DeviceBuffer& list, int most, int parts) {
    list.reserve(sizeof(int) * (2 + static_cast<std::size_t>(most / parts)));
  }

  SumTree tree() const { return {reinterpret_cast<int*>(tickets_.data()), tables_.capacity(Per::Slice)}; }
  Room roomFor(Per per) const { return {static_cast<int>(per), tables_.capacity(per), operation()}; }
  int limitOf(int n) const { return n; }
  int limitOf(int Counters::*n) const { return capacityOf(n); }

  /// Counters is an array of ints.
  static std::size_t indexOf(int Counters::*c) {
    static const Counters probe{};
    return static_cast<std::size_t>(&(probe.*c) - reinterpret_cast<const int*>(&probe));
  }
  int* counter(int Counters::*c) const { return reinterpret_cast<int*>(view().counters) + indexOf(c); }
  /// Capacity of the kind that this counter counts, as given by require().
  int capacityOf(int Counters::*c) const {
    const int per = perOf_[indexOf(c)];
    if (per < 0) throw std::logic_error("CudaExecutor: a counter is used before the room for it is required");
    return tables_.capacity(static_cast<Per>(per));
  }

  DeviceBuffer scratch_, sortedKeys_, indices_, tickets_, highDegree_, longSlices_, colorBins_;
  /// largest scan and largest groupByKey() of this step, in elements
  int scanned_ = 0, grouped_ = 0;
  int perOf_[sizeof(Counters) / sizeof(int)];
  bool kept_ = false;
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The executor for CUDA: the step as kernels of one stream. Every call enqueues work and returns. Counts
/// stay on the device.
#include <algorithm>

#include "backend/cuda/aggregate_kernels.cuh"
#include "backend/cuda/cluster_kernels.cuh"
#include "backend/cuda/color_kernels.cuh"
#include "backend/cuda/column_kernels.cuh"
#include "backend/cuda/contact_kernels.cuh"
#include "backend/cuda/cuda_peers.h"
#include "backend/cuda/pair_kernels.cuh"
#include "backend/cuda/peer_kernels.cuh"
#include "backend/cuda/point_kernels.cuh"
#include "backend/cuda/scan_launcher.cuh"
#include "backend/cuda/strand_kernels.cuh"
#include "backend/cuda/strict_kernels.cuh"
#include "backend/cuda/tree_kernels.cuh"
#include "backend/cuda/tree_solver.h"

namespace rubble::RUBBLE_CORE {

class CudaExecutor : private ScanLauncher {
 public:
  using Lane = Real;

  /// `processors`: CudaOptions.
  CudaExecutor(DeviceTables& tables, cudaStream_t stream, int processors)
      : ScanLauncher(tables, stream, processors) {
    count(&Counters::newPairs, Per::Pair), count(&Counters::tested, Per::ActivePair);
    bound(&Counters::searched, Per::Body), bound(&Counters::swept, Per::Pair);
    bound(&Counters::sweptPairs, Per::Pair), bound(&Counters::fastBodies, Per::Body);
    bound(&Counters::searchedBodies, Per::Body);
  }
  CudaExecutor(const CudaExecutor&) = delete;
  CudaExecutor& operator=(const CudaExecutor&) = delete;

  /// Divides steps among GPUs; null: this device runs all of a step.
  void divide(CudaPeers* peers) {
    peers_ = peers;
    inOrder_ = peers != nullptr;
    if (peers) peers->use(*this);
  }

  const Controls* controls() const { return reinterpret_cast<const Controls*>(control_); }
  /// Returns whether the number of elements of this kind is counted on the device.
  bool counted(Per per) const { return counted_[static_cast<int>(per)]; }
  std::size_t scratchBytes() const {
    return ScanLauncher::scratchBytes() + tickets_.size() + highDegree_.size() + longSlices_.size();
  }

  /// Allocates scratch memory for the scans and sorts of a step, which must not allocate.
  void reserveScratch() {
    beginSizes();
    if (walk(EnqueueOptions::none())) tables_.swapManifolds();
    reserveSizes();
    tickets_.reserve(sizeof(int) * static_cast<std::size_t>(tables_.capacity(Per::Slice)) * kSumLevels);
    colorBins_.reserve(sizeof(int) * kBins);
    reserveList(highDegree_, tables_.capacity(Per::Incidence), kLongIncidences);
    if (peers_) reserveList(ownHighDegree_, tables_.capacity(Per::Incidence), kLongIncidences);
    reserveList(longSlices_, tables_.capacity(Per::Boundary), kLongRounds * kSmallWidth / kLanes);
  }

  /// Enqueues the step from an operation on, and performs swapManifolds of the tables on the host. Returns
  /// whether that was called.
  bool enqueue(const EnqueueOptions& options) {
    if (options.from == 0)
      checkCuda(cudaMemsetAsync(view().counters, 0, sizeof(Counters), stream_), "cudaMemsetAsync");
    clearControl();
    return walk(options);
  }

  // Executor interface.
  using KernelLauncher::awaitSignal;
  using KernelLauncher::observe;
  using KernelLauncher::signal;
  using KernelLauncher::together;
  using KernelLauncher::view;
  using ScanLauncher::clear;
  using ScanLauncher::groupByKey;
  using ScanLauncher::require;
  template <class N> void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, N n) {
    ScanLauncher::scan(counts, offsets, n);
  }
  template <class N>
  void scan(Array<int> SolverData::*counts, Array<int> SolverData::*offsets, N n, int Counters::*total,
            Per per) {
    if (peers_ && counts == &SolverData::hasRows) peers_->share(Share::Touches);
    ScanLauncher::scan(counts, offsets, n, total, per);
  }

  template <class Kernel, class N> void forEach(const Kernel& kernel, N n) {
    announce(Kernel::kStage, kernelName<Kernel>());
    if constexpr (isDivided<Kernel>())
      if (peers_) return runPart(kernel, n);
    run(kernel, n);
    if constexpr (std::same_as<Kernel, BeginTrees>)
      if (peers_) peers_->plan(), peers_->closeOtherTrees();
  }
  template <class Kernel> void forEachIn(const Kernel& kernel, Array<int> SolverData::*offsets, int k) {
    announce(Kernel::kStage, kernelName<Kernel>());
    if constexpr (isDivided<Kernel>())
      if (peers_) return runLevelPart<Kernel>(k);
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
    else if (view().features > 0 || view().anyKinds)
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
    const TreeLaunch trees = solveTreesWith(n, maxBlocks_ * kThreads);
    launchNext(trees.kernel, {trees.blocks, trees.threads}, SolveTree::kStage, view(), n, Gate{control_});
  }

  /// One block per column assembles and solves it.
  void run(const AssembleColumns<Real>& kernel, int Counters::*n) {
    if constexpr (kStrict) run<AssembleColumns<Real>>(kernel, n);
  }
  void run(const SolveColumns& kernel, int Counters::*n) {
    if constexpr (kStrict) return run<SolveColumns>(kernel, n);
    if (!begins()) return;
    enterStage(SolveColumns::kStage);
    launchNext(solveColumns, {processors_ | 1, kColumnThreads}, SolveColumns::kStage, view(), counter(n),
               Gate{control_});
  }

  void run(const FindNeighbors&, int Counters::*) {
    constexpr int kSearchLanes = 8;  // for each body, if all search
    if (!begins()) return;
    enterStage(FindNeighbors::kStage);
    const int n = view().bodies;
    if (view().worlds > 1)
      launchNext(findNeighborsOfWorlds, {blocksFor(n), kThreads}, FindNeighbors::kStage, view(), n,
                 Gate{control_});
    else
      launchNext(findNeighbors, {blocksFor(n, kSearchLanes), kThreads}, FindNeighbors::kStage, view(),
                 Gate{control_});
  }
  void run(const FindPathNeighbors& kernel, int Counters::*n) {
    withLanes<1, 2, 8>(lanesFor<1, 2, 8>(view().bodies, residentThreads()),
                       [&]<int kLanes>() { run(SearchByTile<FindPathNeighbors, kLanes>{kernel}, n); });
  }
  void run(const AddArcs& kernel, int Counters::*n) { runRarely(kernel, n); }
  void run(const FindImpacts& kernel, int Counters::*n) { runRarely(kernel, n); }
  void run(const FindGeneralImpacts& kernel, int Counters::*n) { runRarely(kernel, n); }
  void run(const FindUnpairedImpacts& kernel, int Counters::*n) {
    runRarely(FindUnpairedImpactsByWarp{kernel}, n);
  }
  /// Where bodies are few, lanes look at their neighbors side by side.
  void run(const FindPairs<false>&, int n) {
    if (!begins() || n <= 0) return;
    enterStage(FindPairs<false>::kStage);
    withLanes<1, 8>(lanesFor<1, 8>(n, residentThreads()), [&]<int kLanes>() {
      launchNext(findPairs<kLanes>, {blocksFor(n, kLanes), kThreads}, FindPairs<false>::kStage, view(), n,
                 Gate{control_});
    });
  }

  /// Stages in which a few elements have very many parts.
  void run(const WritePairs<false>&, int n) { launchWritePairs(n, {}); }
  void run(const AtHome<WritePairs<false>>& kernel, int n) { launchWritePairs(n, kernel.home); }
  void launchWritePairs(int n, const PeerHome& home) {
    if (!begins() || n <= 0) return;
    enterStage(WritePairs<false>::kStage);
    launchNext(writePairs, {blocksFor(n), kThreads}, WritePairs<false>::kStage, view(), n, home,
               Gate{control_});
  }
  void run(const FindClashes&, int n) { runByWarp(FindClashesByWarp{}, n); }
  void run(const SortIncidences&, int n) {
    runByWarp(SortIncidencesByWarp{listOf(highDegree_)}, n);
    if (!begun() || n <= 0) return;
    launchNext(sortHighDegree, {processors_, kSortThreads}, SortIncidences::kStage, view(),
               listOf(highDegree_), Gate{control_});
  }
  void run(const FillBoundary& kernel, int Counters::*n) {
    if constexpr (kStrict) return run<FillBoundary>(kernel, n);
    run(FillBoundaryByTile{listOf(longSlices_)}, n);
  }

  void run(const CountColors&, int n) {
    launchByColor<ColoredBodies>(countColors<ColoredBodies>, CountColors::kStage, n);
  }
  void run(const FillColors&, int n) {
    launchByColor<ColoredBodies>(fillColors<ColoredBodies>, FillColors::kStage, n);
  }
  void run(const CountVertexColors&, int n) {
    launchByColor<ColoredVertices>(countColors<ColoredVertices>, CountColors::kStage, n);
  }
  void run(const FillVertexColors&, int n) {
    launchByColor<ColoredVertices>(fillColors<ColoredVertices>, FillVertexColors::kStage, n);
  }

  /// A single launch with grid-wide barriers between the kernels.
  template <class Take, class... Others>
  void rounds(const Rounds& of, const Take& take, const Others&... others) {
    announce(Take::Kernel::kStage, kernelName<typename Take::Kernel>());
    if (!begins()) return;
    enterStage(Take::Kernel::kStage);
    static_assert(sizeof...(Others) < kMostPhases);
    int phase = 0;
    launchTogether("rounds", runRounds<decltype(onGrid(take)), decltype(onGrid(others))...>, view(),
                   counter(of.left), counter(of.turn), of.most, Gate{control_}, onGrid(take),
                   onGrid(others, ++phase)...);
  }

  /// One launch for each of the first colors, and one for all others.
  void forEachColor(const SolveBody<Real>&, const SolveVertex&) {
    announce(SolveBody<Real>::kStage, kernelName<SolveBody<Real>>());
    if (peers_) peers_->beginColors(options_.colors), keepOwnHighDegree();
    if ((!peers_ && !begins()) || view().bodies + view().vertices == 0) return;
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
    const bool bodies = view().bodies > 0 && (view().bodiesMove || view().anyKinds);
    const int held = kSolveBlocks * processors_;
    const int vertexBlocks = std::min((view().vertices * kVertexLanes + kSolveThreads - 1) / kSolveThreads,
                                      held / kVertexShare);
    const int bodyBlocks = std::min((view().bodies + kTailBodies - 1) / kTailBodies, held - vertexBlocks);
    flush();
    // A color starts while the previous one is being solved and reads ahead what no sweep writes. The first
    // one starts after everything else has ended.
    afterKernel_ = false;
    for (int c = 0; c < options_.colors; ++c) {
      const bool begun = !peers_ || begins();  // with peers each color is an operation
      if (begun && bodies)
        solveColorsFrom(c, kHighDegreeBlocks + vertexBlocks + bodyBlocks, {kHighDegreeBlocks, vertexBlocks});
      else if (begun && view().vertices > 0)
        launchNext(
            solveVertexColor,
            {std::min(blocksFor(view().vertices, kVertexLanes), kVertexBlocks * processors_), kThreads},
            SolveVertex::kStage, view(), c, SolveThreads::of(view(), processors_).vertices, control_);
      if (peers_ && bodies) peers_->shareColor(c);
    }
    // colors that share a launch share nothing with other devices
    if (!peers_) solveColorsFrom(options_.colors, 1, {0, 0});
  }

  /// Begins work between steps, whose kernels belong to no graph and no stage.
  void beginWork() {
    clearControl();
    beginOperations();
    kept_ = false;
  }
  void endWork() { enterStage(nullptr); }
  /// Other work was enqueued after the last kernel of this executor.
  void interrupted() { afterKernel_ = false; }

  void aliasRows() { tables_.aliasRows(); }

  void swapManifolds() {
    if (peers_) peers_->share(Share::Counts);
    tables_.swapManifolds();
    kept_ = !kept_;
  }

 private:
  bool walk(const EnqueueOptions& options) {
    beginOperations(options);
    kept_ = false;
    if (peers_) peers_->begin();
    startList(highDegree_), startList(longSlices_);
    if (begins()) clearNext(reinterpret_cast<int*>(colorBins_.data()), nullptr, kBins);
    step(*this);
    enterStage(nullptr);
    return kept_;
  }

  /// Runs the elements of this device, and exchanges what others need.
  template <class Kernel, class N> void runPart(const Kernel& kernel, N n) {
    using D = Divided<Kernel>;
    beside_ = false;  // exchanges and lists may precede the kernel, which reads them
    const int which = D::which(kernel);
    peers_->share(D::kBefore, which);
    if constexpr (D::kCut == Cut::ActivePairs) peers_->listActivePairs();
    if constexpr (D::kCut > Cut::Tested) peers_->plan();
    if constexpr (std::same_as<Kernel, FindCorrections>)
      runByWarp(FindAndShareMotion{{{{peers_->data()}}}}, n);
    else if constexpr (D::kCut == Cut::Homes)
      run(AtHome<Kernel>{kernel, peers_->data().home()}, n);
    else if constexpr (std::same_as<Kernel, FindActivePairs>)
      peers_->withStores<ShareActivity>(kernel, [&](const auto& k) { runList(k, PeerList::Pairs, n); });
    else if constexpr (std::same_as<Kernel, TestNewPairs>)
      peers_->withStores<ShareNewActivity>(kernel, [&](const auto& k) { run(k, n); });
    else if constexpr (std::same_as<Kernel, SumInertia>)
      runList(SumInertiaByTile{tree()}, PeerList::SeenSlices, n);
    else if constexpr (std::same_as<Kernel, FillBoundary>)
      runList(FillBoundaryByTile{listOf(longSlices_)}, PeerList::Slices, n);
    else if constexpr (D::kCut == Cut::Joints)
      runList(kernel, listOfJoints(PeerJoints::All, which), n, view().joints[which]);
    else if constexpr (D::kCut == Cut::OwnJoints)
      runList(kernel, listOfJoints(PeerJoints::Own, which), n, view().joints[which]);
    else if constexpr (peerListOf(D::kCut) != PeerList::FirstJoint)
      runList(kernel, peerListOf(D::kCut), n);
    else if constexpr (!std::same_as<Kernel, PlaceAggregates>)
      run(kernel, n);  // trees of others count as converged
    peers_->share(D::kAfter, which);
  }
  /// `joints`: the number of joints of that type, which n counts with all of their parts.
  template <class Kernel, class N> void runList(const Kernel& kernel, PeerList list, N n, int joints = 0) {
    if (!begins()) return;
    enterStage(Kernel::kStage);
    const int parts = joints > 0 ? limitOf(n) / joints : 1;
    launch(onDevice(kernel), {0, peers_->countOf(list), peers_->elements(list), parts, joints}, limitOf(n),
           Kernel::kStage);
  }
  /// The same for stages of one level of aggregates.
  template <class Kernel> void runLevelPart(int level) {
    constexpr bool kSoftOnly = std::same_as<Kernel, WithSoftNodes<SumSlice<Real>>> ||
                               std::same_as<Kernel, WithSoftNodes<MoveSlice>>;
    using D = Divided<Kernel>;
    if constexpr (D::kCut == Cut::LevelSlices) {
      peers_->plan();
      peers_->share(D::kBefore, level);
      if (!kSoftOnly && sliceWidth(view(), level) == kSmallWidth)
        sumLevelOfAll<kSmallWidth>(level, kSoftOnly);
      else
        sumLevelOfAll<kWarp>(level, kSoftOnly);
    } else if constexpr (D::kCut == Cut::LevelMoves) {
      runList(MoveNode{level, kSoftOnly}, PeerList::SeenBodies, view().bodiesMove ? view().bodies : 0);
    }
  }
  template <int kTile> void sumLevelOfAll(int level, bool softOnly) {
    SumTree own = tree();
    own.owners = {peers_->data().sliceOwner, peers_->data().rank};
    own.mixed = peers_->data().mixed;
    sumLevel<kTile>(level, softOnly, own);
    peers_->share(Share::SliceSums, level);
    if (!begins()) return;
    launchNext(passSumsOn<kTile>, {blocksForRange(kTile), kThreads}, SumSlice<Real>::kStage, view(), tree(),
               Count{0, peers_->countOf(PeerList::MixedSlices), peers_->elements(PeerList::MixedSlices)},
               level, softOnly, Gate{control_});
  }
  /// The bodies of high degree that this device solves.
  void keepOwnHighDegree() {
    startList(ownHighDegree_);
    if (!begins()) return;
    const LongList all = listOf(highDegree_);
    launch(KeepOwn{all, listOf(ownHighDegree_), owners()}, {0, all.count},
           tables_.capacity(Per::Incidence) / kLongIncidences + 1, "ranks");
  }
  PeerOwners owners() const {
    return peers_ ? PeerOwners{peers_->data().owner, peers_->data().rank} : PeerOwners{};
  }

  template <class Nodes, class Kernel> void launchByColor(Kernel* kernel, const char* name, int n) {
    if (!begins() || n <= 0) return;
    enterStage(name);
    launchNext(kernel, {(n + kColorNodes - 1) / kColorNodes, kThreads}, name, view(),
               colorBins(std::same_as<Nodes, ColoredVertices>), Gate{control_});
  }
  template <int kBlockThreads> void solveFewClusters(int level, int n) {
    if (!begins() || n <= 0) return;
    enterStage(SolveCluster::kStage);
    launchNext(solveClusters<kBlockThreads>, {n, kBlockThreads}, SolveCluster::kStage, view(), level,
               Gate{control_});
  }

  template <int kTile> void sumLevel(int level, bool softOnly = false) {
    sumLevel<kTile>(level, softOnly, tree());
  }
  template <int kTile> void sumLevel(int level, bool softOnly, const SumTree& tree) {
    if (!begins()) return;
    enterStage(SumSlice<Real>::kStage);
    const auto sum = [&]<ExtraRows extra>() {
      int blocks = blocksFor(view().nodes() / kNodesPerTile<kTile, extra> + 1, kTile);
      if (extra != ExtraRows::None) blocks = std::min(blocks, kSliceBlocks<extra> * processors_);
      launchNext(sumSlices<kTile, extra>, {processors_ + blocks, kThreads}, SumSlice<Real>::kStage, view(),
                 tree, listOf(longSlices_), processors_, level, softOnly, Gate{control_});
    };
    withExtraRows(extraRowsOf(view(), residentThreads()), sum);
  }

  void solveColorsFrom(int color, int count, ColorBlocks blocks) {
    launchNext(solveColorsOf(view(), residentThreads()), {count, kSolveThreads}, SolveBody<Real>::kStage,
               view(), color, listOf(peers_ ? ownHighDegree_ : highDegree_), blocks,
               SolveThreads::of(view(), processors_), control_);
  }

  /// Bins of the bodies and of the vertices: numbers of nodes, and of those placed so far.
  static constexpr int kBins = 2 * 2 * kColorBins;
  ColorBins colorBins(bool vertices) const {
    int* const first = reinterpret_cast<int*>(colorBins_.data()) + (vertices ? kBins / 2 : 0);
    return {first, first + kColorBins, owners()};
  }
  /// One warp per kWarp of n bodies.
  template <class Kernel> void runByWarp(const Kernel& kernel, int n) { run(kernel, warpsFor(n)); }
  SumTree tree() const { return {reinterpret_cast<int*>(tickets_.data()), tables_.capacity(Per::Slice)}; }

  CudaPeers* peers_ = nullptr;
  DeviceBuffer tickets_, highDegree_, ownHighDegree_, longSlices_, colorBins_;
  bool kept_ = false;
};

}  // namespace rubble::RUBBLE_CORE

#include "backend/cuda/cuda_stepper.h"

#include <initializer_list>

#include "backend/cuda/cuda_rearranger.cuh"
#include "stages/pairs/order.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Number of launches to enqueue for a count that only the device knows. What exceeds it shares a launch.
class Bound {
 public:
  explicit Bound(int limit) : limit_(limit) {}
  int limit() const { return limit_; }
  /// Records the number that a step needed. A change costs a graph capture, so the bound grows with a margin
  /// and shrinks late, to the recent maximum.
  void note(int used) {
    seen_ = std::max(seen_, used);
    if (used > limit_) limit_ = used + std::max(kLeastGrowth, used / kGrowth);
    if (++steps_ < kWindow) return;
    if (seen_ + kMostIdle < limit_) limit_ = seen_;
    seen_ = steps_ = 0;
  }

 private:
  static constexpr int kWindow = 64;  ///< [steps]
  static constexpr int kGrowth = 4;   ///< growth by a quarter
  static constexpr int kLeastGrowth = 1;
  static constexpr int kMostIdle = 2;  ///< this many empty launches cost less than a capture
  int limit_, seen_ = 0, steps_ = 0;
};

/// Everything that the nodes of a graph depend on: pointers, sizes and the plan of the step. Constants are in
/// device memory. Padding may make equal configurations differ, which costs a capture but never a wrong
/// result.
struct Configuration {
  SolverData view;
  int colors = 0;
  int peers = 0;  ///< CudaPeers::version()
  bool operator==(const Configuration& o) const {
    return colors == o.colors && peers == o.peers && std::memcmp(&view, &o.view, sizeof view) == 0;
  }
};

/// A captured step.
class StepGraph {
 public:
  StepGraph() = default;
  ~StepGraph() {
    if (exec_) cudaGraphExecDestroy(exec_);
  }
  StepGraph(const StepGraph&) = delete;
  StepGraph& operator=(const StepGraph&) = delete;

  bool holds(const Configuration& c) const { return exec_ && captured_ == c; }
  /// Returns whether this configuration was requested twice in a row.
  bool seen(const Configuration& c) {
    const bool again = asked_ == c;
    if (!again) asked_ = c;
    return again;
  }

  template <class Enqueue> void capture(const Configuration& c, cudaStream_t stream, Enqueue&& enqueue) {
    captured_ = {};
    timeline_.clear();
    cudaGraph_t graph = nullptr;
    checkCuda(cudaStreamBeginCapture(stream, cudaStreamCaptureModeThreadLocal), "cudaStreamBeginCapture");
    try {
      enqueue(timeline_);
    } catch (...) {
      cudaStreamEndCapture(stream, &graph);
      if (graph) cudaGraphDestroy(graph);
      throw;
    }
    checkCuda(cudaStreamEndCapture(stream, &graph), "cudaStreamEndCapture");
    const cudaError_t status = adopt(graph);
    cudaGraphDestroy(graph);
    checkCuda(status, "cudaGraphInstantiate");
    captured_ = c;
  }

  void upload(cudaStream_t stream) { checkCuda(cudaGraphUpload(exec_, stream), "cudaGraphUpload"); }
  void launch(cudaStream_t stream) { checkCuda(cudaGraphLaunch(exec_, stream), "cudaGraphLaunch"); }
  const Timeline& timeline() const { return timeline_; }

 private:
  /// Updates the existing graph if only parameters changed, otherwise instantiates a new one.
  cudaError_t adopt(cudaGraph_t graph) {
    if (exec_) {
      cudaGraphExecUpdateResultInfo info{};
      if (cudaGraphExecUpdate(exec_, graph, &info) == cudaSuccess) return cudaSuccess;
      cudaGetLastError();
      cudaGraphExecDestroy(exec_);
      exec_ = nullptr;
    }
    return cudaGraphInstantiate(&exec_, graph, 0);
  }

  cudaGraphExec_t exec_ = nullptr;
  Configuration captured_, asked_;
  Timeline timeline_;
};

/// The part of a step's result that is copied to the host.
struct StepStatus {
  Controls controls;
  Counters counters;
};
/// The first operation that a stopped step has not performed.
EnqueueOptions restOf(const Controls& c) {
  EnqueueOptions rest;
  rest.from = c.main.stop - 1;
  rest.fromBeside = c.beside.stop != 0 ? c.beside.stop - 1 : EnqueueOptions::kNone;
  return rest;
}

/// Color launches before the first step of a scene.
constexpr int kFirstColors = 16;

}  // namespace

struct CudaStepper::Impl {
  explicit Impl(const CudaOptions& options)
      : executor{tables, stream.get(), options.processors}, timings(options.timings) {}

  /// Enqueues the step, or what a stopped one has not performed. Afterwards the host's table pointers are
  /// those before the step.
  void enqueue(EnqueueOptions options, Timeline* timeline, bool captured) {
    if (timeline) timeline->clear();
    options.colors = colors.limit(), options.timeline = timings ? timeline : nullptr;
    options.captured = captured;
    swaps = executor.enqueue(options);
    if (swaps) tables.swapManifolds();
    const auto copy = [&](void* to, const void* what, std::size_t bytes) {
      checkCuda(cudaMemcpyAsync(to, what, bytes, cudaMemcpyDeviceToHost, stream.get()), "cudaMemcpyAsync");
    };
    copy(&status->controls, executor.controls(), sizeof(Controls));
    copy(&status->counters, tables.view().counters, sizeof(Counters));
  }

  /// Enqueues the step from an operation on, up to the one that stops it.
  void enqueueObserved(const EnqueueOptions& options) {
    try {
      enqueue(options, &direct, false);
    } catch (const StepStopped&) {
      checkCuda(cudaMemcpyAsync(&status->controls, executor.controls(), sizeof(Controls),
                                cudaMemcpyDeviceToHost, stream.get()),
                "cudaMemcpyAsync");
    }
    wait();
  }

  /// Waits for the device, and for other ranks on their way.
  void wait() {
    if (peers)
      peers->await();
    else
      stream.wait();
  }

  /// Runs the whole step, as a graph if its configuration occurred before. Pointers alternate between two
  /// states, and each has its own graph.
  const Timeline& runWhole() {
    StepGraph& graph = graphs[parity];
    const Configuration now{tables.view(), colors.limit(), peers ? peers->version() : 0};
    const bool holds = !observer && graph.holds(now);
    // room first: when devices have met, none may wait for memory
    if (!holds) executor.reserveScratch();
    if (peers) reservePeers();
    if (observer) {
      enqueueObserved({});
      return direct;
    }
    if (!holds && (!graph.seen(now) || (peers && !peers->captured()))) {
      enqueue({}, &direct, false);
      wait();
      return direct;
    }
    if (!holds) {
      graph.capture(now, stream.get(), [&](Timeline& timeline) { enqueue({}, &timeline, true); });
      if (peers) awaitGraphs(graph);
    }
    graph.launch(stream.get());
    wait();
    return graph.timeline();
  }

  /// A graph takes memory of its device, for which CUDA may wait for kernels of others. So none is launched
  /// before all ranks have theirs; configurations change alike on all.
  void awaitGraphs(StepGraph& graph) {
    graph.upload(stream.get());
    stream.wait();
    peers->awaitAll();
  }
  /// Tables of all GPUs have grown alike, so their addresses are exchanged again.
  void reservePeers() {
    peers->reserve();
    peers->meet(parity);
  }

  /// Takes over the sizes of `host`.
  void adopt(const SolverData& host) { tables.view() = onDevice(host, tables.view()); }

  /// Returns what there is more room for.
  const char* makeRoom(const Control& control) {
    if (peers) {
      if (const char* const its = peers->makeRoom(control.lacking, control.needed)) return its;
      peers->awaitAll();
    }
    const Per per = static_cast<Per>(control.lacking);
    // on several GPUs each color needs a launch
    if (per == Per::Color) colors.note(control.needed);
    // tables start empty, and the next steps need a little more
    constexpr int kLeastSpare = 64;
    const int spare = tables.capacity(per) > 1 ? 0 : kLeastSpare + control.needed / 8;
    tables.reserve(per, control.needed + spare);
    const SolverData& s = tables.view();
    makeAmpleRoom({Per::Pair, Per::ActivePair, Per::Manifold, Per::Incidence, Per::Boundary}, s.bodies,
                  control);
    makeAmpleRoom({Per::PointPair, Per::PointIncidence, Per::NearFeature}, s.vertices, control);
    executor.reserveScratch();
    if (peers) reservePeers();
    return kindName(per);
  }
  /// Reserves generously for contact-related kinds while contacts are few. A step that stops requires new
  /// graphs, and contacts that appear one by one would stop it repeatedly. `nodes`: bodies or vertices.
  void makeAmpleRoom(std::initializer_list<Per> kinds, int nodes, const Control& control) {
    constexpr int kPerNode = 8, kAmple = 1 << 16;
    const int ample = std::max(nodes / 2, std::min(kPerNode * nodes, kAmple));
    if (control.needed >= ample ||
        std::find(kinds.begin(), kinds.end(), static_cast<Per>(control.lacking)) == kinds.end())
      return;
    for (const Per kind : kinds) tables.reserve(kind, ample);
  }

  Stream stream;
  DeviceTables tables;
  CudaExecutor executor;
  std::unique_ptr<CudaPeers> peers;  ///< null: one GPU has the world
  Pinned<StepStatus> status;
  StepGraph graphs[2];
  Timeline direct;
  Bound colors{kFirstColors};
  int parity = 0;
  bool swaps = false;
  bool timings;
  KernelObserver observer;
};

CudaStepper::CudaStepper(const CudaOptions& options) : impl_(std::make_unique<Impl>(options)) {}
CudaStepper::~CudaStepper() = default;

DeviceTables& CudaStepper::tables() { return impl_->tables; }
const DeviceTables& CudaStepper::tables() const { return impl_->tables; }
cudaStream_t CudaStepper::stream() const { return impl_->stream.get(); }
bool CudaStepper::counted(Per per) const { return impl_->executor.counted(per); }
std::size_t CudaStepper::bytes() const {
  return impl_->tables.bytes() + impl_->executor.scratchBytes() + (impl_->peers ? impl_->peers->bytes() : 0);
}

void CudaStepper::divide(Transport& transport, const RankOptions& options) {
  Impl& m = *impl_;
  m.peers = std::make_unique<CudaPeers>(m.tables, m.stream.get(), transport, options);
  m.executor.divide(m.peers.get());
}

bool CudaStepper::gatherState(const SolverData& host) {
  Impl& m = *impl_;
  if (m.peers->holdsAll()) return false;
  m.adopt(host);
  m.peers->meet(CudaPeers::kBetweenSteps + m.parity);
  for (Control control{.stop = 1}; control.stop != 0;) {
    m.executor.beginWork();
    m.peers->gatherState();
    m.executor.endWork();
    checkCuda(cudaMemcpyAsync(&control, &m.executor.controls()->main, sizeof control, cudaMemcpyDeviceToHost,
                              m.stream.get()),
              "cudaMemcpyAsync");
    m.wait();
    // tables have room: what may lack are letters
    if (control.stop != 0) m.peers->makeRoom(control.lacking, control.needed);
  }
  return true;
}

void CudaStepper::restart() { impl_->peers->restart(); }
std::vector<RankReport> CudaStepper::reports() const { return impl_->peers->reports(); }

void CudaStepper::observe(KernelObserver observer) {
  impl_->observer = observer;
  impl_->executor.observe(std::move(observer));
}

void CudaStepper::sortBodies(const SolverData& host, int pairs) {
  Impl& m = *impl_;
  m.adopt(host);
  m.executor.divide(nullptr);  // each device sorts all bodies
  m.executor.reserveScratch();
  {
    CudaRearranger rearranger(m.executor, m.stream);
    RUBBLE_CORE::sortBodies(rearranger, pairs);
  }
  m.executor.divide(m.peers.get());
  // old and new tables swap roles in each step
  m.parity ^= 1;
}

Counters CudaStepper::step(const SolverData& host, StepReport& report) {
  Impl& m = *impl_;
  m.adopt(host);

  const Timeline* timeline = &m.runWhole();
  if (m.timings) timeline->addTo(report.stages);
  while (m.status->controls.main.stop != 0) {
    const Controls stopped = m.status->controls;
    const auto makeRoom = [&](const Control& control) {
      report.grown.push_back({m.makeRoom(control), control.needed});
    };
    makeRoom(stopped.main);
    if (stopped.beside.stop != 0 && stopped.beside.stop != stopped.main.stop) makeRoom(stopped.beside);
    ++report.restarts;
    const EnqueueOptions rest = restOf(stopped);
    if (m.observer) {
      m.enqueueObserved(rest);
    } else {
      m.enqueue(rest, &m.direct, false);
      m.wait();
    }
    if (m.timings) m.direct.addTo(report.stages);
  }
  if (m.observer) m.observer("between steps", "");
  if (m.swaps) {
    // a graph launch does not change the host's pointers
    m.tables.aliasRows();
    m.tables.swapManifolds();
    m.parity ^= 1;
  }
  if (m.peers) m.peers->hasStepped();
  const Counters counters = m.status->counters;
  m.colors.note(m.status->controls.main.wideColors);
  return counters;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Launches kernels into one stream, grouped by stage, from an operation of the step on.
#include <nvtx3/nvToolsExt.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "backend/cuda/device_memory.h"
#include "backend/cuda/joint_kernels.cuh"
#include "backend/cuda/timeline.h"
#include "backend/observable_engine.h"

namespace rubble::RUBBLE_CORE {

/// First operation, timing, and whether a graph is being captured.
struct EnqueueOptions {
  static constexpr int kNone = std::numeric_limits<int>::max();  ///< no operation
  int from = 0;                                                  ///< first operation to enqueue
  int fromBeside = 0;            ///< the same for a sequence beside another one, if it is later
  int colors = 0;                ///< number of color launches
  Timeline* timeline = nullptr;  ///< for stage times; may be null
  bool captured = false;

  static EnqueueOptions none() {
    EnqueueOptions options;
    options.from = kNone;
    return options;
  }
  bool any() const { return from != kNone; }
};

/// Thrown out of a step that is observed when a table is too small.
struct StepStopped {};

class KernelLauncher {
  /// Launches the kernels of exchanges among those of the step.
  friend class CudaPeers;

 public:
  /// With an observer, each kernel of a step ends before it is called for the next one.
  void observe(KernelObserver observer) { observer_ = std::move(observer); }

 protected:
  /// `processors`: CudaOptions.
  KernelLauncher(DeviceTables& tables, cudaStream_t stream, int processors)
      : tables_(tables), stream_(stream) {
    int device = 0;
    checkCuda(cudaGetDevice(&device), "cudaGetDevice");
    checkCuda(cudaDeviceGetAttribute(&processors_, cudaDevAttrMultiProcessorCount, device),
              "cudaDeviceGetAttribute");
    if (processors > 0) processors_ = std::min(processors_, processors);
    int major = 0;
    checkCuda(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device),
              "cudaDeviceGetAttribute");
    launchesEarly_ = major >= kEarlyLaunchMajor;
    int threads = 0;
    checkCuda(cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, device),
              "cudaDeviceGetAttribute");
    // more blocks would only queue
    maxBlocks_ = processors_ * (threads / kThreads);
    reserveCleared(0);
    std::fill(std::begin(perOf_), std::end(perOf_), -1);
  }
  KernelLauncher(const KernelLauncher&) = delete;
  KernelLauncher& operator=(const KernelLauncher&) = delete;

  const SolverData& view() const { return tables_.view(); }

  /// The memory that clearControl() clears: the control, and bytes that follow it.
  void reserveCleared(std::size_t bytes) {
    clearedBytes_ = kFirstCleared + bytes;
    cleared_.reserve(clearedBytes_);
    control_ = reinterpret_cast<Control*>(cleared_.data());
  }
  void clearControl() { checkCuda(cudaMemsetAsync(control_, 0, clearedBytes_, stream_), "cudaMemsetAsync"); }
  /// Begins a step, or work between steps, whose kernels belong to no graph.
  void beginOperations(const EnqueueOptions& options = {}) {
    options_ = options;
    operation_ = clears_.count = 0;
    check_ = {};
    stage_ = nullptr;
    afterKernel_ = false;
  }

  /// Counts operations. Returns whether this one is enqueued.
  bool begins() { return operation_++ >= options_.from; }
  /// Returns whether the present operation is enqueued.
  bool begun() const { return operation_ > options_.from; }
  int operation() const { return operation_ - 1; }

  /// Enqueues two sequences of operations, the second one in a stream of its own. Each has a control, so that
  /// one goes on if the other one stops. Clocks of stages would not know whose time they take, so with them,
  /// as for an observer, one follows the other.
  template <class First, class Second> void together(First&& first, Second&& second) {
    if (!options_.any() || inOrder_ || observer_ || options_.timeline) return first(), second();
    forked_ = true;
    tell(begun_);
    first();
    flush();
    runBeside([&] {
      follow(begun_, control_ - 1);
      second();
      tell(ended_);
    });
    follow(ended_, control_ + 1);
    forked_ = false;
  }
  /// Of the first sequence of together(), and of the second one.
  void signal() {
    if (forked_) tell(signaled_);
  }
  void awaitSignal() {
    if (forked_) follow(signaled_, control_ - 1);
  }

  void announce(const char* stage, std::string_view kernel) {
    if (!observer_ || operation_ < options_.from) return;
    flush();
    Control control;
    checkCuda(cudaMemcpyAsync(&control, control_, sizeof control, cudaMemcpyDeviceToHost, stream_),
              "cudaMemcpyAsync");
    checkCuda(cudaStreamSynchronize(stream_), "a kernel before the next one");
    afterKernel_ = false;
    if (control.stop != 0) throw StepStopped{};
    observer_(stage, kernel);
  }

  void enterStage(const char* name) {
    if (stage_ && name && std::strcmp(stage_, name) == 0) return;
    if (stage_) nvtxRangePop();
    if (name) nvtxRangePushA(name);
    if (options_.timeline && (stage_ || name)) {
      options_.timeline->mark(name, stream_, options_.captured);
      afterKernel_ = false;
    }
    stage_ = name;
  }

  /// Threads that are resident at once; 0 if lanes must not depend on the number of elements.
  int residentThreads() const { return view().fixedOrder ? 0 : maxBlocks_ * kThreads; }
  /// Blocks for n elements of `width` threads each.
  int blocksFor(int n, int width = 1) const {
    const std::int64_t blocks = (std::int64_t{n} * width + kThreads - 1) / kThreads;
    return static_cast<int>(std::clamp<std::int64_t>(blocks, 1, maxBlocks_));
  }

  /// `most`: upper bound on the number of elements.
  template <class Kernel> void launch(const Kernel& kernel, Count n, int most, const char* name) {
    const int blocks = blocksFor(most, widthOf<Kernel>());
    const Gate gate{control_, beside_};
    if constexpr (Staged<Kernel>)
      launchNext(runStaged<Kernel>,
                 {std::max(1, groupsOf(most / elementsPerJoint<Kernel>())), kStagedThreads<Kernel>}, name,
                 view(), kernel, n, gate);
    else if constexpr (OfSlices<Kernel>)
      launchNext(runOfSlices<Kernel>, {blocks, kThreads}, name, view(), kernel, n, gate);
    else if constexpr (Limited<Kernel>)
      launchNext(runLimited<Kernel>, {blocks, kThreads}, name, view(), kernel, n, gate);
    else
      launchNext(runKernel<Kernel>, {blocks, kThreads}, name, view(), kernel, n, gate);
  }

  /// For kernels of many registers that mostly have no element: few blocks, where others would queue only to
  /// end. One a multiprocessor costs 4 % of the smash of `ring-110k` (docs/research/tuning-log.md).
  template <class Kernel> void runRarely(const Kernel& kernel, int Counters::*n) {
    if (!begins()) return;
    enterStage(Kernel::kStage);
    constexpr int kBlocksPerProcessor = 4;
    const int blocks = kBlocksPerProcessor * processors_;
    launch(kernel, {0, counter(n)}, blocks * kThreads / widthOf<Kernel>(), Kernel::kStage);
  }

  /// Counters is an array of ints.
  static std::size_t indexOf(int Counters::*c) {
    static const Counters probe{};
    return static_cast<std::size_t>(&(probe.*c) - reinterpret_cast<const int*>(&probe));
  }
  int* counter(int Counters::*c) const { return reinterpret_cast<int*>(view().counters) + indexOf(c); }
  /// A counter of elements of a kind. bound(): it counts some of them. count(): the step requires room for
  /// them.
  void bound(int Counters::*c, Per per) { perOf_[indexOf(c)] = static_cast<int>(per); }
  void count(int Counters::*c, Per per) { bound(c, per), counted_[static_cast<int>(per)] = true; }
  /// Capacity of the kind that this counter counts.
  int capacityOf(int Counters::*c) const {
    const int per = perOf_[indexOf(c)];
    if (per < 0) throw std::logic_error("CudaExecutor: a counter is used before the room for it is required");
    return tables_.capacity(static_cast<Per>(per));
  }

  struct Grid {
    int blocks, threads;
  };

  /// Clears an array before the next kernel. Clears that follow one another share a launch.
  void clearNext(int* first, const int* counted, int most) {
    if (clears_.count == Clears::kMost) flush();
    clears_.array[clears_.count++] = {first, counted, most};
  }
  /// Checks room before the next kernel, and before what is cleared from now on, which a step that stops here
  /// clears when it continues.
  void checkNext(const RoomCheck& check) {
    flush();
    check_ = check;
  }
  /// Launches what waits for the next kernel. To be called before other work is enqueued.
  void flush() {
    if (clears_.count == 0 && !check_.counter) return;
    const Clears clears = std::exchange(clears_, {});
    std::int64_t most = 0;
    for (int k = 0; k < clears.count; ++k) most += clears.array[k].most;
    const int elements = static_cast<int>(std::min<std::int64_t>(most, std::numeric_limits<int>::max()));
    launchNext(clearArrays, {blocksFor(elements), kThreads}, "clear", clears, std::exchange(check_, {}),
               control_);
  }
  /// Launches a kernel that starts with awaitPrevious(). After another kernel of this class it uses
  /// programmatic dependent launch.
  template <class... Wanted, class... Given>
  void launchNext(void (*kernel)(Wanted...), const Grid& grid, const char* name, Given&&... arguments) {
    flush();
    cudaLaunchAttribute early{};
    early.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    early.val.programmaticStreamSerializationAllowed = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(static_cast<unsigned>(grid.blocks));
    config.blockDim = dim3(static_cast<unsigned>(grid.threads));
    config.stream = stream_;
    config.attrs = &early;
    config.numAttrs = afterKernel_ ? 1 : 0;
    checkCuda(cudaLaunchKernelEx(&config, kernel, std::forward<Given>(arguments)...), name);
    afterKernel_ = launchesEarly_;
  }
  /// A kernel with barriers across the grid, of one block per multiprocessor.
  template <class... Wanted, class... Given>
  void launchTogether(const char* name, void (*kernel)(Wanted...), Given&&... arguments) {
    flush();
    cudaLaunchAttribute together{};
    together.id = cudaLaunchAttributeCooperative;
    together.val.cooperative = 1;
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(static_cast<unsigned>(processors_));
    config.blockDim = dim3(static_cast<unsigned>(kGridThreads));
    config.stream = stream_;
    config.attrs = &together;
    config.numAttrs = 1;
    checkCuda(cudaLaunchKernelEx(&config, kernel, std::forward<Given>(arguments)...), name);
    afterKernel_ = false;
  }

  /// What work() enqueues belongs to the second sequence.
  template <class Work> void runBeside(Work&& work) {
    const cudaStream_t stream = std::exchange(stream_, streamBeside_.get());
    const int from = std::exchange(options_.from, std::max(options_.from, options_.fromBeside));
    ++control_;
    work();
    --control_, options_.from = from, stream_ = stream;
  }
  /// An event of one sequence, and what the other one does: it waits for that, and stops if the former has.
  void tell(const StreamEvent& event) {
    flush();
    event.record(stream_);
  }
  void follow(const StreamEvent& event, const Control* its) {
    flush();
    event.holdBack(stream_);
    afterKernel_ = false;
    launchNext(passStopOn, {1, 1}, "stop", its, control_);
  }

  Count countOf(int n) const { return {n, nullptr}; }
  Count countOf(int Counters::*c) const { return {0, counter(c)}; }
  /// `number`: of the phase among those of a launch.
  template <class P> GridPhase<typename P::Kernel, P::kWhen> onGrid(const P& phase, int number = 0) const {
    int* const claimed = reinterpret_cast<int*>(cleared_.data() + sizeof(Controls));
    return {{phase.kernel}, countOf(phase.count), claimed + number};
  }

  DeviceTables& tables_;
  cudaStream_t stream_;
  Stream streamBeside_;
  StreamEvent begun_, signaled_, ended_;  ///< of together()
  /// In cleared_: the controls, and what phases of a cooperative launch have claimed.
  static constexpr int kMostPhases = 12;
  static constexpr std::size_t kFirstCleared = sizeof(Controls) + kMostPhases * sizeof(int);
  DeviceBuffer cleared_;
  std::size_t clearedBytes_ = 0;
  Control* control_ = nullptr;  ///< of the sequence that is being enqueued; the main one is first in cleared_
  Clears clears_;               ///< of clearNext()
  RoomCheck check_;             ///< of checkNext()
  EnqueueOptions options_;
  KernelObserver observer_;
  int operation_ = 0;
  int perOf_[sizeof(Counters) / sizeof(int)];  ///< kind that a counter counts, or -1
  bool counted_[kPerCount] = {};               ///< kinds for which steps require room
  const char* stage_ = nullptr;
  bool beside_ = false, forked_ = false;
  bool inOrder_ = false;  ///< other devices take part in operations, whose order therefore matters
  int processors_ = 1, maxBlocks_ = 1;
  bool launchesEarly_ = false;  ///< the device supports programmatic dependent launch
  bool afterKernel_ = false;    ///< the last operation in the stream is a kernel of this class
};

}  // namespace rubble::RUBBLE_CORE

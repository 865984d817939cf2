#include "backend/cuda/cuda_peers.h"

#include <algorithm>
#include <set>
#include <string>

#include "backend/cuda/cuda_letters.h"
#include "backend/cuda/kernel_launcher.cuh"
#include "backend/cuda/peer_kernels.cuh"
#include "backend/distributed/rank_lists.h"
#include "backend/peers/peer_phases.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Device memory that keeps its content when it grows.
class KeptBuffer {
 public:
  ~KeptBuffer() { DeviceMemory::release(data_); }
  KeptBuffer() = default;
  KeptBuffer(const KeptBuffer&) = delete;
  KeptBuffer& operator=(const KeptBuffer&) = delete;
  template <class T> void reserve(std::size_t count, T*& to) {
    if (const std::size_t bytes = count * sizeof(T); bytes > bytes_) {
      void* const fresh = DeviceMemory::allocate(bytes);
      if (data_) DeviceMemory::copy(fresh, data_, bytes_);
      DeviceMemory::release(data_);
      data_ = fresh, bytes_ = bytes;
    }
    to = static_cast<T*>(data_);
  }
  std::size_t size() const { return bytes_; }

 private:
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace

struct CudaPeers::Impl {
  Impl(Transport& transport, double longest) : courier(transport), timeout(longest) {}

  RankCourier courier;
  double timeout;                        ///< [s]
  std::unique_ptr<CudaLetters> letters;  ///< null: GPUs reach one another's memory
  KeptBuffer cut, owner, ownerBefore, moves, movesBefore, seen, seenBy, sharedRoot, sharedPartner, sliceOwner,
      sees, mixed, extraRow, extraJoint[JointTypes::kSize], rowAskers, jointAskers[JointTypes::kSize], sums,
      lists[kPeerLists], listed, at, signals;

  /// Flags that all GPUs see, and access to one another's memory.
  void connect(int rank, int ranks);
  PeerSignals signal{};
  PeerRank* places = nullptr;
  struct SumsOfStep {
    PeerSums of[kMostPeers];
  };
  Pinned<SumsOfStep> sumsOfStep;
  /// capacities at which the other ranks were told the addresses, by place; empty: never
  std::vector<int> told[kPlaces];
};

CudaPeers::CudaPeers(DeviceTables& tables, cudaStream_t stream, Transport& transport,
                     const RankOptions& options)
    : tables_(tables), stream_(stream), impl_(std::make_unique<Impl>(transport, options.timeout)) {
  if (kStrict) throw Error("backend", "a build without RUBBLE_STRICT for several GPUs", "cuda");
  const int ranks = transport.ranks();
  if (ranks > kMostPeers)
    throw Error("ranks.devices", "at most " + std::to_string(kMostPeers) + " GPUs", std::to_string(ranks));
  Impl& m = *impl_;
  data_.rank = transport.rank(), data_.ranks = ranks;
  m.cut.reserve(1, data_.cut), m.sums.reserve(kMostPeers, data_.sums);
  m.listed.reserve(kPeerLists, data_.listed);
  m.at.reserve(static_cast<std::size_t>(kPlaces * kMostPeers), m.places);
  PeerCut cut{};
  cut.interval = options.cutInterval, cut.maxImbalance = options.maxImbalance, cut.holdsAll = 1;
  checkCuda(cudaMemcpy(data_.cut, &cut, sizeof cut, cudaMemcpyHostToDevice), "cudaMemcpy");
  if (options.exchange == RankExchange::Letters) {
    m.letters = std::make_unique<CudaLetters>(transport, stream, options.nccl);
    data_.box = m.letters->boxes();
  } else {
    m.connect(data_.rank, ranks);
  }
}

void CudaPeers::Impl::connect(int rank, int ranks) {
  unsigned* flags = nullptr;
  signals.reserve(kMostPeers + 2, flags);
  signal.rank = rank, signal.ranks = ranks;
  signal.flag = flags, signal.epoch = flags + kMostPeers, signal.arrived = flags + kMostPeers + 1;
  signal.limit = static_cast<unsigned long long>(timeout * 1e9);
  std::ranges::copy(courier.gatherValue(flags), signal.of);
  const std::vector<int> devices = courier.gatherValue([] {
    int device = 0;
    checkCuda(cudaGetDevice(&device), "cudaGetDevice");
    return device;
  }());
  signal.shared = std::set<int>(devices.begin(), devices.end()).size() < devices.size();
  for (int r = 0; r < ranks; ++r) {
    if (r == rank || devices[std::size_t(r)] == devices[std::size_t(rank)]) continue;
    const cudaError_t status = cudaDeviceEnablePeerAccess(devices[std::size_t(r)], 0);
    if (status == cudaErrorPeerAccessAlreadyEnabled)
      cudaGetLastError();
    else
      checkCuda(status, "cudaDeviceEnablePeerAccess");
  }
}
CudaPeers::~CudaPeers() = default;

int CudaPeers::mostOf(PeerList list) const {
  switch (list) {
    case PeerList::MigratingPairs:
    case PeerList::Pairs:
      return tables_.capacity(Per::Pair);
    case PeerList::ActivePairs:
      return tables_.capacity(Per::ActivePair);
    case PeerList::Rows:
    case PeerList::OwnRows:
    case PeerList::CrossRows:
    case PeerList::JoinedRows:
    case PeerList::ExtraRows:
      return tables_.capacity(Per::Manifold);
    case PeerList::Bodies:
    case PeerList::Ghosts:
    case PeerList::SeenBodies:
    case PeerList::SharedBodies:
      return tables_.capacity(Per::Body);
    case PeerList::Slices:
    case PeerList::SeenSlices:
    case PeerList::MixedSlices:
    case PeerList::SentSlices:
      return tables_.capacity(Per::Slice);
    default: {
      const int type = (static_cast<int>(list) - static_cast<int>(PeerList::FirstJoint)) / kPeerJointLists;
      return tables_.capacity(perJoint(type));
    }
  }
}

void CudaPeers::reserve() {
  Impl& m = *impl_;
  const auto capacity = [&](Per per) { return static_cast<std::size_t>(tables_.capacity(per)); };
  const std::size_t bodies = capacity(Per::Body);
  data_.stride = static_cast<int>(bodies);
  m.owner.reserve(bodies, data_.owner), m.ownerBefore.reserve(bodies, data_.ownerBefore);
  m.moves.reserve(bodies, data_.moves), m.movesBefore.reserve(bodies, data_.movesBefore);
  m.seen.reserve(bodies * static_cast<std::size_t>(data_.ranks), data_.seen);
  m.seenBy.reserve(bodies, data_.seenBy);
  m.sharedRoot.reserve(bodies * kCoarseLevels, data_.sharedRoot);
  m.sharedPartner.reserve(capacity(Per::Pair), data_.sharedPartner);
  m.sliceOwner.reserve(capacity(Per::Slice), data_.sliceOwner);
  m.sees.reserve(capacity(Per::Aggregate), data_.sees);
  m.mixed.reserve(capacity(Per::Aggregate), data_.mixed);
  m.extraRow.reserve(capacity(Per::Manifold), data_.extraRow);
  const std::size_t ranks = static_cast<std::size_t>(data_.ranks);
  m.rowAskers.reserve(capacity(Per::Manifold) * ranks, data_.rowAskers);
  for (int type = 0; type < JointTypes::kSize; ++type) {
    m.extraJoint[type].reserve(capacity(perJoint(type)), data_.extraJoint[type]);
    m.jointAskers[type].reserve(capacity(perJoint(type)) * ranks, data_.jointAskers[type]);
  }
  const auto beginning = [](int k) { return static_cast<int>(beginningOf(static_cast<PeerList>(k))); };
  for (int k = 0; k < kPeerLists; ++k)
    if (beginning(k) == k)
      m.lists[k].reserve(static_cast<std::size_t>(mostOf(static_cast<PeerList>(k))), data_.list[k]);
  for (int k = 0; k < kPeerLists; ++k) data_.list[k] = data_.list[beginning(k)];
}

std::size_t CudaPeers::bytes() const {
  const Impl& m = *impl_;
  std::size_t sum = 0;
  for (const KeptBuffer* const each :
       {&m.cut, &m.owner, &m.ownerBefore, &m.moves, &m.movesBefore, &m.seen, &m.seenBy, &m.sharedRoot,
        &m.sharedPartner, &m.sliceOwner, &m.sees, &m.mixed, &m.extraRow, &m.rowAskers, &m.sums, &m.listed,
        &m.at, &m.signals})
    sum += each->size();
  for (const KeptBuffer& each : m.extraJoint) sum += each.size();
  for (const KeptBuffer& each : m.jointAskers) sum += each.size();
  for (const KeptBuffer& each : m.lists) sum += each.size();
  return sum + (m.letters ? m.letters->bytes() : 0);
}

void CudaPeers::meet(int place) {
  Impl& m = *impl_;
  PeerRank own{tables(), data_};
  if (place < kBetweenSteps) {
    holdsAll_ = false;
    // in a step ranks store rows only where they will lie
    own.s.contact = reinterpret_cast<ContactRows*>(own.s.oldManifold);
  }
  PeerRank* const to = m.places + place * kMostPeers;
  data_.at = own.p.at = to;
  // addresses change as capacities do, which grow alike on all ranks: either all ranks meet or none
  std::vector<int> capacities;
  for (int per = 0; per < kPerCount; ++per) capacities.push_back(tables_.capacity(static_cast<Per>(per)));
  if (capacities == m.told[place]) return;
  m.told[place] = std::move(capacities);
  const std::vector<PeerRank> all = m.courier.gatherValue(own);
  checkCuda(cudaMemcpyAsync(to, all.data(), all.size() * sizeof(PeerRank), cudaMemcpyHostToDevice, stream_),
            "cudaMemcpyAsync");
  checkCuda(cudaStreamSynchronize(stream_), "addresses of other devices");
  // nobody stores before all have the addresses
  m.courier.gatherValue(place);
}

void CudaPeers::awaitAll() { impl_->courier.gatherValue(0); }

const char* CudaPeers::makeRoom(int lacking, int needed) {
  if (lacking == kLostPeer)
    throw RankFailure("GPU " + std::to_string(needed) + " does not answer GPU " + std::to_string(data_.rank));
  const int kind = CudaLetters::kindOf(lacking);
  if (kind < 0) return nullptr;
  impl_->letters->reserve(kind, needed);
  return "letters";
}
void CudaPeers::await() {
  if (impl_->letters)
    impl_->letters->await(impl_->timeout);
  else
    checkCuda(cudaStreamSynchronize(stream_), "step on the device");
}
bool CudaPeers::captured() const {
  return !impl_->signal.shared && (!impl_->letters || impl_->letters->captured());
}
int CudaPeers::version() const { return impl_->letters ? impl_->letters->version() : 0; }

void CudaPeers::restart() {
  holdsAll_ = true, isLoaded_ = false;
  for (std::vector<int>& told : impl_->told) told.clear();
  const int values[] = {1, 0};
  checkCuda(cudaMemcpyAsync(&data_.cut->holdsAll, &values[0], sizeof(int), cudaMemcpyHostToDevice, stream_),
            "cudaMemcpyAsync");
  checkCuda(cudaMemcpyAsync(&data_.cut->bodies, &values[1], sizeof(int), cudaMemcpyHostToDevice, stream_),
            "cudaMemcpyAsync");
  checkCuda(cudaStreamSynchronize(stream_), "cudaMemcpyAsync");
}

std::vector<RankReport> CudaPeers::reports() const {
  std::vector<RankReport> out;
  for (int r = 0; r < data_.ranks; ++r) {
    const PeerSums::Counts& of = impl_->sumsOfStep->of[r].counts;
    out.push_back({.bodies = of.bodies, .ghosts = of.ghosts, .rows = of.rows, .migrated = of.migrated});
  }
  return out;
}

// Operations of a step.

void CudaPeers::begin() {
  planned_ = activeListed_ = summed_ = false;
  firstPost_ = -1;
}

/// Counts an operation, and notes the first one that posts letters.
template <class Kernel> bool CudaPeers::beginsKernel() {
  const bool begins = launcher_->begins();
  if constexpr (requires { Kernel::kPosts; })
    if (firstPost_ < 0) firstPost_ = launcher_->operation();
  return begins;
}

template <class Kernel> void CudaPeers::each(const Kernel& kernel, int n) {
  KernelLauncher& launcher = *launcher_;
  if (!beginsKernel<Kernel>() || n <= 0) return;
  launcher.enterStage(Kernel::kStage);
  launcher.launch(onDevice(kernel), {n, nullptr}, n, Kernel::kStage);
}
template <class Kernel> void CudaPeers::each(const Kernel& kernel, int Counters::*n) {
  KernelLauncher& launcher = *launcher_;
  if (!beginsKernel<Kernel>()) return;
  launcher.enterStage(Kernel::kStage);
  launcher.launch(kernel, {0, launcher.counter(n)}, launcher.capacityOf(n), Kernel::kStage);
}
template <class Kernel> void CudaPeers::eachOld(const Kernel& kernel) {
  KernelLauncher& launcher = *launcher_;
  if (!beginsKernel<Kernel>()) return;
  launcher.enterStage(Kernel::kStage);
  launcher.launch(kernel, oldPairs(), tables_.capacity(Per::Pair), Kernel::kStage);
}
Count CudaPeers::oldPairs() const { return {0, tables().oldPairOffset + tables().bodies}; }
Count CudaPeers::countedList(PeerList list) const { return {0, countOf(list), elements(list)}; }
template <class Kernel> void CudaPeers::eachOf(PeerList list, const Kernel& kernel) {
  KernelLauncher& launcher = *launcher_;
  if (!beginsKernel<Kernel>()) return;
  launcher.enterStage(Kernel::kStage);
  launcher.launch(onDevice(kernel), countedList(list), mostOf(list), Kernel::kStage);
}
template <class Test> void CudaPeers::select(PeerList list, const Test& test, int n) {
  if (launcher_->begins() && n > 0) launchSelect(list, test, {n, nullptr}, n);
}
template <class Test> void CudaPeers::select(PeerList list, const Test& test, int Counters::*n) {
  KernelLauncher& launcher = *launcher_;
  if (launcher.begins()) launchSelect(list, test, {0, launcher.counter(n)}, launcher.capacityOf(n));
}
template <class Test> void CudaPeers::selectOld(PeerList list, const Test& test) {
  if (launcher_->begins()) launchSelect(list, test, oldPairs(), tables_.capacity(Per::Pair));
}
template <class Test> void CudaPeers::selectOf(PeerList list, PeerList from, const Test& test) {
  if (launcher_->begins()) launchSelect(list, test, countedList(from), mostOf(from));
}
template <class Test>
void CudaPeers::launchSelect(PeerList list, const Test& test, const Count& n, int most) {
  KernelLauncher& launcher = *launcher_;
  launcher.enterStage("ranks");
  launcher.launchNext(listElements<Test>, {launcher.blocksFor(most), kThreads}, "ranks", tables(), test, n,
                      data_.list[static_cast<int>(list)], data_.listed + static_cast<int>(list),
                      Gate{launcher.control_});
}
void CudaPeers::join(PeerList list, PeerList more) {
  KernelLauncher& launcher = *launcher_;
  if (!launcher.begins()) return;
  launcher.enterStage("ranks");
  launcher.launchNext(joinLists, {launcher.blocksFor(mostOf(more) / kEntriesPerJoin), kThreads}, "ranks",
                      countOf(beginningOf(list)), countedList(more), data_.list[static_cast<int>(list)],
                      data_.listed + static_cast<int>(list), Gate{launcher.control_});
}
void CudaPeers::barrier() { meetIf(nullptr); }
void CudaPeers::barrierIf(int Counters::*counter) { meetIf(launcher_->counter(counter)); }
/// `condition`: letters go in any case, for graphs hold messages of fixed length.
void CudaPeers::meetIf(const int* condition) {
  KernelLauncher& launcher = *launcher_;
  if (impl_->letters) return exchangeLetters();
  if (!launcher.begins()) return;
  launcher.enterStage("ranks");
  launchBarrier([&] {
    launcher.launchNext(meetAll, {1, kMostPeers}, "ranks", impl_->signal, condition, launcher.control_);
  });
}
/// The first launch of a kernel loads it, for which CUDA may wait for the end of all work under way. Work
/// that waits for a rank that has not launched its part would then never end. So until all kernels have run,
/// ranks launch a barrier when their devices have ended everything else, and go on when they have ended the
/// barrier. On GPUs with several ranks the barrier is that all have ended.
template <class Launch> void CudaPeers::launchBarrier(Launch&& launch) {
  const bool alone = !isLoaded_ && !launcher_->options_.captured;
  const auto end = [&] { checkCuda(cudaStreamSynchronize(stream_), "a barrier of devices"); };
  if (impl_->signal.shared) {
    launch();
    end(), awaitAll();
    return;
  }
  if (alone) end(), awaitAll();
  launch();
  if (alone) end();
}

/// A message of letters is as long as the longest of its kind so far.
void CudaPeers::enterExchange(Share what, int which) {
  constexpr int kMostWhich = 32;
  static_assert((static_cast<int>(Share::Counts) + 1) * kMostWhich <= CudaLetters::kKinds);
  exchange_ = static_cast<int>(what) * kMostWhich + std::min(which, kMostWhich - 1);
}
void CudaPeers::exchangeLetters() {
  KernelLauncher& launcher = *launcher_;
  const bool begins = launcher.begins();
  const int first = std::exchange(firstPost_, -1);
  if (!begins) return;
  launcher.enterStage("ranks");
  launcher.flush();
  impl_->letters->exchange(exchange_, first < 0 ? launcher.operation() : first, launcher.control_);
  launcher.afterKernel_ = false;
}

void CudaPeers::plan() {
  if (std::exchange(planned_, true)) return;
  enterExchange(Share::None, 0);
  peers::plan(*this);
}
void CudaPeers::listActivePairs() {
  if (!std::exchange(activeListed_, true)) peers::listActivePairs(*this);
}
void CudaPeers::closeOtherTrees() { each(CloseOtherTrees{{data_}}, tables().treeNodes); }

void CudaPeers::beginColors(int limit) {
  plan();
  enterExchange(Share::NodePoses, 0);
  peers::beginColors(*this);
  KernelLauncher& launcher = *launcher_;
  if (!launcher.begins()) return;
  launcher.launchNext(requireColors, {1, 1}, "ranks", launcher.control_,
                      static_cast<const int*>(launcher.counter(&Counters::colors)),
                      Room{static_cast<int>(Per::Color), limit, launcher.operation()});
}
void CudaPeers::shareColor(int color) {
  KernelLauncher& launcher = *launcher_;
  const ShareSeenOfColor push{{{data_}}, color};
  if (impl_->letters) {
    enterExchange(Share::ColorPoses, color);
    eachOf(PeerList::SharedBodies, push);
    return exchangeLetters();
  }
  if (!launcher.begins()) return;
  launchBarrier([&] {
    launcher.launchNext(storeColor, {launcher.blocksFor(tables().bodies / kBodiesPerStore), kThreads},
                        "ranks", tables(), push, countedList(PeerList::SharedBodies), impl_->signal,
                        launcher.control_);
  });
}

void CudaPeers::share(Share what, int which) {
  enterExchange(what, which);
  if (what == Share::NodePoses) {  // all that see a body have its pose
    if (!std::exchange(summed_, tables().plan.coarseCorrection)) peers::beginSums(*this);
    return;
  }
  if (what == Share::Owners && launcher_->begins()) {
    checkCuda(cudaMemsetAsync(data_.listed, 0, sizeof(int) * kPeerLists, stream_), "cudaMemsetAsync");
    launcher_->afterKernel_ = false;
  }
  peers::share(*this, what, which);
  if (what != Share::Counts || !launcher_->begins()) return;
  checkCuda(cudaMemcpyAsync(impl_->sumsOfStep.get(), data_.sums,
                            sizeof(PeerSums) * static_cast<std::size_t>(data_.ranks), cudaMemcpyDeviceToHost,
                            stream_),
            "cudaMemcpyAsync");
  launcher_->afterKernel_ = false;
}

void CudaPeers::gatherState() {
  const bool loaded = std::exchange(isLoaded_, false);  // its own kernels are not those of a step
  enterExchange(Share::None, 1);
  peers::gatherState(*this);
  isLoaded_ = loaded;
  const int one = 1;
  checkCuda(cudaMemcpyAsync(&data_.cut->holdsAll, &one, sizeof one, cudaMemcpyHostToDevice, stream_),
            "cudaMemcpyAsync");
  launcher_->afterKernel_ = false;
  holdsAll_ = true;
}

}  // namespace rubble::RUBBLE_CORE

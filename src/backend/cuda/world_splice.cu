#include "backend/cuda/world_splice.h"

#include <cub/block/block_scan.cuh>

#include "backend/cuda/cuda_check.h"
#include "state/arrays.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr int kLanesPerWorld = 32, kBlock = 128, kScanThreads = 1024;
constexpr unsigned kAll = 0xffffffffu;

/// The contacts of a world in its source.
struct Source {
  const ContactTables* from;
  int firstBody, bodies;            ///< bodies in the source
  int pairs, pairsEnd;              ///< range of pairs
  int manifolds, manifoldsEnd = 0;  ///< range of manifolds

  __device__ Source(const SolverData& s, const Splice& splice, int world) {
    const int inB = splice.firstInB[world];
    from = inB < 0 ? &splice.a : &splice.b;
    firstBody = inB < 0 ? s.firstBody[world] : inB;
    bodies = s.firstBody[world + 1] - s.firstBody[world];
    pairs = from->pairOffset[firstBody], pairsEnd = from->pairOffset[firstBody + bodies];
    manifolds = pairs < pairsEnd ? from->activeOffset[pairs] : 0;
    if (pairs < pairsEnd) manifoldsEnd = from->activeOffset[pairsEnd];
  }
};

__device__ int worldOfWarp() {
  return static_cast<int>((blockIdx.x * blockDim.x + threadIdx.x) / kLanesPerWorld);
}

/// One warp per world.
__global__ void countContacts(const __grid_constant__ SolverData s, const __grid_constant__ Splice splice) {
  const int world = worldOfWarp(), lane = static_cast<int>(threadIdx.x % kLanesPerWorld);
  if (world >= s.worlds) return;
  const Source source(s, splice, world);
  int rows = 0;
  for (int k = source.manifolds + lane; k < source.manifoldsEnd; k += kLanesPerWorld)
    rows += source.from->manifold[k].row >= 0;
  rows = static_cast<int>(__reduce_add_sync(kAll, static_cast<unsigned>(rows)));
  if (lane == 0)
    splice.counts[world] = {source.pairsEnd - source.pairs, source.manifoldsEnd - source.manifolds, rows};
}

/// Replaces the counts by the sums of those before, in one block.
__global__ void scanCounts(ContactCounts* counts, int worlds) {
  using Scan = cub::BlockScan<int, kScanThreads>;
  __shared__ typename Scan::TempStorage storage;
  const int thread = static_cast<int>(threadIdx.x);
  const int each = (worlds + kScanThreads - 1) / kScanThreads, begin = min(thread * each, worlds),
            end = min(begin + each, worlds);
  const auto scan = [&](int ContactCounts::*count) {
    int own = 0, before = 0, all = 0;
    for (int w = begin; w < end; ++w) own += counts[w].*count;
    Scan(storage).ExclusiveSum(own, before, all);
    for (int w = begin; w < end; ++w) {
      const int here = counts[w].*count;
      counts[w].*count = before;
      before += here;
    }
    if (thread == 0) counts[worlds].*count = all;
    __syncthreads();
  };
  scan(&ContactCounts::pairs), scan(&ContactCounts::active), scan(&ContactCounts::rows);
}

/// One warp per world.
__global__ void writeContacts(const __grid_constant__ SolverData s, const __grid_constant__ Splice splice) {
  const int world = worldOfWarp(), lane = static_cast<int>(threadIdx.x % kLanesPerWorld);
  if (world >= s.worlds) return;
  const Source source(s, splice, world);
  const ContactTables& from = *source.from;
  const ContactCounts to = splice.counts[world], all = splice.counts[s.worlds];
  const int body = s.firstBody[world];
  for (int i = lane; i < source.bodies; i += kLanesPerWorld)
    s.oldPairOffset[body + i] = from.pairOffset[source.firstBody + i] - source.pairs + to.pairs;
  for (int k = source.pairs + lane; k < source.pairsEnd; k += kLanesPerWorld) {
    const int place = to.pairs + k - source.pairs;
    s.oldPair[place] = from.pair[k];
    s.oldPairTest[place] = from.test[k];
    s.oldActivePairOffset[place] = from.activeOffset[k] - source.manifolds + to.active;
  }
  int rows = to.rows;
  for (int first = source.manifolds; first < source.manifoldsEnd; first += kLanesPerWorld) {
    const int k = first + lane, place = to.active + k - source.manifolds;
    const bool on = k < source.manifoldsEnd;
    Manifold manifold;
    if (on) manifold = from.manifold[k];
    const bool hasRow = on && manifold.row >= 0;
    const unsigned having = __ballot_sync(kAll, hasRow);
    if (hasRow) {
      ContactRows row = from.row[manifold.row];
      row.manifold = place;
      manifold.row = rows + __popc(having & ((1u << lane) - 1));
      s.contact[manifold.row] = row;
    }
    if (on) s.oldManifold[place] = manifold;
    if (on && s.rolledBefore) s.oldRolling[place] = from.rolling ? from.rolling[k] : RollingRows{};
    rows += __popc(having);
  }
  if (world + 1 < s.worlds) return;
  // bodies of no world own no pairs
  for (int i = s.firstBody[s.worlds] + lane; i <= s.bodies; i += kLanesPerWorld)
    s.oldPairOffset[i] = all.pairs;
  if (lane == 0) s.oldActivePairOffset[all.pairs] = all.active;
}

/// One thread per word. `words`: those of an element of a body.
__global__ void putBackBodies(const __grid_constant__ SolverData s, int* to, const int* from, int words) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  const std::size_t body = i / static_cast<std::size_t>(words);
  if (body < static_cast<std::size_t>(s.firstBody[s.worlds]) && s.paused[s.worldOfBody[body]] != 0)
    to[i] = from[i];
}
template <class F>
__global__ void putBackJoints(const __grid_constant__ SolverData s, const Joint<F>* from, int count) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= count) return;
  const JointSpec<F>& spec = s.specsOf<F>()[i];
  const int body = spec.a >= 0 ? spec.a : spec.b;
  if (body >= 0 && s.paused[s.worldOfBody[body]] != 0) s.jointsOf<F>()[i] = from[i];
}

unsigned blocksFor(std::size_t threads) { return static_cast<unsigned>((threads + kBlock - 1) / kBlock); }
std::size_t size(int n) { return static_cast<std::size_t>(n); }

}  // namespace

void countSplice(cudaStream_t stream, const SolverData& device, const Splice& splice) {
  countContacts<<<blocksFor(size(device.worlds) * kLanesPerWorld), kBlock, 0, stream>>>(device, splice);
  checkCuda(cudaGetLastError(), "countContacts");
  scanCounts<<<1, kScanThreads, 0, stream>>>(splice.counts, device.worlds);
  checkCuda(cudaGetLastError(), "scanCounts");
}

void writeSplice(cudaStream_t stream, const SolverData& device, const Splice& splice) {
  writeContacts<<<blocksFor(size(device.worlds) * kLanesPerWorld), kBlock, 0, stream>>>(device, splice);
  checkCuda(cudaGetLastError(), "writeContacts");
}

void putBackPaused(cudaStream_t stream, const SolverData& device, const SolverData& copy) {
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (array.life != Lifetime::State || !isBodyState(array)) return;
    static_assert(sizeof(T) % sizeof(int) == 0);
    constexpr int kWords = static_cast<int>(sizeof(T) / sizeof(int));
    if (device.bodies == 0) return;
    putBackBodies<<<blocksFor(size(device.bodies) * kWords), kBlock, 0, stream>>>(
        device, reinterpret_cast<int*>(&(device.*array.member)[0]),
        reinterpret_cast<const int*>(&(copy.*array.member)[0]), kWords);
    checkCuda(cudaGetLastError(), "putBackBodies");
  });
  forEachType(JointTypes{}, [&]<class F>() {
    const int count = device.joints[typeIndex<F>(JointTypes{})];
    if (count == 0) return;
    putBackJoints<F><<<blocksFor(size(count)), kBlock, 0, stream>>>(device, copy.jointsOf<F>(), count);
    checkCuda(cudaGetLastError(), "putBackJoints");
  });
}

}  // namespace rubble::RUBBLE_CORE

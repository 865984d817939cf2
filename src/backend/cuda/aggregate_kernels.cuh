#pragma once
/// Kernels of the coarse correction. A tile of lanes per slice strides over nodes, constraints, points or
/// slices.
#include "backend/cuda/long_list_kernels.cuh"
#include "backend/peers/peer_data.h"

namespace rubble::RUBBLE_CORE {

/// FlattenAggregates with warp aggregation: one lane counts all bodies of a warp that have the same root.
/// Aggregates of coarse levels are few and large.
struct FlattenAggregatesByBlock {
  static constexpr const char* kStage = FlattenAggregates::kStage;
  int level;
  explicit FlattenAggregatesByBlock(const FlattenAggregates& stage) : level(stage.level) {}
  __device__ void operator()(const SolverData& s, int i) const {
    const int root = flatten(s, level, i);
    if (!mayJoin(s, i)) return;
    const unsigned same = __match_any_sync(__activemask(), root);
    if (static_cast<int>(threadIdx.x % kWarp) == __ffs(static_cast<int>(same)) - 1)
      atomicCount(&s.nodeCount[atLevel(s, level, root)], __popc(same));
  }
};
template <> struct OnDevice<FlattenAggregates> { using Type = FlattenAggregatesByBlock; };

/// Lanes per slice: few where it is small, else a warp. Joints and soft nodes take long when one lane handles
/// several. So a world that is no batch has narrow slices only if it has no soft nodes, and fewer joints than
/// one per kBodiesPerJoint bodies.
inline constexpr int kSmallWidth = 8, kBodiesPerJoint = 4;
__host__ __device__ inline bool hasNarrowSlices(const SolverData& s) {
  return s.anyKinds || (s.softNodes == 0 && kBodiesPerJoint * s.jointSlots() < s.bodies);
}
/// Those of all slices of a level, but for narrow ones. Aggregates of the finest level are small.
__host__ __device__ inline int sliceWidth(const SolverData& s, int level) {
  return level == 0 && hasNarrowSlices(s) ? kSmallWidth : kWarp;
}
/// Is the slice a whole aggregate of so few nodes and constraints that kSmallWidth lanes sum it? That takes
/// them a round for the nodes and up to eight for the constraints, of which kLanes lanes share one.
__device__ inline bool isNarrow(const SolverData& s, int slice) {
  constexpr int kMostConstraints = 8 * (kSmallWidth / kLanes);
  const Slice& own = s.slice[slice];
  const Aggregate& aggregate = s.aggregate[own.aggregate];
  return own.end - own.begin <= kSmallWidth && aggregate.sliceEnd - aggregate.sliceBegin == 1 &&
         s.boundaryOffset[slice + 1] - s.boundaryOffset[slice] <= kMostConstraints;
}

/// Slice sums are reduced to the sum of an aggregate by a tree whose fan-in is the tile width. The last child
/// to arrive adds up all children of a node, in index order. kSumLevels levels cover kSmallWidth^8 slices.
inline constexpr int kSumLevels = 8;
struct SumTree {
  /// [kSumLevels][slices] number of children that have arrived. Zero between kernels.
  int* tickets;
  int slices;
  PeerOwners owners{};  ///< of slices
  /// [aggregates] 1: sums of its slices go to other devices before they are passed on (passSumsOn).
  const std::uint8_t* mixed = nullptr;

  /// Passes the sum of slice `c` up the reduction tree. Returns true in the tile that completes the
  /// aggregate.
  template <int kWidth>
  __device__ bool carryUp(const SolverData& s, const Aggregate& aggregate, int c, const Tile<kWidth>& tile,
                          Real (&sum)[kRealsPerLane<kWidth>]) const {
    if (mixed && mixed[s.slice[c].aggregate]) {
      storeSums(tile, sum, s.slice[c].sum);
      return false;
    }
    int place = c - aggregate.sliceBegin, count = aggregate.sliceEnd - aggregate.sliceBegin, stride = 1;
    for (int level = 0; count > 1; ++level) {
      storeSums(tile, sum, s.slice[aggregate.sliceBegin + place * stride].sum);
      const int first = place / kWidth * kWidth, children = min(kWidth, count - first),
                node = aggregate.sliceBegin + first * stride;
      int* const ticket = tickets + level * slices + node;
      __threadfence();
      __syncwarp(tile.mask);
      int come = 0;
      if (tile.lane == 0) come = atomicAdd(ticket, 1) + 1;
      if (__shfl_sync(tile.mask, come, 0, kWidth) < children) return false;
      __threadfence();
      if (tile.lane == 0) *ticket = 0;
      Block6 own;
      if (tile.lane < children) own = loadFresh(s.slice[node + tile.lane * stride].sum);
      sumBlocks(tile, own, sum);
      place = first / kWidth, count = (count + kWidth - 1) / kWidth, stride *= kWidth;
    }
    return true;
  }

 private:
  /// Loads a block that other thread blocks wrote within this kernel.
  __device__ static Block6 loadFresh(const Block6& from) {
    Real v[kBlockReals];
    const Real* const numbers = reinterpret_cast<const Real*>(&from);
#pragma unroll
    for (int k = 0; k < kBlockReals; ++k) v[k] = __ldcg(numbers + k);
    Block6 block;
    memcpy(static_cast<void*>(&block), v, sizeof block);
    return block;
  }
};

/// SumInertia and PlaceAggregates fused: the tile that completes the sum of an aggregate places it.
struct SumInertiaByTile {
  static constexpr const char* kStage = SumInertia::kStage;
  static constexpr int kWidth = kSmallWidth;
  SumTree tree;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Slice& slice = s.slice[i];
    Aggregate& aggregate = s.aggregate[slice.aggregate];
    const Vec3d origin = originOf(s, slice);
    Block6 own;
    for (int k = slice.begin + tile.lane; k < slice.end; k += kWidth)
      addInertia(s, aggregate, origin, s.aggregateNode[k], own);
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, own, sums);
    if (!tree.carryUp(s, aggregate, i, tile, sums)) return;
    const Block6 all = gatherSums(tile, sums);
    if (tile.lane == 0) placeAggregate(aggregate, origin, all);
  }
};

struct CountBoundaryByTile {
  static constexpr const char* kStage = CountBoundary::kStage;
  static constexpr int kWidth = kSmallWidth;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Slice& slice = s.slice[i];
    const int level = s.aggregate[slice.aggregate].level;
    int count = 0;
    for (int k = slice.begin + tile.lane; k < slice.end; k += kWidth)
      visitBoundaryOf(s, s.aggregateNode[k], level, [&](std::uint32_t) { ++count; });
    count = tile.sum(count);
    if (tile.lane == 0) s.boundaryCount[i] = count;
  }
};
template <> struct OnDevice<CountBoundary> { using Type = CountBoundaryByTile; };

/// A slice is long if its tile would take more rounds than this in a sweep, with one constraint per four
/// lanes and round.
inline constexpr int kLongRounds = 32;
__device__ inline bool isLongSlice(const SolverData& s, int slice, int level) {
  return s.boundaryOffset[slice + 1] - s.boundaryOffset[slice] > kLongRounds * sliceWidth(s, level) / kLanes;
}

/// FillBoundary in the order of the serial kernel. It also lists long slices.
struct FillBoundaryByTile {
  static constexpr const char* kStage = FillBoundary::kStage;
  static constexpr int kWidth = kSmallWidth;
  LongList longSlices;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Slice& slice = s.slice[i];
    const int level = s.aggregate[slice.aggregate].level;
    if (tile.lane == 0 && isLongSlice(s, i, level)) longSlices.add(i);
    int first = s.boundaryOffset[i];
    for (int base = slice.begin; base < slice.end; base += kWidth) {
      const int k = base + tile.lane;
      const bool on = k < slice.end;
      int count = 0;
      if (on) visitBoundaryOf(s, s.aggregateNode[k], level, [&](std::uint32_t) { ++count; });
      int to = first + tile.sumBefore(count);
      if (on)
        visitBoundaryOf(s, s.aggregateNode[k], level, [&](std::uint32_t code) { s.boundary[to++] = code; });
      first += tile.sum(count);
    }
  }
};
/// Adds the joints among the boundary constraints [k, end), one per lane. Not inlined: joints are rare and
/// would raise the register count of kernels that mostly process contacts.
static __device__ __noinline__ void addBoundaryJointsOutOfLine(const SolverData& s, int aggregate, int k,
                                                               int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.boundary[k]; constraintType(code) != kContactType)
      addBoundaryJoint(s, aggregate, code, *sum);
}

/// The same for worlds with few joints (ExtraRows::FewJoints), where the time is that of one joint. A tile
/// visits `kWidth` constraints at a time from `k` on, `stride` apart, and compacts the joints until each
/// lane has one. The joints of a round run in parallel.
template <int kWidth>
static __device__ __noinline__ void addBoundaryJointsUniform(const SolverData& s, int aggregate, int k,
                                                             int end, int stride, const Tile<kWidth> tile,
                                                             Block6* sum) {
  const auto nthBit = [](unsigned bits, int n) {
    for (; n > 0; --n) bits &= bits - 1;
    return __ffs(static_cast<int>(bits)) - 1;
  };
  std::uint32_t own = 0;
  int have = 0;
  for (; k < end; k += stride) {
    const int e = k + tile.lane;
    const std::uint32_t code = e < end ? s.boundary[e] : 0;
    const unsigned joints = tile.ballot(e < end && constraintType(code) != kContactType);
    const int found = __popc(joints);
    // joint n goes to lane `first` + n
    const auto take = [&](int first) {
      const int n = tile.lane - first;
      const bool mine = n >= 0 && n < found;
      const std::uint32_t given = __shfl_sync(tile.mask, code, mine ? nthBit(joints, n) : tile.lane, kWidth);
      if (mine) own = given;
    };
    take(have);
    have += found;
    if (have < kWidth) continue;
    addBoundaryJointUniform(s, aggregate, own, *sum);
    have -= kWidth;
    take(have - found);
  }
  if (tile.lane < have) addBoundaryJointUniform(s, aggregate, own, *sum);
}

static __device__ __noinline__ void addBoundaryRollingOutOfLine(const SolverData& s, int k, int end,
                                                                int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.boundary[k]; constraintType(code) == kContactType)
      addRolling(s, code, *sum);
}

/// This lane's share of the forces and Hessians of a slice, divided among `kWidth` lanes. The tile is a warp
/// or less of them. any() is a vote of the tile.
template <int kWidth, bool uniform, int kTile, class Any>
__device__ Block6 gatherSlice(const SolverData& s, int i, const Slice& slice, const Aggregate& aggregate,
                              const Tile<kTile>& tile, int lane, Any&& any) {
  // one lane per contact point: four lanes share a constraint
  constexpr int kStride = kWidth / kLanes;
  const int begin = s.boundaryOffset[i] + lane / kLanes, end = s.boundaryOffset[i + 1], point = lane % kLanes;
  std::uint32_t next = begin < end ? s.boundary[begin] : 0;  // asked for before the nodes
  Block6 own;
  for (int k = slice.begin + lane; k < slice.end; k += kWidth)
    addInertialForce(s, aggregate, s.aggregateNode[k], own);
  if (aggregate.soft) {
    Block6 sum = own;
    addSoftNodes(s, slice.begin + lane, slice.end, kWidth, sum);
    own = sum;
  }
  bool joints = false;
  for (int k = begin; k < end; k += kStride) {
    const std::uint32_t code = next;
    if (k + kStride < end) next = s.boundary[k + kStride];
    if (constraintType(code) == kContactType)
      addBoundaryContact<Real>(s, aggregate, s.contact[constraintIndex(code)], constraintSide(code), point,
                               own);
    else
      joints = true;
  }
  if (s.rolls && point == 0) {
    Block6 sum = own;
    addBoundaryRollingOutOfLine(s, begin, end, kStride, &sum);
    own = sum;
  }
  if (any(joints)) {
    Block6 sum = own;
    if constexpr (uniform)
      addBoundaryJointsUniform(s, slice.aggregate, s.boundaryOffset[i] + (lane - tile.lane), end, kWidth,
                               tile, &sum);
    else
      addBoundaryJointsOutOfLine(s, slice.aggregate, s.boundaryOffset[i] + lane, end, kWidth, &sum);
    own = sum;
  }
  return own;
}

/// Passes the sums of a slice on. The tile that completes the aggregate solves it.
template <int kTile>
__device__ void handOn(const SolverData& s, const SumTree& tree, int i, Aggregate& aggregate,
                       const Tile<kTile>& tile, Real (&sums)[kRealsPerLane<kTile>]) {
  if (!tree.carryUp(s, aggregate, i, tile, sums)) return;
  Block6 block = aggregate.inertia;
  block += gatherSums(tile, sums);
  const Vec6 dx = aggregateStep(s, aggregate, block);
  if (tile.lane == 0) aggregate.step = dx;
}

/// A long slice, processed by a thread block.
template <int kTile, bool uniform>
__device__ __noinline__ void sumLongSlice(const SolverData& s, const SumTree& tree, int i,
                                          Real (&warpSums)[kThreads / kWarp][kWarp]) {
  const Slice slice = s.slice[i];
  Aggregate& aggregate = s.aggregate[slice.aggregate];
  const int thread = static_cast<int>(threadIdx.x);
  const Block6 own = gatherSlice<kThreads, uniform>(s, i, slice, aggregate, Tile<kWarp>::ofThread(), thread,
                                                    [](bool yes) { return __syncthreads_or(yes) != 0; });
  Real mine[kRealsPerLane<kWarp>];
  sumBlocks(Tile<kWarp>::ofThread(), own, mine);
  warpSums[thread / kWarp][thread % kWarp] = mine[0];
  __syncthreads();
  if (thread < kTile) {
    Real sums[kRealsPerLane<kTile>];
#pragma unroll
    for (int k = 0; k < kRealsPerLane<kTile>; ++k) {
      sums[k] = 0;
      for (int w = 0; w < kThreads / kWarp; ++w) sums[k] += warpSums[w][thread * kRealsPerLane<kTile> + k];
    }
    handOn(s, tree, i, aggregate, Tile<kTile>::ofThread(), sums);
  }
  __syncthreads();
}

/// SumSlice and SolveAggregate fused, for the slices of a level (`softOnly`: of aggregates with soft nodes).
/// The first blocks process long slices, each tile of the other blocks one slice. Slices of coarse levels
/// that are narrow follow when the others are done.
template <int kTile, bool uniform>
__global__ void __launch_bounds__(kThreads, 6)
    sumSlices(const __grid_constant__ SolverData s, SumTree tree, LongList longSlices, int longBlocks,
              int level, bool softOnly, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  const auto isLeft = [&](int i) {
    return (softOnly && !s.aggregate[s.slice[i].aggregate].soft) || !tree.owners.isMine(i);
  };
  __shared__ Real warpSums[kThreads / kWarp][kWarp];
  const int begin = s.levelSlice[level], end = s.levelSlice[level + 1],
            block = static_cast<int>(blockIdx.x) - longBlocks;
  if (block < 0) {
    for (int h = static_cast<int>(blockIdx.x); h < *longSlices.count; h += longBlocks)
      if (const int i = longSlices.element[h]; i >= begin && i < end && !isLeft(i))
        sumLongSlice<kTile, uniform>(s, tree, i, warpSums);
    return;
  }
  const bool isMixed = kTile == kWarp && hasNarrowSlices(s);
  const auto sumEach = [&]<int kWidth>(const Tile<kWidth>& tile) {
    constexpr int kTiles = kThreads / kWidth;
    const int stride = (static_cast<int>(gridDim.x) - longBlocks) * kTiles;
    for (int i = begin + block * kTiles + static_cast<int>(threadIdx.x) / kWidth; i < end; i += stride) {
      if (isLongSlice(s, i, level) || isLeft(i) || (isMixed && isNarrow(s, i) != (kWidth == kSmallWidth)))
        continue;
      const Slice slice = s.slice[i];
      Aggregate& aggregate = s.aggregate[slice.aggregate];
      const Block6 own = gatherSlice<kWidth, uniform>(s, i, slice, aggregate, tile, tile.lane,
                                                      [&](bool yes) { return tile.ballot(yes) != 0; });
      Real sums[kRealsPerLane<kWidth>];
      sumBlocks(tile, own, sums);
      handOn(s, tree, i, aggregate, tile, sums);
    }
  };
  sumEach(Tile<kTile>::ofThread());
  if (isMixed) sumEach(Tile<kSmallWidth>::ofThread());
}

/// The second half of sumSlices, once all devices have the sums of all slices: in the same order.
template <int kTile>
__global__ void __launch_bounds__(kThreads) passSumsOn(const __grid_constant__ SolverData s, SumTree tree,
                                                       Count slices, int level, bool softOnly, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  const Tile<kTile> tile = Tile<kTile>::ofThread();
  const int n = slices.get(), stride = static_cast<int>(gridDim.x) * (kThreads / kTile);
  for (int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x) / kTile; k < n; k += stride) {
    const int i = slices.list[k];
    Aggregate& aggregate = s.aggregate[s.slice[i].aggregate];
    if (aggregate.level != level || (softOnly && !aggregate.soft)) continue;
    Real sums[kRealsPerLane<kTile>];
    loadSums(tile, s.slice[i].sum, sums);
    handOn(s, tree, i, aggregate, tile, sums);
  }
}

/// MoveSlice for all slices of a level, one thread per body. Bodies are contiguous in memory, the nodes of an
/// aggregate are not.
struct MoveNode {
  static constexpr const char* kStage = MoveSlice::kStage;
  int level;
  bool softOnly = false;
  __device__ void operator()(const SolverData& s, int body) const {
    if (const int aggregate = s.aggregateOf[atLevel(s, level, body)];
        aggregate >= 0 && (!softOnly || s.aggregate[aggregate].soft))
      moveWithAggregate(s, s.aggregate[aggregate], body);
  }
};

}  // namespace rubble::RUBBLE_CORE

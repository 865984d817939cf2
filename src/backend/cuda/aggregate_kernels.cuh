#pragma once
/// Stages of the coarse correction, a tile of lanes a slice: they stride over nodes, row blocks, points or
/// slices.
#include "backend/cuda/heavy_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Bodies of one warp that have the same root are counted by one of them: the aggregates of coarse levels are
/// few, and large.
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

/// Lanes of a slice: the aggregates of the finest level are small, those of the others fill their slices.
inline constexpr int kSmallWidth = 8;
/// In the sweeps: where there are many joints, one for so many bodies or fewer, or soft nodes, all have a
/// warp: these take long one after another.
inline constexpr int kBodiesPerJoint = 4;
__host__ __device__ inline int sliceWidth(const SolverData& s, int level) {
  return level == 0 && s.softNodes == 0 && kBodiesPerJoint * s.jointSlots() < s.bodies ? kSmallWidth : kWarp;
}

/// Sums of slices into those of their aggregate by a tree whose fan-in is the width of a tile: the last of a
/// node's children to come adds them up, in their order. The levels are enough for kSmallWidth^8 slices.
inline constexpr int kSumLevels = 8;
struct SumTree {
  int* tickets;  ///< [kSumLevels][slices] children that have come; zero between kernels
  int slices;

  /// Hands the sum of slice `c` up the tree; true in the tile that is left with the sum of the aggregate.
  template <int kWidth>
  __device__ bool carryUp(const SolverData& s, const Aggregate& aggregate, int c, const Tile<kWidth>& tile,
                          Real (&sum)[kRealsPerLane<kWidth>]) const {
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
  /// What other blocks have written in this kernel.
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

/// SumInertia and PlaceAggregates in one: the tile that completes the sum of an aggregate goes on with it.
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

/// Lanes of a slice in the sweeps, by the level of its aggregate. If they would take more rounds than this, a
/// row block for four lanes, it is a heavy one.
inline constexpr int kHeavyRounds = 32;
__device__ inline bool isHeavySlice(const SolverData& s, int slice, int level) {
  return s.boundaryOffset[slice + 1] - s.boundaryOffset[slice] > kHeavyRounds * sliceWidth(s, level) / kLanes;
}

/// In the order that one thread would write them. Lists heavy slices.
struct FillBoundaryByTile {
  static constexpr const char* kStage = FillBoundary::kStage;
  static constexpr int kWidth = kSmallWidth;
  HeavyList heavy;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Slice& slice = s.slice[i];
    const int level = s.aggregate[slice.aggregate].level;
    if (tile.lane == 0 && isHeavySlice(s, i, level)) heavy.add(i);
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
/// Adds the joints among external row blocks [k, end), a lane each. Rare, and large: a call keeps its
/// registers out of the kernels that contacts fill.
static __device__ __noinline__ void addBoundaryJointsOutOfLine(const SolverData& s, int aggregate, int k,
                                                               int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.boundary[k]; constraintType(code) != kContactType)
      addBoundaryJoint(s, aggregate, code, *sum);
}

/// The same where they are few and so take as long as one of them (ExtraRows::FewJoints): a tile, which has
/// `kWidth` row blocks at a time, from `k` on, `stride` apart, gathers them until every lane has one, and
/// those of one round are done side by side.
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
    // number n of them goes to lane `first` + n
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

/// Forces and row Hessians of a slice that are this lane's, of `kWidth`, a warp or less of which is a tile.
/// any(): does one of them say yes?
template <int kWidth, bool alike, int kTile, class Any>
__device__ Block6 gatherSlice(const SolverData& s, int i, const Slice& slice, const Aggregate& aggregate,
                              const Tile<kTile>& tile, int lane, Any&& any) {
  Block6 own;
  for (int k = slice.begin + lane; k < slice.end; k += kWidth)
    addInertialForce(s, aggregate, s.aggregateNode[k], own);
  if (aggregate.soft) {
    Block6 sum = own;
    addSoftNodes(s, slice.begin + lane, slice.end, kWidth, sum);
    own = sum;
  }
  // a lane a point: four lanes share a row block
  constexpr int kStride = kWidth / kLanes;
  const int begin = s.boundaryOffset[i] + lane / kLanes, end = s.boundaryOffset[i + 1], point = lane % kLanes;
  bool joints = false;
  std::uint32_t next = begin < end ? s.boundary[begin] : 0;
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
    if constexpr (alike)
      addBoundaryJointsUniform(s, slice.aggregate, s.boundaryOffset[i] + (lane - tile.lane), end, kWidth,
                               tile, &sum);
    else
      addBoundaryJointsOutOfLine(s, slice.aggregate, s.boundaryOffset[i] + lane, end, kWidth, &sum);
    own = sum;
  }
  return own;
}

/// Hands the sums of a slice on; the tile that completes those of an aggregate solves it.
template <int kTile>
__device__ void handOn(const SolverData& s, const SumTree& tree, int i, Aggregate& aggregate,
                       const Tile<kTile>& tile, Real (&sums)[kRealsPerLane<kTile>]) {
  if (!tree.carryUp(s, aggregate, i, tile, sums)) return;
  Block6 block = aggregate.inertia;
  block += gatherSums(tile, sums);
  const Vec6 dx = aggregateStep(s, aggregate, block);
  if (tile.lane == 0) aggregate.step = dx;
}

/// A heavy slice, by a block.
template <int kTile, bool alike>
__device__ __noinline__ void sumHeavySlice(const SolverData& s, const SumTree& tree, int i,
                                           Real (&warpSums)[kThreads / kWarp][kWarp]) {
  const Slice slice = s.slice[i];
  Aggregate& aggregate = s.aggregate[slice.aggregate];
  const int thread = static_cast<int>(threadIdx.x);
  const Block6 own = gatherSlice<kThreads, alike>(s, i, slice, aggregate, Tile<kWarp>::ofThread(), thread,
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

/// SumSlice and SolveAggregate in one, for the slices of a level (`softOnly`: of aggregates with soft nodes):
/// the first blocks take the heavy ones, tiles of the others one each.
template <int kTile, bool alike>
__global__ void __launch_bounds__(kThreads, 6)
    sumChunks(const __grid_constant__ SolverData s, SumTree tree, HeavyList heavy, int heavyBlocks, int level,
              bool softOnly, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  const auto isLeft = [&](int i) { return softOnly && !s.aggregate[s.slice[i].aggregate].soft; };
  __shared__ Real warpSums[kThreads / kWarp][kWarp];
  const int begin = s.levelSlice[level], end = s.levelSlice[level + 1],
            block = static_cast<int>(blockIdx.x) - heavyBlocks;
  if (block < 0) {
    for (int h = static_cast<int>(blockIdx.x); h < *heavy.count; h += heavyBlocks)
      if (const int i = heavy.element[h]; i >= begin && i < end && !isLeft(i))
        sumHeavySlice<kTile, alike>(s, tree, i, warpSums);
    return;
  }
  const Tile<kTile> tile = Tile<kTile>::ofThread();
  constexpr int kTiles = kThreads / kTile;
  const int stride = (static_cast<int>(gridDim.x) - heavyBlocks) * kTiles;
  for (int i = begin + block * kTiles + static_cast<int>(threadIdx.x) / kTile; i < end; i += stride) {
    if (isHeavySlice(s, i, level) || isLeft(i)) continue;
    const Slice slice = s.slice[i];
    Aggregate& aggregate = s.aggregate[slice.aggregate];
    const Block6 own = gatherSlice<kTile, alike>(s, i, slice, aggregate, tile, tile.lane,
                                                 [&](bool yes) { return tile.ballot(yes) != 0; });
    Real sums[kRealsPerLane<kTile>];
    sumBlocks(tile, own, sums);
    handOn(s, tree, i, aggregate, tile, sums);
  }
}

/// MoveSlice for all slices of a level, a thread a body: it knows its aggregate, and bodies lie side by side
/// where nodes do not.
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

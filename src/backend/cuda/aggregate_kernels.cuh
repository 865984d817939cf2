#pragma once
/// Kernels of the coarse correction. A tile of lanes per slice strides over nodes, constraints, points or
/// slices.
#include "backend/cuda/extra_rows.cuh"
#include "backend/cuda/long_list_kernels.cuh"
#include "backend/cuda/points.cuh"
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
      if (arrivalAt(ticket, tile) < children) return false;
      asm volatile("fence.acq_rel.gpu;" ::: "memory");
      if (tile.lane == 0) *ticket = 0;
      Block6 own;
      if (tile.lane < children) own = loadFresh(s.slice[node + tile.lane * stride].sum);
      sumBlocks(tile, own, sum);
      place = first / kWidth, count = (count + kWidth - 1) / kWidth, stride *= kWidth;
    }
    return true;
  }

 private:
  /// Counts a tile, whose stores become visible to those that come later. Returns how many have come. A fence
  /// of each lane would also empty the first-level cache each time.
  template <int kWidth> __device__ static int arrivalAt(int* ticket, const Tile<kWidth>& tile) {
    __syncwarp(tile.mask);
    int before = 0;
    if (tile.lane == 0)
      asm volatile("atom.add.release.gpu.s32 %0, [%1], 1;" : "=r"(before) : "l"(ticket) : "memory");
    return __shfl_sync(tile.mask, before, 0, kWidth) + 1;
  }
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
  static constexpr bool kOfSlices = true;
  SumTree tree;
  template <int kTile> __device__ void operator()(const SolverData& s, int i, const Tile<kTile>& tile) const {
    const Slice& slice = s.slice[i];
    Aggregate& aggregate = s.aggregate[slice.aggregate];
    const Vec3d origin = originOf(s, slice);
    Block6 own;
#pragma unroll 2  // the loads of two nodes are on their way at once
    for (int k = slice.begin + tile.lane; k < slice.end; k += kTile)
      addInertia(s, aggregate, origin, s.aggregateNode[k], own);
    Real sums[kRealsPerLane<kTile>];
    sumBlocks(tile, own, sums);
    if (!tree.carryUp(s, aggregate, i, tile, sums)) return;
    const Block6 all = gatherSums(tile, sums);
    if (tile.lane == 0) placeAggregate(aggregate, origin, all);
  }
};

struct CountBoundaryByTile {
  static constexpr const char* kStage = CountBoundary::kStage;
  static constexpr int kWidth = kSmallWidth;
  static constexpr bool kOfSlices = true;
  template <int kTile> __device__ void operator()(const SolverData& s, int i, const Tile<kTile>& tile) const {
    const Slice& slice = s.slice[i];
    const Aggregate& aggregate = s.aggregate[slice.aggregate];
    int count = 0;
    for (int k = slice.begin + tile.lane; k < slice.end; k += kTile)
      visitBoundaryOf(s, aggregate, s.aggregateNode[k], [&](const BoundaryConstraint&) { ++count; });
    count = tile.sum(count);
    if (tile.lane == 0) s.boundaryCount[i] = count;
  }
};
template <> struct OnDevice<CountBoundary> { using Type = CountBoundaryByTile; };

/// What a tile needs to know of a slice before it sums it: its nodes and its boundary constraints.
struct SliceRanges {
  int aggregate, begin, end;
  int boundaryBegin, boundaryEnd;
};
__device__ inline SliceRanges rangesOf(const SolverData& s, int slice) {
  const Slice& own = s.slice[slice];
  return {own.aggregate, own.begin, own.end, s.boundaryOffset[slice], s.boundaryOffset[slice + 1]};
}

/// A slice is long if its tile would take more rounds than this in a sweep, with one constraint per four
/// lanes and round.
inline constexpr int kLongRounds = 32;
__device__ inline bool isLongSlice(const SolverData& s, const SliceRanges& slice, int level) {
  return slice.boundaryEnd - slice.boundaryBegin > kLongRounds * sliceWidth(s, level) / kLanes;
}
/// Is the slice a whole aggregate of so few nodes and constraints that kSmallWidth lanes sum it? That takes
/// them a round for the nodes and up to eight for the constraints, of which kLanes lanes share one.
__device__ inline bool isNarrow(const SliceRanges& slice, const Aggregate& aggregate) {
  constexpr int kMostConstraints = 8 * (kSmallWidth / kLanes);
  return slice.end - slice.begin <= kSmallWidth && aggregate.sliceEnd - aggregate.sliceBegin == 1 &&
         slice.boundaryEnd - slice.boundaryBegin <= kMostConstraints;
}

/// FillBoundary in the order of the serial kernel. It also lists long slices.
struct FillBoundaryByTile {
  static constexpr const char* kStage = FillBoundary::kStage;
  static constexpr int kWidth = kSmallWidth;
  static constexpr bool kOfSlices = true;
  LongList longSlices;
  template <int kTile> __device__ void operator()(const SolverData& s, int i, const Tile<kTile>& tile) const {
    const Slice& slice = s.slice[i];
    const Aggregate& aggregate = s.aggregate[slice.aggregate];
    if (tile.lane == 0 && isLongSlice(s, rangesOf(s, i), aggregate.level)) longSlices.add(i);
    int first = s.boundaryOffset[i];
    for (int base = slice.begin; base < slice.end; base += kTile) {
      const int k = base + tile.lane;
      const bool on = k < slice.end;
      int count = 0;
      if (on) visitBoundaryOf(s, aggregate, s.aggregateNode[k], [&](const BoundaryConstraint&) { ++count; });
      int to = first + tile.sumBefore(count);
      if (on)
        visitBoundaryOf(s, aggregate, s.aggregateNode[k],
                        [&](const BoundaryConstraint& c) { storeWhole(s.boundary[to++], c); });
      first += tile.sum(count);
    }
  }
};
/// Adds the joints among the boundary constraints [k, end), one per lane. Not inlined: joints are rare and
/// would raise the register count of kernels that mostly process contacts.
static __device__ __noinline__ void addBoundaryJointsOutOfLine(const SolverData& s, int aggregate, int k,
                                                               int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.boundary[k].code; constraintType(code) != kContactType)
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
    const std::uint32_t code = e < end ? s.boundary[e].code : 0;
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
    if (const std::uint32_t code = s.boundary[k].code; constraintType(code) == kContactType)
      addRolling(s, code, *sum);
}

/// Adds this lane's share (of `kWidth`) of the inertial forces of a slice. The loads of several nodes are on
/// their way at once.
template <int kWidth>
__device__ void addInertialForces(const SolverData& s, const SliceRanges& slice, const Aggregate& aggregate,
                                  int lane, Block6& sum) {
  constexpr int kAhead = kWidth < kWarp ? 1 : 2;
  if (s.bodies == 0) return;
  for (int first = slice.begin + lane; first < slice.end; first += kAhead * kWidth) {
    int node[kAhead];
#pragma unroll
    for (int k = 0; k < kAhead; ++k) node[k] = s.aggregateNode[min(first + k * kWidth, slice.end - 1)];
    InertialState body[kAhead];
#pragma unroll
    for (int k = 0; k < kAhead; ++k) body[k] = inertialState(s, min(node[k], s.bodies - 1));
#pragma unroll
    for (int k = 0; k < kAhead; ++k)
      if (node[k] < s.bodies && first + k * kWidth < slice.end) addInertialForce(s, aggregate, body[k], sum);
  }
}

__device__ inline BoundaryConstraint boundaryAt(const SolverData& s, int k, int end) {
  return k < end ? loadUnchanging(s.boundary[k]) : BoundaryConstraint{kNoConstraint, {}};
}
/// Adds this lane's share of the contacts among the boundary constraints [k, end), of which `next` is the
/// first: the point of its number in each. Constraints are asked for two rounds ahead, their bodies one
/// round. Returns whether there are other constraints.
template <int kStride>
__device__ bool addBoundaryContacts(const SolverData& s, const Aggregate& aggregate, int k, int end,
                                    BoundaryConstraint next, Block6& sum) {
  const auto bodiesOf = [&](const BoundaryConstraint& c) {
    if (constraintType(c.code) != kContactType) return int2{-1, -1};
    const ContactRows& r = s.contact[constraintIndex(c.code)];
    return int2{r.a, r.b};
  };
  const PointTile tile = PointTile::ofThread();
  BoundaryConstraint afterNext = boundaryAt(s, k + kStride, end);
  int2 nextBodies = bodiesOf(next);
  bool others = false;
  for (; k < end; k += kStride) {
    const BoundaryConstraint own = next;
    const int2 bodies = nextBodies;
    next = afterNext, afterNext = boundaryAt(s, k + 2 * kStride, end);
    nextBodies = bodiesOf(next);
    if (constraintType(own.code) == kContactType)
      addBoundaryContact<Real>(s, aggregate, own, rowsOfPoint(s.contact[constraintIndex(own.code)], tile),
                               bodies.x, bodies.y, 0, sum);
    else
      others = true;
  }
  return others;
}

/// This lane's share of the forces and Hessians of a slice, divided among `kWidth` lanes. The tile is a warp
/// or less of them. any() is a vote of the tile.
template <int kWidth, ExtraRows extra, int kTile, class Any>
__device__ Block6 gatherSlice(const SolverData& s, const SliceRanges& slice, const Aggregate& aggregate,
                              const Tile<kTile>& tile, int lane, Any&& any) {
  // one lane per contact point: four lanes share a constraint
  constexpr int kStride = kWidth / kLanes;
  const int begin = slice.boundaryBegin + lane / kLanes, end = slice.boundaryEnd;
  const BoundaryConstraint first = boundaryAt(s, begin, end);  // asked for before the nodes
  Block6 own;
  addInertialForces<kWidth>(s, slice, aggregate, lane, own);
  if constexpr (extra != ExtraRows::None)
    if (aggregate.soft) {
      Block6 sum = own;
      addSoftNodes(s, slice.begin + lane, slice.end, kWidth, sum);
      own = sum;
    }
  const bool joints = addBoundaryContacts<kStride>(s, aggregate, begin, end, first, own);
  if constexpr (extra != ExtraRows::None) {
    if (s.rolls && lane % kLanes == 0) {
      Block6 sum = own;
      addBoundaryRollingOutOfLine(s, begin, end, kStride, &sum);
      own = sum;
    }
    if (any(joints)) {
      Block6 sum = own;
      if constexpr (extra == ExtraRows::FewJoints)
        addBoundaryJointsUniform(s, slice.aggregate, slice.boundaryBegin + (lane - tile.lane), end, kWidth,
                                 tile, &sum);
      else
        addBoundaryJointsOutOfLine(s, slice.aggregate, slice.boundaryBegin + lane, end, kWidth, &sum);
      own = sum;
    }
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
template <int kTile, ExtraRows extra>
__device__ void sumLongSlice(const SolverData& s, const SumTree& tree, int i,
                             Real (&warpSums)[kThreads / kWarp][kWarp]) {
  const SliceRanges slice = rangesOf(s, i);
  Aggregate& aggregate = s.aggregate[slice.aggregate];
  const int thread = static_cast<int>(threadIdx.x);
  const Block6 own = gatherSlice<kThreads, extra>(s, slice, aggregate, Tile<kWarp>::ofThread(), thread,
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

/// The same where constraints are summed by calls anyhow, so that their code is there once.
template <int kTile, ExtraRows extra>
__device__ __noinline__ void sumLongSliceOutOfLine(const SolverData& s, const SumTree& tree, int i,
                                                   Real (&warpSums)[kThreads / kWarp][kWarp]) {
  sumLongSlice<kTile, extra>(s, tree, i, warpSums);
}

/// Resident blocks of a multiprocessor. Without calls no register is spilled with five.
template <ExtraRows extra> inline constexpr int kSliceBlocks = extra == ExtraRows::None ? 5 : 6;
/// Nodes for which there is a tile. With calls there are only as many blocks as are resident; without, blocks
/// that queue even out what slices cost (docs/research/tuning-log.md).
template <int kTile, ExtraRows extra>
inline constexpr int kNodesPerTile = extra == ExtraRows::None&& kTile == kWarp ? kSliceNodes / 2
                                                                               : kSmallWidth;

/// SumSlice and SolveAggregate fused, for the slices of a level (`softOnly`: of aggregates with soft nodes).
/// The first blocks process long slices, each tile of the other blocks one slice. Slices of coarse levels
/// that are narrow follow when the others are done.
template <int kTile, ExtraRows extra>
__global__ void __launch_bounds__(kThreads, kSliceBlocks<extra>)
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
        if constexpr (extra == ExtraRows::None)
          sumLongSlice<kTile, extra>(s, tree, i, warpSums);
        else
          sumLongSliceOutOfLine<kTile, extra>(s, tree, i, warpSums);
    return;
  }
  const bool isMixed = kTile == kWarp && hasNarrowSlices(s);
  const auto sumEach = [&]<int kWidth>(const Tile<kWidth>& tile) {
    constexpr int kTiles = kThreads / kWidth;
    const int stride = (static_cast<int>(gridDim.x) - longBlocks) * kTiles;
    const int firstOfBlock = begin + block * kTiles, thread = static_cast<int>(threadIdx.x),
              tileOfWarp = thread % kWarp / kWidth;
    SliceRanges next{};
    const auto askFor = [&](int i) {
      if (i < end) next = rangesOf(s, i);
    };
    int firstOfWarp = firstOfBlock + thread / kWarp * (kWarp / kWidth);
    askFor(firstOfWarp + tileOfWarp);
    for (; firstOfWarp < end; firstOfWarp += stride) {
      const int i = firstOfWarp + tileOfWarp;
      const SliceRanges slice = next;
      askFor(i + stride);
      Aggregate& aggregate = s.aggregate[slice.aggregate];
      const bool on = i < end && !isLongSlice(s, slice, level) && !isLeft(i) &&
                      (!isMixed || isNarrow(slice, aggregate) == (kWidth == kSmallWidth));
      Block6 own;
      if (on)
        own = gatherSlice<kWidth, extra>(s, slice, aggregate, tile, tile.lane,
                                         [&](bool yes) { return tile.ballot(yes) != 0; });
      __syncwarp();  // the tiles of a warp took different numbers of rounds, and add up together
      Real sums[kRealsPerLane<kWidth>];
      sumBlocks(tile, own, sums);
      if (on) handOn(s, tree, i, aggregate, tile, sums);
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

#pragma once
/// Stages of the coarse correction, a tile of lanes a chunk: they stride over members, row blocks, points or chunks.
#include "backend/cuda/heavy_kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Bodies of one warp that have the same leader are counted by one of them: the groups of coarse levels are few, and large.
struct FlattenGroupsTogether {
  static constexpr const char* kName = FlattenGroups::kName;
  int level;
  explicit FlattenGroupsTogether(const FlattenGroups& stage) : level(stage.level) {}
  __device__ void operator()(const View& s, int i) const {
    const int leader = flatten(s, level, i);
    if (!mayJoin(s, i)) return;
    const unsigned same = __match_any_sync(__activemask(), leader);
    if (static_cast<int>(threadIdx.x % kWarp) == __ffs(static_cast<int>(same)) - 1)
      atomicCount(&s.memberCount[atLevel(s, level, leader)], __popc(same));
  }
};
template <>
struct OnDevice<FlattenGroups> {
  using Type = FlattenGroupsTogether;
};

/// Lanes of a chunk: the groups of the finest level are small, those of the others fill their chunks.
inline constexpr int kSmallWidth = 8;
/// In the sweeps: where there are many joints, one for so many bodies or fewer, or lumps, all have a warp: these take long one after another.
inline constexpr int kBodiesPerJoint = 4;
__host__ __device__ inline int chunkWidth(const View& s, int level) {
  return level == 0 && s.lumps == 0 && kBodiesPerJoint * s.jointSlots() < s.bodies ? kSmallWidth : kWarp;
}

/// Sums of chunks into those of their group by a tree whose fan-in is the width of a tile: the last of a node's children to come adds them
/// up, in their order. The levels are enough for kSmallWidth^8 chunks.
inline constexpr int kTreeLevels = 8;
struct SumTree {
  int* tickets;  ///< [kTreeLevels][chunks] children that have come; zero between kernels
  int chunks;

  /// Hands the sum of chunk `c` up the tree; true in the tile that is left with the sum of the group.
  template <int kWidth>
  __device__ bool carryUp(const View& s, const Group& group, int c, const Tile<kWidth>& tile, Real (&sum)[kRealsPerLane<kWidth>]) const {
    int place = c - group.chunkBegin, count = group.chunkEnd - group.chunkBegin, stride = 1;
    for (int level = 0; count > 1; ++level) {
      storeSums(tile, sum, s.chunk[group.chunkBegin + place * stride].sum);
      const int first = place / kWidth * kWidth, children = min(kWidth, count - first), node = group.chunkBegin + first * stride;
      int* const ticket = tickets + level * chunks + node;
      __threadfence();
      __syncwarp(tile.mask);
      int come = 0;
      if (tile.lane == 0) come = atomicAdd(ticket, 1) + 1;
      if (__shfl_sync(tile.mask, come, 0, kWidth) < children) return false;
      __threadfence();
      if (tile.lane == 0) *ticket = 0;
      Block6 own;
      if (tile.lane < children) own = loadFresh(s.chunk[node + tile.lane * stride].sum);
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

/// SumInertia and PlaceGroups in one: the tile that completes the sum of a group goes on with it.
struct SumInertiaByTile {
  static constexpr const char* kName = SumInertia::kName;
  static constexpr int kWidth = kSmallWidth;
  SumTree tree;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Chunk& chunk = s.chunk[i];
    Group& group = s.group[chunk.group];
    const Vec3d origin = originOf(s, chunk);
    Block6 own;
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth) addInertia(s, group, origin, s.member[k], own);
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, own, sums);
    if (!tree.carryUp(s, group, i, tile, sums)) return;
    const Block6 all = gatherSums(tile, sums);
    if (tile.lane == 0) placeGroup(group, origin, all);
  }
};

struct CountExternalsByTile {
  static constexpr const char* kName = CountExternals::kName;
  static constexpr int kWidth = kSmallWidth;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Chunk& chunk = s.chunk[i];
    const int level = s.group[chunk.group].level;
    int count = 0;
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth)
      visitExternalsOf(s, s.member[k], level, [&](std::uint32_t) { ++count; });
    count = tile.sum(count);
    if (tile.lane == 0) s.externalCount[i] = count;
  }
};
template <>
struct OnDevice<CountExternals> {
  using Type = CountExternalsByTile;
};

/// Lanes of a chunk in the sweeps, by the level of its group. If they would take more rounds than this, a row block for four lanes, it is a heavy one.
inline constexpr int kHeavyRounds = 32;
__device__ inline bool isHeavyChunk(const View& s, int chunk, int level) {
  return s.externalOffset[chunk + 1] - s.externalOffset[chunk] > kHeavyRounds * chunkWidth(s, level) / kLanes;
}

/// In the order that one thread would write them. Lists heavy chunks.
struct FillExternalsByTile {
  static constexpr const char* kName = FillExternals::kName;
  static constexpr int kWidth = kSmallWidth;
  HeavyList heavy;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Chunk& chunk = s.chunk[i];
    const int level = s.group[chunk.group].level;
    if (tile.lane == 0 && isHeavyChunk(s, i, level)) heavy.add(i);
    int first = s.externalOffset[i];
    for (int base = chunk.begin; base < chunk.end; base += kWidth) {
      const int k = base + tile.lane;
      const bool on = k < chunk.end;
      int count = 0;
      if (on) visitExternalsOf(s, s.member[k], level, [&](std::uint32_t) { ++count; });
      int to = first + tile.sumBefore(count);
      if (on) visitExternalsOf(s, s.member[k], level, [&](std::uint32_t code) { s.external[to++] = code; });
      first += tile.sum(count);
    }
  }
};
/// Adds the joints among external row blocks [k, end), a lane each. Rare, and large: a call keeps its registers out of the kernels that
/// contacts fill.
static __device__ __noinline__ void addExternalJointsApart(const View& s, int group, int k, int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.external[k]; entryType(code) != kContactType) addExternalJoint(s, group, code, *sum);
}

/// The same where they are few and so take as long as one of them (RareRows::FewJoints): a tile, which has `kWidth` row blocks at a time, from `k` on,
/// `stride` apart, gathers them until every lane has one, and those of one round are done side by side.
template <int kWidth>
static __device__ __noinline__ void addExternalJointsAlike(const View& s, int group, int k, int end, int stride, const Tile<kWidth> tile, Block6* sum) {
  const auto nthBit = [](unsigned bits, int n) {
    for (; n > 0; --n) bits &= bits - 1;
    return __ffs(static_cast<int>(bits)) - 1;
  };
  std::uint32_t own = 0;
  int have = 0;
  for (; k < end; k += stride) {
    const int e = k + tile.lane;
    const std::uint32_t code = e < end ? s.external[e] : 0;
    const unsigned joints = tile.ballot(e < end && entryType(code) != kContactType);
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
    addExternalJointAlike(s, group, own, *sum);
    have -= kWidth;
    take(have - found);
  }
  if (tile.lane < have) addExternalJointAlike(s, group, own, *sum);
}

static __device__ __noinline__ void addExternalRollingApart(const View& s, int k, int end, int stride, Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.external[k]; entryType(code) == kContactType) addRolling(s, code, *sum);
}

/// Forces and row Hessians of a chunk that are this lane's, of `kWidth`, a warp or less of which is a tile. any(): does one of them say yes?
template <int kWidth, bool alike, int kTile, class Any>
__device__ Block6 gatherChunk(const View& s, int i, const Chunk& chunk, const Group& group, const Tile<kTile>& tile, int lane, Any&& any) {
  Block6 own;
  for (int k = chunk.begin + lane; k < chunk.end; k += kWidth) addInertialForce(s, group, s.member[k], own);
  if (group.soft) {
    Block6 sum = own;
    addLumps(s, chunk.begin + lane, chunk.end, kWidth, sum);
    own = sum;
  }
  // a lane a point: four lanes share a row block
  constexpr int kStride = kWidth / kLanes;
  const int begin = s.externalOffset[i] + lane / kLanes, end = s.externalOffset[i + 1], point = lane % kLanes;
  bool joints = false;
  std::uint32_t next = begin < end ? s.external[begin] : 0;
  for (int k = begin; k < end; k += kStride) {
    const std::uint32_t code = next;
    if (k + kStride < end) next = s.external[k + kStride];
    if (entryType(code) == kContactType)
      addExternalContact<Real>(s, group, s.contact[entryIndex(code)], entrySide(code), point, own);
    else
      joints = true;
  }
  if (s.rolls && point == 0) {
    Block6 sum = own;
    addExternalRollingApart(s, begin, end, kStride, &sum);
    own = sum;
  }
  if (any(joints)) {
    Block6 sum = own;
    if constexpr (alike) addExternalJointsAlike(s, chunk.group, s.externalOffset[i] + (lane - tile.lane), end, kWidth, tile, &sum);
    else addExternalJointsApart(s, chunk.group, s.externalOffset[i] + lane, end, kWidth, &sum);
    own = sum;
  }
  return own;
}

/// Hands the sums of a chunk on; the tile that completes those of a group solves it.
template <int kTile>
__device__ void handOn(const View& s, const SumTree& tree, int i, Group& group, const Tile<kTile>& tile, Real (&sums)[kRealsPerLane<kTile>]) {
  if (!tree.carryUp(s, group, i, tile, sums)) return;
  Block6 block = group.inertia;
  block += gatherSums(tile, sums);
  const Vec6 dx = groupStep(s, group, block);
  if (tile.lane == 0) group.step = dx;
}

/// A heavy chunk, by a block.
template <int kTile, bool alike>
__device__ __noinline__ void sumHeavyChunk(const View& s, const SumTree& tree, int i, Real (&warpSums)[kThreads / kWarp][kWarp]) {
  const Chunk chunk = s.chunk[i];
  Group& group = s.group[chunk.group];
  const int thread = static_cast<int>(threadIdx.x);
  const Block6 own = gatherChunk<kThreads, alike>(s, i, chunk, group, Tile<kWarp>::ofThread(), thread, [](bool yes) { return __syncthreads_or(yes) != 0; });
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
    handOn(s, tree, i, group, Tile<kTile>::ofThread(), sums);
  }
  __syncthreads();
}

/// SumChunk and SolveGroup in one, for the chunks of a level (`lumpsOnly`: of groups with lumps): the first blocks take the heavy ones, tiles of the others one each.
template <int kTile, bool alike>
__global__ void __launch_bounds__(kThreads, 6)
    sumChunks(const __grid_constant__ View s, SumTree tree, HeavyList heavy, int heavyBlocks, int level, bool lumpsOnly, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  const auto isLeft = [&](int i) { return lumpsOnly && !s.group[s.chunk[i].group].soft; };
  __shared__ Real warpSums[kThreads / kWarp][kWarp];
  const int begin = s.levelChunk[level], end = s.levelChunk[level + 1], block = static_cast<int>(blockIdx.x) - heavyBlocks;
  if (block < 0) {
    for (int h = static_cast<int>(blockIdx.x); h < *heavy.count; h += heavyBlocks)
      if (const int i = heavy.element[h]; i >= begin && i < end && !isLeft(i)) sumHeavyChunk<kTile, alike>(s, tree, i, warpSums);
    return;
  }
  const Tile<kTile> tile = Tile<kTile>::ofThread();
  constexpr int kTiles = kThreads / kTile;
  const int stride = (static_cast<int>(gridDim.x) - heavyBlocks) * kTiles;
  for (int i = begin + block * kTiles + static_cast<int>(threadIdx.x) / kTile; i < end; i += stride) {
    if (isHeavyChunk(s, i, level) || isLeft(i)) continue;
    const Chunk chunk = s.chunk[i];
    Group& group = s.group[chunk.group];
    const Block6 own = gatherChunk<kTile, alike>(s, i, chunk, group, tile, tile.lane, [&](bool yes) { return tile.ballot(yes) != 0; });
    Real sums[kRealsPerLane<kTile>];
    sumBlocks(tile, own, sums);
    handOn(s, tree, i, group, tile, sums);
  }
}

/// MoveChunk for all chunks of a level, a thread a body: it knows its group, and bodies lie side by side where members do not.
struct MoveMember {
  static constexpr const char* kName = MoveChunk::kName;
  int level;
  bool lumpsOnly = false;
  __device__ void operator()(const View& s, int body) const {
    if (const int group = s.groupOf[atLevel(s, level, body)]; group >= 0 && (!lumpsOnly || s.group[group].soft)) moveWithGroup(s, s.group[group], body);
  }
};

}  // namespace rubble::RUBBLE_CORE

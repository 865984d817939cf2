#pragma once
/// Stages of the coarse correction, a warp a chunk or a group: lanes stride over members, row blocks, points or chunks.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Bodies of one warp that have the same leader are counted by one of them: the groups of coarse levels are few, and large.
struct FlattenGroupsTogether {
  static constexpr const char* kName = FlattenGroups::kName;
  int level;
  explicit FlattenGroupsTogether(const FlattenGroups& stage) : level(stage.level) {}
  __device__ void operator()(const View& s, int i) const {
    const int leader = findLeader(s.leader + level * s.bodies, i);
    s.groupOf[atLevel(s, level, i)] = leader;
    if (s.params[i].kind != BodyKind::Dynamic) return;
    const unsigned same = __match_any_sync(__activemask(), leader);
    if (static_cast<int>(threadIdx.x % kWarp) == __ffs(static_cast<int>(same)) - 1)
      atomicCount(&s.memberCount[atLevel(s, level, leader)], __popc(same));
  }
};
template <>
struct OnDevice<FlattenGroups> {
  using Type = FlattenGroupsTogether;
};

struct SumMassesByWarp {
  static constexpr const char* kName = SumMasses::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    Chunk& chunk = s.chunk[i];
    const Vec3d origin = s.position[s.member[s.memberOffset[chunk.group]]];
    Real mass = 0;
    Vec3 moment;
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth) {
      const int body = s.member[k];
      mass += s.params[body].mass;
      moment += s.params[body].mass * Vec3(s.position[body] - origin);
    }
    mass = tile.sum(mass);
    moment = tile.sum(moment);
    if (tile.lane != 0) return;
    chunk.sum.ll.xx = mass;
    chunk.sum.fl = moment;
  }
};
template <>
struct OnDevice<SumMasses> {
  using Type = SumMassesByWarp;
};

struct FindCentresByWarp {
  static constexpr const char* kName = FindCentres::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int g, const Tile<kWidth>& tile) const {
    Group& group = s.group[g];
    Real mass = 0;
    Vec3 moment;
    for (int k = group.chunkBegin + tile.lane; k < group.chunkEnd; k += kWidth) {
      mass += s.chunk[k].sum.ll.xx;
      moment += s.chunk[k].sum.fl;
    }
    mass = tile.sum(mass);
    moment = tile.sum(moment);
    if (tile.lane == 0) group.centre = s.position[s.member[s.memberOffset[g]]] + Vec3d(moment / mass);
  }
};
template <>
struct OnDevice<FindCentres> {
  using Type = FindCentresByWarp;
};

struct SumInertiaByWarp {
  static constexpr const char* kName = SumInertia::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    Chunk& chunk = s.chunk[i];
    Block6 own;
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth) addInertia(s, s.group[chunk.group], s.member[k], own);
    Real sums[1];
    sumBlocks(tile, own, sums);
    storeSums(tile, sums, chunk.sum);
  }
};
template <>
struct OnDevice<SumInertia> {
  using Type = SumInertiaByWarp;
};

struct TakeInertiaByWarp {
  static constexpr const char* kName = TakeInertia::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int g, const Tile<kWidth>& tile) const {
    Group& group = s.group[g];
    Block6 own;
    for (int k = group.chunkBegin + tile.lane; k < group.chunkEnd; k += kWidth) addBlock(own, s.chunk[k].sum);
    Real sums[1];
    sumBlocks(tile, own, sums);
    storeSums(tile, sums, group.inertia);
  }
};
template <>
struct OnDevice<TakeInertia> {
  using Type = TakeInertiaByWarp;
};

/// visit(entry) for the row blocks of a body that leave its group at a level.
template <class Visit>
__device__ void visitExternalsOf(const View& s, int body, int level, Visit&& visit) {
  for (int e = s.entryOffset[body]; e < s.entryOffset[body + 1]; ++e)
    if (s.entry[e].depth > level) visit(s.entry[e].code);
}

struct CountExternalsByWarp {
  static constexpr const char* kName = CountExternals::kName;
  static constexpr int kWidth = kWarp;
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
  using Type = CountExternalsByWarp;
};

/// In the order that one thread would write them.
struct FillExternalsByWarp {
  static constexpr const char* kName = FillExternals::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Chunk& chunk = s.chunk[i];
    const int level = s.group[chunk.group].level;
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
template <>
struct OnDevice<FillExternals> {
  using Type = FillExternalsByWarp;
};

/// Rare, and large: a call keeps its registers out of the kernels that contacts fill.
static __device__ __noinline__ void addExternalJointApart(const View& s, int group, std::uint32_t code, Block6* sum) {
  Block6 own;
  addExternalJoint(s, group, code, own);
  *sum = own;
}

struct SumChunkByWarp {
  static constexpr const char* kName = SumChunk<Real>::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    Chunk& chunk = s.chunk[i];
    const Group& group = s.group[chunk.group];
    Block6 own;
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth) addInertialForce(s, group, s.member[k], own);
    // a lane a point: four lanes share a row block
    const int end = s.externalOffset[i + 1], point = tile.lane % kLanes;
    for (int k = s.externalOffset[i] + tile.lane / kLanes; k < end; k += kWidth / kLanes) {
      const std::uint32_t code = s.external[k];
      if (entryType(code) == kContactType) {
        addExternalContact<Real>(s, group, code, point, own);
      } else if (point == 0) {
        Block6 joint;
        addExternalJointApart(s, chunk.group, code, &joint);
        addBlock(own, joint);
      }
    }
    Real sums[1];
    sumBlocks(tile, own, sums);
    storeSums(tile, sums, chunk.sum);
  }
};
template <>
struct OnDevice<SumChunk<Real>> {
  using Type = SumChunkByWarp;
};

struct MoveChunkByLanes {
  static constexpr const char* kName = MoveChunk::kName;
  static constexpr int kWidth = 16;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Chunk& chunk = s.chunk[i];
    for (int k = chunk.begin + tile.lane; k < chunk.end; k += kWidth) moveWithGroup(s, s.group[chunk.group], s.member[k]);
  }
};
template <>
struct OnDevice<MoveChunk> {
  using Type = MoveChunkByLanes;
};

/// A group of few chunks.
struct SolveGroupByWarp {
  static constexpr const char* kName = SolveGroup::kName;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const View& s, int g, const Tile<kWidth>& tile) const {
    Group& group = s.group[g];
    Block6 own;
    for (int k = group.chunkBegin + tile.lane; k < group.chunkEnd; k += kWidth) addBlock(own, s.chunk[k].sum);
    Real sums[1];
    sumBlocks(tile, own, sums);
    solve(group, gatherSums(sums[0]), tile.lane);
  }
  __device__ static void solve(Group& group, const Block6& rows, int lane) {
    Block6 block = group.inertia;
    block.fl = block.fa = {0, 0, 0};
    addBlock(block, rows);
    const Vec6 dx = groupStep(block);
    if (lane == 0) group.step = dx;
  }
};
template <>
struct OnDevice<SolveGroup> {
  using Type = SolveGroupByWarp;
};

/// Groups of a coarser level have up to thousands of chunks: a block each.
inline constexpr int kSolveThreads = 256;
static __global__ void __launch_bounds__(kSolveThreads) solveLargeGroups(const __grid_constant__ View s, int level, Gate gate) {
  if (gate.closed()) return;
  constexpr int kWarps = kSolveThreads / kWarp;
  __shared__ Real partial[kWarps][kPaddedReals];
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const int warp = static_cast<int>(threadIdx.x) / kWarp;
  const int end = s.levelGroup[level + 1];
  for (int g = s.levelGroup[level] + static_cast<int>(blockIdx.x); g < end; g += static_cast<int>(gridDim.x)) {
    Group& group = s.group[g];
    Block6 own;
    for (int k = group.chunkBegin + static_cast<int>(threadIdx.x); k < group.chunkEnd; k += kSolveThreads) addBlock(own, s.chunk[k].sum);
    Real sums[1];
    sumBlocks(tile, own, sums);
    partial[warp][tile.lane] = sums[0];
    __syncthreads();
    if (warp == 0) {
      Real sum = 0;
#pragma unroll
      for (int w = 0; w < kWarps; ++w) sum += partial[w][tile.lane];
      SolveGroupByWarp::solve(group, gatherSums(sum), tile.lane);
    }
    __syncthreads();
  }
}

}  // namespace rubble::RUBBLE_CORE

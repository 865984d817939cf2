#pragma once
/// Kernels of deformable objects and their clusters, one tile of lanes per vertex or cluster.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

struct BeginTetraCornersByTile {
  static constexpr const char* kStage = BeginTetraCorners::kStage;
  static constexpr int kWidth = 8;
  __device__ void operator()(const SolverData& s, int v, const Tile<kWidth>& tile) const {
    for (int k = s.tetraCornerOffset[v] + tile.lane; k < s.tetraCornerOffset[v + 1]; k += kWidth)
      BeginTetraCorners::begin(s, k);
  }
};
template <> struct OnDevice<BeginTetraCorners> { using Type = BeginTetraCornersByTile; };

struct PlaceLargeClustersByTile {
  static constexpr const char* kStage = PlaceLargeClusters::kStage;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const int large = s.clusterBegin[1] + i;
    const Cluster c = s.cluster[large];
    ClusterMoments own;
    for (int k = c.sliceBegin + tile.lane; k < c.sliceEnd; k += kWidth) own.add(s.clusterMotion[k]);
    const ClusterMoments sum{tile.sum(own.mass), tile.sum(own.place), tile.sum(own.velocity)};
    if (tile.lane == 0) sum.write(s.clusterMotion[large]);
  }
};
template <> struct OnDevice<PlaceLargeClusters> { using Type = PlaceLargeClustersByTile; };

/// One lane per vertex, or several where vertices have many contacts.
template <bool surfaces> struct SumClusterByTile {
  static constexpr const char* kStage = SumCluster<surfaces>::kStage;
  static constexpr int kWidth = surfaces ? kWarp : 8, kLanesPerVertex = surfaces ? 4 : 1;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Cluster c = s.cluster[i];
    ClusterMotion& motion = s.clusterMotion[i];
    const Vec3 center = motion.center;
    Block6 own, self;
    bool folded = false;
    for (int k = c.begin + tile.lane / kLanesPerVertex; k < c.end; k += kWidth / kLanesPerVertex)
      folded |= SumCluster<surfaces>::addVertex(s, s.clusterMember[k], center, tile.lane % kLanesPerVertex,
                                                kLanesPerVertex, own, self);
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, own, sums);
    storeSums(tile, sums, motion.sum);
    if constexpr (surfaces) {
      const bool any = tile.ballot(folded) != 0;
      if (tile.lane == 0) motion.folded = any;
      if (!any) return;
      sumBlocks(tile, self, sums);
      storeSums(tile, sums, motion.inner);
    }
  }
};
template <bool surfaces> struct OnDevice<SumCluster<surfaces>> { using Type = SumClusterByTile<surfaces>; };

/// This worker's share of the block of a cluster: every `workers`-th slice (cluster of the finest level), and
/// every `workers`-th element on its boundary.
__device__ inline Block6 shareOfCluster(const SolverData& s, int index, int worker, int workers) {
  const Cluster c = s.cluster[index];
  const Vec3 center = s.clusterMotion[index].center;
  Block6 own;
  for (int k = c.sliceBegin + worker; k < c.sliceEnd; k += workers)
    SolveCluster::addSlice(s, c, k, center, own);
  for (int k = c.refBegin + worker; k < c.refEnd; k += workers)
    SolveCluster::addLeaving(s, s.clusterRef[k], center, own);
  return own;
}
/// Solves a cluster whose block was summed by a tile.
template <int kWidth>
__device__ void stepCluster(const SolverData& s, int index, const Tile<kWidth>& tile,
                            const Real (&sums)[kRealsPerLane<kWidth>]) {
  Block6 block = gatherSums(tile, sums);
  const Vec6 dx = SolveCluster::stepOf(block);
  if (tile.lane == 0) s.clusterMotion[index].step = dx;
}

/// Lanes per cluster. Few where clusters fill the device, because all lanes repeat the solve.
template <int width> struct SolveClusterByTile {
  static constexpr const char* kStage = SolveCluster::kStage;
  static constexpr int kWidth = width;
  static constexpr int kBlocks = 5;
  int level;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const int index = s.clusterBegin[level] + i;
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, shareOfCluster(s, index, tile.lane, kWidth), sums);
    stepCluster(s, index, tile, sums);
  }
};
/// One thread block per cluster where clusters are few.
template <int kBlockThreads>
static __global__ void __launch_bounds__(kBlockThreads)
    solveClusters(const __grid_constant__ SolverData s, int level, Gate gate) {
  awaitPrevious();
  if (gate.closed()) return;
  constexpr int kWarps = kBlockThreads / kWarp;
  __shared__ Real sums[kWarps][kPaddedReals + 1];
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const int thread = static_cast<int>(threadIdx.x), warp = thread / kWarp;
  const int index = s.clusterBegin[level] + static_cast<int>(blockIdx.x);
  Real mine[kRealsPerLane<kWarp>];
  sumBlocks(tile, shareOfCluster(s, index, thread, kBlockThreads), mine);
  static_assert(kRealsPerLane<kWarp> == 1);
  sums[warp][tile.lane] = mine[0];
  __syncthreads();
  if (warp != 0) return;
  mine[0] = 0;
#pragma unroll
  for (int k = 0; k < kWarps; ++k) mine[0] += sums[k][tile.lane];
  stepCluster(s, index, tile, mine);
}

/// One lane per vertex.
struct MoveClusterByTile {
  static constexpr const char* kStage = MoveCluster::kStage;
  static constexpr int kWidth = 8;
  MoveCluster move;
  explicit MoveClusterByTile(const MoveCluster& stage) : move(stage) {}
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    const Cluster& c = s.cluster[i];
    for (int k = c.begin + tile.lane; k < c.end; k += kWidth) move.moveMember(s, i, k);
  }
};
template <> struct OnDevice<MoveCluster> { using Type = MoveClusterByTile; };

/// One lane per vertex, or several where vertices have many contacts.
template <bool surfaces> struct SumSoftNodePartByTile {
  static constexpr const char* kStage = SumSoftNodePart::kStage;
  static constexpr int kWidth = surfaces ? kWarp : 8, kLanesPerVertex = surfaces ? 4 : 1;
  SumSoftNodePart stage;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    if (!stage.isWanted(s, i)) return;
    const Cluster c = s.cluster[i];
    Block3 own;
    for (int k = c.begin + tile.lane / kLanesPerVertex; k < c.end; k += kWidth / kLanesPerVertex)
      stage.addVertex(s, s.clusterMember[k], tile.lane % kLanesPerVertex, kLanesPerVertex, own);
    const Block3 sum = sumOf(tile, own);
    if (tile.lane == 0) s.clusterMotion[i].push = sum;
  }
};
/// One block per object, which sums its parts.
template <int kBlockThreads>
static __global__ void __launch_bounds__(kBlockThreads)
    sumSoftNodes(const __grid_constant__ SolverData s, int level, Gate gate) {
  awaitPrevious();
  const int i = static_cast<int>(blockIdx.x);
  if (gate.closed() || aggregateOfSoftNode(s, level, i) < 0) return;
  constexpr int kWarps = kBlockThreads / kWarp;
  constexpr int kReals = sizeof(Block3) / sizeof(Real);
  __shared__ Real sums[kWarps][kReals];
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const int thread = static_cast<int>(threadIdx.x);
  Block3 own;
  SumSoftNode::addShare(s, i, thread, kBlockThreads, own);
  own = sumOf(tile, own);
  if (tile.lane == 0) memcpy(sums[thread / kWarp], &own, sizeof own);
  __syncthreads();
  if (thread >= kReals) return;
  Real all = 0;
  for (int k = 0; k < kWarps; ++k) all += sums[k][thread];
  reinterpret_cast<Real*>(&s.softNodeSum[i])[thread] = all;
}
/// Soft nodes with indices above the objects: particles.
struct SumParticle {
  static constexpr const char* kStage = SumSoftNode::kStage;
  SumSoftNode stage;
  int first;
  __device__ void operator()(const SolverData& s, int k) const { stage(s, first + k); }
};

}  // namespace rubble::RUBBLE_CORE

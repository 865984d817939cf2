#include "backend/cuda/tree_solver.h"

#include "backend/cuda/tree_kernels.cuh"

namespace rubble::RUBBLE_CORE {

namespace {

/// Of a block. Up to 128 registers per thread.
constexpr int kTreeThreads = 2 * kWarp, kTreeBlocks = 8;

/// SolveTree by a block, whose tiles share the bodies of each level.
struct SolveTreeByBlock {
  static constexpr int kLanes = kTreeThreads;
  __device__ static void solve(const SolverData& s, const SmallTree& tree) {
    const int thread = static_cast<int>(threadIdx.x);
    const auto run = [&]<class Kernel>(const Kernel& kernel, int first, int last) {
      constexpr int kWidth = Kernel::kWidth;
      const Tile<kWidth> tile = Tile<kWidth>::ofThread();
      for (int n = first + thread / kWidth; n < last; n += kLanes / kWidth) kernel(s, n, tile);
      __syncthreads();
    };
    run(AssembleTreeJointsByTile{}, tree.begin, tree.end);
    forEachLevel(s, tree, [&](int first, int last) { run(EliminateNodeByTile{}, first, last); });
    forEachLevelBack(s, tree, [&](int first, int last) { run(SubstituteNodeByTile{}, first, last); });
  }
};

/// SolveTree by one tile, body after body. No lane waits for those of other bodies, and a block does not
/// leave the registers between assembly and elimination. Each lane reads the record of a body ahead of its
/// turn, so that bodies do not wait for theirs.
struct SolveTreeByTile {
  static constexpr int kLanes = TreeLane::kWidth;
  __device__ static void solve(const SolverData& s, const SmallTree& tree) {
    __shared__ NodeRecord records[kTreeThreads];
    __shared__ PartRing rings[kTreeThreads / kLanes];
    const Tile<kLanes> tile = Tile<kLanes>::ofThread();
    NodeRecord* const ahead = records + (threadIdx.x - static_cast<unsigned>(tile.lane));
    const auto readAhead = [&](int first) {
      __syncwarp(tile.mask);
      if (first + tile.lane < tree.end) ahead[tile.lane] = NodeRecord::of(s, first + tile.lane);
      __syncwarp(tile.mask);
    };
    int first = tree.begin;
    for (int n = tree.begin; n < tree.end; ++n) {
      if (n == tree.begin || n == first + kLanes) readAhead(first = n);
      const NodeRecord& record = ahead[n - first];
      TreeLane::Columns columns = AssembleTreeJointsByTile::columnsOf(s, n, record, tile,
                                                                      rings[threadIdx.x / kLanes]);
      EliminateNodeByTile::eliminate(s, n, record.node, tile, columns);
      __syncwarp(tile.mask);
    }
    for (int n = tree.end - 1; n >= tree.begin; --n) {
      if (n < first) readAhead(first = max(tree.begin, n + 1 - kLanes));
      SubstituteNodeByTile::substitute(s, n, ahead[n - first].node, tile);
      __syncwarp(tile.mask);
    }
  }
};

/// SolveTree for `count` trees.
template <class Solve>
__global__ void __launch_bounds__(kTreeThreads, kTreeBlocks)
    solveTrees(const __grid_constant__ SolverData s, int count, Gate gate) {
  gate.enter([&] {
    const int thread = static_cast<int>(blockIdx.x * kTreeThreads + threadIdx.x),
              index = thread / Solve::kLanes;
    if (index >= count) return;
    const SmallTree tree = s.smallTree[index];
    if (tree.begin == tree.end || s.treeConverged[tree.begin]) return;
    Solve::solve(s, tree);
    // bypasses a stale L1 cache line
    const double share = treeShare(__ldcg(&s.treeMaxRotation[tree.begin]));
    for (int n = tree.begin + thread % Solve::kLanes; n < tree.end; n += Solve::kLanes)
      MoveTrees::move(s, n, share);
  });
}

}  // namespace

TreeLaunch solveTreesWith(int count, int threads) {
  TreeLaunch launch{};
  const auto use = [&]<class Solve>(const Solve&) {
    constexpr int kTrees = kTreeThreads / Solve::kLanes;
    launch = {solveTrees<Solve>, (count + kTrees - 1) / kTrees, kTreeThreads};
  };
  // register use limits this kernel to a quarter of the device's threads
  const int lanes = lanesFor<SolveTreeByTile::kLanes, SolveTreeByBlock::kLanes>(count, threads / 4);
  lanes == SolveTreeByTile::kLanes ? use(SolveTreeByTile{}) : use(SolveTreeByBlock{});
  return launch;
}

}  // namespace rubble::RUBBLE_CORE

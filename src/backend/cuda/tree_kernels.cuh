#pragma once
/// Stages of joint trees, a tile of lanes a body: a joint is thousands of instructions one after another, and some bodies have five.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// A lane a point of a contact, then a lane a joint.
template <class L>
struct AssembleTreesByTile {
  static constexpr const char* kName = AssembleTrees<L>::kName;
  static constexpr int kWidth = 8;
  static constexpr int kNumbers = sizeof(TreeBlock) / sizeof(double);
  AssembleTrees<L> stage;
  explicit AssembleTreesByTile(const AssembleTrees<L>& own) : stage(own) {}

  __device__ void operator()(const View& s, int n, const Tile<kWidth>& tile) const {
    __shared__ TreeBlock sums[kThreads / kWidth];
    TreeBlock& sum = sums[threadIdx.x / kWidth];
    const TreeNode& node = s.treeNode[n];
    __syncwarp(tile.mask);
    for (int k = tile.lane; k < kNumbers; k += kWidth) number(sum, k) = 0;
    __syncwarp(tile.mask);
    if (!stage.stands(s, node)) addRows(s, n, node, tile, sum);
    else if (tile.lane == 0) stage.standStill(sum);
    __syncwarp(tile.mask);
    for (int k = tile.lane; k < kNumbers; k += kWidth) number(s.treeWork[n], k) = number(sum, k);
  }

 private:
  __device__ static double& number(TreeBlock& block, int k) { return reinterpret_cast<double*>(&block)[k]; }
  /// visit(number, its place) for what joints of this node write: local memory is slow.
  template <class Visit>
  __device__ static void forEachNumber(const TreeNode& node, TreeBlock& block, Visit&& visit) {
    const auto all = [&](double* first, int count) {
      for (int k = 0; k < count; ++k) visit(first[k], static_cast<int>(first - reinterpret_cast<double*>(&block)) + k);
    };
    for (int row = 0; row < 6; ++row) all(block.h.m[row], row + 1);
    all(block.x.v, 6);
    for (int t = 0; t < 2; ++t)
      if (node.near[t] >= 0) all(block.e[t].m[0], 36);
  }

  __device__ void addRows(const View& s, int n, const TreeNode& node, const Tile<kWidth>& tile, TreeBlock& sum) const {
    const int begin = s.entryOffset[node.body], end = s.entryOffset[node.body + 1], point = tile.lane % kLanes;
    Block6 own, shared;
    if (tile.lane == 0) startBlock(s, node.body, own);
    int k = begin + tile.lane / kLanes;
    for (; k < end && entryType(s.entry[k].code) == kContactType; k += kWidth / kLanes) {
      Block6 rows;
      addContact<Real>(s, s.entry[k].code, point, rows);
      if (s.rolls && point == 0) addRolling(s, s.entry[k].code, rows);
      if (movesInTree(s, s.entry[k].other)) addBlock(shared, rows);
      else addBlock(own, rows);
    }
    // entries are sorted by type, contacts first
    k = min(k, __shfl_xor_sync(tile.mask, k, kLanes, kWidth)) + tile.lane;
    static_assert(kWidth == 2 * kLanes);
    const TreeSolve how = stage.solveOf(s, node);
    const unsigned turns = tile.ballot(k < end);
    TreeBlock joints;
    if (k < end) forEachNumber(node, joints, [](double& q, int) { q = 0; });
    for (; k < end; k += kWidth) stage.addOther(s, n, s.entry[k].code, how, joints, own);
    for (int turn = 0; turns >> turn != 0; ++turn) {
      if (tile.lane == turn) forEachNumber(node, joints, [&](double& q, int place) { number(sum, place) += q; });
      __syncwarp(tile.mask);
    }
    const Block6 allOwn = sumOver(tile, own), allShared = sumOver(tile, shared);
    if (tile.lane == 0) stage.complete(s, node, allOwn, allShared, sum);
  }
  __device__ static Block6 sumOver(const Tile<kWidth>& tile, const Block6& block) {
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, block, sums);
    return gatherSums(tile, sums);
  }
};
template <class L>
struct OnDevice<AssembleTrees<L>> {
  using Type = AssembleTreesByTile<L>;
};

/// A lane a column: of H (lanes 0 to 5), the force (6), and the two couplings (8 to 13, 16 to 21). All lanes factor H.
struct EliminateNodeByTile {
  static constexpr const char* kName = EliminateNode::kName;
  static constexpr int kWidth = kWarp;
  int begin;
  explicit EliminateNodeByTile(const EliminateNode& stage) : begin(stage.begin) {}
  __device__ void operator()(const View& s, int index, const Tile<kWidth>& tile) const {
    const int n = begin + index, place = tile.lane / 8, column = tile.lane % 8, t = place - 1;
    const TreeNode node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    const bool isForce = place == 0 && column == 6, isHessian = place == 0 && column < 6;
    const bool isCoupling = (place == 1 || place == 2) && column < 6 && node.near[t] >= 0;
    double c[6] = {};
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isHessian) c[i] = w.h.m[i][column];
      if (isForce) c[i] = w.x.v[i];
      if (isCoupling) c[i] = w.e[t].m[i][column];
    }
    for (int source = node.sourceBegin; source < node.sourceEnd; ++source) {
      const int code = s.treeSource[source], from = code >> 1, side = code & 1;
      const TreeWork& o = s.treeWork[from];
      const int far = s.treeNode[from].near[1 - side];
      if (!isHessian && !isForce && !(isCoupling && far >= 0 && node.near[t] == far)) continue;
      const Dense6 &a = o.e[side], &b = o.w[isHessian ? side : 1 - side];
#pragma unroll
      for (int k = 0; k < 6; ++k) {
        const double factor = isForce ? o.x.v[k] : b.m[k][column];
#pragma unroll
        for (int i = 0; i < 6; ++i) c[i] -= a.m[k][i] * factor;
      }
    }
    __syncwarp(tile.mask);
    Dense6 h;
#pragma unroll
    for (int j = 0; j < 6; ++j)
#pragma unroll
      for (int i = 0; i < 6; ++i)
        if (i >= j) h.m[i][j] = __shfl_sync(tile.mask, c[i], j, kWidth);
    factor(h);
    if (!isForce && !isCoupling) return;
    Long6 x;
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isCoupling) w.e[t].m[i][column] = c[i];
      x.v[i] = c[i];
    }
    solveFactored(h, x);
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isForce) w.x.v[i] = x.v[i];
      else w.w[t].m[i][column] = x.v[i];
    }
  }
};
template <>
struct OnDevice<EliminateNode> {
  using Type = EliminateNodeByTile;
};

/// A lane a row.
struct SubstituteNodeByTile {
  static constexpr const char* kName = SubstituteNode::kName;
  static constexpr int kWidth = 8;
  int begin;
  explicit SubstituteNodeByTile(const SubstituteNode& stage) : begin(stage.begin) {}
  __device__ void operator()(const View& s, int index, const Tile<kWidth>& tile) const {
    const int n = begin + index, i = tile.lane;
    const TreeNode node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    double x = i < 6 ? w.x.v[i] : 0;
    for (int t = 0; t < 2; ++t) {
      if (node.near[t] < 0 || i >= 6) continue;
      const Long6& y = s.treeWork[node.near[t]].x;
      for (int j = 0; j < 6; ++j) x -= w.w[t].m[i][j] * y.v[j];
    }
    if (i < 6) w.x.v[i] = x;
    Long6 all;
    for (int j = 0; j < 6; ++j) all.v[j] = __shfl_sync(tile.mask, x, j, kWidth);
    if (i == 0) SubstituteNode::noteTurn(s, node.tree, all);
  }
};
template <>
struct OnDevice<SubstituteNode> {
  using Type = SubstituteNodeByTile;
};

}  // namespace rubble::RUBBLE_CORE

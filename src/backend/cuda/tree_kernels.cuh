#pragma once
/// Stages of joint trees, a warp a body.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

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

}  // namespace rubble::RUBBLE_CORE

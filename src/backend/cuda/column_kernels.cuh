#pragma once
/// Columns (stages/columns/columns.h): one block per column, in a single launch. Warps add up the rows of the
/// bodies. Then they eliminate every second body that is left, so a column of N bodies takes log2 N rounds
/// instead of N steps (cyclic reduction).
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Threads of a block: a warp for each of 16 bodies, the half of a column of 32.
inline constexpr int kColumnThreads = 512;

/// The column of nodes [begin, end), solved by all threads of a block.
class ColumnOfBlock {
 public:
  __device__ ColumnOfBlock(const SolverData& s, int begin, int end) : s_(s), begin_(begin), end_(end) {}

  __device__ void solve() const {
    for (int n = begin_ + warp_; n < end_; n += kWarps) assemble(n);
    __syncthreads();
    int stride = 1;
    for (; begin_ + stride < end_; stride *= 2) eliminateAt(stride);
    if (threadIdx.x == 0) solveLast();
    __syncthreads();
    while (stride /= 2) substituteAt(stride);
    move();
    __syncthreads();
  }

 private:
  static constexpr int kWarps = kColumnThreads / kWarp;
  /// Lanes by 8, as of EliminateNodeByTile: the force (lane 6), and the columns of two couplings.
  static constexpr int kPlaceLanes = 8, kForceLane = 6;
  /// A row of a contact with a neighbor.
  struct Row {
    Real own[6], other[6], force, k;
  };
  static_assert(2 * kLanes * kLinkRows == kWarp);  // a lane for each row of the contacts with both neighbors

  __device__ ColumnWork& work(int n) const { return s_.columnWork[n]; }

  /// AssembleColumns by a warp. Each lane adds up two numbers of the block row.
  __device__ void assemble(int n) const {
    const ColumnNode node = s_.columnNode[n];
    ColumnWork& w = work(n);
    const bool moves = movesInColumn(s_, node.body);
    const Row* const rows = moves ? rowsOf(n) : nullptr;
    for (int i = lane_; i < 6 * kSumColumns; i += kWarp) {
      const int row = i / kSumColumns, column = i % kSumColumns;
      double sum = 0;
      for (int k = 0; moves && k < kWarp; ++k) sum += elementOf(rows[k], k < kWarp / 2, row, column);
      if (column < 6)
        w.h.m[row][column] = !moves && row == column ? 1 : sum;
      else if (column < 12)
        w.e.m[row][column - 6] = sum;
      else
        w.x.v[row] = sum;
    }
    __syncwarp();
    if (moves && lane_ == 0) addOtherRows<Real>(s_, node, w);
  }
  /// Columns of [h e x].
  static constexpr int kSumColumns = 13;
  /// What a row adds there.
  __device__ static double elementOf(const Row& r, bool toPrevious, int row, int column) {
    const double own = static_cast<double>(r.own[row]);
    if (column == 12) return static_cast<double>(r.force) * own;
    const double scaled = static_cast<double>(r.k) * own;
    if (column < 6) return scaled * static_cast<double>(r.own[column]);
    return toPrevious ? 0 : -scaled * static_cast<double>(r.other[column - 6]);
  }
  /// The rows of both contacts of a node, one by each lane.
  __device__ const Row* rowsOf(int n) const {
    __shared__ Row rows[kWarps][kWarp];
    Row& own = rows[warp_][lane_];
    own = {};
    const int wanted = lane_ % kLinkRows, point = lane_ / kLinkRows % kLanes;
    const std::uint32_t code = linkTo(s_, n, lane_ < kWarp / 2 ? -1 : 1);
    if (code != kNoLink)
      visitLinkRows(s_, code, point, [&](int row, const Vec6& j, const Vec6& other, Real force, Real k) {
        if (row != wanted) return;
        for (int i = 0; i < 6; ++i) own.own[i] = (&j.lin.x)[i], own.other[i] = (&other.lin.x)[i];
        own.force = force, own.k = k;
      });
    __syncwarp();
    return rows[warp_];
  }

  /// Eliminates the nodes at odd multiples of a stride. What a node takes from its neighbors goes to the
  /// previous one first and then to the next one, for two of them share a neighbor.
  __device__ void eliminateAt(int stride) const {
    for (int first = begin_ + stride; first < end_; first += 2 * stride * kWarps) {
      const int n = first + 2 * stride * warp_;
      const bool mine = n < end_;
      const int next = n + stride < end_ ? n + stride : -1;
      Long6 y{}, coupling{};
      if (mine) y = eliminate(n, n - stride, coupling);
      __syncthreads();
      if (mine) passOn(n, n - stride, next, y, coupling);
      __syncthreads();
    }
  }
  __device__ int place() const { return lane_ / kPlaceLanes; }
  __device__ int column() const { return lane_ % kPlaceLanes; }
  __device__ bool isForce() const { return place() == 0 && column() == kForceLane; }
  __device__ bool isToPrevious() const { return place() == 1 && column() < 6; }
  __device__ bool isToNext() const { return place() == 2 && column() < 6; }

  /// Solves for this lane's column of [E(n - 1)^T, E(n), f], and subtracts from the previous node. Returns
  /// the solution, and the new coupling of the neighbors.
  __device__ Long6 eliminate(int n, int previous, Long6& coupling) const {
    const ColumnWork& w = work(n);
    ColumnWork& to = work(previous);
    Long6 y{};
    if (!isForce() && !isToPrevious() && !isToNext()) return y;
    Dense6 h;
#pragma unroll
    for (int i = 0; i < 6; ++i) {
#pragma unroll
      for (int j = 0; j <= i; ++j) h.m[i][j] = w.h.m[i][j];
      y.v[i] = isForce() ? w.x.v[i] : isToNext() ? w.e.m[i][column()] : to.e.m[column()][i];
    }
    factor(h);
    solveFactored(h, y);
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      double sum = 0;
#pragma unroll
      for (int k = 0; k < 6; ++k) sum += to.e.m[i][k] * y.v[k];
      coupling.v[i] = -sum;
      if (isForce()) to.x.v[i] -= sum;
      if (isToPrevious() && column() <= i) to.h.m[i][column()] -= sum;
    }
    return y;
  }
  /// Subtracts from the next node, and stores what the substitution needs.
  __device__ void passOn(int n, int previous, int next, const Long6& y, const Long6& coupling) const {
    ColumnWork& w = work(n);
    if (next >= 0 && (isForce() || isToNext())) {
      ColumnWork& to = work(next);
#pragma unroll
      for (int i = 0; i < 6; ++i) {
        double sum = 0;
#pragma unroll
        for (int k = 0; k < 6; ++k) sum += w.e.m[k][i] * y.v[k];
        if (isForce()) to.x.v[i] -= sum;
        if (isToNext() && column() <= i) to.h.m[i][column()] -= sum;
      }
    }
    __syncwarp();
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isForce()) w.x.v[i] = y.v[i];
      if (isToPrevious()) w.h.m[i][column()] = y.v[i];
      if (isToNext()) w.e.m[i][column()] = y.v[i], work(previous).e.m[i][column()] = coupling.v[i];
    }
  }
  /// The first node is the last one that is left.
  __device__ void solveLast() const {
    Dense6 h = work(begin_).h;
    Long6 x = work(begin_).x;
    factor(h);
    solveFactored(h, x);
    work(begin_).x = x;
  }
  /// The steps of the nodes that eliminateAt() eliminated; one lane per row.
  __device__ void substituteAt(int stride) const {
    const int row = static_cast<int>(threadIdx.x) % kPlaceLanes;
    for (int k = static_cast<int>(threadIdx.x) / kPlaceLanes;; k += kColumnThreads / kPlaceLanes) {
      const int n = begin_ + stride * (2 * k + 1), next = n + stride;
      if (n >= end_) break;
      if (row >= 6) continue;
      const ColumnWork& w = work(n);
      double x = w.x.v[row];
      for (int j = 0; j < 6; ++j) x -= w.h.m[row][j] * work(n - stride).x.v[j];
      for (int j = 0; next < end_ && j < 6; ++j) x -= w.e.m[row][j] * work(next).x.v[j];
      work(n).x.v[row] = x;
    }
    __syncthreads();
  }
  __device__ void move() const {
    __shared__ int turnBits;
    if (threadIdx.x == 0) turnBits = 0;
    bool finite = true;
    Real turn = 0;
    const int first = begin_ + static_cast<int>(threadIdx.x);
    for (int n = first; n < end_; n += kColumnThreads) {
      const Vec6 dx = shorter(work(n).x, 1);
      finite &= isFinite(dx.lin) && isFinite(dx.ang);
      turn = max(turn, length(dx.ang));
    }
    if (!__syncthreads_and(finite)) return;
    atomicMax(&turnBits, floatBits(turn));
    __syncthreads();
    const double share = SolveColumns::shareOf(fromFloatBits(turnBits));
    for (int n = first; n < end_; n += kColumnThreads) SolveColumns::move(s_, n, share);
  }

  const SolverData& s_;
  const int begin_, end_;
  const int lane_ = static_cast<int>(threadIdx.x) % kWarp, warp_ = static_cast<int>(threadIdx.x) / kWarp;
};

/// Each block solves the columns that begin at every gridDim.x-th node. An odd number of blocks keeps columns
/// of one length from meeting in few of them.
static __global__ void __launch_bounds__(kColumnThreads)
    solveColumns(const __grid_constant__ SolverData s, const int* nodes, Gate gate) {
  gate.enter([&] {
    __shared__ int first[kColumnThreads], count;
    const int end = *nodes, stride = static_cast<int>(gridDim.x);
    for (int base = static_cast<int>(blockIdx.x); base < end; base += stride * kColumnThreads) {
      if (threadIdx.x == 0) count = 0;
      __syncthreads();
      const int n = base + stride * static_cast<int>(threadIdx.x);
      if (n < end && s.columnNode[n].begin == n) first[atomicAdd(&count, 1)] = n;
      __syncthreads();
      const int columns = count;
      for (int k = 0; k < columns; ++k) ColumnOfBlock(s, first[k], s.columnNode[first[k]].end).solve();
      __syncthreads();
    }
  });
}

}  // namespace rubble::RUBBLE_CORE

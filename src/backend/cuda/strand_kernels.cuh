#pragma once
/// Strands (cables and rods), one warp each.
#include <cstddef>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// SolveStrand by a warp. The window of rows that an elimination step changes is held in registers, one
/// element per lane, and advances row by row. The order of operations is that of SolveStrand, so without
/// contraction the bits are the same.
struct SolveLineByTile {
  static constexpr const char* kStage = SolveStrand::kStage;
  static constexpr int kWidth = kWarp;
  static constexpr int kWindow = kStrandBand + 1;
  static_assert(kWindow * (kWindow + 1) / 2 <= kWidth);

  /// Vertices read at a time, and neighbors that their rows are coupled to.
  static constexpr int kStaged = 32, kBeside = (kStrandBand + 3) / 3;

  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    __shared__ double staged[kThreads / kWidth][(kStaged + kBeside) * kNumbers];
    double* const own = staged[threadIdx.x / kWidth];
    const Strand line = s.strand[i];
    const StrandRows rows(s, line);
    double* const numbers = &rows.work->row[0][0];
    eliminate(numbers, line.end - line.begin, tile, own);
    substitute(numbers, line.end - line.begin, tile, own);
    __syncwarp(tile.mask);
    Real turn = 0;
    for (int k = line.begin + 1 + tile.lane; k < line.end; k += kWidth)
      turn = max(turn, strandRotation(rows, k - line.begin, s.vertexParams[s.strandVertex[k].v].length));
    for (int step = kWidth / 2; step > 0; step /= 2)
      turn = max(turn, __shfl_xor_sync(tile.mask, turn, step, kWidth));
    if (tile.lane == 0) s.strandShare[i] = strandShare(turn);
  }

  /// The lane that holds element (a, b) of the window, a <= b.
  __device__ static constexpr int laneOf(int a, int b) { return a * kWindow - a * (a - 1) / 2 + b - a; }

  /// Layout of StrandWork as an array of doubles. Rows are counted from the first row of a vertex and may
  /// belong to its neighbors.
  static constexpr int kNumbers = sizeof(StrandWork) / sizeof(double);
  __device__ static int rowAt(int row) {
    return ((row + 3 * kBeside) / 3 - kBeside) * kNumbers + (row + 3 * kBeside) % 3 * kWindow;
  }
  __device__ static int unknownAt(int row) {
    return ((row + 3 * kBeside) / 3 - kBeside) * kNumbers + 3 * kWindow + (row + 3 * kBeside) % 3;
  }
  static_assert(offsetof(StrandWork, x) == sizeof(double) * 3 * kWindow);

  /// Reads vertices from `first` on. Beyond the ends of the strand the rows are those of the identity.
  __device__ static void stage(const double* rows, int vertices, int first, const Tile<kWidth>& tile,
                               double* to) {
    __syncwarp(tile.mask);
    for (int k = tile.lane; k < (kStaged + kBeside) * kNumbers; k += kWidth) {
      const int vertex = first + k / kNumbers, number = k % kNumbers;
      const bool isDiagonal = number == 0 || number == kWindow || number == 2 * kWindow;
      to[k] = vertex >= 0 && vertex < vertices ? rows[first * kNumbers + k] : isDiagonal ? 1 : 0;
    }
    __syncwarp(tile.mask);
  }

  /// L, and D^-1 L^-1 applied to the forces.
  __device__ static void eliminate(double* rows, int vertices, const Tile<kWidth>& tile, double* staged) {
    const int lane = tile.lane, behind = min(lane + 1, kStrandBand);
    int a = 0, b = lane;
    for (; a < kStrandBand && b > kStrandBand; ++a) b -= kStrandBand - a;
    b = min(b, kStrandBand);
    const bool enters = b == kStrandBand;
    const int from = enters ? 0 : laneOf(a + 1, b + 1), left = laneOf(0, min(a + 1, kStrandBand)),
              right = laneOf(0, min(b + 1, kStrandBand));
    int entryAt[3], forceAt[3], resultAt[3];
    for (int r = 0; r < 3; ++r) {
      entryAt[r] = rowAt(r + 1 + a) + kStrandBand - a, forceAt[r] = unknownAt(r + kWindow);
      resultAt[r] = lane < kStrandBand ? rowAt(r) + lane + 1 : unknownAt(r);
    }
    const auto broadcast = [&](double value, int source) {
      return __shfl_sync(tile.mask, value, source, kWidth);
    };
    double h = 0, x = 0;
    for (int first = 0; first < vertices; first += kStaged) {
      stage(rows, vertices, first, tile, staged);
      if (first == 0) h = staged[rowAt(a) + b - a], x = staged[unknownAt(min(lane, kStrandBand))];
      const double* near = staged;
      double* result = rows + first * kNumbers;
      const double* const end = rows + min(first + kStaged, vertices) * kNumbers;
      for (; result < end; result += kNumbers, near += kNumbers) {
#pragma unroll
        for (int r = 0; r < 3; ++r) {
          const double incidence = near[entryAt[r]], force = near[forceAt[r]];
          const double inverse = 1 / broadcast(h, 0), own = broadcast(x, 0);
          const double l = broadcast(h, left) * inverse, row = broadcast(h, right), old = broadcast(h, from);
          const double scaled = broadcast(h, behind) * inverse, oldForce = broadcast(x, behind);
          h = enters ? incidence : old - l * row;
          x = lane < kStrandBand ? oldForce - scaled * own : force;
          if (lane < kWindow) result[resultAt[r]] = lane < kStrandBand ? scaled : own * inverse;
        }
      }
    }
  }

  /// L^-T applied to that. Lanes hold the unknowns preceding a row.
  __device__ static void substitute(double* rows, int vertices, const Tile<kWidth>& tile, double* staged) {
    const int lane = min(tile.lane, kStrandBand);
    int factorAt[3], nextAt[3];
    for (int r = 0; r < 3; ++r) {
      factorAt[r] = rowAt(r - 1 - lane) + min(lane + 1, kStrandBand), nextAt[r] = unknownAt(r - kWindow);
    }
    double x = 0;
    for (int first = (vertices - 1) / kStaged * kStaged; first >= 0; first -= kStaged) {
      stage(rows, vertices, first - kBeside, tile, staged);
      int v = min(first + kStaged, vertices) - 1;
      if (v == vertices - 1) x = staged[(v - first + kBeside) * kNumbers + unknownAt(2 - lane)];
      const double* near = staged + (v - first + kBeside) * kNumbers;
      for (; v >= first; --v, near -= kNumbers) {
#pragma unroll
        for (int r = 2; r >= 0; --r) {
          const double factor = near[factorAt[r]], next = near[nextAt[r]];
          const double own = __shfl_sync(tile.mask, x, 0, kWidth),
                       old = __shfl_sync(tile.mask, x, min(lane + 1, kStrandBand), kWidth);
          if (tile.lane == 0) rows[v * kNumbers + unknownAt(r)] = own;
          x = lane < kStrandBand ? old - factor * own : next;
        }
      }
    }
  }
};
template <> struct OnDevice<SolveStrand> { using Type = SolveLineByTile; };

}  // namespace rubble::RUBBLE_CORE

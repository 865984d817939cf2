#pragma once
/// Partners of vertices, edges and corners of bodies. A tile of lanes per owner shares the cells to search.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// A search visits about 27 cells, and most owners find nothing.
inline constexpr int kSearchWidth = 8;

struct FindDentingBodiesByTile {
  static constexpr const char* kStage = FindDentingBodies::kStage;
  static constexpr int kWidth = kSearchWidth;
  __device__ void operator()(const SolverData& s, int body, const Tile<kWidth>& tile) const {
    const bool near = tile.ballot(FindDentingBodies::isActive(s, body, tile.lane, kWidth)) != 0;
    if (tile.lane == 0) s.nearSurface[body] = near ? 1 : 0;
  }
};
template <> struct OnDevice<FindDentingBodies> { using Type = FindDentingBodiesByTile; };

struct FindPointPairsByTile {
  static constexpr const char* kStage = FindPointPairs::kStage;
  static constexpr int kWidth = kSearchWidth;
  static constexpr int kBlocks = 8;

  __device__ void operator()(const SolverData& s, int owner, const Tile<kWidth>& tile) const {
    __shared__ int counts[kThreads / kWidth], found[kThreads / kWidth][kPointPairFinds];
    const int own = static_cast<int>(threadIdx.x) / kWidth;
    __syncwarp(tile.mask);
    if (tile.lane == 0) counts[own] = 0;
    __syncwarp(tile.mask);
    const auto keep = [&](int other) {
      if (const int k = atomicAdd(&counts[own], 1); k < kPointPairFinds) found[own][k] = other;
    };
    searchPoint(s, owner, keep, tile.lane, kWidth);
    __syncwarp(tile.mask);
    if (tile.lane != 0) return;
    PartnerList list{s.pointPairSlot + owner * kPointPairSlots};
    for (int k = 0; k < min(counts[own], kPointPairFinds); ++k) list.add(found[own][k]);
    if (counts[own] > kPointPairFinds) list.isWhole = false, list.finds = counts[own];
    FindPointPairs::finish(s, owner, list);
  }
};
template <> struct OnDevice<FindPointPairs> { using Type = FindPointPairsByTile; };

/// In no fixed order, as in the serial version.
struct FindNearByTile {
  static constexpr const char* kStage = FindNear::kStage;
  static constexpr int kWidth = kSearchWidth;
  __device__ void operator()(const SolverData& s, int owner, const Tile<kWidth>& tile) const {
    __shared__ int counts[kThreads / kWidth];
    int& count = counts[threadIdx.x / kWidth];
    __syncwarp(tile.mask);
    if (tile.lane == 0) count = 0;
    __syncwarp(tile.mask);
    int* const slots = s.pointPairSlot + owner * kPointPairSlots;
    const auto keep = [&](int feature) {
      if (const int k = atomicAdd(&count, 1); k < kPointPairSlots) slots[k] = feature;
    };
    searchNear(s, owner, keep, tile.lane, kWidth);
    __syncwarp(tile.mask);
    if (tile.lane == 0) s.nearCount[owner] = count;
  }
};
template <> struct OnDevice<FindNear> { using Type = FindNearByTile; };

}  // namespace rubble::RUBBLE_CORE

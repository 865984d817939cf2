#pragma once
/// Points of manifolds in registers. A field of the four points of a manifold is 16 contiguous bytes, half a
/// cache sector. Each of four lanes reads whole fields, and the lanes transpose them by shuffles.
#include "backend/cuda/tile.cuh"

namespace rubble::RUBBLE_CORE {

static_assert(kLanes == 4 && sizeof(Lanes) == sizeof(float4));
/// The four lanes of a manifold.
using PointTile = Tile<kLanes>;

/// 4 x 4 transpose: element k of lane j becomes element j of lane k.
__device__ inline float4 transposed(const float4& v, const PointTile& tile) {
  const auto exchange = [&](float a, int step) { return __shfl_xor_sync(tile.mask, a, step, kLanes); };
  const bool odd = tile.lane & 1, upper = tile.lane & 2;
  const float a = exchange(odd ? v.x : v.y, 1), b = exchange(odd ? v.z : v.w, 1);
  const float4 pairs = odd ? make_float4(a, v.y, b, v.w) : make_float4(v.x, a, v.z, b);
  const float c = exchange(upper ? pairs.x : pairs.z, 2), d = exchange(upper ? pairs.y : pairs.w, 2);
  return upper ? make_float4(c, d, pairs.z, pairs.w) : make_float4(pairs.x, pairs.y, c, d);
}

/// One of four consecutive Lane4 fields for each lane: at once, where a plain load would be split into one of
/// four bytes for each element that a lane sends or keeps.
__device__ inline float4 loadField(const Lanes& first, const PointTile& tile) {
  return __ldca(reinterpret_cast<const float4*>(&first) + tile.lane);
}
/// Stores the first `count` of four consecutive fields, at the points of all lanes.
__device__ inline void storeFields(Lanes& first, int count, const float4& values, const PointTile& tile) {
  const float4 field = transposed(values, tile);
  if (tile.lane < count) reinterpret_cast<float4*>(&first)[tile.lane] = field;
}

/// Quads (16 bytes) of the fields that the points of a manifold share. They come last in the struct.
inline constexpr int kSharedQuads = (sizeof(Manifold) - offsetof(Manifold, localNormal)) / sizeof(float4);
static_assert(offsetof(Manifold, localNormal) + kSharedQuads * sizeof(float4) == sizeof(Manifold));

/// Asks for the line of an address, into the first-level cache.
__device__ inline void askForLine(const void* p) { asm volatile("prefetch.global.L1 [%0];" ::"l"(p)); }

/// What a lane loads of a manifold, before the lanes exchange fields: all of it is asked for at once.
struct LoadedManifold {
  float4 onA, onB, load;  ///< one of aX to bX, of bY to lambda1, of lambda2 to drift1
  float4 shared[kSharedQuads];
  float drift2;  ///< of the point of this lane
};
__device__ inline LoadedManifold loadManifold(const Manifold& m, const PointTile& tile) {
  static_assert(offsetof(Manifold, localNormal) == 14 * sizeof(Lanes));
  LoadedManifold loaded{loadField(m.aX, tile), loadField(m.bY, tile), loadField(m.lambda2, tile), {}, 0};
#pragma unroll
  for (int q = 0; q < kSharedQuads; ++q)
    loaded.shared[q] = __ldca(reinterpret_cast<const float4*>(&m.localNormal) + q);
  loaded.drift2 = __ldca(reinterpret_cast<const Real*>(&m.drift2) + tile.lane);
  return loaded;
}
/// The fields that the points share. No point is set.
__device__ inline Manifold sharedOf(const LoadedManifold& loaded) {
  Manifold own;
  memcpy(static_cast<void*>(&own.localNormal), loaded.shared, sizeof loaded.shared);
  return own;
}
/// Makes the point of this lane point 0, but for its feature.
__device__ inline void takePoint(Manifold& own, const LoadedManifold& loaded, const PointTile& tile) {
  const float4 onA = transposed(loaded.onA, tile), onB = transposed(loaded.onB, tile),
               load = transposed(loaded.load, tile);
  own.aX[0] = onA.x, own.aY[0] = onA.y, own.aZ[0] = onA.z, own.bX[0] = onA.w;
  own.bY[0] = onB.x, own.bZ[0] = onB.y, own.lambdaN[0] = onB.z, own.lambda1[0] = onB.w;
  own.lambda2[0] = load.x, own.kN[0] = load.y, own.kT[0] = load.z, own.drift1[0] = load.w;
  own.drift2[0] = loaded.drift2;
  const auto ofPoint = [&](std::uint8_t bits) { return static_cast<std::uint8_t>(bits >> tile.lane & 1); };
  own.stick = ofPoint(own.stick), own.impact = ofPoint(own.impact),
  own.activePoints = ofPoint(own.activePoints);
}
/// A manifold with the point of this lane as point 0. Features and other points are not set.
__device__ inline Manifold manifoldOfPoint(const LoadedManifold& loaded, const PointTile& tile) {
  Manifold own = sharedOf(loaded);
  takePoint(own, loaded, tile);
  return own;
}

/// The rows of a contact with the point of this lane as point 0. Other points are not set.
__device__ inline ContactRows rowsOfPoint(const ContactRows& r, const PointTile& tile) {
  ContactRows own;
  own.place[0] = r.place[tile.lane], own.load[0] = r.load[tile.lane], own.slip[0] = r.slip[tile.lane];
  constexpr int kQuads = (sizeof(ContactRows) - offsetof(ContactRows, n)) / sizeof(float4);
  float4 shared[kQuads];
#pragma unroll
  for (int q = 0; q < kQuads; ++q) shared[q] = __ldca(reinterpret_cast<const float4*>(&r.n) + q);
  memcpy(static_cast<void*>(&own.n), shared, sizeof shared);
  return own;
}

/// Stores the fields that the points share, one quad per lane.
__device__ inline void storeShared(const Manifold& own, Manifold& m, const PointTile& tile) {
  static_assert(kSharedQuads == 2);
  float4 shared[kSharedQuads];
  memcpy(shared, &own.localNormal, sizeof shared);
  if (tile.lane < kSharedQuads)
    reinterpret_cast<float4*>(&m.localNormal)[tile.lane] = tile.lane == 0 ? shared[0] : shared[1];
}

/// Stores the persistent data of this lane's point.
__device__ inline void storeMemory(const PointMemory& p, Manifold& m, const PointTile& tile) {
  static_assert(offsetof(Manifold, drift2) == offsetof(Manifold, lambdaN) + 6 * sizeof(Lanes));
  storeFields(m.lambdaN, 4, make_float4(p.lambdaN, p.lambda1, p.lambda2, p.kN), tile);
  storeFields(m.kT, 3, make_float4(p.kT, p.drift1, p.drift2, 0), tile);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Stages over contacts, a thread a point: the four lanes of a manifold read and write what lies side by side.
#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

struct DualOfPoint {
  static constexpr const char* kName = UpdateContactDuals<Real>::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    ContactRows& r = s.contact[i];
    updateContactDuals<Real>(s.step, r, s.moved[r.a], s.moved[r.b], tile.lane);
  }
};
template <>
struct OnDevice<UpdateContactDuals<Real>> {
  using Type = DualOfPoint;
};

/// A lane a point: most manifolds are recycled, and that is copying.
struct RecycleManifoldByLanes {
  static constexpr const char* kName = RecycleManifolds::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const Pair p = s.pair[i];
    const OrderedPair o = ordered(p);
    const PairPose pose = pairPose(s, o);
    const Manifold* const found = findOldManifold(s, p);
    if (found && s.step.sleeping && !moves(s, p.owner) && !moves(s, p.other)) {
      if (tile.lane == 0) keepAsleep(s, i, p, found);
      return;
    }
    if (!found || !mayRecycle(s, o) || !recyclable(*found, pose, s.step.recycleTolerance)) {
      if (tile.lane == 0) s.tested[claimTogether(&s.counters->tested)] = i;
      return;
    }
    const Manifold& old = *found;
    Manifold& m = s.manifold[i];
    const int k = tile.lane;
    copyTogether(old, m, tile);
    const bool on = k < old.count;
    const Vec3 n = turnedNormal(old, pose);
    PointMemory memory{};
    if (on) memory = memoryOf(old, k, n);
    bool awake = on;
    // points that bear a load need no targets
    if (tile.ballot(on && memory.lambdaN == Real(0)) != 0 && on)
      awake = wakeRule(s, o)(s, o, pose, n, pointAt(old, k, n, pose.qA, pose.qB, pose.t), memory.lambdaN);
    const unsigned bits = tile.ballot(awake), stick = tile.ballot(on && (old.stick >> k & 1));
    if (bits == 0) memory.kN = memory.kT = memory.drift1 = memory.drift2 = Real(0);
    remember(m, k, memory);
    if (k != 0) return;
    m.normal = n, m.row = -1;
    m.stick = bits == 0 ? 0 : static_cast<std::uint8_t>(stick);
    m.impact = 0, m.awake = static_cast<std::uint8_t>(bits), m.recycled = true;
    const bool rows = bits != 0 && !isSensor(s, o.a) && !isSensor(s, o.b);
    s.hasRows[i] = rows;
    if (!rows) return;
    atomicCountTogether(&s.counters->contacts, __popc(bits));
    atomicCountTogether(&s.counters->recycled, 1);
  }

 private:
  /// Sixteen bytes a lane at a time.
  __device__ static void copyTogether(const Manifold& from, Manifold& to, const Tile<kWidth>& tile) {
    constexpr int kParts = sizeof(Manifold) / sizeof(float4);
    static_assert(sizeof(Manifold) % sizeof(float4) == 0);
#pragma unroll
    for (int first = 0; first < kParts; first += kWidth)
      if (first + tile.lane < kParts)
        reinterpret_cast<float4*>(&to)[first + tile.lane] = reinterpret_cast<const float4*>(&from)[first + tile.lane];
    __syncwarp(tile.mask);
  }
};
template <>
struct OnDevice<RecycleManifolds> {
  using Type = RecycleManifoldByLanes;
};

struct BuildRowsOfPoint {
  static constexpr const char* kName = BuildContactRows::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    if (s.hasRows[i] == 0) return;
    Manifold& m = s.manifold[i];
    const int k = tile.lane, row = s.rowOfPair[i];
    // everything that the points share, and the point of this thread in lane 0
    ContactRows own;
    memset(static_cast<void*>(&own), 0, sizeof own);
    const PairRows p = beginRows(s, i, own);
    own.mu[0] = p.muStatic;
    const unsigned impact = tile.ballot(k < m.count && buildPoint(s, m, p, k, own, 0));

    ContactRows& r = s.contact[row];
    r.rAx[k] = own.rAx[0], r.rAy[k] = own.rAy[0], r.rAz[k] = own.rAz[0];
    r.c0[k] = own.c0[0], r.drift1[k] = own.drift1[0], r.drift2[k] = own.drift2[0], r.mu[k] = own.mu[0];
    r.lambdaN[k] = own.lambdaN[0], r.lambda1[k] = own.lambda1[0], r.lambda2[k] = own.lambda2[0];
    r.kN[k] = own.kN[0], r.kT[k] = own.kT[0];
    const bool holds = tile.ballot(holdsAt(own, 0)) != 0;
    if (k != 0) return;
    s.joinLevel[row] = holds ? finestSharedLevel(s, own.a, own.b) : kCoarseLevels;
    r.n = own.n, r.muDynamic = own.muDynamic, r.offset = own.offset, r.start = own.start;
    r.a = own.a, r.b = own.b, r.pair = own.pair, r.length = own.length;
    m.row = row;
    m.impact = static_cast<std::uint8_t>(impact);
  }
};
template <>
struct OnDevice<BuildContactRows> {
  using Type = BuildRowsOfPoint;
};

struct StorePoint {
  static constexpr const char* kName = StoreContacts::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const ContactRows& r = s.contact[i];
    Manifold& m = s.manifold[r.pair];
    const unsigned stick = tile.ballot(tile.lane < m.count && storePoint(s, r, storedFrame(s, r), m, tile.lane));
    if (tile.lane == 0) m.stick = static_cast<std::uint8_t>(stick);
  }
};
template <>
struct OnDevice<StoreContacts> {
  using Type = StorePoint;
};

}  // namespace rubble::RUBBLE_CORE

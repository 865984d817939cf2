#pragma once
/// Stages over contacts, a thread a point: the four lanes of a manifold read and write what lies side by side.
#include "backend/cuda/kernels.cuh"
#include "backend/cuda/points.cuh"

namespace rubble::RUBBLE_CORE {

struct DualOfPoint {
  static constexpr const char* kName = UpdateContactDuals<Real>::kName;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 12;
  __device__ void operator()(const View& s, int i, const PointTile& tile) const {
    ContactRows& r = s.contact[i];
    updateContactDuals<Real>(s.step, r, s.moved[r.a], s.moved[r.b], tile.lane);
  }
};
template <>
struct OnDevice<UpdateContactDuals<Real>> {
  using Type = DualOfPoint;
};

struct FinishPoint {
  static constexpr const char* kName = FinishContacts<Real>::kName;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 10;
  __device__ void operator()(const View& s, int i, const PointTile& tile) const {
    ContactRows& r = s.contact[i];
    Manifold& m = s.manifold[r.manifold];
    const int k = tile.lane;
    // asked for before it is needed
    const bool on = k < m.count, impact = on && (m.impact >> k & 1);
    updateContactDuals<Real>(s.step, r, s.moved[r.a], s.moved[r.b], k);
    Vec3 before;
    if (impact) before = {m.lambdaN[k], m.lambda1[k], m.lambda2[k]};
    StoredPoint point{};
    if (on) point = storedPoint(s, r, storedFrame(s, r), k, impact, before);
    storeMemory(point.memory, m, tile);
    const unsigned sticks = tile.ballot(point.sticks);
    if (k == 0) m.stick = static_cast<std::uint8_t>(sticks);
  }
};
template <>
struct OnDevice<FinishContacts<Real>> {
  using Type = FinishPoint;
};

/// A lane a point: most manifolds are recycled, and that is copying.
struct RecycleManifoldByLanes {
  static constexpr const char* kName = RecycleManifolds::kName;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 6;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    const int pair = s.nearPair[i];
    const Pair p = s.pair[pair];
    const OrderedPair o = ordered(p);
    const PairPose pose = pairPose(s, o);
    const Manifold* const found = manifoldBefore(s, i);
    if (found && s.step.sleeping && !moves(s, p.owner) && !moves(s, p.other)) {
      if (tile.lane == 0) keepAsleep(s, i, p, found);
      return;
    }
    if (!found || !mayRecycle(s, o) || !recyclable(s.pairTest[pair], found->count, pose, s.step.recycleTolerance)) {
      if (tile.lane == 0) s.tested[claimTogether(&s.counters->tested)] = i;
      return;
    }
    Manifold& m = s.manifold[i];
    const Manifold old = manifoldOfPoint(*found, tile);
    copyGeometry(*found, m, tile);
    const int k = tile.lane;
    const bool on = k < old.count;
    const Vec3 n = turnedNormal(old, pose);
    PointMemory memory{};
    if (on) memory = memoryOf(old, 0, n);
    bool awake = on;
    // points that bear a load need no targets
    if (tile.ballot(on && memory.lambdaN == Real(0)) != 0 && on)
      awake = wakeRule(s, o)(s, o, pose, n, pointAt(old, 0, n, pose.qA, pose.qB, pose.t), memory.lambdaN);
    const unsigned bits = tile.ballot(awake), stick = tile.ballot(on && old.stick != 0);
    if (bits == 0) memory.kN = memory.kT = memory.drift1 = memory.drift2 = Real(0);
    storeMemory(memory, m, tile);
    // everything that is written above is in place before its first lane writes over parts of it
    __syncwarp(tile.mask);
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
  /// Everything but what points hand on, sixteen bytes a lane at a time.
  __device__ static void copyGeometry(const Manifold& from, Manifold& to, const PointTile& tile) {
    constexpr int kQuads = sizeof(Manifold) / sizeof(float4), kPlaces = offsetof(Manifold, lambdaN) / sizeof(float4);
    constexpr int kHandedOn = offsetof(Manifold, feature) / sizeof(float4) - kPlaces, kCopied = kQuads - kHandedOn;
    static_assert(sizeof(Manifold) % sizeof(float4) == 0);
    const auto quadOf = [](int k) { return k + (k < kPlaces ? 0 : kHandedOn); };
    float4 quads[(kCopied + kWidth - 1) / kWidth];
#pragma unroll
    for (int k = tile.lane, turn = 0; turn * kWidth < kCopied; ++turn, k += kWidth)
      if (k < kCopied) quads[turn] = reinterpret_cast<const float4*>(&from)[quadOf(k)];
#pragma unroll
    for (int k = tile.lane, turn = 0; turn * kWidth < kCopied; ++turn, k += kWidth)
      if (k < kCopied) reinterpret_cast<float4*>(&to)[quadOf(k)] = quads[turn];
  }
};
template <>
struct OnDevice<RecycleManifolds> {
  using Type = RecycleManifoldByLanes;
};

struct BuildRowsOfPoint {
  static constexpr const char* kName = BuildContactRows::kName;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 8;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    if (s.hasRows[i] == 0) return;
    Manifold& m = s.manifold[i];
    const int k = tile.lane, row = s.rowOffset[i];
    // everything that the points share, and the point of this thread in lane 0
    ContactRows own;
    memset(static_cast<void*>(&own), 0, sizeof own);
    const PairRows p = beginRows(s, i, own);
    own.slip[0].mu = p.muStatic;
    const unsigned impact = tile.ballot(k < m.count && buildPoint(s, m, p, k, own, 0));
    ContactRows& r = s.contact[row];
    r.place[k] = own.place[0], r.load[k] = own.load[0], r.slip[k] = own.slip[0];
    storeHead(own, r, tile);
    const bool holds = (tile.ballot(holdsAt(own, 0)) | impact) != 0;
    if (k != 0) return;
    s.joinLevel[row] = holds ? finestSharedLevel(s, own.a, own.b) : kCoarseLevels;
    m.row = row;
    m.impact = static_cast<std::uint8_t>(impact);
  }

 private:
  /// What the points share, sixteen bytes a lane.
  __device__ static void storeHead(const ContactRows& own, ContactRows& r, const PointTile& tile) {
    constexpr int kQuads = (sizeof(ContactRows) - offsetof(ContactRows, n)) / sizeof(float4);
    static_assert(kQuads == 3);
    float4 head[kQuads];
    memcpy(head, &own.n, sizeof head);
    if (tile.lane < kQuads) reinterpret_cast<float4*>(&r.n)[tile.lane] = tile.lane == 0 ? head[0] : tile.lane == 1 ? head[1] : head[2];
  }
};
template <>
struct OnDevice<BuildContactRows> {
  using Type = BuildRowsOfPoint;
};

}  // namespace rubble::RUBBLE_CORE

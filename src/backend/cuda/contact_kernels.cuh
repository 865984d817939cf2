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

struct MarkDormantPoint {
  static constexpr const char* kName = MarkDormant::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    if (!s.step.dormantRows) return;
    ContactRows& r = s.contact[i];
    const int k = tile.lane;
    // unused points have no stiffness to lose
    if (r.lambdaN[k] != Real(0) || !(r.kN[k] > Real(0))) return;
    if (staysOpen(r, k, targetDisplacement(s, r.a), targetDisplacement(s, r.b))) r.kN[k] = r.kT[k] = Real(0);
  }
};
template <>
struct OnDevice<MarkDormant> {
  using Type = MarkDormantPoint;
};

struct BuildRowsOfPoint {
  static constexpr const char* kName = BuildContactRows::kName;
  static constexpr int kWidth = kLanes;
  __device__ void operator()(const View& s, int i, const Tile<kWidth>& tile) const {
    Manifold& m = s.manifold[i];
    if (m.count == 0) return;
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
    if (k != 0) return;
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

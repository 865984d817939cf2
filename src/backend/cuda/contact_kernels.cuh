#pragma once
/// Kernels over contacts, one thread per point. The four lanes of a manifold access contiguous memory.
#include "backend/cuda/kernels.cuh"
#include "backend/cuda/points.cuh"

namespace rubble::RUBBLE_CORE {

struct DualOfPoint {
  static constexpr const char* kStage = UpdateContactDuals<Real>::kStage;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 8;
  __device__ void operator()(const SolverData& s, int i, const PointTile& tile) const {
    ContactRows& r = s.contact[i];
    ContactRows own = rowsOfPoint(r, tile);
    updateContactDuals<Real>(s.stepOf(own.a), own, loadUnchanging(s.dx[own.a]), loadUnchanging(s.dx[own.b]),
                             0);
    r.load[tile.lane] = own.load[0], r.slip[tile.lane] = own.slip[0];
  }
};
template <> struct OnDevice<UpdateContactDuals<Real>> { using Type = DualOfPoint; };

struct FinishPoint {
  static constexpr const char* kStage = FinishContacts<Real>::kStage;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 6;
  __device__ void operator()(const SolverData& s, int i, const PointTile& tile) const {
    ContactRows& r = s.contact[i];
    ContactRows own = rowsOfPoint(r, tile);
    Manifold& m = s.manifold[own.manifold];
    const int k = tile.lane;
    // all of this is asked for before it is needed
    const bool on = k < m.count, impact = on && (m.impact >> k & 1);
    PointBefore before;
    if (on) before = pointBefore(m, k, impact), noteBefore(s, i, m, k);
    const Displacement a = loadUnchanging(s.dx[own.a]), b = loadUnchanging(s.dx[own.b]);
    updateContactDuals<Real>(s.stepOf(own.a), own, a, b, 0);
    r.load[k] = own.load[0], r.slip[k] = own.slip[0];
    StoredPoint point{};
    PointSupport support;
    if (on) {
      const StoredFrame frame = storedFrame(own.n, a, b);
      point = storedPoint(s, own, frame, 0, impact, before);
      support = pointSupport(s, own, frame.t1, frame.t2, 0, !impact);
    }
    support = {tile.sum(support.load), tile.sum(support.weight), tile.sum(support.moment)};
    storeMemory(point.memory, m, tile);
    const unsigned sticks = tile.ballot(point.sticks);
    if (k != 0) return;
    m.stick = static_cast<std::uint8_t>(sticks);
    s.support[i] = supportOf(own, support);
  }
};
template <> struct OnDevice<FinishContacts<Real>> { using Type = FinishPoint; };

/// A kernel that stores manifolds (kernels.cuh, Counts).
struct CountsContacts {
  using Tally = ManifoldCount;
  __device__ static void tell(const SolverData& s, const Tally& own) {
    const Tally all{sumOfWarp(own.contacts), sumOfWarp(own.recycled)};
    if (threadIdx.x % kWarp == 0) addToCounters(s, all);
  }
};

/// One lane per point. Most manifolds are recycled, and recycling is a copy.
struct RecycleManifoldByLanes : CountsContacts {
  static constexpr const char* kStage = RecycleManifolds<Real>::kStage;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 5;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile, Tally& tally) const {
    const int pair = s.activePair[i];
    // asked for before it is known whether it is needed: what the pair has, then its manifold and its bodies
    const int before = s.manifoldBefore[pair];
    const Pair p = loadUnchanging(s.pair[pair]);
    const PairTest test = loadUnchanging(s.pairTest[pair]);
    const Manifold* const old = before < 0 ? nullptr : &s.oldManifold[before];
    LoadedManifold loaded;
    if (old) loaded = loadManifold(*old, tile);
    const OrderedPair o = ordered(p);
    PairPose pose = pairPoseWithoutMargin(s, o);
    Manifold own;
    if (old) {
      own = sharedOf(loaded);
      if (own.count == 0) setMargin(s, o, pose);
    }
    if (old && s.plan.sleeping && !moves(s, p.owner) && !moves(s, p.other)) {
      if (tile.lane == 0) keepAsleep(s, i, p, old);
      return;
    }
    if (!old || rolls(own) || !mayRecycle(s, o) ||
        !recyclable(test, own.count, pose, s.step->recycleTolerance)) {
      if (tile.lane == 0) s.tested[claimTogether(&s.counters->tested)] = i;
      return;
    }
    takePoint(own, loaded, tile);
    Manifold& m = s.manifold[i];
    copyPlaces(*old, m, tile);
    const int k = tile.lane;
    const bool on = k < own.count;
    const Vec3 n = turnedNormal(own, pose);
    PointMemory memory{};
    if (on) memory = memoryOf(own, 0, n);
    bool awake = on;
    // points that carry load do not need the targets
    if (tile.ballot(on && memory.lambdaN == Real(0)) != 0 && on)
      awake = activationRule(s, o)(s, o, pose, n, pointAt(own, 0, n, pose.qA, pose.qB, pose.t),
                                   memory.lambdaN);
    const unsigned bits = tile.ballot(awake), stick = tile.ballot(on && own.stick != 0);
    if (bits == 0) memory.kN = memory.kT = memory.drift1 = memory.drift2 = Real(0);
    storeMemory(memory, m, tile);
    own.normal = n, own.row = -1;
    own.stick = bits == 0 ? 0 : static_cast<std::uint8_t>(stick);
    own.impact = 0, own.activePoints = static_cast<std::uint8_t>(bits), own.recycled = true,
    own.passes = false;
    storeShared(own, m, tile);
    if (k != 0) return;
    const bool rows = bits != 0 && !isSensor(s, o.a) && !isSensor(s, o.b);
    s.hasRows[i] = rows;
    if (rows) tally += {__popc(bits), 1};
  }

 private:
  /// Copies positions and features of the points, 16 bytes per lane.
  __device__ static void copyPlaces(const Manifold& from, Manifold& to, const PointTile& tile) {
    constexpr int kPlaces = offsetof(Manifold, lambdaN) / sizeof(float4),
                  kHandedOn = offsetof(Manifold, feature) / sizeof(float4) - kPlaces;
    static_assert(kPlaces + 1 <= 2 * kWidth && sizeof(Manifold::feature) == sizeof(float4));
    const int second = kWidth + tile.lane, behind = second < kPlaces ? second : second + kHandedOn;
    const float4* const quads = reinterpret_cast<const float4*>(&from);
    const float4 first = quads[tile.lane];
    if (second <= kPlaces) reinterpret_cast<float4*>(&to)[behind] = quads[behind];
    reinterpret_cast<float4*>(&to)[tile.lane] = first;
  }
};
template <> struct OnDevice<RecycleManifolds<Real>> { using Type = RecycleManifoldByLanes; };

struct TestPairsByThread : CountsContacts {
  static constexpr const char* kStage = TestPairs::kStage;
  static constexpr int kBlocks = 4;
  __device__ void operator()(const SolverData& s, int t, Tally& tally) const {
    tally += TestPairs::take(s, t);
  }
};
template <> struct OnDevice<TestPairs> { using Type = TestPairsByThread; };

struct BuildRowsOfPoint {
  static constexpr const char* kStage = BuildContactRows<Real>::kStage;
  static constexpr int kWidth = kLanes;
  static constexpr int kBlocks = 6;
  __device__ void operator()(const SolverData& s, int i, const Tile<kWidth>& tile) const {
    // asked for at once, then what the bodies have
    const int k = tile.lane, row = s.rowOffset[i], pair = s.activePair[i];
    const bool hasRows = s.hasRows[i] != 0;
    const LoadedManifold loaded = loadManifold(s.manifold[i], tile);
    if (!hasRows) return;
    const OrderedPair bodies = ordered(loadUnchanging(s.pair[pair]));
    askForBodies(s, bodies, tile);
    const PairPlace place = pairPlace(s, bodies);
    const Manifold m = manifoldOfPoint(loaded, tile);
    const bool on = k < m.count;
    PointMotion<Real> motion{};
    if (on) motion = pointMotion<Real>(s, m, place, 0);
    const Real fastest = tile.max(on ? stoppedSpeed(s, place, motion.closing, motion.at.depth) : Real(0));
    // the fields that the points share, and this thread's point in lane 0
    ContactRows own;
    memset(static_cast<void*>(&own), 0, sizeof own);
    const PairRows p = beginRows(s, i, place, fastest, own);
    own.slip[0].mu = p.mu;
    const unsigned impact = tile.ballot(on && buildPoint(s, m, p, motion, 0, own, 0));
    ContactRows& r = s.contact[row];
    r.place[k] = own.place[0], r.load[k] = own.load[0], r.slip[k] = own.slip[0];
    storeHead(own, r, tile);
    const bool holds = (tile.ballot(holdsAt(own, 0)) | impact) != 0;
    if (k != 0) return;
    s.rowBodies[row] = {own.a, own.b, i};
    s.joinLevel[row] = holds ? finestSharedLevel(s, own.a, own.b) : kNoTouch;
    s.manifold[i].row = row;
    s.manifold[i].impact = static_cast<std::uint8_t>(impact);
  }

 private:
  /// Asks for what rows take of the bodies, two lanes a body: behind branches each would be waited for alone.
  __device__ static void askForBodies(const SolverData& s, const OrderedPair& o, const PointTile& tile) {
    const int body = tile.lane % 2 == 0 ? o.a : o.b;
    if (tile.lane < 2) {
      askForLine(&s.orientation[body]), askForLine(&s.velocity[body]), askForLine(&s.angularVelocity[body]);
      askForLine(&s.correction[body]);
    } else {
      askForLine(&s.params[body]), askForLine(&s.params[body].muStatic), askForLine(&s.pushed[body]);
      askForLine(&s.islandMassLength[body]), askForLine(&s.impactSpeedBound[body]);
    }
  }
  /// Stores the fields that the points share, 16 bytes per lane.
  __device__ static void storeHead(const ContactRows& own, ContactRows& r, const PointTile& tile) {
    constexpr int kQuads = (sizeof(ContactRows) - offsetof(ContactRows, n)) / sizeof(float4);
    static_assert(kQuads == kWidth);
    float4 head[kQuads];
    memcpy(head, &own.n, sizeof head);
    reinterpret_cast<float4*>(&r.n)[tile.lane] = tile.lane < 2    ? (tile.lane == 0 ? head[0] : head[1])
                                                 : tile.lane == 2 ? head[2]
                                                                  : head[3];
  }
};
template <> struct OnDevice<BuildContactRows<Real>> { using Type = BuildRowsOfPoint; };

}  // namespace rubble::RUBBLE_CORE

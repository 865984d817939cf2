#pragma once
/// Software pipeline that copies rows to shared memory while earlier rows are processed. A sweep follows a
/// chain of dependent loads: body, incidence, rows and displacement. Each is requested one body or one
/// constraint ahead, which hides memory latency.
#include <cuda_pipeline_primitives.h>

#include "backend/cuda/long_list_kernels.cuh"
#include "backend/cuda/points.cuh"

namespace rubble::RUBBLE_CORE {

/// The rows of one contact and the displacement of the other body in shared memory, padded so that neighbors
/// use different banks.
struct StagedRows {
  static constexpr int kRows = offsetof(ContactRows, muStatic) / sizeof(float4),
                       kMoved = sizeof(Displacement) / sizeof(float4);
  /// 320 bytes: neighbors start 16 of 32 banks apart
  static constexpr int kRoom = 20;
  float4 quad[kRoom];
  __device__ const ContactRows& rows() const { return reinterpret_cast<const ContactRows&>(quad[0]); }
  __device__ const Displacement& other() const { return reinterpret_cast<const Displacement&>(quad[kRows]); }
};
static_assert(StagedRows::kRows * sizeof(float4) == offsetof(ContactRows, muStatic) &&
              StagedRows::kMoved == 2 && kLanes == 4);
static_assert(StagedRows::kRows + StagedRows::kMoved <= StagedRows::kRoom);

/// Asynchronous copy of 16 bytes to shared memory, `kOffset` bytes after both addresses. Like
/// __pipeline_memcpy_async(), without recomputing the shared address in each call.
template <int kOffset> __device__ void copyQuad(unsigned to, const char* from) {
  asm volatile("cp.async.cg.shared.global [%0+%2], [%1+%2], 16;" ::"r"(to), "l"(from), "n"(kOffset)
               : "memory");
}
/// Requests `kCount` quads for each of four lanes, starting at the lane's own.
template <int kCount> __device__ void askForQuads(unsigned to, const char* from, int lane) {
  constexpr int kStep = kLanes * sizeof(float4), kWhole = kCount / kLanes;
  if constexpr (kWhole > 0) copyQuad<0>(to, from);
  if constexpr (kWhole > 1) copyQuad<kStep>(to, from);
  if constexpr (kWhole > 2) copyQuad<2 * kStep>(to, from);
  static_assert(kWhole <= 3);
  if (lane < kCount % kLanes) copyQuad<kWhole * kStep>(to, from);
}

/// Shared memory of `kQuads` quads times four lanes: two constraints each, and the displacements of two
/// bodies.
template <int kQuads> struct Staging {
  StagedRows rows[2][kQuads];
  float4 own[2][kQuads][StagedRows::kMoved];
};

/// Streams the constraints of the bodies first, first + stride ... of a list, one body per batch, to a tile
/// of `kWidth` lanes. Each group of four lanes processes every (kWidth / 4)-th constraint.
template <int kWidth, int kQuads> class RowStream {
 public:
  static constexpr int kStride = kWidth / kLanes;

  __device__ RowStream(const SolverData& s, Staging<kQuads>& staging, const Tile<kWidth>& tile,
                       const int* bodies, int count, int first, int stride)
      : s_(s),
        staging_(staging),
        quad_(PointTile::ofThread()),
        quadOfBlock_(static_cast<int>(threadIdx.x) / kLanes),
        offset_(tile.lane / kLanes),
        rowsPlace_(placeOf(staging.rows[0][quadOfBlock_].quad + quad_.lane)),
        ownPlace_(placeOf(staging.own[0][quadOfBlock_] + quad_.lane)),
        bodies_(bodies),
        count_(count),
        next_(first + 3 * stride),
        stride_(stride) {
    body_[0] = bodyAt(first), body_[1] = bodyAt(first + stride), body_[2] = bodyAt(first + 2 * stride);
    range_[0] = rangeOf(body_[0]), range_[1] = rangeOf(body_[1]);
    present_ = entryAt(range_[0], 0), ahead_ = entryAt(range_[0], 1);
  }
  /// Reads nothing that sweeps write.
  __device__ void start() { begin(present_, body_[0], 0); }

  /// Adds the contacts of the next body (-1: none). Returns whether it has incidences other than contacts.
  __device__ bool gather(Block6& sum) {
    // used in the next batch
    const Incidence following = entryAt(range_[1], 0), secondOfFollowing = entryAt(range_[1], 1);
    const Range afterNext = rangeOf(body_[2]);
    const int afterThat = bodyAt(next_);
    next_ += stride_;

    int k = range_[0].begin;
    const int end = range_[0].end;
    const Displacement& own = reinterpret_cast<const Displacement&>(staging_.own[parity_][quadOfBlock_]);
    if (!isContact(present_)) {
      begin(following, body_[1], parity_ ^ 1);
    } else {
      for (bool more = true; more; k += kStride) {
        more = isContact(ahead_);
        stage_ ^= 1;
        if (more) {
          askForRows(ahead_);
          __pipeline_commit();
        } else {
          begin(following, body_[1], parity_ ^ 1);
        }
        const Incidence incidence = present_;
        present_ = ahead_;
        if (more) ahead_ = k + 2 * kStride < end ? s_.incidence[k + 2 * kStride] : noEntry();
        __pipeline_wait_prior(1);
        __syncwarp(quad_.mask);
        accumulate(incidence, own, staging_.rows[stage_ ^ 1][quadOfBlock_], sum);
        __syncwarp(quad_.mask);
      }
    }
    const bool others = k < end;
    body_[0] = body_[1], body_[1] = body_[2], body_[2] = afterThat;
    range_[0] = range_[1], range_[1] = afterNext;
    present_ = following, ahead_ = secondOfFollowing;
    parity_ ^= 1;
    return others;
  }

 private:
  struct Range {
    int begin, end;  ///< of the incidences, for these four lanes
  };
  __device__ static Incidence noEntry() { return {kNoConstraint, -1, 0}; }
  __device__ static bool isContact(const Incidence& e) { return constraintType(e.code) == kContactType; }
  __device__ int bodyAt(int k) const { return k < count_ ? bodies_[k] : -1; }
  __device__ Range rangeOf(int body) const {
    return body < 0 ? Range{0, 0} : Range{s_.incidenceOffset[body] + offset_, s_.incidenceOffset[body + 1]};
  }
  __device__ Incidence entryAt(const Range& r, int turn) const {
    const int k = r.begin + turn * kStride;
    return k < r.end ? s_.incidence[k] : noEntry();
  }

  /// Requests the first constraint of a body, and its location.
  __device__ void begin(const Incidence& e, int body, int parity) {
    if (isContact(e)) askForRows(e);
    if (body >= 0)
      ask<StagedRows::kMoved>(ownPlace_ + static_cast<unsigned>(parity * sizeof staging_.own[0]),
                              &s_.dx[body]);
    __pipeline_commit();
  }
  __device__ void askForRows(const Incidence& e) {
    const unsigned to = rowsPlace_ + static_cast<unsigned>(stage_ * sizeof staging_.rows[0]);
    ask<StagedRows::kRows>(to, &s_.contact[constraintIndex(e.code)]);
    if (e.other >= 0) ask<StagedRows::kMoved>(to + StagedRows::kRows * sizeof(float4), &s_.dx[e.other]);
  }
  /// `to`: address for this lane.
  template <int kCount> __device__ void ask(unsigned to, const void* from) const {
    askForQuads<kCount>(to, static_cast<const char*>(from) + quad_.lane * sizeof(float4), quad_.lane);
  }
  /// Shared-memory address.
  __device__ static unsigned placeOf(const float4* p) {
    return static_cast<unsigned>(__cvta_generic_to_shared(p));
  }

  __device__ void accumulate(const Incidence& e, const Displacement& own, const StagedRows& staged,
                             Block6& sum) const {
    const ContactRows& r = staged.rows();
    const bool onA = constraintSide(e.code) == 0;
    const Displacement other = e.other >= 0 ? staged.other() : s_.dx[onA ? r.b : r.a];
    accumulateContact<Real>(s_.plan.coneHessian, r, onA, onA ? own : other, onA ? other : own, quad_.lane,
                            sum);
  }

  const SolverData& s_;
  Staging<kQuads>& staging_;
  const PointTile quad_;
  const int quadOfBlock_, offset_;
  const unsigned rowsPlace_, ownPlace_;  ///< of this lane: first stage, first parity
  const int* const bodies_;
  const int count_;
  int next_;
  const int stride_;
  int body_[3];
  Range range_[2];
  Incidence present_, ahead_;
  int stage_ = 0;   ///< stage of the next constraint
  int parity_ = 0;  ///< parity of the batch
};

}  // namespace rubble::RUBBLE_CORE

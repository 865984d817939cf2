#pragma once
/// What a tile reads to assemble a body of a joint tree. A body waits for a chain of dependent loads: its
/// node, its incidences, and the parts of its joints, one after another. So all that is known early is
/// requested early.
#include <cuda_pipeline.h>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Eight lanes per body. Lane i holds column i of H and of the couplings, lane 6 the force: for a row J with
/// stiffness K and force F, lanes add J times K J_i, K J'_i of a neighbor, and -F.
struct TreeLane {
  static constexpr int kWidth = 8, kForce = 6;
  /// A column of [H f], and one of each coupling.
  struct Columns {
    double own[6], coupling[2][6];
  };
  __device__ static bool isColumn(int lane) { return lane < 6; }
  /// The column of a lane in a body's block without couplings.
  __device__ static void load(const TreeBlock& w, int lane, double (&own)[6]) {
#pragma unroll
    for (int i = 0; i < 6; ++i)
      own[i] = isColumn(lane) ? (i >= lane ? w.h.m[i][lane] : 0) : lane == kForce ? w.x.v[i] : 0;
  }
};

/// What the assembly of a node needs to know besides its rows.
struct NodeRecord {
  TreeNode node;
  int begin, end;  ///< its incidences; none if it stands
  int locks[3];    ///< locked axes of its parents, and of its own body
  __device__ static NodeRecord of(const SolverData& s, int n) {
    NodeRecord record{s.treeNode[n], 0, 0, {}};
    const TreeNode& node = record.node;
    const auto locksOf = [&](int body) { return s.target[body].locks; };
    record.locks[2] = locksOf(node.body);
    for (int t = 0; t < 2; ++t)
      if (node.parent[t] >= 0) record.locks[t] = locksOf(s.treeNode[node.parent[t]].body);
    if (!stands(s, node))
      record.begin = s.incidenceOffset[node.body], record.end = s.incidenceOffset[node.body + 1];
    return record;
  }
};

/// Most parts of a joint of the list.
template <class... F> constexpr int mostParts(TypeList<F...>) {
  int most = 0;
  ((most = most > F::Parts::kCount ? most : F::Parts::kCount), ...);
  return most;
}

/// The sides of a joint that are the body and its neighbors, -1 for none.
struct TreeSides {
  unsigned bits;
  __device__ static TreeSides of(int own, const TreeCoupling& to, bool hasFrameBodies) {
    return {static_cast<unsigned>(own | (to.side[0] + 1) << 2 | (to.side[1] + 1) << 5 |
                                  (hasFrameBodies ? 1 << 8 : 0))};
  }
  __device__ int own() const { return static_cast<int>(bits & 3); }
  __device__ int far(int t) const { return static_cast<int>(bits >> (2 + 3 * t) & 7) - 1; }
  __device__ bool hasFrameBodies() const { return bits >> 8 != 0; }
};
/// A joint whose next part is at `part`, and the numbers of rows of its parts, all of which are read at
/// once: rows do not wait for their number.
struct JointParts {
  static constexpr int kBits = 2, kMostParts = mostParts(JointTypes{});
  static constexpr unsigned kLowerBits = 0x55555555u;  ///< of each number in `counts`
  static_assert(kBits == 2 && kMostTreeRows < 1 << kBits && kBits * kMostParts <= 32);
  const char* part;
  TreeSides sides;
  unsigned counts;
  __device__ JointParts() : part(nullptr), sides{0}, counts(0) {}
  template <int kSides>
  __device__ JointParts(const TreePart<kSides>* first, int count, int own, const TreeCoupling& to)
      : part(reinterpret_cast<const char*>(first)), sides(TreeSides::of(own, to, kSides > 2)), counts(0) {
#pragma unroll
    for (int p = 0; p < kMostParts; ++p)
      if (p < count) counts |= static_cast<unsigned>(first[p].count) << (kBits * p);
  }
  /// Number of parts with rows.
  __device__ int parts() const { return __popc((counts | counts >> 1) & kLowerBits); }
  /// The next part with rows, and their number.
  template <int kSides> __device__ const TreePart<kSides>& take(int& count) {
    const int skipped = (__ffs(static_cast<int>(counts)) - 1) / kBits;
    const TreePart<kSides>* const at = reinterpret_cast<const TreePart<kSides>*>(part) + skipped;
    counts >>= kBits * skipped;
    count = static_cast<int>(counts & ((1 << kBits) - 1));
    counts >>= kBits;
    part = reinterpret_cast<const char*>(at + 1);
    return *at;
  }
  /// The value of another lane.
  __device__ JointParts of(int lane, const Tile<TreeLane::kWidth>& tile) const {
    JointParts other;
    other.part = reinterpret_cast<const char*>(
        __shfl_sync(tile.mask, reinterpret_cast<unsigned long long>(part), lane, TreeLane::kWidth));
    other.sides.bits = __shfl_sync(tile.mask, sides.bits, lane, TreeLane::kWidth);
    other.counts = __shfl_sync(tile.mask, counts, lane, TreeLane::kWidth);
    return other;
  }
};
/// The rows of the next parts on their way from memory to a tile.
struct PartRing {
  static constexpr int kAhead = 3;  ///< slots: one part is added while the others come
  struct alignas(sizeof(int4)) Slot {
    char rows[sizeof(TreePart<4>)];
    TreeSides sides;
    int count;
  } slot[kAhead];

  /// Requests the next part of a joint.
  template <int kSides> __device__ void request(int number, JointParts& joint, int lane) {
    Slot& to = slot[number % kAhead];
    int count;
    const TreePart<kSides>& part = joint.take<kSides>(count);
    const unsigned bytes = static_cast<unsigned>(sizeof part) -
                           static_cast<unsigned>(kMostTreeRows - count) * sizeof part.row[0];
    for (unsigned at = static_cast<unsigned>(lane) * sizeof(int4); at < bytes;
         at += TreeLane::kWidth * sizeof(int4))
      __pipeline_memcpy_async(to.rows + at, reinterpret_cast<const char*>(&part) + at, sizeof(int4));
    if (lane == 0) to.sides = joint.sides, to.count = count;
  }
  __device__ void request(int number, JointParts& joint, int lane) {
    joint.sides.hasFrameBodies() ? request<4>(number, joint, lane) : request<2>(number, joint, lane);
  }
};

}  // namespace rubble::RUBBLE_CORE

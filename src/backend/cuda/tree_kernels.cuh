#pragma once
/// Stages of joint trees, a tile of lanes a body: a joint is thousands of instructions one after another, and some bodies have five.
#include <cuda_pipeline_primitives.h>

#include <algorithm>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Which number of a Block6 a lane has the sum of: its place in the lower triangle of H, or in the force where `column` is kForce; row -1: none.
struct BlockPlace {
  static constexpr int kForce = 6;
  int row, column;
  __device__ static BlockPlace of(int number) {
    // ll and aa: xx xy xz yy yz zz; then the columns of al; then fl, fa
    constexpr int kTriangle = 6;
    if (number >= kBlockReals) return {-1, 0};
    if (number >= 2 * kTriangle + 9) return {number - 2 * kTriangle - 9, kForce};
    if (number >= 2 * kTriangle) return {3 + (number - 2 * kTriangle) % 3, (number - 2 * kTriangle) / 3};
    const int first = number / kTriangle * 3, k = number % kTriangle, column = k < 3 ? 0 : k < 5 ? 1 : 2;
    return {first + (k < 3 ? k : k < 5 ? k - 2 : 2), first + column};
  }
};

template <class... F>
constexpr std::size_t largestTreeRows(TypeList<F...>) {
  return std::max({sizeof(TreeRows<F>)...});
}

/// A lane a point of a contact, then a lane a number of the block: all of them go through the rows of the joints together.
template <class L>
struct AssembleTreesByTile {
  static constexpr const char* kName = AssembleTrees<L>::kName;
  static constexpr int kWidth = kWarp, kBlocks = 5;
  /// Numbers of the couplings that a lane has.
  static constexpr int kCoupled = 36, kTurns = (2 * kCoupled + kWidth - 1) / kWidth;
  AssembleTrees<L> stage;
  explicit AssembleTreesByTile(const AssembleTrees<L>& own) : stage(own) {}

  __device__ void operator()(const View& s, int n, const Tile<kWidth>& tile) const {
    const TreeNode node = s.treeNode[n];
    // nobody asks for the blocks of small trees that rest
    if (s.smallTrees && s.treeRests[node.tree]) return;
    const BlockPlace place = BlockPlace::of(tile.lane);
    double block = place.row == place.column ? 1 : 0, coupling[kTurns] = {};
    if (!stage.stands(s, node)) block = sumRows(s, node, tile, place, coupling);
    TreeBlock& w = s.treeWork[n];
    if (place.row >= 0) (place.column == BlockPlace::kForce ? w.x.v[place.row] : w.h.m[place.row][place.column]) = block;
#pragma unroll
    for (int turn = 0; turn < kTurns; ++turn)
      if (const int k = tile.lane + turn * kWidth; k < 2 * kCoupled) (&w.e[0].m[0][0])[k] = coupling[turn];
    __syncwarp(tile.mask);
    if (tile.lane == 0) stage.lockAxesOf(s, node, w);
  }

 private:
  /// Rows of a joint in shared memory: all of them on their way at once, while those of the joint before are summed.
  struct alignas(16) Staged {
    char bytes[largestTreeRows(JointTypes{})];
  };
  static constexpr int kStages = 2;
  __device__ double sumRows(const View& s, const TreeNode& node, const Tile<kWidth>& tile, const BlockPlace& place,
                            double (&coupling)[kTurns]) const {
    const int begin = s.entryOffset[node.body], end = s.entryOffset[node.body + 1], point = tile.lane % kLanes;
    __shared__ Staged staged[kThreads / kWidth][kStages];
    Staged(&memory)[kStages] = staged[threadIdx.x / kWidth];
    Block6 own;
    if (tile.lane == 0) startBlock(s, node.body, own);
    int k = begin + tile.lane / kLanes;
    for (; k < end && entryType(s.entry[k].code) == kContactType; k += kWidth / kLanes) {
      Block6 rows;
      addContact<Real>(s, s.entry[k].code, point, rows);
      if (s.rolls && point == 0) addRolling(s, s.entry[k].code, rows);
      addWeighted(own, rows, movesInTree(s, s.entry[k].other) ? Real(2) : Real(1));
    }
    // entries are sorted by type, contacts first and joints before deformable objects
    k = __reduce_min_sync(tile.mask, k);
    double block = 0;
    for (int joints = kWidth; joints == kWidth; k += joints) {
      // a lane a joint
      const Entry entry = k + tile.lane < end ? s.entry[k + tile.lane] : Entry{0xffffffffu, -1, 0};
      const bool isJoint = entryType(entry.code) <= JointTypes::kSize;
      const int far = isJoint && entry.other >= 0 ? s.nodeOfBody[entry.other] : -1;
      joints = __popc(tile.ballot(isJoint));
      const auto codeOf = [&](int joint) { return __shfl_sync(tile.mask, entry.code, joint, kWidth); };
      if (joints > 0) askForRows(s, codeOf(0), tile, memory[0]);
      __pipeline_commit();
      for (int joint = 0; joint < joints; ++joint) {
        const Entry own{codeOf(joint), __shfl_sync(tile.mask, entry.other, joint, kWidth), 0};
        const int farNode = __shfl_sync(tile.mask, far, joint, kWidth);
        if (joint + 1 < joints) askForRows(s, codeOf(joint + 1), tile, memory[(joint + 1) % kStages]);
        __pipeline_commit();
        // all but the last that was asked for
        __pipeline_wait_prior(1);
        __syncwarp(tile.mask);
        forEachType(JointTypes{}, [&]<class F>() {
          if (entryType(own.code) == typeIndex<F>(JointTypes{}) + 1 && !isLink<F>(own.code))
            addJointRows<F>(s, node, own, farNode, tile, place, memory[joint % kStages], block, coupling);
        });
        __syncwarp(tile.mask);
      }
    }
    for (k += tile.lane; k < end; k += kWidth) addSoftRows(s, s.entry[k].code, own);
    Real sum[kRealsPerLane<kWidth>];
    sumBlocks(tile, own, sum);
    return block + static_cast<double>(sum[0]);
  }

  /// Adds rows whose Hessian counts so many times.
  __device__ static void addWeighted(Block6& to, const Block6& rows, Real weight) {
    const auto add = [&](Sym3& a, const Sym3& b) {
      a.xx += weight * b.xx, a.xy += weight * b.xy, a.xz += weight * b.xz;
      a.yy += weight * b.yy, a.yz += weight * b.yz, a.zz += weight * b.zz;
    };
    add(to.ll, rows.ll), add(to.aa, rows.aa);
    to.al0 += weight * rows.al0, to.al1 += weight * rows.al1, to.al2 += weight * rows.al2;
    to.fl += rows.fl, to.fa += rows.fa;
  }

  /// Asks for the rows of the joint of an entry.
  __device__ static void askForRows(const View& s, std::uint32_t code, const Tile<kWidth>& tile, Staged& to) {
    forEachType(JointTypes{}, [&]<class F>() {
      static_assert(sizeof(TreeRows<F>) % sizeof(int4) == 0 && sizeof(TreeRows<F>) <= sizeof(Staged));
      if (entryType(code) != typeIndex<F>(JointTypes{}) + 1 || isLink<F>(code)) return;
      const int4* const from = reinterpret_cast<const int4*>(&s.treeRowsOf<F>()[jointIndex<F>(code)]);
      for (int i = tile.lane; i < static_cast<int>(sizeof(TreeRows<F>) / sizeof(int4)); i += kWidth)
        __pipeline_memcpy_async(reinterpret_cast<int4*>(to.bytes) + i, from + i, sizeof(int4));
    });
  }

  template <class F>
  __device__ static void addJointRows(const View& s, const TreeNode& node, const Entry& entry, int far, const Tile<kWidth>& tile, const BlockPlace& place,
                                      const Staged& staged, double& block, double (&coupling)[kTurns]) {
    TreeCoupling to{{-1, -1}};
    if constexpr (isCarried<F>()) to = couplingOf<F>(s, node, entry);
    else noteCoupling(node, 1 - jointSide<F>(entry.code), far, to);
    const TreeRows<F>& rows = *reinterpret_cast<const TreeRows<F>*>(staged.bytes);
    const int side = jointSide<F>(entry.code), lane = tile.lane;
    const auto number = [](const Vec6& j, int i) { return static_cast<double>((&j.lin.x)[i]); };
    const int row = max(place.row, 0), column = place.column % BlockPlace::kForce;
    const bool isForce = place.column == BlockPlace::kForce;
    for (const TreePart<kSides<F>>& part : rows.part) {
      const int count = part.count;
      for (int k = 0; k < count; ++k) {
        const TreeRow<kSides<F>>& r = part.row[k];
        const Vec6& own = r.j[side];
        block += isForce ? -r.force * number(own, row) : r.hessian * number(own, row) * number(own, column);
#pragma unroll
        for (int turn = 0; turn < kTurns; ++turn) {
          const int e = lane + turn * kWidth, t = e / kCoupled, far = t == 0 ? to.side[0] : t == 1 ? to.side[1] : -1;
          if (far >= 0) coupling[turn] += r.hessian * number(own, e % kCoupled / 6) * number(r.j[far], e % 6);
        }
      }
      if (count > 0 && place.row == place.column) block += number(part.bend[side], row);
    }
  }
};
template <class L>
struct OnDevice<AssembleTrees<L>> {
  using Type = AssembleTreesByTile<L>;
};

/// A lane a column: of H (lanes 0 to 5), the force (6), and the two couplings (8 to 13, 16 to 21). All lanes factor H.
struct EliminateNodeByTile {
  static constexpr const char* kName = EliminateNode::kName;
  static constexpr int kWidth = kWarp;
  int begin;
  RUBBLE_HD explicit EliminateNodeByTile(const EliminateNode& stage) : begin(stage.begin) {}
  __device__ void operator()(const View& s, int index, const Tile<kWidth>& tile) const {
    const int n = begin + index, place = tile.lane / 8, column = tile.lane % 8, t = place - 1;
    const TreeNode node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    const bool isForce = place == 0 && column == 6, isHessian = place == 0 && column < 6;
    const bool isCoupling = (place == 1 || place == 2) && column < 6 && node.near[t] >= 0;
    double c[6] = {};
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isHessian) c[i] = w.h.m[i][column];
      if (isForce) c[i] = w.x.v[i];
      if (isCoupling) c[i] = w.e[t].m[i][column];
    }
    for (int source = node.sourceBegin; source < node.sourceEnd; ++source) {
      const int code = s.treeSource[source], from = code >> 1, side = code & 1;
      const TreeWork& o = s.treeWork[from];
      const int far = s.treeNode[from].near[1 - side];
      if (!isHessian && !isForce && !(isCoupling && far >= 0 && node.near[t] == far)) continue;
      const Dense6 &a = o.e[side], &b = o.w[isHessian ? side : 1 - side];
#pragma unroll
      for (int k = 0; k < 6; ++k) {
        const double factor = isForce ? o.x.v[k] : b.m[k][column];
#pragma unroll
        for (int i = 0; i < 6; ++i) c[i] -= a.m[k][i] * factor;
      }
    }
    __syncwarp(tile.mask);
    Dense6 h;
#pragma unroll
    for (int j = 0; j < 6; ++j)
#pragma unroll
      for (int i = 0; i < 6; ++i)
        if (i >= j) h.m[i][j] = __shfl_sync(tile.mask, c[i], j, kWidth);
    factor(h);
    if (!isForce && !isCoupling) return;
    Long6 x;
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isCoupling) w.e[t].m[i][column] = c[i];
      x.v[i] = c[i];
    }
    solveFactored(h, x);
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (isForce) w.x.v[i] = x.v[i];
      else w.w[t].m[i][column] = x.v[i];
    }
  }
};
template <>
struct OnDevice<EliminateNode> {
  using Type = EliminateNodeByTile;
};

/// A lane a row.
struct SubstituteNodeByTile {
  static constexpr const char* kName = SubstituteNode::kName;
  static constexpr int kWidth = 8;
  int begin;
  RUBBLE_HD explicit SubstituteNodeByTile(const SubstituteNode& stage) : begin(stage.begin) {}
  __device__ void operator()(const View& s, int index, const Tile<kWidth>& tile) const {
    const int n = begin + index, i = tile.lane;
    const TreeNode node = s.treeNode[n];
    TreeWork& w = s.treeWork[n];
    double x = i < 6 ? w.x.v[i] : 0;
    for (int t = 0; t < 2; ++t) {
      if (node.near[t] < 0 || i >= 6) continue;
      const Long6& y = s.treeWork[node.near[t]].x;
      for (int j = 0; j < 6; ++j) x -= w.w[t].m[i][j] * y.v[j];
    }
    if (i < 6) w.x.v[i] = x;
    Long6 all;
    for (int j = 0; j < 6; ++j) all.v[j] = __shfl_sync(tile.mask, x, j, kWidth);
    if (i == 0) SubstituteNode::noteTurn(s, node.tree, all);
  }
};
template <>
struct OnDevice<SubstituteNode> {
  using Type = SubstituteNodeByTile;
};

/// A block a small tree: round by round, a warp each body that is eliminated, and fewer lanes each that is substituted.
inline constexpr int kTreeThreads = 2 * kWarp;
static __global__ void __launch_bounds__(kTreeThreads) solveTrees(const __grid_constant__ View s, Gate gate) {
  gate.enter([&] {
    const int tree = static_cast<int>(blockIdx.x), thread = static_cast<int>(threadIdx.x);
    const int begin = s.treeOffset[tree], end = s.treeOffset[tree + 1];
    if (s.treeRests[s.treeNode[s.treeMember[begin]].tree]) return;
    const auto solveRound = [&]<class Kernel>(const Kernel& kernel, int first, int last) {
      constexpr int kWidth = Kernel::kWidth;
      const Tile<kWidth> tile = Tile<kWidth>::ofThread();
      for (int k = first + thread / kWidth; k < last; k += kTreeThreads / kWidth) kernel(s, s.treeMember[k], tile);
      __syncthreads();
    };
    int k = begin;
    for (int r = 0; r < s.treeRounds; ++r) {
      const int first = k;
      while (k < end && s.treeMember[k] < s.treeBegin[r + 1]) ++k;
      if (k > first) solveRound(EliminateNodeByTile(EliminateNode{0}), first, k);
    }
    for (int r = s.treeRounds - 1; r >= 0; --r) {
      const int last = k;
      while (k > begin && s.treeMember[k - 1] >= s.treeBegin[r]) --k;
      if (k < last) solveRound(SubstituteNodeByTile(SubstituteNode{0}), k, last);
    }
  });
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Kernels of joint trees, one tile of lanes per body. A joint has hundreds of numbers, and bodies have up to
/// about five joints.
#include "backend/cuda/tree_parts.cuh"

namespace rubble::RUBBLE_CORE {

/// Place of an element of a Block6 in [H f]: the lower triangle of H, or column 6.
struct BlockPlace {
  static constexpr int kForce = 6;
  int row, column;
  __device__ static BlockPlace of(int number) {
    // order: ll and aa as xx xy xz yy yz zz, then the columns of al, then fl, fa
    constexpr int kTriangle = 6, kSquare = 9;
    if (number >= 2 * kTriangle + kSquare) return {number - 2 * kTriangle - kSquare, kForce};
    if (number >= 2 * kTriangle) return {3 + (number - 2 * kTriangle) % 3, (number - 2 * kTriangle) / 3};
    const int first = number / kTriangle * 3, k = number % kTriangle, column = k < 3 ? 0 : k < 5 ? 1 : 2;
    return {first + (k < 3 ? k : k < 5 ? k - 2 : 2), first + column};
  }
};

/// Eight lanes per body, one lane per contact point. More lanes would be idle with contacts, and the rows of
/// joints are computed elsewhere.
template <class L> struct AssembleTreeBodiesByTile {
  static constexpr const char* kStage = AssembleTreeBodies<L>::kStage;
  /// 72 registers. Fewer spill most of a block to memory, more prevent concurrency with the pair search.
  static constexpr int kWidth = 8, kBlocks = 7;
  explicit AssembleTreeBodiesByTile(const AssembleTreeBodies<L>&) {}

  __device__ void operator()(const SolverData& s, int n, const Tile<kWidth>& tile) const {
    const TreeNode node = s.treeNode[n];
    // blocks of converged small trees are not used
    if (!node.large && s.treeConverged[node.tree]) return;
    Block6 block;
    const bool still = stands(s, node);
    if (!still) addRows(s, node, tile, block);
    Real sums[kRealsPerLane<kWidth>];
    sumBlocks(tile, block, sums);
    TreeBlock& w = s.treeWork[n];
#pragma unroll
    for (int k = 0; k < kRealsPerLane<kWidth>; ++k) {
      const int number = tile.lane * kRealsPerLane<kWidth> + k;
      if (number >= kBlockReals) break;
      const BlockPlace place = BlockPlace::of(number);
      if (place.column == BlockPlace::kForce)
        w.x.v[place.row] = static_cast<double>(sums[k]);
      else
        w.h.m[place.row][place.column] = still && place.row == place.column ? 1
                                                                            : static_cast<double>(sums[k]);
    }
  }

 private:
  __device__ static void addRows(const SolverData& s, const TreeNode& node, const Tile<kWidth>& tile,
                                 Block6& block) {
    const int begin = s.incidenceOffset[node.body], end = s.incidenceOffset[node.body + 1],
              point = tile.lane % kLanes;
    if (tile.lane == 0) startBlock(s, node.body, block);
    for (int k = begin + tile.lane / kLanes; k < end && constraintType(s.incidence[k].code) == kContactType;
         k += kWidth / kLanes) {
      const Incidence incidence = s.incidence[k];
      const Real weight = contactWeight(s, incidence);
      addContact<Real>(s, incidence.code, point, block, weight);
      if (s.rolls && point == 0) addRolling(s, incidence.code, block, weight);
    }
    // Deformable objects come last. Their sum is a separate variable, because a variable passed by reference
    // is not kept in registers.
    if (s.vertices == 0) return;
    Block6 soft;
    for (int k = end - 1 - tile.lane; k >= begin && constraintType(s.incidence[k].code) > JointTypes::kSize;
         k -= kWidth)
      addSoftRows(s, s.incidence[k].code, soft);
    block += soft;
  }
};
template <class L> struct OnDevice<AssembleTreeBodies<L>> { using Type = AssembleTreeBodiesByTile<L>; };

/// Adds the joints of a body, part by part, to its block.
struct AssembleTreeJointsByTile {
  static constexpr const char* kStage = AssembleTreeJoints::kStage;
  /// up to 102 registers
  static constexpr int kWidth = TreeLane::kWidth, kBlocks = 5;

  __device__ void operator()(const SolverData& s, int n, const Tile<kWidth>& tile) const {
    __shared__ PartRing rings[kThreads / kWidth];
    PartRing& ring = rings[threadIdx.x / kWidth];
    const TreeLane::Columns sums = columnsOf(s, n, NodeRecord::of(s, n), tile, ring);
    TreeBlock& w = s.treeWork[n];
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (tile.lane == TreeLane::kForce) w.x.v[i] = sums.own[i];
      if (!TreeLane::isColumn(tile.lane)) continue;
      if (i >= tile.lane) w.h.m[i][tile.lane] = sums.own[i];
#pragma unroll
      for (int t = 0; t < 2; ++t) w.e[t].m[i][tile.lane] = sums.coupling[t][i];
    }
  }
  /// The block of a body and its couplings, with its joints.
  __device__ static TreeLane::Columns columnsOf(const SolverData& s, int n, const NodeRecord& record,
                                                const Tile<kWidth>& tile, PartRing& ring) {
    TreeLane::Columns sums{};
    TreeLane::load(s.treeWork[n], tile.lane, sums.own);
    for (int k = record.begin; k < record.end; k += kWidth)
      addJoints(s, record.node, k, record.end, tile, ring, sums);
    if ((record.locks[0] | record.locks[1] | record.locks[2]) != 0) lockAxes(record.locks, tile.lane, sums);
    return sums;
  }

 private:
  /// Decouples locked axes, those of NodeRecord.
  __device__ static void lockAxes(const int (&locks)[3], int lane, TreeLane::Columns& sums) {
#pragma unroll
    for (int i = 0; i < 6; ++i) {
      if (i != lane && ((locks[2] >> i | locks[2] >> lane) & 1)) sums.own[i] = 0;
#pragma unroll
      for (int t = 0; t < 2; ++t)
        if ((locks[2] >> i | locks[t] >> lane) & 1) sums.coupling[t][i] = 0;
    }
  }

  /// Adds the joints among a tile of incidences from k on.
  __device__ static void addJoints(const SolverData& s, const TreeNode& node, int k, int end,
                                   const Tile<kWidth>& tile, PartRing& ring, TreeLane::Columns& sums) {
    const JointParts own = k + tile.lane < end ? jointOf(s, node, s.incidence[k + tile.lane]) : JointParts{};
    const int parts = own.parts(), last = tile.sumBefore(parts) + parts,
              all = __shfl_sync(tile.mask, last, kWidth - 1, kWidth);
    JointParts joint{};
    int next = 0, until = 0;
    const auto request = [&](int p) {
      if (p < all) {
        for (; p == until; ++next) {
          joint = own.of(next, tile);
          until = __shfl_sync(tile.mask, last, next, kWidth);
        }
        ring.request(p, joint, tile.lane);
      }
      __pipeline_commit();
    };
    for (int p = 0; p < PartRing::kAhead - 1; ++p) request(p);
    for (int p = 0; p < all; ++p) {
      __pipeline_wait_prior(PartRing::kAhead - 2);
      __syncwarp(tile.mask);
      request(p + PartRing::kAhead - 1);
      const PartRing::Slot& slot = ring.slot[p % PartRing::kAhead];
      const TreeSides sides = slot.sides;
      add(sides.hasFrameBodies() ? read<4>(slot, sides, tile.lane) : read<2>(slot, sides, tile.lane), sides,
          tile, sums);
    }
    __syncwarp(tile.mask);
  }
  __device__ static JointParts jointOf(const SolverData& s, const TreeNode& node,
                                       const Incidence& incidence) {
    JointParts joint;
    // read before the branch on the type, so that all lanes wait for memory together; the other side of an
    // attachment is a vertex
    const bool isBody = incidence.other >= 0 && incidence.other < s.bodies;
    const int far = isBody ? s.nodeOfBody[incidence.other] : -1;
    forEachType(JointTypes{}, [&]<class F>() {
      if (constraintType(incidence.code) != typeIndex<F>(JointTypes{}) + 1 || isLink<F>(incidence.code))
        return;
      const int side = jointSide<F>(incidence.code);
      TreeCoupling to{{-1, -1}};
      if constexpr (hasFrameBodies<F>())
        to = couplingOf<F>(s, node, incidence);
      else
        noteCoupling(node, 1 - side, far, to);
      joint = {s.treeRowsOf<F>()[jointIndex<F>(incidence.code)].part, F::Parts::kCount, side, to};
    });
    return joint;
  }

  /// This lane's numbers of the rows of a part: K (-F for the force), and a number of J, of J' of each
  /// neighbor, and of the second derivatives.
  struct PartOfLane {
    int count;
    double scale[kMostTreeRows];
    Real own[kMostTreeRows], far[2][kMostTreeRows], bend;
  };

  /// Reads a part that has come.
  template <int kSides>
  __device__ static PartOfLane read(const PartRing::Slot& slot, TreeSides sides, int lane) {
    const TreePart<kSides>& part = reinterpret_cast<const TreePart<kSides>&>(slot.rows);
    const auto of = [&](const Vec6& v) { return (&v.lin.x)[min(lane, 5)]; };
    PartOfLane own;
    own.count = slot.count;
    own.bend = of(part.bend[sides.own()]);
#pragma unroll
    for (int k = 0; k < kMostTreeRows; ++k) {
      if (k >= own.count) break;
      const TreeRow<kSides>& row = part.row[k];
      own.scale[k] = lane == TreeLane::kForce ? -row.force : row.hessian;
      own.own[k] = of(row.j[sides.own()]);
#pragma unroll
      for (int t = 0; t < 2; ++t) own.far[t][k] = sides.far(t) >= 0 ? of(row.j[sides.far(t)]) : Real(0);
    }
    return own;
  }
  __device__ static void add(const PartOfLane& part, TreeSides sides, const Tile<kWidth>& tile,
                             TreeLane::Columns& sums) {
#pragma unroll
    for (int k = 0; k < kMostTreeRows; ++k) {
      if (k >= part.count) break;
      const double own = static_cast<double>(part.own[k]), scale = part.scale[k];
      double j[6];
#pragma unroll
      for (int i = 0; i < 6; ++i) j[i] = __shfl_sync(tile.mask, own, i, kWidth);
      const double factor = tile.lane == TreeLane::kForce ? scale : scale * own;
#pragma unroll
      for (int i = 0; i < 6; ++i) sums.own[i] += j[i] * factor;
#pragma unroll
      for (int t = 0; t < 2; ++t) {
        if (sides.far(t) < 0) continue;
        const double far = scale * static_cast<double>(part.far[t][k]);
#pragma unroll
        for (int i = 0; i < 6; ++i) sums.coupling[t][i] += j[i] * far;
      }
    }
#pragma unroll
    for (int i = 0; i < 6; ++i)
      if (i == tile.lane) sums.own[i] += static_cast<double>(part.bend);
  }
};
template <> struct OnDevice<AssembleTreeJoints> { using Type = AssembleTreeJointsByTile; };

/// All lanes repeat the factorization of H. Lane i solves for column i of the couplings, lane 6 for the
/// force.
struct EliminateNodeByTile {
  static constexpr const char* kStage = EliminateNode::kStage;
  static constexpr int kWidth = TreeLane::kWidth, kBlocks = 5;
  __device__ void operator()(const SolverData& s, int n, const Tile<kWidth>& tile) const {
    const TreeNode node = s.treeNode[n];
    const TreeWork& w = s.treeWork[n];
    TreeLane::Columns c{};
    TreeLane::load(w, tile.lane, c.own);
#pragma unroll
    for (int t = 0; t < 2; ++t)
      if (node.parent[t] >= 0)
#pragma unroll
        for (int i = 0; i < 6; ++i) c.coupling[t][i] = w.e[t].m[i][min(tile.lane, 5)];
    eliminate(s, n, node, tile, c);
  }
  __device__ static void eliminate(const SolverData& s, int n, const TreeNode& node, const Tile<kWidth>& tile,
                                   TreeLane::Columns& c) {
    const int lane = tile.lane, column = min(lane, 5);
    TreeWork& w = s.treeWork[n];
    const bool isForce = lane == TreeLane::kForce, isColumn = TreeLane::isColumn(lane);
    for (int child = node.childBegin; child < node.childEnd; ++child) {
      const int code = s.treeChild[child], from = code >> 1, side = code & 1;
      const TreeWork& o = s.treeWork[from];
      const int far = s.treeNode[from].parent[1 - side];
      const auto subtract = [&](double(&to)[6], const auto& factor) {
#pragma unroll
        for (int k = 0; k < 6; ++k) {
          const double times = factor(k);
#pragma unroll
          for (int i = 0; i < 6; ++i) to[i] -= o.e[side].m[k][i] * times;
        }
      };
      subtract(c.own, [&](int k) { return isForce ? o.x.v[k] : o.w[side].m[k][column]; });
#pragma unroll
      for (int t = 0; t < 2; ++t)
        if (far >= 0 && node.parent[t] == far)
          subtract(c.coupling[t], [&](int k) { return o.w[1 - side].m[k][column]; });
    }
    Dense6 h;
#pragma unroll
    for (int j = 0; j < 6; ++j)
#pragma unroll
      for (int i = j; i < 6; ++i) h.m[i][j] = __shfl_sync(tile.mask, c.own[i], j, kWidth);
    factor(h);
    const auto solve = [&](const double(&of)[6]) {
      Long6 x;
#pragma unroll
      for (int i = 0; i < 6; ++i) x.v[i] = of[i];
      solveFactored(h, x);
      return x;
    };
    // the force and the first coupling together
    if (node.parent[0] >= 0 || isForce) {
      double of[6];
#pragma unroll
      for (int i = 0; i < 6; ++i) of[i] = isForce ? c.own[i] : c.coupling[0][i];
      const Long6 x = solve(of);
#pragma unroll
      for (int i = 0; i < 6; ++i) {
        if (isForce) w.x.v[i] = x.v[i];
        if (isColumn) w.e[0].m[i][lane] = of[i], w.w[0].m[i][lane] = x.v[i];
      }
    }
    if (node.parent[1] < 0 || !isColumn) return;
    const Long6 x = solve(c.coupling[1]);
#pragma unroll
    for (int i = 0; i < 6; ++i) w.e[1].m[i][lane] = c.coupling[1][i], w.w[1].m[i][lane] = x.v[i];
  }
};
template <> struct OnDevice<EliminateNode> { using Type = EliminateNodeByTile; };

/// One lane per row.
struct SubstituteNodeByTile {
  static constexpr const char* kStage = SubstituteNode::kStage;
  static constexpr int kWidth = 8;
  __device__ void operator()(const SolverData& s, int n, const Tile<kWidth>& tile) const {
    substitute(s, n, s.treeNode[n], tile);
  }
  __device__ static void substitute(const SolverData& s, int n, const TreeNode& node,
                                    const Tile<kWidth>& tile) {
    const int i = tile.lane;
    TreeWork& w = s.treeWork[n];
    double x = i < 6 ? w.x.v[i] : 0;
    for (int t = 0; t < 2; ++t) {
      if (node.parent[t] < 0 || i >= 6) continue;
      const Long6& y = s.treeWork[node.parent[t]].x;
      for (int j = 0; j < 6; ++j) x -= w.w[t].m[i][j] * y.v[j];
    }
    if (i < 6) w.x.v[i] = x;
    Long6 all;
    for (int j = 0; j < 6; ++j) all.v[j] = __shfl_sync(tile.mask, x, j, kWidth);
    if (i == 0) SubstituteNode::noteRotation(s, node.tree, all);
  }
};
template <> struct OnDevice<SubstituteNode> { using Type = SubstituteNodeByTile; };

/// The launch bounds of a kernel, if it has any.
template <class Kernel> struct LaunchBounds {};
template <class Kernel>
requires requires { Kernel::kBlocks; }
struct LaunchBounds<Kernel> {
  static constexpr int kBlocks = Kernel::kBlocks;
};

/// InLevel of a kernel by tiles.
template <class Kernel> struct InLevelByTile : LaunchBounds<Kernel> {
  static constexpr const char* kStage = Kernel::kStage;
  static constexpr int kWidth = Kernel::kWidth;
  int begin;
  template <class Plain> explicit InLevelByTile(const InLevel<Plain>& plain) : begin(plain.begin) {}
  __device__ void operator()(const SolverData& s, int k, const Tile<kWidth>& tile) const {
    Kernel{}(s, s.levelNode[begin + k], tile);
  }
};
template <> struct OnDevice<InLevel<AssembleTreeJoints>> {
  using Type = InLevelByTile<AssembleTreeJointsByTile>;
};
template <> struct OnDevice<InLevel<EliminateNode>> { using Type = InLevelByTile<EliminateNodeByTile>; };
template <> struct OnDevice<InLevel<SubstituteNode>> { using Type = InLevelByTile<SubstituteNodeByTile>; };

/// Calls level(first, last) for the nodes of each elimination level of a tree, in order.
template <class Level>
__device__ void forEachLevel(const SolverData& s, const SmallTree& tree, Level&& level) {
  for (int first = tree.begin, last; first < tree.end; first = last) {
    for (last = first + 1; last < tree.end && s.nodeLevel[last] == s.nodeLevel[first];) ++last;
    level(first, last);
  }
}
/// The same in reverse order.
template <class Level>
__device__ void forEachLevelBack(const SolverData& s, const SmallTree& tree, Level&& level) {
  for (int last = tree.end, first; last > tree.begin; last = first) {
    for (first = last - 1; first > tree.begin && s.nodeLevel[first - 1] == s.nodeLevel[last - 1];) --first;
    level(first, last);
  }
}

/// ProjectTree by a warp, one lane per body.
struct ProjectTreeByTile {
  static constexpr const char* kStage = ProjectTree::kStage;
  static constexpr int kWidth = kWarp;
  __device__ void operator()(const SolverData& s, int index, const Tile<kWidth>& tile) const {
    const SmallTree tree = s.smallTree[index];
    if (tree.begin == tree.end || s.treeNeedsProjection[tree.begin] == 0) return;
    const auto solve = [&](const auto& kernel, int first, int last) {
      for (int n = first + tile.lane; n < last; n += kWidth) kernel(s, n);
      __syncwarp(tile.mask);
    };
    solve(AssembleLinks{}, tree.begin, tree.end);
    forEachLevel(s, tree, [&](int first, int last) { solve(EliminateLink{}, first, last); });
    forEachLevelBack(s, tree, [&](int first, int last) { solve(SubstituteLink{}, first, last); });
  }
};
template <> struct OnDevice<ProjectTree> { using Type = ProjectTreeByTile; };

}  // namespace rubble::RUBBLE_CORE

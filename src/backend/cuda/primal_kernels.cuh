#pragma once
/// The primal update. Several lanes per body gather its rows, while the last warps of the block solve the
/// local problems of the previous batch. High-degree bodies take a block each.
#include "backend/cuda/extra_rows.cuh"
#include "backend/cuda/row_stream.cuh"

namespace rubble::RUBBLE_CORE {

/// Threads of a block that gather. Two more warps solve.
inline constexpr int kGatherThreads = 192, kSolvers = 2 * kWarp, kSolveThreads = kGatherThreads + kSolvers;
/// Resident blocks of a color kernel per multiprocessor.
inline constexpr int kSolveBlocks = 2;
/// Block ranges of a color kernel: high-degree bodies first, then vertices, then bodies.
struct ColorBlocks {
  int highDegree, vertices;
};
inline constexpr int kHighDegreeBlocks = 16;
/// One of this many resident blocks processes vertices, where bodies move as well.
inline constexpr int kVertexShare = 4;
/// Lanes per vertex, which share its elements and contacts.
inline constexpr int kVertexLanes = 8, kMostVertexLanes = kWarp;
/// Resident blocks of the vertex kernel per multiprocessor if no body moves. The number is low so that 80
/// registers are available for reading ahead.
inline constexpr int kVertexBlocks = 6;
/// Threads of the device that gather the rows of one color.
struct SolveThreads {
  int bodies, vertices;
  static SolveThreads of(const SolverData& s, int processors) {
    if (s.fixedOrder) return {0, 0};
    const int all = kSolveBlocks * processors;
    return {all * kGatherThreads,
            s.bodiesMove ? all / kVertexShare * kSolveThreads : kVertexBlocks * processors * kThreads};
  }
};
/// Colors of at most this many bodies share a single-block launch, which solves that many at once.
inline constexpr int kTailBodies = kGatherThreads / kMostLanes;

/// Adds the joints among the incidences [k, end) of a body, one per lane. Not inlined: joints are rare and
/// would raise the register count of kernels that mostly process contacts.
static __device__ __noinline__ void addJointsOutOfLine(const SolverData& s, int k, int end, int stride,
                                                       Block6* sum) {
  for (; k < end; k += stride)
    if (const std::uint32_t code = s.incidence[k].code; constraintType(code) != kContactType)
      addJoint(s, code, *sum);
}

static __device__ __noinline__ void addRollingOutOfLine(const SolverData& s, int k, int end, int stride,
                                                        Block6* sum) {
  for (; k < end && constraintType(s.incidence[k].code) == kContactType; k += stride)
    addRolling(s, s.incidence[k].code, *sum);
}

/// Adds this lane's share (of `kWidth`) of a body's joints and rolling contacts. any() is a vote of the tile.
template <int kWidth, class Any>
__device__ void addExtraRows(const SolverData& s, int body, int lane, bool joints, Any&& any, Block6& sum) {
  const int begin = s.incidenceOffset[body], end = s.incidenceOffset[body + 1];
  if (s.rolls && lane % kLanes == 0) {
    Block6 rolling = sum;
    addRollingOutOfLine(s, begin + lane / kLanes, end, kWidth / kLanes, &rolling);
    sum = rolling;
  }
  if (!any(joints)) return;
  Block6 others = sum;
  addJointsOutOfLine(s, begin + lane, end, kWidth, &others);
  sum = others;
}

/// Returns whether a body has joints, attachments or rolling contacts. Incidences are sorted by type,
/// contacts first.
__device__ inline bool hasExtraRows(const SolverData& s, int body) {
  const int end = s.incidenceOffset[body + 1];
  return end > s.incidenceOffset[body] &&
         (s.rolls || constraintType(s.incidence[end - 1].code) != kContactType);
}
static __device__ __noinline__ void addJointOutOfLine(const SolverData& s, std::uint32_t code, Block6* sum) {
  addJoint(s, code, *sum);
}
/// Adds this lane's share (of `width`) of these constraints, starting at the joints. Not inlined, as above.
/// The sums stay in registers.
static __device__ __noinline__ void addExtraRowsUniform(const SolverData& s, int body, int lane, int width,
                                                        Block6* sum) {
  const int begin = s.incidenceOffset[body], end = s.incidenceOffset[body + 1];
  Block6 own = *sum;
  for (int k = end - 1 - lane; k >= begin; k -= width) {
    const std::uint32_t code = s.incidence[k].code;
    if (constraintType(code) == kContactType) break;
    addJointUniform(s, code, own, [&](Block6& block) {
      Block6 others = block;
      addJointOutOfLine(s, code, &others);
      block = others;
    });
  }
  *sum = own;
  if (s.rolls) addRollingOutOfLine(s, begin + lane, end, width, sum);
}

/// Number of buffers for the row sums of a batch: the number of batches by which gathering may be ahead of
/// solving.
inline constexpr int kBuffers = 2;
using BatchSums = Real[kGatherThreads / kLeastLanes][kPaddedReals + 1];
/// Shared memory of a block.
struct SolveMemory {
  Staging<kGatherThreads / kLanes> staging;
  BatchSums sums[kBuffers];
  Real warpSums[kSolveThreads / kWarp][kWarp];
};
/// Static shared memory available without an opt-in [bytes].
inline constexpr int kSharedMemory = 48 * 1024;
static_assert(sizeof(SolveMemory) <= kSharedMemory);

/// Named barriers of a block (0 is __syncthreads()). Warps arrive as a whole.
inline constexpr int kFull = 1, kEmpty = kFull + kBuffers;
__device__ inline void waitAt(int barrier) {
  __syncwarp();
  asm volatile("barrier.sync %0, %1;" ::"r"(barrier), "n"(kSolveThreads) : "memory");
}
__device__ inline void passBy(int barrier) {
  asm volatile("fence.acq_rel.cta;" ::: "memory");
  __syncwarp();
  asm volatile("barrier.arrive %0, %1;" ::"r"(barrier), "n"(kSolveThreads) : "memory");
}

/// Solves `count` bodies of one color, which share no rows, by `shares` blocks. It starts before the previous
/// color has ended, as far as it reads what no sweep writes. All threads end at a barrier.
template <int kWidth, ExtraRows extra>
__device__ void solveBodies(const SolverData& s, const int* bodies, int count, int share, int shares,
                            SolveMemory& memory) {
  // with few bodies the time is that of the longest: some lanes of the solving warps add the other rows of a
  // body while its contacts are gathered
  constexpr bool few = extra == ExtraRows::FewJoints, bySolvers = few && kWidth == kMostLanes;
  constexpr int kBodies = kGatherThreads / kWidth;
  static_assert(kBodies * (bySolvers ? kWidth / kLanes : 1) <= kSolvers);
  const int thread = static_cast<int>(threadIdx.x), first = share * kBodies, stride = shares * kBodies;
  const int batches = first < count ? (count - first + stride - 1) / stride : 0;
  const auto nextBuffer = [](int buffer) { return buffer + 1 < kBuffers ? buffer + 1 : 0; };
  if (thread < kGatherThreads) {
    const Tile<kWidth> tile = Tile<kWidth>::ofThread();
    const int slot = thread / kWidth;
    RowStream<kWidth, kGatherThreads / kLanes> stream(s, memory.staging, tile, bodies, count, first + slot,
                                                      stride);
    awaitPrevious();
    stream.start();
    for (int batch = 0, buffer = 0; batch < batches; ++batch, buffer = nextBuffer(buffer)) {
      Block6 own;
      const bool others = stream.gather(own);
      if constexpr (extra != ExtraRows::None && !bySolvers)
        if (const int k = first + batch * stride + slot; (s.rolls || tile.ballot(others) != 0) && k < count) {
          if constexpr (few) {
            Block6 sum = own;
            addExtraRowsUniform(s, bodies[k], tile.lane, kWidth, &sum);
            own = sum;
          } else {
            addExtraRows<kWidth>(
                s, bodies[k], tile.lane, others, [&](bool yes) { return tile.ballot(yes) != 0; }, own);
          }
        }
      Real mine[kRealsPerLane<kWidth>];
      sumBlocks(tile, own, mine);
      if (batch >= kBuffers) waitAt(kEmpty + buffer);
#pragma unroll
      for (int k = 0; k < kRealsPerLane<kWidth>; ++k)
        memory.sums[buffer][slot][tile.lane * kRealsPerLane<kWidth> + k] = mine[k];
      passBy(kFull + buffer);
    }
  } else {
    constexpr int kShare = bySolvers ? kWidth / kLanes : 1;
    const Tile<kShare> tile = Tile<kShare>::ofThread();
    const int solver = (thread - kGatherThreads) / kShare;
    awaitPrevious();
    for (int batch = 0, buffer = 0; batch < batches; ++batch, buffer = nextBuffer(buffer)) {
      const int k = first + batch * stride + solver;
      const bool mine = solver < kBodies && k < count, on = mine && tile.lane == 0;
      const int body = mine ? bodies[k] : 0;
      Block6 block, rows;
      Pose x;
      if (on) x = startBlock(s, body, block);
      if constexpr (bySolvers)
        if (mine && hasExtraRows(s, body)) {
          Block6 own;
          addExtraRowsUniform(s, body, tile.lane, kShare, &own);
          block += sumOf(tile, own);
        }
      waitAt(kFull + buffer);
      if (on) memcpy(static_cast<void*>(&rows), memory.sums[buffer][solver], sizeof rows);
      // nothing waits for the last batches
      if (batch + kBuffers < batches) passBy(kEmpty + buffer);
      if (on) {
        block += rows;
        finishBlock(s, body, block, x);
      }
    }
  }
  __syncthreads();
}

/// This thread's share of the forces and Hessians of a high-degree body, divided among a block.
template <ExtraRows extra> __device__ Block6 gatherHighDegree(const SolverData& s, int body, int thread) {
  const int end = s.incidenceOffset[body + 1], point = thread % kLanes;
  int k = s.incidenceOffset[body] + thread / kLanes;
  const Displacement own = s.dx[body];
  Block6 sum;
  // incidences are sorted by type, contacts first
  for (; k < end; k += kSolveThreads / kLanes) {
    const Incidence incidence = s.incidence[k];
    if (constraintType(incidence.code) != kContactType) break;
    const ContactRows& r = s.contact[constraintIndex(incidence.code)];
    const bool onA = constraintSide(incidence.code) == 0;
    const Displacement other = s.dx[onA ? r.b : r.a];
    accumulateContact<Real>(s.plan.coneHessian, r, onA, onA ? own : other, onA ? other : own, point, sum);
  }
  if constexpr (extra != ExtraRows::None)
    addExtraRows<kSolveThreads>(
        s, body, thread, k < end, [](bool yes) { return __syncthreads_or(yes) != 0; }, sum);
  return sum;
}

/// A high-degree body, solved by all threads of a block.
template <ExtraRows extra>
static __device__ __noinline__ void solveHighDegreeBody(const SolverData& s, int body,
                                                        Real (&warpSums)[kSolveThreads / kWarp][kWarp]) {
  const Tile<kWarp> tile = Tile<kWarp>::ofThread();
  const int thread = static_cast<int>(threadIdx.x), warp = thread / kWarp;
  const Block6 own = gatherHighDegree<extra>(s, body, thread);
  Real mine[kRealsPerLane<kWarp>];
  sumBlocks(tile, own, mine);
  warpSums[warp][tile.lane] = mine[0];
  __syncthreads();
  if (warp == 0) {
    mine[0] = 0;
    for (int w = 0; w < kSolveThreads / kWarp; ++w) mine[0] += warpSums[w][tile.lane];
    const Block6 rows = gatherSums(tile, mine);
    if (tile.lane == 0) {
      Block6 block;
      const Pose x = startBlock(s, body, block);
      block += rows;
      finishBlock(s, body, block, x);
    }
  }
  __syncthreads();
}

/// The high-degree bodies of a color, divided among `shares` blocks.
template <ExtraRows extra>
__device__ void solveHighDegreeBodies(const SolverData& s, int color, const LongList& highDegree, int share,
                                      int shares, SolveMemory& memory) {
  for (int h = share; h < *highDegree.count; h += shares)
    if (const int body = highDegree.element[h]; s.color[body] == color && isSwept(s, body))
      solveHighDegreeBody<extra>(s, body, memory.warpSums);
}

template <ExtraRows extra>
__device__ void solveColorTogether(const SolverData& s, int color, int threads, int share, int shares,
                                   SolveMemory& memory) {
  const int begin = s.colorOffset[color], count = s.colorOffset[color + 1] - begin;
  const auto solve = [&]<int kWidth>() {
    solveBodies<kWidth, extra>(s, s.colorBody + begin, count, share, shares, memory);
  };
  // where joints take most of the time, a warp for a body would only wait for them
  if constexpr (extra == ExtraRows::FewJoints)
    withLanes<kLeastLanes, 8, kMostLanes>(lanesFor<kLeastLanes, 8, kMostLanes>(count, threads), solve);
  else
    withLanes<kLeastLanes, 8, kMostLanes, kWarp>(lanesFor<kLeastLanes, 8, kMostLanes, kWarp>(count, threads),
                                                 solve);
}

inline constexpr int kTailVertices = kSolveThreads / kMostVertexLanes;
/// `ahead`: read the next tetrahedron while one is added, at the cost of registers.
template <int kWidth, bool ahead> class VertexByTile {
 public:
  __device__ explicit VertexByTile(const SolverData& s) : s_(s) {}

  /// Reads nothing that sweeps write.
  __device__ void begin(int v) {
    v_ = v;
    corners_ = {s_.tetraCornerOffset[v] + tile_.lane, s_.tetraCornerOffset[v + 1]};
    refs_ = {s_.refOffset[v] + tile_.lane, s_.refOffset[v + 1]};
    contacts_ = {s_.pointIncidenceOffset[v] + tile_.lane, s_.pointIncidenceOffset[v + 1]};
    if constexpr (ahead) fetchNext(corners_.begin);
  }
  __device__ void solve() {
    const Vec3 place = load(s_.vertexPlace[v_]);
    Block3 block;
    if (tile_.lane == 0) block = startVertexBlock(s_, v_);
    for (int k = corners_.begin; k < corners_.end; k += kWidth) {
      if constexpr (ahead) {
        const Tetra tetra = next_;
        fetchNext(k + kWidth);
        addTetraCorner(s_, tetra.corner, tetra.start, place, block);
      } else {
        addTetraCorner(s_, s_.tetraCorner[k], s_.cornerStart[k], place, block);
      }
    }
    for (int k = refs_.begin; k < refs_.end; k += kWidth) addElement(s_, s_.ref[k], block);
    for (int k = contacts_.begin; k < contacts_.end; k += kWidth)
      addPointContact<!ahead>(s_, s_.pointIncidence[k], block);
    block = sumOf(tile_, block);
    if (tile_.lane == 0) finishVertexBlock(s_, v_, block);
  }

 private:
  struct Range {
    int begin, end;  ///< range of this lane
  };
  struct Tetra {
    TetraCorner corner;
    Sym3 start;
  };
  struct None {};
  __device__ void fetchNext(int k) {
    if (k < corners_.end) next_ = {s_.tetraCorner[k], s_.cornerStart[k]};
  }

  const SolverData& s_;
  const Tile<kWidth> tile_ = Tile<kWidth>::ofThread();
  int v_ = 0;
  Range corners_{}, refs_{}, contacts_{};
  std::conditional_t<ahead, Tetra, None> next_;
};

/// The vertices of one color, by all threads of a grid or block. Starts early as solveBodies() does.
template <bool ahead>
__device__ void solveVertices(const SolverData& s, int color, int thread, int threads, int resident) {
  const int begin = s.vertexColorOffset[color], count = s.vertexColorOffset[color + 1] - begin;
  withLanes<kVertexLanes, 16, kMostVertexLanes>(lanesFor<kVertexLanes, 16, kMostVertexLanes>(count, resident),
                                                [&]<int kWidth>() {
                                                  VertexByTile<kWidth, ahead> vertex(s);
                                                  int k = thread / kWidth;
                                                  if (k < count) vertex.begin(s.colorVertex[begin + k]);
                                                  awaitPrevious();
                                                  while (k < count) {
                                                    vertex.solve();
                                                    k += threads / kWidth;
                                                    if (k < count) vertex.begin(s.colorVertex[begin + k]);
                                                  }
                                                });
}
static __global__ void __launch_bounds__(kThreads, kVertexBlocks)
    solveVertexColor(const __grid_constant__ SolverData s, int color, int resident, const Control* control) {
  if (control->stop != 0 || color >= s.counters->colors) return awaitPrevious();
  solveVertices<true>(s, color, static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x),
                      static_cast<int>(gridDim.x * blockDim.x), resident);
}

/// Records how many colors are worth a launch.
__device__ inline void noteWideColors(const SolverData& s, int colors, Control* control) {
  for (int c = static_cast<int>(threadIdx.x); c < colors; c += kSolveThreads)
    if (s.colorOffset[c + 1] - s.colorOffset[c] > kTailBodies ||
        (s.vertices > 0 && s.vertexColorOffset[c + 1] - s.vertexColorOffset[c] > kTailVertices))
      atomicMax(&control->wideColors, c + 1);
}

/// The bodies and vertices of color `first`, which share no constraint. Without blocks for high-degree
/// bodies: all colors from it on, one after another in one block. Both cases are one kernel, so a body has
/// the same bits in either.
template <ExtraRows extra>
static __global__ void __launch_bounds__(kSolveThreads, kSolveBlocks)
    solveColors(const __grid_constant__ SolverData s, int first, LongList highDegree, ColorBlocks blocks,
                SolveThreads resident, Control* control) {
  __shared__ SolveMemory memory;
  if (control->stop != 0) return awaitPrevious();
  const bool tail = blocks.highDegree == 0;
  const int colors = s.counters->colors, end = tail ? colors : min(first + 1, colors),
            thread = static_cast<int>(threadIdx.x);
  const int block = static_cast<int>(blockIdx.x), vertexBlock = block - blocks.highDegree,
            bodyBlock = vertexBlock - blocks.vertices;
  if (tail) noteWideColors(s, colors, control);
  if (first >= end) awaitPrevious();
  for (int c = first; c < end; ++c) {
    // without high-degree bodies the tail starts as early as other blocks of bodies
    if (tail ? *highDegree.count > 0 : vertexBlock < 0) {
      awaitPrevious();
      solveHighDegreeBodies<extra>(s, c, highDegree, block, tail ? 1 : blocks.highDegree, memory);
    }
    if (bodyBlock >= 0)
      solveColorTogether<extra>(s, c, resident.bodies, bodyBlock,
                                static_cast<int>(gridDim.x) - blocks.highDegree - blocks.vertices, memory);
    if (extra == ExtraRows::None || s.vertices == 0) continue;
    if (tail || (vertexBlock >= 0 && bodyBlock < 0))
      solveVertices<false>(s, c, vertexBlock * kSolveThreads + thread,
                           max(blocks.vertices, 1) * kSolveThreads, resident.vertices);
    __syncthreads();
  }
}

/// Selects the kernel for the constraint types that occur.
inline auto solveColorsOf(const SolverData& s, int threads) {
  const ExtraRows extra = extraRowsOf(s, threads);
  return extra == ExtraRows::None  ? solveColors<ExtraRows::None>
         : extra == ExtraRows::Any ? solveColors<ExtraRows::Any>
                                   : solveColors<ExtraRows::FewJoints>;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Aggregates of the coarse correction, at several sizes. An aggregate is a set of bodies and soft nodes
/// (nodes.h) that share a cell of a nested hierarchy of cubes and are connected by touching contacts, joints
/// and attachments. Any partition gives a valid descent (coarse.h), but nodes that do not touch would only
/// disturb one another.
#include "stages/bodies/blocks.h"
#include "stages/coarse/forest.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int atLevel(const SolverData& s, int level, int node) { return level * s.nodes() + node; }
RUBBLE_HD inline int aggregateOfSoftNode(const SolverData& s, int level, int softNode) {
  return s.aggregateOf[atLevel(s, level, s.bodies + softNode)];
}

/// Every node starts as its own set. `root` is a union-find forest until FlattenAggregates; a root is its own
/// parent.
struct StartAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { s.root[i] = i; }
};

/// Unites bodies that an active constraint connects and whose finest shared cell is at this level. Bodies
/// that share a finer cell are united already.
template <class Blocks> struct JoinAggregates {
  static constexpr const char* kStage = "aggregates";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (Blocks::joinLevel(s, i) != level) return;
    const BlockBodies block = Blocks::bodies(s, i);
    if (block.active && isDynamic(s, block.a) && isDynamic(s, block.b))
      unite(s.root + level * s.nodes(), block.a, block.b);
  }
};

/// Stores the root of a node, which is also its initial set at the next coarser level.
RUBBLE_HD inline int flatten(const SolverData& s, int level, int node) {
  const int root = findRoot(s.root + level * s.nodes(), node);
  s.aggregateOf[atLevel(s, level, node)] = root;
  if (level + 1 < kCoarseLevels) s.root[atLevel(s, level + 1, node)] = root;
  return root;
}

/// Finds the roots and counts the nodes of their aggregates.
struct FlattenAggregates {
  static constexpr const char* kStage = "aggregates";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int root = flatten(s, level, i);
    if (mayJoin(s, i)) atomicCount(&s.nodeCount[atLevel(s, level, root)], 1);
  }
};

/// Is index t a deformable object at the coarsest level?
RUBBLE_HD inline bool isWholeObject(const SolverData& s, int t) {
  const int softNode = t - atLevel(s, kCoarseLevels - 1, s.bodies);
  return softNode >= 0 && softNode < s.objects;
}

/// Flags the nodes that are roots of aggregates. An aggregate that equals the one at the finer level is
/// solved at both levels, because skipping it worsens momentum conservation in impacts. A lone deformable
/// object forms an aggregate of the coarsest level, which conserves its momentum.
struct FindRoots {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    s.isRoot[t] = s.nodeCount[t] >= (isWholeObject(s, t) ? 1 : 2);
  }
};

/// Maps roots to aggregate numbers. A body or particle that is alone in its cell belongs to no aggregate.
struct NumberAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int led = atLevel(s, t / s.nodes(), s.aggregateOf[t]);
    s.aggregateOf[t] = s.isRoot[led] ? s.aggregateIndex[led] : -1;
    if (s.isRoot[t])
      s.aggregateSlices[s.aggregateIndex[t]] = (s.nodeCount[t] + kSliceNodes - 1) / kSliceNodes;
  }
};

/// First aggregate and first slice of each level.
struct FindLevels {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int level) const {
    const int aggregate = level < kCoarseLevels ? s.aggregateIndex[atLevel(s, level, 0)]
                                                : s.counters->aggregates;
    s.levelAggregate[level] = aggregate;
    s.levelSlice[level] = s.sliceOffset[aggregate];
  }
};

/// Level and slices of each aggregate.
struct BeginAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int g) const {
    int level = 0;
    while (g >= s.levelAggregate[level + 1]) ++level;
    s.aggregate[g].level = level;
    s.aggregate[g].locks = s.aggregate[g].joined = 0;
    // nodes ascend, so soft nodes come last
    s.aggregate[g].soft = s.aggregateNode[s.aggregateOffset[g + 1] - 1] >= s.bodies;
    s.aggregate[g].sliceBegin = s.sliceOffset[g];
    s.aggregate[g].sliceEnd = s.sliceOffset[g + 1];
  }
};

/// Aggregate and node range of each slice.
struct MakeSlices {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    // binary search for the last aggregate that begins at or before slice i
    int low = 0, high = s.counters->aggregates;
    while (high - low > 1) {
      const int middle = low + (high - low) / 2;
      if (s.sliceOffset[middle] <= i)
        low = middle;
      else
        high = middle;
    }
    Slice& slice = s.slice[i];
    slice.aggregate = low;
    slice.begin = s.aggregateOffset[low] + (i - s.sliceOffset[low]) * kSliceNodes;
    slice.end = min(s.aggregateOffset[low + 1], slice.begin + kSliceNodes);
  }
};

/// Flags the aggregates that contain a rigid joint. It does not ask whether a tree is solved exactly, which
/// may be found beside it.
template <class F> struct MarkJointedAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const BlockBodies block = JointBlocks<F>::bodies(s, i);
    if (!block.active || !isDynamic(s, block.a) || !isDynamic(s, block.b)) return;
    for (int level = JointBlocks<F>::rigidLevel(s, i); level < kCoarseLevels; ++level)
      if (const int aggregate = s.aggregateOf[atLevel(s, level, block.a)];
          aggregate >= 0 && aggregate == s.aggregateOf[atLevel(s, level, block.b)] &&
          atomicLoad(&s.aggregate[aggregate].joined) == 0)
        atomicSet(&s.aggregate[aggregate].joined, 1);
  }
};

/// An aggregate inherits the locked axes of its bodies. It also does not rotate about axes by which a body
/// would leave its line or plane.
struct LockAggregates {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int aggregate = s.aggregateOf[t], node = t % s.nodes();
    if (aggregate < 0 || node >= s.bodies) return;
    const int locks = s.extras[node].locks;
    if (locks == 0) return;
    const bool x = locks & 1, y = locks & 2, z = locks & 4;
    atomicSet(&s.aggregate[aggregate].locks,
              locks | (y || z ? 8 : 0) | (x || z ? 16 : 0) | (x || y ? 32 : 0));
  }
};

/// Number of coarse levels at which a and b belong to different aggregates. These are the finest levels,
/// because aggregates are nested.
RUBBLE_HD inline int separateLevels(const SolverData& s, int a, int b) {
  int level = 0;
  for (; level < kCoarseLevels; ++level) {
    const int g = s.aggregateOf[atLevel(s, level, a)];
    if (g >= 0 && g == s.aggregateOf[atLevel(s, level, b)]) break;
  }
  return level;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Deformable objects and granular particles as nodes of aggregates, so that they share the motion after an
/// impact with the bodies that they touch.
///
/// An aggregate with soft nodes is translated but not rotated. A translation changes no element and no
/// constraint inside; a rotation would shear the rows between points that have moved since x^t. A soft node
/// contributes inertia, loads, attachments and contacts of its vertices, except for constraints inside the
/// aggregate. Objects with fixed vertices are no soft nodes, because the world takes part in their momentum
/// balance.
#include "stages/soft/clusters.h"
#include "stages/soft/vertex_graph.h"

namespace rubble::RUBBLE_CORE {

/// visit(node) for the nodes that a contact or attachment connects, -1 for a node that is in no aggregate. An
/// object may be visited several times.
template <class Visit>
RUBBLE_HD void visitVertices(const SolverData& s, const int (&vertices)[kPointCorners], Visit&& visit) {
  for (int k = 0; k < kPointCorners && vertices[k] >= 0; ++k) visit(nodeOfVertex(s, vertices[k]));
}
template <class Visit> RUBBLE_HD void visitNodes(const SolverData& s, const PointContact& p, Visit&& visit) {
  visitVertices(s, p.v, visit);
  if (p.body >= 0) visit(isDynamic(s, p.body) ? p.body : -1);
}
template <class Visit> RUBBLE_HD void visitNodes(const SolverData& s, const Attachment& a, Visit&& visit) {
  visitVertices(s, a.v, visit);
  if (a.isVertexVertex == 0) visit(isDynamic(s, a.body) ? a.body : -1);
}

/// The maximum of levels(first, node) over the nodes of a constraint, where `first` is the node of its first
/// vertex. kCoarseLevels if one of them is in no aggregate.
template <class Block, class Levels>
RUBBLE_HD int mostLevels(const SolverData& s, const Block& block, Levels&& levels) {
  const int first = nodeOfVertex(s, block.v[0]);
  int most = 0;
  visitNodes(s, block, [&](int node) {
    if (first < 0 || node < 0)
      most = kCoarseLevels;
    else if (node != first)
      most = max(most, levels(first, node));
  });
  return most;
}

/// Does a constraint hold its nodes together, or stop their approach in this step?
RUBBLE_HD inline bool holdsNow(const SolverData& s, const Attachment& a) { return active(s, a); }
RUBBLE_HD inline bool holdsNow(const SolverData&, const PointContact& p) {
  return p.active && (p.impact || p.c0 > -kInactiveGap * p.length);
}

/// Until aggregates are found, `depth` of a constraint is the level at which it unites its nodes.
template <class Blocks> struct FindJoinLevels {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    auto& block = Blocks::blocks(s)[i];
    block.depth = holdsNow(s, block)
                      ? mostLevels(s, block, [&](int a, int b) { return finestSharedLevel(s, a, b); })
                      : kCoarseLevels;
  }
};
template <class Blocks> struct JoinSoftNodes {
  static constexpr const char* kStage = "aggregates";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (block.depth != level) return;
    const int first = nodeOfVertex(s, block.v[0]);
    visitNodes(s, block, [&](int node) {
      if (node != first) unite(s.root + level * s.nodes(), first, node);
    });
  }
};
/// Afterwards `depth` is the number of levels at which its nodes belong to different aggregates.
template <class Blocks> struct FindDepths {
  static constexpr const char* kStage = "aggregates";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    auto& block = Blocks::blocks(s)[i];
    block.depth = mostLevels(s, block, [&](int a, int b) { return separateLevels(s, a, b); });
  }
};

/// Sums the vertices of one of the finest clusters, if its object belongs to an aggregate of the level.
struct SumSoftNodePart {
  static constexpr const char* kStage = "soft nodes";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isWanted(s, i)) return;
    Block3 sum;
    for (int k = s.cluster[i].begin; k < s.cluster[i].end; ++k) addVertex(s, s.clusterMember[k], 0, 1, sum);
    s.clusterMotion[i].push = sum;
  }
  RUBBLE_HD bool isWanted(const SolverData& s, int i) const {
    const int softNode = s.vertexParams[s.clusterMember[s.cluster[i].begin]].softNode;
    return softNode >= 0 && aggregateOfSoftNode(s, level, softNode) >= 0;
  }
  /// Adds the share of worker `lane` of `lanes` of a vertex.
  RUBBLE_HD void addVertex(const SolverData& s, int v, int lane, int lanes, Block3& sum) const {
    addFromOutside<false>(s, v, lane, lanes, level, sum, sum);
  }
};
/// Sums a soft node from its parts.
struct SumSoftNode {
  static constexpr const char* kStage = "soft nodes";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (aggregateOfSoftNode(s, level, i) < 0) return;
    Block3 sum;
    if (s.softNode[i].cluster < 0)
      SumSoftNodePart{level}.addVertex(s, s.softNode[i].first, 0, 1, sum);
    else
      addShare(s, i, 0, 1, sum);
    s.softNodeSum[i] = sum;
  }
  /// Adds the share of one worker of an object: every `workers`-th of its parts.
  RUBBLE_HD static void addShare(const SolverData& s, int i, int worker, int workers, Block3& sum) {
    const Cluster& c = s.cluster[s.softNode[i].cluster];
    for (int k = c.sliceBegin + worker; k < c.sliceEnd; k += workers) sum += s.clusterMotion[k].push;
  }
};

/// Moves a vertex with the aggregate of its soft node.
struct MoveSoftNodes {
  static constexpr const char* kStage = "soft nodes";
  int level;
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    const int softNode = s.vertexParams[v].softNode,
              aggregate = softNode >= 0 ? aggregateOfSoftNode(s, level, softNode) : -1;
    if (aggregate < 0) return;
    const Vec3 move = s.aggregate[aggregate].step.lin;
    s.vertexMoved[v] += move;
    s.vertexPlace[v] += move;
  }
};

}  // namespace rubble::RUBBLE_CORE

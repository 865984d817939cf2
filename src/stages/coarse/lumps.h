#pragma once
/// Deformable objects and granular particles in the groups of bodies: what strikes together moves on together, whatever it is. A group with
/// lumps is moved without being turned: no element and no row inside of it feels that, while a turn would shear the rows between points that
/// have moved since x^t. Of a lump its group sees inertia, loads, attachments and contacts of the vertices, but for rows inside of the group.
/// Objects with fixed vertices are no lumps: the world takes part in whatever happens to them.
#include "stages/soft/clusters.h"
#include "stages/soft/vertex_graph.h"

namespace rubble::RUBBLE_CORE {

/// visit(member) for what a contact or attachment joins, -1 for what is in no group; an object may be visited several times.
template <class Visit>
RUBBLE_HD void visitVertices(const View& s, const int (&vertices)[kPointCorners], Visit&& visit) {
  for (int k = 0; k < kPointCorners && vertices[k] >= 0; ++k) visit(memberOfVertex(s, vertices[k]));
}
template <class Visit>
RUBBLE_HD void visitMembers(const View& s, const PointContact& p, Visit&& visit) {
  visitVertices(s, p.v, visit);
  if (p.body >= 0) visit(isDynamic(s, p.body) ? p.body : -1);
}
template <class Visit>
RUBBLE_HD void visitMembers(const View& s, const Attachment& a, Visit&& visit) {
  visitVertices(s, a.v, visit);
  if (a.seam == 0) visit(isDynamic(s, a.body) ? a.body : -1);
}

/// The most of levels(first, member) over the members of a block, the first of which is that of its first vertex; kCoarseLevels if one is in
/// no group.
template <class Block, class Levels>
RUBBLE_HD int mostLevels(const View& s, const Block& block, Levels&& levels) {
  const int first = memberOfVertex(s, block.v[0]);
  int most = 0;
  visitMembers(s, block, [&](int member) {
    if (first < 0 || member < 0) most = kCoarseLevels;
    else if (member != first) most = max(most, levels(first, member));
  });
  return most;
}

/// Does a block hold its members together now, or stop their approach in this step?
RUBBLE_HD inline bool holdsNow(const View& s, const Attachment& a) { return active(s, a); }
RUBBLE_HD inline bool holdsNow(const View&, const PointContact& p) { return p.active && (p.impact || p.c0 > -kDormantGap * p.length); }

/// `depth` of a block until groups are found: the level at which it unites its members.
template <class Blocks>
struct FindJoinLevels {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    auto& block = Blocks::blocks(s)[i];
    block.depth = holdsNow(s, block) ? mostLevels(s, block, [&](int a, int b) { return finestSharedLevel(s, a, b); }) : kCoarseLevels;
  }
};
template <class Blocks>
struct JoinLumps {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (block.depth != level) return;
    const int first = memberOfVertex(s, block.v[0]);
    visitMembers(s, block, [&](int member) {
      if (member != first) unite(s.leader + level * s.members(), first, member);
    });
  }
};
/// And then: the levels at which they are in different groups.
template <class Blocks>
struct FindDepths {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    auto& block = Blocks::blocks(s)[i];
    block.depth = mostLevels(s, block, [&](int a, int b) { return separateLevels(s, a, b); });
  }
};

/// Sums the vertices of one of the finest clusters, if its object is in a group of a level.
struct SumLumpPart {
  static constexpr const char* kName = "lumps";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!isWanted(s, i)) return;
    Block3 sum;
    for (int k = s.cluster[i].begin; k < s.cluster[i].end; ++k) addVertex(s, s.clusterMember[k], 0, 1, sum);
    s.clusterMotion[i].push = sum;
  }
  RUBBLE_HD bool isWanted(const View& s, int i) const {
    const int lump = s.vertexParams[s.clusterMember[s.cluster[i].begin]].lump;
    return lump >= 0 && groupOfLump(s, level, lump) >= 0;
  }
  /// Adds the share of number `lane` of `lanes` in a vertex.
  RUBBLE_HD void addVertex(const View& s, int v, int lane, int lanes, Block3& sum) const {
    addFromOutside<false>(s, v, lane, lanes, level, sum, sum);
  }
};
/// Sums a lump from its parts.
struct SumLump {
  static constexpr const char* kName = "lumps";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (groupOfLump(s, level, i) < 0) return;
    Block3 sum;
    if (s.lump[i].cluster < 0) SumLumpPart{level}.addVertex(s, s.lump[i].first, 0, 1, sum);
    else addShare(s, i, 0, 1, sum);
    s.lumpSum[i] = sum;
  }
  /// The share of a worker in an object: every `workers`-th of its parts.
  RUBBLE_HD static void addShare(const View& s, int i, int worker, int workers, Block3& sum) {
    const Cluster& c = s.cluster[s.lump[i].cluster];
    for (int k = c.chunkBegin + worker; k < c.chunkEnd; k += workers) sum += s.clusterMotion[k].push;
  }
};

/// Moves a vertex with the group of its lump.
struct MoveLumps {
  static constexpr const char* kName = "lumps";
  int level;
  RUBBLE_HD void operator()(const View& s, int v) const {
    const int lump = s.vertexParams[v].lump, group = lump >= 0 ? groupOfLump(s, level, lump) : -1;
    if (group < 0) return;
    const Vec3 move = s.group[group].step.lin;
    s.vertexMoved[v] += move;
    s.vertexPlace[v] += move;
  }
};

}  // namespace rubble::RUBBLE_CORE

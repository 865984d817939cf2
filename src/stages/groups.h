#pragma once
/// Groups of bodies for the coarse correction: bodies of one cell of a nested hierarchy of cubes that hang together by touching contacts and
/// joints, at several sizes. Any grouping gives a valid descent (coarse.h); bodies that do not touch would only disturb one another.
#include "stages/blocks.h"

namespace rubble::RUBBLE_CORE {

/// Edge of the finest cells in base cells of the grid (about the bounding radius of a typical body), and the ratio from level to level.
inline constexpr Real kFinestGroup = 4;
inline constexpr int kGroupRatio = 8;

RUBBLE_HD inline int atLevel(const View& s, int level, int body) { return level * s.bodies + body; }

struct GroupCell {
  int x, y, z;
  RUBBLE_HD friend bool operator==(const GroupCell& a, const GroupCell& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

/// Cell of a body at a level: nested, so that bodies that share one share all coarser ones.
RUBBLE_HD inline GroupCell groupCell(const View& s, int level, int body) {
  const double size = static_cast<double>(kFinestGroup * s.baseCell);
  int ratio = 1;
  for (int k = 0; k < level; ++k) ratio *= kGroupRatio;
  const auto cell = [&](double x) {
    constexpr double kFar = 1e9;
    // shifted, so that scenes built about the origin are not cut there at every level
    const int fine = static_cast<int>(floor(clamp(x / size, -kFar, kFar))) + 3 * kGroupRatio * kGroupRatio * kGroupRatio / 8 + 1;
    return fine >= 0 ? fine / ratio : -((ratio - 1 - fine) / ratio);
  };
  const Vec3d p = s.position[body];
  return {cell(p.x), cell(p.y), cell(p.z)};
}

/// Each body starts in the group that it has at the finer level, or alone. `leader` is a forest until FlattenGroups: roots lead themselves.
struct StartGroups {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const { s.leader[atLevel(s, level, i)] = level == 0 ? i : s.groupOf[atLevel(s, level - 1, i)]; }
};

RUBBLE_HD inline int findLeader(const int* leader, int i) {
  while (leader[i] != i) i = leader[i];
  return i;
}

/// Unites the groups of a and b; the lower leader leads, so the result does not depend on the order of unions.
RUBBLE_HD inline void unite(int* leader, int a, int b) {
  for (;;) {
    a = findLeader(leader, a), b = findLeader(leader, b);
    if (a == b) return;
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (atomicClaim(&leader[high], high, low) == high) return;
  }
}

/// Bodies that a row block holds together now: joined, or touching up to the gap below which a point is not dormant.
template <class Blocks>
struct JoinGroups {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    const BlockBodies block = Blocks::bodies(s, i);
    if (!block.acts || !isDynamic(s, block.a) || !isDynamic(s, block.b) || !Blocks::holds(s, i)) return;
    if (groupCell(s, level, block.a) == groupCell(s, level, block.b)) unite(s.leader + level * s.bodies, block.a, block.b);
  }
};

/// Every body knows its leader; members are counted.
struct FlattenGroups {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int leader = findLeader(s.leader + level * s.bodies, i);
    s.groupOf[atLevel(s, level, i)] = leader;
    if (s.params[i].kind == BodyKind::Dynamic) atomicCount(&s.memberCount[atLevel(s, level, leader)], 1);
  }
};

struct FindLeaders {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int t) const { s.leads[t] = s.memberCount[t] >= 2; }
};

/// From leaders to group numbers; a body alone in its cell is in no group.
struct NumberGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int t) const {
    const int level = t / s.bodies, body = t - level * s.bodies;
    if (s.params[body].kind != BodyKind::Dynamic) {
      s.groupOf[t] = -1;
      return;
    }
    const int led = atLevel(s, level, s.groupOf[t]);
    s.groupOf[t] = s.leads[led] ? s.groupIndex[led] : -1;
    if (s.leads[t]) s.groupChunks[s.groupIndex[t]] = (s.memberCount[t] + kChunkMembers - 1) / kChunkMembers;
  }
};

/// First group and first chunk of each level.
struct FindLevels {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int level) const {
    const int group = level < kCoarseLevels ? s.groupIndex[level * s.bodies] : s.counters->groups;
    s.levelGroup[level] = group;
    s.levelChunk[level] = s.chunkOffset[group];
  }
};

struct MakeChunks {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int g) const {
    const int begin = s.memberOffset[g], end = s.memberOffset[g + 1];
    int level = 0;
    while (g >= s.levelGroup[level + 1]) ++level;
    s.group[g].level = level;
    s.group[g].chunkBegin = s.chunkOffset[g];
    s.group[g].chunkEnd = s.chunkOffset[g + 1];
    for (int k = 0; k < s.groupChunks[g]; ++k) {
      Chunk& chunk = s.chunk[s.chunkOffset[g] + k];
      chunk.group = g;
      chunk.begin = begin + k * kChunkMembers;
      chunk.end = min(end, chunk.begin + kChunkMembers);
    }
  }
};

/// Mass and first moment of a chunk, about its first member.
struct SumMasses {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Chunk& chunk = s.chunk[i];
    const Vec3d origin = s.position[s.member[s.memberOffset[chunk.group]]];
    Real mass = 0;
    Vec3 moment;
    for (int k = chunk.begin; k < chunk.end; ++k) {
      const int body = s.member[k];
      mass += s.params[body].mass;
      moment += s.params[body].mass * Vec3(s.position[body] - origin);
    }
    chunk.sum.ll.xx = mass;
    chunk.sum.fl = moment;
  }
};

struct FindCentres {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int g) const {
    Group& group = s.group[g];
    Real mass = 0;
    Vec3 moment;
    for (int k = group.chunkBegin; k < group.chunkEnd; ++k) {
      mass += s.chunk[k].sum.ll.xx;
      moment += s.chunk[k].sum.fl;
    }
    group.centre = s.position[s.member[s.memberOffset[g]]] + Vec3d(moment / mass);
  }
};

/// Coarse levels at which a and b are in different groups: the finest ones, since groups are nested.
RUBBLE_HD inline int separateLevels(const View& s, int a, int b) {
  int level = 0;
  for (; level < kCoarseLevels; ++level) {
    const int g = s.groupOf[atLevel(s, level, a)];
    if (g >= 0 && g == s.groupOf[atLevel(s, level, b)]) break;
  }
  return level;
}

}  // namespace rubble::RUBBLE_CORE

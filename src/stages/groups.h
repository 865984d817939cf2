#pragma once
/// Groups of bodies for the coarse correction: the bodies of one cell of a nested hierarchy of cubes, at several sizes. Any grouping gives
/// a valid descent (coarse.h); cells make it cheap, nested and independent of order.
#include "stages/contacts.h"

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

/// Does the body stand for itself (finest level) or for its finer group at this level?
RUBBLE_HD inline bool standsAt(const View& s, int level, int body) {
  return s.params[body].kind == BodyKind::Dynamic && (level == 0 || s.leader[atLevel(s, level - 1, body)] == body);
}

/// Slot of a body's cell in the table: the one of the first body that came.
RUBBLE_HD inline int findCell(const View& s, int level, int body) {
  const GroupCell cell = groupCell(s, level, body);
  const std::uint32_t h = hash32(static_cast<std::uint32_t>(cell.x) ^ hash32(static_cast<std::uint32_t>(cell.y) ^ hash32(static_cast<std::uint32_t>(cell.z))));
  int slot = static_cast<int>(h & static_cast<std::uint32_t>(s.cells - 1));
  for (;; slot = (slot + 1) & (s.cells - 1)) {
    const int head = atomicClaim(&s.cellHead[slot], -1, body);
    if (head < 0 || groupCell(s, level, head) == cell) return slot;
  }
}

struct FindCells {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (standsAt(s, level, i)) atomicLower(&s.cellLeader[findCell(s, level, i)], i);
  }
};

struct TakeLeaders {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (standsAt(s, level, i)) s.leader[atLevel(s, level, i)] = s.cellLeader[findCell(s, level, i)];
  }
};

/// Bodies follow the body that stands for them; members are counted.
struct FollowLeaders {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.params[i].kind != BodyKind::Dynamic) return;
    int leader = i;
    for (int level = 0; level < kCoarseLevels; ++level) {
      leader = s.leader[atLevel(s, level, leader)];
      s.groupOf[atLevel(s, level, i)] = leader;
      atomicCount(&s.memberCount[atLevel(s, level, leader)], 1);
    }
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

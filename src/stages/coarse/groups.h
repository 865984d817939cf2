#pragma once
/// Groups for the coarse correction: bodies and lumps (members.h) of one cell of a nested hierarchy of cubes that hang together by touching
/// contacts, joints and attachments, at several sizes. Any grouping gives a valid descent (coarse.h); members that do not touch would only
/// disturb one another.
#include "stages/bodies/blocks.h"
#include "stages/coarse/forest.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int atLevel(const View& s, int level, int member) { return level * s.members() + member; }
RUBBLE_HD inline int groupOfLump(const View& s, int level, int lump) { return s.groupOf[atLevel(s, level, s.bodies + lump)]; }

/// Every member is alone at first. `leader` is a forest until FlattenGroups: roots lead themselves.
struct StartGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const { s.leader[i] = i; }
};

/// Unites bodies that a row block holds together now and that share a cell at this level and at none that is finer: those that share a
/// finer one are united already.
template <class Blocks>
struct JoinGroups {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (Blocks::joinLevel(s, i) != level) return;
    const BlockBodies block = Blocks::bodies(s, i);
    if (block.acts && isDynamic(s, block.a) && isDynamic(s, block.b)) unite(s.leader + level * s.members(), block.a, block.b);
  }
};

/// Every member knows its leader, and starts the next level with it.
RUBBLE_HD inline int flatten(const View& s, int level, int member) {
  const int leader = findLeader(s.leader + level * s.members(), member);
  s.groupOf[atLevel(s, level, member)] = leader;
  if (level + 1 < kCoarseLevels) s.leader[atLevel(s, level + 1, member)] = leader;
  return leader;
}

/// Leaders, and the number of members of their groups.
struct FlattenGroups {
  static constexpr const char* kName = "groups";
  int level;
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int leader = flatten(s, level, i);
    if (mayJoin(s, i)) atomicCount(&s.memberCount[atLevel(s, level, leader)], 1);
  }
};

/// Is place t that of a deformable object at the coarsest level?
RUBBLE_HD inline bool isWholeObject(const View& s, int t) {
  const int lump = t - atLevel(s, kCoarseLevels - 1, s.bodies);
  return lump >= 0 && lump < s.objects;
}

/// Which of them lead a group. One that is the same as at the finer level is solved at both: left out at one of them, the momentum of an impact is
/// kept less well, for its sweeps are what finds it. An object that is alone is a group of the coarsest level, so that it keeps its own.
struct FindLeaders {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int t) const { s.leads[t] = s.memberCount[t] >= (isWholeObject(s, t) ? 1 : 2); }
};

/// From leaders to group numbers; a body or particle that is alone in its cell is in no group.
struct NumberGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int t) const {
    const int led = atLevel(s, t / s.members(), s.groupOf[t]);
    s.groupOf[t] = s.leads[led] ? s.groupIndex[led] : -1;
    if (s.leads[t]) s.groupChunks[s.groupIndex[t]] = (s.memberCount[t] + kChunkMembers - 1) / kChunkMembers;
  }
};

/// First group and first chunk of each level.
struct FindLevels {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int level) const {
    const int group = level < kCoarseLevels ? s.groupIndex[atLevel(s, level, 0)] : s.counters->groups;
    s.levelGroup[level] = group;
    s.levelChunk[level] = s.chunkOffset[group];
  }
};

/// Level and chunks of each group.
struct BeginGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int g) const {
    int level = 0;
    while (g >= s.levelGroup[level + 1]) ++level;
    s.group[g].level = level;
    s.group[g].locks = s.group[g].joined = 0;
    // members ascend
    s.group[g].soft = s.member[s.memberOffset[g + 1] - 1] >= s.bodies;
    s.group[g].chunkBegin = s.chunkOffset[g];
    s.group[g].chunkEnd = s.chunkOffset[g + 1];
  }
};

/// Group and members of each chunk.
struct MakeChunks {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    // the last group that begins at i or before
    int low = 0, high = s.counters->groups;
    while (high - low > 1) {
      const int middle = low + (high - low) / 2;
      if (s.chunkOffset[middle] <= i) low = middle;
      else high = middle;
    }
    Chunk& chunk = s.chunk[i];
    chunk.group = low;
    chunk.begin = s.memberOffset[low] + (i - s.chunkOffset[low]) * kChunkMembers;
    chunk.end = min(s.memberOffset[low + 1], chunk.begin + kChunkMembers);
  }
};

/// Finds the groups inside of which there is a joint.
template <class F>
struct MarkJoinedGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const BlockBodies block = JointBlocks<F>::bodies(s, i);
    if (!block.acts || !isDynamic(s, block.a) || !isDynamic(s, block.b)) return;
    for (int level = JointBlocks<F>::joinLevel(s, i); level < kCoarseLevels; ++level)
      if (const int group = s.groupOf[atLevel(s, level, block.a)]; group >= 0 && s.group[group].joined == 0) atomicSet(&s.group[group].joined, 1);
  }
};

/// A group does not move as one of its bodies must not: it does not turn such that a body would leave its line or plane either.
struct LockGroups {
  static constexpr const char* kName = "groups";
  RUBBLE_HD void operator()(const View& s, int t) const {
    const int group = s.groupOf[t], member = t % s.members();
    if (group < 0 || member >= s.bodies) return;
    const int locks = s.extras[member].locks;
    if (locks == 0) return;
    const bool x = locks & 1, y = locks & 2, z = locks & 4;
    atomicSet(&s.group[group].locks, locks | (y || z ? 8 : 0) | (x || z ? 16 : 0) | (x || y ? 32 : 0));
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

#pragma once
/// Ranks that store into one another's tables: GPUs, or threads. Written once for CPU and GPU.
///
/// All ranks have tables with the same indices, so an exchange is a store of an element into the same place
/// of another rank's table, and a barrier of all ranks. Between two barriers a rank does not read what others
/// store, except where they store what is there already (peer_phases.h names the reason at each exchange).
/// Where the memory of another rank is out of reach, the stores are letters (peer_letters.h), which the
/// barrier brings.
#include <atomic>
#include <type_traits>

#include "backend/division.h"
#include "backend/peers/peer_letters.h"

namespace rubble::RUBBLE_CORE {

/// flag = value, where several threads may set a flag to the same value.
template <class T> RUBBLE_HD void mark(T& flag, std::type_identity_t<T> value = 1) {
  if constexpr (RUBBLE_DEVICE_CODE)
    flag = value;
  else
    std::atomic_ref<T>(flag).store(value, std::memory_order_relaxed);
}

/// Ranks are bits of a number.
inline constexpr int kMostPeers = 32;
/// Owner of bodies that every rank solves: those that touch deformable objects.
inline constexpr int kEveryPeer = -1;

/// Lists of the elements that a rank runs. Those of joints follow, by type.
enum class PeerList {
  MigratingPairs,  ///< old pairs that it gives to new owners
  Pairs,           ///< near pairs
  ActivePairs,     ///< of these, the active ones
  OwnRows,         ///< of these, the rows
  CrossRows,       ///< rows between bodies of two other ranks
  JoinedRows,      ///< own rows, then cross rows; only until extra rows are listed
  ExtraRows,       ///< rows evaluated for its slices alone
  Rows,            ///< own rows, then extra ones
  Bodies,
  Ghosts,        ///< bodies of others that it sees
  SeenBodies,    ///< its own, then ghosts
  SharedBodies,  ///< its own that others see or solve
  Slices,
  SeenSlices,
  MixedSlices,  ///< seen ones of mixed aggregates
  SentSlices,   ///< own ones of mixed aggregates
  FirstJoint
};
inline constexpr int kPeerJointLists = 3;  ///< of a type: all that are evaluated, near ones, extra ones
inline constexpr int kPeerLists = static_cast<int>(PeerList::FirstJoint) +
                                  kPeerJointLists * JointTypes::kSize;
enum class PeerJoints { All, Own, Extra };
constexpr PeerList listOfJoints(PeerJoints kind, int type) {
  return static_cast<PeerList>(static_cast<int>(PeerList::FirstJoint) + kPeerJointLists * type +
                               static_cast<int>(kind));
}
template <class F> constexpr PeerList listOfJoints(PeerJoints kind) {
  return listOfJoints(kind, typeIndex<F>(JointTypes{}));
}
/// The list of the elements of a cut. FirstJoint: there is none, or it depends on more than the cut.
constexpr PeerList peerListOf(Cut cut) {
  using List = PeerList;
  constexpr struct {
    Cut cut;
    PeerList list;
  } kLists[] = {{Cut::Pairs, List::Pairs},           {Cut::ActivePairs, List::ActivePairs},
                {Cut::JoinedRows, List::JoinedRows}, {Cut::Rows, List::Rows},
                {Cut::OwnRows, List::OwnRows},       {Cut::Bodies, List::Bodies},
                {Cut::Slices, List::Slices},         {Cut::SeenSlices, List::SeenSlices}};
  for (const auto& each : kLists)
    if (each.cut == cut) return each.list;
  return PeerList::FirstJoint;
}
/// The list that a list begins with, in the same memory; itself for most.
constexpr PeerList beginningOf(PeerList list) {
  if (list == PeerList::Rows || list == PeerList::JoinedRows) return PeerList::OwnRows;
  if (list == PeerList::SeenBodies) return PeerList::Bodies;
  const int joint = static_cast<int>(list) - static_cast<int>(PeerList::FirstJoint);
  if (joint >= 0 && joint % kPeerJointLists == static_cast<int>(PeerJoints::All))
    return listOfJoints(PeerJoints::Own, joint / kPeerJointLists);
  return list;
}

/// Where the table of bodies is cut, and what the last cut left behind. The same on all ranks.
struct PeerCut {
  int begin[kMostPeers + 1];  ///< first body of each rank, and the number of bodies
  int bodies;                 ///< bodies that were cut; 0: none
  int known, knownBefore;     ///< bodies that have an owner, in this step and in the last one
  int since;                  ///< steps since the cut
  int changed;                ///< 1: some body has another owner than in the last step
  int holdsAll;               ///< 1: all ranks have the state of all pairs and joints
  int interval;               ///< RankOptions::cutInterval
  double maxImbalance;        ///< RankOptions::maxImbalance
};

/// Bodies for which a rank finds the pairs: those between its cuts. All of them if ranks send letters, which
/// cannot add to a counter.
struct PeerHome {
  const PeerCut* cut = nullptr;  ///< null: all bodies
  int rank = 0;
  RUBBLE_HD bool has(int i) const { return !cut || (i >= cut->begin[rank] && i < cut->begin[rank + 1]); }
};

/// Numbers of one rank, which it stores into the tables of all others.
struct PeerSums {
  int bounces;             ///< of its counters
  int broken, brokenNear;  ///< joints that broke: those that it counts, and all near ones
  /// Of the whole step. It may come while another rank still adds up what broke.
  struct Counts {
    int contacts, recycled, failedSolves, boundedSteps;
    int bodies, ghosts, rows, migrated;  ///< RankReport
  } counts;
};

struct PeerRank;

/// What a rank has for its part of a step, beside its tables. Arrays have the capacity of the tables.
struct PeerData {
  int rank = 0, ranks = 1;
  int stride = 0;                ///< capacity for bodies
  const PeerRank* at = nullptr;  ///< [ranks] the tables of all ranks
  PeerCut* cut = nullptr;
  int *owner = nullptr, *ownerBefore = nullptr;           ///< [bodies] rank, or kEveryPeer
  std::uint8_t *moves = nullptr, *movesBefore = nullptr;  ///< [bodies] 1: dynamic, asleep or not
  std::uint8_t* seen = nullptr;  ///< [ranks][bodies] 1: that rank needs the pose; rows of others: own bodies
  unsigned* seenBy = nullptr;    ///< [bodies] of own bodies: bit r: rank r sees it
  /// [levels][bodies] of bodies of others, whose owner stores it: 1 + a body that its rows unite with this
  /// one at a level of aggregates. 0 between exchanges, and if there is none.
  int* sharedRoot = nullptr;
  int* sharedPartner = nullptr;  ///< [pairs] of bodies at home elsewhere: the other body
  int* sliceOwner = nullptr;     ///< [slices]
  std::uint8_t* sees = nullptr;  ///< [aggregates] 1: it moves a body that this rank sees
  /// [aggregates] 1: other ranks have a slice of it or see a body that it moves. Sums of all others stay
  /// here.
  std::uint8_t* mixed = nullptr;
  std::uint8_t* extraRow = nullptr;                   ///< [rows] 1: evaluated for a slice alone
  std::uint8_t* extraJoint[JointTypes::kSize] = {};   ///< [joints] the same
  std::uint8_t* rowAskers = nullptr;                  ///< [rows][ranks] 1: that rank asks for an own row
  std::uint8_t* jointAskers[JointTypes::kSize] = {};  ///< [joints][ranks] the same
  PeerSums* sums = nullptr;                           ///< [ranks]
  PeerBox* box = nullptr;      ///< [ranks] letters to each rank; null: ranks reach one another's memory
  int* list[kPeerLists] = {};  ///< indices, on a device
  int* listed = nullptr;       ///< [lists] how many

  RUBBLE_HD bool isMine(int body) const { return body == rank || body == kEveryPeer; }
  /// Does this rank count an element of that owner?
  RUBBLE_HD bool counts(int body) const { return body == rank || (body == kEveryPeer && rank == 0); }
  RUBBLE_HD std::uint8_t& sightOf(int of, int body) const {
    return seen[static_cast<std::size_t>(of) * static_cast<std::size_t>(stride) +
                static_cast<std::size_t>(body)];
  }
  RUBBLE_HD int& sharedRootOf(int level, int body) const {
    return sharedRoot[static_cast<std::size_t>(level) * static_cast<std::size_t>(stride) +
                      static_cast<std::size_t>(body)];
  }
  RUBBLE_HD std::uint8_t* askersOf(int row) const {
    return rowAskers + static_cast<std::size_t>(row) * static_cast<std::size_t>(ranks);
  }
  template <class F> RUBBLE_HD std::uint8_t* askersOf(int joint) const {
    return jointAskers[typeIndex<F>(JointTypes{})] +
           static_cast<std::size_t>(joint) * static_cast<std::size_t>(ranks);
  }
  RUBBLE_HD PeerHome home() const { return {box || ranks == 1 ? nullptr : cut, rank}; }
  RUBBLE_HD int homeOf(int body) const {
    int r = 0;
    while (r + 1 < ranks && cut->begin[r + 1] <= body) ++r;
    return r;
  }
  RUBBLE_HD bool has(int body) const { return body >= 0 && body < cut->known; }
  /// Is the body solved here, or does a constraint or slice of this rank need its pose?
  RUBBLE_HD bool isSeen(int body) const { return isMine(owner[body]) || sightOf(rank, body) != 0; }
};

/// A rank as others see it.
struct PeerRank {
  SolverData s;
  PeerData p;
};

/// Another rank, into whose tables this one stores. Nothing is read there.
struct PeerTables {
  const SolverData& s;
  const PeerData& p;
  PeerBox* box;  ///< letters to it; null: its memory is in reach

  /// `to`: an element of its tables.
  template <class T> RUBBLE_HD void put(T& to, const T& value) const {
    if (box)
      box->post(&to, value);
    else
      to = value;
  }
};
RUBBLE_HD inline PeerTables peerTables(const PeerData& p, int r) {
  return {p.at[r].s, p.at[r].p, p.box ? p.box + r : nullptr};
}
/// Calls f(tables) for every other rank.
template <class F> RUBBLE_HD void forEachPeer(const PeerData& p, F&& f) {
  for (int r = 0; r < p.ranks; ++r)
    if (r != p.rank) f(peerTables(p, r));
}

/// Calls f(tables) for the ranks whose bits are set.
template <class F> RUBBLE_HD void forEachOf(const PeerData& p, unsigned ranks, F&& f) {
  for (int r = 0; ranks != 0; ranks >>= 1, ++r)
    if (ranks & 1) f(peerTables(p, r));
}

/// The bodies of a constraint.
struct PeerEnds {
  int count;
  int body[4];
};
RUBBLE_HD inline PeerEnds endsOfPair(const Pair& pair) { return {2, {pair.owner, pair.other, -1, -1}}; }
template <class F> RUBBLE_HD PeerEnds endsOfJoint(const SolverData& s, int joint) {
  static_assert(kSides<F> <= 4);
  PeerEnds ends{kSides<F>, {-1, -1, -1, -1}};
  for (int side = 0; side < kSides<F>; ++side) ends.body[side] = bodyOf(s.specsOf<F>()[joint], side);
  return ends;
}

/// The owner of the first dynamic body; if there is none, of the first body.
RUBBLE_HD inline int ownerOf(const PeerData& p, const int* owner, const std::uint8_t* moves,
                             const PeerEnds& ends) {
  int first = kEveryPeer;
  bool found = false;
  for (int k = 0; k < ends.count; ++k) {
    const int body = ends.body[k];
    if (!p.has(body)) continue;
    if (moves[body]) return owner[body];
    if (!found) first = owner[body], found = true;
  }
  return first;
}
RUBBLE_HD inline int ownerOf(const PeerData& p, const PeerEnds& ends) {
  return ownerOf(p, p.owner, p.moves, ends);
}
/// The ranks that evaluate a constraint, a bit each: owners of its dynamic bodies, or, if there are none, its
/// owner.
RUBBLE_HD inline unsigned evaluatorsOf(const PeerData& p, const PeerEnds& ends) {
  const auto bitsOf = [](int owner) { return owner == kEveryPeer ? ~0u : 1u << owner; };
  unsigned ranks = 0;
  for (int k = 0; k < ends.count; ++k)
    if (const int body = ends.body[k]; p.has(body) && p.moves[body]) ranks |= bitsOf(p.owner[body]);
  return ranks != 0 ? ranks : bitsOf(ownerOf(p, ends));
}
RUBBLE_HD inline bool actsHere(const PeerData& p, const PeerEnds& ends) {
  return (evaluatorsOf(p, ends) >> p.rank & 1) != 0;
}
/// Calls f(tables) for the other ranks, which do not evaluate the constraint. Those that do have the same
/// bits.
template <class F> RUBBLE_HD void forEachOnlooker(const PeerData& p, const PeerEnds& ends, F&& f) {
  forEachOf(p, ~evaluatorsOf(p, ends) & (~0u >> (kMostPeers - p.ranks)), f);
}
/// Has a body of it another owner than in the last step?
RUBBLE_HD inline bool hasNewOwner(const PeerData& p, const PeerEnds& ends) {
  for (int k = 0; k < ends.count; ++k)
    if (const int body = ends.body[k];
        p.has(body) && (p.owner[body] != p.ownerBefore[body] || p.moves[body] != p.movesBefore[body]))
      return true;
  return false;
}

RUBBLE_HD inline PeerEnds endsOfManifold(const SolverData& s, int i) {
  return endsOfPair(s.pair[s.activePair[i]]);
}
RUBBLE_HD inline PeerEnds endsOfRow(const SolverData& s, int row) {
  const RowBodies& r = s.rowBodies[row];
  return {2, {r.a, r.b, -1, -1}};
}

/// Predicates of the lists, and the owner of an element. Those with `of` select from another list: of(k) is
/// the element of the new list for element k of the other one.
struct NearPair {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int k) const { return actsHere(p, endsOfPair(s.pair[k])); }
  RUBBLE_HD int ownerOf(const SolverData& s, int k) const {
    return RUBBLE_CORE::ownerOf(p, endsOfPair(s.pair[k]));
  }
};
/// Of near pairs.
struct NearActivePair {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int k) const { return s.isActive[k] != 0; }
  RUBBLE_HD int of(const SolverData& s, int k) const { return s.activePairOffset[k]; }
  RUBBLE_HD int ownerOf(const SolverData& s, int i) const {
    return RUBBLE_CORE::ownerOf(p, endsOfManifold(s, i));
  }
};
/// Of near active pairs.
struct NearRow {
  RUBBLE_HD bool operator()(const SolverData& s, int i) const { return s.hasRows[i] != 0; }
  RUBBLE_HD int of(const SolverData& s, int i) const { return s.rowOffset[i]; }
};
struct CrossRow {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int row) const {
    const auto [a, b, manifold] = s.rowBodies[row];
    return p.moves[a] && p.moves[b] && p.owner[a] != p.owner[b] && !actsHere(p, endsOfRow(s, row));
  }
};
struct ExtraRow {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData&, int row) const { return p.extraRow[row] != 0; }
};
template <class F> struct NearJoint {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const { return actsHere(p, endsOfJoint<F>(s, i)); }
  RUBBLE_HD int ownerOf(const SolverData& s, int i) const {
    return RUBBLE_CORE::ownerOf(p, endsOfJoint<F>(s, i));
  }
};
template <class F> struct ExtraJoint {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData&, int i) const {
    return p.extraJoint[typeIndex<F>(JointTypes{})][i] != 0;
  }
  RUBBLE_HD int ownerOf(const SolverData& s, int i) const { return NearJoint<F>{p}.ownerOf(s, i); }
};
struct OwnBody {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const {
    return p.isMine(p.owner[i]) && isDynamic(s, i);
  }
  RUBBLE_HD int ownerOf(const SolverData&, int i) const { return p.owner[i]; }
};
struct Ghost {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const {
    return p.sightOf(p.rank, i) != 0 && !p.isMine(p.owner[i]) && isDynamic(s, i);
  }
};
/// Of its own bodies.
struct SharedBody {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData&, int i) const {
    return p.seenBy[i] != 0 || p.owner[i] == kEveryPeer;
  }
  RUBBLE_HD int of(const SolverData&, int i) const { return i; }
};
struct OwnSlice {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData&, int i) const { return p.isMine(p.sliceOwner[i]); }
};
struct SeenSlice {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const { return p.sees[s.slice[i].aggregate] != 0; }
};
struct MixedSlice {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const {
    const int aggregate = s.slice[i].aggregate;
    return p.sees[aggregate] != 0 && p.mixed[aggregate] != 0;
  }
};
struct SentSlice {
  PeerData p;
  RUBBLE_HD bool operator()(const SolverData& s, int i) const {
    return p.sliceOwner[i] == p.rank && p.mixed[s.slice[i].aggregate] != 0;
  }
};

}  // namespace rubble::RUBBLE_CORE

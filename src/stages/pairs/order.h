#pragma once
/// The order of bodies in the tables. On request they are sorted along a Morton curve between steps. Bodies
/// that are close in space then lie close in memory and share cache lines (docs/performance.md gives the
/// gain). A body keeps its id and its persistent state, contacts included. The relative order of two bodies
/// depends on these two alone.
#include <algorithm>

#include "stages/joints/joints.h"
#include "stages/pairs/active_pairs.h"
#include "stages/soft/body_corners.h"
#include "state/solver_tables.h"

namespace rubble::RUBBLE_CORE {

/// The lowest 21 bits of a number, each followed by two zeros.
RUBBLE_HD constexpr std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1fffffu;
  v = (v | v << 32) & 0x001f00000000ffffu;
  v = (v | v << 16) & 0x001f0000ff0000ffu;
  v = (v | v << 8) & 0x100f00f00f00f00fu;
  v = (v | v << 4) & 0x10c30c30c30c30c3u;
  return (v | v << 2) & 0x1249249249249249u;
}

/// Has the body a position? Removed bodies and planes do not.
RUBBLE_HD inline bool hasPlace(const SolverData& s, int i) {
  return s.params[i].kind != BodyKind::Removed && s.params[i].shape.kind != ShapeKind::Plane;
}

/// Edge of the cells of the curve over g dt^2 [1]: 4 cm at 1/60 s.
inline constexpr double kCurveCell = 16;

/// Key of a body on the curve. Bodies without a position come last.
RUBBLE_HD inline std::uint64_t placeOnCurve(const SolverData& s, int i) {
  if (!hasPlace(s, i)) return ~std::uint64_t{0};
  constexpr double kHalf = 1 << 20;
  const double size = kCurveCell / s.stepOf(i).perFall;
  const auto cell = [&](double x) {
    return spreadBits(static_cast<std::uint64_t>(clamp(std::floor(x / size) + kHalf, 0.0, 2 * kHalf - 1)));
  };
  const Vec3d& x = s.position[i];
  return cell(x.x) | cell(x.y) << 1 | cell(x.z) << 2;
}

struct FindPlacesOnCurve {
  static constexpr const char* kStage = "order";
  std::uint64_t* key;
  RUBBLE_HD void operator()(const SolverData& s, int i) const { key[i] = placeOnCurve(s, i); }
};

/// The permutation of bodies.
struct NewPlaces {
  int* from;  ///< old place of the body at each new place
  int* to;    ///< new place of the body at each old place
  RUBBLE_HD int of(int body) const { return body < 0 ? body : to[body]; }
};

struct InvertPlaces {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData&, int k) const { places.to[places.from[k]] = k; }
};

template <class T> struct TakeElements {
  static constexpr const char* kStage = "order";
  T* to;
  const T* of;
  const int* from;
  RUBBLE_HD void operator()(const SolverData&, int k) const { to[k] = of[from[k]]; }
};

// Pair data are written to the tables of this step, which then become the old ones of the next. Multipliers
// and sides of a pair persist; its owner is the one that the next step will determine.

/// Grid levels as the next step will find them.
struct FindGridLevels {
  static constexpr const char* kStage = "order";
  RUBBLE_HD void operator()(const SolverData& s, int i) const { ComputeBounds::place(s, i); }
};

RUBBLE_HD inline Pair movedPair(const SolverData& s, const NewPlaces& places, const Pair& old) {
  Pair p = old;
  p.owner = places.of(old.owner), p.other = places.of(old.other);
  if (old.other < 0) return p;
  // planes own no pairs
  const int level = sizeOf(s.bounds[old.owner].level), otherLevel = sizeOf(s.bounds[old.other].level);
  if (otherLevel < 0 || level < otherLevel || (level == otherLevel && p.owner < p.other)) return p;
  p.owner = places.of(old.other), p.other = places.of(old.owner);
  p.ownerIsA = !old.ownerIsA;
  // against a surface, `first` and `second` are the part of the other body and the slot, whoever is the owner
  if (isSurface(s.params[old.owner].shape.kind) || isSurface(s.params[old.other].shape.kind)) return p;
  p.first = static_cast<std::uint32_t>(old.second) & 0x7fffffffu, p.second = static_cast<int>(old.first);
  return p;
}

struct CountMovedPairs {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    atomicCount(&s.pairCount[movedPair(s, places, s.oldPair[i]).owner], 1);
  }
};

/// In no fixed order; `from` receives the old index of each pair.
struct FillMovedPairs {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  int* from;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Pair p = movedPair(s, places, s.oldPair[i]);
    const int to = s.pairOffset[p.owner] + atomicCount(&s.pairCount[p.owner], -1) - 1;
    s.pair[to] = p;
    from[to] = i;
  }
};

/// Sorts by partner and parts; other pair data follow.
struct SortMovedPairs {
  static constexpr const char* kStage = "order";
  int* from;
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    const int begin = s.pairOffset[owner], end = s.pairOffset[owner + 1];
    for (int k = begin + 1; k < end; ++k) {
      const Pair p = s.pair[k];
      const int old = from[k];
      // pairs whose partner was removed compare equal
      const auto comesBefore = [&](int j) {
        return before(p, s.pair[j]) || (!before(s.pair[j], p) && old < from[j]);
      };
      int j = k;
      for (; j > begin && comesBefore(j - 1); --j) s.pair[j] = s.pair[j - 1], from[j] = from[j - 1];
      s.pair[j] = p, from[j] = old;
    }
    for (int k = begin; k < end; ++k) {
      s.pairTest[k] = s.oldPairTest[from[k]];
      s.manifoldBefore[k] = manifoldOfOld(s, from[k]);
      s.isActive[k] = s.manifoldBefore[k] >= 0;
    }
  }
};

struct MoveManifolds {
  static constexpr const char* kStage = "order";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!s.isActive[i]) return;
    const int from = s.manifoldBefore[i], to = s.activePairOffset[i];
    s.manifold[to] = s.oldManifold[from];
    if (s.rolledBefore) s.rolling[to] = s.oldRolling[from];
  }
};

// Contacts of vertices, and of corners with surfaces, follow their owners.

/// New owner of point pairs: vertices and edges keep their index, corners follow their body.
RUBBLE_HD inline int movedOwner(const SolverData& s, const NewPlaces& places, int owner) {
  const int fixed = s.vertices + s.edges;
  return owner < fixed ? owner
                       : fixed + kCornerSlots * places.of(bodyOfOwner(s, owner)) + slotOfOwner(s, owner);
}
struct CountMovedPoints {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    s.pointPairCount[movedOwner(s, places, owner)] = s.oldPointPairOffset[owner + 1] -
                                                     s.oldPointPairOffset[owner];
  }
};
struct MovePoints {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int owner) const {
    const int moved = movedOwner(s, places, owner);
    int to = s.pointPairOffset[moved];
    for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k, ++to) {
      const int other = s.oldPointPair[k].other;
      s.pointPair[to] = {moved, other < kVertexNode ? places.of(other) : other};
      s.pointContact[to] = s.oldPointContact[k];
      s.pointContact[to].body = places.of(s.oldPointContact[k].body);
    }
  }
};

// References to bodies by place.

struct RenumberAttachments {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    s.attachment[i].body = places.of(s.attachment[i].body);
  }
};

struct NumberPlaces {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    s.placeOf[s.idOf[k]] = k;
    if (s.asleep[k] != 0) s.asleep[k] = places.of(s.asleep[k] - 1) + 1;
  }
};

struct RenumberPlanes {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int k) const { s.planeBody[k] = places.of(s.planeBody[k]); }
};

template <class F> struct RenumberJoints {
  static constexpr const char* kStage = "order";
  NewPlaces places;
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    JointSpec<F>& joint = s.specsOf<F>()[i];
    joint.a = places.of(joint.a), joint.b = places.of(joint.b);
    if constexpr (hasFrameBodies<F>())
      joint.frameBodyA = places.of(joint.frameBodyA), joint.frameBodyB = places.of(joint.frameBodyB);
  }
};

/// Does element k of an array belong to the body at place k?
template <class T> bool followsBodies(const ArrayInfo<T>& array) {
  return array.per == Per::Body && array.extra == 0 && isKept(array.life);
}

// Operations that an executor offers between steps, in addition to some of those within a step:
//
//   room<T>(n)             temporary memory until the sort is complete
//   order(keys, order, n)  stable sort: indices by ascending key
//   copy(to, from, n)

/// The bodies in the order of the curve.
template <class E> int* orderOnCurve(E& e) {
  const int bodies = e.view().bodies;
  int* const order = e.template room<int>(bodies);
  auto* const key = e.template room<std::uint64_t>(bodies);
  e.forEach(FindPlacesOnCurve{key}, bodies);
  e.order(key, order, bodies);
  return order;
}

/// Sorts the bodies along the curve. `pairs`: number of old pairs. Constants are those of the next step.
/// Derived arrays and SolverData::ordered must be updated afterwards.
template <class E> void sortBodies(E& e, int pairs) {
  const int bodies = e.view().bodies;
  const NewPlaces places{orderOnCurve(e), e.template room<int>(bodies)};
  e.forEach(InvertPlaces{places}, bodies);

  // all memory first: from here on nothing fails
  int* const from = e.template room<int>(pairs);
  std::size_t most = 0;
  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (followsBodies(array)) most = std::max(most, sizeof(T));
  });
  struct alignas(64) Line {};
  void* const aside = e.template room<Line>(
      static_cast<int>(most * static_cast<std::size_t>(bodies) / sizeof(Line)) + 1);
  e.forEach(FindGridLevels{}, bodies);
  e.clear(&SolverData::pairCount, bodies);
  e.forEach(CountMovedPairs{places}, pairs);
  e.scan(&SolverData::pairCount, &SolverData::pairOffset, bodies);
  e.forEach(FillMovedPairs{places, from}, pairs);
  e.forEach(SortMovedPairs{from}, bodies);
  e.scan(&SolverData::isActive, &SolverData::activePairOffset, pairs);
  e.forEach(MoveManifolds{}, pairs);
  if (e.view().vertices > 0) {
    const int owners = e.view().owners();
    e.forEach(CountMovedPoints{places}, owners);
    e.scan(&SolverData::pointPairCount, &SolverData::pointPairOffset, owners);
    e.forEach(MovePoints{places}, owners);
    e.forEach(RenumberAttachments{places}, e.view().attachments);
  }
  e.aliasRows();
  e.swapManifolds();

  forEachArray([&]<class T>(const ArrayInfo<T>& array) {
    if (!followsBodies(array)) return;
    T *const moved = static_cast<T*>(aside), *const elements = e.view().*array.member;
    e.forEach(TakeElements<T>{moved, elements, places.from}, bodies);
    e.copy(elements, moved, bodies);
  });
  e.forEach(NumberPlaces{places}, bodies);
  e.forEach(RenumberPlanes{places}, e.view().planes);
  forEachType(JointTypes{}, [&]<class F>() {
    e.forEach(RenumberJoints<F>{places}, e.view().joints[typeIndex<F>(JointTypes{})]);
  });
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// State arrays as rows of numbers, on host and device (rubble/arrays.h).
#include <type_traits>

#include <rubble/arrays.h>

#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// Calls f(member of SolverData) for the array.
template <class F> auto withStateArray(StateArray which, F&& f) {
  switch (which) {
    case StateArray::Position:
      break;
    case StateArray::Orientation:
      return f(&SolverData::orientation);
    case StateArray::Velocity:
      return f(&SolverData::velocity);
    case StateArray::AngularVelocity:
      return f(&SolverData::angularVelocity);
    case StateArray::Force:
      return f(&SolverData::force);
    case StateArray::Torque:
      return f(&SolverData::torque);
  }
  return f(&SolverData::position);
}

/// An array of 3 or 4 numbers per element as a view of host memory.
template <class T> ArrayView rowsOf(const T* data, int rows) {
  using Number = std::conditional_t<std::is_same_v<T, Vec3d>, double, Real>;
  static_assert(sizeof(T) % sizeof(Number) == 0);
  return packedArray(reinterpret_cast<const Number*>(data), rows, sizeof(T) / sizeof(Number));
}

/// An array of vertices, where `s` has them.
inline ArrayView rowsOf(VertexArray which, const SolverData& s) {
  if (which == VertexArray::Position) return rowsOf(firstOf(s.vertexPosition, s.vertices).data(), s.vertices);
  return rowsOf(firstOf(s.vertexVelocity, s.vertices).data(), s.vertices);
}

/// Velocity change of an impulse. It is added in double precision, so that the result equals that of a read,
/// an addition and a write through the API.
RUBBLE_HD inline void changeVelocity(const SolverData& s, int slot, const Vec3d& change) {
  s.velocity[slot] = s.previousVelocity[slot] = Vec3(Vec3d(s.velocity[slot]) + change);
  wakeBody(s, slot);
}

/// Writes row k of the values to a row of an array, or adds it.
struct ScatterRows {
  StateArray which;
  const char *rows, *values;
  std::int64_t rowStride, valueStride, numberStride;  ///< [bytes]
  bool isDouble;

  ScatterRows(StateArray array, const ArrayView& rowView, const ArrayView& valueView)
      : which(array),
        rows(static_cast<const char*>(rowView.data)),
        values(static_cast<const char*>(valueView.data)),
        rowStride(rowView.strides[0]),
        valueStride(valueView.strides[0]),
        numberStride(valueView.strides[1]),
        isDouble(valueView.typestr[2] == '8') {}

  RUBBLE_HD double number(int k, int column) const {
    const char* const at = values + k * valueStride + column * numberStride;
    return isDouble ? *reinterpret_cast<const double*>(at)
                    : static_cast<double>(*reinterpret_cast<const float*>(at));
  }

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int id = *reinterpret_cast<const int*>(rows + k * rowStride);
    if (id < 0 || id >= s.bodies) return;
    const int slot = s.placeOf[id];
    if (s.params[slot].kind == BodyKind::Removed) return;
    const Vec3d v{number(k, 0), number(k, 1), number(k, 2)};
    switch (which) {
      case StateArray::Position:
        s.position[slot] = v;
        break;
      case StateArray::Orientation:
        s.orientation[slot] = normalize(Quat(QuatT<double>{v.x, v.y, v.z, number(k, 3)}));
        break;
      case StateArray::Velocity:
        s.velocity[slot] = s.previousVelocity[slot] = Vec3(v);
        break;
      case StateArray::AngularVelocity:
        s.angularVelocity[slot] = Vec3(v);
        break;
      case StateArray::Force:
        s.force[slot] += Vec3(v);
        break;
      case StateArray::Torque:
        s.torque[slot] += Vec3(v);
        break;
    }
    if (which != StateArray::Force && which != StateArray::Torque) wakeBody(s, slot);
  }
};

/// Kinds of tables whose sizes only steps know, by the names in reports and World::reserve().
struct CountedKind {
  const char* name;
  Per per;
};
inline constexpr CountedKind kCountedKinds[] = {{"pairs", Per::Pair},
                                                {"activePairs", Per::ActivePair},
                                                {"manifolds", Per::Manifold},
                                                {"rollers", Per::Rolling},
                                                {"bounceRows", Per::Bounce},
                                                {"incidences", Per::Incidence},
                                                {"colors", Per::Color},
                                                {"aggregates", Per::Aggregate},
                                                {"slices", Per::Slice},
                                                {"boundary", Per::Boundary},
                                                {"pointPairs", Per::PointPair},
                                                {"pointIncidences", Per::PointIncidence},
                                                {"nearFeatures", Per::NearFeature},
                                                {"freeIslands", Per::FreeIsland},
                                                {"columnNodes", Per::ColumnNode},
                                                {"pathCells", Per::PathCell}};
inline const char* kindName(Per per) {
  for (const CountedKind& kind : kCountedKinds)
    if (kind.per == per) return kind.name;
  return "";
}
/// Reserves table memory for a kind by name. Returns false if the name is unknown.
template <class SomeTables> bool reserveKind(SomeTables& tables, const std::string& name, int count) {
  for (const CountedKind& kind : kCountedKinds)
    if (name == kind.name) {
      tables.reserve(kind.per, count);
      return true;
    }
  return false;
}

}  // namespace rubble::RUBBLE_CORE

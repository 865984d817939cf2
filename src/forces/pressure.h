#pragma once
/// Pressure on a triangle of a closed surface.
///
///   E = -p V,  V = 1/6 sum over triangles x_0.(x_1 x x_2): enclosed volume, triangles counter-clockwise seen
///              from outside
///   dV/dx_i = 1/6 sum over the triangles at i of (x_1 - x_0) x (x_2 - x_0): a third of each area vector
///   f_i = p/6 (x_1 - x_0) x (x_2 - x_0) for each of its triangles,  H_i = 0
///
/// V is linear in each vertex, so H_i = 0 is the exact second derivative. The symmetric form of the gradient
/// makes each triangle feel the pressure on its own area only. Single terms of V depend on the origin; their
/// sum does not.
///
/// Pressure is a load: unlike those of other elements, the forces of one triangle do not add up to zero.
#include <array>

#include "math/block3.h"
#include "solver/constants.h"

namespace rubble {

/// Cooked triangle under pressure. Vertices are those of its object.
struct PressureModel {
  std::array<int, 3> v;
  double pressure;  ///< [Pa]
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

struct Pressure {
  static constexpr const char* kName = "pressure";
  static constexpr int kCorners = 3;
  static constexpr bool kHasDual = false;
  static constexpr bool kIsLoad = true;

  int v[kCorners];
  int alive;
  Real pressure;  ///< p, inside relative to outside [Pa]

  using Model = PressureModel;
  void set(const Model& m) { pressure = Real(m.pressure); }

  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&)[kCorners]) {}
  /// Its term of -p V, which depends on the origin. [J]
  RUBBLE_HD Real energy(const StepConstants&, const Vec3 (&x)[kCorners]) const {
    return -pressure / 6 * dot(x[0], cross(x[1], x[2]));
  }
  RUBBLE_HD void accumulate(const StepConstants&, const Vec3 (&x)[kCorners], int, Block3& block) const {
    block.f += (pressure / 6) * cross(x[1] - x[0], x[2] - x[0]);
  }
};

}  // namespace rubble::RUBBLE_CORE

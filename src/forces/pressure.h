#pragma once
/// Pressure on a triangle of a closed surface.
///
///   E = -p V,  V = 1/6 sum over triangles x_0.(x_1 x x_2): the volume inside of the surface,
///              counter-clockwise seen from outside
///   dV/dx_i = 1/6 sum over the triangles at i of (x_1 - x_0) x (x_2 - x_0): a third of the area vector of
///   each
///   f_i = p/6 (x_1 - x_0) x (x_2 - x_0) for each of its triangles,  H_i = 0
///
/// V is linear in one vertex, so that H_i = 0 is its complete second derivative. The gradient of the sum is
/// written in its symmetric form: each triangle feels the pressure on its own area and no other (single terms
/// of V depend on where the origin lies, their sum does not).
///
/// It is a load: the forces of one triangle do not add up to zero, as those of other elements do.
#include "math/block3.h"
#include "solver/constants.h"

namespace rubble::RUBBLE_CORE {

struct Pressure {
  static constexpr const char* kName = "pressure";
  static constexpr int kCorners = 3;
  static constexpr bool kHasDual = false;
  static constexpr bool kIsLoad = true;

  int v[kCorners];
  int alive;
  Real pressure;  ///< p, inside over outside [Pa]

  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&)[kCorners]) {}
  /// Its term of -p V, about the origin. [J]
  RUBBLE_HD Real energy(const StepConstants&, const Vec3 (&x)[kCorners]) const {
    return -pressure / 6 * dot(x[0], cross(x[1], x[2]));
  }
  RUBBLE_HD void accumulate(const StepConstants&, const Vec3 (&x)[kCorners], int, Block3& block) const {
    block.f += (pressure / 6) * cross(x[1] - x[0], x[2] - x[0]);
  }
};

}  // namespace rubble::RUBBLE_CORE

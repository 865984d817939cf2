#pragma once
/// Spring between two vertices.
///
///   C = |x_0 - x_1| - L_0              [m], F [N]
///   J_0 = u^T = -J_1,  u = (x_0 - x_1) / l
///   d2C/dx2 = (1 - u u^T) / l          used for F > 0 (tension) only; makes H indefinite for F < 0
///
/// A finite row (finite_row.h) with a damper on dC/dt. It breaks if its force at the end of a step exceeds
/// the threshold.
#include <array>

#include "forces/finite_row.h"
#include "math/block3.h"

namespace rubble {

/// Cooked spring, in double precision. Vertices are those of its object.
struct SpringModel {
  std::array<int, 2> v;
  double stiffness, damping, restLength, bound, mass;
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

struct Spring {
  static constexpr const char* kName = "spring";
  static constexpr int kCorners = 2;
  static constexpr bool kHasDual = true;

  int v[kCorners];
  int alive;
  Real stiffness;   ///< K [N/m]
  Real damping;     ///< [N s/m]
  Real restLength;  ///< [m]
  Real bound;       ///< break threshold [N]
  Real mass;        ///< mass of the lighter vertex [kg]
  Real lambda;      ///< [N]
  Real k;           ///< [N/m]
  DampedRow row;    ///< row of this step
  Real c0;          ///< [m]

  using Model = SpringModel;
  void set(const Model& m) {
    stiffness = Real(m.stiffness), damping = Real(m.damping), restLength = Real(m.restLength);
    bound = thresholdOf(m.bound), mass = Real(m.mass);
  }

  RUBBLE_HD Real elongation(const Vec3 (&x)[kCorners]) const { return length(x[0] - x[1]) - restLength; }
  RUBBLE_HD Real unit(const StepConstants& c) const { return mass * c.inverseDt * c.inverseDt; }

  RUBBLE_HD void begin(const StepConstants& c, const Vec3 (&x)[kCorners]) {
    const Real error = elongation(x);
    row = dampedRow(stiffness, damping * c.inverseDt, error);
    const FiniteStart start = beginFiniteRow(c, row.stiffness, unit(c), Real(1), error - row.shift, k,
                                             lambda);
    k = start.k, lambda = start.lambda, c0 = start.c0;
  }
  RUBBLE_HD Real error(const Vec3 (&x)[kCorners]) const { return elongation(x) - row.shift - c0; }
  RUBBLE_HD FiniteForce evaluate(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    return finiteForce(c.compliantRows, row.stiffness, k, error(x), lambda);
  }
  /// Force at the converged multiplier, for direct solvers of all vertices of a spring
  /// (stages/soft/strands.h).
  RUBBLE_HD FiniteForce converged(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    return c.compliantRows ? FiniteForce{row.stiffness * error(x), row.stiffness} : evaluate(c, x);
  }
  /// Energy of the row in the present iteration [J].
  RUBBLE_HD Real energy(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    const Real e = error(x), s = c.compliantRows ? row.stiffness / (row.stiffness + k) : Real(1);
    return s * (k * e * e / 2 + lambda * e);
  }
  RUBBLE_HD void accumulate(const StepConstants& c, const Vec3 (&x)[kCorners], int corner,
                            Block3& block) const {
    accumulate(x, corner, evaluate(c, x), block);
  }
  /// Adds the row with the given force.
  RUBBLE_HD void accumulate(const Vec3 (&x)[kCorners], int corner, const FiniteForce& f,
                            Block3& block) const {
    const Vec3 d = corner == 0 ? x[0] - x[1] : x[1] - x[0];
    const Real l2 = dot(d, d);
    // coincident ends have no direction; other forces separate them
    if (!(l2 > Real(1e-12) * restLength * restLength)) return;
    const Real l = std::sqrt(l2);
    const Vec3 u = d / l;
    block.f -= f.force * u;
    const Real across = max(f.force, Real(0)) / l;
    block.h += outer(u, f.hessian - across);
    block.addDiagonal(across);
  }
  RUBBLE_HD void updateDual(const StepConstants& c, const Vec3 (&x)[kCorners]) {
    const FiniteForce f = evaluate(c, x);
    if (c.compliantRows) lambda = f.force;
    k = grownFiniteRow(c, row.stiffness, unit(c), Real(1), error(x), k, f.force, restLength);
  }
  /// Does it break in this step?
  RUBBLE_HD bool finish(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    return std::fabs(c.compliantRows ? lambda : evaluate(c, x).force) >= bound;
  }
};

}  // namespace rubble::RUBBLE_CORE

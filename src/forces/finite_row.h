#pragma once
/// Rows of finite stiffness K between vertices: most of the stiffness of cloth and springs.
///
///   compliant   F = s (k (C - c0) + lambda), s = K / (K + k), lambda <- F: F = K C at the fixed point,
///               for any k           (engine)
///   ramp        F = k C, k <- min(K, k + beta |C|)
///               (preset paper, [P 16])
///
/// Block descent propagates a change by one vertex per sweep, more slowly the stiffer the rows are that enter
/// the Hessian with K. Therefore k starts near the inertia of the vertices and follows the load. A row that
/// is much stiffer is practically hard, and its inherited error C - lambda/K must not become velocity. Hence
/// c0 = alpha (C
/// - lambda/K) at x^t, and the multiplier decays as that of a hard row. This is the rule of hard rows for K
/// -> infinity, and c0 vanishes where lambda has converged. Authored stretch is not an inherited error: a new
/// row starts with lambda = K C.
#include "solver/warmstart.h"

namespace rubble::RUBBLE_CORE {

/// Force multiplier of a row and its stiffness in the Hessian.
struct FiniteForce {
  Real force, hessian;
};
RUBBLE_HD inline FiniteForce finiteForce(bool compliant, Real stiffness, Real k, Real error, Real lambda) {
  if (!compliant) return {k * error, k};
  const Real s = stiffness / (stiffness + k);
  return {s * (k * error + lambda), s * k};
}

/// State of a row at the start of a step.
struct FiniteStart {
  Real k, lambda, c0;
};
/// `unit`: m / (dt^2 |J|^2) of the row; `perForce`: |J|, from multiplier to force; `error`: C(x^t); `k`,
/// `lambda`: of the last step, k = 0 before the first.
RUBBLE_HD inline FiniteStart beginFiniteRow(const StepConstants& c, Real stiffness, Real unit, Real perForce,
                                            Real error, Real k, Real lambda) {
  const Real start = c.startStiffness * unit;
  if (!c.compliantRows) return {min(stiffness, max(k * c.gamma * c.stiffnessRescale, start)), 0, 0};
  const bool isNew = !(k > Real(0));
  const Real c0 = isNew ? Real(0) : c.alpha * (error - lambda / stiffness);
  lambda = isNew ? stiffness * error : c.alpha * c.gamma * lambda;
  return {max(start, std::fabs(lambda) / (perForce * c.loadAcceleration) * c.inverseDt * c.inverseDt), lambda,
          c0};
}

/// k after an iteration. `length`: the elongation at C = 1 [m].
RUBBLE_HD inline Real grownFiniteRow(const StepConstants& c, Real stiffness, Real unit, Real perForce,
                                     Real error, Real k, Real lambda, Real length) {
  if (c.compliantRows)
    return max(c.startStiffness * unit,
               std::fabs(lambda) / (perForce * c.loadAcceleration) * c.inverseDt * c.inverseDt);
  const Real beta = c.literalBeta ? c.jointRampRate : c.jointRampRate * unit / length;
  return min(stiffness, k + beta * std::fabs(error));
}

/// A row with a damper of coefficient d: K_tot = K + D with D = d/dt, and its error is C - shift.
struct DampedRow {
  Real stiffness, shift;
};
RUBBLE_HD inline DampedRow dampedRow(Real stiffness, Real damper, Real errorAtStart) {
  const Real total = stiffness + damper;
  return {total, damper > Real(0) ? damper / total * errorAtStart : Real(0)};
}

}  // namespace rubble::RUBBLE_CORE

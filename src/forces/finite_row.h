#pragma once
/// Rows of finite stiffness K between vertices, which carry most of the stiffness of cloth and springs.
///
///   compliant   F = s (k (C - c0) + lambda), s = K / (K + k), lambda <- F: F = K C at the fixed point,
///               whatever k is       (engine)
///   ramp        F = k C, k <- min(K, k + beta |C|)
///               (preset paper, [P 16])
///
/// Block descent moves news one vertex a sweep, and the slower the stiffer the rows are that add their K; k
/// starts near the inertia of the vertices instead and follows the load. A row much stiffer than that is as
/// good as hard, and an error C - lambda/K that it has inherited must not become velocity: c0 = alpha (C -
/// lambda/K) at x^t, which is the rule of hard rows for K -> infinity and vanishes where lambda has
/// converged; the multiplier loses what theirs do. What an author has stretched is no such error: a row that
/// is new starts with lambda = K C.
#include "solver/warmstart.h"

namespace rubble::RUBBLE_CORE {

/// Force multiplier of a row and the stiffness that it puts into the Hessian.
struct FiniteForce {
  Real force, hessian;
};
RUBBLE_HD inline FiniteForce finiteForce(bool compliant, Real stiffness, Real k, Real error, Real lambda) {
  if (!compliant) return {k * error, k};
  const Real s = stiffness / (stiffness + k);
  return {s * (k * error + lambda), s * k};
}

/// What a row starts a step with.
struct FiniteStart {
  Real k, lambda, c0;
};
/// `unit`: m / (dt^2 |J|^2) of the row; `perForce`: |J|, from multiplier to force; `error`: C(x^t); `k`,
/// `lambda` of the step before, k = 0 before the first.
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

/// k after an iteration. `length`: the elongation that C = 1 stands for [m].
RUBBLE_HD inline Real grownFiniteRow(const StepConstants& c, Real stiffness, Real unit, Real perForce,
                                     Real error, Real k, Real lambda, Real length) {
  if (c.compliantRows)
    return max(c.startStiffness * unit,
               std::fabs(lambda) / (perForce * c.loadAcceleration) * c.inverseDt * c.inverseDt);
  const Real beta = c.literalBeta ? c.jointRampRate : c.jointRampRate * unit / length;
  return min(stiffness, k + beta * std::fabs(error));
}

/// A row with a damper: K_tot = K + D with D = d/dt for a damper of coefficient d, and the error that it
/// sees, C - shift.
struct DampedRow {
  Real stiffness, shift;
};
RUBBLE_HD inline DampedRow dampedRow(Real stiffness, Real damper, Real errorAtStart) {
  const Real total = stiffness + damper;
  return {total, damper > Real(0) ? damper / total * errorAtStart : Real(0)};
}

}  // namespace rubble::RUBBLE_CORE

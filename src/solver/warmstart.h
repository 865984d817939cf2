#pragma once
/// What a row takes over from the step before, and how much of its error.
#include "solver/stiffness.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S12} A new row: lambda = 0, k = k_start.
struct Warm {
  Real lambda, k;
};
RUBBLE_HD inline Warm coldStart(Real start) { return {Real(0), start}; }

/// \eq{S17} lambda <- alpha gamma lambda. A finite row has no inherited error to correct: gamma lambda.
RUBBLE_HD inline Real warmMultiplier(const StepConstants& c, Real lambda, bool hard) {
  return (hard ? c.alpha * c.gamma : c.gamma) * lambda;
}

/// Second half of [S 17]: k <- max(gamma k, k_start), within the ceiling of its rule; rescaled where the time
/// step has changed.
RUBBLE_HD inline Real warmStiffness(const StepConstants& c, const StiffnessRule& rule, Real k, Real lambda) {
  if (rule.policy == StiffnessPolicy::FollowLoad) return grownStiffness<Real>(rule, k, Real(0), lambda);
  return clamp(c.gamma * k * c.stiffnessRescale, rule.start, rule.limit);
}

/// k of a row that is new and begins with a load.
RUBBLE_HD inline Real newStiffness(const StiffnessRule& rule, Real lambda) {
  return rule.policy == StiffnessPolicy::FollowLoad ? grownStiffness<Real>(rule, rule.start, Real(0), lambda)
                                                    : rule.start;
}

/// What of an authored error, a difference of numbers of that size, is more than round-off: the load of a
/// stiff row would be that of round-off else.
RUBBLE_HD inline Real beyondRoundOff(Real error, Real size) {
  constexpr Real kRoundOff = 8 * std::numeric_limits<Real>::epsilon();
  return error - clamp(error, -kRoundOff * size, kRoundOff * size);
}

/// C(x^t) of an equality after regularisation, C*(x) - alpha C*(x^t): only the part 1 - alpha of an inherited
/// error is corrected in this step.
RUBBLE_HD inline Real inheritedError(const StepConstants& c, Real error) {
  return (Real(1) - c.alpha) * error;
}
/// The same for a row that acts on C > 0 only: a gap is not an error and stays whole.
RUBBLE_HD inline Real inheritedViolation(const StepConstants& c, Real error) {
  return error > Real(0) ? inheritedError(c, error) : error;
}

}  // namespace rubble::RUBBLE_CORE

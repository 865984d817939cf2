#pragma once
/// Warm start: multipliers and stiffness carried over from the last step, and regularization of inherited
/// errors.
#include "solver/stiffness.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S12} A new row: lambda = 0, k = k_start.
struct Warm {
  Real lambda, k;
};
RUBBLE_HD inline Warm coldStart(Real start) { return {Real(0), start}; }

/// \eq{S17} lambda <- alpha gamma lambda. A finite row has no inherited error to correct: gamma lambda.
template <class L> RUBBLE_HD RUBBLE_NEAR L warmMultiplier(const StepConstants& c, L lambda, bool hard) {
  return (hard ? c.alpha * c.gamma : c.gamma) * lambda;
}

/// Second half of [S 17]: k <- max(gamma k, k_start), within the ceiling of its rule. Rescaled if the time
/// step changed.
template <class L>
RUBBLE_HD RUBBLE_NEAR L warmStiffness(const StepConstants& c, const StiffnessRuleT<L>& rule, L k, L lambda) {
  if (rule.policy == StiffnessPolicy::FollowLoad) return grownBy(rule, k, LaneAccess<L>::splat(0), lambda);
  const L kept = c.gamma * k * c.stiffnessRescale;
  return select(kept < rule.start, rule.start, minOf(kept, rule.limit));
}

/// k of a new row that starts with a load.
RUBBLE_HD inline Real newStiffness(const StiffnessRule& rule, Real lambda) {
  return rule.policy == StiffnessPolicy::FollowLoad ? grownStiffness<Real>(rule, rule.start, Real(0), lambda)
                                                    : rule.start;
}

/// The part of an error above round-off; `size` is the magnitude of the numbers that it is a difference of.
/// Otherwise a stiff row would start with a load of round-off.
RUBBLE_HD inline Real beyondRoundOff(Real error, Real size) {
  constexpr Real kRoundOff = 8 * std::numeric_limits<Real>::epsilon();
  return error - clamp(error, -kRoundOff * size, kRoundOff * size);
}

/// Regularized error of an equality at x^t, C* - alpha C*: only the share 1 - alpha of an inherited error is
/// corrected in this step.
RUBBLE_HD inline Real inheritedError(const StepConstants& c, Real error) {
  return (Real(1) - c.alpha) * error;
}
/// The same for an inequality that acts on C > 0: a gap is not an error and is not scaled.
template <class L> RUBBLE_HD RUBBLE_NEAR L inheritedViolation(const StepConstants& c, L error) {
  return select(error > LaneAccess<L>::splat(0), (Real(1) - c.alpha) * error, error);
}

}  // namespace rubble::RUBBLE_CORE

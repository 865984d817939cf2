#pragma once
/// The penalty stiffness k of a row: start value and growth. It affects how fast multipliers converge, not
/// their limit.
#include <limits>

#include "math/lanes.h"
#include "solver/constants.h"

namespace rubble::RUBBLE_CORE {

/// Floor of k: K m_row / dt^2. m_row is the mass of the lighter dynamic body of the row; for angular rows its
/// moment of inertia about the row.
RUBBLE_HD inline Real startStiffness(const StepConstants& c, Real rowInertia) {
  return c.startStiffness * rowInertia * c.inverseDt * c.inverseDt;
}

/// Growth rule of k for one row. The unit of stiffness is m_row / dt^2.
template <class L> struct StiffnessRuleT {
  StiffnessPolicy policy;
  L start;    ///< k_start
  L limit;    ///< k_max
  L beta;     ///< Ramp: growth per unit of error
  L perLoad;  ///< FollowLoad: 1 / (a dt^2); the load is the weight of this mass at acceleration a, over dt^2
};
using StiffnessRule = StiffnessRuleT<Real>;

/// `rampRate`: B. `length`: characteristic length of a linear row [m], 1 for an angular row.
RUBBLE_HD inline StiffnessRule stiffnessRule(const StepConstants& c, StiffnessPolicy policy, Real rampRate,
                                             Real start, Real length) {
  const Real unit = start / c.startStiffness;
  return {policy, start, c.maxStiffness * unit, c.literalBeta ? rampRate : rampRate * unit / length,
          c.inverseDt * c.inverseDt / c.loadAcceleration};
}
RUBBLE_HD inline StiffnessRule contactRule(const StepConstants& c, Real start, Real length) {
  return stiffnessRule(c, c.contactPolicy, c.contactRampRate, start, length);
}
RUBBLE_HD inline StiffnessRule jointRule(const StepConstants& c, Real start, Real length) {
  return stiffnessRule(c, c.jointPolicy, c.jointRampRate, start, length);
}

/// Largest k of a normal row whose depth is C_n0 at x^t. Deeply interpenetrating bodies may have no way out,
/// for example a cube created between two jointed bodies. Their error persists at any force; a stiffness that
/// follows the load would double the load in every step until the bodies slip free. At constant k the load is
/// bounded, because the decay of the warm start balances what the error adds.
template <class L>
RUBBLE_HD RUBBLE_NEAR L contactCeiling(const StepConstants& c, PerContact<L> start, PerContact<L> length,
                                       L depth) {
  using A = LaneAccess<L>;
  const auto deep = c.contactPolicy == StiffnessPolicy::FollowLoad
                        ? kDeepShare * length
                        : LaneAccess<PerContact<L>>::splat(std::numeric_limits<Real>::max());
  return select(depth > A::splat(deep), A::splat(kDeepStiffness * start),
                A::splat(c.maxStiffness * start / c.startStiffness));
}

/// Growth rule of the tangential rows of a contact: a lower start, then k follows their own load.
template <class L>
RUBBLE_HD RUBBLE_NEAR StiffnessRuleT<L> tangentRule(const StepConstants& c, StiffnessRuleT<L> normal) {
  normal.start *= c.tangentStiffness;
  return normal;
}

/// \eq{S14} k + beta |C|, up to the ceiling; or, for FollowLoad, max(k_start, |lambda| / (a dt^2)).
template <class L>
RUBBLE_HD RUBBLE_NEAR L grownBy(const StiffnessRuleT<L>& rule, L k, L error, L multiplier) {
  if (rule.policy == StiffnessPolicy::FollowLoad)
    return minOf(maxOf(rule.start, absOf(multiplier) * rule.perLoad), rule.limit);
  return minOf(k + rule.beta * absOf(error), rule.limit);
}
/// The rule of the points of contacts that have one rule each.
template <class L>
RUBBLE_HD RUBBLE_NEAR StiffnessRuleT<L> ruleOfPoints(const StiffnessRuleT<PerContact<L>>& rule) {
  using A = LaneAccess<L>;
  return {rule.policy, A::splat(rule.start), A::splat(rule.limit), A::splat(rule.beta),
          A::splat(rule.perLoad)};
}
/// The same for the points of contacts that have one rule each.
template <class L>
RUBBLE_HD RUBBLE_NEAR L grownStiffness(const StiffnessRuleT<PerContact<L>>& rule, L k, L error,
                                       L multiplier) {
  return grownBy(ruleOfPoints<L>(rule), k, error, multiplier);
}

}  // namespace rubble::RUBBLE_CORE

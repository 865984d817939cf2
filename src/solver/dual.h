#pragma once
/// The dual update: after each sweep the multiplier of a row becomes its force, and k grows.
#include "solver/row.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S13} lambda <- F, the bounded force k C + lambda; k follows its rule while F is below its bound.
/// `keeps`: mask of the lanes that keep their multiplier.
template <int N, class L, class Mask>
RUBBLE_HD RUBBLE_NEAR void updateRows(GroupLaw<L>& g, const StiffnessRuleT<L>& rule, Mask keeps,
                                      const L* error, L* lambda, int count) {
  const L zero = LaneAccess<L>::splat(0);
  L force[N], hessian;
  const auto over = cutForce<N>(g, error, lambda, force, count, hessian);
  L error2 = zero, force2 = zero;
  for (int i = 0; i < count; ++i) {
    error2 += error[i] * error[i];
    force2 += force[i] * force[i];
    lambda[i] = select(keeps, force[i], zero);
  }
  // no growth for a compliant group: its multiplier converges to K_mat C at any k
  const L grown = grownBy(rule, g.k, sqrtOf(error2), sqrtOf(force2));
  g.k = select(over, g.k, select(g.compliance == zero, grown, g.k));
}
template <int N> RUBBLE_HD void updateGroup(GroupState& g, const Real* error, Real* lambda, int count) {
  GroupLaw<Real> law{g.k, g.compliance, g.bound};
  updateRows<N>(law, g.rule, g.keepsMultiplier != 0, error, lambda, count);
  g.k = law.k;
}

}  // namespace rubble::RUBBLE_CORE

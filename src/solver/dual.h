#pragma once
/// The dual update: after each sweep a multiplier takes over the force of its row, and k grows where that is still moving.
#include "solver/row.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S13} lambda <- F, the bounded force k C + lambda; k moves by its rule while the force is inside its bound.
template <int N>
RUBBLE_HD void updateGroup(GroupState& g, const Real* error, Real* lambda, int count) {
  Real force[N], hessian;
  const bool inside = groupForce<N>(g, error, lambda, force, count, hessian);
  Real error2 = 0, force2 = 0;
  for (int i = 0; i < count; ++i) {
    error2 += error[i] * error[i];
    force2 += force[i] * force[i];
    lambda[i] = g.keepsMultiplier ? force[i] : Real(0);
  }
  // a compliant group needs no growth: its multiplier converges to K_mat C at any k
  if (inside && g.compliance == Real(0)) g.k = grownStiffness<Real>(g.rule, g.k, std::sqrt(error2), std::sqrt(force2));
}

}  // namespace rubble::RUBBLE_CORE

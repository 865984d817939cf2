#pragma once
/// Rows: scalar constraints C(x) with a Jacobian. A group of rows shares one stiffness and one bound on the size of its force.
#include "solver/block.h"
#include "solver/warmstart.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S10} Energy of a row of finite stiffness: k C^2 / 2. [J]
RUBBLE_HD inline Real quadraticEnergy(Real k, Real error) { return k * error * error / 2; }
/// \eq{S11} Energy of a hard row: k C^2 / 2 + lambda C; its derivative by C is the force. [J]
RUBBLE_HD inline Real augmentedEnergy(Real k, Real lambda, Real error) { return quadraticEnergy(k, error) + lambda * error; }

enum class RowUnit { Linear, Angular };

/// Rows [begin, begin + count) of a force.
struct RowGroup {
  int begin, count;
  RowUnit unit;
};

/// What a group of rows keeps: multipliers live beside it, one a row.
struct GroupState {
  Real k;           ///< [N/m] or [N m/rad]
  Real compliance;  ///< 1 / K_mat; 0 for a hard group
  Real bound;       ///< largest |force| [N] or [N m]
  StiffnessRule rule;
  int keepsMultiplier;  ///< 0 (no bool: padding would be left to chance where states are compared): a soft group whose k ramps up to K_mat instead (the paper's rule for finite stiffness)
};

/// Force multiplier and Hessian stiffness of a group at error C: s (k C + lambda) and s k, s = 1 / (1 + k compliance), the force cut to the
/// bound. Hard rows have s = 1. Returns whether the force is inside its bound.
/// A cut force has the secant stiffness |bound - lambda| / |C| along itself, and at least half of what stops it: with lambda at the bound the
/// secant alone is zero, the bodies overshoot, and the force turns round at its full size.
template <int N>
RUBBLE_HD RUBBLE_NEAR bool groupForce(const GroupState& g, const Real* error, const Real* lambda, Real (&force)[N], int count, Real& hessian) {
  const Real s = Real(1) / (Real(1) + g.k * g.compliance);
  Real size2 = 0, error2 = 0, lambdaAlong = 0;
  for (int i = 0; i < count; ++i) {
    force[i] = s * (g.k * error[i] + lambda[i]);
    size2 += force[i] * force[i];
    error2 += error[i] * error[i];
    lambdaAlong += force[i] * lambda[i];
  }
  hessian = s * g.k;
  if (!(size2 > g.bound * g.bound)) return true;
  const Real size = std::sqrt(size2);
  const Real cut = g.bound / size;
  for (int i = 0; i < count; ++i) force[i] *= cut;
  if (error2 > Real(0)) hessian = min(hessian, max(absOf(g.bound - lambdaAlong / size), g.bound / 2) / std::sqrt(error2));
  return false;
}

/// \eq{S15} f -= F J^T, H += k J^T J for one row.
RUBBLE_HD RUBBLE_NEAR void stampRow(Block6& block, const Vec6& j, Real force, Real k) {
  block.fl -= force * j.lin;
  block.fa -= force * j.ang;
  block.ll += outer(j.lin, k);
  block.aa += outer(j.ang, k);
  block.al0 += (k * j.lin.x) * j.ang;
  block.al1 += (k * j.lin.y) * j.ang;
  block.al2 += (k * j.lin.z) * j.ang;
}

/// \eq{S16} The second-derivative term G = sum F d2C/dx2 of a force, replaced by the diagonal of its column norms: H += diag(g).
RUBBLE_HD RUBBLE_NEAR void stampCurvature(Block6& block, const Vec6& g) {
  block.ll.xx += g.lin.x, block.ll.yy += g.lin.y, block.ll.zz += g.lin.z;
  block.aa.xx += g.ang.x, block.aa.yy += g.ang.y, block.aa.zz += g.ang.z;
}

/// Second derivative of a . r(w) for a vector r = b that turns with the body: S(a, b) = (a b^T + b a^T) / 2 - (a . b) 1. Norms of its columns.
RUBBLE_HD RUBBLE_NEAR Vec3 turningColumnNorms(const Vec3& a, const Vec3& b) {
  const Real aa = dot(a, a), bb = dot(b, b), ab = dot(a, b);
  const auto norm = [&](Real ac, Real bc) {
    return std::sqrt(max((aa * bc * bc + bb * ac * ac) / 4 - Real(1.5) * ab * ac * bc + ab * ab, Real(0)));
  };
  return {norm(a.x, b.x), norm(a.y, b.y), norm(a.z, b.z)};
}

}  // namespace rubble::RUBBLE_CORE

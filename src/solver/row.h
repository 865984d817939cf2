#pragma once
/// Rows: scalar constraints C(x) with a Jacobian. A group of rows shares one stiffness and one bound on the
/// norm of its force.
#include "solver/block.h"
#include "solver/warmstart.h"

namespace rubble::RUBBLE_CORE {

/// \eq{S10} Energy of a row of finite stiffness: k C^2 / 2. [J]
RUBBLE_HD inline Real quadraticEnergy(Real k, Real error) { return k * error * error / 2; }
/// \eq{S11} Energy of a hard row: k C^2 / 2 + lambda C. Its derivative with respect to C is the force. [J]
RUBBLE_HD inline Real augmentedEnergy(Real k, Real lambda, Real error) {
  return quadraticEnergy(k, error) + lambda * error;
}

enum class RowUnit { Linear, Angular };

/// Rows [begin, begin + count) of a constraint.
struct RowGroup {
  int begin, count;
  RowUnit unit;
};

/// Force law of a group: what its force depends on besides errors and multipliers.
template <class L> struct GroupLaw {
  L k;           ///< [N/m] or [N m/rad]
  L compliance;  ///< 1 / K_mat; 0 for a hard group
  L bound;       ///< largest norm of the force [N] or [N m]
};
/// State of a group of rows. Its multipliers are stored beside it, one per row.
struct GroupState {
  Real k, compliance, bound;  ///< as in GroupLaw
  StiffnessRule rule;
  int keepsMultiplier;  ///< 0: a soft group whose k ramps up to K_mat (the paper's rule for finite
                        ///< stiffness). An int, so that states compared byte by byte have no padding
};

/// Force and Hessian stiffness of a group at error C: s (k C + lambda) and s k, with s = 1 / (1 + k
/// compliance); s = 1 for hard rows. The force is cut to the bound; returns the mask of the cut lanes. A cut
/// force has the secant stiffness |bound - lambda| / |C| along itself, but at least half of what stops the
/// bodies. With lambda at the bound the secant alone is zero; the bodies overshoot and the force reverses at
/// full size.
template <int N, class L>
RUBBLE_HD RUBBLE_NEAR auto cutForce(const GroupLaw<L>& g, const L* error, const L* lambda, L (&force)[N],
                                    int count, L& hessian) {
  using A = LaneAccess<L>;
  const L zero = A::splat(0), s = A::splat(1) / (Real(1) + g.k * g.compliance);
  L size2 = zero, error2 = zero, lambdaAlong = zero;
  for (int i = 0; i < count; ++i) {
    force[i] = s * (g.k * error[i] + lambda[i]);
    size2 += force[i] * force[i];
    error2 += error[i] * error[i];
    lambdaAlong += force[i] * lambda[i];
  }
  hessian = s * g.k;
  const auto over = size2 > g.bound * g.bound;
  if (!anyOf(over)) return over;
  const L size = sqrtOf(size2);
  const L cut = g.bound / size;
  for (int i = 0; i < count; ++i) force[i] = select(over, force[i] * cut, force[i]);
  const L secant = maxOf(absOf(g.bound - lambdaAlong / size), Real(.5) * g.bound) / sqrtOf(error2);
  hessian = select(over & (error2 > zero), minOf(hessian, secant), hessian);
  return over;
}
/// cutForce for one GroupState; returns true if the force is inside its bound.
template <int N>
RUBBLE_HD RUBBLE_NEAR bool aggregateForce(const GroupState& g, const Real* error, const Real* lambda,
                                          Real (&force)[N], int count, Real& hessian) {
  return !cutForce<N, Real>({g.k, g.compliance, g.bound}, error, lambda, force, count, hessian);
}

/// \eq{S15} f -= F J^T, H += k J^T J for one row.
RUBBLE_HD RUBBLE_NEAR void accumulateRow(Block6& block, const Vec6& j, Real force, Real k) {
  block.fl -= force * j.lin;
  block.fa -= force * j.ang;
  block.ll += outer(j.lin, k);
  block.aa += outer(j.ang, k);
  block.al0 += (k * j.lin.x) * j.ang;
  block.al1 += (k * j.lin.y) * j.ang;
  block.al2 += (k * j.lin.z) * j.ang;
}

/// \eq{S16} Second-derivative term G = sum F d2C/dx2, replaced by the diagonal of its column norms:
/// H += diag(g).
template <class L> RUBBLE_HD RUBBLE_NEAR void accumulateCurvature(Block6T<L>& block, const Vec6T<L>& g) {
  block.ll.xx += g.lin.x, block.ll.yy += g.lin.y, block.ll.zz += g.lin.z;
  block.aa.xx += g.ang.x, block.aa.yy += g.ang.y, block.aa.zz += g.ang.z;
}
/// The same for a block about another point; the center of the body lies `shift` from it.
RUBBLE_HD RUBBLE_NEAR void accumulateCurvature(Block6& block, const Vec6& g, const Vec3& shift) {
  // few rows have curvature in their linear part
  if (!(g.lin.x + g.lin.y + g.lin.z > Real(0))) return accumulateCurvature(block, g);
  addAtLever(block, shift, {0, 0, 0}, Sym3{g.lin.x, 0, 0, g.lin.y, 0, g.lin.z});
  accumulateCurvature(block, {{0, 0, 0}, g.ang});
}

/// Column norms of the second derivative S(a, b) = (a b^T + b a^T) / 2 - (a . b) 1 of a . r(w), where the
/// vector r = b rotates with the body.
template <class L = Real>
RUBBLE_HD RUBBLE_NEAR Vec3T<L> turningColumnNorms(const Vec3T<L>& a, const Vec3T<L>& b) {
  const L aa = dot(a, a), bb = dot(b, b), ab = dot(a, b), zero = LaneAccess<L>::splat(0);
  const auto norm = [&](L ac, L bc) {
    return sqrtOf(
        maxOf(Real(.25) * (aa * bc * bc + bb * ac * ac) - Real(1.5) * ab * ac * bc + ab * ab, zero));
  };
  return {norm(a.x, b.x), norm(a.y, b.y), norm(a.z, b.z)};
}

}  // namespace rubble::RUBBLE_CORE

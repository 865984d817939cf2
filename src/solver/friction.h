#pragma once
/// Coulomb friction of a contact point: a circular cone in the tangent plane, written for lanes.
#include "math/lanes.h"

namespace rubble::RUBBLE_CORE {

/// Force in the tangent basis and the symmetric Hessian [[w11, w12], [w12, w22]].
template <class L>
struct TangentForce {
  L f1, f2;
  L w11, w12, w22;
  L inside;  ///< 1 where the force is inside the cone (sticking), else 0
};

/// Least Hessian stiffness along the sliding direction, in cone force over slip [1]: 1 would stop the slip within the step.
inline constexpr Real kSlidingResistance = Real(.5);

/// l = k C + lambda, cut to the cone |l| <= mu F_n. A point that leaves the cone of `mu` slides with `muDynamic` at once.
/// The Hessian is that of the cut force: along the sliding direction e the secant |b - lambda.e| / |C.e|, across it k b / |l| (exact).
/// With `coneHessian` false it is k in both directions, as in the paper.
template <class L>
RUBBLE_HD TangentForce<L> frictionForce(L k, L c1, L c2, L lambda1, L lambda2, L normalForce, L mu, L muDynamic, bool coneHessian) {
  using A = LaneAccess<L>;
  const L zero = A::splat(0), one = A::splat(1), tiny = A::splat(Real(1e-12));
  const L l1 = k * c1 + lambda1, l2 = k * c2 + lambda2;
  const L size = sqrtOf(l1 * l1 + l2 * l2);
  const auto stick = size <= mu * normalForce;
  const L bound = muDynamic * normalForce;
  const L safe = maxOf(size, tiny);
  const L e1 = l1 / safe, e2 = l2 / safe;
  TangentForce<L> t;
  t.inside = select(stick, one, zero);
  t.f1 = select(stick, l1, bound * e1);
  t.f2 = select(stick, l2, bound * e2);
  if (!coneHessian) {
    t.w11 = t.w22 = k;
    t.w12 = zero;
    return t;
  }
  const L along = absOf(c1 * e1 + c2 * e2);
  const L secant = absOf(bound - (lambda1 * e1 + lambda2 * e2)) / maxOf(along, tiny);
  // With lambda on the cone the secant is 0, and the body would overshoot and flip lambda for ever: resist half of what stops it.
  const L resistance = maxOf(secant, A::splat(kSlidingResistance) * bound / maxOf(along, tiny));
  const L parallel = select(stick, k, select(along < tiny, k, minOf(k, resistance)));
  const L across = select(stick, k, minOf(k, k * bound / safe));
  const L d = parallel - across;
  t.w11 = across + d * e1 * e1;
  t.w12 = d * e1 * e2;
  t.w22 = across + d * e2 * e2;
  return t;
}

}  // namespace rubble::RUBBLE_CORE

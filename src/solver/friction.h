#pragma once
/// Coulomb friction of a contact point: a circular cone in the tangent plane. L: Real or SIMD lanes.
#include <limits>

#include "math/sym.h"

namespace rubble::RUBBLE_CORE {

/// Friction force in the tangent basis, and its Hessian W = across 1 + excess e e^T.
template <class L> struct TangentForce {
  L f1, f2;
  L e1, e2;          ///< direction of k C + lambda, along which the point sticks or slides
  L across, excess;  ///< stiffness perpendicular to e, and its excess along e
  L inside;          ///< 1: the force is inside the cone (sticking), else 0

  RUBBLE_HD L w11() const { return across + excess * e1 * e1; }
  RUBBLE_HD L w12() const { return excess * e1 * e2; }
  RUBBLE_HD L w22() const { return across + excess * e2 * e2; }
};

/// Least Hessian stiffness along the sliding direction, in units of cone force over slip [1]. At 1 the slip
/// would stop within the step.
inline constexpr Real kSlidingResistance = Real(.5);

/// The force l = k C + lambda, projected onto the cone |l| <= mu F_n. A point that leaves the cone of `mu`
/// slides with `muDynamic` at once. The Hessian is that of the projected force: along the sliding direction e
/// the secant |b - lambda.e| / |C.e|, perpendicular to it k b / |l| (exact), with b = muDynamic F_n. With
/// `coneHessian` false it is k in both directions, as in the paper.
template <class L>
RUBBLE_HD RUBBLE_NEAR TangentForce<L> frictionForce(L k, L c1, L c2, L lambda1, L lambda2, L normalForce,
                                                    L mu, L muDynamic, bool coneHessian) {
  using A = LaneAccess<L>;
  const L zero = A::splat(0), one = A::splat(1), tiny = A::splat(std::numeric_limits<Real>::min());
  const L l1 = k * c1 + lambda1, l2 = k * c2 + lambda2;
  const L size = sqrtOf(l1 * l1 + l2 * l2);
  const auto stick = size <= mu * normalForce;
  const L bound = muDynamic * normalForce;
  const L inverse = one / maxOf(size, tiny);
  TangentForce<L> t;
  t.e1 = l1 * inverse, t.e2 = l2 * inverse;
  t.inside = select(stick, one, zero);
  t.f1 = select(stick, l1, bound * t.e1);
  t.f2 = select(stick, l2, bound * t.e2);
  if (!coneHessian) {
    t.across = k, t.excess = zero;
    return t;
  }
  const L slip = absOf(c1 * t.e1 + c2 * t.e2), missing = absOf(bound - (lambda1 * t.e1 + lambda2 * t.e2));
  // With lambda on the cone the secant is 0; the body would then overshoot and flip the sign of lambda in
  // every iteration. The floor is half of what stops it.
  const L resistance = maxOf(missing, A::splat(kSlidingResistance) * bound) / maxOf(slip, tiny);
  const L along = select(stick, k, select(slip < tiny, k, minOf(k, resistance)));
  t.across = select(stick, k, minOf(k, k * bound * inverse));
  t.excess = along - t.across;
  return t;
}

/// The Hessian W = k_n n n^T + across (1 - n n^T) + excess e e^T of a contact point, with normal n, tangents
/// t1, t2 and e = e1 t1 + e2 t2. C: PerContact<L>.
template <class L, class C>
RUBBLE_HD RUBBLE_NEAR Sym3T<L> pointHessian(const Vec3T<C>& n, const Vec3T<C>& t1, const Vec3T<C>& t2, L kN,
                                            const TangentForce<L>& t) {
  const Vec3T<L> e{t1.x * t.e1 + t2.x * t.e2, t1.y * t.e1 + t2.y * t.e2, t1.z * t.e1 + t2.z * t.e2};
  const L across = t.across, beyond = kN - across;
  const Vec3T<L> u{n.x * beyond, n.y * beyond, n.z * beyond},
      v{e.x * t.excess, e.y * t.excess, e.z * t.excess};
  return {across + (u.x * n.x + v.x * e.x), u.x * n.y + v.x * e.y, u.x * n.z + v.x * e.z,
          across + (u.y * n.y + v.y * e.y), u.y * n.z + v.y * e.z, across + (u.z * n.z + v.z * e.z)};
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Contact with friction: up to four points of a pair of bodies A, B, with one normal.
///
///   at x^t      n from A to B; r_A, r_B levers to the point; C_n0 penetration; C_t0 tangential drift since
///               the point stuck
///   in the step d_A = Dp_A + Dw_A x r_A, d_B likewise: first-order displacements of the point on both bodies
///   normal      C_n = C_n0' + n.(d_A - d_B),           0 <= F_n                    [m], [N]
///   tangent     C_t = c C_t0 + t.(d_A - d_B), |F_t| <= mu F_n                       [m], [N]   (c: share of
///               the drift corrected per step)
///               All points share mu in a step, static or dynamic: a point that yields while the others stick
///               keeps its load.
///   force       on A: -(F_n n + F_t) at r_A; on B: the opposite at r_B
///
/// Normal and levers stay frozen at x^t (a first-order expansion), so there is no curvature term. Both bodies
/// use the same point, in the middle of the gap, so that their forces have no net moment. (Giles et al. 2025,
/// sections 3.3 and 4.)
#include "solver/block.h"
#include "solver/friction.h"
#include "solver/stiffness.h"

namespace rubble::RUBBLE_CORE {

/// Motion of a body since x^t: translation [m] and rotation vector [rad]. Contacts read nothing else of a
/// body during the iterations.
struct alignas(8 * sizeof(Real)) Displacement {
  Vec3 dp;
  Real step2;  ///< squared norm of the last sweep's update of dp [m2]; 0: the sweep did not move the body
  Vec3 dw;
  Real turn2;  ///< and of dw [rad2]
};

/// The rows of one point, in three records for vectorized loads and stores.
struct alignas(4 * sizeof(Real)) PointPlace {
  Vec3 rA;  ///< lever on A [m]; the lever on B is rA + offset
  Real c0;  ///< C_n at x^t after regularization [m]
};
struct alignas(4 * sizeof(Real)) PointLoad {
  Real lambdaN, lambda1, lambda2;  ///< multipliers; friction in the tangent basis of n [N]
  Real kN;                         ///< stiffness of the normal row [N/m]
};
struct alignas(4 * sizeof(Real)) PointSlip {
  Real drift1, drift2;  ///< share of C_t at x^t that the rows correct in this step, in the same basis [m]
  Real mu;  ///< static or dynamic friction coefficient, by the state of the manifold in the last step [1]
  Real kT;  ///< stiffness of the two tangential rows [N/m]
};

/// The rows of one manifold in one step. Unused and inactive points have k = 0 and lambda = 0 and so
/// contribute neither force nor Hessian.
struct ContactRows {
  PointPlace place[kLanes];
  PointLoad load[kLanes];
  PointSlip slip[kLanes];
  Vec3 n;                    ///< unit normal, from A to B
  Real most;                 ///< largest normal force of a point [N]
  Vec3 offset;               ///< p_A - p_B at x^t [m]
  Real start;                ///< k_start of the normal rows [N/m]
  int a, b;                  ///< bodies, a < b
  int manifold;              ///< index of the manifold of these rows
  Real length;               ///< L: bounding diameter of the smaller dynamic body [m]
  Real muStatic, muDynamic;  ///< from here on not read by sweeps
  Real restitution;          ///< e [1]
  Real perLoad;              ///< stiffness of a row per newton of load, for StiffnessPolicy::FollowLoad [1/m]
};
static_assert(sizeof(ContactRows) == 64 * sizeof(Real));

/// Errors and forces of the points of one manifold.
template <class L> struct ContactForces {
  L cN, c1, c2;
  L fN;
  TangentForce<L> t;
};

/// The points of a manifold as SIMD lanes, with normal and tangents. load: lambdaN, lambda1, lambda2, kN.
/// slip: drift1, drift2, mu, kT.
template <class L> struct ContactFrame {
  using C = PerContact<L>;
  Vec3T<C> n, t1, t2;
  C most;  ///< largest normal force of a point [N]
  Vec3T<L> rA, rB;
  L c0;
  Quad<L> load, slip;
};

/// `normal`: n and `most`. `offset`: p_A - p_B at x^t [m].
template <class L>
RUBBLE_HD RUBBLE_NEAR ContactFrame<L> contactFrame(const Quad<PerContact<L>>& normal,
                                                   const Vec3T<PerContact<L>>& offset, const Quad<L>& place,
                                                   const Quad<L>& load, const Quad<L>& slip) {
  ContactFrame<L> f;
  f.n = {normal.x, normal.y, normal.z}, f.most = normal.w;
  f.load = load, f.slip = slip;
  tangentBasis(f.n, f.t1, f.t2);
  f.rA = {place.x, place.y, place.z};
  f.rB = {f.rA.x + offset.x, f.rA.y + offset.y, f.rA.z + offset.z};
  f.c0 = place.w;
  return f;
}
template <class L> RUBBLE_HD RUBBLE_NEAR ContactFrame<L> contactFrame(const ContactRows& m, int lane) {
  using A = LaneAccess<L>;
  return contactFrame<L>({m.n.x, m.n.y, m.n.z, m.most}, m.offset, A::loadQuad(m.place, lane),
                         A::loadQuad(m.load, lane), A::loadQuad(m.slip, lane));
}

/// d_A - d_B. D: Displacement, or its dp and dw for each contact.
template <class L, class D>
RUBBLE_HD RUBBLE_NEAR Vec3T<L> relativeDisplacement(const ContactFrame<L>& f, const D& a, const D& b) {
  using A = LaneAccess<L>;
  using C = PerContact<L>;
  const auto at = [](const Vec3T<C>& dw, const Vec3T<L>& r) {
    return Vec3T<L>{dw.y * r.z - dw.z * r.y, dw.z * r.x - dw.x * r.z, dw.x * r.y - dw.y * r.x};
  };
  const Vec3T<C> dp = a.dp - b.dp;
  const Vec3T<L> turn = at(a.dw, f.rA) - at(b.dw, f.rB);
  return {A::splat(dp.x) + turn.x, A::splat(dp.y) + turn.y, A::splat(dp.z) + turn.z};
}

template <class L> RUBBLE_HD RUBBLE_NEAR L along(const Vec3T<PerContact<L>>& u, const Vec3T<L>& d) {
  return u.x * d.x + u.y * d.y + u.z * d.z;
}

/// Errors and bounded forces at the given displacements.
template <class L, class D>
RUBBLE_HD RUBBLE_NEAR ContactForces<L> contactForces(bool coneHessian, const ContactFrame<L>& f, const D& a,
                                                     const D& b) {
  using A = LaneAccess<L>;
  const Vec3T<L> d = relativeDisplacement(f, a, b);
  ContactForces<L> o;
  o.cN = f.c0 + along<L>(f.n, d);
  o.c1 = f.slip.x + along<L>(f.t1, d);
  o.c2 = f.slip.y + along<L>(f.t2, d);
  o.fN = minOf(maxOf(f.load.w * o.cN + f.load.x, A::splat(0)), A::splat(f.most));
  o.t = frictionForce(f.slip.w, o.c1, o.c2, f.load.y, f.load.z, o.fN, f.slip.z, f.slip.z, coneHessian);
  return o;
}

/// Adds forces and Hessians of the points, with levers r, to the block of A (sign -1) or B (1):
/// [[W, -W [r]], [[r] W, -[r] W [r]]] with W = k_n n n^T + tangential part. Hessians are scaled by `weight`.
template <class L, class D>
RUBBLE_HD RUBBLE_NEAR void accumulateContact(bool coneHessian, const ContactFrame<L>& f, PerContact<L> sign,
                                             const Vec3T<L>& r, const D& a, const D& b, Block6T<L>& block,
                                             Real weight) {
  const ContactForces<L> o = contactForces(coneHessian, f, a, b);
  const Vec3T<PerContact<L>>&n = f.n, &t1 = f.t1, &t2 = f.t2;

  const L fn = sign * o.fN, f1 = sign * o.t.f1, f2 = sign * o.t.f2;
  const Vec3T<L> force{n.x * fn + t1.x * f1 + t2.x * f2, n.y * fn + t1.y * f1 + t2.y * f2,
                       n.z * fn + t1.z * f1 + t2.z * f2};

  addAtLever(block, r, force, LaneAccess<L>::splat(weight) * pointHessian(n, t1, t2, f.load.w, o.t));
}
/// The same for points of one contact. The block may be about a point other than the center of the body; the
/// center then lies `shift` from it.
template <class L>
RUBBLE_HD void accumulateContact(bool coneHessian, const ContactRows& m, bool onA, const Displacement& a,
                                 const Displacement& b, int lane, Block6T<L>& block,
                                 const Vec3& shift = {0, 0, 0}, Real weight = 1) {
  const ContactFrame<L> f = contactFrame<L>(m, lane);
  const Vec3T<L>& own = onA ? f.rA : f.rB;
  const Vec3T<L> r{own.x + shift.x, own.y + shift.y, own.z + shift.z};
  accumulateContact(coneHessian, f, onA ? Real(-1) : Real(1), r, a, b, block, weight);
}

/// Stiffness rule of the normal rows of a contact.
RUBBLE_HD inline StiffnessRule normalRule(const StepConstants& c, const ContactRows& m) {
  StiffnessRule rule = contactRule(c, m.start, m.length);
  rule.perLoad = m.perLoad;
  return rule;
}

/// Multipliers and stiffnesses of points after a dual update, as in ContactFrame.
template <class L> struct ContactDuals { Quad<L> load, slip; };

/// The dual update [S 13], [S 14] of the points: the normal force, the friction cone that follows from it,
/// then both stiffnesses. `length`: of ContactRows [m].
template <class L, class D>
RUBBLE_HD RUBBLE_NEAR ContactDuals<L> contactDuals(const StepConstants& c, const ContactFrame<L>& f,
                                                   const StiffnessRuleT<PerContact<L>>& normal,
                                                   PerContact<L> length, const D& a, const D& b) {
  using A = LaneAccess<L>;
  const ContactForces<L> o = contactForces(false, f, a, b);  // without Hessians
  const L kN = f.load.w, kT = f.slip.w;
  const auto sticks = o.t.inside > A::splat(0);
  const auto tangent = tangentRule(c, normal);
  const L grownN = grownStiffness(normal, kN, o.cN, o.fN);
  const L grownT = grownStiffness(tangent, kT, sqrtOf(o.c1 * o.c1 + o.c2 * o.c2),
                                  sqrtOf(o.t.f1 * o.t.f1 + o.t.f2 * o.t.f2));
  const auto loaded = o.fN > A::splat(0);
  const L ceiling = contactCeiling(c, normal.start, (Real(1) - c.alpha) * length, f.c0);
  return {{o.fN, o.t.f1, o.t.f2, select(loaded, minOf(grownN, maxOf(kN, ceiling)), kN)},
          {f.slip.x, f.slip.y, f.slip.z, select(loaded, select(sticks, grownT, kT), kT)}};
}
template <class L>
RUBBLE_HD void updateContactDuals(const StepConstants& c, ContactRows& m, const Displacement& a,
                                  const Displacement& b, int lane) {
  const ContactDuals<L> duals = contactDuals(c, contactFrame<L>(m, lane), normalRule(c, m), m.length, a, b);
  LaneAccess<L>::storeQuad(m.load, lane, duals.load);
  LaneAccess<L>::storeQuad(m.slip, lane, duals.slip);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Contact with friction of vertices: with bodies, other vertices, triangles and edges.
///
///   side A: a body at lever r, or vertices with weights c_i > 0; side B: vertices with weights c_i < 0,
///   which add up to -1
///   d   = [Dp + Dw x r] + sum c_i (x_i - x_i^t)                 n from A to B, frozen at x^t
///   C_n = C_n0' + n.d,          0 <= F_n                        [m], [N]
///   C_t = c C_t0 + t.d,         |F_t| <= mu F_n
///   force on vertex i: -c_i (F_n n + F_t),  H_i = c_i^2 W,  W = k_n n n^T + tangential part (friction.h)
///
/// The rows of contact.h with one point, and 3x3 blocks for the vertices.
#include "forces/attachment.h"
#include "solver/friction.h"

namespace rubble::RUBBLE_CORE {

struct alignas(4 * sizeof(Real)) PointContact {  // aligned for vectorized loads
  int v[kPointCorners];                          ///< -1: unused
  Real weight[kPointCorners];                    ///< c_i
  int body;                                      ///< side A, or -1
  int part;                                      ///< part of its shape
  int depth;            ///< coarse levels at which its two sides are in different aggregates
                        ///< (stages/coarse/soft_nodes.h)
  int active : 16;      ///< 1: has rows in this step
  int passes : 16;      ///< 1: the vertex passes a one-way surface: no rows
  int stick, impact;    ///< 1: it stuck at the end of the step; 1: it has an impact in this step
  Vec3 n;               ///< unit
  Vec3 lever;           ///< r [m]
  Real c0;              ///< C_n at x^t after regularization [m]
  Real drift1, drift2;  ///< C_t at x^t before regularization, tangent basis of n [m]
  Real mu, muStatic, muDynamic;
  Real lambdaN, lambda1, lambda2;  ///< [N]
  Real keptN, kept1, kept2;        ///< multipliers for the next warm start; not those of an impact [N]
  Real kN, kT;                     ///< [N/m]; 0: inactive or new
  Real start;                      ///< k_start of the normal row [N/m]
  Real length;                     ///< L [m]

  struct Forces {
    Real cN, c1, c2, fN;
    TangentForce<Real> t;
    Vec3 t1, t2;
    RUBBLE_HD Vec3 vector(const Vec3& n) const { return fN * n + t.f1 * t1 + t.f2 * t2; }
    RUBBLE_HD Sym3 hessian(const Vec3& n, Real kN) const { return pointHessian(n, t1, t2, kN, t); }
  };

  /// d for displacement `a` of the body and weighted sum `moved` of the vertex displacements.
  RUBBLE_HD Vec3 displacement(const Displacement& a, const Vec3& moved) const {
    return body >= 0 ? moved + a.dp + cross(a.dw, lever) : moved;
  }
  RUBBLE_HD Forces forces(const StepConstants& c, bool coneHessian, const Vec3& d) const {
    Forces o;
    tangentBasis(n, o.t1, o.t2);
    o.cN = c0 + dot(n, d);
    o.c1 = c.driftCorrection * drift1 + dot(o.t1, d);
    o.c2 = c.driftCorrection * drift2 + dot(o.t2, d);
    o.fN = max(kN * o.cN + lambdaN, Real(0));
    o.t = frictionForce<Real>(kT, o.c1, o.c2, lambda1, lambda2, o.fN, mu, muDynamic, coneHessian);
    return o;
  }
  RUBBLE_HD void accumulateVertex(const StepConstants& c, bool coneHessian, const Vec3& d, int corner,
                                  Block3& block) const {
    const Forces o = forces(c, coneHessian, d);
    const Real w = weight[corner];
    block.f -= w * o.vector(n);
    block.h += (w * w) * o.hessian(n, kN);
  }
  RUBBLE_HD void accumulateBody(const StepConstants& c, bool coneHessian, const Vec3& d,
                                Block6& block) const {
    const Forces o = forces(c, coneHessian, d);
    addAtLever(block, lever, -o.vector(n), o.hessian(n, kN));
  }
  RUBBLE_HD void updateDual(const StepConstants& c, const Vec3& d) {
    const Forces o = forces(c, false, d);  // without Hessians
    const bool inside = o.t.inside > Real(0);
    lambdaN = o.fN, lambda1 = o.t.f1, lambda2 = o.t.f2;
    if (!inside) mu = muDynamic;
    if (!(o.fN > Real(0))) return;
    const StiffnessRule normal = contactRule(c, start, length), tangent = tangentRule(c, normal);
    kN = grownStiffness(normal, kN, o.cN, o.fN);
    if (inside)
      kT = grownStiffness(tangent, kT, std::sqrt(o.c1 * o.c1 + o.c2 * o.c2),
                          std::sqrt(o.t.f1 * o.t.f1 + o.t.f2 * o.t.f2));
  }
  /// Stores the state for the next step. `d`: exact relative displacement.
  RUBBLE_HD void finish(const StepConstants& c, const Vec3& d) {
    if (!impact) keptN = lambdaN, kept1 = lambda1, kept2 = lambda2;
    if (!(kN > Real(0))) kN = start, kT = start * c.tangentStiffness;
    const Real bound = mu * lambdaN;
    stick = lambdaN > Real(0) &&
            lambda1 * lambda1 + lambda2 * lambda2 < bound * bound * (Real(1) - Real(1e-5));
    Vec3 t1, t2;
    tangentBasis(n, t1, t2);
    drift1 = stick ? drift1 + dot(t1, d) : Real(0);
    drift2 = stick ? drift2 + dot(t2, d) : Real(0);
  }
};

/// Input of beginPointContact besides the geometry.
struct PointContactStart {
  Real rowMass;  ///< mass of the lighter side [kg]
  Real depth;    ///< C_n*(x^t) [m]
  Real closing;  ///< closing speed [m/s]
  Real restitution;
};

/// Closing speed above which a vertex contact counts as an impact [m/s].
inline constexpr Real kVertexImpactSpeed = 1;

/// Regularizes and warm-starts [S 12] [S 17] rows whose geometry is set. `old`: the contact in the last step,
/// or null.
RUBBLE_HD inline void beginPointContact(const StepConstants& c, PointContact& p, const PointContactStart& s,
                                        const PointContact* old) {
  p.start = startStiffness(c, s.rowMass);
  const bool hits = s.depth + s.closing * c.dt > Real(0) && s.closing > kVertexImpactSpeed;
  p.c0 = hits && s.restitution > Real(0) ? s.restitution * s.closing * c.dt : inheritedViolation(c, s.depth);
  p.impact = hits && c.impactRule;
  p.mu = p.muStatic;
  const StiffnessRule normal = contactRule(c, p.start, p.length), tangent = tangentRule(c, normal);
  p.kN = coldStart(normal.start).k, p.kT = coldStart(tangent.start).k;
  // no warm start if the normal has rotated too far
  constexpr Real kSameDirection = Real(.866);
  if (!old || !old->active || dot(old->n, p.n) < kSameDirection) return;
  Vec3 o1, o2, t1, t2;
  tangentBasis(old->n, o1, o2);
  tangentBasis(p.n, t1, t2);
  const Vec3 pull = o1 * old->kept1 + o2 * old->kept2, drift = o1 * old->drift1 + o2 * old->drift2;
  p.keptN = p.lambdaN = warmMultiplier(c, old->keptN, true);
  Real l1 = warmMultiplier(c, dot(t1, pull), true), l2 = warmMultiplier(c, dot(t2, pull), true);
  const Real size2 = l1 * l1 + l2 * l2, bound = p.muStatic * p.lambdaN;
  if (size2 > bound * bound) {
    const Real cut = bound / std::sqrt(size2);
    l1 *= cut, l2 *= cut;
  }
  p.kept1 = p.lambda1 = l1, p.kept2 = p.lambda2 = l2;
  if (old->stick)
    p.drift1 = dot(t1, drift), p.drift2 = dot(t2, drift);
  else
    p.mu = p.muDynamic;
  p.kN = warmStiffness(c, normal, old->kN, p.lambdaN);
  p.kT = warmStiffness(c, tangent, old->kT, std::sqrt(l1 * l1 + l2 * l2));
}

}  // namespace rubble::RUBBLE_CORE

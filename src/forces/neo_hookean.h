#pragma once
/// Tetrahedron of stable neo-Hookean material (Smith, de Goes, Kim 2018) with viscosity.
///
///   F = sum x_i m_i^T, J = det F; m_i: rest gradient of the shape function of corner i; V: rest volume
///   psi = mu/2 (|F|^2 - 3) + lam/2 (J - a)^2,  a = 1 + mu/lam                                        [Pa]
///   mu = E/(2 (1 + nu)),  lam = E nu/((1 + nu)(1 - 2 nu)) + mu                                       [Pa]
///   f_i = -V (mu F m_i + lam (J - a) w_i),   w_i = cof(F) m_i
///   H_i = V (mu |m_i|^2 1 + lam w_i w_i^T)
///
/// J is linear in each vertex, so H_i is the exact second derivative. It is positive definite for any F, even
/// inverted. Viscosity acts on the rate of the Green strain E = (F^T F - 1)/2, which is invariant under rigid
/// motion: dissipation V eta/(2 dt) |E - E^t|^2, Gauss-Newton Hessian.
#include <array>

#include "math/block3.h"
#include "solver/constants.h"

namespace rubble {

/// Cooked tetrahedron, in double precision. Vertices are those of its object.
struct TetrahedronModel {
  std::array<int, 4> v;
  Vec3 m[3];                ///< [1/m]
  double mu, lambda;        ///< [Pa]
  double volume;            ///< [m3]
  double viscosity;         ///< [Pa s]
  double yield, hardening;  ///< [Pa]
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

/// Material and rest shape. Any corner may be corner 0.
struct NeoHookean {
  static constexpr int kCorners = 4;

  Vec3 m[3];        ///< m_1, m_2, m_3; m_0 is minus their sum [1/m]
  Real mu, lambda;  ///< Lame parameters times V [J]
  Real damper;      ///< V eta [J s]

  RUBBLE_HD Vec3 gradient(int corner) const { return corner == 0 ? -(m[0] + m[1] + m[2]) : m[corner - 1]; }

  /// Sum of |m_i|^2; times mu it is the stiffness that its corners see. [1/m2]
  RUBBLE_HD Real steepness() const {
    Real sum = 0;
    for (int i = 0; i < kCorners; ++i) sum += dot(gradient(i), gradient(i));
    return sum;
  }
  /// F by columns.
  RUBBLE_HD Mat3 deformation(const Vec3 (&x)[kCorners]) const {
    const Vec3 e1 = x[1] - x[0], e2 = x[2] - x[0], e3 = x[3] - x[0];
    const auto column = [&](Real a, Real b, Real c) { return e1 * a + e2 * b + e3 * c; };
    return {column(m[0].x, m[1].x, m[2].x), column(m[0].y, m[1].y, m[2].y), column(m[0].z, m[1].z, m[2].z)};
  }
  RUBBLE_HD static Mat3 cofactors(const Mat3& f) {
    return {cross(f.c1, f.c2), cross(f.c2, f.c0), cross(f.c0, f.c1)};
  }
  RUBBLE_HD static Sym3 greenStrain(const Mat3& f) {
    return {(dot(f.c0, f.c0) - 1) / 2, dot(f.c0, f.c1) / 2, dot(f.c0, f.c2) / 2,
            (dot(f.c1, f.c1) - 1) / 2, dot(f.c1, f.c2) / 2, (dot(f.c2, f.c2) - 1) / 2};
  }
  /// E - E^t
  RUBBLE_HD static Sym3 strainChange(const Mat3& f, const Sym3& start) {
    Sym3 d = greenStrain(f);
    d += Sym3{-start.xx, -start.xy, -start.xz, -start.yy, -start.yz, -start.zz};
    return d;
  }
  RUBBLE_HD Real target() const { return Real(1) + mu / lambda; }

  /// P = V (mu F + lam (J - a) cof F + eta/dt F (E - E^t)), f_i = -P m_i. `start`: E^t, if there is
  /// viscosity. [J]
  RUBBLE_HD Mat3 stress(const StepConstants& c, const Mat3& f, const Mat3& cof, const Sym3& start) const {
    Mat3 p = mu * f + (lambda * (dot(f.c0, cof.c0) - target())) * cof;
    if (damper > Real(0)) {
      const Sym3 e = strainChange(f, start);
      const Mat3 rate{{e.xx, e.xy, e.xz}, {e.xy, e.yy, e.yz}, {e.xz, e.yz, e.zz}};
      p = p + damper * c.inverseDt * (f * rate);
    }
    return p;
  }
  RUBBLE_HD void accumulate(const StepConstants& c, const Vec3 (&x)[kCorners], const Sym3& start, int corner,
                            Block3& block) const {
    const Mat3 f = deformation(x), cof = cofactors(f);
    const Vec3 g = gradient(corner);
    block.f -= stress(c, f, cof, start) * g;
    block.h += outer(cof * g, lambda);
    block.addDiagonal(mu * dot(g, g));
    if (!(damper > Real(0))) return;
    const Real half = damper * c.inverseDt / 2, size = half * dot(g, g);
    block.h += outer(f.c0, size);
    block.h += outer(f.c1, size);
    block.h += outer(f.c2, size);
    block.h += outer(f * g, half);
  }
};

/// Largest growth of the corner stiffness (sum of |m_i|^2) by plastic flow [1]: stretched to 15 times the
/// length, or pressed to a fifth of the height. Beyond it the material is elastic. Without a bound, elements
/// that are torn apart become needles that ten sweeps do not solve, and the energy of a thrown object
/// diverges; at 30 it does not.
inline constexpr Real kMostSteepness = 10;

/// Aligned for vectorized loads.
struct alignas(4 * sizeof(Real)) Tetrahedron : NeoHookean {
  static constexpr const char* kName = "tetrahedron";
  static constexpr int kCorners = NeoHookean::kCorners;
  static constexpr bool kHasDual = false;

  int v[kCorners];
  int alive;              ///< always 1: it does not tear
  Sym3 strainStart;       ///< E^t, if there is viscosity
  Real yield, hardening;  ///< yield stress and hardening times V [J]; plasticity.h, which changes the m_i
  Real plasticStrain;     ///< accumulated equivalent plastic strain [1]
  Real steepest;          ///< largest sum of |m_i|^2 that plastic flow may reach [1/m2]

  using Model = TetrahedronModel;
  void set(const Model& in) {
    for (int k = 0; k < 3; ++k) m[k] = Vec3(in.m[k]);
    mu = Real(in.mu * in.volume), lambda = Real(in.lambda * in.volume);
    damper = Real(in.volume * in.viscosity);
    yield = thresholdOf(in.yield * in.volume), hardening = Real(in.hardening * in.volume);
    steepest = kMostSteepness * steepness();
  }

  /// As set(), but plastic flow has the last word on the rest shape.
  void redefine(const Model& in) {
    const Vec3 flowed[3] = {m[0], m[1], m[2]};
    set(in);
    for (int k = 0; k < 3 && plasticStrain > Real(0); ++k) m[k] = flowed[k];
  }

  RUBBLE_HD void begin(const StepConstants&, const Vec3 (&x)[kCorners]) {
    if (damper > Real(0)) strainStart = greenStrain(deformation(x));
  }
  /// Elastic energy, plus the dissipation of the step V eta/(2 dt) |E - E^t|^2. [J]
  RUBBLE_HD Real energy(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    const Mat3 f = deformation(x);
    const Real excess = dot(f.c0, cross(f.c1, f.c2)) - target();
    Real sum = mu / 2 * (dot(f.c0, f.c0) + dot(f.c1, f.c1) + dot(f.c2, f.c2) - 3) +
               lambda / 2 * excess * excess;
    if (damper > Real(0)) {
      const Sym3 d = strainChange(f, strainStart);
      const Real size2 = d.xx * d.xx + d.yy * d.yy + d.zz * d.zz +
                         2 * (d.xy * d.xy + d.xz * d.xz + d.yz * d.yz);
      sum += damper * c.inverseDt / 2 * size2;
    }
    return sum;
  }
  RUBBLE_HD void accumulate(const StepConstants& c, const Vec3 (&x)[kCorners], int corner,
                            Block3& block) const {
    NeoHookean::accumulate(c, x, strainStart, corner, block);
  }
};

/// Copy of a tetrahedron for one of its corners, which is corner 0 here. A vertex thus reads its tetrahedra
/// contiguously.
struct alignas(4 * sizeof(Real)) TetraCorner : NeoHookean {
  int other[3];  ///< vertices 1, 2, 3
  int element;

  /// Copies m_1, m_2, m_3 in the order of `other`.
  RUBBLE_HD void takeShape(const Tetrahedron& e) {
    for (int k = 0, n = 0; k < kCorners && n < 3; ++k)
      if (e.v[k] == other[n]) m[n++] = e.gradient(k);
  }
};

}  // namespace rubble::RUBBLE_CORE

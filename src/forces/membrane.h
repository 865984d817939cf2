#pragma once
/// Cloth triangle with in-plane stretch and shear stiffness (St. Venant-Kirchhoff), as three finite rows.
///
///   F = [f1 f2] = sum x_i m_i^T (3x2), E = (F^T F - 1)/2; A: rest area; mu, lam: Lame parameters times the
///   thickness [N/m]
///   psi A = A (mu |E|^2 + lam/2 tr(E)^2) = A (mu + lam)/2 C_0^2 + A mu/2 (C_1^2 + C_2^2)
///   C_0 = E11 + E22, C_1 = E11 - E22, C_2 = 2 E12      [1], multipliers in J
///   J_i: f1 m1 + f2 m2,  f1 m1 - f2 m2,  f1 m2 + f2 m1  with m_i = (m1, m2)
///   d2C/dx_i^2: (m1^2 + m2^2) 1, (m1^2 - m2^2) 1, 2 m1 m2 1; their sum with the multipliers is m_i.S m_i 1,
///   of which max(0, .) is kept: the only projection that makes H definite under compression
///
/// The rows are in material axes, so their multipliers rotate with the cloth from step to step. Viscosity
/// acts on dE/dt.
#include <array>

#include "forces/finite_row.h"
#include "math/block3.h"

namespace rubble {

/// Cooked cloth triangle, in double precision. Vertices are those of its object.
struct MembraneModel {
  std::array<int, 3> v;
  double m1[2], m2[2];  ///< [1/m]
  double stiffness[2];  ///< [J]
  double damper;        ///< [J s]
  double tearStretch;
  double unit;     ///< [kg m2]
  double largest;  ///< [1/m]
};

}  // namespace rubble

namespace rubble::RUBBLE_CORE {

struct Membrane {
  static constexpr const char* kName = "membrane";
  static constexpr int kCorners = 3;
  static constexpr bool kHasDual = true;
  static constexpr int kRows = 3;

  int v[kCorners];
  int alive;
  Real m1[2],
      m2[2];             ///< rest gradients of corners 1 and 2, by component; corner 0: minus their sum [1/m]
  Real stiffness[2];     ///< A (mu + lam) for row 0, A mu for rows 1 and 2 [J]
  Real damper;           ///< A h eta / 2 for each row [J s]
  Real tearStretch;      ///< tear threshold of the largest principal stretch (length over rest length) [1]
  Real unit0;            ///< mass of the lightest vertex over the largest |m_i|^2 [kg m2]
  Real largest;          ///< the largest |m_i| [1/m]
  Real lambda[kRows];    ///< [J]
  Real k[kRows];         ///< [J]
  DampedRow row[kRows];  ///< rows of this step
  Real c0[kRows];        ///< [1]

  using Model = MembraneModel;
  void set(const Model& m) {
    for (int i = 0; i < 2; ++i)
      m1[i] = Real(m.m1[i]), m2[i] = Real(m.m2[i]), stiffness[i] = Real(m.stiffness[i]);
    damper = Real(m.damper), tearStretch = Real(m.tearStretch);
    unit0 = Real(m.unit), largest = Real(m.largest);
  }

  struct Columns {
    Vec3 f1, f2;
  };
  struct Gradient {
    Real x, y;
  };
  RUBBLE_HD Columns deformation(const Vec3 (&x)[kCorners]) const {
    const Vec3 e1 = x[1] - x[0], e2 = x[2] - x[0];
    return {e1 * m1[0] + e2 * m2[0], e1 * m1[1] + e2 * m2[1]};
  }
  RUBBLE_HD Gradient gradient(int corner) const {
    if (corner == 0) return {-(m1[0] + m2[0]), -(m1[1] + m2[1])};
    return corner == 1 ? Gradient{m1[0], m1[1]} : Gradient{m2[0], m2[1]};
  }
  RUBBLE_HD static void strains(const Columns& f, Real (&c)[kRows]) {
    const Real a = (dot(f.f1, f.f1) - 1) / 2, b = (dot(f.f2, f.f2) - 1) / 2;
    c[0] = a + b, c[1] = a - b, c[2] = dot(f.f1, f.f2);
  }
  RUBBLE_HD Real unit(const StepConstants& c) const { return unit0 * c.inverseDt * c.inverseDt; }

  RUBBLE_HD void begin(const StepConstants& c, const Vec3 (&x)[kCorners]) {
    Real error[kRows];
    strains(deformation(x), error);
    for (int i = 0; i < kRows; ++i) {
      row[i] = dampedRow(stiffness[i > 0], damper * c.inverseDt, error[i]);
      const FiniteStart start = beginFiniteRow(c, row[i].stiffness, unit(c), largest, error[i] - row[i].shift,
                                               k[i], lambda[i]);
      k[i] = start.k, lambda[i] = start.lambda, c0[i] = start.c0;
    }
  }
  RUBBLE_HD FiniteForce force(const StepConstants& c, const Real (&error)[kRows], int i) const {
    return finiteForce(c.compliantRows, row[i].stiffness, k[i], error[i] - row[i].shift - c0[i], lambda[i]);
  }
  RUBBLE_HD Real energy(const StepConstants& c, const Vec3 (&x)[kCorners]) const {
    Real error[kRows], sum = 0;
    strains(deformation(x), error);
    for (int i = 0; i < kRows; ++i) {
      const Real e = error[i] - row[i].shift - c0[i], own = k[i];
      const Real s = c.compliantRows ? row[i].stiffness / (row[i].stiffness + own) : Real(1);
      sum += s * (own * e * e / 2 + lambda[i] * e);
    }
    return sum;
  }
  RUBBLE_HD void accumulate(const StepConstants& c, const Vec3 (&x)[kCorners], int corner,
                            Block3& block) const {
    const Columns f = deformation(x);
    const Gradient g = gradient(corner);
    Real error[kRows];
    strains(f, error);
    const Vec3 a = f.f1 * g.x, b = f.f2 * g.y;
    const Vec3 j[kRows] = {a + b, a - b, f.f1 * g.y + f.f2 * g.x};
    const Real second[kRows] = {g.x * g.x + g.y * g.y, g.x * g.x - g.y * g.y, 2 * g.x * g.y};
    Real curvature = 0;
    for (int i = 0; i < kRows; ++i) {
      const FiniteForce o = force(c, error, i);
      block.f -= o.force * j[i];
      block.h += outer(j[i], o.hessian);
      curvature += o.force * second[i];
    }
    block.addDiagonal(max(curvature, Real(0)));
  }
  RUBBLE_HD void updateDual(const StepConstants& c, const Vec3 (&x)[kCorners]) {
    Real error[kRows];
    strains(deformation(x), error);
    for (int i = 0; i < kRows; ++i) {
      const Real now = force(c, error, i).force;
      if (c.compliantRows) lambda[i] = now;
      k[i] = grownFiniteRow(c, row[i].stiffness, unit(c), largest, error[i] - row[i].shift, k[i], now,
                            Real(1) / largest);
    }
  }
  /// Does it tear in this step?
  RUBBLE_HD bool finish(const StepConstants&, const Vec3 (&x)[kCorners]) const {
    if (!isFinite(tearStretch)) return false;
    const Columns f = deformation(x);
    const Real a = dot(f.f1, f.f1), b = dot(f.f2, f.f2), d = dot(f.f1, f.f2);
    const Real largest = (a + b) / 2 + std::sqrt((a - b) * (a - b) / 4 + d * d);
    return largest > tearStretch * tearStretch;
  }
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Contribution of an element to a cluster of vertices that moves rigidly: x_a -> x_a + dp + dw x s_a for the
/// corners a inside; the others stay.
///
/// Force and moment are those of the corners. The Hessian is that of rows C with J_S = (sum J_a, sum s_a x
/// J_a), summed before squaring; negative curvature of rows is dropped. For a tetrahedron the rows are the
/// entries of F (stiffness mu) and J (lambda), which bound its Hessian from above under compression.
#include "forces/soft_forces.h"

namespace rubble::RUBBLE_CORE {

/// Rows e_i (sum_a w_a x_a), i = 1..3, of stiffness k. `lin` = sum w_a, `ang` = sum w_a s_a over the corners
/// inside.
RUBBLE_HD inline void accumulateMeanRows(Block6& block, Real lin, const Vec3& ang, Real k) {
  block.ll.xx += k * lin * lin, block.ll.yy += k * lin * lin, block.ll.zz += k * lin * lin;
  const Vec3 b = (k * lin) * ang;
  // columns of [b]
  block.al0 += Vec3{0, b.z, -b.y}, block.al1 += Vec3{-b.z, 0, b.x}, block.al2 += Vec3{b.y, -b.x, 0};
  const Real size = k * dot(ang, ang);
  block.aa += outer(ang, -k);
  block.aa.xx += size, block.aa.yy += size, block.aa.zz += size;
}

/// The same for three sets of weights: `lin` holds their sums w_a, the columns of `ang` their sums w_a s_a.
RUBBLE_HD inline void accumulateMeanRows(Block6& block, const Vec3& lin, const Mat3& ang, Real k) {
  const Real mass = k * dot(lin, lin),
             size = k * (dot(ang.c0, ang.c0) + dot(ang.c1, ang.c1) + dot(ang.c2, ang.c2));
  block.ll.xx += mass, block.ll.yy += mass, block.ll.zz += mass;
  const Vec3 b = k * (ang * lin);
  block.al0 += Vec3{0, b.z, -b.y}, block.al1 += Vec3{-b.z, 0, b.x}, block.al2 += Vec3{b.y, -b.x, 0};
  block.aa += outer(ang.c0, -k);
  block.aa += outer(ang.c1, -k);
  block.aa += outer(ang.c2, -k);
  block.aa.xx += size, block.aa.yy += size, block.aa.zz += size;
}

/// Calls f(corner, s) for the corners inside.
template <int N, class Function>
RUBBLE_HD void forEachInside(const Vec3 (&x)[N], unsigned mask, const Vec3& center, Function&& f) {
  for (int k = 0; k < N; ++k)
    if (mask >> k & 1u) f(k, x[k] - center);
}

RUBBLE_HD inline void accumulateGroupHessian(const StepConstants& c, const Membrane& e, const Vec3 (&x)[3],
                                             unsigned mask, const Vec3& center, Real scale, Block6& block) {
  const Membrane::Columns f = e.deformation(x);
  Real error[Membrane::kRows];
  Membrane::strains(f, error);
  Vec6 rows[Membrane::kRows]{};
  Membrane::Gradient m{0, 0};
  Vec3 bx{0, 0, 0}, by{0, 0, 0};
  forEachInside(x, mask, center, [&](int k, const Vec3& s) {
    const Membrane::Gradient g = e.gradient(k);
    const Vec3 a = f.f1 * g.x, b = f.f2 * g.y;
    const Vec3 j[3] = {a + b, a - b, f.f1 * g.y + f.f2 * g.x};
    for (int i = 0; i < Membrane::kRows; ++i) rows[i].lin += j[i], rows[i].ang += cross(s, j[i]);
    m.x += g.x, m.y += g.y;
    bx += g.x * s, by += g.y * s;
  });
  Real force[Membrane::kRows];
  for (int i = 0; i < Membrane::kRows; ++i) {
    const FiniteForce o = e.force(c, error, i);
    force[i] = o.force;
    accumulateRow(block, rows[i], Real(0), scale * o.hessian);
  }
  // tension: largest principal value of the stress S in material axes
  const Real sx = force[0] + force[1], sy = force[0] - force[1],
             largest = max(Real(0),
                           (sx + sy) / 2 + std::sqrt((sx - sy) * (sx - sy) / 4 + force[2] * force[2]));
  accumulateMeanRows(block, m.x, bx, scale * largest);
  accumulateMeanRows(block, m.y, by, scale * largest);
}

template <int N>
RUBBLE_HD void accumulateGroupHessian(const StepConstants&, const QuadraticBend<N>& e, const Vec3 (&x)[N],
                                      unsigned mask, const Vec3& center, Real scale, Block6& block) {
  Real lin = 0;
  Vec3 ang{0, 0, 0};
  forEachInside(x, mask, center, [&](int k, const Vec3& s) { lin += e.weight[k], ang += e.weight[k] * s; });
  accumulateMeanRows(block, lin, ang, scale * e.stiffness);
}

RUBBLE_HD inline void accumulateGroupHessian(const StepConstants& c, const FoldBend& e, const Vec3 (&x)[4],
                                             unsigned mask, const Vec3& center, Real scale, Block6& block) {
  const FoldBend::Fold f = e.fold(x);
  if (!f.valid) return;
  Vec6 row{{0, 0, 0}, {0, 0, 0}};
  forEachInside(x, mask, center, [&](int k, const Vec3& s) {
    const Vec3 g = e.gradient(f, x, k);
    row.lin += g, row.ang += cross(s, g);
  });
  accumulateRow(block, row, Real(0), scale * (e.stiffness + e.damping * c.inverseDt));
}

RUBBLE_HD inline void accumulateGroupHessian(const StepConstants& c, const Spring& e, const Vec3 (&x)[2],
                                             unsigned mask, const Vec3& center, Real scale, Block6& block) {
  const Vec3 d = x[0] - x[1];
  const Real l = length(d);
  if (!(l > Real(1e-6) * e.restLength)) return;
  const FiniteForce o = e.evaluate(c, x);
  const Vec3 u = d / l;
  Vec6 row{{0, 0, 0}, {0, 0, 0}};
  Real lin = 0;
  Vec3 ang{0, 0, 0};
  forEachInside(x, mask, center, [&](int k, const Vec3& s) {
    const Real sign = k == 0 ? Real(1) : Real(-1);
    row.lin += sign * u, row.ang += cross(s, sign * u);
    lin += sign, ang += sign * s;
  });
  const Real across = max(o.force, Real(0)) / l;
  accumulateRow(block, row, Real(0), scale * max(o.hessian - across, Real(0)));
  accumulateMeanRows(block, lin, ang, scale * across);
}

/// For elements without a formula of their own: an upper bound by the traces of the Hessians of the corners.
template <class F>
RUBBLE_HD void boundGroupHessian(const StepConstants& c, const F& e, const Vec3 (&x)[F::kCorners],
                                 unsigned mask, const Vec3& center, Real scale, Block6& block) {
  int inside = 0;
  forEachInside(x, mask, center, [&](int, const Vec3&) { ++inside; });
  forEachInside(x, mask, center, [&](int k, const Vec3& s) {
    Block3 own;
    e.accumulate(c, x, k, own);
    accumulateMeanRows(block, Real(1), s, scale * Real(inside) * (own.h.xx + own.h.yy + own.h.zz));
  });
}

/// Adds force and Hessian of an element with corners inside and outside. `scale`: factor on the Hessian.
template <class F>
RUBBLE_HD void accumulateGroup(const StepConstants& c, const F& e, const Vec3 (&x)[F::kCorners],
                               unsigned mask, const Vec3& center, Real scale, Block6& block) {
  forEachInside(x, mask, center, [&](int k, const Vec3& s) {
    Block3 own;
    e.accumulate(c, x, k, own);
    block.fl += own.f, block.fa += cross(s, own.f);
  });
  if constexpr (requires { accumulateGroupHessian(c, e, x, mask, center, scale, block); })
    accumulateGroupHessian(c, e, x, mask, center, scale, block);
  else
    boundGroupHessian(c, e, x, mask, center, scale, block);
}

/// The tetrahedron, all corners at once. With m = sum m_a and B = sum s_a m_a^T over the corners inside
/// (columns b_i), the force is -P m, the moment -sum b_i x P_i, and the row of J has J_S = (K m, sum b_i x
/// K_i), K = cof F.
RUBBLE_HD inline void accumulateGroup(const StepConstants& c, const Tetrahedron& e, const Vec3 (&x)[4],
                                      unsigned mask, const Vec3& center, Real scale, Block6& block) {
  const Mat3 f = e.deformation(x), k = Tetrahedron::cofactors(f), p = e.stress(c, f, k, e.strainStart);
  Vec3 m{0, 0, 0};
  Mat3 b{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  for (int corner = 0; corner < Tetrahedron::kCorners; ++corner) {
    const Vec3 g = Real(mask >> corner & 1u) * e.gradient(corner), s = x[corner] - center;
    m += g;
    b.c0 += g.x * s, b.c1 += g.y * s, b.c2 += g.z * s;
  }
  const auto moment = [&](const Mat3& a) {
    return cross(b.c0, a.c0) + cross(b.c1, a.c1) + cross(b.c2, a.c2);
  };
  block.fl -= p * m;
  block.fa -= moment(p);
  // far from the rest volume the mixed second derivatives of J matter too; |F| bounds them
  constexpr Real kFarVolume = Real(.5);
  const Real excess = max(Real(0), std::fabs(dot(f.c0, k.c0) - 1) - kFarVolume);
  const Real bend = excess > Real(0)
                        ? e.lambda * excess * std::sqrt(dot(f.c0, f.c0) + dot(f.c1, f.c1) + dot(f.c2, f.c2))
                        : Real(0);
  const Real mu = scale * (e.mu + bend + e.damper * c.inverseDt);
  accumulateMeanRows(block, m, b, mu);
  accumulateRow(block, Vec6{k * m, moment(k)}, Real(0), scale * e.lambda);
}

}  // namespace rubble::RUBBLE_CORE

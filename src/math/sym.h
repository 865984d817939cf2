#pragma once
/// Symmetric 3x3 and 6x6 matrices, and the 6x6 solve.
#include "math/lanes.h"

namespace rubble::RUBBLE_CORE {

template <class L> struct Sym3T {
  L xx{}, xy{}, xz{}, yy{}, yz{}, zz{};

  RUBBLE_HD Vec3T<L> column(int i) const {
    return i == 0 ? Vec3T<L>{xx, xy, xz} : i == 1 ? Vec3T<L>{xy, yy, yz} : Vec3T<L>{xz, yz, zz};
  }
  RUBBLE_HD Sym3T& operator+=(const Sym3T& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    return *this;
  }
  RUBBLE_HD friend Sym3T operator*(const L& k, const Sym3T& m) {
    return {k * m.xx, k * m.xy, k * m.xz, k * m.yy, k * m.yz, k * m.zz};
  }
  RUBBLE_HD friend Vec3T<L> operator*(const Sym3T& m, const Vec3T<L>& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
  }
};
using Sym3 = Sym3T<Real>;

/// s a a^T
RUBBLE_HD inline Sym3 outer(const Vec3& a, Real s = 1) {
  return {s * a.x * a.x, s * a.x * a.y, s * a.x * a.z, s * a.y * a.y, s * a.y * a.z, s * a.z * a.z};
}
/// Adds the inertia m (r.r 1 - r r^T) of a point.
RUBBLE_HD inline void addPointInertia(Sym3& sum, const Vec3& r, Real m) {
  sum += outer(r, -m);
  const Real size = m * dot(r, r);
  sum.xx += size, sum.yy += size, sum.zz += size;
}
/// R diag(d) R^T for the rotation of q.
RUBBLE_HD inline Sym3 rotateDiagonal(const Quat& q, const Vec3& d) {
  const Mat3 r = rotationMatrix(q);
  Sym3 m = outer(r.c0, d.x);
  m += outer(r.c1, d.y);
  m += outer(r.c2, d.z);
  return m;
}
/// The 6x6 system H dx = f of one body, linear part first: H = [[ll, la], [la^T, aa]]. `al` holds la^T (row:
/// angular, column: linear) by columns. L: Real or SIMD lanes (lanes.h).
template <class L> struct Block6T {
  Sym3T<L> ll, aa;
  Vec3T<L> al0{}, al1{}, al2{};  ///< columns of la^T
  Vec3T<L> fl{}, fa{};           ///< force, torque
};
using Block6 = Block6T<Real>;
/// Adds a block about the same point.
template <class L> RUBBLE_HD RUBBLE_NEAR Block6T<L>& operator+=(Block6T<L>& to, const Block6T<L>& from) {
  to.ll += from.ll, to.aa += from.aa;
  to.al0 += from.al0, to.al1 += from.al1, to.al2 += from.al2;
  to.fl += from.fl, to.fa += from.fa;
  return to;
}

/// Adds a force and a Hessian W that act at a lever r: [[W, -W [r]], [[r] W, -[r] W [r]]].
template <class L>
RUBBLE_HD RUBBLE_NEAR void addAtLever(Block6T<L>& block, const Vec3T<L>& r, const Vec3T<L>& force,
                                      const Sym3T<L>& w) {
  block.fl += force;
  block.fa += cross(r, force);
  block.ll += w;
  const Vec3T<L> b0 = cross(r, w.column(0)), b1 = cross(r, w.column(1)), b2 = cross(r, w.column(2));
  block.al0 += b0, block.al1 += b1, block.al2 += b2;
  // row i of [r] W [r]^T is r x (row i of [r] W)
  block.aa.xx += r.y * b2.x - r.z * b1.x;
  block.aa.xy += r.z * b0.x - r.x * b2.x;
  block.aa.xz += r.x * b1.x - r.y * b0.x;
  block.aa.yy += r.z * b0.y - r.x * b2.y;
  block.aa.yz += r.x * b1.y - r.y * b0.y;
  block.aa.zz += r.x * b1.z - r.y * b0.z;
}

/// The same for W = k 1.
template <class L>
RUBBLE_HD RUBBLE_NEAR void addAtLever(Block6T<L>& block, const Vec3T<L>& r, const Vec3T<L>& force, L k) {
  block.fl += force;
  block.fa += cross(r, force);
  block.ll.xx += k, block.ll.yy += k, block.ll.zz += k;
  const Vec3T<L> b = k * r;
  block.al0.y += b.z, block.al0.z -= b.y;
  block.al1.z += b.x, block.al1.x -= b.z;
  block.al2.x += b.y, block.al2.y -= b.x;
  const L xx = b.x * r.x, yy = b.y * r.y, zz = b.z * r.z;
  block.aa.xx += yy + zz, block.aa.yy += xx + zz, block.aa.zz += xx + yy;
  block.aa.xy -= b.x * r.y, block.aa.xz -= b.x * r.z, block.aa.yz -= b.y * r.z;
}

/// Packed lower triangle of a symmetric 6x6 matrix, row by row.
template <class L> struct Sym6T {
  L a[21];
  RUBBLE_HD static constexpr int index(int i, int j) { return i * (i + 1) / 2 + j; }
  RUBBLE_HD L operator()(int i, int j) const { return i >= j ? a[index(i, j)] : a[index(j, i)]; }
};
using Sym6 = Sym6T<Real>;

template <class L> RUBBLE_HD Sym6T<L> pack(const Block6T<L>& b) {
  return {{b.ll.xx, b.ll.xy, b.ll.yy, b.ll.xz, b.ll.yz, b.ll.zz, b.al0.x, b.al1.x, b.al2.x, b.aa.xx, b.al0.y,
           b.al1.y, b.al2.y, b.aa.xy, b.aa.yy, b.al0.z, b.al1.z, b.al2.z, b.aa.xz, b.aa.yz, b.aa.zz}};
}

/// Floor of the pivots, relative to the scaled diagonal 1, since masses and inertias of one body may differ
/// by 1e4 and more.
inline constexpr Real kPivotFloor = sizeof(Real) == 8 ? Real(1e-12) : Real(1e-6);

/// Solves H x = f in place (x holds f) for a symmetric positive definite H: diagonal scaling, then LDL^T
/// without pivoting.
template <class L> RUBBLE_HD RUBBLE_NEAR void solveLdlt(Sym6T<L> h, L (&x)[6]) {
  using A = LaneAccess<L>;
  L scale[6], d[6], inverse[6];
  RUBBLE_UNROLL
  for (int i = 0; i < 6; ++i) scale[i] = A::splat(1) / sqrtOf(h.a[Sym6::index(i, i)]);
  RUBBLE_UNROLL
  for (int j = 0; j < 6; ++j) {
    L pivot = h.a[Sym6::index(j, j)] * scale[j] * scale[j], row[6];
    RUBBLE_UNROLL
    for (int k = 0; k < j; ++k) {
      row[k] = h.a[Sym6::index(j, k)] * d[k];
      pivot -= h.a[Sym6::index(j, k)] * row[k];
    }
    d[j] = maxOf(pivot, A::splat(kPivotFloor));
    inverse[j] = A::splat(1) / d[j];
    RUBBLE_UNROLL
    for (int i = j + 1; i < 6; ++i) {
      L sum = h.a[Sym6::index(i, j)] * scale[i] * scale[j];
      RUBBLE_UNROLL
      for (int k = 0; k < j; ++k) sum -= h.a[Sym6::index(i, k)] * row[k];
      h.a[Sym6::index(i, j)] = sum * inverse[j];
    }
  }
  RUBBLE_UNROLL
  for (int i = 0; i < 6; ++i) {
    x[i] *= scale[i];
    RUBBLE_UNROLL
    for (int k = 0; k < i; ++k) x[i] -= h.a[Sym6::index(i, k)] * x[k];
  }
  RUBBLE_UNROLL
  for (int i = 5; i >= 0; --i) {
    x[i] *= inverse[i];
    RUBBLE_UNROLL
    for (int k = i + 1; k < 6; ++k) x[i] -= h.a[Sym6::index(k, i)] * x[k];
  }
  RUBBLE_UNROLL
  for (int i = 0; i < 6; ++i) x[i] *= scale[i];
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Dense 6x6 matrices in double precision, for block elimination. It subtracts large stiffnesses from one
/// another, and the remainder may be 1e-9 of them.
#include "solver/block.h"

namespace rubble::RUBBLE_CORE {

/// A 6-vector in double precision, linear part first as in Vec6.
struct Long6 {
  double v[6];
};
struct Dense6 {
  double m[6][6];  ///< [row][column]
};

RUBBLE_HD inline void clear(Long6& a) {
  for (double& x : a.v) x = 0;
}
RUBBLE_HD inline void clear(Dense6& a) {
  for (auto& row : a.m)
    for (double& x : row) x = 0;
}

RUBBLE_HD inline Long6 longer(const Vec6& a) {
  return {{static_cast<double>(a.lin.x), static_cast<double>(a.lin.y), static_cast<double>(a.lin.z),
           static_cast<double>(a.ang.x), static_cast<double>(a.ang.y), static_cast<double>(a.ang.z)}};
}
RUBBLE_HD inline Vec6 shorter(const Long6& a, double scale) {
  const auto r = [&](int i) { return static_cast<Real>(scale * a.v[i]); };
  return {{r(0), r(1), r(2)}, {r(3), r(4), r(5)}};
}

RUBBLE_HD inline double dot(const Long6& a, const Long6& b) {
  double sum = 0;
  for (int i = 0; i < 6; ++i) sum += a.v[i] * b.v[i];
  return sum;
}

/// H += s a b^T
RUBBLE_HD inline void addOuter(Dense6& h, const Long6& a, const Long6& b, double s) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) h.m[i][j] += s * a.v[i] * b.v[j];
}
/// The lower triangle of H += s a a^T.
RUBBLE_HD inline void addSquare(Dense6& h, const Long6& a, double s) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) h.m[i][j] += s * a.v[i] * a.v[j];
}

/// The lower triangle of H += the Hessian of a block; f += its force.
RUBBLE_HD inline void addBlock(Dense6& h, Long6& f, const Block6& block) {
  const Sym6 s = pack(block);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) h.m[i][j] += static_cast<double>(s(i, j));
  const Long6 force = longer({block.fl, block.fa});
  for (int i = 0; i < 6; ++i) f.v[i] += force.v[i];
}

/// C -= A^T B
RUBBLE_HD inline void subtractProduct(Dense6& c, const Dense6& a, const Dense6& b) {
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) c.m[i][j] -= a.m[k][i] * b.m[k][j];
}
/// c -= A^T b
RUBBLE_HD inline void subtractProduct(Long6& c, const Dense6& a, const Long6& b) {
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i) c.v[i] -= a.m[k][i] * b.v[k];
}

/// Floor of a pivot, relative to its diagonal element before elimination.
inline constexpr double kDensePivotFloor = 1e-13;

/// In-place factorization H = L D L^T of a symmetric positive definite H. Uses the lower triangle only: L
/// below the diagonal, 1 / D on it.
RUBBLE_HD inline void factor(Dense6& h) {
  double d[6];
  for (int j = 0; j < 6; ++j) {
    double pivot = h.m[j][j];
    const double least = kDensePivotFloor * pivot;
    for (int k = 0; k < j; ++k) pivot -= h.m[j][k] * h.m[j][k] * d[k];
    d[j] = max(pivot, least);
    const double inverse = 1 / d[j];
    for (int i = j + 1; i < 6; ++i) {
      double sum = h.m[i][j];
      for (int k = 0; k < j; ++k) sum -= h.m[i][k] * h.m[j][k] * d[k];
      h.m[i][j] = sum * inverse;
    }
    h.m[j][j] = inverse;
  }
}

/// Solves H x = b with factor(H), in place.
RUBBLE_HD inline void solveFactored(const Dense6& h, Long6& x) {
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < i; ++k) x.v[i] -= h.m[i][k] * x.v[k];
  for (int i = 5; i >= 0; --i) {
    x.v[i] *= h.m[i][i];
    for (int k = i + 1; k < 6; ++k) x.v[i] -= h.m[k][i] * x.v[k];
  }
}
/// The same for the columns of B.
RUBBLE_HD inline void solveFactored(const Dense6& h, Dense6& b) {
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < i; ++k)
      for (int j = 0; j < 6; ++j) b.m[i][j] -= h.m[i][k] * b.m[k][j];
  for (int i = 5; i >= 0; --i) {
    for (int j = 0; j < 6; ++j) b.m[i][j] *= h.m[i][i];
    for (int k = i + 1; k < 6; ++k)
      for (int j = 0; j < 6; ++j) b.m[i][j] -= h.m[k][i] * b.m[k][j];
  }
}

}  // namespace rubble::RUBBLE_CORE

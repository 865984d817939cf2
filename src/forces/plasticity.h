#pragma once
/// Plastic flow of a tetrahedron: F = F_e F_p, and the radial return of Simo (1988) for neo-Hookean material
/// with isotropic hardening.
///
///   F = sum x_i m_i^T is F_e: the m_i are those of the stress-free shape
///   C = F^T F,  b = F F^T,  J = det F,  I1 = tr C,  I2 = |cof F|^2
///   q = sqrt(3/2) mu |dev C|                von Mises stress of the Kirchhoff stress (dev tau = mu dev b,
///                                           |dev b| = |dev C|)  [Pa]
///   Y = sigma_Y + H eps                     eps: equivalent plastic strain  [Pa]
///   q > Y:  d = (q - Y)/(mu I1 + H),   eps <- eps + d,   b' = f b + g 1,   f = (Y + H d)/q,   g >= 0:
///           det b' = J^2
///   F' = F D,   D D^T = F^-1 b' F^-T,   m_i <- D^T m_i
///
/// b' has the axes of b, f dev b and the same J. So pressure and volume are unchanged and the energy
/// decreases. D is determined up to a rotation of the stress-free shape, to which isotropic material is
/// invariant. With F = Q R, D = R^-1 U and U U^T = f R R^T + g 1, both upper triangular. So D = 1 without
/// flow, and det D = 1.
#include "forces/neo_hookean.h"

namespace rubble::RUBBLE_CORE {

/// Least volume over that of the stress-free shape at which a tetrahedron flows [1]. Flat and inverted
/// tetrahedra recover their shape first.
inline constexpr Real kLeastVolumeToFlow = Real(.05);
/// Newton steps for g. Volumes up to twice that of the stress-free shape, and stretches of 1,000, need 8 for
/// a relative error of 1e-7. U compensates the remaining volume error.
inline constexpr int kFlowSteps = 12;

/// Upper triangular matrix.
struct Upper3 {
  Real xx, xy, xz, yy, yz, zz;

  RUBBLE_HD Vec3 timesTransposed(const Vec3& a) const {
    return {xx * a.x, xy * a.x + yy * a.y, xz * a.x + yz * a.y + zz * a.z};
  }
  /// Solves U^T y = a.
  RUBBLE_HD Vec3 solveTransposed(const Vec3& a) const {
    const Real x = a.x / xx, y = (a.y - xy * x) / yy;
    return {x, y, (a.z - xz * x - yz * y) / zz};
  }
};

/// R of F = Q R by Gram-Schmidt. det F = `det` > 0.
RUBBLE_HD inline Upper3 triangularPart(const Mat3& f, Real det) {
  Upper3 r;
  r.xx = std::sqrt(dot(f.c0, f.c0));
  const Vec3 q0 = f.c0 / r.xx;
  r.xy = dot(q0, f.c1), r.xz = dot(q0, f.c2);
  const Vec3 rest = f.c1 - r.xy * q0;
  r.yy = std::sqrt(dot(rest, rest));
  r.yz = dot(rest, f.c2) / r.yy;
  r.zz = det / (r.xx * r.yy);
  return r;
}

/// U of U U^T = f R R^T + g 1, with the determinant of R. Free of cancellation.
RUBBLE_HD inline Upper3 returned(const Upper3& r, Real f, Real g) {
  const Real zz2 = f * r.zz * r.zz + g, left = g / zz2;
  Upper3 u;
  u.zz = std::sqrt(zz2);
  u.yz = f * r.yz * r.zz / u.zz, u.xz = f * r.xz * r.zz / u.zz;
  u.yy = std::sqrt(f * (r.yy * r.yy + r.yz * r.yz * left) + g);
  u.xy = f * (r.xy * r.yy + r.xz * r.yz * left) / u.yy;
  u.xx = r.xx * (r.yy / u.yy) * (r.zz / u.zz);
  return u;
}

/// von Mises stress over mu: sqrt(3/2) |dev C|.
RUBBLE_HD inline Real distortion(const Mat3& f) {
  const Real xx = dot(f.c0, f.c0), yy = dot(f.c1, f.c1), zz = dot(f.c2, f.c2);
  const Real xy = dot(f.c0, f.c1), xz = dot(f.c0, f.c2), yz = dot(f.c1, f.c2);
  const Real a = xx - yy, b = yy - zz, c = zz - xx;
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (xy * xy + xz * xz + yz * yz));
}

/// Solves g^3 + f I1 g^2 + f^2 I2 g = (1 - f^3) J^2 for g >= 0, i.e. det(f b + g 1) = J^2. `lost`: 1 - f,
/// small for little flow.
RUBBLE_HD inline Real volumeKeeper(Real f, Real lost, Real i1, Real i2, Real det) {
  const Real a = f * i1, b = f * f * i2, c = lost * (Real(1) + f + f * f) * det * det;
  // upper bounds of the root: the geometric mean of the eigenvalues of b' is at most their arithmetic mean,
  // and g^3 <= c; Newton descends from there monotonically
  Real g = min(lost * i1, c + Real(2)) / Real(3);
  for (int k = 0; k < kFlowSteps; ++k) g -= (((g + a) * g + b) * g - c) / ((3 * g + 2 * a) * g + b);
  return max(g, Real(0));
}

/// Plastic flow of a tetrahedron by its stress with corners at x.
RUBBLE_HD inline void flow(Tetrahedron& e, const Vec3 (&x)[Tetrahedron::kCorners]) {
  const Mat3 f = e.deformation(x), cof = Tetrahedron::cofactors(f);
  const Real det = dot(f.c0, cof.c0), q = e.mu * distortion(f),
             bound = e.yield + e.hardening * e.plasticStrain;
  if (!(det > kLeastVolumeToFlow) || !(q > bound)) return;
  const Real i1 = dot(f.c0, f.c0) + dot(f.c1, f.c1) + dot(f.c2, f.c2);
  const Real i2 = dot(cof.c0, cof.c0) + dot(cof.c1, cof.c1) + dot(cof.c2, cof.c2);
  const Real strain = (q - bound) / (e.mu * i1 + e.hardening);
  const Real share = (bound + e.hardening * strain) / q, lost = min(e.mu * i1 * strain / q, Real(1));
  const Upper3 r = triangularPart(f, det), u = returned(r, share, volumeKeeper(share, lost, i1, i2, det));
  NeoHookean flowed = e;
  for (Vec3& m : flowed.m) m = u.timesTransposed(r.solveTransposed(m));
  // also false if not finite
  if (!(flowed.steepness() <= e.steepest)) return;
  for (int k = 0; k < 3; ++k) e.m[k] = flowed.m[k];
  e.plasticStrain += strain;
}

}  // namespace rubble::RUBBLE_CORE

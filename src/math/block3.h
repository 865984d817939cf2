#pragma once
/// The local problem of one vertex, with three unknowns.
#include "math/sym.h"

namespace rubble::RUBBLE_CORE {

/// The 3x3 system H dx = f of one vertex [S 4].
struct Block3 {
  Sym3 h;    ///< [N/m]
  Vec3 f{};  ///< [N]

  RUBBLE_HD void addDiagonal(Real a) { h.xx += a, h.yy += a, h.zz += a; }
  RUBBLE_HD void operator+=(const Block3& b) { h += b.h, f += b.f; }
};

/// H^-1 f by diagonal scaling and LDL^T. Cofactors would lose all digits for an ill-conditioned H, such as
/// that of a crushed tetrahedron.
RUBBLE_HD inline Vec3 solve(const Block3& block) {
  constexpr Real kFloor = sizeof(Real) == 8 ? Real(1e-14) : Real(1e-7);
  const Sym3& m = block.h;
  const Vec3& b = block.f;
  const Vec3 scale{Real(1) / std::sqrt(m.xx), Real(1) / std::sqrt(m.yy), Real(1) / std::sqrt(m.zz)};
  const Real xy = m.xy * scale.x * scale.y, xz = m.xz * scale.x * scale.z, yz = m.yz * scale.y * scale.z;
  const Real d1 = max(Real(1) - xy * xy, kFloor), l21 = (yz - xz * xy) / d1;
  const Real d2 = max(Real(1) - xz * xz - l21 * l21 * d1, kFloor);
  const Real x0 = b.x * scale.x, x1 = b.y * scale.y - xy * x0, x2 = (b.z * scale.z - xz * x0 - l21 * x1) / d2;
  const Real y1 = x1 / d1 - l21 * x2;
  return {(x0 - xy * y1 - xz * x2) * scale.x, y1 * scale.y, x2 * scale.z};
}

}  // namespace rubble::RUBBLE_CORE

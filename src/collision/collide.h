#pragma once
/// Narrow-phase test of two primitive shapes.
#include "collision/box_box.h"
#include "collision/round.h"

namespace rubble::RUBBLE_CORE {

/// The manifold of (B, A) as one of (A, B): `t` = p_B - p_A.
RUBBLE_HD inline RawManifold flipped(RawManifold m, const Vec3& t) {
  m.n = -m.n;
  m.normalOnB = !m.normalOnB;
  for (int k = 0; k < m.count; ++k) {
    const RawPoint p = m.points[k];
    m.points[k] = {p.onB + t, p.onA + t, p.feature};
  }
  return m;
}

namespace pairs {

/// For shape kinds in ascending order: round, box, plane.
RUBBLE_HD inline RawManifold collideOrdered(const ShapeData& sa, const Quat& qa, const ShapeData& sb,
                                            const Quat& qb, const Vec3& t, Real margin, Real length) {
  if (sb.kind == ShapeKind::Plane)
    return sa.kind == ShapeKind::Plane ? RawManifold{} : collidePlane(sa, qa, qb, t, margin);
  if (sb.kind != ShapeKind::Box) return collideRounds(sa, qa, sb, qb, t, margin);
  if (sa.kind != ShapeKind::Box) return collideRoundBox(sa, qa, sb, qb, t, margin);
  return collideBoxes(sa.half, qa, sb.half, qb, t, margin, length);
}

}  // namespace pairs

/// Contact points of A and B whose gap is at most `margin` [m]. `t` = p_B - p_A; `length` = bounding diameter
/// of the smaller shape.
RUBBLE_HD inline RawManifold collide(const ShapeData& sa, const Quat& qa, const ShapeData& sb, const Quat& qb,
                                     const Vec3& t, Real margin, Real length) {
  // one call, so that its code exists once
  const bool swaps = sa.kind > sb.kind;
  const RawManifold m = pairs::collideOrdered(swaps ? sb : sa, swaps ? qb : qa, swaps ? sa : sb,
                                              swaps ? qa : qb, swaps ? -t : t, margin, length);
  return swaps ? flipped(m, t) : m;
}

}  // namespace rubble::RUBBLE_CORE

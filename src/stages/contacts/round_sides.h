#pragma once
/// Contact points on the round sides of spheres, capsules, cylinders and cones. While a body rolls, such a
/// point stays where the side faces along the normal, and other material comes there. If a recycled point
/// turned with its body, the weight would push a ball at rest on, up to the speed at which it is tested anew.
#include "collision/manifold.h"
#include "collision/parts.h"
#include "stages/contacts/materials.h"

namespace rubble::RUBBLE_CORE {

/// Cosine of the angle between the normal of a contact and the axis of a cylinder or cone above which it is
/// at its flat end [1].
inline constexpr Real kFlatEnd = Real(.99);

/// Is a contact on the side of a cylinder or cone? `cosine`: between its normal and the axis of the shape.
RUBBLE_HD inline bool isOnSide(const ShapeData& s, Real cosine) {
  return (s.kind == ShapeKind::Cylinder || s.kind == ShapeKind::Cone) && std::fabs(cosine) <= kFlatEnd;
}
/// Does a shape roll on a contact? n: unit normal of the contact, in the frame of the shape.
RUBBLE_HD inline bool rollsOn(const ShapeData& s, const Vec3& n) {
  return s.kind == ShapeKind::Sphere || s.kind == ShapeKind::Capsule || isOnSide(s, n.z);
}

/// The point of a shape that rolls which faces along the unit vector n, at the height of x on its axis. In
/// the frame of the shape [m].
RUBBLE_HD inline Vec3 facingPoint(const ShapeData& s, const Vec3& n, const Vec3& x) {
  if (s.kind == ShapeKind::Sphere) return s.radius * n;
  if (s.kind == ShapeKind::Capsule) return {s.radius * n.x, s.radius * n.y, x.z};
  Real core = s.half.x;
  // the apex of a cone is at half.z, its base at -half.z / 3
  if (s.kind == ShapeKind::Cone) core *= Real(.75) * (Real(1) - (x.z - s.radius * n.z) / s.half.z);
  const Real share = s.radius + core / std::sqrt(n.x * n.x + n.y * n.y);
  return {share * n.x, share * n.y, x.z};
}

/// The parts of a pair, in the frames of their bodies.
struct RoundSides {
  PlacedPart a, b;
};
RUBBLE_HD inline RoundSides roundSides(const SolverData& s, const Pair& pair, const OrderedPair& o) {
  const PairParts parts = partsOf(s, pair, o);
  const Quat same{};
  return {placedPart(s.shapeTables(), s.params[o.a].shape, same, parts.ofA),
          placedPart(s.shapeTables(), s.params[o.b].shape, same, parts.ofB)};
}

/// The point of a part that faces along n, in place of x; all in the frame of the body.
RUBBLE_HD inline Vec3 facingPoint(const PlacedPart& part, const Vec3& n, const Vec3& x) {
  return part.at + rotate(part.q, facingPoint(part.shape, rotateInverse(part.q, n),
                                              rotateInverse(part.q, x - part.at)));
}

/// Distance of contact points from where they would be on a round side, over L [1], up to which they are.
inline constexpr Real kOnRoundSide = Real(1e-4);

/// Marks on which bodies all points of a new manifold are on a round side.
RUBBLE_HD inline void noteRoundSides(const SolverData& s, const Pair& pair, const OrderedPair& o,
                                     const PairPose& pose, Manifold& m) {
  const auto mayRoll = [&](int body) {
    const ShapeData& shape = s.params[body].shape;
    return rollsOn(shape, {1, 0, 0}) || shape.kind == ShapeKind::Compound;
  };
  if (m.count == 0 || !(mayRoll(o.a) || mayRoll(o.b))) return;
  const RoundSides sides = roundSides(s, pair, o);
  const Real most = kOnRoundSide * pose.length;
  const auto isOn = [&](const PlacedPart& part, const Vec3& n, const Vec3& x) {
    return lengthSquared(facingPoint(part, n, x) - x) <= most * most;
  };
  const Vec3 ofA = rotateInverse(pose.qA, m.normal), ofB = rotateInverse(pose.qB, -m.normal);
  bool onA = rollsOn(sides.a.shape, rotateInverse(sides.a.q, ofA)),
       onB = rollsOn(sides.b.shape, rotateInverse(sides.b.q, ofB));
  for (int k = 0; k < m.count; ++k) {
    onA = onA && isOn(sides.a, ofA, pointOnA(m, k));
    onB = onB && isOn(sides.b, ofB, pointOnB(m, k));
  }
  m.rollsA = onA, m.rollsB = onB;
}

/// The old manifold of a pair that hardly moved, with its points where the round sides face along the normal.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline Manifold rolledManifold(const SolverData& s, const Pair& pair,
                                                            const OrderedPair& o, const PairPose& pose,
                                                            const Manifold& old) {
  Manifold m = recycledManifold<Real>(old, pose);
  const RoundSides sides = roundSides(s, pair, o);
  const Vec3 ofA = rotateInverse(pose.qA, m.normal), ofB = rotateInverse(pose.qB, -m.normal);
  for (int k = 0; k < m.count; ++k) {
    if (m.rollsA) setPointOnA(m, k, facingPoint(sides.a, ofA, pointOnA(m, k)));
    if (m.rollsB) setPointOnB(m, k, facingPoint(sides.b, ofB, pointOnB(m, k)));
  }
  return m;
}

}  // namespace rubble::RUBBLE_CORE

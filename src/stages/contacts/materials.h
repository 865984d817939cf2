#pragma once
/// Combines the materials of two bodies into that of their contact.
#include <rubble/scene.h>

#include "stages/pairs/pair_parts.h"

namespace rubble::RUBBLE_CORE {

/// If the rules differ, the later one in rubble::Combine applies. `usual` is the meaning of Combine::Usual.
RUBBLE_HD inline Real combined(int ruleA, int ruleB, Combine usual, Real a, Real b) {
  const int rule = max(ruleA, ruleB);
  switch (rule == 0 ? usual : static_cast<Combine>(rule)) {
    case Combine::Average:
      return (a + b) / 2;
    case Combine::Minimum:
      return min(a, b);
    case Combine::Multiply:
      return a * b;
    case Combine::Maximum:
      return max(a, b);
    default:
      return std::sqrt(a * b);
  }
}

/// The material of a part of a body; `part` is 0 unless the shape is a compound.
RUBBLE_HD inline SurfaceData surfaceOf(const SolverData& s, int body, int part) {
  const BodyParams& p = s.params[body];
  int index = p.surface;
  if (p.shape.kind == ShapeKind::Compound) {
    const int own = s.shapePart[s.shapeIndex[p.shape.data + 2] + part].surface;
    if (own >= 0) index = own;
  }
  if (index >= 0) return s.surface[index];
  return {p.muStatic, p.muDynamic, p.restitution, 0, 0, 0, 0, {0, 0, 0}};
}

/// The combined material of a contact.
struct PairMaterial {
  Real muStatic, muDynamic, restitution;
  Real rolling, torsional;  ///< [m]
  Vec3 surfaceShift;        ///< displacement of A's surface against B's in a step by surface velocity [m]
};

RUBBLE_HD inline PairMaterial pairMaterial(const SolverData& s, const Pair& pair, const OrderedPair& o) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  if (s.surfaces == 0)
    return {std::sqrt(pa.muStatic * pb.muStatic),
            std::sqrt(pa.muDynamic * pb.muDynamic),
            max(pa.restitution, pb.restitution),
            0,
            0,
            {0, 0, 0}};
  // against a surface, `first` is the part of the other body; a surface has no parts
  const bool surface = isSurface(pa.shape.kind) || isSurface(pb.shape.kind), ownerIsA = pair.owner == o.a;
  const SurfaceData a = surfaceOf(s, o.a, surface || ownerIsA ? pair.first : pair.second);
  const SurfaceData b = surfaceOf(s, o.b, surface || !ownerIsA ? pair.first : pair.second);
  PairMaterial m;
  m.muStatic = combined(a.frictionCombine, b.frictionCombine, Combine::GeometricMean, a.muStatic, b.muStatic);
  m.muDynamic = combined(a.frictionCombine, b.frictionCombine, Combine::GeometricMean, a.muDynamic,
                         b.muDynamic);
  m.restitution = combined(a.restitutionCombine, b.restitutionCombine, Combine::Maximum, a.restitution,
                           b.restitution);
  m.rolling = max(a.rolling, b.rolling);
  m.torsional = max(a.torsional, b.torsional);
  m.surfaceShift = s.step->dt *
                   (rotate(s.orientation[o.a], a.velocity) - rotate(s.orientation[o.b], b.velocity));
  return m;
}

}  // namespace rubble::RUBBLE_CORE

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
  return {p.muStatic, p.muDynamic, p.restitution, 0, 0, 0, 0, 0, {0, 0, 0}, {0, 0, 0}};
}
/// The material of a vertex.
RUBBLE_HD inline SurfaceData surfaceOf(const VertexParams& p) {
  SurfaceData out{p.muStatic, p.muDynamic, p.restitution, 0,        0, p.restitutionCombine,
                  0,          0,           {0, 0, 0},     {0, 0, 0}};
  out.frictionCombine = p.frictionCombine, out.kind = p.materialKind;
  return out;
}

/// The rule for materials of two kinds in a world, or null.
RUBBLE_HD inline const MaterialRule* ruleOf(const SolverData& s, int world, int kindA, int kindB) {
  if (s.materialRules == 0 || kindA == 0 || kindB == 0) return nullptr;
  const int key[3] = {world, min(kindA, kindB), max(kindA, kindB)};
  const auto isBefore = [&](const MaterialRule& r) {
    return r.world != key[0] ? r.world < key[0] : r.low != key[1] ? r.low < key[1] : r.high < key[2];
  };
  int begin = 0, end = s.materialRules;
  while (begin < end) {
    const int middle = (begin + end) / 2;
    if (isBefore(s.materialRule[middle]))
      begin = middle + 1;
    else
      end = middle;
  }
  if (begin == s.materialRules) return nullptr;
  const MaterialRule& r = s.materialRule[begin];
  return r.world == key[0] && r.low == key[1] && r.high == key[2] ? &r : nullptr;
}

/// Two materials in contact.
struct MixedMaterial {
  Real muStatic, muDynamic, restitution;
  Real rolling, torsional;  ///< [m]
};
/// The one place where two materials become one: rules of the pair come before the combine rules.
RUBBLE_HD inline MixedMaterial mixed(const SolverData& s, int world, const SurfaceData& a,
                                     const SurfaceData& b) {
  const auto ruled = [](std::uint32_t x, std::uint32_t y, Combine usual, Real u, Real v) {
    return combined(static_cast<int>(x), static_cast<int>(y), usual, u, v);
  };
  MixedMaterial m;
  m.muStatic = ruled(a.frictionCombine, b.frictionCombine, Combine::GeometricMean, a.muStatic, b.muStatic);
  m.muDynamic = ruled(a.frictionCombine, b.frictionCombine, Combine::GeometricMean, a.muDynamic, b.muDynamic);
  m.restitution = combined(a.restitutionCombine, b.restitutionCombine, Combine::Maximum, a.restitution,
                           b.restitution);
  m.rolling = max(a.rolling, b.rolling);
  m.torsional = max(a.torsional, b.torsional);
  const MaterialRule* const rule = ruleOf(s, world, static_cast<int>(a.kind), static_cast<int>(b.kind));
  if (!rule) return m;
  if (rule->given & 1) m.muStatic = rule->muStatic, m.muDynamic = min(m.muDynamic, m.muStatic);
  if (rule->given & 2) m.muDynamic = rule->muDynamic, m.muStatic = max(m.muStatic, m.muDynamic);
  if (rule->given & 4) m.restitution = rule->restitution;
  if (rule->given & 8) m.rolling = rule->rolling;
  if (rule->given & 16) m.torsional = rule->torsional;
  return m;
}

/// The parts of the two bodies of a pair.
struct PairParts {
  int ofA, ofB;
};
RUBBLE_HD inline PairParts partsOf(const SolverData& s, const Pair& pair, const OrderedPair& o) {
  // against a surface, `first` is the part of the other body; a surface has no parts
  const bool surface = isSurface(s.params[o.a].shape.kind) || isSurface(s.params[o.b].shape.kind),
             ownerIsA = pair.owner == o.a;
  const int first = static_cast<int>(pair.first);
  return {surface || ownerIsA ? first : pair.second, surface || !ownerIsA ? first : pair.second};
}

/// The combined material of a contact of bodies.
struct PairMaterial : MixedMaterial {
  Vec3 surfaceShift;  ///< displacement of A's surface against B's in a step by surface velocity [m]
};

RUBBLE_HD inline PairMaterial pairMaterial(const SolverData& s, const Pair& pair, const OrderedPair& o) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  if (s.surfaces == 0)
    return {{std::sqrt(pa.muStatic * pb.muStatic), std::sqrt(pa.muDynamic * pb.muDynamic),
             max(pa.restitution, pb.restitution), 0, 0},
            {0, 0, 0}};
  const PairParts parts = partsOf(s, pair, o);
  const SurfaceData a = surfaceOf(s, o.a, parts.ofA), b = surfaceOf(s, o.b, parts.ofB);
  return {mixed(s, s.worldOf(o.a), a, b),
          s.step->dt * (rotate(s.orientation[o.a], a.velocity) - rotate(s.orientation[o.b], b.velocity))};
}

}  // namespace rubble::RUBBLE_CORE

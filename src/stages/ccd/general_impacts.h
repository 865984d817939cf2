#pragma once
/// Times of impact of pairs that are not of two primitive shapes. It is a separate kernel so that the kernel
/// for primitives stays small.
#include "stages/ccd/fast_bodies.h"

namespace rubble::RUBBLE_CORE {

/// Do the rows of a distance-field manifold keep its points out?
RUBBLE_HD inline bool rowsHold(const SolverData& s, const Manifold* m) {
  if (!hasRows(m)) return false;
  const ContactRows& r = s.contact[m->row];
  bool active = false;
  for (int k = 0; k < m->count; ++k) {
    if (!(r.load[k].kN > Real(0))) continue;
    active = true;
    const ContactFrame<Real> f = contactFrame<Real>(r, k);
    if (f.c0 + along<Real>(r.n, relativeDisplacement(f, s.dx[r.a], s.dx[r.b])) > kHeldPoint * r.length)
      return false;
  }
  return active;
}

/// Normals of the rows between a part and a surface, from the surface to the part.
struct RowFacings {
  Vec3 n[kSurfaceSlots];
  int count = 0;

  RUBBLE_HD bool have(const Vec3d& normal) const {
    for (int k = 0; k < count; ++k)
      if (dot(n[k], Vec3(normal)) > kSameFacing) return true;
    return false;
  }
};
/// Normals of the manifolds that counts(manifold) accepts.
template <class Counts>
RUBBLE_HD RowFacings rowFacings(const SolverData& s, int pair, bool surfaceOnA, Counts&& counts) {
  RowFacings out;
  for (int slot = 0; slot < kSurfaceSlots; ++slot) {
    const Manifold* const m = manifoldOf(s, pair + slot);
    if (counts(m)) out.n[out.count++] = surfaceOnA ? m->normal : -m->normal;
  }
  return out;
}

/// Times of impact of general pairs. Parts of compounds are separate pairs. The first slot of a part and a
/// surface processes all of their slots. By swept pair.
struct FindGeneralImpacts {
  static constexpr const char* kStage = "ccd";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (!s.generalShapes) return;
    SweptPair& swept = s.sweptPair[k];
    const int i = swept.pair;
    const Pair p = s.pair[i];
    const OrderedPair o = ordered(p);
    if (isPrimitivePair(s, o.a, o.b) || !needsSearch(s, o)) return;
    const ShapeData &shapeA = s.params[o.a].shape, &shapeB = s.params[o.b].shape;
    const bool surface = isSurface(shapeA.kind) || isSurface(shapeB.kind);
    if (surface && p.second != 0) return;
    const ShapeTables tables = s.shapeTables();
    const SweptMotion motionA = motionIn(s, o.a), motionB = motionIn(s, o.b);
    const Vec3d between = s.position[o.b] - s.position[o.a];
    const Real size = pairLength(s.params[o.a], s.params[o.b]);
    const double tolerance = static_cast<double>(kImpactGap * size);
    const auto thinnerOf = [&](const PlacedAny& a, const PlacedAny& b) {
      return thinner(innerRadiusOf(tables, a.shape), innerRadiusOf(tables, b.shape));
    };
    if (!surface) {
      const PlacedAny a = placedAny(tables, shapeA, {0, 0, 0}, s.orientation[o.a],
                                    p.owner == o.a ? p.first : p.second);
      const PlacedAny b = placedAny(tables, shapeB, between, s.orientation[o.b],
                                    p.owner == o.a ? p.second : p.first);
      const Real thin = thinnerOf(a, b);
      if (!mayPass(s, o, motionA, motionB, thin, manifoldOf(s, i))) return;
      const TimeOfImpact m = timeOfImpactOfPair(asConvex(a), motionA, asConvex(b), motionB, manifoldOf(s, i),
                                                thin, bothDynamic(s, o), tolerance);
      if (m.fraction <= 1) recordImpact(s, swept, o, m.fraction, m.at.n);
      return;
    }
    const bool onA = surfaceIsOnA(s, p, o);
    const PlacedAny a = placedAny(tables, shapeA, {0, 0, 0}, s.orientation[o.a], onA ? 0 : p.first);
    const PlacedAny b = placedAny(tables, shapeB, between, s.orientation[o.b], onA ? p.first : 0);
    const Real thin = thinnerOf(a, b);
    bool rows = false;
    for (int slot = 0; slot < kSurfaceSlots; ++slot) rows |= hasRows(manifoldOf(s, i + slot));
    if (!rows && approach(s, o, motionA, motionB) <= thin) return;
    const PlacedAny &whole = onA ? a : b, &part = onA ? b : a;
    const SweptMotion &motionS = onA ? motionA : motionB, &motionP = onA ? motionB : motionA;
    TimeOfImpact m;
    if (whole.shape.kind == ShapeKind::Distance) {
      const RowFacings held = rowFacings(s, i, onA, [&](const Manifold* rows) { return rowsHold(s, rows); });
      const Vec3d relative = motionS.move - motionP.move;
      // rows that hold prevent a further impact; at a touching point only an approach counts
      const auto accepts = [&](const Vec3d& facing, const TimeOfImpact& at) {
        return (at.fraction > 0 || dot(at.at.n, relative) > 0) && !held.have(facing) && !held.have(at.at.n);
      };
      // rows push a part out again that is in by no more than half its thickness
      m = timeOfImpactWithField(whole, motionS, part, motionP,
                                {tolerance, true, static_cast<double>(max(kHeldPoint * size, thin))},
                                accepts);
    } else {
      const double allowed = static_cast<double>(kHeldInSurface * thin),
                   more = static_cast<double>(kDeeperYetAtRest * thin);
      const RowFacings rows = rowFacings(s, i, onA, hasRows);
      const Placed convex = asConvex(part);
      const auto impactWith = [&](const Placed& triangle, const Vec3d& up) {
        if (rows.have(up))
          return timeOfImpactBeyond(triangle, motionS, convex, motionP, up, false, allowed, more);
        const TimeOfImpact first = timeOfImpact(triangle, motionS, convex, motionP, tolerance);
        if (first.fraction > 1 || (first.fraction > 0 && !rows.have(first.at.n))) return first;
        return timeOfImpactBeyond(triangle, motionS, convex, motionP, first.fraction > 0 ? first.at.n : up,
                                  false, allowed, more);
      };
      m = timeOfImpactWithTriangles(whole, motionS, convex, motionP, {tolerance, true, allowed}, impactWith);
    }
    if (m.fraction <= 1) recordImpact(s, swept, o, m.fraction, onA ? m.at.n : -m.at.n);
  }
};

}  // namespace rubble::RUBBLE_CORE

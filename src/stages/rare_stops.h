#pragma once
/// Stops of pairs that are not of two plain shapes: in a kernel of its own, so that the plain ones keep theirs small.
#include "stages/stops.h"

namespace rubble::RUBBLE_CORE {

/// Normals of the rows that keep a part and a surface apart, from the surface to the part.
struct HeldFacings {
  Vec3 n[kSurfaceSlots];
  int count = 0;

  RUBBLE_HD bool holds(const Vec3d& normal) const {
    for (int k = 0; k < count; ++k)
      if (dot(n[k], Vec3(normal)) > kSameFacing) return true;
    return false;
  }
};
RUBBLE_HD inline HeldFacings heldFacings(const View& s, int pair, bool surfaceOnA) {
  HeldFacings held;
  for (int slot = 0; slot < kSurfaceSlots; ++slot) {
    const Manifold* const m = manifoldOf(s, pair + slot);
    if (rowsHold(s, m)) held.n[held.count++] = surfaceOnA ? m->normal : -m->normal;
  }
  return held;
}

/// Where the bodies of a pair meet on their ways: parts of compounds one by one, a part and a surface in the first of their slots.
struct FindRareStops {
  static constexpr const char* kName = "stops";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Pair p = s.pair[i];
    const OrderedPair o = ordered(p);
    if (isPlainPair(s, o.a, o.b) || !mayStop(s, o)) return;
    const ShapeData &shapeA = s.params[o.a].shape, &shapeB = s.params[o.b].shape;
    const bool surface = isSurface(shapeA.kind) || isSurface(shapeB.kind);
    if (surface && p.second != 0) return;
    const ShapeTables tables = s.shapeTables();
    const Displacement da = wayIn(s, o.a), db = wayIn(s, o.b);
    const Vec3d between = s.position[o.b] - s.position[o.a];
    const Real size = pairLength(s.params[o.a], s.params[o.b]);
    const double tolerance = static_cast<double>(kMeetingGap * size);
    const auto wayExceeds = [&](const PlacedAny& a, const PlacedAny& b) {
      return approach(s, o, da, db) > innerRadiusOf(tables, a.shape) + innerRadiusOf(tables, b.shape);
    };
    if (!surface) {
      const PlacedAny a = placedAny(tables, shapeA, {0, 0, 0}, s.orientation[o.a], p.owner == o.a ? p.first : p.second);
      const PlacedAny b = placedAny(tables, shapeB, between, s.orientation[o.b], p.owner == o.a ? p.second : p.first);
      if (!wayExceeds(a, b) || rowsHold(s, manifoldOf(s, i))) return;
      const Meeting m = meeting(asConvex(a), wayOf(da), asConvex(b), wayOf(db), tolerance);
      if (m.fraction > 1 || (m.fraction == 0 && dot(m.at.n, Vec3d(da.dp - db.dp)) <= 0)) return;
      noteMeeting(s, i, o, m.fraction);
      return;
    }
    const bool onA = surfaceIsOnA(s, p, o);
    const PlacedAny a = placedAny(tables, shapeA, {0, 0, 0}, s.orientation[o.a], onA ? 0 : p.first);
    const PlacedAny b = placedAny(tables, shapeB, between, s.orientation[o.b], onA ? p.first : 0);
    if (!wayExceeds(a, b)) return;
    const HeldFacings held = heldFacings(s, i, onA);
    const PlacedAny &whole = onA ? a : b, &part = onA ? b : a;
    const Way wayS = wayOf(onA ? da : db), wayP = wayOf(onA ? db : da);
    const Vec3d relative = wayS.move - wayP.move;
    // what rows hold already is not met again; what is touched already only if they go on into one another
    const auto accepts = [&](const Vec3d& facing, const Meeting& m) {
      return (m.fraction > 0 || dot(m.at.n, relative) > 0) && !held.holds(facing) && !held.holds(m.at.n);
    };
    // as long as the part is in by no more than half its thickness, rows push it out again: it lies so deep where it rolls fast in a hollow
    const Real thickness = innerRadiusOf(tables, isConvex(part.shape.kind) ? part.shape : whole.shape);
    const MeetRule rule{tolerance, true, static_cast<double>(max(kHeldDepth * size, thickness))};
    const Meeting m = whole.shape.kind == ShapeKind::Distance ? meetField(whole, wayS, part, wayP, rule, accepts)
                                                              : meetTriangles(whole, wayS, asConvex(part), wayP, rule, accepts);
    if (m.fraction <= 1) noteMeeting(s, i, o, m.fraction);
  }
};

}  // namespace rubble::RUBBLE_CORE

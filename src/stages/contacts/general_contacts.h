#pragma once
/// Narrow phase of all pairs that involve a shape other than primitives. It is a separate kernel so that the
/// kernel for primitives stays small.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline Vec3 downOf(const SolverData& s, int body) {
  return normalize(s.stepOf(body).gravity, Vec3{0, 0, 0});
}

/// Manifolds i to i + kSurfaceSlots - 1, of as many pairs: one part of a body against one surface (a mesh,
/// height field or distance field). Contact points are gathered anew in every step. Each inherits from the
/// nearest old point of the same part and facing, in whichever slot that is.
RUBBLE_HD inline void updateSurfaceManifolds(const SolverData& s, int i) {
  const Pair p = s.pair[s.activePair[i]];
  const OrderedPair o = ordered(p);
  const PairPose pose = pairPose(s, o);
  const ShapeData &shapeA = s.params[o.a].shape, &shapeB = s.params[o.b].shape;
  const bool onA = surfaceIsOnA(s, p, o);
  const ShapeData& surface = onA ? shapeA : shapeB;
  const Quat &qs = onA ? pose.qA : pose.qB, &qp = onA ? pose.qB : pose.qA;
  const ShapeTables tables = s.shapeTables();
  const PlacedPart part = placedPart(tables, onA ? shapeB : shapeA, qp, p.first);
  // pose of the part in the frame of the surface
  const Vec3 toPart = (onA ? pose.t : -pose.t) + part.at, at = rotateInverse(qs, toPart);
  const Quat q = conjugate(qs) * part.q;
  SurfaceContacts found;
  found.length = pose.length;
  // a point where the part hangs from the surface bears no weight: both centers are that of the other body
  const Vec3 center = rotateInverse(qs, surface.kind == ShapeKind::Distance ? toPart - part.at : -part.at);
  found.weight = {center, center, rotateInverse(qs, downOf(s, o.a))};
  if (surface.kind == ShapeKind::Distance)
    collideDistance(tables, surface, part.shape, at, q, pose.margin, found);
  else
    collideTriangles(tables, surface, part.shape, at, q, pose.margin, found);
  if (pose.bullet && !touches(found, kTouchGap * pose.length)) found.count = 0;
  // distance fields give points relative to their own center, triangle shapes relative to that of the part
  const Vec3 origin = surface.kind == ShapeKind::Distance ? Vec3{0, 0, 0} : at;

  // slots of a surface pair are always active together
  const int oldFirst = s.manifoldBefore[s.activePair[i]];
  unsigned used = 0;
  for (int slot = 0; slot < kSurfaceSlots; ++slot) {
    RawManifold raw;
    raw.n = {0, 0, 1};
    raw.separation = 0;
    if (slot < found.count) {
      SurfaceCluster& c = found.cluster[slot];
      convex::pickFour(c.points, c.n, convex::loadedSide(c.points, c.n, found.weight), pose.margin,
                       pose.length);
      const Vec3 n = rotate(qs, c.n);
      raw.n = onA ? n : -n;
      raw.normalOnB = !onA;
      raw.count = c.points.count;
      for (int k = 0; k < raw.count; ++k) {
        // relative to the surface's center, then to that of A
        const Vec3 local = rotate(qs, origin + c.points.v[k].x), onSurface = onA ? local : pose.t + local;
        const Vec3 onPart = onSurface + n * c.points.v[k].w;
        raw.points[k] = {onA ? onSurface : onPart, onA ? onPart : onSurface, c.points.v[k].from};
      }
    }
    Manifold m = newManifold(raw, pose);
    if (oldFirst >= 0 && m.count > 0) {
      // match by feature within the facing, then by distance
      for (int pass = 0; pass < 2; ++pass) {
        for (int k = 0; k < m.count; ++k) {
          if (m.kN[k] > Real(0)) continue;
          int bestSlot = -1, bestPoint = 0;
          Real best = kSamePoint * kSamePoint * pose.length * pose.length;
          for (int j = 0; j < kSurfaceSlots * kLanes; ++j) {
            const Manifold& old = s.oldManifold[oldFirst + j / kLanes];
            const int point = j % kLanes;
            if (point >= old.count || (used >> j & 1) || dot(old.normal, m.normal) < kSameNormal) continue;
            if (pass == 0) {
              if (old.feature[point] == m.feature[k] && bestSlot < 0)
                bestSlot = j / kLanes, bestPoint = point;
              continue;
            }
            const Real d2 = min(lengthSquared(pointOnA(m, k) - pointOnA(old, point)),
                                lengthSquared(pointOnB(m, k) - pointOnB(old, point)));
            if (d2 < best) best = d2, bestSlot = j / kLanes, bestPoint = point;
          }
          if (bestSlot < 0) continue;
          transferLoad(s.oldManifold[oldFirst + bestSlot], bestPoint, m, k);
          used |= 1u << (bestSlot * kLanes + bestPoint);
        }
      }
    }
    addToCounters(s, keepManifold(s, i + slot, o, pose, m));
  }
}

/// Narrow phase of the `tested` pairs that are not of two primitive shapes.
struct TestGeneralPairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int i = s.tested[t];
    const Pair p = s.pair[s.activePair[i]];
    const OrderedPair o = ordered(p);
    if (isPrimitivePair(s, o.a, o.b)) return;
    const ShapeData &shapeA = s.params[o.a].shape, &shapeB = s.params[o.b].shape;
    if (isSurface(shapeA.kind) || isSurface(shapeB.kind)) {
      if (p.second == 0) updateSurfaceManifolds(s, i);
      return;
    }
    addToCounters(s, testPair(s, i, p, o, [&](const PairPose& pose) {
                    const ShapeTables tables = s.shapeTables();
                    const PairParts parts = partsOf(s, p, o);
                    RawManifold raw = collideParts(tables, placedPart(tables, shapeA, pose.qA, parts.ofA),
                                                   placedPart(tables, shapeB, pose.qB, parts.ofB), pose.t,
                                                   pose.margin, pose.length, downOf(s, o.a));
                    if (!touchesNow(raw, pose)) raw.count = 0;
                    return raw;
                  }));
  }
};

}  // namespace rubble::RUBBLE_CORE

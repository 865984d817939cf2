#pragma once
/// Convex shapes against half spaces: at most four of the lowest corners.
#include "collision/convex_pair.h"

namespace rubble::RUBBLE_CORE {

/// Convex shape (A) against the half space z < 0 of the plane (B). `t` = p_B - p_A; the weight is relative to
/// p_A.
RUBBLE_HD inline RawManifold collideConvexPlane(const Convex& a, const Quat& qa, const Quat& qb,
                                                const Vec3& t, Real margin, Real length,
                                                const Weight& weight) {
  using namespace convex;
  RawManifold out;
  const Vec3 up = rotate(qb, Vec3{0, 0, 1}), down = rotateInverse(qa, -up);  // `down` in the frame of A
  const Real surface = -dot(up, t);  // height of A's center over the plane
  out.n = -up;
  out.normalOnB = true;
  out.separation = surface - dot(down, support(a, down)) - a.radius;
  if (out.separation > margin) return out;

  const Weight own{rotateInverse(qa, weight.centerA), rotateInverse(qa, weight.centerB),
                   rotateInverse(qa, weight.down)};
  Cut cut;
  if (a.kind == ShapeKind::Hull) {
    // all vertices of the hull, independent of its faces
    for (int k = 0; k < a.vertexCount; ++k) {
      const Vec3 x = xyz(a.vertices[k]);
      const Real height = surface - dot(down, x);
      if (height - a.radius > margin) continue;
      if (cut.count == kMaxCut) pickFour(cut, down, loadedSide(cut, down, own), Real(1e30), length);
      cut.v[cut.count++] = {x, height, k, k};
    }
  } else {
    Feature f;
    Vec3 foot;
    if (!footOfWeight(own, down, down * surface, foot)) foot = {0, 0, 0};
    featureAlong(a, down, foot, kSameHeight * length, f);
    for (int k = 0; k < f.count; ++k)
      cut.v[cut.count++] = {f.corner[k], surface - dot(down, f.corner[k]), f.id[k], f.id[k]};
  }
  // in the frame of A, so that the same corners are chosen from step to step
  pickFour(cut, down, loadedSide(cut, down, own), margin + a.radius, length);
  out.count = cut.count;
  for (int k = 0; k < cut.count; ++k) {
    const Vec3 onA = rotate(qa, cut.v[k].x) - up * a.radius;
    out.points[k] = {onA, onA - up * (cut.v[k].w - a.radius), cut.v[k].to};
  }
  return out;
}

}  // namespace rubble::RUBBLE_CORE

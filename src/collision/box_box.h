#pragma once
/// Box against box: separating axis test with a preference for faces, then the incident face clipped to at
/// most four points.
#include "collision/shapes.h"

namespace rubble::RUBBLE_CORE {

/// An edge axis wins over the best face axis only if its separation exceeds this share of the face's
/// separation by kEdgeMargin L. Near ties go to faces, whose manifolds are complete.
inline constexpr Real kEdgePreference = Real(.95);
inline constexpr Real kEdgeMargin = Real(.01);
/// Edges are parallel, and give no axis, if their cross product is shorter than this [1].
inline constexpr Real kParallelEdges = Real(1e-3);
/// A point deeper than all points of the reduced manifold by this share of L replaces the nearest of them.
inline constexpr Real kDeeperPoint = Real(1e-3);

namespace boxes {

/// A vertex of the incident face during clipping, in the frame of the reference face: u, v in the face, w
/// above it. Edge numbers: 0-3 incident edges, 4-7 side planes.
struct ClipVertex {
  Real u, v, w;
  int edgeIn, edgeOut;
};
inline constexpr int kMaxVertices = 8;

/// Clips the polygon to sign * coordinate <= limit (coordinate u if axis 0, v if 1).
RUBBLE_HD inline int clip(ClipVertex (&in)[kMaxVertices], int count, ClipVertex (&out)[kMaxVertices],
                          int axis, Real sign, Real limit, int plane) {
  int n = 0;
  RUBBLE_ROLLED
  for (int i = 0; i < count; ++i) {
    const ClipVertex &p = in[i], &q = in[i + 1 == count ? 0 : i + 1];
    const Real dp = sign * (axis == 0 ? p.u : p.v) - limit, dq = sign * (axis == 0 ? q.u : q.v) - limit;
    const bool keepP = dp <= Real(0), keepQ = dq <= Real(0);
    if (keepP && n < kMaxVertices) out[n++] = p;
    if (keepP != keepQ && n < kMaxVertices) {
      const Real t = dp / (dp - dq);
      ClipVertex& x = out[n++];
      x = {p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), p.w + t * (q.w - p.w), p.edgeOut, p.edgeOut};
      if (keepP)
        x.edgeOut = plane;  // leaves the half space: continues along the side plane
      else
        x.edgeIn = plane;  // returns from the side plane
    }
  }
  return n;
}

/// Reduces `count` vertices to four: the extreme ones along the two diagonals of the reference face, then the
/// deepest one if kDeeperPoint selects it.
RUBBLE_HD inline void reduceToFour(ClipVertex (&p)[kMaxVertices], int& count, Real hu, Real hv, Real length) {
  if (count <= kLanes) return;
  int chosen[kLanes];
  unsigned used = 0;
  RUBBLE_ROLLED
  for (int k = 0; k < kLanes; ++k) {
    const Real su = (k & 1) ? hv : -hv, sv = (k & 2) ? hu : -hu;
    int best = -1;
    Real bestScore = 0;
    RUBBLE_ROLLED
    for (int i = 0; i < count; ++i) {
      const Real score = su * p[i].u + sv * p[i].v;
      if ((used >> i & 1) == 0 && (best < 0 || score > bestScore)) best = i, bestScore = score;
    }
    chosen[k] = best, used |= 1u << best;
  }
  int deepest = 0;
  Real chosenDepth = p[chosen[0]].w;
  RUBBLE_ROLLED
  for (int i = 1; i < count; ++i) deepest = p[i].w < p[deepest].w ? i : deepest;
  for (int k = 1; k < kLanes; ++k) chosenDepth = min(chosenDepth, p[chosen[k]].w);
  if (p[deepest].w < chosenDepth - kDeeperPoint * length) {
    int nearest = 0;
    Real nearestDistance = 0;
    for (int k = 0; k < kLanes; ++k) {
      const Real du = p[chosen[k]].u - p[deepest].u, dv = p[chosen[k]].v - p[deepest].v,
                 d = du * du + dv * dv;
      if (k == 0 || d < nearestDistance) nearest = k, nearestDistance = d;
    }
    chosen[nearest] = deepest;
  }
  ClipVertex out[kLanes];
  for (int k = 0; k < kLanes; ++k) out[k] = p[chosen[k]];
  for (int k = 0; k < kLanes; ++k) p[k] = out[k];
  count = kLanes;
}

}  // namespace boxes

/// Contact points whose gap is at most `margin`. `t` = p_B - p_A; `length` = L.
RUBBLE_HD inline RawManifold collideBoxes(const Vec3& ha, const Quat& qa, const Vec3& hb, const Quat& qb,
                                          const Vec3& t, Real margin, Real length) {
  using namespace boxes;
  RawManifold out;
  const Mat3 ra = rotationMatrix(qa), rb = rotationMatrix(qb);
  const Vec3 axisA[3] = {ra.c0, ra.c1, ra.c2}, axisB[3] = {rb.c0, rb.c1, rb.c2};
  const Real halfA[3] = {ha.x, ha.y, ha.z}, halfB[3] = {hb.x, hb.y, hb.z};
  Real r[3][3], absR[3][3], ta[3], tb[3];
  for (int i = 0; i < 3; ++i) {
    ta[i] = dot(axisA[i], t);
    tb[i] = dot(axisB[i], t);
    for (int j = 0; j < 3; ++j) {
      r[i][j] = dot(axisA[i], axisB[j]);
      absR[i][j] = std::fabs(r[i][j]);
    }
  }

  // faces of A (0-2), then of B (3-5)
  Real bestFace = 0;
  int face = -1;
  for (int i = 0; i < 3; ++i) {
    const Real s = std::fabs(ta[i]) -
                   (halfA[i] + halfB[0] * absR[i][0] + halfB[1] * absR[i][1] + halfB[2] * absR[i][2]);
    if (face < 0 || s > bestFace) bestFace = s, face = i;
  }
  for (int j = 0; j < 3; ++j) {
    const Real s = std::fabs(tb[j]) -
                   (halfB[j] + halfA[0] * absR[0][j] + halfA[1] * absR[1][j] + halfA[2] * absR[2][j]);
    // ties go to faces of A, so that the reference face does not flicker
    if (s > bestFace + Real(1e-3) * length) bestFace = s, face = 3 + j;
  }
  out.separation = bestFace;
  if (bestFace > margin) return out;

  Real bestEdge = 0;
  int edge = -1;
  Real edgeSign = 1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const Real size2 = Real(1) - r[i][j] * r[i][j];  // |a_i x b_j|^2
      if (size2 < kParallelEdges) continue;
      const Real inverse = Real(1) / std::sqrt(size2);
      const Real distance = ta[i2] * r[i1][j] - ta[i1] * r[i2][j];  // t . (a_i x b_j)
      const Real reach = halfA[i1] * absR[i2][j] + halfA[i2] * absR[i1][j] + halfB[j1] * absR[i][j2] +
                         halfB[j2] * absR[i][j1];
      const Real s = (std::fabs(distance) - reach) * inverse;
      if (edge < 0 || s > bestEdge)
        bestEdge = s, edge = 3 * i + j, edgeSign = distance < Real(0) ? Real(-1) : Real(1);
    }
  }
  if (edge >= 0 && bestEdge > margin) {
    out.separation = bestEdge;
    return out;
  }

  const auto edgeContact = [&] {
    const int i = edge / 3, j = edge % 3;
    out.n = normalize(cross(axisA[i], axisB[j]) * edgeSign);
    // a point on each supporting edge, then the closest points of the two edges
    Vec3 pa{0, 0, 0}, pb = t;
    for (int k = 0; k < 3; ++k) {
      if (k != i) pa += axisA[k] * (dot(axisA[k], out.n) > Real(0) ? halfA[k] : -halfA[k]);
      if (k != j) pb += axisB[k] * (dot(axisB[k], out.n) > Real(0) ? -halfB[k] : halfB[k]);
    }
    const Vec3 d = pb - pa;
    const Real da = dot(d, axisA[i]), db = dot(d, axisB[j]), cosine = r[i][j],
               inverse = Real(1) / (Real(1) - cosine * cosine);
    const Real sa = clamp((da - cosine * db) * inverse, -halfA[i], halfA[i]),
               sb = clamp((cosine * da - db) * inverse, -halfB[j], halfB[j]);
    out.count = 1;
    out.points[0] = {pa + axisA[i] * sa, pb + axisB[j] * sb, 0x1000 + edge};
  };
  if (edge >= 0 && bestEdge > kEdgePreference * bestFace + kEdgeMargin * length) {
    edgeContact();
    return out;
  }

  // Face contact. X: reference box, Y: incident box; positions relative to the center of A.
  const bool refB = face >= 3;
  const int axis = refB ? face - 3 : face;
  const Vec3* axisX = refB ? axisB : axisA;
  const Vec3* axisY = refB ? axisA : axisB;
  const Real* halfX = refB ? halfB : halfA;
  const Real* halfY = refB ? halfA : halfB;
  const Vec3 toY = refB ? -t : t;
  const Real side = dot(axisX[axis], toY) < Real(0) ? Real(-1) : Real(1);
  const Vec3 normal = axisX[axis] * side;  // out of X toward Y
  const int iu = (axis + 1) % 3, iv = (axis + 2) % 3;

  int incident = 0;
  Real steepest = -1;
  for (int k = 0; k < 3; ++k) {
    const Real a = std::fabs(dot(axisY[k], normal));
    if (a > steepest) steepest = a, incident = k;
  }
  const Real incidentSide = dot(axisY[incident], normal) > Real(0) ? Real(-1) : Real(1);
  const int ju = (incident + 1) % 3, jv = (incident + 2) % 3;
  const Vec3 centerY = toY +
                       axisY[incident] * (incidentSide * halfY[incident]);  // relative to the center of X
  ClipVertex p[kMaxVertices], q[kMaxVertices];
  for (int k = 0; k < 4; ++k) {
    const Real su = (k == 1 || k == 2) ? halfY[ju] : -halfY[ju], sv = k >= 2 ? halfY[jv] : -halfY[jv];
    const Vec3 x = centerY + axisY[ju] * su + axisY[jv] * sv;
    p[k] = {dot(x, axisX[iu]), dot(x, axisX[iv]), dot(x, normal) - halfX[axis], (k + 3) % 4, k};
  }
  int count = 4;
  // there and back for each axis
  RUBBLE_ROLLED
  for (int k = 0; k < 2; ++k) {
    const Real limit = halfX[k == 0 ? iu : iv];
    count = clip(p, count, q, k, Real(1), limit, 4 + 2 * k);
    count = clip(q, count, p, k, Real(-1), limit, 5 + 2 * k);
  }
  int kept = 0;
  for (int k = 0; k < count; ++k)
    if (p[k].w <= margin) p[kept++] = p[k];
  count = kept;
  if (count == 0 && edge >= 0) {
    // the incident face misses the reference face: two edges cross
    edgeContact();
    return out;
  }
  reduceToFour(p, count, halfX[iu], halfX[iv], length);

  const Vec3 centerX = refB ? t : Vec3{0, 0, 0};
  out.n = refB ? -normal : normal;
  out.normalOnB = refB;
  out.count = count;
  for (int k = 0; k < count; ++k) {
    const Vec3 onX = centerX + axisX[iu] * p[k].u + axisX[iv] * p[k].v + normal * halfX[axis];
    const Vec3 onY = onX + normal * p[k].w;
    const int feature = ((face * 2 + (side > Real(0))) * 6 + incident * 2 + (incidentSide > Real(0))) * 64 +
                        p[k].edgeIn * 8 + p[k].edgeOut;
    out.points[k] = {refB ? onY : onX, refB ? onX : onY, feature};
  }
  return out;
}

}  // namespace rubble::RUBBLE_CORE

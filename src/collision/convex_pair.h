#pragma once
/// Narrow phase of any two convex shapes. Separating axes are the faces of both and the direction of gjk.h;
/// near ties go to faces. A face contact clips the incident feature to at most four points. Otherwise
/// parallel edges give two points, and all else one.
#include "collision/box_box.h"
#include "collision/gjk.h"

namespace rubble::RUBBLE_CORE {

/// Most vertices of a feature while it is clipped.
inline constexpr int kMaxCut = 2 * kMaxCorners;
/// Edges count as parallel up to this sine of the angle between them.
inline constexpr Real kParallelSides = Real(.05);
/// Heights within this share of L count as equal.
inline constexpr Real kSameHeight = Real(1e-3);

namespace convex {

/// A vertex of the clipped incident feature. `w`: height over the reference face. Edge numbers: 0-31 incident
/// edges, 32-63 reference edges.
struct CutVertex {
  Vec3 x;
  Real w;
  int from, to;
};

template <int kSize> struct CutOf {
  CutVertex v[kSize];
  int count = 0;
};
using Cut = CutOf<kMaxCut>;

RUBBLE_HD inline CutVertex between(const CutVertex& p, const CutVertex& q, Real t) {
  return {p.x + (q.x - p.x) * t, p.w + (q.w - p.w) * t, p.to, p.to};
}

/// Clips a polygon to d <= 0 of a plane.
RUBBLE_HD inline void cutByPlane(Cut& in, Cut& out, const Vec3& n, Real offset, int plane) {
  out.count = 0;
  for (int i = 0; i < in.count; ++i) {
    const CutVertex &p = in.v[i], &q = in.v[i + 1 == in.count ? 0 : i + 1];
    const Real dp = dot(n, p.x) - offset, dq = dot(n, q.x) - offset;
    const bool keepP = dp <= Real(0), keepQ = dq <= Real(0);
    if (keepP && out.count < kMaxCut) out.v[out.count++] = p;
    // an edge feature is traversed in both directions; only the first one is clipped
    if (keepP == keepQ || out.count >= kMaxCut) continue;
    CutVertex& x = out.v[out.count++];
    x = between(p, q, dp / (dp - dq));
    if (keepP)
      x.to = plane;
    else
      x.from = plane;
  }
}

/// Clips the incident feature to the side planes of the reference face.
RUBBLE_HD inline void cutToFace(const Feature& face, const Feature& incident, Real slack, Cut& result) {
  Cut other;
  Cut *in = &result, *out = &other;
  for (int k = 0; k < incident.count; ++k)
    in->v[k] = {incident.corner[k], dot(face.normal, incident.corner[k] - face.corner[0]),
                (k + incident.count - 1) % incident.count, k};
  in->count = incident.count;
  for (int k = 0; k < face.count && in->count > 0; ++k) {
    const Vec3 a = face.corner[k], b = face.corner[k + 1 == face.count ? 0 : k + 1];
    const Vec3 side = normalize(cross(b - a, face.normal), Vec3{0, 0, 0});
    const Real offset = dot(side, a) + slack;
    if (incident.count >= 3) {
      cutByPlane(*in, *out, side, offset, 32 + k);
      Cut* const swapped = in;
      in = out, out = swapped;
      continue;
    }
    // incident feature is a corner or an edge
    Real d[2];
    for (int i = 0; i < in->count; ++i) d[i] = dot(side, in->v[i].x) - offset;
    if (in->count == 1) {
      if (d[0] > Real(0)) in->count = 0;
      continue;
    }
    if (d[0] > Real(0) && d[1] > Real(0)) {
      in->count = 0;
    } else if (d[0] > Real(0) || d[1] > Real(0)) {
      const int cut = d[0] > Real(0) ? 0 : 1;
      const int to = in->v[cut].to;
      in->v[cut] = between(in->v[0], in->v[1], d[0] / (d[0] - d[1]));
      in->v[cut].from = 32 + k, in->v[cut].to = to;
    }
  }
  if (in != &result) result = *in;
}

/// Scores within this share of L count as equal; the first vertex wins.
inline constexpr Real kSameReach = Real(1e-4);

/// Index of the vertex with the highest score; among scores within `same` the first one.
template <int kSize, class Score> RUBBLE_HD int bestVertex(const CutOf<kSize>& c, Real same, Score&& score) {
  int best = 0;
  Real most = score(c.v[0].x);
  for (int i = 1; i < c.count; ++i) {
    const Real s = score(c.v[i].x);
    if (s > most + same) best = i, most = s;
  }
  return best;
}

/// Direction in which the weight of the upper body loads a contact, in the contact plane. `from`: its center
/// of mass projected onto the plane; `along`: unit, or zero if the load is centered.
struct LoadedSide {
  Vec3 from, along;
};

/// Vertices this close to the load direction, relative to their distance, lie on it and bear the whole load.
inline constexpr Real kOnLoadedSide = Real(.02);

template <int kSize>
RUBBLE_HD LoadedSide loadedSide(const CutOf<kSize>& c, const Vec3& n, const Weight& weight) {
  Vec3 foot;
  if (c.count <= 1 || !footOfWeight(weight, n, c.v[0].x, foot)) return {{0, 0, 0}, {0, 0, 0}};
  const Vec3& center = dot(weight.down, n) > Real(0) ? weight.centerA : weight.centerB;
  const Vec3 from = center + n * dot(n, c.v[0].x - center), way = foot - from;
  Real reach2 = 0;
  for (int k = 0; k < c.count; ++k) reach2 = max(reach2, lengthSquared(c.v[k].x - from));
  return {from, lengthSquared(way) > kOffMiddle * kOffMiddle * reach2 ? normalize(way) : Vec3{0, 0, 0}};
}

/// Four distinct vertices, extreme along the diagonals of a frame fixed to the face.
template <int kSize>
RUBBLE_HD void chooseByDiagonals(const CutOf<kSize>& c, const Vec3& normal, Real same,
                                 int (&chosen)[kLanes]) {
  Vec3 t1, t2;
  tangentBasis(normal, t1, t2);
  unsigned used = 0;
  for (int k = 0; k < kLanes; ++k) {
    // Not the diagonals of a square: disc corners lie symmetric to those, and round-off would decide their
    // order.
    const Vec3 d = t1 * ((k & 1) ? Real(1) : Real(-1)) + t2 * ((k & 2) ? Real(.8) : Real(-.8));
    int best = -1;
    Real most = 0;
    for (int i = 0; i < c.count; ++i) {
      const Real along = dot(d, c.v[i].x);
      if (!(used >> i & 1) && (best < 0 || along > most + same)) best = i, most = along;
    }
    used |= 1u << best;
    chosen[k] = best;
  }
}

/// Four vertices of an off-center load: the furthest along the load direction, the other end of the edge over
/// which the bodies would tip, and two that add most area.
template <int kSize>
RUBBLE_HD void chooseByLoad(const CutOf<kSize>& c, const Vec3& normal, const LoadedSide& side, Real same,
                            Real length, int (&chosen)[kLanes]) {
  const Vec3 &first = side.along, aside = cross(normal, first);
  chosen[0] = bestVertex(c, same, [&](const Vec3& x) { return dot(first, x); });
  const Vec3 a = c.v[chosen[0]].x;
  const Real offA = dot(aside, a - side.from), outA = dot(first, a - side.from);
  if (std::fabs(offA) > kOnLoadedSide * outA) {
    // distance at which the line to the first vertex crosses the load direction
    chosen[1] = bestVertex(c, same, [&](const Vec3& x) {
      const Real off = dot(aside, x - side.from);
      return off * offA < Real(0) ? outA + (dot(first, x - side.from) - outA) * offA / (offA - off) : -length;
    });
  } else {
    chosen[1] = bestVertex(c, same, [&](const Vec3& x) { return lengthSquared(x - a) / length; });
  }
  const Vec3 b = c.v[chosen[1]].x, across = normalize(cross(normal, b - a), aside);
  chosen[2] = bestVertex(c, same, [&](const Vec3& x) { return std::fabs(dot(across, x - a)); });
  const Vec3 d = c.v[chosen[2]].x;
  const Real turn = dot(across, d - a) > Real(0) ? Real(-1) : Real(1);
  const auto beyond = [&](const Vec3& p, const Vec3& q, const Vec3& x) {
    return turn * dot(cross(normal, q - p), x - p);
  };
  chosen[3] = bestVertex(c, same * same, [&](const Vec3& x) {
    return max(beyond(a, b, x), max(beyond(b, d, x), beyond(d, a, x)));
  });
}

/// Reduces to at most four vertices with height <= `reach`: those that bear an off-center load, or extreme
/// ones, and the deepest one if kDeeperPoint selects it.
template <int kSize>
RUBBLE_HD void pickFour(CutOf<kSize>& c, const Vec3& normal, const LoadedSide& side, Real reach,
                        Real length) {
  int kept = 0;
  for (int k = 0; k < c.count; ++k)
    if (c.v[k].w <= reach) c.v[kept++] = c.v[k];
  c.count = kept;
  if (c.count <= kLanes) return;
  int chosen[kLanes];
  if (dot(side.along, side.along) > Real(0))
    chooseByLoad(c, normal, side, kSameReach * length, length, chosen);
  else
    chooseByDiagonals(c, normal, kSameReach * length, chosen);

  int deepest = 0;
  for (int i = 1; i < c.count; ++i) deepest = c.v[i].w < c.v[deepest].w ? i : deepest;
  CutVertex picked[kLanes];
  Real depth = c.v[chosen[0]].w;
  for (int k = 0; k < kLanes; ++k) picked[k] = c.v[chosen[k]], depth = min(depth, picked[k].w);
  if (c.v[deepest].w < depth - kDeeperPoint * length) {
    int nearest = 0;
    Real least = 0;
    for (int k = 0; k < kLanes; ++k) {
      const Real d2 = lengthSquared(picked[k].x - c.v[deepest].x);
      if (k == 0 || d2 < least) nearest = k, least = d2;
    }
    picked[nearest] = c.v[deepest];
  }
  c.count = 0;
  for (int k = 0; k < kLanes; ++k) {
    bool again = false;
    for (int j = 0; j < k; ++j) again |= chosen[j] == chosen[k];
    if (!again) c.v[c.count++] = picked[k];
  }
}

/// Transforms a feature of B to the frame of A.
RUBBLE_HD inline void place(Feature& f, const ConvexPair& p) {
  for (int k = 0; k < f.count; ++k) f.corner[k] = p.at + p.turn * f.corner[k];
  f.normal = p.turn * f.normal;
}

struct BestFace {
  int face = -1;
  bool onB = false;
  Real s = 0;
};

/// The face with the largest separation; near ties go to A. Returns early once a separation exceeds `enough`.
RUBBLE_HD inline BestFace bestFace(const ConvexPair& p, Real enough) {
  BestFace best;
  const int ofA = faceCount(p.a), ofB = faceCount(p.b);
  for (int i = 0; i < ofA; ++i) {
    const Vec4 plane = facePlane(p.a, i);
    const Real s = dot(xyz(plane), supportOfB(p, -xyz(plane))) - plane.w;
    if (best.face >= 0 && !(s > best.s)) continue;
    best = {i, false, s};
    if (s > enough) return best;
  }
  for (int i = 0; i < ofB; ++i) {
    const Vec4 plane = facePlane(p.b, i);
    const Vec3 n = p.turn * xyz(plane);
    const Real s = -dot(n, p.at) - plane.w + dot(n, support(p.a, -n));
    if (best.face >= 0 && !(s > best.s + (best.onB ? Real(0) : Real(1e-3) * p.length))) continue;
    best = {i, true, s};
    if (s > enough) return best;
  }
  return best;
}

/// Contact points of a face contact, in the frame of A. `lowest`: height of the lowest vertex over the face.
RUBBLE_HD inline void faceContact(const ConvexPair& p, const BestFace& best, Real margin, RawManifold& out,
                                  Real& lowest) {
  const Convex &reference = best.onB ? p.b : p.a, &other = best.onB ? p.a : p.b;
  const Vec3 local = xyz(facePlane(reference, best.face));
  const Vec3 normal = best.onB ? p.turn * local : local;  // out of the reference face, frame of A
  const Vec3 towards = best.onB ? normal * Real(-1) : mulTransposed(p.turn, -normal);
  out.n = best.onB ? -normal : normal;
  const Vec3 level = best.onB ? p.at + p.turn * (local * facePlane(reference, best.face).w)
                              : normal * facePlane(reference, best.face).w;
  Vec3 foot;
  const bool loaded = footOfWeight(p.weight, out.n, level, foot);
  const Vec3 onA = loaded ? foot : Vec3{0, 0, 0},
             onB = loaded ? mulTransposed(p.turn, foot - p.at) : Vec3{0, 0, 0};
  // without load, the first corner of a disc points toward the other shape
  const Vec3 lies = best.onB ? mulTransposed(p.turn, -p.at) : p.at;
  Feature face, incident;
  faceFeature(reference, best.face, {0, 0, 0}, loaded ? (best.onB ? onB : onA) : lies, face);
  featureAlong(other, towards, best.onB ? onA : onB, kSameHeight * p.length, incident);
  place(best.onB ? face : incident, p);
  Cut cut;
  cutToFace(face, incident, Real(1e-6) * p.length, cut);
  lowest = Real(1e30);
  for (int k = 0; k < cut.count; ++k) lowest = min(lowest, cut.v[k].w);
  const Real radii = p.a.radius + p.b.radius;
  pickFour(cut, normal, loadedSide(cut, out.n, p.weight), margin + radii, p.length);
  out.normalOnB = best.onB;
  out.count = cut.count;
  for (int k = 0; k < cut.count; ++k) {
    const CutVertex& v = cut.v[k];
    const Vec3 onOther = v.x - normal * other.radius, onFace = v.x - normal * (v.w - reference.radius);
    // corners use their feature ids, which persist when the faces change
    const bool corner = v.from < 32 && v.to < 32;
    const int name = corner ? incident.id[v.to] : 0x800 | v.from << 6 | v.to;
    out.points[k] = {best.onB ? onOther : onFace, best.onB ? onFace : onOther,
                     name | (best.onB ? 0x1000 : 0)};
  }
}

/// Contact without a reference face: two points for parallel edges, else one.
RUBBLE_HD inline void edgeContact(const ConvexPair& p, const SeparatingDirection& x, Real margin,
                                  RawManifold& out) {
  const Real radii = p.a.radius + p.b.radius;
  out.n = x.n;
  out.normalOnB = false;
  out.count = 0;
  const auto add = [&](const Vec3& a, const Vec3& b, int feature) {
    if (dot(x.n, b - a) - radii > margin) return;
    out.points[out.count++] = {a + x.n * p.a.radius, b - x.n * p.b.radius, feature};
  };
  Feature fa, fb;
  featureAlong(p.a, x.n, {0, 0, 0}, kSameHeight * p.length, fa);
  featureAlong(p.b, mulTransposed(p.turn, -x.n), {0, 0, 0}, kSameHeight * p.length, fb);
  place(fb, p);
  if (fa.count == 2 && fb.count == 2) {
    const Vec3 da = fa.corner[1] - fa.corner[0], db = fb.corner[1] - fb.corner[0];
    const Real aa = dot(da, da), bb = dot(db, db);
    const Vec3 across = cross(da, db);
    if (dot(across, across) < kParallelSides * kParallelSides * aa * bb) {
      Real t0 = dot(fb.corner[0] - fa.corner[0], da) / aa, t1 = dot(fb.corner[1] - fa.corner[0], da) / aa;
      const Real lo = max(Real(0), min(t0, t1)), hi = min(Real(1), max(t0, t1));
      if (hi - lo > Real(.05)) {
        for (int k = 0; k < 2; ++k) {
          const Vec3 a = fa.corner[0] + da * (k == 0 ? lo : hi);
          const Real u = clamp(dot(a - fb.corner[0], db) / bb, Real(0), Real(1));
          const Vec3 b = fb.corner[0] + db * u;
          // the same position in the contact plane on both shapes
          add(a, a + x.n * dot(x.n, b - a), 0x2001 + k);
        }
        if (out.count > 0) return;
      }
    }
  }
  add(x.onA, x.onB, 0x2000);
}

}  // namespace convex

/// Contact points whose gap is at most `margin`. `t` = p_B - p_A; the weight is relative to p_A.
RUBBLE_HD inline RawManifold collideConvex(const Convex& a, const Quat& qa, const Convex& b, const Quat& qb,
                                           const Vec3& t, Real margin, Real length, const Weight& weight) {
  using namespace convex;
  const Weight own{rotateInverse(qa, weight.centerA), rotateInverse(qa, weight.centerB),
                   rotateInverse(qa, weight.down)};
  const Quat q = conjugate(qa) * qb;
  const ConvexPair p{a, b, q, rotationMatrix(q), rotateInverse(qa, t), length, own};
  const Real radii = a.radius + b.radius;
  RawManifold out;
  const auto told = [&] {
    out.n = rotate(qa, out.n);
    for (int k = 0; k < out.count; ++k)
      out.points[k].onA = rotate(qa, out.points[k].onA), out.points[k].onB = rotate(qa, out.points[k].onB);
    return out;
  };

  const BestFace face = bestFace(p, margin + radii);
  Vec3 start = normalize(p.at);
  if (face.face >= 0) {
    out.separation = face.s - radii;
    if (out.separation > margin) return out;
    Real lowest;
    faceContact(p, face, margin, out, lowest);
    // The face separation equals the distance, or the shapes overlap so little that no edge can be preferred.
    // GJK is not needed then.
    const bool exact = lowest <= face.s + kSameHeight * length;
    if (out.count > 0 && exact && kEdgePreference * face.s + kEdgeMargin * length > Real(0)) return told();
    start = out.n;
  }
  const SeparatingDirection x = mostSeparating(p, start);
  if (x.s - radii > margin) {
    out.count = 0;
    out.separation = x.s - radii;
    return out;
  }
  if (face.face < 0 || out.count == 0 || x.s > kEdgePreference * face.s + kEdgeMargin * length)
    edgeContact(p, x, margin, out);
  return told();
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Contacts of the corners of bodies with surfaces of deformable objects. They complement vertex-body
/// contacts, which miss a corner between the vertices.
///
/// A corner has a contact with the nearest feature of a surface: a triangle, an edge or a vertex. A body has
/// kCornerSlots owners of pairs, each of which represents a share of its corners. An owner of several corners
/// has two rows per feature, one for each half of the corners, and a row acts on the deepest corner of its
/// half. Corners that are far apart must not share a row, because supporting one of them would let the other
/// fall.
///
/// Sheets have two sides. A corner stays on the side of the previous step as long as it touches; a closed
/// surface has an outside. The contact normal must also agree with the outward direction of the body at the
/// corner. A normal that does not agree comes from an adjacent part of a folded sheet and is rejected.
#include "collision/corners.h"
#include "stages/contacts/one_way.h"
#include "stages/pairs/filter.h"
#include "stages/soft/feature_contacts.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int bodyOfOwner(const SolverData& s, int owner) {
  return (owner - s.vertices - s.edges) / kCornerSlots;
}
RUBBLE_HD inline int slotOfOwner(const SolverData& s, int owner) {
  return (owner - s.vertices - s.edges) % kCornerSlots;
}

/// Is the vertex attached to that body? Attached vertices and bodies do not collide.
RUBBLE_HD inline bool isAttached(const SolverData& s, int v, int body) {
  bool attached = false;
  visitAttachments(s, v, [&](const Attachment& a) {
    attached |= active(s, a) && a.isVertexVertex == 0 && a.body == body;
  });
  return attached;
}

/// To the filters of bodies a vertex counts as a body without a filter.
RUBBLE_HD inline bool mayMeet(const SolverData& s, int v, int body) {
  if (s.filtered && (isSensor(s, body) || !filtersAllow(s.filter[body], {1, ~0u, 0, 0}))) return false;
  return isDynamicVertex(s, v) || s.params[body].kind == BodyKind::Dynamic;
}
RUBBLE_HD inline bool mayTouch(const SolverData& s, int v, int body) {
  return mayMeet(s, v, body) && !isAttached(s, v, body);
}

/// May corners of a body touch that feature?
RUBBLE_HD inline bool mayTouchSurface(const SolverData& s, int body, const SurfaceFeature& f) {
  if ((s.vertexParams[f.v[0]].collides & kCollidesWithBodies) == 0) return false;
  const int corners = cornersOf(f);
  bool any = false;
  for (int k = 0; k < corners; ++k) {
    if (isAttached(s, f.v[k], body)) return false;
    any |= mayMeet(s, f.v[k], body);
  }
  return any;
}

/// A sheet has no inside, so a body that tunnels through it is lost. The velocities at x^t miss two motions.
/// First, stopping one corner of a body rotates it, so that other corners move farther by up to this factor
/// [1]. An example is the free end of a rod whose other end stops.
inline constexpr Real kTipping = Real(1.5);
/// Second, a body that begins to fall moves this far [m].
RUBBLE_HD inline Real fallInStep(const StepConstants& c) { return c.dt * c.dt * length(c.gravity); }

/// Flags bodies whose boxes touch that of a feature; the corners of all other bodies need no search.
struct FindDentingBodies {
  static constexpr const char* kStage = "pairs";
  RUBBLE_HD void operator()(const SolverData& s, int body) const {
    s.nearSurface[body] = isActive(s, body, 0, 1) ? 1 : 0;
  }

  /// Share of worker `lane` of `lanes`.
  RUBBLE_HD static bool isActive(const SolverData& s, int body, int lane, int lanes) {
    if (s.bounds[body].level < 0) return false;
    const Real way = s.step->dt *
                     (length(s.velocity[body]) + length(s.angularVelocity[body]) * s.params[body].radius);
    const Real more = (kTipping - Real(1)) * way + fallInStep(s.stepOf(body));
    const SweptBox box{s.bounds[body].center, s.bounds[body].half + Vec3{more, more, more}};
    bool found = false;
    const auto look = [&](int i) { found = found || mayTouchSurface(s, body, s.feature[i]); };
    seekFeatures(s, s.worldOf(body), FeatureKind::BareEdge, box, look, lane, lanes);
    seekFeatures(s, s.worldOf(body), FeatureKind::Triangle, box, look, lane, lanes);
    return found;
  }
};

/// A corner of a body at x^t, world axes, relative to the body's center.
struct PlacedCorner {
  Vec3 at, velocity;  ///< [m], [m/s]
  Vec3 outward;       ///< outward direction of the body at the corner; zero: all directions
  Real radius;        ///< [m]
  int part;
};

/// visit(corner) for a range of corners of a body.
template <class Visit>
RUBBLE_HD void visitCornersOf(const SolverData& s, int body, const CornerRange& range, Visit&& visit) {
  const Quat q = s.orientation[body];
  visitCorners(s.shapeTables(), s.params[body].shape, range, [&](const ShapeCorner& c) {
    const Vec3 at = rotate(q, c.at);
    visit(PlacedCorner{at, s.velocity[body] + cross(s.angularVelocity[body], at), rotate(q, c.outward),
                       c.radius, c.part});
  });
}
/// The corners that an owner represents.
RUBBLE_HD inline CornerRange ownCorners(const SolverData& s, int owner) {
  return cornerShare(s.shapeTables(), s.params[bodyOfOwner(s, owner)].shape, slotOfOwner(s, owner),
                     kCornerSlots);
}
/// Number of rows that an owner has per feature.
RUBBLE_HD inline int rowsWithPart(const SolverData& s, int owner) {
  if (owner < s.vertices + s.edges) return 1;
  const CornerRange own = ownCorners(s, owner);
  return own.end - own.begin > 1 ? 2 : 1;
}
/// visit(corner) for the corners that one of these rows represents.
template <class Visit>
RUBBLE_HD void visitCornersOfRow(const SolverData& s, int owner, int row, Visit&& visit) {
  CornerRange own = ownCorners(s, owner);
  if (const int middle = (own.begin + own.end) / 2; own.end - own.begin > 1)
    (row == 0 ? own.end : own.begin) = middle;
  visitCornersOf(s, bodyOfOwner(s, owner), own, visit);
}
/// Index of pair i among the rows of its owner with the same feature.
RUBBLE_HD inline int rowOfPair(const PointPair* pair, int i) {
  return i > 0 && pair[i - 1].vertex == pair[i].vertex && pair[i - 1].other == pair[i].other ? 1 : 0;
}

/// A triangle, edge or vertex of a surface.
struct SurfacePart {
  int v[3], count;
  bool rim;  ///< a boundary edge
};
/// `part`: as PointPair::other.
RUBBLE_HD inline SurfacePart surfacePart(const SolverData& s, int part) {
  SurfacePart p{{-1, -1, -1}, 0, false};
  p.count = partCorners(s, part, p.v);
  if (p.count == 2) {
    const SurfaceFeature& f = s.feature[part - kFeatureNode];
    p.rim = f.kind == FeatureKind::Edge && (f.opposite[0] < 0 || f.opposite[1] < 0);
  }
  return p;
}

/// A corner against a feature.
struct CornerTouch {
  bool valid;     ///< the feature is the nearest, and the corner is within `behind` of its front side
  Vec3 n;         ///< from the surface to the corner, unit
  Real distance;  ///< of the corner from the surface; negative behind it [m]
  Real w[3];      ///< barycentric weights of the nearest point
  Vec3 foot;      ///< nearest point relative to the center of the body [m]
};

/// May a surface push a corner along n, that is, into the body? The tolerance accounts for a surface that
/// bends about a corner.
RUBBLE_HD inline bool mayPush(const PlacedCorner& corner, const Vec3& n) {
  constexpr Real kDoubt = Real(.3);
  return dot(n, corner.outward) <= kDoubt;
}
/// `side`: direction in which the surface held the corner last, or zero. `behind`: largest distance behind
/// the surface at which it is still held [m].
RUBBLE_HD inline CornerTouch touchPart(const SolverData& s, int body, const PlacedCorner& corner,
                                       const SurfacePart& f, const Vec3& side, Real behind) {
  CornerTouch t;
  t.valid = false;
  Vec3 x[3];
  for (int k = 0; k < f.count; ++k) x[k] = Vec3(s.vertexPosition[f.v[k]] - s.position[body]);
  const bool held = side != Vec3{0, 0, 0} && mayPush(corner, side);
  if (f.count == 3) {
    nearestOnTriangle(corner.at, x[0], x[1], x[2], t.w);
    if (!(t.w[0] > Real(0) && t.w[1] > Real(0) && t.w[2] > Real(0))) return t;
    const Vec3 normal = cross(x[1] - x[0], x[2] - x[0]);
    const Real size = length(normal);
    if (!(size > Real(0))) return t;
    t.n = normal / size;
    const bool closed = (s.vertexParams[f.v[0]].collides & kHasInside) != 0;
    const Real facing = held ? dot(t.n, side) : dot(t.n, corner.at - x[0]);
    if (!closed && facing < Real(0)) t.n = -t.n;
    t.foot = x[0] + t.w[1] * (x[1] - x[0]) + t.w[2] * (x[2] - x[0]);
    t.distance = dot(t.n, corner.at - x[0]);
    t.valid = t.distance >= -behind && mayPush(corner, t.n);
    return t;
  }
  t.w[0] = Real(1), t.w[1] = t.w[2] = 0;
  t.foot = x[0];
  if (f.count == 2) {
    Real w[2];
    nearestOnSegment(corner.at, x[0], x[1], w);
    if (!(w[0] > Real(0) && w[1] > Real(0))) return t;
    t.w[0] = w[0], t.w[1] = w[1];
    t.foot = x[0] + w[1] * (x[1] - x[0]);
  }
  const Vec3 gap = corner.at - t.foot;
  t.distance = length(gap);
  t.n = t.distance > Real(0) ? gap / t.distance : side;
  if (held && dot(t.n, side) < Real(0)) {
    // A corner cannot be behind a boundary edge. One that is beside an edge or vertex rather than behind it
    // is behind another feature.
    constexpr Real kRightBehind = Real(-.7);
    if (f.rim || dot(t.n, side) > kRightBehind) return t;
    t.n = -t.n, t.distance = -t.distance;
  }
  t.valid = t.n != Vec3{0, 0, 0} && t.distance >= -behind && mayPush(corner, t.n);
  return t;
}

/// Side on which a feature that shares a vertex with this one held the owner.
struct HeldSide {
  Vec3 side;    ///< from the surface to the body, or zero
  Real behind;  ///< [m]
};
RUBBLE_HD inline HeldSide heldSide(const SolverData& s, int owner, const SurfacePart& f) {
  HeldSide out{{0, 0, 0}, 0};
  for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k) {
    const PointContact& old = s.oldPointContact[k];
    if (s.oldPointPair[k].other < 0 || !old.active) continue;
    int shared = 0;
    for (int i = 0; i < f.count; ++i)
      for (int j = 0; j < kPointCorners && old.v[j] >= 0; ++j) shared += old.v[j] == f.v[i] ? 1 : 0;
    if (shared == 0) continue;
    out = {-old.n, old.length};
    // the feature itself
    if (shared == f.count) return out;
  }
  return out;
}

/// L of a contact between a body and a surface: that of the smaller one [m].
RUBBLE_HD inline Real surfaceContactLength(const SolverData& s, int body, const SurfacePart& f) {
  const Real own = s.vertexParams[f.v[0]].length;
  return s.params[body].kind == BodyKind::Dynamic ? min(own, 2 * s.params[body].radius) : own;
}
RUBBLE_HD inline Vec3 partVelocity(const SolverData& s, const SurfacePart& f, const Real (&w)[3]) {
  Vec3 sum{0, 0, 0};
  for (int k = 0; k < f.count; ++k) sum += w[k] * s.vertexVelocity[f.v[k]];
  return sum;
}

/// A corner against a feature, with its gap and detection margin in this step.
struct CornerReach {
  CornerTouch touch;
  Real gap, margin;  ///< [m]
};
RUBBLE_HD inline CornerReach reachPart(const SolverData& s, int body, const PlacedCorner& corner,
                                       const SurfacePart& f, const HeldSide& held) {
  const Real size = surfaceContactLength(s, body, f);
  CornerReach out;
  out.touch.w[0] = out.touch.w[1] = out.touch.w[2] = Real(1) / static_cast<Real>(f.count);
  const Real fast = s.step->dt * length(corner.velocity - partVelocity(s, f, out.touch.w));
  out.touch = touchPart(s, body, corner, f, held.side, max(held.behind, max(fast, kHeldFromBelow * size)));
  out.gap = out.touch.distance - corner.radius - s.vertexParams[f.v[0]].radius;
  const Real there = s.step->dt * length(corner.velocity - partVelocity(s, f, out.touch.w));
  out.margin = max(s.step->contactMargin * size, kTipping * max(fast, there) + fallInStep(s.stepOf(body)));
  return out;
}

/// found(part) for every feature that a corner of this owner may touch in this step; share of worker `lane`
/// of `lanes`.
template <class Found>
RUBBLE_HD void searchCorners(const SolverData& s, int owner, Found&& found, int lane, int lanes) {
  const int body = bodyOfOwner(s, owner);
  if (s.nearSurface[body] == 0) return;
  Real behind = 0;
  for (int k = s.oldPointPairOffset[owner]; k < s.oldPointPairOffset[owner + 1]; ++k)
    if (s.oldPointPair[k].other >= 0 && s.oldPointContact[k].active)
      behind = max(behind, s.oldPointContact[k].length);
  visitCornersOf(s, body, ownCorners(s, owner), [&](const PlacedCorner& corner) {
    const Vec3 from = Vec3(s.position[body]) + corner.at,
               sweep = (kTipping * s.step->dt / 2) * corner.velocity;
    const Real roundOff = Real(2.4e-7) * (std::fabs(from.x) + std::fabs(from.y) + std::fabs(from.z));
    const Real grow = corner.radius + max(behind, ownMargin(s, s.params[body])) + fallInStep(s.stepOf(body)) +
                      roundOff;
    const SweptBox box{from + sweep, abs(sweep) + Vec3{grow, grow, grow}};
    const auto look = [&](int i) {
      const SurfaceFeature& f = s.feature[i];
      if (!mayTouchSurface(s, body, f)) return;
      int part = kFeatureNode + i;
      if (f.kind == FeatureKind::Triangle) {
        Real w[3];
        Vec3 x[3];
        for (int k = 0; k < 3; ++k) x[k] = Vec3(s.vertexPosition[f.v[k]] - s.position[body]);
        nearestOnTriangle(corner.at, x[0], x[1], x[2], w);
        int used = 0, last = 0, unused = 0;
        for (int k = 0; k < 3; ++k) {
          if (w[k] > Real(0))
            ++used, last = k;
          else
            unused = k;
        }
        // the corners other than `unused` are k and k + 1
        if (used == 2) part = kFeatureNode + f.edge[(unused + 1) % 3];
        if (used == 1) part = kCornerNode + f.v[last];
      }
      const SurfacePart nearest = surfacePart(s, part);
      const CornerReach r = reachPart(s, body, corner, nearest, heldSide(s, owner, nearest));
      if (r.touch.valid && r.gap <= r.margin) found(part);
    };
    seekFeatures(s, s.worldOf(body), FeatureKind::BareEdge, box, look, lane, lanes);
    seekFeatures(s, s.worldOf(body), FeatureKind::Triangle, box, look, lane, lanes);
  });
}

/// A row between the corners of an owner (A) and a feature (B), at the deepest corner of the row. Fills the
/// geometry and returns the initial values.
RUBBLE_HD inline PointContactStart touchCorner(const SolverData& s, int owner, int other, int row,
                                               PointContact& p, Real& gap, Real& margin) {
  const int body = bodyOfOwner(s, owner);
  const BodyParams& b = s.params[body];
  const SurfacePart f = surfacePart(s, other);
  const HeldSide held = heldSide(s, owner, f);
  PlacedCorner corner{};
  CornerReach best{};
  best.gap = Real(1e18), best.margin = -1, best.touch.valid = false;
  visitCornersOfRow(s, owner, row, [&](const PlacedCorner& c) {
    const CornerReach r = reachPart(s, body, c, f, held);
    if (r.touch.valid && r.gap < best.gap) best = r, corner = c;
  });
  const VertexParams& point = s.vertexParams[f.v[0]];
  gap = best.gap, margin = best.touch.valid ? best.margin : best.gap - Real(1);
  p.body = body;
  p.part = corner.part;
  p.n = -best.touch.n;
  p.length = surfaceContactLength(s, body, f);
  // at the middle of the gap
  p.lever = (corner.at - corner.radius * best.touch.n + best.touch.foot + point.radius * best.touch.n) *
            Real(.5);
  Real rowMass = b.mass;
  for (int k = 0; k < kPointCorners; ++k) p.v[k] = -1, p.weight[k] = 0;
  int used = 0;
  for (int k = 0; k < f.count; ++k) {
    const Real w = best.touch.w[k];
    if (w == Real(0)) continue;
    p.v[used] = f.v[k], p.weight[used++] = -w;
    const Real mass = s.vertexParams[f.v[k]].mass / (w * w);
    if (mass > Real(0)) rowMass = rowMass > Real(0) ? min(rowMass, mass) : mass;
  }
  // an inactive row still needs a valid vertex
  if (used == 0) p.v[0] = f.v[0];
  return {rowMass, -gap, dot(p.n, corner.velocity - partVelocity(s, f, best.touch.w)),
          setMaterial(s, p, surfaceOf(s, body, corner.part), surfaceOf(point))};
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Contacts between surfaces: which features are near, and the rows of such a pair. A vertex has one contact
/// with the nearest feature of a surface, a triangle, an edge or a vertex, so a vertex shared by many
/// triangles gives only one contact. Edges have a contact with each other where they cross in their
/// interiors.
#include "solver/warmstart.h"
#include "stages/contacts/materials.h"
#include "stages/soft/features.h"

namespace rubble::RUBBLE_CORE {

/// Vertices of the two sides of a pair at x^t, and their nearest points.
struct NearParts {
  int v[kPointCorners];   ///< side A first
  int sideA, count;       ///< vertices of side A; of both sides
  Vec3 x[kPointCorners];  ///< relative to the first vertex [m]
  Real c[kPointCorners];  ///< weights, see collision/features.h
  Vec3 gap;               ///< p_A - p_B [m]
};

/// Nearest points of a vertex and a vertex, edge or triangle, or of two edges, for the given vertices.
RUBBLE_HD inline void findNearest(NearParts& p) {
  p.c[0] = Real(1);
  if (p.sideA == 2 || p.count == 4) {
    p.gap = nearestOfFeatures(p.x, p.sideA, p.c);
  } else if (p.count == 3) {
    Real w[2];
    nearestOnSegment(p.x[0], p.x[1], p.x[2], w);
    p.c[1] = -w[0], p.c[2] = -w[1];
    p.gap = (p.x[0] - p.x[1]) + p.c[2] * (p.x[2] - p.x[1]);
  } else {
    p.c[1] = Real(-1);
    p.gap = p.x[0] - p.x[1];
  }
}

/// The features of a pair. `other`: a feature (kFeatureNode + index) or a vertex (kCornerNode + index).
RUBBLE_HD inline NearParts nearParts(const SolverData& s, int owner, int other) {
  NearParts p;
  int own[2];
  p.sideA = p.count = ownerCorners(s, owner, own);
  for (int k = 0; k < kPointCorners; ++k) p.v[k] = k < p.sideA ? own[k] : -1;
  if (other >= kFeatureNode) {
    const SurfaceFeature& f = s.feature[other - kFeatureNode];
    for (int k = 0; k < cornersOf(f); ++k) p.v[p.count++] = f.v[k];
  } else {
    p.v[p.count++] = other - kCornerNode;
  }
  for (int k = 0; k < p.count; ++k)
    p.x[k] = k == 0 ? Vec3{0, 0, 0} : Vec3(s.vertexPosition[p.v[k]] - s.vertexPosition[p.v[0]]);
  findNearest(p);
  return p;
}

/// Velocity of the nearest point of side A relative to that of side B [m/s].
RUBBLE_HD inline Vec3 relativeVelocity(const SolverData& s, const NearParts& p) {
  Vec3 sum{0, 0, 0};
  for (int k = 0; k < p.count; ++k) sum += p.c[k] * s.vertexVelocity[p.v[k]];
  return sum;
}
RUBBLE_HD inline Real featureMargin(const SolverData& s, const NearParts& p) {
  const Real size = min(s.vertexParams[p.v[0]].length, s.vertexParams[p.v[p.sideA]].length);
  return max(s.step->contactMargin * size, s.step->dt * length(relativeVelocity(s, p)));
}
RUBBLE_HD inline Real bothRadii(const SolverData& s, const NearParts& p) {
  return s.vertexParams[p.v[0]].surfaceRadius + s.vertexParams[p.v[p.sideA]].surfaceRadius;
}

/// Features of one surface that are closer at rest than the thickness keep only this share of their rest
/// distance [1].
inline constexpr Real kRestShare = Real(.5);

/// Distance that a pair of features keeps [m].
RUBBLE_HD inline Real touchDistance(const SolverData& s, const NearParts& p) {
  const Real radii = bothRadii(s, p);
  if (s.vertexParams[p.v[0]].first != s.vertexParams[p.v[p.sideA]].first) return radii;
  NearParts rest = p;
  for (int k = 0; k < p.count; ++k) rest.x[k] = s.vertexRest[p.v[k]] - s.vertexRest[p.v[0]];
  findNearest(rest);
  return min(radii, kRestShare * length(rest.gap));
}

/// Does the surface bend away from the other edge at an edge (vertices a, b of `parts`)? Where it is flat, or
/// bends towards the other edge, vertex contacts keep the surfaces apart already. `towards`: from the nearest
/// point of the edge to that of the other.
RUBBLE_HD inline bool bendsAway(const SolverData& s, const SurfaceFeature& edge, const Vec3& towards) {
  // an edge with fewer than two triangles is a boundary
  if (edge.opposite[0] < 0 || edge.opposite[1] < 0) return true;
  const Vec3 along(s.vertexPosition[edge.v[1]] - s.vertexPosition[edge.v[0]]);
  Real rise = 0;
  for (const int corner : edge.opposite) {
    const Vec3 out(s.vertexPosition[corner] - s.vertexPosition[edge.v[0]]),
        across = out - along * (dot(out, along) / dot(along, along));
    rise += dot(towards, across) /
            std::sqrt(max(dot(across, across) * dot(towards, towards), std::numeric_limits<Real>::min()));
  }
  constexpr Real kBend = Real(-.05);
  return rise < kBend;
}

/// The feature in which the nearest point lies: the given one, one of its edges or a vertex, as
/// PointPair::other. -1 if other pairs represent the contact: for two edges whose nearest points are not
/// interior, or at which the surfaces are flat.
RUBBLE_HD inline int nearestPart(const SolverData& s, const NearParts& p, int own, int feature) {
  if (p.sideA == 2) {
    for (int k = 0; k < 4; ++k)
      if (p.c[k] == Real(0)) return -1;
    const bool held = bendsAway(s, s.feature[own], -p.gap) || bendsAway(s, s.feature[feature], p.gap);
    return held ? kFeatureNode + feature : -1;
  }
  int used = 0, last = -1, unused = -1;
  for (int k = 1; k < p.count; ++k) {
    if (p.c[k] != Real(0))
      ++used, last = k;
    else
      unused = k;
  }
  // of two vertices that see each other the lower one owns the contact; particles own no such pair
  if (used == 1)
    return p.v[last] > p.v[0] || s.vertexParams[p.v[0]].cluster < 0 ? kCornerNode + p.v[last] : -1;
  // the vertices other than `unused` are k and k + 1: edge k of the three
  if (p.count == 4 && used == 2) return kFeatureNode + s.feature[feature].edge[unused % 3];
  return kFeatureNode + feature;
}

/// Vertices of a feature, as PointPair::other.
RUBBLE_HD inline int partCorners(const SolverData& s, int part, int (&v)[3]) {
  if (part < kFeatureNode) {
    v[0] = part - kCornerNode;
    return 1;
  }
  const SurfaceFeature& f = s.feature[part - kFeatureNode];
  for (int k = 0; k < 3; ++k) v[k] = f.v[k];
  return cornersOf(f);
}

/// Is feature `part` an edge or vertex of feature `larger`? A vertex has a contact with the larger one only,
/// because it is at least as near.
RUBBLE_HD inline bool isSideOf(const SolverData& s, int part, int larger) {
  if (part < kCornerNode || larger < kFeatureNode || part == larger) return false;
  int v[3], w[3];
  const int few = partCorners(s, part, v), many = partCorners(s, larger, w);
  if (few >= many) return false;
  for (int i = 0; i < few; ++i) {
    bool in = false;
    for (int k = 0; k < many; ++k) in |= v[i] == w[k];
    if (!in) return false;
  }
  return true;
}

/// Removes features that are edges or vertices of others from a list of partners; returns the remaining
/// number.
RUBBLE_HD inline int dropSides(const SolverData& s, int owner, int count, int* partner, int stride) {
  if (owner >= s.vertices && owner < s.vertices + s.edges) return count;
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    // entries removed so far are behind `kept`; they are parts of features that remain
    bool side = false;
    for (int k = 0; k < count && !side; ++k)
      side = (k < kept || k > i) && isSideOf(s, partner[i * stride], partner[k * stride]);
    if (!side) partner[kept++ * stride] = partner[i * stride];
  }
  return kept;
}

/// found(part) for every feature that the owner, a vertex or an edge, may touch in this step; share of worker
/// `lane` of `lanes`. A feature may be found several times.
template <class Found>
RUBBLE_HD void searchFeatures(const SolverData& s, int owner, Found&& found, int lane, int lanes) {
  if (!seeksFeatures(s, owner)) return;
  int own[2];
  const int corners = ownerCorners(s, owner, own), world = s.worldOfPoint(own[0]);
  const SweptBox box = sweptBox<ExpectedWay>(s, own, corners);
  const auto look = [&](int i) {
    // of two edges the lower one owns the pair
    if ((corners == 2 && s.vertices + i <= owner) || !mayMeet(s, own, corners, s.feature[i])) return;
    const NearParts p = nearParts(s, owner, kFeatureNode + i);
    if (!(length(p.gap) <= bothRadii(s, p) + featureMargin(s, p))) return;
    if (const int part = nearestPart(s, p, owner - s.vertices, i); part >= 0) found(part);
  };
  seekFeatures(s, world, FeatureKind::BareEdge, box, look, lane, lanes);
  seekFeatures(s, world, corners == 1 ? FeatureKind::Triangle : FeatureKind::Edge, box, look, lane, lanes);
}

/// Sets the friction of a contact of two materials and returns its restitution.
RUBBLE_HD inline Real setMaterial(const SolverData& s, PointContact& p, const SurfaceData& a,
                                  const SurfaceData& b) {
  const MixedMaterial m = mixed(s, s.worldOfPoint(p.v[0]), a, b);
  p.muStatic = m.muStatic, p.muDynamic = m.muDynamic;
  return m.restitution;
}

/// Rows of a vertex or edge (A) against a feature (B). Fills the geometry and returns the initial values.
RUBBLE_HD inline PointContactStart touchFeature(const SolverData& s, int owner, int other, PointContact& p,
                                                Real& gap, Real& margin) {
  const NearParts parts = nearParts(s, owner, other);
  const VertexParams &pa = s.vertexParams[parts.v[0]], &pb = s.vertexParams[parts.v[parts.sideA]];
  const Real distance = length(parts.gap);
  gap = distance - touchDistance(s, parts);
  // at zero distance there is no contact normal
  margin = distance > Real(0) ? featureMargin(s, parts) : -std::fabs(gap) - Real(1);
  p.n = distance > Real(0) ? -parts.gap / distance : Vec3{0, 0, 1};
  p.body = -1;
  p.length = min(pa.length, pb.length);
  Real rowMass = 0;
  int used = 0;
  for (int k = 0; k < kPointCorners; ++k) p.v[k] = -1, p.weight[k] = 0;
  for (int k = 0; k < parts.count; ++k) {
    const Real c = parts.c[k];
    if (c == Real(0)) continue;
    p.v[used] = parts.v[k], p.weight[used++] = c;
    const Real mass = s.vertexParams[parts.v[k]].mass / (c * c);
    if (mass > Real(0)) rowMass = rowMass > Real(0) ? min(rowMass, mass) : mass;
  }
  return {rowMass, -gap, dot(p.n, relativeVelocity(s, parts)),
          setMaterial(s, p, surfaceOf(pa), surfaceOf(pb))};
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Convex shapes for the general narrow phase: a core with support function, faces and contact features, and
/// a rounding radius around it.
#include "collision/shapes.h"

namespace rubble::RUBBLE_CORE {

/// Most corners of a contact feature. A hull face with more is sampled evenly; a disc gets kDiscCorners.
inline constexpr int kMaxCorners = 16;
inline constexpr int kDiscCorners = 12;
/// Sine of the tilt above which the first corner of a disc is its lowest point. Below it the first corner is
/// the loaded point if there is one, else fixed to the body.
inline constexpr Real kFlatDisc = Real(2e-3);
/// Share of the radius beyond which an off-center load gets a corner of its own on a disc.
inline constexpr Real kOffMiddle = Real(.25);
/// The cap of a cylinder or the base of a cone is the feature if the direction is within this cosine of the
/// axis.
inline constexpr Real kCapCosine = Real(.7);

/// A convex shape about its own center. Sizes are those of the core, which `radius` rounds.
struct Convex {
  ShapeKind kind;
  Vec3 half;
  Real radius;
  const Vec4* vertices;  ///< of a hull
  const Vec4* planes;
  const int* faces;  ///< offset of the first corner of each face, plus an end offset
  int vertexCount, faceCount;
  Vec3 corner[3];  ///< of a triangle
};

RUBBLE_HD inline Convex convexOf(const ShapeTables& tables, const ShapeData& s) {
  Convex c{s.kind, s.half, s.radius, nullptr, nullptr, nullptr, 0, 0, {}};
  if (s.kind != ShapeKind::Hull) return c;
  const int* const header = tables.index + s.data;
  c.vertexCount = header[2], c.faceCount = header[3];
  c.vertices = tables.vector + header[0];
  c.planes = c.vertices + c.vertexCount;
  c.faces = tables.index + header[1];
  return c;
}

/// A contact feature of the core: a face, an edge or a corner.
struct Feature {
  Vec3 corner[kMaxCorners];
  int id[kMaxCorners];  ///< feature id of each corner
  int count = 0;        ///< 1: corner, 2: edge, more: face, counter-clockwise from outside
  Vec3 normal;          ///< outward normal of a face
};

RUBBLE_HD inline void addCorner(Feature& f, const Vec3& x, int id) {
  f.corner[f.count] = x, f.id[f.count++] = id;
}

namespace convex {

/// z of the base of a cone relative to its center of mass: -h / 4.
RUBBLE_HD inline Real coneBase(const Convex& c) { return -c.half.z / 3; }

/// Unit radial direction of d about z; {1, 0, 0} if its radial part is at most `least`.
template <class S> RUBBLE_HD Vec3T<S> radial(const Vec3T<S>& d, S least) {
  const S l2 = d.x * d.x + d.y * d.y;
  if (!(l2 > least * least)) return {1, 0, 0};
  const S inverse = S(1) / std::sqrt(l2);
  return {d.x * inverse, d.y * inverse, 0};
}

/// Adds corners on the disc of radius r at height z, counter-clockwise about `side` z. `d`: direction of the
/// contact, in which the disc tilts; `load`: loaded point.
RUBBLE_HD inline void addDisc(Feature& f, const Vec3& d, const Vec3& load, Real r, Real z, Real side,
                              int firstId) {
  const bool leans = d.x * d.x + d.y * d.y > kFlatDisc * kFlatDisc;
  const Vec3 u = leans ? radial(d, kFlatDisc) : radial(load, kOffMiddle * r), v{-u.y * side, u.x * side, 0};
  // cos and sin of 30 degrees
  constexpr Real kCos = Real(.86602540378443864676), kSin = Real(.5);
  Real c = 1, s = 0;
  for (int k = 0; k < kDiscCorners; ++k) {
    addCorner(f, {r * (u.x * c + v.x * s), r * (u.y * c + v.y * s), z}, firstId + k);
    const Real next = c * kCos - s * kSin;
    s = s * kCos + c * kSin;
    c = next;
  }
  f.normal = {0, 0, side};
}

/// Adds the corners of a hull face. If it has more than kMaxCorners, the one furthest along `load` is
/// included.
RUBBLE_HD inline void addHullFace(Feature& f, const Convex& c, int face, const Vec3& load) {
  const int begin = c.faces[face], count = c.faces[face + 1] - begin;
  const int taken = min(count, kMaxCorners);
  const int* const corners = c.faces + c.faceCount + 1 + begin;
  int first = 0;
  if (taken < count)
    for (int k = 1; k < count; ++k)
      if (dot(load, xyz(c.vertices[corners[k]])) > dot(load, xyz(c.vertices[corners[first]]))) first = k;
  for (int k = 0; k < taken; ++k) {
    const int vertex = corners[(first + k * count / taken) % count];
    addCorner(f, xyz(c.vertices[vertex]), vertex);
  }
  f.normal = xyz(c.planes[face]);
}

RUBBLE_HD inline void addBoxFace(Feature& f, const Vec3& h, int axis, Real side) {
  const int iu = (axis + 1) % 3, iv = (axis + 2) % 3;
  for (int k = 0; k < 4; ++k) {
    const int turn = side > Real(0) ? k : 3 - k;
    Vec3 x;
    x[axis] = side * h[axis];
    x[iu] = (turn == 1 || turn == 2) ? h[iu] : -h[iu];
    x[iv] = turn >= 2 ? h[iv] : -h[iv];
    addCorner(f, x, (x.x > Real(0)) + 2 * (x.y > Real(0)) + 4 * (x.z > Real(0)));
  }
  f.normal = {0, 0, 0};
  f.normal[axis] = side;
}

}  // namespace convex

/// Support function of the core along d (of any length), in the precision of d.
template <class S> RUBBLE_HD Vec3T<S> support(const Convex& c, const Vec3T<S>& d) {
  const Vec3T<S> half(c.half);
  switch (c.kind) {
    case ShapeKind::Capsule:
      return {0, 0, d.z > S(0) ? half.z : -half.z};
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      return {d.x > S(0) ? half.x : -half.x, d.y > S(0) ? half.y : -half.y, d.z > S(0) ? half.z : -half.z};
    case ShapeKind::Cylinder: {
      const Vec3T<S> u = convex::radial(d, S(0));
      return {u.x * half.x, u.y * half.x, d.z > S(0) ? half.z : -half.z};
    }
    case ShapeKind::Cone: {
      const Vec3T<S> u = convex::radial(d, S(0));
      const Vec3T<S> rim{u.x * half.x, u.y * half.x, static_cast<S>(convex::coneBase(c))}, apex{0, 0, half.z};
      return dot(rim - apex, d) > S(0) ? rim : apex;
    }
    case ShapeKind::Hull: {
      int best = 0;
      S most = -S(1e30);
      for (int i = 0; i < c.vertexCount; ++i) {
        const S h = dot(Vec3T<S>(xyz(c.vertices[i])), d);
        if (h > most) most = h, best = i;
      }
      return Vec3T<S>(xyz(c.vertices[best]));
    }
    case ShapeKind::Triangle: {
      const Vec3T<S> x(c.corner[0]), y(c.corner[1]), z(c.corner[2]);
      const S a = dot(x, d), b = dot(y, d), e = dot(z, d);
      return a >= b && a >= e ? x : b >= e ? y : z;
    }
    default: {
      Vec3T<S> x{0, 0, 0};
      withAddedShape(c.kind, [&]<class A>() { x = A::support(half, d); });
      return x;
    }
  }
}

/// Number of face normals that are tested as separating axes.
RUBBLE_HD inline int faceCount(const Convex& c) {
  switch (c.kind) {
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      return 6;
    case ShapeKind::Cylinder:
    case ShapeKind::Triangle:
      return 2;
    case ShapeKind::Cone:
      return 1;
    case ShapeKind::Hull:
      return c.faceCount;
    default:
      return 0;
  }
}

/// Outward normal of a face, and distance of its plane from the center [m].
RUBBLE_HD inline Vec4 facePlane(const Convex& c, int face) {
  const Real side = (face & 1) ? Real(-1) : Real(1);
  switch (c.kind) {
    case ShapeKind::Cylinder:
      return {0, 0, side, c.half.z};
    case ShapeKind::Cone:
      return {0, 0, -1, -convex::coneBase(c)};
    case ShapeKind::Hull:
      return c.planes[face];
    case ShapeKind::Triangle: {
      const Vec3 n = normalize(cross(c.corner[1] - c.corner[0], c.corner[2] - c.corner[0])) * side;
      return {n.x, n.y, n.z, dot(n, c.corner[0])};
    }
    default: {
      Vec3 n{0, 0, 0};
      n[face / 2] = side;
      return {n.x, n.y, n.z, c.half[face / 2]};
    }
  }
}

/// Adds the corners of a face. `lean` and `load` (a point; zero: none) select the first corner of a disc.
RUBBLE_HD inline void faceFeature(const Convex& c, int face, const Vec3& lean, const Vec3& load, Feature& f) {
  const Real side = (face & 1) ? Real(-1) : Real(1);
  switch (c.kind) {
    case ShapeKind::Cylinder:
      convex::addDisc(f, lean, load, c.half.x, side * c.half.z, side, 16 * (face & 1));
      return;
    case ShapeKind::Cone:
      convex::addDisc(f, lean, load, c.half.x, convex::coneBase(c), Real(-1), 0);
      return;
    case ShapeKind::Hull:
      convex::addHullFace(f, c, face, load);
      return;
    case ShapeKind::Triangle:
      for (int k = 0; k < 3; ++k) {
        const int corner = (face & 1) ? 2 - k : k;
        addCorner(f, c.corner[corner], corner);
      }
      f.normal = xyz(facePlane(c, face));
      return;
    default:
      convex::addBoxFace(f, c.half, face / 2, side);
  }
}

/// Does a face of a hull reach further than `far` along d? In thin hulls the plane may while the corners do
/// not.
RUBBLE_HD inline bool faceReaches(const Convex& c, int face, const Vec3& d, Real far) {
  const int* const corners = c.faces + c.faceCount + 1;
  for (int k = c.faces[face]; k < c.faces[face + 1]; ++k)
    if (dot(d, xyz(c.vertices[corners[k]])) > far) return true;
  return false;
}

/// The feature of the core that is furthest along the unit vector d. Of a hull: the face there whose normal
/// is closest to d.
RUBBLE_HD inline void featureAlong(const Convex& c, const Vec3& d, const Vec3& load, Real tolerance,
                                   Feature& f) {
  if (isAdded(c.kind)) {
    addCorner(f, support(c, d), 0);
    return;
  }
  switch (c.kind) {
    case ShapeKind::Sphere:
      addCorner(f, {0, 0, 0}, 0);
      return;
    case ShapeKind::Capsule:
      addCorner(f, {0, 0, c.half.z}, 1);
      addCorner(f, {0, 0, -c.half.z}, 2);
      return;
    case ShapeKind::Cylinder: {
      if (std::fabs(d.z) > kCapCosine) {
        faceFeature(c, d.z > Real(0) ? 0 : 1, d, load, f);
        return;
      }
      const Vec3 rim = convex::radial(d, Real(0)) * c.half.x;
      addCorner(f, {rim.x, rim.y, c.half.z}, 0);
      addCorner(f, {rim.x, rim.y, -c.half.z}, 16);
      return;
    }
    case ShapeKind::Cone: {
      if (d.z < -kCapCosine) {
        faceFeature(c, 0, d, load, f);
        return;
      }
      const Vec3 rim = convex::radial(d, Real(0)) * c.half.x;
      addCorner(f, {0, 0, c.half.z}, 32);
      addCorner(f, {rim.x, rim.y, convex::coneBase(c)}, 0);
      return;
    }
    case ShapeKind::Hull: {
      const Vec3 tip = support(c, d);
      int best = 0;
      Real most = Real(-2);
      for (int i = 0; i < c.faceCount; ++i) {
        const Vec4 plane = c.planes[i];
        const Real along = dot(xyz(plane), d);
        const bool nearTip = along > most && dot(xyz(plane), tip) > plane.w - tolerance;
        if (nearTip && faceReaches(c, i, d, dot(d, tip) - tolerance)) most = along, best = i;
      }
      convex::addHullFace(f, c, best, load);
      return;
    }
    case ShapeKind::Triangle:
      faceFeature(c, dot(xyz(facePlane(c, 0)), d) > Real(0) ? 0 : 1, d, load, f);
      return;
    default: {
      int axis = 0;
      for (int i = 1; i < 3; ++i)
        if (std::fabs(d[i]) > std::fabs(d[axis])) axis = i;
      convex::addBoxFace(f, c.half, axis, d[axis] > Real(0) ? Real(1) : Real(-1));
    }
  }
}

}  // namespace rubble::RUBBLE_CORE

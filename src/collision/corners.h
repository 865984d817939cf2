#pragma once
/// Corners of a shape: the points with which it indents a surface. A sphere, and each end of a capsule, is a
/// corner with a radius.
#include "collision/lattice.h"
#include "math/trig.h"

namespace rubble::RUBBLE_CORE {

/// Corners on the rim of a cylinder or cone. Between two of them the rim protrudes by 0.5 % of its radius.
inline constexpr int kRimCorners = 32;

/// In the frame of the body.
struct ShapeCorner {
  Vec3 at;       ///< [m]
  Vec3 outward;  ///< unit outward direction; zero: convex on all sides
  Real radius;   ///< [m]
  int part;      ///< part of a compound, else 0
};

/// Number of corners of a shape other than a compound. Planes, meshes and height fields have none.
RUBBLE_HD inline int convexCornerCount(const ShapeTables& tables, const ShapeData& s) {
  switch (s.kind) {
    case ShapeKind::Sphere:
      return 1;
    case ShapeKind::Capsule:
      return 2;
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      return 8;
    case ShapeKind::Cylinder:
      return 2 * kRimCorners;
    case ShapeKind::Cone:
      return 1 + kRimCorners;
    case ShapeKind::Hull:
      return tables.index[s.data + 2];
    case ShapeKind::Distance:
      return tables.index[s.data + 5];
    default:
      return isAdded(s.kind) ? kAddedCorners : 0;
  }
}

RUBBLE_HD inline Vec3 rimCorner(Real radius, Real height, int k) {
  constexpr Real kStep = Real(6.283185307179586476925) / static_cast<Real>(kRimCorners);
  const SinCos t = sinCos(kStep * static_cast<Real>(k));
  return {radius * t.cos, radius * t.sin, height};
}

RUBBLE_HD inline Vec3 convexCorner(const ShapeTables& tables, const ShapeData& s, int k) {
  switch (s.kind) {
    case ShapeKind::Capsule:
      return {0, 0, k == 0 ? s.half.z : -s.half.z};
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      return {k & 1 ? s.half.x : -s.half.x, k & 2 ? s.half.y : -s.half.y, k & 4 ? s.half.z : -s.half.z};
    case ShapeKind::Cylinder:
      return rimCorner(s.half.x, k < kRimCorners ? s.half.z : -s.half.z, k % kRimCorners);
    case ShapeKind::Cone:
      return k == 0 ? Vec3{0, 0, s.half.z} : rimCorner(s.half.x, -s.half.z / 3, k - 1);
    case ShapeKind::Hull:
      return xyz(tables.vector[tables.index[s.data] + k]);
    case ShapeKind::Distance:
      return xyz(latticeOf(tables, s).points[k]);
    default: {
      Vec3 x{0, 0, 0};
      withAddedShape(s.kind, [&]<class A>() { x = A::support(s.half, addedDirection(k)); });
      return x;
    }
  }
}

/// Outward direction of corner k at `at`; zero: convex on all sides.
RUBBLE_HD inline Vec3 cornerOutward(const ShapeTables& tables, const ShapeData& s, int k, const Vec3& at) {
  Vec3 out{0, 0, 0};
  switch (s.kind) {
    case ShapeKind::Box:
    case ShapeKind::RoundBox:
      out = {k & 1 ? Real(1) : Real(-1), k & 2 ? Real(1) : Real(-1), k & 4 ? Real(1) : Real(-1)};
      break;
    case ShapeKind::Cylinder:
      out = {at.x / s.half.x, at.y / s.half.x, k < kRimCorners ? Real(1) : Real(-1)};
      break;
    case ShapeKind::Cone:
      out = k == 0 ? Vec3{0, 0, 1} : Vec3{at.x / s.half.x, at.y / s.half.x, -1};
      break;
    case ShapeKind::Hull:
      out = at;
      break;
    case ShapeKind::Distance:
      latticeDistance(latticeOf(tables, s), at, out);
      break;
    default:
      return out;
  }
  const Real size = length(out);
  return size > Real(0) ? out / size : Vec3{0, 0, 0};
}

/// Corners [begin, end) of a shape; the corners of a compound are numbered part after part.
struct CornerRange {
  int begin, end;
};

RUBBLE_HD inline int cornerCount(const ShapeTables& tables, const ShapeData& s) {
  if (s.kind != ShapeKind::Compound) return convexCornerCount(tables, s);
  int all = 0;
  for (int p = 0; p < tables.index[s.data + 3]; ++p)
    all += convexCornerCount(tables, tables.part[tables.index[s.data + 2] + p].shape);
  return all;
}
/// Range `share` of `shares` of the corners of a shape. Corners close in the list are close in space
/// (cook/halving.h). The tip of a cone has a range of its own.
RUBBLE_HD inline CornerRange cornerShare(const ShapeTables& tables, const ShapeData& s, int share,
                                         int shares) {
  const int all = cornerCount(tables, s);
  if (s.kind != ShapeKind::Cone) return {all * share / shares, all * (share + 1) / shares};
  const auto cut = [&](int k) { return k == 0 ? 0 : 1 + (all - 1) * (k - 1) / (shares - 1); };
  return {cut(share), cut(share + 1)};
}

/// Calls visit(corner) for the corners in `range`.
template <class Visit>
RUBBLE_HD void visitCorners(const ShapeTables& tables, const ShapeData& s, const CornerRange& range,
                            Visit&& visit) {
  const bool compound = s.kind == ShapeKind::Compound;
  const int parts = compound ? tables.index[s.data + 3] : 1;
  const auto partAt = [&](int p) { return tables.part + tables.index[s.data + 2] + p; };
  int before = 0;
  for (int p = 0; p < parts && before < range.end; ++p) {
    const ShapeData& own = compound ? partAt(p)->shape : s;
    const int count = convexCornerCount(tables, own);
    for (int k = max(range.begin - before, 0); k < min(range.end - before, count); ++k) {
      const Vec3 at = convexCorner(tables, own, k), outward = cornerOutward(tables, own, k, at);
      if (compound)
        visit(ShapeCorner{partAt(p)->position + rotate(partAt(p)->rotation, at),
                          rotate(partAt(p)->rotation, outward), own.radius, p});
      else
        visit(ShapeCorner{at, outward, own.radius, p});
    }
    before += count;
  }
}

}  // namespace rubble::RUBBLE_CORE

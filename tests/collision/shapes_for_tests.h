#pragma once
/// Shapes, poses and brute-force measures for the pair tests.
#include <collision/collide.h>
#include <cook/cook.h>

#include <algorithm>
#include <vector>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {

inline ShapeData sphere(Real radius) { return {{0, 0, 0}, radius, ShapeKind::Sphere, -1}; }
inline ShapeData capsule(Real radius, Real halfLength) {
  return {{0, 0, halfLength}, radius, ShapeKind::Capsule, -1};
}
inline ShapeData box(const Vec3& half) { return {half, 0, ShapeKind::Box, -1}; }
inline ShapeData plane() { return {{0, 0, 0}, 0, ShapeKind::Plane, -1}; }

/// Shapes with the tables that they need.
class Shelf {
 public:
  ShapeData add(const Shape& shape) {
    const CookedShape cooked = cook(shape);
    const int vectors = static_cast<int>(vectors_.size()), indices = static_cast<int>(indices_.size());
    const int parts = static_cast<int>(parts_.size());
    for (const auto& v : cooked.vectors) vectors_.push_back({v[0], v[1], v[2], v[3]});
    for (const int i : cooked.indices) indices_.push_back(i);
    for (const int place : cooked.vectorPlaces)
      indices_[static_cast<std::size_t>(indices + place)] += vectors;
    for (const int place : cooked.indexPlaces) indices_[static_cast<std::size_t>(indices + place)] += indices;
    for (const int place : cooked.partPlaces) indices_[static_cast<std::size_t>(indices + place)] += parts;
    for (const CookedPart& part : cooked.parts)
      parts_.push_back({data(part.shape, indices), part.position, part.rotation, part.radius, -1});
    return data(cooked.shape, indices);
  }
  ShapeTables tables() const { return {vectors_.data(), indices_.data(), parts_.data()}; }

 private:
  static ShapeData data(const CookedData& shape, int indices) {
    return {shape.half, shape.radius, shape.kind, shape.data < 0 ? -1 : shape.data + indices};
  }

  std::vector<Vec4> vectors_;
  std::vector<int> indices_;
  std::vector<ShapePart> parts_;
};

/// Two shapes in the frame of A's center.
struct PairCase {
  ShapeData a, b;
  Quat qA, qB;
  Vec3 t;  ///< p_B - p_A

  Real length() const {
    const Real ra = boundingRadius(a), rb = boundingRadius(b);
    return 2 * (ra > 0 && rb > 0 ? std::min(ra, rb) : std::max(ra, rb));
  }
  RawManifold collide(Real margin) const { return RUBBLE_CORE::collide(a, qA, b, qB, t, margin, length()); }
  PairCase swapped() const { return {b, a, qB, qA, -t}; }
  PairCase turned(const Quat& turn) const { return {a, b, turn * qA, turn * qB, rotate(turn, t)}; }
};

/// Furthest extent of a shape about its center along the unit vector d.
inline Real reach(const ShapeData& s, const Quat& q, const Vec3& d) {
  const Vec3 local = rotateInverse(q, d);
  return dot(abs(local), s.half) + s.radius;
}
/// Distance of the two shapes' supports along d; negative: they overlap along d.
inline Real separationAlong(const PairCase& x, const Vec3& d) {
  return dot(x.t, d) - reach(x.a, x.qA, d) - reach(x.b, x.qB, d);
}

/// How far a point (relative to the shape's center) lies outside a box, along its axes.
inline Real outside(const ShapeData& s, const Quat& q, const Vec3& point) {
  const Vec3 local = rotateInverse(q, point);
  return std::max(
      {std::fabs(local.x) - s.half.x, std::fabs(local.y) - s.half.y, std::fabs(local.z) - s.half.z});
}

inline Real depthOf(const RawManifold& m, int k) { return dot(m.n, m.points[k].onA - m.points[k].onB); }
inline Real deepest(const RawManifold& m) {
  Real depth = -1e30;
  for (int k = 0; k < m.count; ++k) depth = std::max(depth, depthOf(m, k));
  return depth;
}

/// Does `m` have a point with these positions and equal features?
inline bool hasPoint(const RawManifold& m, const Vec3& onA, const Vec3& onB, Real tolerance) {
  for (int k = 0; k < m.count; ++k)
    if (length(m.points[k].onA - onA) <= tolerance && length(m.points[k].onB - onB) <= tolerance) return true;
  return false;
}

inline std::vector<int> features(const RawManifold& m) {
  std::vector<int> out;
  for (int k = 0; k < m.count; ++k) out.push_back(m.points[k].feature);
  std::sort(out.begin(), out.end());
  return out;
}

/// Two boxes near touching, with random orientations.
inline PairCase randomBoxes(test::Random& random) {
  PairCase x{box({random.uniform(.2, 1), random.uniform(.2, 1), random.uniform(.2, 1)}),
             box({random.uniform(.2, 1), random.uniform(.2, 1), random.uniform(.2, 1)}),
             random.rotation(),
             random.rotation(),
             {}};
  const Vec3 d = random.direction();
  x.t = d * ((reach(x.a, x.qA, d) + reach(x.b, x.qB, d)) * random.uniform(.75, 1.05));
  return x;
}

}  // namespace rubble::RUBBLE_CORE

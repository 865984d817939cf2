#pragma once
/// Kinds of shapes as the solver stores them, and shapes that a program adds. An added shape S is convex and
/// given by numbers. It declares
///
///   kName, kDoc, kFields     keyword in files, one line, and its fields: members of Shape (math/field.h)
///   half(const Shape&)       half extents about its center of mass [m]
///   massProperties           (const Shape&, double density); principal axes are those of the shape
///   support<T>(half, d)      furthest point of the shape along d, in the precision of d
///   distance(half, x, n)     signed distance of a point [m], and the outward unit normal there
///   innerRadius(half)        radius of a ball inside it [m]
///
/// Validation, files, cooking, drawing, contacts, continuous collision and queries follow from these.
#include "forces/extension.h"
#include "math/hd.h"
#include "math/type_list.h"

namespace rubble {

namespace RUBBLE_CORE {

struct FirstEntry;
template <class First, class... S> struct ShapesAfter { using Type = TypeList<S...>; };
/// The list of added shapes. A new one needs its header and one entry here, after FirstEntry.
using AddedShapes = ShapesAfter<FirstEntry RUBBLE_EXTRA_SHAPES>::Type;

}  // namespace RUBBLE_CORE

/// Kinds up to Plane are primitive: a pair has one manifold, which a specialized kernel computes. Kinds from
/// Hull on store data in shared tables, except for triangles and added shapes.
enum class ShapeKind : int {
  Sphere,
  Capsule,
  Box,
  Plane,
  RoundBox,
  Cylinder,
  Cone,
  Hull,
  FirstAdded,
  Triangle = FirstAdded + RUBBLE_CORE::AddedShapes::kSize,
  Compound,
  Mesh,
  HeightField,
  Distance
};

namespace RUBBLE_CORE {

template <class S> constexpr ShapeKind addedKind() {
  return static_cast<ShapeKind>(static_cast<int>(ShapeKind::FirstAdded) + typeIndex<S>(AddedShapes{}));
}
RUBBLE_HD inline bool isAdded([[maybe_unused]] ShapeKind kind) {
  bool found = false;
  forEachType(AddedShapes{}, [&]<class S>() { found |= kind == addedKind<S>(); });
  return found;
}
/// Calls f.operator()<S>() for the added shape of that kind.
template <class Function> RUBBLE_HD void withAddedShape([[maybe_unused]] ShapeKind kind, Function&& f) {
  forEachType(AddedShapes{}, [&]<class S>() {
    if (kind == addedKind<S>()) f.template operator()<S>();
  });
}

/// Points on the surface of an added shape, by which it touches concave surfaces: along its axes and between
/// them.
inline constexpr int kAddedCorners = 14;
RUBBLE_HD inline Vec3 addedDirection(int k) {
  const auto side = [&](int bit) { return (k - 6) & bit ? Real(1) : Real(-1); };
  if (k >= 6) return {side(1), side(2), side(4)};
  Vec3 d{0, 0, 0};
  d[k / 2] = k & 1 ? Real(-1) : Real(1);
  return d;
}

}  // namespace RUBBLE_CORE
}  // namespace rubble

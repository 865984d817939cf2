#pragma once
/// All that is known about shape types on the host: built-in ones and those that a program adds
/// (collision/shape_kind.h). Validation, files, cooking and mass properties follow from their traits.
#include "collision/cooked_shape.h"
#include "math/field.h"

namespace rubble {

using ShapeField = AnyField<Shape>;

/// What is known about a shape type, without its types.
struct ShapeTraits {
  ShapeType type;
  const char* name;
  const char* doc;
  bool isConvex;                   ///< a convex solid: a part of compounds, the shape of a query
  std::vector<ShapeField> fields;  ///< its numbers; its lists are in ShapeGeometry
  void (*check)(const Shape&, const Path& path);  ///< of its lists; null: it has none
  void (*cook)(CookedShape&, const Shape&, const Path& path);
  MassProperties (*massProperties)(const Shape&, double density);
  Vec3 (*support)(const Shape&, const Vec3& d);  ///< of added shapes; else null
};

/// All of them, by ShapeType; and one of them.
const std::vector<ShapeTraits>& shapeTraits();
const ShapeTraits& traitsOf(ShapeType type);

/// Radius of rounded edges and corners.
inline constexpr auto kRounding = field("rounding", "m", "radius of rounded edges and corners",
                                        &Shape::rounding, {.range = FieldRange::NotNegative});
struct InShape {
  template <class Owner, class S> static auto& owner(S& shape) { return shape; }
};
/// Of shapes that are given by lists (cook/list_shapes.cpp).
std::vector<ShapeTraits> listShapes();

}  // namespace rubble

/// Shapes that are given by lists, and the plane. Their checks come before cooking: finite numbers and
/// consistent list sizes. All readers of geometry (cooking, rendering, files) rely on them.
#include "cook/checks.h"
#include "cook/cook.h"
#include "cook/shape_traits.h"
#include "cook/size.h"

namespace rubble {

namespace {

using namespace checks;

/// Largest number of elements of a geometry list. Derived elements, such as two triangles per sample, are
/// counted in int.
constexpr std::size_t kMost = std::size_t{1} << 28;

void bounded(std::size_t count, const Path& path) {
  if (count > kMost) throw Error(path, "at most " + std::to_string(kMost), std::to_string(count));
}

void checkPoints(const ShapeGeometry& g, const Path& path) {
  bounded(g.points.size(), path);
  finite(g.points, path);
}

void checkTriangles(const ShapeGeometry& g, const Path& path) {
  if (g.triangles.empty()) throw Error(path, "at least one triangle", "none");
  bounded(g.triangles.size(), path);
  for (std::size_t t = 0; t < g.triangles.size(); ++t)
    for (const int v : g.triangles[t])
      if (v < 0 || static_cast<std::size_t>(v) >= g.points.size())
        throw Error(path[t], "corners below " + std::to_string(g.points.size()), std::to_string(v));
}

/// One sample per lattice point. `axes`: number of entries of `counts` in use.
void checkSamples(const ShapeGeometry& g, std::size_t axes, const Path& path, const std::string& name) {
  Size count = 1;
  for (std::size_t i = 0; i < axes; ++i) {
    if (g.counts[i] < 2)
      throw Error(path + ".counts", "at least 2 samples along each axis", std::to_string(g.counts[i]));
    count = count * Size::of(g.counts[i]);
  }
  if (count > kMost) throw Error(path + ".counts", "at most " + std::to_string(kMost) + " samples", "more");
  if (g.samples.size() != count.value())
    throw Error(path + name, std::to_string(count.value()) + " samples", std::to_string(g.samples.size()));
  finite(g.samples, path + name);
}

/// Parts are convex solids, not compounds, so the recursion has one level.
void checkParts(const ShapeGeometry& g, const Path& path) {
  if (g.parts.empty()) throw Error(path, "the parts of a compound", "none");
  bounded(g.parts.size(), path);
  for (std::size_t i = 0; i < g.parts.size(); ++i) {
    const ShapePartDef& part = g.parts[i];
    const Path where = path[i];
    finite(part.position, where + ".position");
    unit(part.orientation, where + ".orientation");
    positive(part.density, where + ".density");
    if (part.material) material(*part.material, where + ".material");
    enumeration(static_cast<int>(part.shape.type), static_cast<int>(shapeTraits().size()) - 1,
                where + ".shape.type");
    if (!traitsOf(part.shape.type).isConvex)
      throw Error(where + ".shape", "a convex solid",
                  part.shape.type == ShapeType::Compound ? "a compound" : "another shape");
    validate(part.shape, where + ".shape");
  }
}

void checkCompound(const ShapeGeometry& g, const Path& path) {
  checkParts(g, path + ".parts");
  if (!g.mass) return;
  const Path where = path + ".mass_properties";
  positive(g.mass->mass, where + ".mass");
  moments(g.mass->inertia, where + ".inertia");
  finite(g.mass->center, where + ".center");
  unit(g.mass->axes, where + ".axes");
}

const ShapeGeometry& geometryOf(const Shape& s) {
  static const ShapeGeometry none;
  return s.geometry ? *s.geometry : none;
}
MassProperties cookedMass(const Shape& shape, double density) {
  MassProperties mass = cook(shape).unit;
  mass.mass *= density;
  mass.inertia *= density;
  return mass;
}
MassProperties massless(const Shape&, double) { return {}; }

ShapeTraits plane() {
  return {ShapeType::Plane,
          "plane",
          "half space, solid where local z is below 0",
          false,
          {},
          nullptr,
          [](CookedShape&, const Shape&, const Path&) {},
          massless,
          nullptr};
}

struct HullType {
  static constexpr std::tuple kFields{kRounding};
  static void check(const Shape& s, const Path& path) {
    const ShapeGeometry& g = geometryOf(s);
    if (g.points.empty()) throw Error(path + ".points", "the points of a hull", "none");
    checkPoints(g, path + ".points");
  }
  static ShapeTraits traits() {
    return {ShapeType::Hull,
            "hull",
            "convex hull of points",
            true,
            anyFields<Shape, HullType, InShape>(),
            check,
            cooking::addHull,
            cookedMass,
            nullptr};
  }
};

ShapeTraits compound() {
  return {ShapeType::Compound,
          "compound",
          "convex shapes that move as one",
          false,
          {},
          [](const Shape& s, const Path& path) { checkCompound(geometryOf(s), path); },
          cooking::addCompound,
          cookedMass,
          nullptr};
}

ShapeTraits mesh() {
  const auto check = [](const Shape& s, const Path& path) {
    checkPoints(geometryOf(s), path + ".points");
    checkTriangles(geometryOf(s), path + ".triangles");
  };
  return {ShapeType::Mesh, "mesh", "surface of triangles", false, {}, check, cooking::addMesh,
          massless,        nullptr};
}

ShapeTraits heightField() {
  const auto check = [](const Shape& s, const Path& path) {
    const ShapeGeometry& g = geometryOf(s);
    checkSamples(g, 2, path, ".heights");
    positive(g.spacing.x, path + ".spacing.x");
    positive(g.spacing.y, path + ".spacing.y");
  };
  return {ShapeType::HeightField,
          "height_field",
          "surface over the local x-y plane",
          false,
          {},
          check,
          cooking::addHeightField,
          massless,
          nullptr};
}

ShapeTraits distanceField() {
  const auto check = [](const Shape& s, const Path& path) {
    const ShapeGeometry& g = geometryOf(s);
    checkSamples(g, 3, path, ".distances");
    finite(g.origin, path + ".origin");
    positive(g.spacing.x, path + ".spacing");
    if (g.spacing.y != g.spacing.x || g.spacing.z != g.spacing.x)
      throw Error(path + ".spacing", "one length for all three axes", text(g.spacing));
  };
  return {ShapeType::DistanceField,
          "distance_field",
          "solid by signed distances on a lattice",
          false,
          {},
          check,
          cooking::addDistanceField,
          cookedMass,
          nullptr};
}

}  // namespace

std::vector<ShapeTraits> listShapes() {
  return {plane(), HullType::traits(), compound(), mesh(), heightField(), distanceField()};
}

}  // namespace rubble

/// Validation of shapes before cooking: finite numbers and consistent list sizes. All readers of geometry
/// (cooking, rendering, files) rely on it.
#include <rubble/scene.h>

#include "cook/checks.h"
#include "cook/size.h"

namespace rubble {

namespace {

using namespace checks;

/// Largest number of elements of a geometry list. Derived elements, such as two triangles per sample, are
/// counted in int.
constexpr std::size_t kMost = std::size_t{1} << 28;

void bounded(std::size_t count, const std::string& path) {
  if (count > kMost) throw Error(path, "at most " + std::to_string(kMost), std::to_string(count));
}

void checkPoints(const ShapeGeometry& g, const std::string& path) {
  bounded(g.points.size(), path);
  finite(g.points, path);
}

void checkTriangles(const ShapeGeometry& g, const std::string& path) {
  if (g.triangles.empty()) throw Error(path, "at least one triangle", "none");
  bounded(g.triangles.size(), path);
  for (std::size_t t = 0; t < g.triangles.size(); ++t)
    for (const int v : g.triangles[t])
      if (v < 0 || static_cast<std::size_t>(v) >= g.points.size())
        throw Error(element(path, t), "corners below " + std::to_string(g.points.size()), std::to_string(v));
}

/// One sample per lattice point. `axes`: number of entries of `counts` in use.
void checkSamples(const ShapeGeometry& g, std::size_t axes, const std::string& path,
                  const std::string& name) {
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

bool isConvexSolid(ShapeType type) {
  return type == ShapeType::Sphere || type == ShapeType::Box || type == ShapeType::Capsule ||
         type == ShapeType::Cylinder || type == ShapeType::Cone || type == ShapeType::Hull;
}

/// Parts are convex solids, not compounds, so the recursion has one level.
void checkParts(const ShapeGeometry& g, const std::string& path) {
  if (g.parts.empty()) throw Error(path, "the parts of a compound", "none");
  bounded(g.parts.size(), path);
  for (std::size_t i = 0; i < g.parts.size(); ++i) {
    const ShapePartDef& part = g.parts[i];
    const std::string where = element(path, i);
    finite(part.position, where + ".position");
    unit(part.orientation, where + ".orientation");
    positive(part.density, where + ".density");
    if (part.material) material(*part.material, where + ".material");
    enumeration(part.shape.type, ShapeType::DistanceField, where + ".shape.type");
    if (!isConvexSolid(part.shape.type))
      throw Error(where + ".shape", "a convex solid",
                  part.shape.type == ShapeType::Compound ? "a compound" : "another shape");
    validate(part.shape, where + ".shape");
  }
}

}  // namespace

void validate(const Shape& s, const std::string& path) {
  const ShapeGeometry none, &g = s.geometry ? *s.geometry : none;
  notNegative(s.rounding, path + ".rounding");
  enumeration(s.type, ShapeType::DistanceField, path + ".type");
  switch (s.type) {
    case ShapeType::Sphere:
      positive(s.radius, path + ".radius");
      break;
    case ShapeType::Box:
      positive(s.halfExtents.x, path + ".halfExtents.x");
      positive(s.halfExtents.y, path + ".halfExtents.y");
      positive(s.halfExtents.z, path + ".halfExtents.z");
      break;
    case ShapeType::Capsule:
    case ShapeType::Cylinder:
    case ShapeType::Cone:
      positive(s.radius, path + ".radius");
      positive(s.halfLength, path + ".halfLength");
      break;
    case ShapeType::Plane:
      break;
    case ShapeType::Hull:
      if (g.points.empty()) throw Error(path + ".points", "the points of a hull", "none");
      checkPoints(g, path + ".points");
      break;
    case ShapeType::Compound:
      checkParts(g, path + ".parts");
      break;
    case ShapeType::Mesh:
      checkPoints(g, path + ".points");
      checkTriangles(g, path + ".triangles");
      break;
    case ShapeType::HeightField:
      checkSamples(g, 2, path, ".heights");
      positive(g.spacing.x, path + ".spacing.x");
      positive(g.spacing.y, path + ".spacing.y");
      break;
    case ShapeType::DistanceField:
      checkSamples(g, 3, path, ".distances");
      finite(g.origin, path + ".origin");
      positive(g.spacing.x, path + ".spacing");
      if (g.spacing.y != g.spacing.x || g.spacing.z != g.spacing.x)
        throw Error(path + ".spacing", "one length for all three axes", text(g.spacing));
      break;
  }
}

}  // namespace rubble

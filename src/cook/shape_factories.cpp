#include <rubble/scene.h>

namespace rubble {

namespace {

Shape withGeometry(ShapeType type, ShapeGeometry geometry, double rounding = 0) {
  return {type, {}, 0, 0, rounding, std::make_shared<const ShapeGeometry>(std::move(geometry))};
}

}  // namespace

Shape Shape::hull(std::vector<Vec3> points, double rounding) {
  ShapeGeometry g;
  g.points = std::move(points);
  return withGeometry(ShapeType::Hull, std::move(g), rounding);
}

Shape Shape::compound(std::vector<ShapePartDef> parts, const std::optional<MassProperties>& mass) {
  ShapeGeometry g;
  g.parts = std::move(parts);
  g.mass = mass;
  return withGeometry(ShapeType::Compound, std::move(g));
}

Shape Shape::mesh(std::vector<Vec3> vertices, std::vector<std::array<int, 3>> triangles, bool twoSided) {
  ShapeGeometry g;
  g.points = std::move(vertices);
  g.triangles = std::move(triangles);
  g.twoSided = twoSided;
  return withGeometry(ShapeType::Mesh, std::move(g));
}

Shape Shape::heightField(int countX, int countY, const Vec3& spacing, std::vector<double> heights) {
  ShapeGeometry g;
  g.counts = {countX, countY, 1};
  g.spacing = spacing;
  g.samples = std::move(heights);
  return withGeometry(ShapeType::HeightField, std::move(g));
}

Shape Shape::distanceField(const std::array<int, 3>& counts, const Vec3& origin, double spacing,
                           std::vector<double> distances) {
  ShapeGeometry g;
  g.counts = counts;
  g.origin = origin;
  g.spacing = {spacing, spacing, spacing};
  g.samples = std::move(distances);
  return withGeometry(ShapeType::DistanceField, std::move(g));
}

}  // namespace rubble

#include "render/shape_meshes.h"

#include <rubble/mesh.h>

namespace rubble::render {

BodyLook ShapeMeshes::withMesh(Bodies& bodies, BodyLook look, const Shape& shape) {
  if (look.geometry != kOwnMesh) return look;
  // all cones are one, scaled
  const Shape drawn = shape.type == ShapeType::Cone && shape.rounding == 0 ? Shape::cone(1, 1) : shape;
  const Key key{drawn.type,   drawn.halfExtents.x, drawn.halfExtents.y, drawn.halfExtents.z,
                drawn.radius, drawn.halfLength,    drawn.rounding,      drawn.geometry.get()};
  const auto known = known_.find(key);
  if (known != known_.end()) {
    look.geometry = known->second.geometry;
    return look;
  }
  const ShapeMesh mesh = shapeMesh(drawn);
  std::vector<Vec3f> points;
  std::vector<Triangle> triangles;
  for (const Vec3& p : mesh.points) points.emplace_back(p);
  for (const auto& t : mesh.triangles)
    triangles.push_back({static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                         static_cast<std::uint32_t>(t[2])});
  look.geometry = bodies.addMesh(points, triangles);
  known_[key] = {drawn, look.geometry};
  return look;
}

}  // namespace rubble::render

/// Colliders of USD: geometry with PhysicsCollisionAPI, and its physics material.
#include <algorithm>
#include <cmath>

#include <rubble/error.h>

#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

int axisOf(const std::string& axis) { return axis == "X" ? 0 : axis == "Y" ? 1 : 2; }

}  // namespace

bool UsdReader::shapeOf(const UsdPrim& prim, FreeShape& shape) {
  const std::string& type = prim.prim().type;
  shape.axis = axisOf(prim.text("axis", "Z"));
  if (type == "Cube") {
    const double edge = prim.number("size", 2);
    shape.size = {edge, edge, edge};
  } else if (type == "Sphere") {
    shape.type = FreeShape::Type::Sphere, shape.radius = prim.number("radius", 1);
  } else if (type == "Capsule" || type == "Capsule_1") {
    shape.type = FreeShape::Type::Capsule, shape.height = prim.number("height", 1);
    shape.radius = prim.number("radius", prim.number("radiusBottom", .5));
    shape.topRadius = prim.has("radius") ? -1 : prim.number("radiusTop", .5);
  } else if (type == "Cylinder" || type == "Cylinder_1") {
    shape.type = FreeShape::Type::Cylinder, shape.height = prim.number("height", 2);
    shape.radius = prim.number("radius", prim.number("radiusBottom", 1));
    shape.topRadius = prim.has("radius") ? -1 : prim.number("radiusTop", shape.radius);
  } else if (type == "Cone") {
    shape.type = FreeShape::Type::Cone;
    shape.height = prim.number("height", 2), shape.radius = prim.number("radius", 1);
  } else if (type == "Plane") {
    shape.type = FreeShape::Type::Plane;
    if (prim.has("width") || prim.has("length"))
      report_.note(Effect::Approximate, prim.place(), "Plane.width", "planes are infinite");
    prim.number("width", 0), prim.number("length", 0);
  } else if (type == "Mesh") {
    return meshOf(prim, shape);
  } else {
    report_.note(Effect::Lost, prim.place(), "collider" + inQuotes(prim.prim().name),
                 "geometry of the type '" + type + "'");
    return false;
  }
  return true;
}

bool UsdReader::meshOf(const UsdPrim& prim, FreeShape& shape) {
  shape.type = FreeShape::Type::Mesh;
  const auto* points = prim.list("points");
  const auto* counts = prim.list("faceVertexCounts");
  const auto* indices = prim.list("faceVertexIndices");
  if (!points || !counts || !indices) {
    report_.note(Effect::Lost, prim.place(), "collider" + inQuotes(prim.prim().name), "a mesh without faces");
    return false;
  }
  for (std::size_t i = 0; i + 2 < points->size(); i += 3)
    shape.mesh.vertices.push_back({(*points)[i], (*points)[i + 1], (*points)[i + 2]});
  const auto most = static_cast<double>(shape.mesh.vertices.size());
  const bool left = prim.text("orientation") == "leftHanded";
  std::size_t at = 0;
  for (const double count : *counts) {
    if (!(count >= 0 && count <= static_cast<double>(indices->size() - at)))
      prim.fail("faceVertexCounts", "as many corners as there are indices", std::to_string(count));
    const auto corner = [&](std::size_t k) {
      const double v = (*indices)[at + k];
      if (!(v >= 0 && v < most)) prim.fail("faceVertexIndices", "indices of points", std::to_string(v));
      return static_cast<int>(v);
    };
    for (std::size_t k = 2; k < static_cast<std::size_t>(count); ++k) {
      std::array<int, 3> t{corner(0), corner(k - 1), corner(k)};
      if (left) std::swap(t[1], t[2]);
      shape.mesh.triangles.push_back(t);
    }
    at += static_cast<std::size_t>(count);
  }
  const std::string as = prim.text("physics:approximation", "none");
  shape.as = as == "none" || as == "meshSimplification"   ? FreeShape::Mesh::Triangles
             : as == "convexDecomposition" || as == "sdf" ? FreeShape::Mesh::Parts
             : as == "boundingCube"                       ? FreeShape::Mesh::Box
             : as == "boundingSphere"                     ? FreeShape::Mesh::Sphere
                                                          : FreeShape::Mesh::Hull;
  return true;
}

std::optional<UsdPrim> UsdReader::boundMaterial(const UsdPrim& prim, const std::string& path,
                                                bool forPhysics) {
  std::string at = path;
  std::string bound;
  while (bound.empty()) {
    const auto found = byPath_.find(at);
    if (found != byPath_.end()) {
      const Placed& owner = placed_[found->second];
      const UsdPrim own = this->at(*owner.prim);
      const auto* targets = forPhysics ? own.targets("material:binding:physics") : nullptr;
      if (!targets) targets = own.targets("material:binding");
      if (targets) bound = inInstance(owner, targets->front());
    }
    const std::size_t slash = at.rfind('/');
    if (slash == std::string::npos || slash == 0) break;
    at = at.substr(0, slash);
  }
  if (bound.empty()) return std::nullopt;
  const auto found = byPath_.find(bound);
  if (found == byPath_.end()) {
    report_.note(forPhysics ? Effect::Lost : Effect::None, prim.place(), "material:binding",
                 "the material '" + bound + "' is not there");
    return std::nullopt;
  }
  return this->at(*placed_[found->second].prim);
}

UsdReader::Surface UsdReader::surfaceOf(const UsdPrim& prim, const std::string& path) {
  Surface out;
  const std::optional<UsdPrim> bound = boundMaterial(prim, path, true);
  if (!bound || !bound->prim().hasSchema("PhysicsMaterialAPI")) return out;
  const UsdPrim& material = *bound;
  const auto atLeast0 = [&](const char* key) {
    const double value = material.number(key, 0);
    if (value < 0) material.fail(key, "a number of at least 0", std::to_string(value));
    return value;
  };
  const double rest = atLeast0("physics:staticFriction"), slip = atLeast0("physics:dynamicFriction");
  out.material.dynamicFriction = slip, out.material.staticFriction = std::max(rest, slip);
  out.material.restitution = std::min(atLeast0("physics:restitution"), 1.);
  out.density = atLeast0("physics:density") * kilogramsPerUnit_ / std::pow(metersPerUnit_, 3);
  return out;
}

void UsdReader::addCollider(const UsdPrim& prim, Placed& placed) {
  FreeShape shape;
  if (!shapeOf(prim, shape)) return;
  const bool isStatic = placed.link < 0;
  if (isStatic) {
    // a link of its own, which filters can name
    Link own;
    own.name = placed.path.substr(1);
    own.place = prim.place();
    own.parent = 0, own.pose = placed.world.rigid();
    placed.link = static_cast<int>(model_.links.size());
    model_.links.push_back(std::move(own));
    bodyPrims_.push_back(&prim.prim());
  }
  const int index = placed.link;
  Link& link = model_.links[static_cast<std::size_t>(index)];
  const Surface surface = surfaceOf(prim, placed.path);
  Geom like;
  like.name = prim.prim().name;
  like.place = prim.place();
  like.material = surface.material;
  const Pose own = link.pose;
  const Affine toLink = Affine::of(inverse(own)) * placed.world;
  Collider collider{index, {}, 0, 0, surface.density};
  if (prim.prim().hasSchema("PhysicsMassAPI")) {
    collider.mass = prim.number("physics:mass", 0) * kilogramsPerUnit_;
    collider.density = prim.number("physics:density", 0) * kilogramsPerUnit_ / std::pow(metersPerUnit_, 3);
  }
  if (collider.mass < 0) prim.fail("physics:mass", "a number of at least 0", "less");
  if (collider.density < 0) prim.fail("physics:density", "a number of at least 0", "less");
  placed.geom = static_cast<int>(link.geoms.size());
  if (!addShape(link, shape, toLink, like, isStatic || link.kinematic, collider.solid, report_)) return;
  report_.converted(prim.place(), prim.prim().type + inQuotes(prim.prim().name),
                    isStatic ? "static shape" : "shape of body" + inQuotes(link.name));
  colliders_.push_back(std::move(collider));
}

}  // namespace rubble::convert

#pragma once
/// Meshes of the shapes that the renderer has no geometry of its own for; bodies with the same shape share
/// one.
#include <map>
#include <memory>
#include <tuple>

#include <rubble/scene.h>

#include "render/bodies.h"

namespace rubble::render {

class ShapeMeshes {
 public:
  /// The look of a body of that shape, with the mesh in place of kOwnMesh; others are returned as they are.
  BodyLook withMesh(Bodies& bodies, BodyLook look, const Shape& shape);

 private:
  using Key = std::tuple<ShapeType, double, double, double, double, double, double, const ShapeGeometry*>;
  struct Known {
    Shape shape;  ///< holds the geometry, so that no other takes its address
    int geometry;
  };
  std::map<Key, Known> known_;
};

}  // namespace rubble::render

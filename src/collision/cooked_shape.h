#pragma once
/// A cooked shape in double precision: output of the cooker, copied by backends into their shared tables.
#include <array>
#include <vector>

#include <rubble/scene.h>

#include "collision/shape_kind.h"

namespace rubble {

/// Like ShapeData; `data` is relative to the tables of this shape.
struct CookedData {
  ShapeKind kind = ShapeKind::Plane;
  Vec3 half;
  double radius = 0;
  int data = -1;
};

struct CookedPart {
  CookedData shape;
  Vec3 position;
  Quat rotation;
  double radius = 0;
  std::optional<Material> material = {};
};

/// In the engine's frame: origin at the center of mass, principal axes.
struct CookedShape {
  CookedData shape;
  MassProperties unit;  ///< mass properties at density 1; `center` and `axes` locate the engine's frame in
                        ///< the authored frame, even without mass
  double radius = 0;    ///< of the bounding sphere about the origin [m]
  std::vector<std::array<double, 4>> vectors;
  std::vector<int> indices;
  std::vector<CookedPart> parts;
  std::vector<int> triangleOrder;  ///< mesh: authored triangle of each in the tables. No part of them
  /// Positions in `indices` whose value is relative to this shape's tables of vectors, indices and parts.
  std::vector<int> vectorPlaces, indexPlaces, partPlaces;
};

}  // namespace rubble

#pragma once
/// A shape as engines take it, in double precision: what the cook makes of a Shape and backends copy into
/// their shared tables.
#include <array>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// The numbers of ShapeKind (collision/shapes.h), which is compiled once a precision.
enum class CookedKind : int {
  Sphere,
  Capsule,
  Box,
  Plane,
  RoundBox,
  Cylinder,
  Cone,
  Hull,
  Triangle,
  Compound,
  Mesh,
  HeightField,
  Distance
};

/// Like ShapeData; `data` counts from the beginning of this shape's own tables.
struct CookedData {
  CookedKind kind = CookedKind::Plane;
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

/// In the frame of the engine: origin at the centre of mass, axes along the principal axes.
struct CookedShape {
  CookedData shape;
  MassProperties unit;  ///< at density 1; `centre` and `axes` say where the engine's frame lies in the
                        ///< author's, also for what has no mass
  double radius = 0;    ///< of the sphere about the origin that holds it [m]
  std::vector<std::array<double, 4>> vectors;
  std::vector<int> indices;
  std::vector<CookedPart> parts;
  /// Places in `indices` that count from the beginning of this shape's tables: of vectors, indices and parts.
  std::vector<int> vectorPlaces, indexPlaces, partPlaces;
};

}  // namespace rubble

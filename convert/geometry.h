#pragma once
/// Meshes of models: convex hulls for collision, and mass properties.
#include <optional>
#include <string>
#include <vector>

#include <rubble/mesh.h>

#include "convert/mesh/corners.h"
#include "convert/model.h"

namespace rubble::convert {

/// Which solid a mesh stands for.
enum class MeshMass {
  Exact,   ///< inside of its surface
  Legacy,  ///< sum of the cones from its triangles to their centroid (default of MuJoCo)
  Convex,  ///< its convex hull
  Shell,   ///< its surface: "volume" is the area
};
/// At density 1.
SolidSums massOf(const TriangleMesh& mesh, MeshMass kind, const std::string& path);

/// The convex hull as triangles. Throws Error at `path` if the points lie in one plane.
TriangleMesh hullOf(const std::vector<Vec3>& points, const std::string& path);

/// The mesh as a shape of pictures; nothing if it has no triangles, or cannot be one.
std::optional<Shape> drawnMesh(TriangleMesh mesh);
/// The surface of an ellipsoid with these half axes, for pictures.
Shape drawnEllipsoid(const Vec3& halfAxes);

/// Convex hull of points of an ellipsoid with these half axes.
Shape ellipsoidHull(const Vec3& halfAxes);
/// At density 1.
MassProperties ellipsoidMass(const Vec3& halfAxes);

/// Integrals of a mass with this tensor about its center of mass, (xx, yy, zz, xy, xz, yz), in that frame.
SolidSums sumsOfTensor(double mass, const std::array<double, 6>& tensor);

}  // namespace rubble::convert

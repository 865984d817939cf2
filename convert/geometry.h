#pragma once
/// Meshes of models: convex hulls for collision, and mass properties.
#include <string>
#include <vector>

#include <rubble/mesh.h>

#include "convert/model.h"

namespace rubble::convert {

/// Which solid a mesh stands for.
enum class MeshMass {
  Exact,   ///< inside of its surface
  Legacy,  ///< sum of the cones from its triangles to their centroid (default of MuJoCo)
  Convex,  ///< its convex hull
};
/// At density 1.
SolidSums massOf(const TriangleMesh& mesh, MeshMass kind, const std::string& path);

/// The convex hull as triangles. Throws Error at `path` if the points lie in one plane.
TriangleMesh hullOf(const std::vector<Vec3>& points, const std::string& path);

/// Largest number of corners of a hull that is made of a mesh. Contact tests cost time in proportion to it.
inline constexpr std::size_t kMostCorners = 64;
/// The points of at most kMostCorners corners of the convex hull: those farthest along evenly spread
/// directions. `reduced`: were there more? Throws Error as hullOf().
std::vector<Vec3> cornersOf(const std::vector<Vec3>& points, bool& reduced, const std::string& path);

/// Unit vectors that are spread evenly, and the six along the axes.
std::vector<Vec3> directions(int count);
/// Convex hull of points of an ellipsoid with these half axes.
Shape ellipsoidHull(const Vec3& halfAxes);
/// At density 1.
MassProperties ellipsoidMass(const Vec3& halfAxes);

/// Integrals of a mass with this tensor about its center of mass, (xx, yy, zz, xy, xz, yz), in that frame.
SolidSums sumsOfTensor(double mass, const std::array<double, 6>& tensor);

}  // namespace rubble::convert

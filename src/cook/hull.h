#pragma once
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// A convex polyhedron.
struct Hull {
  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> faces;  ///< corners, counter-clockwise seen from outside
  std::vector<Vec3> normals;            ///< outward, unit, one a face
};

/// The convex hull of points, faces that lie in one plane united (qhull; Barber, Dobkin, Huhdanpaa 1996).
/// Throws Error at `path` if the points lie in one plane, or if this build has no qhull.
Hull convexHull(const std::vector<Vec3>& points, const std::string& path);
/// Is qhull in this build?
bool hasHulls();

}  // namespace rubble

#pragma once
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// A convex polyhedron.
struct Hull {
  std::vector<Vec3> vertices;
  std::vector<std::vector<int>> faces;  ///< corners, counter-clockwise seen from outside
  std::vector<Vec3> normals;            ///< outward unit normals, one per face
};

/// Convex hull of points with coplanar faces merged (qhull; Barber, Dobkin, Huhdanpaa 1996). Throws Error at
/// `path` if the points are coplanar, or if this build has no qhull.
Hull convexHull(const std::vector<Vec3>& points, const Path& path);
/// Returns whether this build has qhull.
bool hasHulls();

}  // namespace rubble

#pragma once
/// Convex hulls with few corners.
#include <string>
#include <vector>

#include <rubble/math.h>

namespace rubble::convert {

/// Largest number of corners of a hull that is made of a mesh. Contact tests cost time in proportion to it.
inline constexpr std::size_t kMostCorners = 64;
/// The points of at most kMostCorners corners of the convex hull: those farthest along evenly spread
/// directions. `reduced`: were there more? Throws Error at `path` if the points lie in one plane.
std::vector<Vec3> cornersOf(const std::vector<Vec3>& points, bool& reduced, const std::string& path);

/// Unit vectors that are spread evenly, and the six along the axes.
std::vector<Vec3> directions(int count);

}  // namespace rubble::convert

#pragma once
/// From shapes as authored to shapes as engines take them.
#include <string>

#include "collision/cooked_shape.h"

namespace rubble {

/// Throws Error with `path` for geometry that no solid or surface can be made of.
CookedShape cook(const Shape& shape, const std::string& path = "shape");

/// Steps of cook() for single types that validate() has nothing against, in the frame of the author: `unit`
/// has centre and axes, nothing is moved yet.
namespace cooking {

/// A hull about the engine's frame that `unit` says.
void addHull(CookedShape& out, const Shape& shape, const std::string& path);
void addCompound(CookedShape& out, const Shape& shape, const std::string& path);
void addMesh(CookedShape& out, const Shape& shape, const std::string& path);
void addHeightField(CookedShape& out, const Shape& shape);
void addDistanceField(CookedShape& out, const Shape& shape, const std::string& path);

/// Begins the header of a shape's tables: the places of its vectors and indices, which follow what is there
/// already. The header itself is to be filled up to `size` numbers before anything else is added to the
/// indices.
int beginHeader(CookedShape& out, int size);

/// Bit e of a triangle: its edge from corner e on is one that other shapes can touch; bit 3 + k: so is corner
/// k. An edge within a face, or in a hollow, is none: what lies there is touched by the faces. `twoSided`:
/// the same from the back, six bits further up. `beyond`, if wanted: for each edge the corner of the triangle
/// on its other side that is not its own, -1 where there is not exactly one.
std::vector<int> touchableEdges(const std::vector<Vec3>& points,
                                const std::vector<std::array<int, 3>>& triangles, bool twoSided,
                                std::vector<int>* beyond = nullptr);

}  // namespace cooking
}  // namespace rubble

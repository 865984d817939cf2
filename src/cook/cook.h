#pragma once
/// Converts authored shapes to the form that engines use (cooking).
#include <string>

#include "collision/cooked_shape.h"

namespace rubble {

/// Throws Error with `path` for degenerate geometry.
CookedShape cook(const Shape& shape, const Path& path = "shape");

/// Steps of cook() for single types, in the authored frame, for shapes that passed validate(). `unit` has
/// center and axes; no data is transformed yet.
namespace cooking {

/// Appends a hull, transformed to the engine frame given by `unit`.
void addHull(CookedShape& out, const Shape& shape, const Path& path);
void addCompound(CookedShape& out, const Shape& shape, const Path& path);
void addMesh(CookedShape& out, const Shape& shape, const Path& path);
void addHeightField(CookedShape& out, const Shape& shape, const Path& path);
void addDistanceField(CookedShape& out, const Shape& shape, const Path& path);

/// Starts the header of a shape's tables: the offsets of its vectors and indices. The header must be filled
/// to `size` numbers before other indices are appended.
int beginHeader(CookedShape& out, int size);

/// Flags of triangle edges and corners that contacts may use. Bit e: the edge from corner e on. Bit 3 + k:
/// corner k. Edges within a flat face and concave edges are not flagged, since contacts there belong to the
/// faces. `twoSided`: the same for the back, six bits higher. `beyond`, if not null: per edge, the opposite
/// corner of the adjacent triangle, or -1 if there is not exactly one.
std::vector<int> touchableEdges(const std::vector<Vec3>& points,
                                const std::vector<std::array<int, 3>>& triangles, bool twoSided,
                                std::vector<int>* beyond = nullptr);

}  // namespace cooking
}  // namespace rubble

#pragma once
/// The surface of a deformable object: boundary triangles of solids, and collision features.
#include <utility>

#include "forces/soft_model.h"

namespace rubble {

/// Outward faces that belong to exactly one tetrahedron.
std::vector<std::array<int, 3>> boundaryOf(const std::vector<std::array<int, 4>>& tetrahedra);

/// Adds triangles, their edges and `bare` edges as collision features. `elements`: triangle k is removed with
/// membrane k, bare edge k with spring k. The radii of the vertices must be set.
void addSurface(SoftModel& model, const DeformableDef& def, const std::vector<std::array<int, 3>>& triangles,
                const std::vector<std::pair<int, int>>& bare, bool elements);

}  // namespace rubble

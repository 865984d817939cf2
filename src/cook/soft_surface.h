#pragma once
/// The surface of a deformable object: what is drawn of a solid, and what other surfaces meet.
#include <utility>

#include "forces/soft_model.h"

namespace rubble {

/// Faces that belong to one tetrahedron only, outward.
std::vector<std::array<int, 3>> boundaryOf(const std::vector<std::array<int, 4>>& tetrahedra);

/// Triangles, their edges and `bare` edges as what other surfaces meet. `elements`: triangle k vanishes with
/// membrane k, bare edge k with spring k. The radii of the vertices are set.
void addSurface(SoftModel& model, const DeformableDef& def, const std::vector<std::array<int, 3>>& triangles,
                const std::vector<std::pair<int, int>>& bare, bool elements);

}  // namespace rubble

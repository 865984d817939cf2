#pragma once
/// Tests of surfaces that use positions only and no code of the engine, in double precision.
#include <rubble/world.h>

namespace rubble::scenes {

/// Edges and triangles without a common corner that cross or touch, within all deformable objects and between
/// them. By separating axes: two are apart only if an axis shows it by more than the round-off of the test,
/// so that none that cross is missed.
int countCrossings(const World& world);
/// The same of given surfaces.
int countCrossings(const std::vector<World::Surface>& surfaces);

/// Least distance over the distance that they should keep (the sum of the radii) of two segments of lines
/// that share no corner nor a neighboring segment [1]; 1e30 if there are none.
double closestSegments(const World& world);

/// How often two closed lines wind around one another (Gauss linking number, from solid angles). The number
/// changes only if they cross.
double linkingNumber(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace rubble::scenes

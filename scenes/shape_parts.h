#pragma once
/// Shared by the scenes of shapes: forms, and a probe for final positions.
#include <cstdint>
#include <memory>
#include <vector>

#include "build.h"

namespace rubble::scenes {

/// Corners of an upright prism with a regular base about local z.
std::vector<Vec3> prismCorners(int sides, double radius, double halfHeight);
/// A pebble: corners spread over an ellipsoid, a little off it; `key` picks one of many.
Shape pebble(double size, std::uint32_t key);
/// A shape of about that size, one kind after another: box, cylinder, pebble, cone, rounded box, prism,
/// capsule, sphere, cross.
Shape mixedShape(double size, int index);
/// Distances of a lattice that covers [low, high] with cells of that size.
Shape distanceShape(const Vec3& low, const Vec3& high, double spacing,
                    const std::function<double(const Vec3&)>& distance);

/// inside_ratio: share of the dynamic bodies whose frames lie in [low, high] at the end.
std::unique_ptr<Probe> insideProbe(const Vec3& low, const Vec3& high);

}  // namespace rubble::scenes

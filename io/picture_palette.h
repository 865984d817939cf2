#pragma once
#include <cstdint>

#include "io/picture_raster.h"

namespace rubble::io::draw {

/// Colours are linear light (red, green, blue), 0 to 1.

/// A body's own colour: one family for each kind of shape, varied a little from body to body.
Vec bodyColor(const PictureBody& body);
/// Cold and dark at rest, through teal and yellow to red at `fraction` 1.
Vec speedColor(double fraction);
/// Linear light to a byte of sRGB, highlights rolled off.
Vec displayed(const Vec& light);

/// A well-mixed hash.
std::uint32_t hash(std::uint32_t value);

}  // namespace rubble::io::draw

#pragma once
#include <array>
#include <cstdint>

#include "io/picture_raster.h"

namespace rubble::io::draw {

/// Colours are linear light (red, green, blue), 0 to 1.

/// A body's own colour: one family for each kind of shape, varied a little from body to body.
Vec bodyColor(const PictureBody& body);
/// Of values (sRGB): cold and dark at 0, through teal and yellow to red at 1.
inline constexpr std::array<std::uint32_t, 6> kHeatStops{0x4a5a72, 0x2f7f93, 0x5fb58b, 0xe9d46a, 0xee8f3c, 0xd6362f};
/// Of kinds (sRGB), which are told apart and have no order.
inline constexpr std::array<std::uint32_t, 12> kKindColors{0xc0604a, 0x3f7f93, 0xd9b35c, 0x6c9362, 0x8e6a94, 0x4f6fa8,
                                                           0xd08a4e, 0x5aa59a, 0xb5566f, 0x9aa04c, 0x7f6a5a, 0x7aa7cf};
/// Of what has no value (sRGB).
inline constexpr std::uint32_t kNoValue = 0x9a9c9e;
/// Colour of a value: along kHeatStops up to `full`, or for a quantity of kinds one of kKindColors.
Vec valueColor(double value, ColorBy colorBy, double full);
/// Linear light to a byte of sRGB, highlights rolled off.
Vec displayed(const Vec& light);

/// A well-mixed hash.
std::uint32_t hash(std::uint32_t value);

}  // namespace rubble::io::draw

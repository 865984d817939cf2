#include "io/picture_palette.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "io/picture_values.h"

namespace rubble::io::draw {
namespace {

float toLinear(float srgb) { return srgb <= .04045f ? srgb / 12.92f : std::pow((srgb + .055f) / 1.055f, 2.4f); }

Vec fromHex(std::uint32_t rgb) {
  const auto channel = [&](int shift) { return toLinear(static_cast<float>((rgb >> shift) & 255u) / 255.f); };
  return {channel(16), channel(8), channel(0)};
}

Vec mix(const Vec& a, const Vec& b, float t) { return a + (b - a) * t; }

/// Two ends of each family: bodies of one kind lie between them.
constexpr std::array<std::array<std::uint32_t, 2>, 5> kFamilies{{
    {0xb9532f, 0xe2b07e},  // brick
    {0x1f5673, 0x5fa3b5},  // harbour
    {0x56703b, 0xb4bf76},  // moss
    {0x6a4a78, 0xb894b5},  // heather
    {0xb98a1c, 0xecd07a},  // straw
}};
constexpr std::uint32_t kStaticColor = 0xa3a7ab;
constexpr std::uint32_t kKinematicColor = 0x52616b;
constexpr std::uint32_t kPlaneColor = 0xcfd2d4;

std::uint32_t sizeBits(double size) { return std::bit_cast<std::uint32_t>(static_cast<float>(size)) >> 12; }

/// Boxes are bricks, spheres are blue, capsules of one radius are alike.
std::size_t familyOf(const Shape& shape) {
  if (shape.type == ShapeType::Box) return 0;
  return shape.type == ShapeType::Sphere ? 1 : 2 + hash(sizeBits(shape.radius)) % 3;
}

}  // namespace

std::uint32_t hash(std::uint32_t value) {
  value ^= value >> 16;
  value *= 0x7feb352du;
  value ^= value >> 15;
  value *= 0x846ca68bu;
  return value ^ (value >> 16);
}

Vec bodyColor(const PictureBody& body) {
  if (body.shape.type == ShapeType::Plane) return fromHex(kPlaneColor);
  const std::uint32_t bits = hash(body.key + 1);
  const float shade = .92f + .16f * static_cast<float>((bits >> 8) & 255u) / 255.f;
  if (body.motion == Motion::Static) return fromHex(kStaticColor) * shade;
  if (body.motion == Motion::Kinematic) return fromHex(kKinematicColor) * shade;
  const auto& family = kFamilies[familyOf(body.shape)];
  const float along = static_cast<float>(bits & 255u) / 255.f;
  return mix(fromHex(family[0]), fromHex(family[1]), along) * shade;
}

Vec valueColor(double value, ColorBy colorBy, double full) {
  if (std::isnan(value)) return fromHex(kNoValue);
  if (quantity(colorBy).isKind) return value < 0 ? fromHex(kNoValue) : fromHex(kKindColors[static_cast<std::size_t>(value) % kKindColors.size()]);
  const float at = static_cast<float>(full > 0 ? std::clamp(value / full, 0., 1.) : 0) * (kHeatStops.size() - 1);
  const auto stop = std::min(static_cast<std::size_t>(at), kHeatStops.size() - 2);
  return mix(fromHex(kHeatStops[stop]), fromHex(kHeatStops[stop + 1]), at - static_cast<float>(stop));
}

Vec displayed(const Vec& light) {
  const auto channel = [](float value) {
    // Straight up to .7, then towards 1 without ever clipping.
    constexpr float kKnee = .7f;
    const float x = std::max(value, 0.f);
    const float rolled = x <= kKnee ? x : kKnee + (1 - kKnee) * (1 - std::exp(-(x - kKnee) / (1 - kKnee)));
    return rolled <= .0031308f ? 12.92f * rolled : 1.055f * std::pow(rolled, 1 / 2.4f) - .055f;
  };
  return {channel(light.x), channel(light.y), channel(light.z)};
}

}  // namespace rubble::io::draw

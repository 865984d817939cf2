#include "render/palette.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "io/picture_values.h"

namespace rubble::render {
namespace {

/// Scenes with fewer boxes are not stacks: each box has its own color.
constexpr std::size_t kStack = 30;
/// A ball this much larger than a brick is a wrecking ball.
constexpr double kWreckingBall = 1.3;

/// From the lowest course to the highest: clay, sandstone, limestone.
constexpr std::array<std::uint32_t, 6> kCourses{0x6a4d45, 0x8f6656, 0xab846b, 0xbc9c7d, 0xc6b192, 0xcdc0a6};
/// Colors that go with one another, for scenes of few bodies.
constexpr std::array<std::uint32_t, 8> kAccents{0xab6a52, 0x4a7480, 0xc9a668, 0x6f8868,
                                                0x86667c, 0x566f8f, 0xb4957a, 0x7b888d};
/// Of values: cold and dark at 0, through teal and yellow to red at 1.
constexpr std::array<std::uint32_t, 6> kHeatStops{0x4a5a72, 0x2f7f93, 0x5fb58b, 0xe9d46a, 0xee8f3c, 0xd6362f};
/// Of what has no value.
constexpr std::uint32_t kNoValue = 0x9a9c9e;
constexpr std::uint32_t kRope = 0x5b5247;
constexpr std::uint32_t kConcrete = 0xb4b3ae, kSteel = 0x6d7378, kDarkMetal = 0x77777a,
                        kGroundColor = 0xb5b3af;

std::uint32_t mixed(std::uint32_t value) {
  value ^= value >> 16;
  value *= 0x7feb352du;
  value ^= value >> 15;
  value *= 0x846ca68bu;
  return value ^ (value >> 16);
}
float fraction(std::uint32_t bits, int shift) { return static_cast<float>((bits >> shift) & 255u) / 255.f; }

/// Neighbors take colors that are far apart.
std::size_t accentOf(std::uint32_t kind) { return (kind * 5u + 3u) % kAccents.size(); }

double middleOf(std::vector<double>& values, double fallback) {
  if (values.empty()) return fallback;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Vec3f along(std::span<const std::uint32_t> stops, double t) {
  const double at = std::clamp(t, 0., 1.) * static_cast<double>(stops.size() - 1);
  const std::size_t stop = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const Vec3f a = linearColor(stops[stop]), b = linearColor(stops[stop + 1]);
  return a + (b - a) * static_cast<float>(at - static_cast<double>(stop));
}

}  // namespace

Vec3f linearColor(const Vec3f& srgb) {
  const auto channel = [](float s) {
    return s <= .04045f ? s / 12.92f : std::pow((s + .055f) / 1.055f, 2.4f);
  };
  return {channel(srgb.x), channel(srgb.y), channel(srgb.z)};
}

Vec3f linearColor(std::uint32_t rgb) {
  const auto channel = [&](int shift) { return static_cast<float>((rgb >> shift) & 255u) / 255.f; };
  return linearColor(Vec3f{channel(16), channel(8), channel(0)});
}

Vec3f heat(double fraction) { return along(kHeatStops, fraction); }

std::vector<float> heatStops() {
  std::vector<float> out;
  for (const std::uint32_t stop : kHeatStops) {
    const Vec3f c = linearColor(stop);
    out.insert(out.end(), {c.x, c.y, c.z});
  }
  return out;
}

Vec3f valueColor(double value, io::ColorBy colorBy, double full) {
  if (std::isnan(value)) return linearColor(kNoValue);
  if (!io::quantity(colorBy).isKind) return heat(full > 0 ? value / full : 0);
  return linearColor(value < 0 ? kNoValue
                               : kKindColors[static_cast<std::size_t>(value) % kKindColors.size()]);
}

Palette::Palette(std::span<const io::PictureBody> bodies, const Vec3& up) : up_(up) {
  std::vector<double> heights;
  std::size_t boxes = 0;
  double low = 1e30, high = -1e30;
  for (const io::PictureBody& body : bodies) {
    if (body.shape.type == ShapeType::Plane || body.motion == Motion::Static || body.deforms) continue;
    const double height = dot(body.position, up);
    if (std::isfinite(height)) low = std::min(low, height), high = std::max(high, height);
    if (body.shape.type != ShapeType::Box) continue;
    ++boxes;
    heights.push_back(2 * dot(abs(rotateInverse(body.orientation, up)), body.shape.halfExtents));
  }
  bodySize_ = io::typicalSize(bodies);
  course_ = std::max(1e-6, middleOf(heights, 1));
  isStack_ = boxes >= kStack;
  isFlat_ = high - low < 1.5 * course_;
  if (low <= high) low_ = low, high_ = std::max(high, low + 3 * course_);
}

Vec3f Palette::stone(const io::PictureBody& body) const {
  const std::uint32_t bits = mixed(body.key + 1);
  const float shade = .90f + .20f * fraction(bits, 8);
  if (!isStack_) return linearColor(kAccents[accentOf(body.key)]) * shade;
  const double height = dot(body.position, up_) - low_;
  // Courses differ a little from one another, bricks of a course less.
  const auto course = static_cast<std::uint32_t>(std::max(0., std::round(height / course_)));
  // Within one course bodies differ in shade only.
  const double place = isFlat_ ? .25 + .45 * fraction(bits, 16) : height / (high_ - low_);
  const double t = place + .05 * (fraction(mixed(course + 11), 0) - .5) + .07 * (fraction(bits, 0) - .5);
  return along(kCourses, t) * shade;
}

Vec3f Palette::softColor(std::uint32_t key) const {
  if (key == io::kRopeKey) return linearColor(kRope);
  return linearColor(kAccents[accentOf(key >> io::kSoftKeyBits)]) *
         (.93f + .14f * fraction(mixed(key + 1), 8));
}

BodyLook Palette::look(const io::PictureBody& body) {
  if (body.color) {
    BodyLook look = newLook(body);
    look.color = linearColor(Vec3f(*body.color));
    if (look.finish != Finish::Ground) look.finish = Finish::Paint;
    return look;
  }
  // The key of a body that was removed may come back with another.
  const auto known = known_.find(body.key);
  if (known != known_.end() && io::sameShape(known->second.shape, body.shape)) return known->second.look;
  return (known_[body.key] = {body.shape, newLook(body)}).look;
}

BodyLook Palette::newLook(const io::PictureBody& body) const {
  BodyLook look;
  const Shape& shape = body.shape;
  const std::uint32_t bits = mixed(body.key + 1);
  const float shade = .93f + .14f * fraction(bits, 8);
  switch (shape.type) {
    case ShapeType::Box:
      look.geometry = shape.rounding > 0 ? kOwnMesh : kBox;
      look.size = shape.rounding > 0 ? Vec3f{1, 1, 1} : Vec3f(shape.halfExtents);
      look.color = stone(body);
      break;
    case ShapeType::Sphere:
    case ShapeType::Capsule: {
      const auto radius = static_cast<float>(shape.radius);
      look.geometry = kRound;
      look.size = {radius, radius, radius};
      look.halfLength = shape.type == ShapeType::Capsule ? static_cast<float>(shape.halfLength) : 0;
      const bool wrecks = isStack_ && shape.type == ShapeType::Sphere &&
                          shape.radius > kWreckingBall * bodySize_;
      look.finish = wrecks ? Finish::Metal : Finish::Plastic;
      // Capsules of one radius are links of one chain or bundle.
      const std::uint32_t ball = body.key >= io::kSoftKeys ? body.key >> io::kSoftKeyBits : body.key;
      const std::uint32_t kind = shape.type == ShapeType::Capsule
                                     ? mixed(std::bit_cast<std::uint32_t>(radius) >> 12)
                                     : ball;
      look.color = wrecks ? linearColor(kDarkMetal) : linearColor(kAccents[accentOf(kind)]) * shade;
      break;
    }
    case ShapeType::Plane:
      look.geometry = kPlane;
      look.color = linearColor(kGroundColor);
      look.finish = Finish::Ground;
      return look;
    case ShapeType::Cylinder:
    case ShapeType::Cone: {
      const auto radius = static_cast<float>(shape.radius);
      const bool plain = shape.rounding == 0;
      look.geometry = plain && shape.type == ShapeType::Cylinder ? kCylinder : kOwnMesh;
      look.size = plain ? Vec3f{radius, radius, static_cast<float>(shape.halfLength)} : Vec3f{1, 1, 1};
      look.color = linearColor(kAccents[accentOf(body.key)]) * shade;
      break;
    }
    default:
      look.geometry = kOwnMesh;
      look.size = {1, 1, 1};
      look.color = stone(body);
      break;
  }
  if (body.motion == Motion::Static) look.color = linearColor(kConcrete) * shade;
  if (body.motion == Motion::Kinematic) {
    look.color = linearColor(kSteel) * shade;
    look.finish = Finish::Metal;
  }
  return look;
}

}  // namespace rubble::render

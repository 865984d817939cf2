#include "io/picture.h"

#include <algorithm>
#include <cmath>

#include <rubble/error.h>

#include "io/picture_extent.h"
#include "io/picture_light.h"
#include "io/picture_palette.h"
#include "io/picture_raster.h"
#include "io/picture_values.h"

namespace rubble::io {
namespace {

using namespace draw;

/// Samples a pixel, each way.
constexpr int kSamples = 2;
constexpr Vec kSunlight{2.05f, 1.9f, 1.65f};
constexpr Vec kSkylight{.62f, .74f, .92f};
constexpr Vec kGroundlight{.42f, .38f, .34f};
constexpr Vec kZenith{.36f, .50f, .68f};
constexpr Vec kHorizon{.80f, .84f, .88f};

Vec mix(const Vec& a, const Vec& b, float t) { return a + (b - a) * t; }
float smoothstep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

View cameraView(const PictureSettings& s) {
  if (s.width < 1 || s.height < 1)
    throw Error("picture.size", "at least one pixel", std::to_string(s.width) + "x" + std::to_string(s.height));
  if (!(s.fieldOfView > 0 && s.fieldOfView < 3.1))
    throw Error("picture.fieldOfView", "an angle above 0 and below 3.1 rad", std::to_string(s.fieldOfView));
  const double distance = length(s.target - s.eye);
  if (!(distance > 0)) throw Error("picture.eye", "a point other than the target", "the target");
  View view;
  view.eye = s.eye;
  view.forward = (s.target - s.eye) / distance;
  const Vec3 right = cross(view.forward, s.up);
  // Straight up or down there is no natural right: any will do.
  const Vec3 spare = cross(view.forward, std::fabs(view.forward.x) < .9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  view.right = normalize(lengthSquared(right) > 1e-18 * lengthSquared(s.up) ? right : spare);
  view.up = cross(view.right, view.forward);
  view.width = kSamples * s.width;
  view.height = kSamples * s.height;
  view.scale = static_cast<float>(view.height / (2 * std::tan(s.fieldOfView / 2)));
  view.nearest = static_cast<float>(1e-3 * distance);
  return view;
}

/// How far occlusion reaches: the size of a typical body [m].
float occlusionRadius(std::span<const PictureBody> bodies) {
  std::vector<double> sizes;
  for (const PictureBody& body : bodies) {
    if (body.shape.type == ShapeType::Plane || body.motion == Motion::Static) continue;
    const Vec3& h = body.shape.halfExtents;
    sizes.push_back(body.shape.type == ShapeType::Box ? std::cbrt(h.x * h.y * h.z) : .6 * boundingRadius(body.shape));
  }
  if (sizes.empty()) return 1;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return static_cast<float>(3 * *middle);
}

class Painter {
 public:
  Painter(std::span<const PictureBody> bodies, const PictureSettings& settings);
  Image paint() const;

 private:
  Vec sample(int x, int y) const;
  Vec sky(const Vec& direction) const;
  Vec surfaceColor(std::uint32_t index, std::uint32_t face, const Vec& point, float nearness) const;
  float groundLines(const ViewBody& body, const Vec& point, float nearness) const;
  float skySeen(int x, int y) const;

  std::span<const PictureBody> bodies_;
  View view_;
  std::vector<ViewBody> viewBodies_;
  Vec up_;  ///< view space
  Vec3 toSunWorld_;
  Vec toSun_;       ///< view space
  float distance_;  ///< eye to target [m]
  Surfaces seen_;
  std::vector<Vec> colors_;
  std::vector<float> skyVisible_;
  Shadow shadow_;
};

Vec3 sunDirection(const View& view, const Vec3& up) {
  // Over the left shoulder of the viewer, high.
  const Vec3 back = normalize(-view.forward + up * dot(view.forward, up), -view.up);
  return normalize(up * .95 - view.right * .6 + back * .35);
}

Painter::Painter(std::span<const PictureBody> bodies, const PictureSettings& settings)
    : bodies_(bodies),
      view_(cameraView(settings)),
      viewBodies_(toView(view_, bodies)),
      up_(view_.turnToView(normalize(settings.up))),
      toSunWorld_(sunDirection(view_, normalize(settings.up))),
      toSun_(view_.turnToView(toSunWorld_)),
      distance_(static_cast<float>(length(settings.target - settings.eye))),
      seen_(view_, true),
      shadow_(view_, bodies, toSunWorld_) {
  rasterize(view_, viewBodies_, seen_);
  skyVisible_ = skyVisibility(view_, seen_, viewBodies_, occlusionRadius(bodies));
  const double full = settings.fullValue > 0 ? settings.fullValue : largestValue(bodies, settings.colorBy);
  for (const PictureBody& body : bodies) {
    const bool own = settings.colorBy == ColorBy::Body || body.motion == Motion::Static;
    colors_.push_back(own ? bodyColor(body) : valueColor(shownValue(body, settings.colorBy), settings.colorBy, full));
  }
}

Vec Painter::sky(const Vec& direction) const {
  const float height = dot(normalize(direction), up_);
  return mix(kHorizon, kZenith, smoothstep(-.02f, .55f, height));
}

/// How dark a line is at a distance from its middle, for a line of some width seen at some size of a pixel.
float line(float distance, float width, float pixel) {
  const float soft = std::max(pixel, 1e-6f);
  const float covered = 1 - smoothstep(width, width + soft, distance);
  return covered * std::min(1.f, width / soft + .35f);
}

float Painter::groundLines(const ViewBody& body, const Vec& point, float nearness) const {
  const Vec p = point - body.center;
  const float pixel = 2 / (view_.scale * nearness);
  const float slant = std::max(.05f, std::fabs(dot(body.axes[2], normalize(point))));
  const float cell = std::pow(10.f, std::round(std::log10(distance_ / 12)));
  const float faded = 1 - smoothstep(.15f, .5f, pixel / slant / cell);
  if (faded <= 0) return 0;
  float dark = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const float u = dot(p, body.axes[axis]);
    const auto from = [&](float step) { return std::fabs(u - step * std::round(u / step)); };
    dark = std::max(dark, .5f * line(from(cell), .006f * cell, pixel));
    dark = std::max(dark, line(from(10 * cell), .012f * cell, pixel));
  }
  return dark * faded;
}

Vec Painter::surfaceColor(std::uint32_t index, std::uint32_t face, const Vec& point, float nearness) const {
  const ViewBody& body = viewBodies_[index];
  const Vec color = colors_[index];
  const float pixel = 2 / (view_.scale * nearness);
  const Vec p = point - body.center;
  switch (body.type) {
    case ShapeType::Plane:
      return color * (1 - .28f * groundLines(body, point, nearness));
    case ShapeType::Box: {
      if (body.mesh) break;
      // A fine dark rim tells neighbours apart.
      const int axis = static_cast<int>(face / 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
      const float toRim = std::min(body.half[u] - std::fabs(dot(p, body.axes[u])), body.half[v] - std::fabs(dot(p, body.axes[v])));
      const float smallest = std::min(body.half[u], body.half[v]);
      const float visible = 1 - smoothstep(.05f, .35f, pixel / smallest);
      return color * (1 - .35f * visible * (1 - smoothstep(0, std::max(.035f * smallest, 1.1f * pixel), toRim)));
    }
    case ShapeType::Sphere:
    case ShapeType::Capsule:
    case ShapeType::Cylinder:
    case ShapeType::Cone: {
      // Sectors in two shades make rolling visible.
      int sectors = 0;
      for (int axis = 0; axis < (body.type == ShapeType::Sphere ? 3 : 2); ++axis) sectors += dot(p, body.axes[axis]) > 0;
      return color * (sectors % 2 == 0 ? 1.f : .78f);
    }
    default:
      break;
  }
  return color;
}

float Painter::skySeen(int x, int y) const {
  const std::size_t pixelsAcross = static_cast<std::size_t>(view_.width / kSamples);
  const float nearness = seen_.nearness[seen_.at(x, y)];
  const int px = x / kSamples, py = y / kSamples;
  // The pixel whose depth is the most like this sample's: at an outline the sample's own pixel may show another body.
  float best = std::numeric_limits<float>::infinity(), visible = 1;
  constexpr int kNear[5][2] = {{0, 0}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (const auto& offset : kNear) {
    const int sx = px + offset[0], sy = py + offset[1];
    if (sx < 0 || sy < 0 || sx >= view_.width / kSamples || sy >= view_.height / kSamples) continue;
    const float difference = std::fabs(seen_.nearness[seen_.at(kSamples * sx, kSamples * sy)] - nearness);
    if (difference < best) {
      best = difference;
      visible = skyVisible_[static_cast<std::size_t>(sy) * pixelsAcross + static_cast<std::size_t>(sx)];
      if (difference < .01f * nearness) break;
    }
  }
  return visible;
}

Vec Painter::sample(int x, int y) const {
  const Vec direction{view_.planeX(x), view_.planeY(y), 1};
  const std::size_t at = seen_.at(x, y);
  const std::uint32_t surface = seen_.surface[at];
  if (surface == kNothing) return sky(direction);
  const float nearness = seen_.nearness[at];
  const Vec point = direction * (1 / nearness);
  const std::uint32_t index = surface / 8, face = surface % 8;
  const Vec normal = normalAt(viewBodies_[index], face, point, seen_.detail[at]);
  const float open = skySeen(x, y);
  const float facing = std::max(0.f, dot(normal, toSun_));
  const auto pattern =
      static_cast<std::uint32_t>((x & 1) + 2 * (y & 1)) * 16 + hash(static_cast<std::uint32_t>((x / 2 % 4) + 4 * (y / 2 % 4))) % 16;
  const float sun = facing > 0 ? facing * shadow_.sunlight(point, normal, pattern) : 0;
  const Vec ambient = mix(kGroundlight, kSkylight, .5f + .5f * dot(normal, up_)) * (.62f * open);
  const Vec light = ambient + kSunlight * (sun * (.65f + .35f * open));
  const Vec lit = mul(surfaceColor(index, face, point, nearness), light) * .62f;
  const float haze = 1 - std::exp(-.012f * std::pow(std::max(0.f, 1 / (nearness * distance_) - 1.2f), 1.5f));
  return mix(lit, kHorizon, std::clamp(haze, 0.f, 1.f));
}

Image Painter::paint() const {
  Image image{view_.width / kSamples, view_.height / kSamples, {}};
  image.rgb.reserve(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      Vec sum;
      for (int sy = 0; sy < kSamples; ++sy)
        for (int sx = 0; sx < kSamples; ++sx) sum += displayed(sample(kSamples * x + sx, kSamples * y + sy));
      for (int c = 0; c < 3; ++c) image.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * sum[c] / (kSamples * kSamples))));
    }
  }
  return image;
}

bool finite(const PictureBody& body) {
  const Vec3& p = body.position;
  const Quat& q = body.orientation;
  return std::isfinite(p.x + p.y + p.z + q.s + q.v.x + q.v.y + q.v.z) && std::isfinite(body.speed);
}

}  // namespace

Image drawPicture(std::span<const PictureBody> bodies, const PictureSettings& settings) {
  std::vector<PictureBody> drawable;
  for (const PictureBody& body : bodies)
    if (finite(body)) drawable.push_back(body);
  return Painter(drawable, settings).paint();
}

}  // namespace rubble::io

#include "io/picture_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "io/picture_extent.h"
#include "io/picture_palette.h"

namespace rubble::io::draw {
namespace {

constexpr int kSmallestMap = 256, kLargestMap = 4096;
/// Half the angle under which the sun is seen: soft enough to read, sharp at the foot of things.
constexpr float kSunSpread = .045f;
constexpr float kTurn = 2 * std::numbers::pi_v<float>;

bool inSight(const View& camera, const PictureBody& body) {
  const Vec p = camera.toView(body.position);
  const float slack = 1.3f;
  return p.z > 0 && std::fabs(p.x) < slack * p.z * static_cast<float>(camera.width) / (2 * camera.scale) &&
         std::fabs(p.y) < slack * p.z * static_cast<float>(camera.height) / (2 * camera.scale);
}

View sunView(const View& camera, std::span<const PictureBody> bodies, const Vec3& toSun) {
  View view;
  view.perspective = false;
  view.width = view.height = 1;
  view.forward = -toSun;
  view.right = normalize(cross(view.forward, std::fabs(toSun.x) < .9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  view.up = cross(view.right, view.forward);
  std::vector<double> xs, ys;
  double margin = 0;
  for (const bool onlyMoving : {true, false}) {
    for (const PictureBody& body : bodies) {
      if (body.shape.type == ShapeType::Plane || (onlyMoving && body.motion == Motion::Static) || !inSight(camera, body)) continue;
      xs.push_back(dot(view.right, body.position));
      ys.push_back(dot(view.up, body.position));
      margin = std::max(margin, boundingRadius(body.shape));
    }
    if (!xs.empty()) break;
  }
  if (xs.empty()) return view;
  const Range x = coreRange(std::move(xs)), y = coreRange(std::move(ys));
  view.eye = view.right * x.middle() + view.up * y.middle();
  // As fine as the picture is.
  view.width = view.height = std::clamp(std::max(camera.width, camera.height), kSmallestMap / 2, kLargestMap / 2) * 2;
  view.scale = static_cast<float>(view.width / (2.1 * (std::max(x.half(), y.half()) + margin)));
  return view;
}

/// `count` points of a disc, evenly spread, turned by `turn` [1 = once round].
template <std::size_t count> struct Disc {
  std::array<float, count> x, y;
  explicit Disc(float turn) {
    for (std::size_t i = 0; i < count; ++i) {
      const float radius = std::sqrt((static_cast<float>(i) + .5f) / count);
      const float angle = kTurn * (turn + .618034f * static_cast<float>(i));
      x[i] = radius * std::cos(angle);
      y[i] = radius * std::sin(angle);
    }
  }
};

constexpr std::size_t kPatterns = 64;

/// Discs turned by equal amounts; neighbours in the list are far apart in angle.
template <std::size_t count> const std::vector<Disc<count>>& discs() {
  static const std::vector<Disc<count>> all = [] {
    std::vector<Disc<count>> made;
    for (std::size_t i = 0; i < kPatterns; ++i) made.emplace_back(std::fmod(.618034f * static_cast<float>(i), 1.f));
    return made;
  }();
  return all;
}

}  // namespace

Shadow::Shadow(const View& camera, std::span<const PictureBody> bodies, const Vec3& toSun)
    : view_(sunView(camera, bodies, toSun)), map_(view_, false), texel_(1 / view_.scale), empty_(view_.width == 1) {
  const auto column = [&](const Vec3& axis) { return view_.turnToView(axis); };
  turn_ = {column(camera.right), column(camera.up), column(camera.forward)};
  shift_ = view_.toView(camera.eye);
  if (!empty_) rasterize(view_, toView(view_, bodies), map_);
}

Vec Shadow::toMap(const Vec& pointInCamera) const { return turn_ * pointInCamera + shift_; }

float Shadow::nearnessAt(float x, float y) const {
  const float half = .5f * static_cast<float>(view_.width);
  const int column = static_cast<int>(x * view_.scale + half), row = static_cast<int>(half - y * view_.scale);
  if (column < 0 || row < 0 || column >= view_.width || row >= view_.height) return -std::numeric_limits<float>::infinity();
  return map_.nearness[map_.at(column, row)];
}

float Shadow::sunlight(const Vec& pointInCamera, const Vec& normalInCamera, std::uint32_t pattern) const {
  if (empty_) return 1;
  const Vec p = toMap(pointInCamera + normalInCamera * (1.5f * texel_));
  const float widest = 24 * texel_;
  const float edge = .5f * static_cast<float>(view_.width) * texel_ - widest;
  if (std::fabs(p.x) > edge || std::fabs(p.y) > edge) return 1;
  const float bias = 1.5f * texel_;

  // What stands in the way, and how far off it is on average, gives the width of the half shadow.
  const Disc<8>& search = discs<8>()[pattern % kPatterns];
  float distance = 0;
  int blockers = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const float ahead = nearnessAt(p.x + widest * search.x[i], p.y + widest * search.y[i]) + p.z;
    if (ahead > bias) distance += ahead, ++blockers;
  }
  if (blockers == 0) return 1;
  const float width = std::clamp(distance / static_cast<float>(blockers) * kSunSpread, 1.5f * texel_, widest);
  const Disc<8>& taps = discs<8>()[(pattern + 29) % kPatterns];
  int lit = 0;
  for (std::size_t i = 0; i < 8; ++i) lit += nearnessAt(p.x + width * taps.x[i], p.y + width * taps.y[i]) + p.z < bias;
  return static_cast<float>(lit) / 8;
}

namespace {

struct PixelDepths {
  int width, height;
  std::vector<float> nearness;
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x); }
};

/// One pass of a blur that does not reach over steps in depth.
std::vector<float> blurred(const std::vector<float>& in, const PixelDepths& depths, int dx, int dy) {
  std::vector<float> out(in.size());
  for (int y = 0; y < depths.height; ++y) {
    for (int x = 0; x < depths.width; ++x) {
      const std::size_t here = depths.at(x, y);
      const float nearness = depths.nearness[here];
      float sum = 0, weights = 0;
      for (int k = -2; k <= 2; ++k) {
        const int sx = x + k * dx, sy = y + k * dy;
        if (sx < 0 || sy < 0 || sx >= depths.width || sy >= depths.height) continue;
        const std::size_t there = depths.at(sx, sy);
        const float weight = std::max(0.f, 1 - 60 * std::fabs(depths.nearness[there] / std::max(nearness, 1e-20f) - 1));
        sum += weight * in[there];
        weights += weight;
      }
      out[here] = weights > 0 ? sum / weights : in[here];
    }
  }
  return out;
}

}  // namespace

std::vector<float> skyVisibility(const View& camera, const Surfaces& seen, std::span<const ViewBody> bodies, float radius) {
  constexpr std::size_t kTaps = 12;
  constexpr float kStrength = 1.9f;
  PixelDepths depths{camera.width / 2, camera.height / 2, {}};
  depths.nearness.resize(static_cast<std::size_t>(depths.width) * static_cast<std::size_t>(depths.height));
  for (int y = 0; y < depths.height; ++y)
    for (int x = 0; x < depths.width; ++x) depths.nearness[depths.at(x, y)] = seen.nearness[seen.at(2 * x, 2 * y)];
  const auto pointAt = [&](int x, int y, float nearness) { return Vec{camera.planeX(2 * x), camera.planeY(2 * y), 1} * (1 / nearness); };

  std::vector<float> visible(depths.nearness.size(), 1.f);
  for (int y = 0; y < depths.height; ++y) {
    for (int x = 0; x < depths.width; ++x) {
      const float nearness = depths.nearness[depths.at(x, y)];
      const std::uint32_t surface = seen.surface[seen.at(2 * x, 2 * y)];
      if (surface == kNothing) continue;
      const float reach = std::min(radius * camera.scale * nearness / 2, 96.f);
      if (reach < 1.5f) continue;
      const Vec point = pointAt(x, y, nearness);
      const Vec normal = normalAt(bodies[surface / 8], surface % 8, point, seen.detail[seen.at(2 * x, 2 * y)]);
      const auto pattern = static_cast<std::size_t>(hash(static_cast<std::uint32_t>((y % 4) * 4 + x % 4)) % kPatterns);
      const Disc<kTaps>& disc = discs<kTaps>()[pattern];
      float occluded = 0;
      for (std::size_t i = 0; i < kTaps; ++i) {
        const int sx = x + static_cast<int>(std::lround(reach * disc.x[i])), sy = y + static_cast<int>(std::lround(reach * disc.y[i]));
        if (sx < 0 || sy < 0 || sx >= depths.width || sy >= depths.height) continue;
        const float there = depths.nearness[depths.at(sx, sy)];
        if (there <= 0) continue;
        const Vec to = pointAt(sx, sy, there) - point;
        const float distance2 = dot(to, to);
        const float fade = std::max(0.f, 1 - distance2 / (radius * radius));
        occluded += fade * std::max(0.f, dot(to, normal) / std::sqrt(distance2 + 1e-20f) - .06f);
      }
      visible[depths.at(x, y)] = std::max(0.f, 1 - kStrength * occluded / kTaps);
    }
  }
  return blurred(blurred(visible, depths, 1, 0), depths, 0, 1);
}

}  // namespace rubble::io::draw

#include "shape_parts.h"
#include "math/portable.h"

#include <cmath>
#include <numbers>

namespace rubble::scenes {
namespace {

/// In [0, 1), the same on every machine.
double unitOf(std::uint32_t key) {
  key ^= key >> 16;
  key *= 0x7feb352du;
  key ^= key >> 15;
  key *= 0x846ca68bu;
  key ^= key >> 16;
  return key * 0x1p-32;
}

class InsideProbe : public Probe {
 public:
  InsideProbe(const Vec3& low, const Vec3& high) : low_(low), high_(high) {}
  void finish(const World& world, Metrics& metrics) override {
    int all = 0, inside = 0;
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      const Vec3 p = world.state(id).position;
      ++all;
      inside += p.x >= low_.x && p.y >= low_.y && p.z >= low_.z && p.x <= high_.x && p.y <= high_.y &&
                p.z <= high_.z;
    }
    metrics["inside_ratio"] = all > 0 ? double(inside) / all : 0;
  }

 private:
  Vec3 low_, high_;
};

}  // namespace

std::vector<Vec3> prismCorners(int sides, double radius, double halfHeight) {
  std::vector<Vec3> points;
  for (int k = 0; k < sides; ++k)
    for (const double z : {-halfHeight, halfHeight}) {
      const double angle = 2 * std::numbers::pi * k / sides;
      points.push_back({radius * portable::cos(angle), radius * portable::sin(angle), z});
    }
  return points;
}

Shape pebble(double size, std::uint32_t key) {
  std::vector<Vec3> points;
  constexpr int kCorners = 24;
  for (std::uint32_t k = 0; k < kCorners; ++k) {
    const double z = 1 - (2 * k + 1.0) / kCorners, angle = 2.399963229728653 * k + unitOf(97 * key + k),
                 s = std::sqrt(1 - z * z);
    const double far = size * (.85 + .15 * unitOf(1031 * key + 7 * k));
    points.push_back({far * s * portable::cos(angle), .8 * far * s * portable::sin(angle), .65 * far * z});
  }
  return Shape::hull(points);
}

Shape mixedShape(double size, int index) {
  const double s = size;
  switch (index % 9) {
    case 0:
      return Shape::box({s, .7 * s, .6 * s});
    case 1:
      return Shape::cylinder(.7 * s, .7 * s);
    case 2:
      return pebble(s, std::uint32_t(index / 9 % 4));
    case 3:
      return Shape::cone(.8 * s, .8 * s);
    case 4:
      return Shape::box({.8 * s, .7 * s, .7 * s}, .2 * s);
    case 5:
      return Shape::hull(prismCorners(5, .8 * s, .6 * s));
    case 6:
      return Shape::capsule(.5 * s, .5 * s);
    case 7:
      return Shape::sphere(.7 * s);
    default:
      return Shape::compound({{Shape::box({s, .3 * s, .3 * s}), {}, {}},
                              {Shape::box({.3 * s, s, .3 * s}), {}, {}},
                              {Shape::cylinder(.3 * s, .8 * s), {}, {}}});
  }
}

Shape distanceShape(const Vec3& low, const Vec3& high, double spacing,
                    const std::function<double(const Vec3&)>& distance) {
  std::array<int, 3> counts;
  for (int i = 0; i < 3; ++i)
    counts[std::size_t(i)] = std::max(2, int(std::ceil((high[i] - low[i]) / spacing - 1e-9)) + 1);
  std::vector<double> samples;
  for (int k = 0; k < counts[2]; ++k)
    for (int j = 0; j < counts[1]; ++j)
      for (int i = 0; i < counts[0]; ++i)
        samples.push_back(distance(low + spacing * Vec3{double(i), double(j), double(k)}));
  return Shape::distanceField(counts, low, spacing, std::move(samples));
}

std::unique_ptr<Probe> insideProbe(const Vec3& low, const Vec3& high) {
  return std::make_unique<InsideProbe>(low, high);
}

}  // namespace rubble::scenes

#include "cook/shape_traits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cook/checks.h"
#include "cook/rounded_mass.h"
#include "math/portable.h"

namespace rubble {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr FieldRules kSize{.range = FieldRange::Positive, .always = true};
constexpr FieldRules kDoubled{
    .range = FieldRange::Positive, .always = true, .name = "halfLength", .factor = 2};
constexpr auto kRadius = field("radius", "m", "its radius", &Shape::radius, kSize);
constexpr auto kHeight = field("length", "m", "its height along local z", &Shape::halfLength, kDoubled);

struct SphereTraits {
  static constexpr ShapeType kType = ShapeType::Sphere;
  static constexpr const char *kName = "sphere", *kDoc = "ball";
  static constexpr std::tuple kFields{kRadius};
  static CookedData core(const Shape& s) { return {ShapeKind::Sphere, {}, s.radius}; }
  static MassProperties massProperties(const Shape& s, double density) {
    const double r = s.radius, m = density * 4 / 3 * kPi * r * r * r, i = .4 * m * r * r;
    return {m, {i, i, i}, {}, {}};
  }
};

struct BoxTraits {
  static constexpr ShapeType kType = ShapeType::Box;
  static constexpr const char *kName = "box", *kDoc = "box about its center";
  static constexpr std::tuple kFields{
      field("size", "m", "its three edge lengths", &Shape::halfExtents,
            {.range = FieldRange::Positive, .always = true, .name = "halfExtents", .factor = 2}),
      kRounding};
  static double smallest(const Shape& s) {
    return std::min({s.halfExtents.x, s.halfExtents.y, s.halfExtents.z});
  }
  static CookedData core(const Shape& s) {
    const double r = s.rounding;
    return {r > 0 ? ShapeKind::RoundBox : ShapeKind::Box, s.halfExtents - Vec3{r, r, r}, r};
  }
  static MassProperties massProperties(const Shape& s, double density) {
    const Vec3 h = s.halfExtents;
    if (const double r = s.rounding; r > 0) {
      const SolidSums sums = roundedSums(boxHull(h - Vec3{r, r, r}), r);
      // without the round-off of its symmetric parts
      return principal(
          {density * sums.volume,
           {},
           {density * sums.second[0], density * sums.second[1], density * sums.second[2], 0, 0, 0}});
    }
    const double m = density * 8 * h.x * h.y * h.z;
    return {
        m,
        {m / 3 * (h.y * h.y + h.z * h.z), m / 3 * (h.x * h.x + h.z * h.z), m / 3 * (h.x * h.x + h.y * h.y)},
        {},
        {}};
  }
};

struct CapsuleTraits {
  static constexpr ShapeType kType = ShapeType::Capsule;
  static constexpr const char *kName = "capsule",
                              *kDoc = "cylinder along local z with half balls at its ends";
  static constexpr std::tuple kFields{
      kRadius,
      field("length", "m", "the distance of the centers of its two ends", &Shape::halfLength, kDoubled)};
  static CookedData core(const Shape& s) { return {ShapeKind::Capsule, {0, 0, s.halfLength}, s.radius}; }
  static MassProperties massProperties(const Shape& s, double density) {
    const double r = s.radius, l = s.halfLength;
    const double cylinder = density * kPi * r * r * 2 * l, sphere = density * 4 / 3 * kPi * r * r * r;
    // the center of mass of a hemisphere is 3/8 r beyond the end of the cylinder
    const double axial = cylinder * r * r / 2 + sphere * .4 * r * r;
    const double across = cylinder * (r * r / 4 + l * l / 3) + sphere * (.4 * r * r + l * l + .75 * l * r);
    return {cylinder + sphere, {across, across, axial}, {}, {}};
  }
};

struct CylinderTraits {
  static constexpr ShapeType kType = ShapeType::Cylinder;
  static constexpr const char *kName = "cylinder", *kDoc = "cylinder along local z";
  static constexpr std::tuple kFields{kRadius, kHeight, kRounding};
  static double smallest(const Shape& s) { return std::min(s.radius, s.halfLength); }
  static CookedData core(const Shape& s) {
    const double r = s.rounding;
    return {ShapeKind::Cylinder, {s.radius - r, s.radius - r, s.halfLength - r}, r};
  }
  static double boundingRadius(const Shape& s) {
    return portable::hypot(s.radius - s.rounding, s.halfLength - s.rounding) + s.rounding;
  }
  static MassProperties massProperties(const Shape& s, double density) {
    if (s.rounding > 0) return roundedMass(s, density);
    const double r = s.radius, l = s.halfLength;
    const double m = density * kPi * r * r * 2 * l, across = m * (r * r / 4 + l * l / 3);
    return {m, {across, across, m * r * r / 2}, {}, {}};
  }
  /// A middle part of half height h between two caps, of radius a + sqrt(r^2 - t^2) at t above it.
  static MassProperties roundedMass(const Shape& s, double density) {
    const double r = s.rounding, a = s.radius - r, h = s.halfLength - r, b = s.radius, r2 = r * r,
                 r3 = r2 * r;
    // integrals of the squared radius times 1, t and t^2 over a cap, and of its fourth power
    const double i0 = r * a * a + kPi / 2 * a * r2 + 2 * r3 / 3,
                 i1 = a * a * r2 / 2 + 2 * a * r3 / 3 + r3 * r / 4,
                 i2 = a * a * r3 / 3 + kPi / 8 * a * r3 * r + 2 * r3 * r2 / 15,
                 j = r * a * a * a * a + kPi * a * a * a * r2 + 4 * a * a * r3 + kPi * 3 / 4 * a * r3 * r +
                     8 * r3 * r2 / 15;
    const double axial = density * kPi * (h * b * b * b * b + j),
                 along = density * 2 * kPi * (b * b * h * h * h / 3 + h * h * i0 + 2 * h * i1 + i2);
    return {density * 2 * kPi * (h * b * b + i0), {axial / 2 + along, axial / 2 + along, axial}, {}, {}};
  }
};

struct ConeTraits {
  static constexpr ShapeType kType = ShapeType::Cone;
  static constexpr const char *kName = "cone", *kDoc = "cone along local z, base at -length/2";
  static constexpr std::tuple kFields{field("radius", "m", "the radius of its base", &Shape::radius, kSize),
                                      kHeight};
  // the tip is three quarters of the height above the center of mass
  static CookedData core(const Shape& s) {
    return {ShapeKind::Cone, {s.radius, s.radius, 1.5 * s.halfLength}, 0};
  }
  static double boundingRadius(const Shape& s) {
    return std::max(1.5 * s.halfLength, portable::hypot(s.radius, .5 * s.halfLength));
  }
  static MassProperties massProperties(const Shape& s, double density) {
    const double r = s.radius, l = s.halfLength, h = 2 * l, m = density * kPi * r * r * h / 3,
                 across = m * (3 * r * r / 20 + 3 * h * h / 80);
    return {m, {across, across, .3 * m * r * r}, {0, 0, h / 4 - l}, {}};
  }
};

template <class S> void cookConvex(CookedShape& out, const Shape& shape, const Path& path) {
  if constexpr (requires { S::smallest(shape); })
    if (shape.rounding > 0 && !(shape.rounding < S::smallest(shape)))
      throw Error(path + ".rounding", "less than half of the smallest size", std::to_string(shape.rounding));
  if constexpr (requires { S::core(shape); })
    out.shape = S::core(shape);
  else
    out.shape = {host::addedKind<S>(), S::half(shape)};
  out.radius = out.shape.radius + length(out.shape.half);
  if constexpr (requires { S::boundingRadius(shape); }) out.radius = S::boundingRadius(shape);
  out.unit = S::massProperties(shape, 1);
}

template <class S> ShapeTraits convexTraits(ShapeType type) {
  ShapeTraits traits{type,    S::kName,      S::kDoc,           true,   anyFields<Shape, S, InShape>(),
                     nullptr, cookConvex<S>, S::massProperties, nullptr};
  if constexpr (!requires { S::kType; })
    traits.support = [](const Shape& shape, const Vec3& d) { return S::support(S::half(shape), d); };
  return traits;
}

}  // namespace

const std::vector<ShapeTraits>& shapeTraits() {
  static const std::vector<ShapeTraits> all = [] {
    std::vector<ShapeTraits> traits = listShapes();
    const auto add = [&]<class S>() { traits.push_back(convexTraits<S>(S::kType)); };
    forEachType(TypeList<SphereTraits, BoxTraits, CapsuleTraits, CylinderTraits, ConeTraits>{}, add);
    std::sort(traits.begin(), traits.end(), [](auto& a, auto& b) { return a.type < b.type; });
    forEachType(host::AddedShapes{},
                [&]<class S>() { traits.push_back(convexTraits<S>(static_cast<ShapeType>(traits.size()))); });
    return traits;
  }();
  return all;
}

const ShapeTraits& traitsOf(ShapeType type) { return shapeTraits().at(static_cast<std::size_t>(type)); }

const char* keyword(ShapeType type) {
  const auto at = static_cast<std::size_t>(type);
  return at < shapeTraits().size() ? shapeTraits()[at].name : "";
}
ShapeType shapeType(const std::string& keyword) {
  for (const ShapeTraits& traits : shapeTraits())
    if (traits.name == keyword) return traits.type;
  throw Error("type", "the keyword of a shape type", "\"" + keyword + "\"");
}

void validate(const Shape& s, const Path& path) {
  checks::notNegative(s.rounding, path + ".rounding");
  checks::enumeration(static_cast<int>(s.type), static_cast<int>(shapeTraits().size()) - 1, path + ".type");
  const ShapeTraits& traits = traitsOf(s.type);
  for (const ShapeField& info : traits.fields)
    info.visit(s, [&](const auto& value) { checks::field(info, value, path); });
  if (traits.check) traits.check(s, path);
}

MassProperties massProperties(const Shape& shape, double density) {
  return traitsOf(shape.type).massProperties(shape, density);
}

}  // namespace rubble

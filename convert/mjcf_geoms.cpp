/// <geom>: shape, mass, surface and collision masks.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

const std::vector<std::string> kTypes{"plane",    "hfield", "sphere", "capsule", "ellipsoid",
                                      "cylinder", "box",    "mesh",   "sdf"};

Vec3 positive(const Tag& tag, const std::vector<double>& size, std::size_t count) {
  if (size.size() < count)
    tag.fail("size", std::to_string(count) + (count == 1 ? " number" : " numbers"),
             std::to_string(size.size()));
  Vec3 out;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(size[i] > 0)) tag.fail("size", "numbers above 0 [m]", std::to_string(size[i]));
    out[static_cast<int>(i)] = size[i];
  }
  return out;
}

/// Sizes and pose of a geom between two points.
std::vector<double> spanned(const Tag& tag, const std::string& type, std::vector<double> size,
                            const std::vector<double>& ends, Pose& pose) {
  const Vec3 from{ends[0], ends[1], ends[2]}, to{ends[3], ends[4], ends[5]};
  const double half = length(from - to) / 2;
  if (!(half > 1e-10)) tag.fail("fromto", "two points apart", "one point");
  pose = {(from + to) / 2, quatOfZ(from - to)};
  if (size.empty()) tag.fail("size", "a radius", "none");
  if (type == "box" || type == "ellipsoid") return {size[0], size[0], half};
  return {size[0], half};
}

/// Integrals over the surface of a primitive; false for others.
bool shellOf(const std::string& type, const Shape& shape, SolidSums& out) {
  const double r = shape.radius, h = shape.halfLength, pi = std::numbers::pi;
  double area = 0, x = 0, y = 0, z = 0;
  const auto add = [&](double own, double xx, double yy, double zz) {
    area += own, x += own * xx, y += own * yy, z += own * zz;
  };
  if (type == "box") {
    const Vec3 e = shape.halfExtents;
    for (int k = 0; k < 3; ++k) {
      Vec3 square = mul(e, e) / 3;
      square[k] *= 3;
      add(8 * e[(k + 1) % 3] * e[(k + 2) % 3], square.x, square.y, square.z);
    }
  } else if (type == "sphere") {
    add(4 * pi * r * r, r * r / 3, r * r / 3, r * r / 3);
  } else if (type == "cylinder" || type == "capsule") {
    add(4 * pi * r * h, r * r / 2, r * r / 2, h * h / 3);
    if (type == "cylinder")
      add(2 * pi * r * r, r * r / 4, r * r / 4, h * h);
    else
      add(4 * pi * r * r, r * r / 3, r * r / 3, h * h + h * r + r * r / 3);
  } else {
    return false;
  }
  out = {area, {}, {x, y, z, 0, 0, 0}};
  return true;
}

}  // namespace

void MjcfReader::readGeom(const Tag& tag, const MjcfScope& scope) {
  Geom geom;
  geom.name = tag.name();
  if (!geom.name.empty()) geom.name += scope.suffix;
  geom.place = tag.place();
  geom.material = materialOf(tag);
  constexpr int kLow = std::numeric_limits<int>::min(), kHigh = std::numeric_limits<int>::max();
  geom.contact = {static_cast<std::uint32_t>(tag.whole("contype", kLow, kHigh).value_or(1)),
                  static_cast<std::uint32_t>(tag.whole("conaffinity", kLow, kHigh).value_or(1))};
  if (!compiler_.contacts) geom.contact = {0, 0};
  const std::string type = kTypes[tag.choice("type", kTypes, 2)];
  geom.pose = poseOf(tag);
  SolidSums solid;
  std::optional<Shape> drawn;
  const bool isThere = shapeOf(tag, type, geom, solid, drawn);
  geom.pose = scope.pose * geom.pose;
  const int index = isThere ? static_cast<int>(link(scope.link).geoms.size()) : -1;
  if (isThere || drawn) addDrawn(tag, scope, {drawn.value_or(geom.shape), geom.pose, {}, index});
  if (!isThere) return;
  if (!geom.name.empty() && (type == "sphere" || type == "cylinder"))
    rounds_[geom.name] = {scope.link, geom.pose, geom.shape.radius, type == "cylinder"};
  const double group = tag.number("group", 0);
  const std::optional<double> mass = tag.number("mass");
  const double density = tag.number("density", 1000);
  if (mass.value_or(0) < 0) tag.fail("mass", "a mass of at least 0 [kg]", std::to_string(*mass));
  if (density < 0) tag.fail("density", "a density of at least 0 [kg/m3]", std::to_string(density));
  const bool shell = tag.flag("shellinertia", false);
  if (shell && !shellOf(type, geom.shape, solid))
    report_.note(Effect::Lost, tag.place(), "geom.shellinertia",
                 "mass is in the solid and not on the surface");
  if (solid.volume > 0 && group >= compiler_.inertiaGroups[0] && group <= compiler_.inertiaGroups[1]) {
    const double factor = mass ? *mass / solid.volume : density;
    geomMass_[static_cast<std::size_t>(scope.link)] += placed(solid, geom.pose.p, geom.pose.q, factor);
  }
  if (!geom.name.empty()) geoms_[geom.name] = {scope.link, index};
  link(scope.link).geoms.push_back(std::move(geom));
}

Material MjcfReader::materialOf(const Tag& tag) {
  // friction is along the surface, about its normal, and of rolling; condim says which of them act
  std::vector<double> friction{1, .005, .0001};
  if (const auto given = tag.numbers("friction", 1, 3))
    std::copy(given->begin(), given->end(), friction.begin());
  for (const double each : friction)
    if (each < 0) tag.fail("friction", "numbers of at least 0", std::to_string(each));
  const int dimensions = tag.whole("condim", 1, 6).value_or(3);
  if (dimensions == 2 || dimensions == 5) tag.fail("condim", "1, 3, 4 or 6", std::to_string(dimensions));
  Material out;
  out.staticFriction = out.dynamicFriction = dimensions >= 3 ? friction[0] : 0;
  out.torsionalFriction = dimensions >= 4 ? friction[1] : 0;
  out.rollingFriction = dimensions >= 6 ? friction[2] : 0;
  out.frictionCombine = Combine::Maximum;
  return out;
}

bool MjcfReader::shapeOf(const Tag& tag, const std::string& type, Geom& geom, SolidSums& solid,
                         std::optional<Shape>& drawn) {
  if (type == "plane") {
    geom.shape = Shape::plane();
    return true;
  }
  if (type == "hfield") return fieldShape(tag, geom);
  if (type == "mesh" || (type == "sdf" && tag.has("mesh"))) {
    if (const MjcfMesh* const mesh = meshOf(tag)) drawn = mesh->drawn;
    return meshShape(tag, geom, solid);
  }
  if (type == "sdf") {
    report_.note(Effect::Lost, tag.place(), "geom" + inQuotes(geom.name),
                 "a signed distance function of a plugin");
    return false;
  }
  std::vector<double> size = tag.numbers("size", 1, 3).value_or(std::vector<double>{});
  if (tag.has("mesh")) {
    size = fittedSize(tag, type, geom.pose);
    if (size.empty()) return false;
  } else if (type != "sphere")
    if (const auto ends = tag.numbers("fromto", 6, 6))
      size = spanned(tag, type, std::move(size), *ends, geom.pose);
  const Vec3 s = positive(tag, size, type == "sphere" ? 1 : type == "capsule" || type == "cylinder" ? 2 : 3);
  if (type == "ellipsoid") {
    geom.shape = ellipsoidHull(s);
    drawn = drawnEllipsoid(s);
    solid = sumsOf(ellipsoidMass(s));
    report_.note(
        Effect::Approximate, tag.place(), "geom.type",
        "an ellipsoid is a convex hull of 64 of its points in contacts; its mass properties are exact");
    return true;
  }
  geom.shape = type == "sphere"     ? Shape::sphere(s.x)
               : type == "capsule"  ? Shape::capsule(s.x, s.y)
               : type == "cylinder" ? Shape::cylinder(s.x, s.y)
                                    : Shape::box(s);
  solid = sumsOf(massProperties(geom.shape, 1));
  return true;
}

std::vector<double> MjcfReader::fittedSize(const Tag& tag, const std::string& type, Pose& pose) {
  const MjcfMesh* const asset = meshOf(tag);
  const SolidSums sums = asset ? massOf(asset->mesh, asset->mass, tag.path("mesh")) : SolidSums{};
  if (!(sums.volume > 0)) {
    report_.note(Effect::Lost, tag.place(), "geom" + inQuotes(tag.name()),
                 "its mesh is not there, or encloses no volume");
    return {};
  }
  // the box of the same mass and inertia, its longest edge along z
  const MassProperties mass = principal(sums);
  const Vec3& i = mass.inertia;
  std::array<std::pair<double, Vec3>, 3> edge;
  for (int k = 0; k < 3; ++k) {
    const double square = 1.5 * (i[(k + 1) % 3] + i[(k + 2) % 3] - i[k]) / mass.mass;
    Vec3 axis;
    axis[k] = 1;
    edge[static_cast<std::size_t>(k)] = {std::sqrt(std::max(square, 0.)), rotate(mass.axes, axis)};
  }
  std::sort(edge.begin(), edge.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const Vec3 x = edge[0].second, z = edge[2].second;
  pose = pose * Pose{mass.center, quatOfAxes(x, cross(z, x), z)};
  const double scale = tag.number("fitscale", 1), across = scale * (edge[0].first + edge[1].first) / 2,
               along = scale * edge[2].first;
  if (type == "sphere") return {(2 * across + along) / 3};
  if (type == "capsule") return {across, std::max(along - across / 2, 1e-6)};
  if (type == "cylinder") return {across, along};
  return {scale * edge[0].first, scale * edge[1].first, along};
}

const MjcfMesh* MjcfReader::meshOf(const Tag& tag) const {
  const auto found = meshes_.find(tag.text("mesh").value_or(""));
  return found == meshes_.end() ? nullptr : &found->second;
}

bool MjcfReader::meshShape(const Tag& tag, Geom& geom, SolidSums& solid) {
  const std::string name = tag.need("mesh");
  const MjcfMesh* const found = meshOf(tag);
  if (!found) {
    report_.note(Effect::Lost, tag.place(), "geom" + inQuotes(geom.name),
                 "the mesh '" + name + "' is not there");
    return false;
  }
  const MjcfMesh& asset = *found;
  solid = massOf(asset.mesh, asset.mass, tag.path("mesh"));
  if (!(solid.volume > 0)) {
    const bool hasMass = tag.number("mass").value_or(tag.number("density", 1)) > 0;
    report_.note(hasMass ? Effect::Lost : Effect::None, tag.place(), "geom" + inQuotes(geom.name),
                 "the mesh '" + name + "' encloses no volume, so it has no mass");
    solid = {};
  }
  try {
    bool reduced = false;
    geom.shape = Shape::hull(cornersOf(asset.mesh.vertices, reduced, tag.path("mesh")));
    if (reduced && geom.contact.any())
      report_.note(Effect::Approximate, tag.place(), "geom.mesh",
                   "at most 64 corners of the convex hull of a mesh take part in contacts");
  } catch (const Error&) {
    report_.note(geom.contact.any() ? Effect::Lost : Effect::None, tag.place(), "geom" + inQuotes(geom.name),
                 "the mesh '" + name + "' has no convex hull (it is flat, or this build has no qhull)");
    return false;
  }
  return true;
}

bool MjcfReader::fieldShape(const Tag& tag, Geom& geom) {
  const std::string name = tag.need("hfield");
  const auto found = fields_.find(name);
  if (found == fields_.end()) {
    report_.note(Effect::Lost, tag.place(), "geom" + inQuotes(geom.name),
                 "the hfield '" + name + "' is not there");
    return false;
  }
  const MjcfHeightField& field = found->second;
  std::vector<double> heights = field.samples;
  for (double& height : heights) height *= field.height;
  const Vec3 spacing{2 * field.radiusX / (field.columns - 1), 2 * field.radiusY / (field.rows - 1), 1};
  geom.shape = Shape::heightField(field.columns, field.rows, spacing, std::move(heights));
  geom.pose = geom.pose * Pose{{-field.radiusX, -field.radiusY, 0}, {}};
  return true;
}

}  // namespace rubble::convert

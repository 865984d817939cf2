#include "io/appearance_json.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "io/field_json.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr Want kShare{0, true, 1, "a number from 0 to 1"};
constexpr Want kAngle{0, false, 180, "an angle above 0 and of at most 180 degrees"};
constexpr Want kIntensity{0, false, std::numeric_limits<double>::infinity(), "an intensity above 0 [m2]"};
constexpr double kDegree = std::numbers::pi / 180;
/// A direction is taken as it is if its length is 1 to this much.
constexpr double kUnit = 1e-12;

/// Degrees that are read as that angle, bit for bit.
double degreesOf(double angle) {
  const double degrees = angle / kDegree;
  for (const double towards : {0., kHard})
    if (const double next = std::nextafter(degrees, towards);
        degrees * kDegree != angle && next * kDegree == angle)
      return next;
  return degrees;
}

}  // namespace

Look readLook(const Node& node, const std::function<int(const Node&)>& body,
              const std::function<Shape(const Node&)>& shape, const std::vector<BodyDef>& bodies) {
  Look out;
  ObjectReader object(node, "the look of a body");
  if (!object.isObject()) return out;
  if (const auto found = object.need("body", "the name or index of a body, or \"world\""))
    out.body = body(*found);
  if (const auto parts = object.need("parts", "a list of drawn parts"))
    for (const Node& element : parts->elements("a list of drawn parts")) {
      LookPart part;
      ObjectReader reader(element, "a drawn part");
      if (const auto found = reader.get("shape"))
        part.shape = shape(*found);
      else if (out.body >= 0 && out.body < static_cast<int>(bodies.size()))
        part.shape = bodies[static_cast<std::size_t>(out.body)].shape;
      else
        reader.need("shape", "a shape");
      reader.read("position", part.position);
      if (const auto found = reader.get("orientation")) part.orientation = readOrientation(*found);
      if (const auto found = reader.get("color"))
        part.color = found->vector(kShare, "red, green and blue from 0 to 1");
      reader.finish();
      try {
        validate(part.shape, "shape");
      } catch (const Error& error) {
        element.faultText(error.what());
      }
      out.parts.push_back(std::move(part));
    }
  object.finish();
  return out;
}

Json lookJson(const Look& look, const Json& body, const std::function<Json(const Shape&)>& shape) {
  Json parts = Json::array();
  for (const LookPart& part : look.parts) {
    Json entry{{"shape", shape(part.shape)}};
    if (part.position != Vec3{}) entry["position"] = vectorJson(part.position);
    const Quat& q = part.orientation;
    if (q != Quat{}) entry["orientation"] = {q.s, q.v.x, q.v.y, q.v.z};
    if (part.color) entry["color"] = vectorJson(*part.color);
    parts.push_back(std::move(entry));
  }
  return {{"body", body}, {"parts", std::move(parts)}};
}

NamedCamera readNamedCamera(const Node& node) {
  NamedCamera out;
  ObjectReader object(node, "a camera");
  if (!object.isObject()) return out;
  if (const auto found = object.need("name", "a name")) out.name = found->text().value_or("");
  if (const auto found = object.need("eye", "a point [m]")) out.eye = found->vector().value_or(Vec3{});
  if (const auto found = object.need("target", "a point [m]"))
    out.target = found->vector().value_or(Vec3{1, 0, 0});
  if (const auto found = object.get("fov"))
    if (const auto degrees = found->number(kAngle)) out.fieldOfView = *degrees * kDegree;
  if (out.eye == out.target) node.faultText("expected an eye away from the target, got one point");
  object.finish();
  return out;
}

Json namedCameraJson(const NamedCamera& camera) {
  Json json{{"name", camera.name}, {"eye", vectorJson(camera.eye)}, {"target", vectorJson(camera.target)}};
  if (camera.fieldOfView) json["fov"] = degreesOf(*camera.fieldOfView);
  return json;
}

namespace {

/// A direction, made unit.
std::optional<Vec3> readDirection(const Node& node) {
  const auto v = node.vector();
  if (v && !(length(*v) > 0)) node.fault("a direction of some length");
  if (!v || !(length(*v) > 0)) return std::nullopt;
  return std::fabs(length(*v) - 1) <= kUnit ? *v : normalize(*v);
}

void readColor(ObjectReader& object, Vec3& out) {
  if (const auto found = object.get("color"))
    out = found->vector(kShare, "red, green and blue from 0 to 1").value_or(out);
}

}  // namespace

void readSun(const Node& node, Daylight& out) {
  if (!node.value().isObject()) {
    out.toSun = readDirection(node);
    return;
  }
  ObjectReader object(node, "a direction, or the sun");
  if (const auto found = object.get("direction")) out.toSun = readDirection(*found);
  readColor(object, out.sunColor);
  object.read("strength", out.sunStrength, kNotNegative);
  object.finish();
}

Json sunJson(const Daylight& light) {
  const Daylight usual;
  Json json = Json::object();
  if (light.toSun) json["direction"] = vectorJson(*light.toSun);
  if (!sameBits(light.sunColor, usual.sunColor)) json["color"] = vectorJson(light.sunColor);
  if (!sameBits(light.sunStrength, usual.sunStrength)) json["strength"] = light.sunStrength;
  return json.size() == 1 && light.toSun ? json["direction"] : json;
}

PointLight readPointLight(const Node& node) {
  PointLight out;
  ObjectReader object(node, "a light");
  if (!object.isObject()) return out;
  if (const auto found = object.need("position", "a point [m]"))
    out.position = found->vector().value_or(Vec3{});
  readColor(object, out.color);
  object.read("intensity", out.intensity, kIntensity);
  object.finish();
  return out;
}

Json pointLightJson(const PointLight& light) {
  Json json{{"position", vectorJson(light.position)}};
  if (!sameBits(light.color, PointLight{}.color)) json["color"] = vectorJson(light.color);
  json["intensity"] = light.intensity;
  return json;
}

std::string appearanceText(const Appearance& appearance) {
  Json json = Json::object();
  json["looks"] = Json::array(), json["cameras"] = Json::array();
  for (const Look& look : appearance.looks) json["looks"].push_back(lookJson(look, look.body, shapeJson));
  if (Json sun = sunJson(appearance.daylight); !sun.empty()) json["sun"] = std::move(sun);
  if (appearance.daylight.skyStrength != 1) json["sky"] = appearance.daylight.skyStrength;
  for (const PointLight& light : appearance.lights) json["lights"].push_back(pointLightJson(light));
  for (const NamedCamera& camera : appearance.cameras) json["cameras"].push_back(namedCameraJson(camera));
  return json.dump();
}

std::optional<Appearance> appearanceOf(const std::string& text) {
  std::vector<Fault> faults;
  const std::optional<JsonDocument> json = parseJson(text, faults);
  if (!json) return std::nullopt;
  Appearance out;
  ObjectReader object(Node(json->root(), "", faults), "an appearance");
  const auto body = [](const Node& node) {
    return node.whole(kWorld, "the index of a body").value_or(kWorld);
  };
  const auto shape = [](const Node& node) { return readShape(node, {}, readMaterial); };
  if (const auto list = object.need("looks", "a list of looks"))
    for (const Node& element : list->elements("a list of looks"))
      out.looks.push_back(readLook(element, body, shape, {}));
  if (const auto found = object.get("sun")) readSun(*found, out.daylight);
  object.read("sky", out.daylight.skyStrength, kNotNegative);
  if (const auto list = object.get("lights"))
    for (const Node& element : list->elements("a list of lights"))
      out.lights.push_back(readPointLight(element));
  if (const auto list = object.need("cameras", "a list of cameras"))
    for (const Node& element : list->elements("a list of cameras"))
      out.cameras.push_back(readNamedCamera(element));
  object.finish();
  return faults.empty() ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace rubble::io

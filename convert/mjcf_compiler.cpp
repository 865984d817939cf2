/// <compiler>, <option>, and orientations, whose meaning depends on them.
#include <cmath>
#include <numbers>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"

namespace rubble::convert {

static constexpr double kLeastStep = 1e-6;  // [s]

void MjcfReader::readCompiler(pugi::xml_node node) {
  const Tag tag(source_, node);
  if (tag.has("angle")) compiler_.degrees = tag.choice("angle", {"radian", "degree"}, 1) == 1;
  compiler_.autolimits = tag.flag("autolimits", compiler_.autolimits);
  if (const auto sequence = tag.text("eulerseq")) {
    if (sequence->size() != 3 || sequence->find_first_not_of("xyzXYZ") != std::string::npos)
      tag.fail("eulerseq", "three of the letters x, y, z, X, Y, Z", "\"" + *sequence + "\"");
    compiler_.eulerSequence = *sequence;
  }
  compiler_.inertiaFromGeoms = tag.choice("inertiafromgeom", {"false", "true", "auto"},
                                          compiler_.inertiaFromGeoms);
  if (const auto range = tag.range("inertiagrouprange")) compiler_.inertiaGroups = *range;
  compiler_.balanceInertia = tag.flag("balanceinertia", compiler_.balanceInertia);
  compiler_.boundMass = tag.number("boundmass", compiler_.boundMass);
  compiler_.boundInertia = tag.number("boundinertia", compiler_.boundInertia);
  compiler_.totalMass = tag.number("settotalmass", compiler_.totalMass);
  compiler_.stripPath = tag.flag("strippath", compiler_.stripPath);
  compiler_.assetFolder = tag.text("assetdir").value_or(compiler_.assetFolder);
  compiler_.meshFolder = tag.text("meshdir").value_or(compiler_.meshFolder);
  compiler_.textureFolder = tag.text("texturedir").value_or(compiler_.textureFolder);
  if (tag.flag("exactmeshinertia", false)) compiler_.meshMass = MeshMass::Exact;
  if (tag.choice("coordinate", {"local", "global"}, 0) == 1)
    tag.fail("coordinate", "local (MuJoCo has removed global coordinates)", "global");
}

void MjcfReader::readOption(pugi::xml_node node) {
  const Tag tag(source_, node);
  model_.gravity = tag.vector("gravity").value_or(model_.gravity);
  if (const auto step = tag.number("timestep")) {
    if (!(*step >= kLeastStep && *step <= 1)) tag.fail("timestep", "1e-6 to 1 s", std::to_string(*step));
    model_.timeStep = step;
  }
  for (const char* medium : {"density", "viscosity"})
    if (tag.number(medium, 0) != 0)
      report_.note(Effect::Lost, tag.place(), std::string("option.") + medium,
                   "there is no drag of a medium");
  if (lengthSquared(tag.vector("wind").value_or(Vec3{})) > 0)
    report_.note(Effect::Lost, tag.place(), "option.wind", "there is no wind");
  for (const double group : tag.numbers("actuatorgroupdisable", 0, 32).value_or(std::vector<double>{}))
    compiler_.actuatorsOff.push_back(group);
  for (const pugi::xml_node& flag : source_.children(node, "flag")) readFlags(flag);
}

void MjcfReader::readFlags(pugi::xml_node node) {
  const Tag tag(source_, node);
  const auto isOn = [&](const char* name) { return tag.choice(name, {"disable", "enable"}, 1) == 1; };
  if (!isOn("gravity")) model_.gravity = {};
  if (!isOn("filterparent")) model_.parentsCollide = true;
  compiler_.contacts = compiler_.contacts && isOn("contact");
  compiler_.limits = compiler_.limits && isOn("limit");
  compiler_.springs = compiler_.springs && isOn("spring");
  compiler_.dampers = compiler_.dampers && isOn("damper");
  compiler_.friction = compiler_.friction && isOn("frictionloss");
  compiler_.actuation = compiler_.actuation && isOn("actuation");
  compiler_.equality = compiler_.equality && isOn("equality");
  compiler_.clampsControls = compiler_.clampsControls && isOn("clampctrl");
  if (!isOn("passive")) compiler_.springs = compiler_.dampers = false;
  if (!isOn("constraint"))
    compiler_.contacts = compiler_.limits = compiler_.friction = compiler_.equality = false;
}

double MjcfReader::angle(double value) const {
  return compiler_.degrees ? value * std::numbers::pi / 180 : value;
}

std::optional<Quat> MjcfReader::quaternionOf(const Tag& tag, const char* key) const {
  const auto q = tag.numbers(key, 4, 4);
  if (!q) return std::nullopt;
  const double norm = std::hypot(std::hypot((*q)[0], (*q)[1]), std::hypot((*q)[2], (*q)[3]));
  if (!(norm > 1e-10)) tag.fail(key, "a quaternion of some length", "one of length 0");
  return normalize(Quat{(*q)[0] / norm, (*q)[1] / norm, (*q)[2] / norm, (*q)[3] / norm});
}

Quat MjcfReader::orientationOf(const Tag& tag) const {
  const auto unit = [&](const Vec3& v, const char* key) {
    if (!(length(v) > 1e-10)) tag.fail(key, "a direction", "a vector of length 0");
    return v / length(v);
  };
  // an orientation of the element itself comes before one of its defaults
  const bool byDefault = !(tag.hasOwn("axisangle") || tag.hasOwn("euler") || tag.hasOwn("xyaxes") ||
                           tag.hasOwn("zaxis"));
  if (tag.hasOwn("quat") || byDefault)
    if (const auto q = quaternionOf(tag, "quat")) return *q;
  if (const auto a = tag.numbers("axisangle", 4, 4))
    return fromAxisAngle(unit({(*a)[0], (*a)[1], (*a)[2]}, "axisangle"), angle((*a)[3]));
  if (const auto e = tag.vector("euler"))
    return quatOfEuler({angle(e->x), angle(e->y), angle(e->z)}, compiler_.eulerSequence);
  if (const auto a = tag.numbers("xyaxes", 6, 6)) {
    const Vec3 x = unit({(*a)[0], (*a)[1], (*a)[2]}, "xyaxes"), wish{(*a)[3], (*a)[4], (*a)[5]};
    const Vec3 y = unit(wish - dot(wish, x) * x, "xyaxes");
    return quatOfAxes(x, y, cross(x, y));
  }
  if (const auto z = tag.vector("zaxis")) return quatOfZ(unit(*z, "zaxis"));
  return {};
}

Pose MjcfReader::poseOf(const Tag& tag) const {
  return {tag.vector("pos").value_or(Vec3{}), orientationOf(tag)};
}

}  // namespace rubble::convert

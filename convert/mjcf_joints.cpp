/// <joint> and <freejoint>.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

std::optional<std::array<double, 2>> MjcfReader::limitOf(const Tag& tag, const char* range,
                                                         const char* limited) {
  const std::size_t wanted = tag.choice(limited, {"false", "true", "auto"}, 2);
  const auto given = tag.range(range);
  const bool isLimited = wanted == 1 || (wanted == 2 && compiler_.autolimits && given);
  if (wanted == 2 && !compiler_.autolimits && given)
    tag.fail(limited, "true or false beside a range, because autolimits is off", "none");
  if (!isLimited) return std::nullopt;
  if (!given) tag.fail(range, "a range, because it is limited", "none");
  if ((*given)[0] > (*given)[1]) tag.fail(range, "a lower limit below the upper one", "others");
  return given;
}

void MjcfReader::readJoint(const Tag& tag, const MjcfScope& scope) {
  if (scope.link == 0) throw Error(source_.path(tag.node()), "a joint in a body", "one in the world");
  Link& own = link(scope.link);
  const bool isFree = tag.type() == "freejoint";
  const std::size_t type = isFree ? 0 : tag.choice("type", {"free", "ball", "slide", "hinge"}, 3);
  const std::string name = tag.name().empty() ? "" : tag.name() + scope.suffix;
  if (type == 0) {
    if (own.parent != 0) tag.fail("type", "a free joint of a child of the world", "one of another body");
    if (!own.dofs.empty() || own.free)
      tag.fail("type", "a free joint that is alone in its body", "several joints");
    own.free = true;
    if (!name.empty()) freeByName_[name] = scope.link;
    report_.converted(tag.place(), tag.describe(), "free body" + inQuotes(own.name));
    for (const char* key : {"damping", "frictionloss", "stiffness", "armature"})
      if (const auto list = isFree ? std::nullopt : tag.numbers(key, 1, 3); list && (*list)[0] != 0)
        report_.note(Effect::Lost, tag.place(), std::string("joint.") + key, "of a free joint");
    return;
  }
  if (own.free) tag.fail("type", "a free joint that is alone in its body", "several joints");
  if (own.kinematic) tag.fail("type", "a mocap body without joints", "a joint");
  Dof out;
  out.type = type == 1 ? DofType::Ball : type == 2 ? DofType::Slide : DofType::Hinge;
  out.name = name;
  out.place = tag.place();
  const bool turns = out.type != DofType::Slide;
  const auto coordinate = [&](double value) { return turns ? angle(value) : value; };
  const Vec3 axis = tag.vector("axis").value_or(Vec3{0, 0, 1});
  if (out.type != DofType::Ball && !(length(axis) > 1e-10))
    tag.fail("axis", "a direction", "a vector of length 0");
  out.axis = rotate(scope.pose.q, normalize(axis));
  out.anchor = scope.pose * tag.vector("pos").value_or(Vec3{});
  out.reference = out.type == DofType::Ball ? 0 : coordinate(tag.number("ref", 0));
  const auto range = limitOf(tag, "range", "limited");
  if (range && compiler_.limits) out.range = {coordinate((*range)[0]), coordinate((*range)[1])};

  const auto coefficient = [&](const char* key) {
    const auto list = tag.numbers(key, 1, 3).value_or(std::vector<double>{0});
    if (list[0] < 0) tag.fail(key, "a number of at least 0", std::to_string(list[0]));
    for (std::size_t i = 1; i < list.size(); ++i)
      if (list[i] != 0)
        report_.note(Effect::Lost, tag.place(), std::string("joint.") + key, "the terms of higher order");
    return list[0];
  };
  const double stiffness = coefficient("stiffness"), damping = coefficient("damping");
  const double rest = out.type == DofType::Ball ? 0 : coordinate(tag.number("springref", 0));
  if (compiler_.springs) out.drive.stiffness = stiffness, out.drive.stiffnessTarget = stiffness * rest;
  if (compiler_.dampers) out.damping = damping;
  springRest_[{scope.link, static_cast<int>(own.dofs.size())}] = rest;
  const double friction = tag.number("frictionloss", 0);
  if (friction < 0) tag.fail("frictionloss", "a number of at least 0", std::to_string(friction));
  if (compiler_.friction) out.friction = friction;
  out.armature = tag.number("armature", 0);
  if (out.armature < 0) tag.fail("armature", "a number of at least 0", std::to_string(out.armature));
  const std::pair<int, int> at{scope.link, static_cast<int>(own.dofs.size())};
  const auto springDamper = tag.range("springdamper");
  if (springDamper && (*springDamper)[0] > 0 && (*springDamper)[1] > 0) {
    if (compiler_.springs) out.drive.stiffnessTarget = rest;
    springDampers_[at] = *springDamper;
  }
  if (const auto soft = out.range && out.type != DofType::Ball ? softnessOf(tag, "solreflimit", "solimplimit")
                                                               : std::nullopt)
    softLimits_[at] = *soft;
  if (const auto force = limitOf(tag, "actuatorfrcrange", "actuatorfrclimited"))
    actuatorForce_[at] = std::max(std::fabs((*force)[0]), std::fabs((*force)[1]));
  if (!name.empty() && !dofByName_.emplace(name, at).second)
    tag.fail("name", "a name that no other joint has", "\"" + name + "\"");
  own.dofs.push_back(std::move(out));
}

}  // namespace rubble::convert

/// The tree of bodies: <body>, <frame>, <replicate>, <inertial>, <site>.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

/// Largest number of elements of a tree of bodies, with the repetitions of <replicate>.
constexpr std::size_t kMostElements = 200000;
constexpr int kMostDepth = 200;
constexpr int kMostCopies = 100000;

}  // namespace

void MjcfReader::readWorld(pugi::xml_node node) {
  if (model_.links.empty()) {
    Link world;
    world.name = "world";
    world.place = source_.place(node);
    model_.links.push_back(world);
    geomMass_.emplace_back(), hasInertial_.push_back(false);
    linkByName_["world"] = 0;
  }
  MjcfScope scope;
  scope.childClass = Tag(source_, node).text("childclass").value_or("");
  readChildren(node, scope);
}

void MjcfReader::readChildren(pugi::xml_node node, const MjcfScope& scope) {
  if (scope.depth > kMostDepth)
    throw Error(source_.path(node), "at most " + std::to_string(kMostDepth) + " levels of bodies", "more");
  for (const pugi::xml_node& child : source_.children(node)) {
    if (++elements_ > kMostElements)
      throw Error(source_.path(child), "at most " + std::to_string(kMostElements) + " elements", "more");
    const std::string_view type = child.name();
    if (type == "body") readBody(Tag(source_, child), scope);
    if (type == "frame") readFrame(Tag(source_, child), scope);
    if (type == "replicate") readReplicate(Tag(source_, child), scope);
    if (type == "inertial") readInertial(Tag(source_, child), scope);
    if (type == "geom") readGeom(tagOf(child, scope.childClass), scope);
    if (type == "joint") readJoint(tagOf(child, scope.childClass), scope);
    if (type == "freejoint") readJoint(Tag(source_, child), scope);
    if (type == "attach") readAttach(Tag(source_, child), scope);
    if (type == "camera") readCamera(tagOf(child, scope.childClass), scope);
    if (type == "light") readLight(tagOf(child, scope.childClass), scope);
    if (type == "flexcomp") readFlexcomp(Tag(source_, child), scope);
    if (type == "composite" && isCable(child)) readComposite(Tag(source_, child), scope);
    if (type == "plugin" && isCable(child)) readPlugin(Tag(source_, child), scope);
    if (type == "site") {
      const Tag tag = tagOf(child, scope.childClass);
      if (const std::string name = tag.name(); !name.empty())
        sites_[name + scope.suffix] = {scope.link, scope.pose * poseOf(tag), siteVolume(tag)};
    }
  }
}

void MjcfReader::readBody(const Tag& tag, const MjcfScope& scope) {
  Link own;
  own.name = tag.name();
  if (!own.name.empty()) own.name += scope.suffix;
  own.place = tag.place();
  own.parent = scope.link;
  own.pose = scope.pose * poseOf(tag);
  own.gravityScale = 1 - tag.number("gravcomp", 0);
  own.kinematic = tag.flag("mocap", false);
  if (own.kinematic && scope.link != 0) tag.fail("mocap", "a child of the world", "a child of another body");
  const int index = static_cast<int>(model_.links.size());
  if (!own.name.empty() && !linkByName_.emplace(own.name, index).second)
    tag.fail("name", "a name that no other body has", "\"" + own.name + "\"");
  model_.links.push_back(std::move(own));
  geomMass_.emplace_back(), hasInertial_.push_back(false);
  MjcfScope inner{
      index, {}, tag.text("childclass").value_or(scope.childClass), scope.suffix, scope.depth + 1};
  if (!inner.childClass.empty() && inner.childClass != defaults_.main &&
      !defaults_.parent.contains(inner.childClass))
    tag.fail("childclass", "the name of a default class", "\"" + inner.childClass + "\"");
  readChildren(tag.node(), inner);
}

void MjcfReader::readFrame(const Tag& tag, const MjcfScope& scope) {
  MjcfScope inner = scope;
  inner.pose = scope.pose * poseOf(tag);
  inner.childClass = tag.text("childclass").value_or(scope.childClass);
  ++inner.depth;
  readChildren(tag.node(), inner);
}

void MjcfReader::readReplicate(const Tag& tag, const MjcfScope& scope) {
  const int count = tag.whole("count", 1, kMostCopies).value_or(0);
  if (count == 0) tag.fail("count", "a number of copies", "none");
  const std::string separator = tag.text("sep").value_or("");
  const Pose step{tag.vector("offset").value_or(Vec3{}), orientationOf(tag)};
  const std::size_t digits = std::to_string(count - 1).size();
  MjcfScope inner = scope;
  ++inner.depth;
  for (int i = 0; i < count; ++i) {
    const std::string number = std::to_string(i);
    inner.suffix = separator + std::string(digits - number.size(), '0') + number + scope.suffix;
    readChildren(tag.node(), inner);
    inner.pose = inner.pose * step;
  }
}

void MjcfReader::readInertial(const Tag& tag, const MjcfScope& scope) {
  if (scope.link == 0) return;
  if (compiler_.inertiaFromGeoms == 1) {
    tag.useAll();
    report_.note(Effect::None, tag.place(), "inertial", "inertiafromgeom says that geometry gives the mass");
    return;
  }
  const auto at = static_cast<std::size_t>(scope.link);
  const Pose pose = scope.pose * poseOf(tag);
  const double mass = tag.needNumber("mass");
  if (mass < 0) tag.fail("mass", "a mass of at least 0 [kg]", std::to_string(mass));
  std::array<double, 6> tensor{};
  if (const auto full = tag.numbers("fullinertia", 6, 6))
    std::copy(full->begin(), full->end(), tensor.begin());
  else if (const auto diagonal = tag.vector("diaginertia"))
    tensor = {diagonal->x, diagonal->y, diagonal->z, 0, 0, 0};
  else
    tag.fail("diaginertia", "a diagonal or full inertia", "none");
  model_.links[at].mass = placed(sumsOfTensor(mass, tensor), pose.p, pose.q, 1);
  hasInertial_[at] = true;
}

void MjcfReader::finishMass(Link& own, bool hasInertial, const SolidSums& ofGeoms) {
  if (!hasInertial && compiler_.inertiaFromGeoms > 0) own.mass = ofGeoms;
  if (&own == &model_.links.front()) return;
  const bool bounded = compiler_.boundMass > 0 || compiler_.boundInertia > 0;
  if (!bounded && !compiler_.balanceInertia) return;
  MassProperties mass = own.mass.volume > 0 ? principal(own.mass) : MassProperties{};
  mass.mass = std::max(mass.mass, compiler_.boundMass);
  for (int k = 0; k < 3; ++k) mass.inertia[k] = std::max(mass.inertia[k], compiler_.boundInertia);
  const Vec3& i = mass.inertia;
  if (compiler_.balanceInertia && (i.x + i.y < i.z || i.y + i.z < i.x || i.z + i.x < i.y)) {
    const double mean = (i.x + i.y + i.z) / 3;
    mass.inertia = {mean, mean, mean};
  }
  own.mass = sumsOf(mass);
}

void MjcfReader::scaleTotalMass() {
  if (!(compiler_.totalMass > 0)) return;
  double total = 0;
  for (std::size_t i = 1; i < model_.links.size(); ++i) total += model_.links[i].mass.volume;
  if (!(total > 0)) return;
  for (std::size_t i = 1; i < model_.links.size(); ++i)
    model_.links[i].mass = placed(model_.links[i].mass, {}, {}, compiler_.totalMass / total);
}

}  // namespace rubble::convert

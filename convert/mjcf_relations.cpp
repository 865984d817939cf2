/// <contact> and <equality>: pairs that do not collide, loops, couplings.
#include <algorithm>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

int MjcfReader::linkOf(const Tag& tag, const char* key) const {
  const std::string name = tag.need(key);
  const auto found = linkByName_.find(name);
  if (found == linkByName_.end()) tag.fail(key, "the name of a body", "\"" + name + "\"");
  return found->second;
}

void MjcfReader::readContact(pugi::xml_node node) {
  for (const pugi::xml_node& child : source_.children(node)) {
    const std::string_view type = child.name();
    if (type == "pair" && compiler_.contacts) readPair(tagOf(child));
    if (type == "exclude") {
      const Tag tag(source_, child);
      tag.text("name");
      model_.exclusions.emplace_back(linkOf(tag, "body1"), linkOf(tag, "body2"));
      report_.converted(tag.place(), "exclude" + inQuotes(tag.name()), "pair of bodies that do not collide");
    }
  }
}

void MjcfReader::readPair(const Tag& tag) {
  const auto first = geoms_.find(tag.need("geom1")), second = geoms_.find(tag.need("geom2"));
  if (first == geoms_.end() || second == geoms_.end())
    return report_.note(Effect::Lost, tag.place(), tag.describe(), "one of its geoms is not there");
  model_.pairs.push_back({tag.name(), tag.place(), first->second, second->second});
}

void MjcfReader::finishPairs() {
  constexpr std::size_t kMostPairs = 64;
  for (; model_.pairs.size() > kMostPairs; model_.pairs.pop_back())
    report_.note(Effect::Lost, model_.pairs.back().place, "pair" + inQuotes(model_.pairs.back().name),
                 "more than 64 pairs");
  for (std::size_t i = 0; i < model_.pairs.size(); ++i)
    for (const auto& [at, index] : {model_.pairs[i].geomA, model_.pairs[i].geomB})
      link(at).geoms[static_cast<std::size_t>(index)].contact.pairs |= std::uint64_t{1} << i;
}

Pose MjcfReader::referencePose(int at) const {
  Pose out;
  for (; at >= 0; at = model_.links[static_cast<std::size_t>(at)].parent)
    out = model_.links[static_cast<std::size_t>(at)].pose * out;
  return out;
}

void MjcfReader::readEquality(pugi::xml_node node) {
  for (const pugi::xml_node& child : source_.children(node)) {
    const std::string_view type = child.name();
    if (type != "connect" && type != "weld" && type != "joint" && type != "tendon") continue;
    const Tag tag = tagOfKind(child, "equality");
    if (!tag.flag("active", true) || !compiler_.equality) {
      tag.useAll();
      report_.note(Effect::None, tag.place(), "equality" + inQuotes(tag.name()), "it is not active");
      continue;
    }
    if (type == "joint")
      readCoupling(tag);
    else if (type == "tendon")
      readTendonLock(tag);
    else
      readLoop(tag);
  }
}

void MjcfReader::readLoop(const Tag& tag) {
  MjcfLoop loop;
  loop.name = tag.name();
  loop.place = tag.place();
  loop.keepsOrientation = tag.type() == "weld";
  loop.soft = softnessOf(tag, "solref", "solimp");
  if (tag.has("site1")) {
    const MjcfSite &a = siteOf(tag, "site1"), &b = siteOf(tag, "site2");
    loop.linkA = a.link, loop.linkB = b.link;
    loop.anchorA = a.pose.p, loop.anchorB = b.pose.p;
    loop.orientationAtoB = normalize(b.pose.q * conjugate(a.pose.q));
    loops_.push_back(loop);
    return;
  }
  loop.linkA = linkOf(tag, "body1");
  loop.linkB = tag.has("body2") ? linkOf(tag, "body2") : 0;
  loop.anchor = tag.vector("anchor").value_or(Vec3{});
  if (loop.keepsOrientation) {
    const auto pose = tag.numbers("relpose", 7, 7);
    const Quat q = pose ? Quat{(*pose)[3], (*pose)[4], (*pose)[5], (*pose)[6]} : Quat{0, 0, 0, 0};
    if (q.s != 0 || lengthSquared(q.v) > 0)
      loop.inA = Pose{{(*pose)[0], (*pose)[1], (*pose)[2]}, normalize(q)};
  } else if (!tag.has("anchor")) {
    tag.fail("anchor", "a point", "none");
  }
  loops_.push_back(loop);
}

void MjcfReader::finishLoops() {
  for (MjcfLoop& loop : loops_) {
    if (loop.anchor) {
      const Pose inA = loop.inA.value_or(inverse(referencePose(loop.linkA)) * referencePose(loop.linkB));
      loop.anchorA = loop.keepsOrientation ? inA * *loop.anchor : *loop.anchor;
      loop.anchorB = loop.keepsOrientation ? *loop.anchor : inverse(inA) * *loop.anchor;
      loop.orientationAtoB = conjugate(inA.q);
    }
    model_.loops.push_back(loop);
  }
}

void MjcfReader::readCoupling(const Tag& tag) {
  const auto dofOf = [&](const char* key) {
    const std::string name = tag.need(key);
    const auto found = dofByName_.find(name);
    if (found == dofByName_.end()) tag.fail(key, "the name of a hinge or slide", "\"" + name + "\"");
    if (dof(found->second).type == DofType::Ball) tag.fail(key, "a hinge or slide", "a ball joint");
    return found->second;
  };
  std::vector<double> terms{0, 1, 0, 0, 0};
  if (const auto given = tag.numbers("polycoef", 1, 5))
    std::copy(given->begin(), given->end(), terms.begin());
  const std::pair<int, int> first = dofOf("joint1");
  const std::optional<Softness> soft = softnessOf(tag, "solref", "solimp");
  if (!tag.has("joint2")) {
    Dof& own = dof(first);
    own.range = {own.reference + terms[0], own.reference + terms[0]};
    const double mass = soft ? massSeen({{first, 1}}) : 0;
    own.limitStiffness = mass > 0 ? soft->stiffness * mass : kHard;
    own.limitDamping = mass > 0 ? soft->damping(mass) : 0;
    report_.converted(tag.place(), tag.describe(), "locked joint" + inQuotes(own.name));
    return;
  }
  model_.couplings.push_back({tag.name(), tag.place(), first, dofOf("joint2"), {}});
  Coupling& own = model_.couplings.back();
  std::copy(terms.begin(), terms.end(), own.terms.begin());
  if (const double mass = soft ? massSeen({{first, 1}, {own.dofB, -terms[1]}}) : 0; mass > 0)
    own.stiffness = soft->stiffness * mass, own.damping = soft->damping(mass);
}

}  // namespace rubble::convert

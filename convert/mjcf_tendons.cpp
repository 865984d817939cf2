/// <tendon>: spatial tendons along sites, and fixed ones, which are sums of coordinates.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

void MjcfReader::readTendon(const Tag& tag) {
  if (tag.type() != "spatial" && tag.type() != "fixed")
    return report_.note(Effect::Lost, tag.place(), tag.describe(), "an element that is not known here");
  Tendon out;
  out.name = tag.name();
  out.place = tag.place();
  if (tag.type() == "spatial")
    readPath(tag, out);
  else
    readSum(tag, out);
  const auto atLeast0 = [&](const char* key) {
    const auto list = tag.numbers(key, 1, 3).value_or(std::vector<double>{0});
    if (list[0] < 0) tag.fail(key, "a number of at least 0", std::to_string(list[0]));
    for (std::size_t i = 1; i < list.size(); ++i)
      if (list[i] != 0)
        report_.note(Effect::Lost, tag.place(), tag.type() + "." + key, "the terms of higher order");
    return list[0];
  };
  if (const auto range = limitOf(tag, "range", "limited"); range && compiler_.limits) out.range = range;
  const double stiffness = atLeast0("stiffness"), damping = atLeast0("damping"),
               friction = atLeast0("frictionloss");
  out.armature = atLeast0("armature");
  if (compiler_.dampers) out.damping = damping;
  if (compiler_.friction) out.friction = friction;
  // one length, or a range in which there is no force; below 0: that of the pose in the file
  const auto rest = tag.numbers("springlength", 1, 2).value_or(std::vector<double>{-1});
  if (compiler_.springs && stiffness > 0) {
    const double first = rest[0] < 0 ? lengthInFile(out) : rest[0], last = rest.size() > 1 ? rest[1] : first;
    if (first == last) {
      out.drive.stiffness = stiffness;
      out.drive.stiffnessTarget = stiffness * first;
    } else if (!out.range) {
      out.range = {{first, last}};
      out.limitStiffness = stiffness;
    } else {
      report_.note(Effect::Lost, tag.place(), tag.type() + ".springlength", "a dead band beside a range");
    }
  }
  if (!out.name.empty() && !tendonByName_.emplace(out.name, model_.tendons.size()).second)
    tag.fail("name", "a name that no other tendon has", "\"" + out.name + "\"");
  model_.tendons.push_back(std::move(out));
}

void MjcfReader::readPath(const Tag& tag, Tendon& out) {
  double divisor = 1;
  bool wraps = false;
  for (const pugi::xml_node& child : source_.children(tag.node())) {
    const Tag part(source_, child);
    if (part.type() == "pulley") {
      divisor = part.needNumber("divisor");
      if (!(divisor > 0)) part.fail("divisor", "a number above 0", std::to_string(divisor));
      if (!out.path.empty()) out.path.back().weight = 0;
    } else if (part.type() == "site") {
      const std::string name = part.need("site");
      const auto found = sites_.find(name);
      if (found == sites_.end()) part.fail("site", "the name of a site", "\"" + name + "\"");
      out.path.push_back({found->second.link, found->second.pose.p, 1 / divisor});
    } else if (part.type() == "geom") {
      part.need("geom"), part.text("sidesite");
      wraps = true;
    }
  }
  if (out.path.size() < 2) tag.fail("site", "two sites", std::to_string(out.path.size()));
  out.path.back().weight = 0;
  if (wraps)
    report_.note(Effect::Lost, tag.place(), "spatial.geom", "the tendon is straight and does not wrap geoms");
}

void MjcfReader::readSum(const Tag& tag, Tendon& out) {
  for (const pugi::xml_node& child : source_.children(tag.node(), "joint")) {
    const Tag part(source_, child);
    const std::string name = part.need("joint");
    const auto found = dofByName_.find(name);
    if (found == dofByName_.end() || dof(found->second).type == DofType::Ball)
      part.fail("joint", "the name of a hinge or slide", "\"" + name + "\"");
    out.terms.push_back({found->second, part.needNumber("coef")});
  }
  if (out.terms.empty()) tag.fail("joint", "a joint", "none");
}

double MjcfReader::lengthInFile(const Tendon& tendon) const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < tendon.path.size(); ++i) {
    const Tendon::Point &a = tendon.path[i], &b = tendon.path[i + 1];
    sum += a.weight * length(referencePose(b.link) * b.at - referencePose(a.link) * a.at);
  }
  for (const Tendon::Term& term : tendon.terms)
    sum += term.coefficient * model_.links[static_cast<std::size_t>(term.dof.first)]
                                  .dofs[static_cast<std::size_t>(term.dof.second)]
                                  .reference;
  return sum;
}

void MjcfReader::readTendonLock(const Tag& tag) {
  const std::string name = tag.need("tendon1");
  const auto found = tendonByName_.find(name);
  if (found == tendonByName_.end()) tag.fail("tendon1", "the name of a tendon", "\"" + name + "\"");
  if (tag.has("tendon2"))
    return report_.note(Effect::Lost, tag.place(), tag.describe(), "a relation of two tendons");
  const double offset = tag.numbers("polycoef", 1, 5).value_or(std::vector<double>{0})[0];
  Tendon& own = model_.tendons[found->second];
  const double length = lengthInFile(own) + offset;
  own.range = {{length, length}};
  report_.converted(tag.place(), tag.describe(), "locked tendon" + inQuotes(own.name));
}

}  // namespace rubble::convert

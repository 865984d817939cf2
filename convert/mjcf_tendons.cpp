/// <tendon>: spatial tendons along sites, and fixed ones, which are sums of coordinates.
#include <algorithm>
#include <cmath>
#include <set>

#include "convert/mjcf_lengths.h"

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
  if (const auto soft = out.range ? softnessOf(tag, "solreflimit", "solimplimit") : std::nullopt)
    if (const double mass = massSeen(momentsOf(out)); mass > 0)
      out.limitStiffness = soft->stiffness * mass, out.limitDamping = soft->damping(mass);
  const double stiffness = atLeast0("stiffness"), damping = atLeast0("damping"),
               friction = atLeast0("frictionloss");
  out.armature = atLeast0("armature");
  if (compiler_.dampers) out.damping = damping;
  if (compiler_.friction) out.friction = friction;
  // one length, or a range in which there is no force; below 0: that of the pose in the file
  const auto rest = tag.numbers("springlength", 1, 2).value_or(std::vector<double>{-1});
  if (compiler_.springs && stiffness > 0) {
    const double first = rest[0] < 0 ? lengthAtRest(out) : rest[0], last = rest.size() > 1 ? rest[1] : first;
    if (first == last) {
      out.drive.stiffness = stiffness;
      out.drive.stiffnessTarget = stiffness * first;
    } else if (!out.range) {
      out.range = {{first, last}};
      out.limitStiffness = stiffness;
    } else {
      // beside a range: a tendon of its own
      Tendon band = out;
      band.name = out.name.empty() ? "" : out.name + "_spring";
      static_cast<Coordinate&>(band) = {};
      band.range = {{first, last}}, band.limitStiffness = stiffness;
      model_.tendons.push_back(std::move(band));
    }
  }
  if (!out.name.empty() && !tendonByName_.emplace(out.name, model_.tendons.size()).second)
    tag.fail("name", "a name that no other tendon has", "\"" + out.name + "\"");
  model_.tendons.push_back(std::move(out));
}

const MjcfSite& MjcfReader::siteOf(const Tag& tag, const char* key) const {
  const std::string name = tag.need(key);
  const auto found = sites_.find(name);
  if (found == sites_.end()) tag.fail(key, "the name of a site", "\"" + name + "\"");
  return found->second;
}

void MjcfReader::readPath(const Tag& tag, Tendon& out) {
  double divisor = 1;
  std::string before;
  for (const pugi::xml_node& child : source_.children(tag.node())) {
    const Tag part(source_, child);
    const std::string type = part.type();
    if (type == "pulley") {
      if (before == "geom") part.fail("divisor", "a site between a geom and a pulley", "none");
      divisor = part.needNumber("divisor");
      if (!(divisor > 0)) part.fail("divisor", "a number above 0", std::to_string(divisor));
      if (!out.path.empty()) out.path.back().weight = 0;
    } else if (type == "site") {
      const MjcfSite& site = siteOf(part, "site");
      out.path.push_back({site.link, site.pose.p, 1 / divisor});
    } else if (type == "geom") {
      if (before != "site") part.fail("geom", "a geom between two sites", "one after none");
      readWrap(part, out);
    } else {
      continue;
    }
    before = type;
  }
  if (before == "geom") tag.fail("geom", "a geom between two sites", "one before none");
  if (out.path.size() < 2) tag.fail("site", "two sites", std::to_string(out.path.size()));
  out.path.back().weight = 0;
}

void MjcfReader::readWrap(const Tag& tag, Tendon& out) {
  const std::string name = tag.need("geom");
  const auto found = rounds_.find(name);
  if (found == rounds_.end()) tag.fail("geom", "the name of a sphere or cylinder", "\"" + name + "\"");
  const MjcfRound& round = found->second;
  Tendon::Wrap wrap;
  wrap.point = out.path.size() - 1;
  wrap.link = round.link, wrap.center = round.pose.p, wrap.radius = round.radius;
  if (round.isCylinder) wrap.axis = rotate(round.pose.q, Vec3{0, 0, 1});
  if (tag.has("sidesite")) {
    const MjcfSite& site = siteOf(tag, "sidesite");
    if (site.link != round.link)
      report_.note(Effect::Approximate, tag.place(), "geom.sidesite",
                   "a side site on another body moves with the geom");
    const Pose seen = inverse(referencePose(round.link)) * referencePose(site.link);
    wrap.guide = seen * site.pose.p - wrap.center;
  }
  out.wraps.push_back(wrap);
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

Pose MjcfReader::restPose(int at) const {
  return poseWith(at, [&](const std::pair<int, int>& own) {
    const auto rest = springRest_.find(own);
    if (rest == springRest_.end()) return 0.;
    const Link& link = model_.links[static_cast<std::size_t>(own.first)];
    return rest->second - link.dofs[static_cast<std::size_t>(own.second)].reference;
  });
}

double MjcfReader::lengthInFile(const Tendon& tendon) const {
  return lengthOf(
      tendon, [&](int link) { return referencePose(link); },
      [&](const std::pair<int, int>& at) {
        return model_.links[static_cast<std::size_t>(at.first)]
            .dofs[static_cast<std::size_t>(at.second)]
            .reference;
      });
}

Moments MjcfReader::momentsOf(const Tendon& tendon) const {
  std::map<std::pair<int, int>, double> rates;
  for (const Tendon::Term& term : tendon.terms) rates[term.dof] += term.coefficient;
  std::set<int> links;
  const auto addAll = [&](int at) {
    for (; at > 0; at = model_.links[static_cast<std::size_t>(at)].parent) links.insert(at);
  };
  for (const Tendon::Point& point : tendon.path) addAll(point.link);
  for (const Tendon::Wrap& wrap : tendon.wraps) addAll(wrap.link);
  Tendon path;
  path.path = tendon.path, path.wraps = tendon.wraps;
  for (const int at : links) {
    const Link& link = model_.links[static_cast<std::size_t>(at)];
    for (std::size_t k = 0; k < link.dofs.size(); ++k) {
      const Dof& dof = link.dofs[k];
      if (dof.type == DofType::Ball) continue;
      const auto lengthAt = [&](double change) {
        const Quat turn = fromAxisAngle(dof.axis, change);
        const Pose motion = dof.type == DofType::Slide ? Pose{change * dof.axis, {}}
                                                       : Pose{dof.anchor - rotate(turn, dof.anchor), turn};
        const Pose from = referencePose(at), moved = from * motion * inverse(from);
        return lengthOf(
            path,
            [&](int of) {
              int up = of;
              while (up > at) up = model_.links[static_cast<std::size_t>(up)].parent;
              return up == at ? moved * referencePose(of) : referencePose(of);
            },
            [](const std::pair<int, int>&) { return 0.; });
      };
      constexpr double kStep = 1e-5;
      rates[{at, static_cast<int>(k)}] += (lengthAt(kStep) - lengthAt(-kStep)) / (2 * kStep);
    }
  }
  return {rates.begin(), rates.end()};
}

double MjcfReader::lengthAtRest(const Tendon& tendon) const {
  return lengthOf(
      tendon, [&](int link) { return restPose(link); },
      [&](const std::pair<int, int>& at) { return springRest_.at(at); });
}

void MjcfReader::readTendonLock(const Tag& tag) {
  const std::string name = tag.need("tendon1");
  const auto found = tendonByName_.find(name);
  if (found == tendonByName_.end()) tag.fail("tendon1", "the name of a tendon", "\"" + name + "\"");
  const auto terms = tag.numbers("polycoef", 1, 5).value_or(std::vector<double>{0, 1});
  if (tag.has("tendon2")) return readTendonRelation(tag, found->second, terms);
  const double offset = terms[0];
  Tendon& own = model_.tendons[found->second];
  const double length = lengthInFile(own) + offset;
  own.range = {{length, length}};
  if (const auto soft = softnessOf(tag, "solref", "solimp"))
    if (const double mass = massSeen(momentsOf(own)); mass > 0)
      own.limitStiffness = soft->stiffness * mass, own.limitDamping = soft->damping(mass);
  report_.converted(tag.place(), tag.describe(), "locked tendon" + inQuotes(own.name));
}

void MjcfReader::readTendonRelation(const Tag& tag, std::size_t first, const std::vector<double>& terms) {
  const std::string name = tag.need("tendon2");
  const auto found = tendonByName_.find(name);
  if (found == tendonByName_.end()) tag.fail("tendon2", "the name of a tendon", "\"" + name + "\"");
  const Tendon other = model_.tendons[found->second];
  const double factor = terms.size() > 1 ? -terms[1] : terms.size() == 1 ? 0 : -1;
  if (std::any_of(terms.begin() + std::min<std::ptrdiff_t>(2, std::ssize(terms)), terms.end(),
                  [](double term) { return term != 0; }))
    return report_.note(Effect::Lost, tag.place(), tag.describe(), "terms of higher order of two tendons");
  if (factor < 0 && !other.path.empty())
    return report_.note(Effect::Lost, tag.place(), tag.describe(),
                        "two tendons along sites that grow together");
  // length_1 + factor length_2 keeps its value
  Tendon sum = model_.tendons[first];
  static_cast<Coordinate&>(sum) = {};
  sum.name = tag.name(), sum.place = tag.place();
  for (Tendon::Wrap wrap : other.wraps) {
    wrap.point += sum.path.size();
    sum.wraps.push_back(wrap);
  }
  for (Tendon::Point point : other.path) {
    point.weight *= factor;
    sum.path.push_back(point);
  }
  for (Tendon::Term term : other.terms) {
    term.coefficient *= factor;
    sum.terms.push_back(term);
  }
  const double length = lengthInFile(sum) + terms[0];
  sum.range = {{length, length}};
  if (const auto soft = softnessOf(tag, "solref", "solimp"))
    if (const double mass = massSeen(momentsOf(sum)); mass > 0)
      sum.limitStiffness = soft->stiffness * mass, sum.limitDamping = soft->damping(mass);
  model_.tendons.push_back(std::move(sum));
  report_.converted(tag.place(), tag.describe(), "sum of two tendons that keeps its length");
}

}  // namespace rubble::convert

/// <attach>: bodies of another MJCF file, with what joins them, under a prefix.
#include <map>

#include <rubble/error.h>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

constexpr int kMostLevels = 8;

}  // namespace

void MjcfReader::readAttach(const Tag& tag, const MjcfScope& scope) {
  const std::string name = tag.need("model"), prefix = tag.text("prefix").value_or("");
  const auto file = attached_.find(name);
  if (file == attached_.end()) tag.fail("model", "the name of a model of <asset>", "\"" + name + "\"");
  if (level_ == kMostLevels) tag.fail("model", "at most 8 levels of attached models", "more");
  Source source(source_.folders());
  const pugi::xml_node root = source.load(file->second, tag.path("model"));
  const ImportOptions options;
  MjcfReader reader(source, options, report_);
  reader.level_ = level_ + 1;
  Model part = reader.read(root);
  noteUnusedMjcf(source, report_);
  elements_ += reader.elements_;

  // links of the part that are taken over; the world of the part becomes the body that it is attached to
  std::map<int, int> taken;
  const std::optional<std::string> body = tag.text("body");
  int top = 0;
  if (body) {
    const auto found = reader.linkByName_.find(*body);
    if (found == reader.linkByName_.end() || found->second == 0)
      tag.fail("body", "the name of a body of the model", "\"" + *body + "\"");
    top = found->second;
  } else {
    for (Geom& geom : part.links[0].geoms) {
      geom.pose = scope.pose * geom.pose;
      link(scope.link).geoms.push_back(std::move(geom));
    }
  }
  const auto named = [&](const std::string& own) { return own.empty() ? own : prefix + own + scope.suffix; };
  for (int i = 1; i < static_cast<int>(part.links.size()); ++i) {
    Link& own = part.links[static_cast<std::size_t>(i)];
    const bool isTop = body ? i == top : own.parent == 0;
    if (!isTop && !taken.contains(own.parent)) continue;
    if (isTop) own.pose = scope.pose * own.pose;
    if (isTop && scope.link != 0 && (own.free || own.kinematic))
      tag.fail("body", "a free or mocap body as a child of the world", "a child of another body");
    own.parent = isTop ? scope.link : taken.at(own.parent);
    own.name = named(own.name);
    for (Dof& dof : own.dofs) dof.name = named(dof.name);
    for (Geom& geom : own.geoms) geom.name = named(geom.name);
    taken[i] = static_cast<int>(model_.links.size());
    model_.links.push_back(std::move(own));
    geomMass_.emplace_back(), hasInertial_.push_back(true);
  }

  const auto isTaken = [&](int at) { return taken.contains(at); };
  const auto add = [&](auto& to, const auto& from, const auto& change) {
    for (const auto& [key, value] : from) {
      auto own = value;
      if (change(own) && !to.emplace(named(key), own).second)
        tag.fail("prefix", "names that no others have", "\"" + named(key) + "\"");
    }
  };
  const auto moveDof = [&](std::pair<int, int>& dof) {
    if (!isTaken(dof.first)) return false;
    dof.first = taken.at(dof.first);
    return true;
  };
  const auto moveLink = [&](int& at) {
    if (!isTaken(at)) return false;
    at = taken.at(at);
    return true;
  };
  add(linkByName_, reader.linkByName_, moveLink);
  add(dofByName_, reader.dofByName_, moveDof);
  add(sites_, reader.sites_, [&](MjcfSite& site) { return moveLink(site.link); });
  add(rounds_, reader.rounds_, [&](MjcfRound& round) { return moveLink(round.link); });
  add(geoms_, reader.geoms_, moveDof);
  for (const auto& [dof, rest] : reader.springRest_)
    if (std::pair<int, int> own = dof; moveDof(own)) springRest_[own] = rest;
  for (const auto& [dof, most] : reader.actuatorForce_)
    if (std::pair<int, int> own = dof; moveDof(own)) actuatorForce_[own] = most;

  const auto lose = [&](const Place& place, const std::string& what) {
    report_.note(Effect::Lost, place, what, "its bodies are not all attached");
  };
  for (Loop& loop : part.loops) {
    if (!moveLink(loop.linkA) || !moveLink(loop.linkB)) {
      lose(loop.place, "equality" + inQuotes(loop.name));
      continue;
    }
    loop.name = named(loop.name);
    model_.loops.push_back(std::move(loop));
  }
  for (Coupling& coupling : part.couplings) {
    if (!moveDof(coupling.dofA) || !moveDof(coupling.dofB)) {
      lose(coupling.place, "equality" + inQuotes(coupling.name));
      continue;
    }
    coupling.name = named(coupling.name);
    model_.couplings.push_back(std::move(coupling));
  }
  for (Tendon& tendon : part.tendons) {
    bool whole = true;
    for (Tendon::Point& point : tendon.path) whole = moveLink(point.link) && whole;
    for (Tendon::Wrap& wrap : tendon.wraps) whole = moveLink(wrap.link) && whole;
    for (Tendon::Term& term : tendon.terms) whole = moveDof(term.dof) && whole;
    if (!whole) {
      lose(tendon.place, "tendon" + inQuotes(tendon.name));
      continue;
    }
    tendon.name = named(tendon.name);
    if (!tendon.name.empty()) tendonByName_.emplace(tendon.name, model_.tendons.size());
    model_.tendons.push_back(std::move(tendon));
  }
  for (std::pair<int, int> each : part.exclusions)
    if (moveLink(each.first) && moveLink(each.second)) model_.exclusions.push_back(each);
  for (const SoftObject& object : part.objects)
    report_.note(Effect::Lost, object.place, "flexcomp", "a flexible object of an attached model");
  report_.converted(tag.place(), "attach" + inQuotes(name), std::to_string(taken.size()) + " bodies");
}

}  // namespace rubble::convert

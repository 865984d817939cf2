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

  // what joins links of the part, if all of them are taken over
  const auto takeOver = [&](auto& from, auto& to, const std::string& what, const auto& move) {
    for (auto& each : from) {
      if (!move(each)) {
        report_.note(Effect::Lost, each.place, what + inQuotes(each.name), "its bodies are not all attached");
        continue;
      }
      each.name = named(each.name);
      to.push_back(std::move(each));
    }
  };
  takeOver(part.loops, model_.loops, "equality",
           [&](Loop& loop) { return moveLink(loop.linkA) && moveLink(loop.linkB); });
  takeOver(part.couplings, model_.couplings, "equality",
           [&](Coupling& coupling) { return moveDof(coupling.dofA) && moveDof(coupling.dofB); });
  std::size_t next = model_.tendons.size();
  takeOver(part.tendons, model_.tendons, "tendon", [&](Tendon& tendon) {
    bool whole = true;
    for (Tendon::Point& point : tendon.path) whole = moveLink(point.link) && whole;
    for (Tendon::Wrap& wrap : tendon.wraps) whole = moveLink(wrap.link) && whole;
    for (Tendon::Term& term : tendon.terms) whole = moveDof(term.dof) && whole;
    return whole;
  });
  for (; next < model_.tendons.size(); ++next)
    if (const std::string& own = model_.tendons[next].name; !own.empty()) tendonByName_.emplace(own, next);
  for (std::pair<int, int> each : part.exclusions)
    if (moveLink(each.first) && moveLink(each.second)) model_.exclusions.push_back(each);
  for (const SoftObject& object : part.objects)
    report_.note(Effect::Lost, object.place, "flexcomp", "a flexible object of an attached model");
  report_.converted(tag.place(), "attach" + inQuotes(name), std::to_string(taken.size()) + " bodies");
}

}  // namespace rubble::convert

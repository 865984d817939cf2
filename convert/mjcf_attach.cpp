/// <attach>: bodies of another MJCF file, with what joins them, under a prefix.
#include <algorithm>
#include <map>

#include <rubble/error.h>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

constexpr int kMostLevels = 8;

/// The name of something that an attached model has.
std::string& nameOf(auto& each) { return each.name; }
std::string& nameOf(SoftObject& each) { return common(each.object).name; }
std::string& nameOf(ModelSensor& each) { return each.sensor.name; }
std::string& nameOf(ModelActuator& each) { return each.actuator.name; }

}  // namespace

void MjcfReader::readAttach(const Tag& tag, const MjcfScope& scope) {
  const std::string name = tag.need("model"), prefix = tag.text("prefix").value_or("");
  const auto file = attached_.find(name);
  if (file == attached_.end()) tag.fail("model", "the name of a model of <asset>", "\"" + name + "\"");
  if (level_ == kMostLevels) tag.fail("model", "at most 8 levels of attached models", "more");
  Source source(source_.folders());
  const pugi::xml_node root = source.load(file->second, tag.path("model"));
  // its keyframes have the prefix before their names; of several copies the first one starts in them
  ImportOptions options;
  if (!foundKey_ && options_.key.starts_with(prefix)) options.key = options_.key.substr(prefix.size());
  MjcfReader reader(source, options, report_);
  reader.level_ = level_ + 1, reader.frame_ = frame_ * scope.pose;
  Model part = reader.read(root);
  noteUnusedMjcf(source, report_);
  elements_ += reader.elements_, foundKey_ = foundKey_ || reader.foundKey_;

  const auto named = [&](const std::string& own) { return own.empty() ? own : prefix + own + scope.suffix; };
  // the links of the part that are taken over: which links they are now, and where in these
  std::map<int, MjcfSite> taken;
  const std::optional<std::string> body = tag.text("body");
  const int firstGeom = static_cast<int>(link(scope.link).geoms.size());
  int top = 0;
  if (body) {
    const auto found = reader.linkByName_.find(*body);
    if (found == reader.linkByName_.end() || found->second == 0)
      tag.fail("body", "the name of a body of the model", "\"" + *body + "\"");
    top = found->second;
  } else {
    // what is in the world of the part becomes a part of the body that it is attached to
    taken[0] = {scope.link, scope.pose};
    for (Geom& geom : part.links[0].geoms) {
      geom.pose = scope.pose * geom.pose;
      geom.name = named(geom.name);
      link(scope.link).geoms.push_back(std::move(geom));
    }
    for (DrawnShape& drawn : part.links[0].drawn) {
      drawn.pose = scope.pose * drawn.pose;
      if (drawn.geom >= 0) drawn.geom += firstGeom;
      link(scope.link).drawn.push_back(std::move(drawn));
    }
    geomMass_[static_cast<std::size_t>(scope.link)] += placed(part.links[0].mass, scope.pose.p, scope.pose.q,
                                                              1);
  }
  for (int i = 1; i < static_cast<int>(part.links.size()); ++i) {
    Link& own = part.links[static_cast<std::size_t>(i)];
    const bool isTop = body ? i == top : own.parent == 0;
    if (!isTop && !taken.contains(own.parent)) continue;
    if (isTop) own.pose = scope.pose * own.pose;
    if (isTop && scope.link != 0 && (own.free || own.kinematic))
      tag.fail("body", "a free or mocap body as a child of the world", "a child of another body");
    own.parent = isTop ? scope.link : taken.at(own.parent).link;
    own.name = named(own.name);
    for (Dof& dof : own.dofs) dof.name = named(dof.name);
    for (Geom& geom : own.geoms) geom.name = named(geom.name);
    taken[i] = {static_cast<int>(model_.links.size()), {}};
    model_.links.push_back(std::move(own));
    geomMass_.emplace_back(), hasInertial_.push_back(true);
  }

  const auto add = [&](auto& to, const auto& from, const auto& change) {
    for (const auto& [key, value] : from) {
      auto own = value;
      if (change(own) && !to.emplace(named(key), own).second)
        tag.fail("prefix", "names that no others have", "\"" + named(key) + "\"");
    }
  };
  // each of these returns whether the link is taken over; moveLink the pose of its frame in the link that it
  // is now
  const auto moveLink = [&](int& at) -> const Pose* {
    const auto found = taken.find(at);
    if (found == taken.end()) return nullptr;
    at = found->second.link;
    return &found->second.pose;
  };
  // the world by its name is that of the whole model
  const auto moveBody = [&](int& at) { return at == 0 || moveLink(at); };
  const auto moveDof = [&](std::pair<int, int>& dof) { return moveLink(dof.first) != nullptr; };
  const auto moveGeom = [&](std::pair<int, int>& geom) {
    if (geom.first == 0) geom.second += firstGeom;
    return moveLink(geom.first) != nullptr;
  };
  const auto moveFrame = [&](auto& frame) {
    const Pose* const in = moveLink(frame.link);
    if (in) frame.pose = *in * frame.pose;
    return in != nullptr;
  };
  add(linkByName_, reader.linkByName_, [&](int& at) { return at != 0 && moveLink(at); });
  add(dofByName_, reader.dofByName_, moveDof);
  add(freeByName_, reader.freeByName_, [&](int& at) { return moveLink(at) != nullptr; });
  add(sites_, reader.sites_, moveFrame);
  add(rounds_, reader.rounds_, moveFrame);
  add(geoms_, reader.geoms_, moveGeom);
  for (const auto& [dof, rest] : reader.springRest_)
    if (std::pair<int, int> own = dof; moveDof(own)) springRest_[own] = rest;
  for (const auto& [dof, most] : reader.actuatorForce_)
    if (std::pair<int, int> own = dof; moveDof(own)) actuatorForce_[own] = most;
  for (MjcfCamera& own : reader.cameras_) {
    own.name = named(own.name);
    if (moveFrame(own) && (own.target.empty() || moveBody(own.targetLink)))
      cameras_.push_back(own);
    else
      report_.note(Effect::None, own.place, "camera" + inQuotes(own.name), "its bodies are not all attached");
  }
  if (!sun_ && reader.sun_ && moveFrame(*reader.sun_)) sun_ = reader.sun_;

  // what joins links of the part, if all of them are taken over
  const auto takeOver = [&](auto& from, auto& to, const std::string& what, const auto& move,
                            Effect effect = Effect::Lost) {
    std::vector<int> indices;  // that they have now; -1: none
    for (auto& each : from) {
      if (!move(each)) {
        report_.note(effect, each.place, what + inQuotes(nameOf(each)), "its bodies are not all attached");
        indices.push_back(-1);
        continue;
      }
      nameOf(each) = named(nameOf(each));
      indices.push_back(static_cast<int>(to.size()));
      to.push_back(std::move(each));
    }
    return indices;
  };
  takeOver(reader.loops_, loops_, "equality", [&](MjcfLoop& loop) {
    if (loop.anchor) return moveBody(loop.linkA) && moveBody(loop.linkB);
    const Pose *const a = moveLink(loop.linkA), *const b = moveLink(loop.linkB);
    if (!a || !b) return false;
    loop.anchorA = *a * loop.anchorA, loop.anchorB = *b * loop.anchorB;
    loop.orientationAtoB = normalize(b->q * loop.orientationAtoB * conjugate(a->q));
    return true;
  });
  takeOver(part.couplings, model_.couplings, "equality",
           [&](Coupling& coupling) { return moveDof(coupling.dofA) && moveDof(coupling.dofB); });
  std::size_t next = model_.tendons.size();
  const std::vector<int> tendons = takeOver(part.tendons, model_.tendons, "tendon", [&](Tendon& tendon) {
    bool whole = true;
    for (Tendon::Point& point : tendon.path) {
      const Pose* const in = moveLink(point.link);
      if (in) point.at = *in * point.at;
      whole = whole && in;
    }
    for (Tendon::Wrap& wrap : tendon.wraps) {
      const Pose* const in = moveLink(wrap.link);
      whole = whole && in;
      if (!in) continue;
      wrap.center = *in * wrap.center, wrap.axis = rotate(in->q, wrap.axis);
      if (wrap.guide) wrap.guide = rotate(in->q, *wrap.guide);
    }
    for (Tendon::Term& term : tendon.terms) whole = moveDof(term.dof) && whole;
    for (Tendon::Motion& motion : tendon.motions) {
      const auto moved = [&](int& at) {
        const Pose* const in = at < 0 ? nullptr : moveLink(at);
        whole = whole && (in || at < 0);
        return in ? *in : Pose{};
      };
      motion.anchor = moved(motion.link) * motion.anchor;
      motion.origin = moved(motion.frame) * motion.origin;
      motion.axis = rotate(moved(motion.axisLink).q, motion.axis);
    }
    return whole;
  });
  for (; next < model_.tendons.size(); ++next)
    if (const std::string& own = model_.tendons[next].name; !own.empty()) tendonByName_.emplace(own, next);
  takeOver(part.pairs, model_.pairs, "pair",
           [&](GeomPair& pair) { return moveGeom(pair.geomA) && moveGeom(pair.geomB); });
  for (std::pair<int, int> each : part.exclusions)
    if (moveBody(each.first) && moveBody(each.second)) model_.exclusions.push_back(each);
  const auto moveCoordinate = [&](std::pair<int, int>& dof, int& tendon) {
    if (tendon >= 0) return (tendon = tendons[static_cast<std::size_t>(tendon)]) >= 0;
    return moveDof(dof);
  };
  add(actuatorByName_, reader.actuatorByName_,
      [&](MjcfActuator& own) { return moveCoordinate(own.dof, own.tendon); });
  const auto addCoordinates = [&](const auto& from, auto& to) {
    for (auto own : from)
      if (moveCoordinate(own.first, own.second)) to.insert(own);
  };
  addCoordinates(reader.drivenCoordinates_, drivenCoordinates_);
  addCoordinates(reader.sharedCoordinates_, sharedCoordinates_);
  takeOver(part.actuators, model_.actuators, "actuator", [&](ModelActuator& own) {
    if (own.link < 0) return moveCoordinate(own.dof, own.tendon);
    const Pose* const in = moveLink(own.link);
    if (!in) return false;
    ActuatorDef& actuator = own.actuator;
    actuator.position = *in * actuator.position;
    actuator.force = rotate(in->q, actuator.force), actuator.torque = rotate(in->q, actuator.torque);
    return true;
  });
  takeOver(
      part.sensors, model_.sensors, "sensor",
      [&](ModelSensor& sensor) {
        const auto mount = [&](int& link, Vec3& position, Quat& orientation) {
          if (link < 0) return true;
          const Pose* const in = moveLink(link);
          if (in) position = *in * position, orientation = normalize(in->q * orientation);
          return in != nullptr;
        };
        SensorDef& own = sensor.sensor;
        const bool isOfAxis = sensor.dof.first >= 0 || sensor.tendon >= 0;
        return mount(sensor.link, own.position, own.orientation) &&
               mount(sensor.reference, own.referencePosition, own.referenceOrientation) &&
               (!isOfAxis || moveCoordinate(sensor.dof, sensor.tendon));
      },
      Effect::None);
  // vertices are in the world of the part
  const Pose partInWorld = referencePose(scope.link) * scope.pose;
  takeOver(part.objects, model_.objects, "flexcomp", [&](SoftObject& object) {
    if (!moveLink(object.link)) return false;
    bool whole = true;
    for (auto& [vertex, held] : object.pins) {
      int at = std::max(held, 0);
      whole = moveLink(at) && whole;
      held = at == 0 ? -1 : at;
    }
    for (Vec3& vertex : common(object.object).vertices) vertex = partInWorld * vertex;
    return whole;
  });
  report_.converted(tag.place(), "attach" + inQuotes(name),
                    std::to_string(taken.size() - taken.count(0)) + " bodies");
}

}  // namespace rubble::convert

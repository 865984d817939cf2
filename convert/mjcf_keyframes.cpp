/// <keyframe>: the pose and controls that the scene may start with.
#include <algorithm>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

void MjcfReader::readKeyframes(pugi::xml_node node) {
  int index = 0;
  for (const pugi::xml_node& child : source_.children(node, "key")) {
    const Tag tag(source_, child);
    const bool wanted = !options_.key.empty() && (tag.name() == options_.key ||
                                                  (level_ == 0 && std::to_string(index) == options_.key));
    if (wanted && !foundKey_) {
      foundKey_ = true;
      applyKey(tag);
      report_.converted(tag.place(), "key" + inQuotes(tag.name()), "start of the scene");
    } else {
      for (const pugi::xml_attribute& attribute : child.attributes()) source_.use(attribute);
      report_.note(Effect::None, tag.place(), "key" + inQuotes(tag.name()),
                   "the scene starts in it with --key");
    }
    ++index;
  }
}

void MjcfReader::readSpeeds(const Tag& tag) {
  std::size_t speeds = 0;
  for (const Link& each : model_.links) {
    speeds += each.free ? 6 : 0;
    for (const Dof& own : each.dofs) speeds += own.type == DofType::Ball ? 3 : 1;
  }
  const auto v = tag.numbers("qvel", speeds, speeds);
  if (!v) return;
  std::size_t at = 0;
  const auto vector = [&] {
    at += 3;
    return Vec3{(*v)[at - 3], (*v)[at - 2], (*v)[at - 1]};
  };
  for (Link& each : model_.links) {
    if (each.free) {
      each.velocity = vector(), each.velocityOfOrigin = true;
      each.angularVelocity = rotate(each.start ? each.start->q : (frame_ * each.pose).q, vector());
    }
    for (Dof& own : each.dofs) own.startSpeed = own.type == DofType::Ball ? vector() : Vec3{(*v)[at++], 0, 0};
  }
}

void MjcfReader::applyKey(const Tag& tag) {
  constexpr std::size_t kMost = 1000000;
  std::size_t positions = 0, mocaps = 0;
  for (const Link& each : model_.links) {
    positions += each.free ? 7 : 0;
    for (const Dof& own : each.dofs) positions += own.type == DofType::Ball ? 4 : 1;
    mocaps += each.kinematic ? 1 : 0;
  }
  const auto unit = [&](const std::vector<double>& list, std::size_t at, const char* key) {
    const Quat q{list[at], list[at + 1], list[at + 2], list[at + 3]};
    if (!(q.s * q.s + dot(q.v, q.v) > 1e-20)) tag.fail(key, "quaternions of some length", "one of length 0");
    return normalize(q);
  };
  if (const auto q = tag.numbers("qpos", positions, positions)) {
    std::size_t at = 0;
    for (Link& each : model_.links) {
      if (each.free) {
        each.start = Pose{{(*q)[at], (*q)[at + 1], (*q)[at + 2]}, unit(*q, at + 3, "qpos")};
        at += 7;
      }
      for (Dof& own : each.dofs) {
        if (own.type == DofType::Ball)
          own.startTurn = unit(*q, at, "qpos"), at += 4;
        else
          own.start = (*q)[at++] - own.reference;
      }
    }
  }
  const auto places = tag.numbers("mpos", 3 * mocaps, 3 * mocaps);
  const auto turns = tag.numbers("mquat", 4 * mocaps, 4 * mocaps);
  std::size_t mocap = 0;
  for (Link& each : model_.links) {
    if (!each.kinematic) continue;
    Pose pose = frame_ * each.pose;
    if (places) pose.p = {(*places)[3 * mocap], (*places)[3 * mocap + 1], (*places)[3 * mocap + 2]};
    if (turns) pose.q = unit(*turns, 4 * mocap, "mquat");
    each.start = pose;
    ++mocap;
  }
  readSpeeds(tag);
  controls_ = tag.numbers("ctrl", 0, kMost).value_or(std::vector<double>{});
  activations_ = tag.numbers("act", 0, kMost).value_or(std::vector<double>{});
  keyPlace_ = tag.place();
}

void MjcfReader::noteFurtherControls() {
  const auto further = [](const std::vector<double>& list, std::size_t own) {
    return std::any_of(list.begin() + static_cast<std::ptrdiff_t>(std::min(own, list.size())), list.end(),
                       [](double each) { return each != 0; });
  };
  if (further(controls_, actuators_) || further(activations_, activated_))
    report_.note(Effect::Lost, keyPlace_, "key.ctrl", "controls of actuators of attached models");
}

}  // namespace rubble::convert

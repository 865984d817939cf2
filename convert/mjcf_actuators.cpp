/// <actuator>: a force gear * (gain * ctrl + b0 + b1 * length + b2 * speed), with length = gear * q, is a
/// drive of stiffness -b1 gear^2 and damping -b2 gear^2. A force that depends on neither has no drive.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

/// Force of an actuator per unit gear: constant, by length and by speed. Empty: not of that form.
struct Law {
  double constant = 0, byLength = 0, bySpeed = 0;
};

std::optional<Law> generalLaw(const Tag& tag, double control) {
  const std::string dynamics = tag.text("dyntype").value_or("none"),
                    gain = tag.text("gaintype").value_or("fixed"),
                    bias = tag.text("biastype").value_or("none");
  const auto gains = tag.numbers("gainprm", 1, 10).value_or(std::vector<double>{1});
  auto biases = tag.numbers("biasprm", 1, 10).value_or(std::vector<double>{0});
  biases.resize(std::max<std::size_t>(biases.size(), 3));
  if (dynamics != "none" || gain != "fixed" || (bias != "none" && bias != "affine")) return std::nullopt;
  if (bias == "none") biases.assign(3, 0);
  return Law{gains[0] * control + biases[0], biases[1], biases[2]};
}

std::optional<Law> lawOf(const Tag& tag, double control, Report& report) {
  const std::string type = tag.type();
  if (type == "general") return generalLaw(tag, control);
  if (type == "motor") return Law{control, 0, 0};
  if (type == "position") {
    const double kp = tag.number("kp", 1), kv = tag.number("kv", 0);
    if (tag.number("dampratio", 0) != 0)
      report.note(Effect::Lost, tag.place(), "position.dampratio", "damping by a ratio; give kv");
    if (tag.number("timeconst", 0) != 0)
      report.note(Effect::Approximate, tag.place(), "position.timeconst", "the target is not filtered");
    return Law{kp * control, -kp, -kv};
  }
  if (type == "velocity") {
    const double kv = tag.number("kv", 1);
    return Law{kv * control, 0, -kv};
  }
  if (type == "damper") return Law{0, 0, -tag.number("kv", 1) * control};
  return std::nullopt;
}

}  // namespace

void MjcfReader::readActuator(const Tag& tag) {
  const std::size_t index = actuators_++;
  const std::string what = tag.type() + inQuotes(tag.name());
  const auto lose = [&](const std::string& why) { report_.note(Effect::Lost, tag.place(), what, why); };
  if (!compiler_.actuation) return report_.note(Effect::None, tag.place(), what, "actuation is disabled");
  const char* joint = tag.has("joint") ? "joint" : "jointinparent";
  if (!tag.has(joint)) return lose("only actuators of joints become drives");
  const auto found = dofByName_.find(tag.need(joint));
  if (found == dofByName_.end()) {
    const std::string& name = tag.need(joint);
    tag.fail(joint, "the name of a joint of a body", "\"" + name + "\"");
  }
  Dof& own = dof(found->second);
  if (own.type == DofType::Ball) return lose("an actuator of a ball joint");
  const double gear = tag.numbers("gear", 1, 6).value_or(std::vector<double>{1})[0];
  double control = index < controls_.size() ? controls_[index] : 0;
  if (const auto range = limitOf(tag, "ctrlrange", "ctrllimited"))
    control = std::clamp(control, (*range)[0], (*range)[1]);
  double most = kHard;
  if (const auto range = limitOf(tag, "forcerange", "forcelimited")) {
    most = std::fabs(gear) * std::max(std::fabs((*range)[0]), std::fabs((*range)[1]));
    if ((*range)[0] != -(*range)[1])
      report_.note(Effect::Approximate, tag.place(), tag.type() + ".forcerange",
                   "the larger bound holds both ways");
  }
  if (const auto limit = actuatorForce_.find(found->second); limit != actuatorForce_.end())
    most = std::min(most, limit->second);
  const std::optional<Law> law = lawOf(tag, control, report_);
  if (!law)
    return lose(
        "only motor, position, velocity, damper and general actuators without dynamics become drives");
  for (const char* passive : {"damping", "armature"})
    if (const auto list = tag.numbers(passive, 1, 3); list && (*list)[0] != 0)
      report_.note(Effect::Lost, tag.place(), tag.type() + "." + passive,
                   "of an actuator; give it to the joint");
  if (law->byLength > 0 || law->bySpeed > 0) return lose("a force that grows with position or speed");
  if (law->byLength == 0 && law->bySpeed == 0) {
    if (law->constant == 0)
      return lose("a drive has no plain force; apply " + std::to_string(gear) +
                  " N or N m for each unit of control with World::applyTorque or applyForce");
    return lose("a constant force");
  }
  if (law->byLength == 0 && law->constant != 0 && !(law->bySpeed < 0)) return lose("a constant force");
  DofDrive& drive = own.drive;
  if (most < kHard && (drive.stiffness > 0 || drive.damping > 0))
    report_.note(Effect::Approximate, tag.place(), what,
                 "the largest force of the drive also bounds spring and damping of the joint");
  const double square = gear * gear;
  drive.stiffness -= law->byLength * square, drive.damping -= law->bySpeed * square;
  (law->byLength < 0 ? drive.stiffnessTarget : drive.dampingSpeed) += gear * law->constant;
  drive.maxForce = drive.maxForce < kHard ? drive.maxForce + most : most;
  report_.converted(tag.place(), what, "drive of joint" + inQuotes(own.name));
}

}  // namespace rubble::convert

/// <actuator>: a force gear * f with f = constant + byLength * length + bySpeed * speed, length = gear * q,
/// is a drive of stiffness -byLength gear^2 and damping -bySpeed gear^2, or a plain force of a motor.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_muscle.h"
#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

using Law = MjcfLaw;

/// Is its input an activation, which follows the control by a differential equation?
bool hasActivation(const Tag& tag) {
  const std::string type = tag.type();
  return type == "intvelocity" || type == "cylinder" || type == "muscle" ||
         (type == "position" && tag.number("timeconst", 0) != 0) ||
         (type == "general" && tag.text("dyntype").value_or("none") != "none");
}

}  // namespace

std::optional<MjcfLaw> MjcfReader::lawOf(const Tag& tag, double control, double activation,
                                         const MjcfTarget& target) {
  const std::string type = tag.type();
  const auto approximate = [&](const char* key, const char* why) {
    report_.note(Effect::Approximate, tag.place(), type + "." + key, why);
  };
  const auto integrated = [&] {
    if (control != 0)
      report_.note(Effect::Lost, tag.place(), tag.describe(), "the target does not move with its control");
    return activation;
  };
  if (type == "motor") return Law{control, 0, 0};
  if (type == "position" || type == "intvelocity") {
    const double kp = tag.number("kp", 1), ratio = tag.number("dampratio", 0);
    double kv = tag.number("kv", 0);
    if (ratio > 0) {
      const double mass = massSeen(target.moments);
      kv = 2 * ratio * std::sqrt(std::max(kp * mass, 0.));
      if (!(mass > 0))
        report_.note(Effect::Lost, tag.place(), type + ".dampratio", "of this actuator; give kv");
    }
    if (tag.number("timeconst", 0) != 0) approximate("timeconst", "the target is not filtered");
    return Law{kp * (type == "position" ? control : integrated()), -kp, -kv};
  }
  if (type == "velocity") {
    const double kv = tag.number("kv", 1);
    return Law{kv * control, 0, -kv};
  }
  if (type == "damper") return Law{0, 0, -tag.number("kv", 1) * control};
  if (type == "muscle") return muscleLaw(tag, activation, target);
  auto biases = tag.numbers(type == "cylinder" ? "bias" : "biasprm", 1, 10).value_or(std::vector<double>{0});
  biases.resize(std::max<std::size_t>(biases.size(), 3));
  if (type == "cylinder") {
    const double diameter = tag.number("diameter", 0), area = tag.number("area", 1);
    if (control != 0) approximate("timeconst", "the control is not filtered");
    return Law{(diameter > 0 ? std::acos(-1.) / 4 * diameter * diameter : area) * control + biases[0],
               biases[1], biases[2]};
  }
  if (type != "general") return std::nullopt;
  const std::string dynamics = tag.text("dyntype").value_or("none"),
                    gain = tag.text("gaintype").value_or("fixed"),
                    bias = tag.text("biastype").value_or("none");
  if (dynamics == "muscle" || gain == "muscle" || bias == "muscle") return muscleLaw(tag, activation, target);
  if (gain != "fixed" && gain != "affine") return std::nullopt;
  if (bias != "none" && bias != "affine") return std::nullopt;
  auto gains = tag.numbers("gainprm", 1, 10).value_or(std::vector<double>{1});
  gains.resize(std::max<std::size_t>(gains.size(), 3));
  if (gain == "fixed") gains[1] = gains[2] = 0;
  if (bias == "none") biases.assign(3, 0);
  double input = control;
  if (dynamics == "integrator")
    input = integrated();
  else if (dynamics == "user")
    return std::nullopt;
  else if (dynamics != "none" && control != activation)
    approximate("dyntype", "the control is not filtered");
  return Law{gains[0] * input + biases[0], gains[1] * input + biases[1], gains[2] * input + biases[2]};
}

Vec3 MjcfReader::gearOf(const Tag& tag, std::size_t first) const {
  auto gear = tag.numbers("gear", 1, 6).value_or(std::vector<double>{1});
  gear.resize(6);
  return {gear[first], gear[first + 1], gear[first + 2]};
}

std::optional<MjcfTarget> MjcfReader::targetOf(const Tag& tag) {
  MjcfTarget out;
  out.gear = gearOf(tag, 0).x;
  if (tag.has("tendon")) {
    const std::string name = tag.need("tendon");
    const auto found = tendonByName_.find(name);
    if (found == tendonByName_.end()) tag.fail("tendon", "the name of a tendon", "\"" + name + "\"");
    Tendon& own = model_.tendons[found->second];
    out.coordinate = &own, out.what = "tendon" + inQuotes(name), out.length = out.gear * lengthInFile(own);
    out.moments = momentsOf(own);
    for (auto& moment : out.moments) moment.second *= out.gear;
    out.tendon = static_cast<int>(found->second);
    return out;
  }
  if (tag.has("site")) return targetOfSite(tag);
  const char* joint = tag.has("joint") ? "joint" : "jointinparent";
  if (!tag.has(joint)) {
    report_.note(Effect::Lost, tag.place(), tag.describe(), "only joints, tendons and sites have actuators");
    return std::nullopt;
  }
  const std::string name = tag.need(joint);
  if (const auto free = freeByName_.find(name); free != freeByName_.end())
    return targetOfTurns(tag, free->second, joint[5] != '\0');
  const auto found = dofByName_.find(name);
  if (found == dofByName_.end()) tag.fail(joint, "the name of a joint of a body", "\"" + name + "\"");
  Dof& own = dof(found->second);
  if (own.type == DofType::Ball) return targetOfTurns(tag, found->second.first, joint[5] != '\0');
  out.coordinate = &own, out.moments = {{found->second, out.gear}}, out.what = "joint" + inQuotes(own.name);
  out.length = out.gear * (own.reference + own.start);
  out.dof = found->second;
  if (const auto limit = actuatorForce_.find(found->second); limit != actuatorForce_.end())
    out.most = limit->second;
  return out;
}

double MjcfReader::controlOf(const Tag& tag, std::size_t index) {
  const double control = index < controls_.size() ? controls_[index] : 0;
  const auto range = limitOf(tag, "ctrlrange", "ctrllimited");
  return range && compiler_.clampsControls ? std::clamp(control, (*range)[0], (*range)[1]) : control;
}

void MjcfReader::readAdhesion(const Tag& tag, std::size_t index) {
  linkOf(tag, "body");
  const double force = tag.number("gain", 1) * controlOf(tag, index);
  report_.note(force == 0 ? Effect::None : Effect::Lost, tag.place(), tag.describe(),
               force == 0 ? "its control is 0: it does not pull" : "a pull of contacts on a body");
}

void MjcfReader::readActuator(const Tag& tag) {
  const std::size_t index = actuators_++, activated = activated_;
  activated_ += hasActivation(tag);
  const std::string what = tag.describe();
  const bool isOff = std::count(compiler_.actuatorsOff.begin(), compiler_.actuatorsOff.end(),
                                tag.number("group", 0)) > 0;
  if (!compiler_.actuation || isOff) {
    tag.useAll();
    return report_.note(Effect::None, tag.place(), what, "actuation is disabled");
  }
  if (tag.type() == "adhesion") return readAdhesion(tag, index);
  const auto target = targetOf(tag);
  if (!target) return tag.useAll();
  const double gear = target->gear, square = gear * gear;
  if (const std::pair key{target->dof, target->tendon}; key.first.first >= 0 || key.second >= 0) {
    const DofDrive& before = target->coordinate->drive;
    if (!drivenCoordinates_.insert(key).second || before.stiffness > 0) sharedCoordinates_.insert(key);
    if (gear != 0 && !tag.name().empty()) actuatorByName_[tag.name()] = {target->dof, target->tendon, gear};
  }
  const double control = controlOf(tag, index);
  std::optional<Law> law = lawOf(tag, control, activated < activations_.size() ? activations_[activated] : 0,
                                 *target);
  if (!law) return tag.useAll(), report_.note(Effect::Lost, tag.place(), what, "an actuator of this kind");
  if (!target->hasLength) law->byLength = 0;
  double most = target->most, force = law->constant;
  if (const auto range = limitOf(tag, "forcerange", "forcelimited")) {
    most = std::min(most, std::fabs(gear) * std::max(std::fabs((*range)[0]), std::fabs((*range)[1])));
    force = std::clamp(force, (*range)[0], (*range)[1]);
    if ((*range)[0] != -(*range)[1] && (law->byLength != 0 || law->bySpeed != 0))
      report_.note(Effect::Approximate, tag.place(), tag.type() + ".forcerange",
                   "the larger bound holds both ways");
  }
  if (law->byLength > 0 || law->bySpeed > 0)
    return report_.note(Effect::Lost, tag.place(), what, "a force that grows with position or speed");
  Coordinate& own = *target->coordinate;
  if (law->byLength == 0 && law->bySpeed == 0) {
    own.motorForce += std::clamp(gear * force, -most, most);
    return report_.converted(tag.place(), what, "motor of " + target->what);
  }
  DofDrive& drive = own.drive;
  if (most < kHard && drive.maxForce == kHard && drive.stiffness > 0)
    report_.note(Effect::Approximate, tag.place(), what,
                 "the largest force of the drive also bounds the spring of the joint");
  drive.stiffness -= law->byLength * square, drive.damping -= law->bySpeed * square;
  (law->byLength < 0 ? drive.stiffnessTarget : drive.dampingSpeed) += gear * law->constant;
  drive.maxForce = drive.maxForce < kHard ? drive.maxForce + most : most;
  report_.converted(tag.place(), what, "drive of " + target->what);
}

}  // namespace rubble::convert

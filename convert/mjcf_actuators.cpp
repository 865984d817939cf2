/// <actuator>: a force gear * f with f = constant + byLength * length + bySpeed * speed, length = gear * q,
/// is a drive of stiffness -byLength gear^2 and damping -bySpeed gear^2, or a plain force of a motor.
/// Controls and activations move targets of drives, and forces. Other laws are those of ActuatorDef alone.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

/// Is its input an activation, which follows the control by a differential equation?
bool hasActivation(const Tag& tag) {
  const std::string type = tag.type();
  return type == "intvelocity" || type == "cylinder" || type == "muscle" ||
         (type == "position" && tag.number("timeconst", 0) != 0) ||
         (type == "general" && tag.text("dyntype").value_or("none") != "none");
}

/// Does its force depend on its input alone?
bool isPlain(const Tag& tag) {
  return tag.type() == "motor" ||
         (tag.type() == "general" && tag.text("gaintype").value_or("fixed") == "fixed" &&
          tag.text("biastype").value_or("none") == "none");
}

void filter(ActuatorDef& out, bool exact, double timeConstant) {
  constexpr double kShortest = 1e-9;  // [s]
  out.dynamics = exact || timeConstant < kShortest ? ActuatorDynamics::FilterExact : ActuatorDynamics::Filter;
  out.timeConstant = std::max(timeConstant, kShortest);
}

Vec3 threeOf(const Tag& tag, const char* key, double first) {
  auto list = tag.numbers(key, 1, 10).value_or(std::vector<double>{first});
  list.resize(std::max<std::size_t>(list.size(), 3));
  return {list[0], list[1], list[2]};
}

}  // namespace

double MjcfReader::dampingOf(const Tag& tag, const MjcfTarget& target, double stiffness, double ratio) {
  const double mass = massSeen(target.moments);
  if (!(mass > 0))
    report_.note(Effect::Lost, tag.place(), tag.type() + ".dampratio", "of this actuator; give kv");
  return 2 * ratio * std::sqrt(std::max(stiffness * mass, 0.));
}

bool MjcfReader::readLaw(const Tag& tag, const MjcfTarget& target, ActuatorDef& out) {
  const std::string type = tag.type();
  if (type == "motor") return true;
  if (type == "position" || type == "intvelocity") {
    const double kp = tag.number("kp", 1), ratio = tag.number("dampratio", 0);
    const double kv = ratio > 0 ? dampingOf(tag, target, kp, ratio) : tag.number("kv", 0);
    out.gain = {kp, 0, 0}, out.bias = {0, -kp, -kv};
    if (type == "intvelocity")
      out.dynamics = ActuatorDynamics::Integrator;
    else if (const double time = tag.number("timeconst", 0); time != 0)
      filter(out, true, time);
    return true;
  }
  if (type == "velocity" || type == "damper") {
    const double kv = tag.number("kv", 1);
    if (type == "velocity")
      out.gain = {kv, 0, 0}, out.bias = {0, 0, -kv};
    else
      out.gain = {0, 0, -kv};
    return true;
  }
  if (type == "cylinder") {
    const double diameter = tag.number("diameter", 0), area = tag.number("area", 1);
    out.gain = {diameter > 0 ? std::acos(-1.) / 4 * diameter * diameter : area, 0, 0};
    out.bias = threeOf(tag, "bias", 0);
    filter(out, false, tag.number("timeconst", 1));
    return true;
  }
  if (type == "muscle") return readMuscle(tag, target, out);
  return type == "general" && readGeneral(tag, target, out);
}

bool MjcfReader::readGeneral(const Tag& tag, const MjcfTarget& target, ActuatorDef& out) {
  const std::string dynamics = tag.text("dyntype").value_or("none"),
                    gain = tag.text("gaintype").value_or("fixed"),
                    bias = tag.text("biastype").value_or("none");
  const auto times = tag.numbers("dynprm", 1, 10).value_or(std::vector<double>{1});
  if (dynamics == "integrator") {
    out.dynamics = ActuatorDynamics::Integrator;
  } else if (dynamics == "filter" || dynamics == "filterexact") {
    filter(out, dynamics == "filterexact", times[0]);
  } else if (dynamics == "muscle") {
    out.dynamics = ActuatorDynamics::Muscle;
    Muscle& muscle = out.muscle;
    double* const members[] = {&muscle.rise, &muscle.fall, &muscle.smoothing};
    for (std::size_t i = 0; i < std::min(times.size(), std::size(members)) && tag.has("dynprm"); ++i)
      *members[i] = times[i];
  } else if (dynamics != "none") {
    return false;
  }
  if (gain == "muscle") return (bias == "muscle" || bias == "none") && readMuscle(tag, target, out);
  if ((gain != "fixed" && gain != "affine") || (bias != "none" && bias != "affine")) return false;
  out.gain = threeOf(tag, "gainprm", 1);
  if (gain == "fixed") out.gain.y = out.gain.z = 0;
  if (bias == "affine") out.bias = threeOf(tag, "biasprm", 0);
  // of a drive to its control, as position has it, a positive number is the damping ratio
  if (out.bias.z > 0 && out.gain.x == -out.bias.y)
    out.bias.z = -dampingOf(tag, target, out.gain.x, out.bias.z);
  return true;
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
    out.coordinate = &own, out.what = "tendon" + inQuotes(name), out.moments = momentsOf(own);
    for (auto& moment : out.moments) moment.second *= out.gear;
    out.tendon = static_cast<int>(found->second);
    return out;
  }
  if (tag.has("site")) return targetOfSite(tag, isPlain(tag));
  const char* joint = tag.has("joint") ? "joint" : "jointinparent";
  if (!tag.has(joint)) {
    report_.note(Effect::Lost, tag.place(), tag.describe(), "only joints, tendons and sites have actuators");
    return std::nullopt;
  }
  const std::string name = tag.need(joint);
  if (const auto free = freeByName_.find(name); free != freeByName_.end())
    return targetOfTurns(tag, free->second, joint[5] != '\0', isPlain(tag));
  const auto found = dofByName_.find(name);
  if (found == dofByName_.end()) tag.fail(joint, "the name of a joint of a body", "\"" + name + "\"");
  Dof& own = dof(found->second);
  if (own.type == DofType::Ball)
    return targetOfTurns(tag, found->second.first, joint[5] != '\0', isPlain(tag));
  out.coordinate = &own, out.moments = {{found->second, out.gear}}, out.what = "joint" + inQuotes(own.name);
  out.dof = found->second;
  if (const auto limit = actuatorForce_.find(found->second); limit != actuatorForce_.end())
    out.most = limit->second;
  return out;
}

ModelActuator MjcfReader::actuatorAtStart(const Tag& tag) {
  const std::size_t index = actuators_++, state = activated_;
  activated_ += hasActivation(tag);
  ModelActuator out;
  out.place = tag.place(), out.what = tag.describe();
  ActuatorDef& own = out.actuator;
  own.name = tag.name();
  const auto bound = [&](const char* range, const char* limited, double& min, double& max) {
    if (const auto found = limitOf(tag, range, limited)) min = (*found)[0], max = (*found)[1];
  };
  if (compiler_.clampsControls) bound("ctrlrange", "ctrllimited", own.minControl, own.maxControl);
  bound("actrange", "actlimited", own.minActivation, own.maxActivation);
  bound("forcerange", "forcelimited", own.minForce, own.maxForce);
  own.early = tag.flag("actearly", false);
  own.control = index < controls_.size() ? controls_[index] : 0;
  own.control = std::clamp(own.control, own.minControl, own.maxControl);
  if (hasActivation(tag) && state < activations_.size()) own.activation = activations_[state];
  return out;
}

void MjcfReader::readAdhesion(const Tag& tag, ModelActuator own) {
  own.link = linkOf(tag, "body");
  own.actuator.type = ActuatorType::Adhesion;
  own.actuator.gain = {tag.number("gain", 1), 0, 0};
  report_.converted(own.place, own.what, "adhesion of body" + inQuotes(link(std::max(own.link, 0)).name));
  model_.actuators.push_back(std::move(own));
}

void MjcfReader::readActuator(const Tag& tag) {
  ModelActuator own = actuatorAtStart(tag);
  const std::string& what = own.what;
  const bool isOff = std::count(compiler_.actuatorsOff.begin(), compiler_.actuatorsOff.end(),
                                tag.number("group", 0)) > 0;
  if (!compiler_.actuation || isOff) {
    tag.useAll();
    return report_.note(Effect::None, tag.place(), what, "actuation is disabled");
  }
  if (tag.type() == "adhesion") return readAdhesion(tag, std::move(own));
  const auto target = targetOf(tag);
  if (!target) return tag.useAll();
  ActuatorDef& actuator = own.actuator;
  if (!readLaw(tag, *target, actuator))
    return tag.useAll(), report_.note(Effect::Lost, tag.place(), what, "an actuator of this kind");
  if (const double share = tag.number("inheritrange", 0); share > 0 && target->coordinate) {
    const auto& range = target->coordinate->range;
    const bool isSpeed = tag.type() == "intvelocity";
    if (range && !tag.has(isSpeed ? "actrange" : "ctrlrange")) {
      const double middle = ((*range)[0] + (*range)[1]) / 2, half = share * ((*range)[1] - (*range)[0]) / 2;
      (isSpeed ? actuator.minActivation : actuator.minControl) = middle - half;
      (isSpeed ? actuator.maxActivation : actuator.maxControl) = middle + half;
      actuator.control = std::clamp(actuator.control, actuator.minControl, actuator.maxControl);
    }
  }
  own.dof = target->dof, own.tendon = target->tendon, own.link = target->link;
  if (own.link >= 0) {
    actuator.type = ActuatorType::Wrench;
    actuator.position = target->position, actuator.force = target->force, actuator.torque = target->torque;
    report_.converted(tag.place(), what, "force and torque of " + target->what);
    return model_.actuators.push_back(std::move(own));
  }
  actuator.gear = target->gear;
  if (target->isOfModel) {
    const std::pair key{target->dof, target->tendon};
    const DofDrive& before = target->coordinate->drive;
    if (!drivenCoordinates_.insert(key).second || before.stiffness > 0) sharedCoordinates_.insert(key);
    if (target->gear != 0 && !tag.name().empty())
      actuatorByName_[tag.name()] = {target->dof, target->tendon, target->gear};
  }
  if (!target->hasLength) actuator.gain.y = actuator.bias.y = 0;
  addToCoordinate(tag, *target, own);
  model_.actuators.push_back(std::move(own));
}

void MjcfReader::addToCoordinate(const Tag& tag, const MjcfTarget& target, ModelActuator& own) {
  ActuatorDef& actuator = own.actuator;
  Coordinate& coordinate = *target.coordinate;
  const double gear = target.gear, square = gear * gear;
  const double input = actuator.dynamics == ActuatorDynamics::None ? actuator.control : actuator.activation;
  const Vec3 gain = actuator.gain, bias = actuator.bias;
  const double least = actuator.minForce, largest = actuator.maxForce;
  double most = target.most;
  if (gear != 0 && most < kHard) {
    actuator.minForce = std::max(least, -most / std::fabs(gear));
    actuator.maxForce = std::max(std::min(largest, most / std::fabs(gear)), actuator.minForce);
  }
  const bool isMuscle = actuator.type == ActuatorType::Muscle;
  // of gear 0 a drive would have no stiffness, over which its gain is taken
  if (isMuscle || square == 0 || gain.y != 0 || gain.z != 0 || bias.y > 0 || bias.z > 0)
    return report_.converted(own.place, own.what, (isMuscle ? "muscle of " : "force of ") + target.what);
  if (bias.y == 0 && bias.z == 0) {
    const double force = std::clamp(gain.x * input + bias.x, actuator.minForce, actuator.maxForce);
    coordinate.motorForce += actuator.included = gear * force;
    return report_.converted(own.place, own.what, "motor of " + target.what);
  }
  if (least > -kHard || largest < kHard) {
    most = std::min(most, std::fabs(gear) * std::max(std::fabs(least), std::fabs(largest)));
    if (least != -largest)
      report_.note(Effect::Approximate, own.place, tag.type() + ".forcerange",
                   "the larger bound holds both ways");
  }
  DofDrive& drive = coordinate.drive;
  if (most < kHard && drive.maxForce == kHard && drive.stiffness > 0)
    report_.note(Effect::Approximate, own.place, own.what,
                 "the largest force of the drive also bounds the spring of the joint");
  drive.stiffness -= bias.y * square, drive.damping -= bias.z * square;
  (bias.y < 0 ? drive.stiffnessTarget : drive.dampingSpeed) += gear * (gain.x * input + bias.x);
  drive.maxForce = drive.maxForce < kHard ? drive.maxForce + most : most;
  actuator.type = bias.y < 0 ? ActuatorType::Position : ActuatorType::Speed;
  actuator.included = gear * gain.x * input;
  actuator.gain = {gain.x, 0, 0}, actuator.bias = {};
  actuator.minForce = -kHard, actuator.maxForce = kHard;
  report_.converted(own.place, own.what, "drive of " + target.what);
}

}  // namespace rubble::convert

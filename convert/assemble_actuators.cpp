/// Actuators of degrees of freedom, tendons and links as those of joints and bodies.
#include "convert/assemble.h"

namespace rubble::convert {
namespace {

const Coordinate& coordinateOf(const Model& model, const ModelActuator& from) {
  if (from.tendon >= 0) return model.tendons[static_cast<std::size_t>(from.tendon)];
  return model.links[static_cast<std::size_t>(from.dof.first)]
      .dofs[static_cast<std::size_t>(from.dof.second)];
}

/// Why it cannot act; empty if it can.
std::string finish(const Model& model, const Layout& layout, const ModelActuator& from, ActuatorDef& out) {
  if (from.link >= 0) {
    out.body = bodyIndex(layout, from.link);
    if (const std::vector<int>& fixed = layout.staticOf[static_cast<std::size_t>(from.link)];
        out.body == kWorld && out.type == ActuatorType::Adhesion && fixed.size() == 1)
      out.body = fixed.front();
    if (out.body == kWorld) return "its body does not move";
    const Pose pose = poseInBody(layout, from.link);
    out.position = pose * out.position;
    out.force = rotate(pose.q, out.force), out.torque = rotate(pose.q, out.torque);
    return "";
  }
  const AxisReading reading = axisOf(layout, from.dof, from.tendon);
  if (reading.joint < 0) return "no axis of a joint has its coordinate";
  out.joint = reading.joint, out.axis = reading.axis;
  double scale = reading.sign;
  if (out.type == ActuatorType::Position || out.type == ActuatorType::Speed) {
    const DofDrive& drive = coordinateOf(model, from).drive;
    scale *= 1 / (out.type == ActuatorType::Position ? drive.stiffness : drive.damping);
    out.gain.x *= scale * out.gear;
    out.gear = 1, out.offset = 0;
  } else {
    out.offset += out.gear * reading.offset, out.gear *= reading.sign;
  }
  out.included *= scale;
  return "";
}

}  // namespace

std::vector<ActuatorDef> actuatorsOf(const Model& model, const Layout& layout, Report& report) {
  std::vector<ActuatorDef> out;
  for (const ModelActuator& from : model.actuators) {
    ActuatorDef actuator = from.actuator;
    if (const std::string why = finish(model, layout, from, actuator); why.empty())
      out.push_back(std::move(actuator));
    else
      report.note(Effect::Lost, from.place, from.what, why);
  }
  return out;
}

}  // namespace rubble::convert

/// Sensors of links, degrees of freedom and tendons as those of bodies and joints.
#include "convert/assemble.h"

namespace rubble::convert {
namespace {

/// A frame in a link as one in its body.
void place(const Layout& layout, int link, int& body, Vec3& position, Quat& orientation) {
  const Pose pose = poseInBody(layout, link) * Pose{position, orientation};
  body = bodyIndex(layout, link), position = pose.p, orientation = pose.q;
}

/// Why it cannot be measured; empty if it can.
std::string finish(const ModelSensor& from, const Layout& layout, SensorDef& sensor) {
  place(layout, from.link, sensor.body, sensor.position, sensor.orientation);
  place(layout, from.reference, sensor.reference, sensor.referencePosition, sensor.referenceOrientation);
  if (sensor.type == SensorType::Force || sensor.type == SensorType::Torque) {
    const int joint = from.link < 0 ? -1 : layout.jointOf[static_cast<std::size_t>(from.link)];
    if (joint < 0) return "its body has no joint to its parent: the two are one body";
    sensor.joint = joint;
    return "";
  }
  if (from.dof.first < 0 && from.tendon < 0) return "";
  const AxisReading reading = axisOf(layout, from.dof, from.tendon);
  if (reading.joint < 0) return "no axis of a joint has its coordinate";
  sensor.joint = reading.joint, sensor.axis = reading.axis;
  if (sensor.type == SensorType::JointPosition) sensor.offset += sensor.scale * reading.offset;
  sensor.scale *= reading.sign;
  return "";
}

}  // namespace

std::vector<SensorDef> sensorsOf(const Model& model, const Layout& layout, Report& report) {
  std::vector<SensorDef> out;
  for (const ModelSensor& from : model.sensors) {
    SensorDef sensor = from.sensor;
    if (const std::string why = finish(from, layout, sensor); !why.empty()) {
      report.note(Effect::None, from.place, from.what, why);
      continue;
    }
    report.converted(from.place, from.what,
                     std::string("sensor of ") + keyword(sensor.type) + inQuotes(sensor.name));
    out.push_back(std::move(sensor));
  }
  return out;
}

}  // namespace rubble::convert

/// <sensor>: readings of frames, joints, tendons and actuators.
#include <algorithm>
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {
namespace {

using Type = SensorType;

const std::map<std::string, Type, std::less<>> kAtSites{{"accelerometer", Type::Acceleration},
                                                        {"gyro", Type::AngularRate},
                                                        {"velocimeter", Type::Velocity},
                                                        {"force", Type::Force},
                                                        {"torque", Type::Torque},
                                                        {"touch", Type::Touch},
                                                        {"rangefinder", Type::Range}};
const std::map<std::string, Type, std::less<>> kOfFrames{{"framepos", Type::Position},
                                                         {"framequat", Type::Orientation},
                                                         {"framexaxis", Type::XAxis},
                                                         {"frameyaxis", Type::YAxis},
                                                         {"framezaxis", Type::ZAxis},
                                                         {"framelinvel", Type::LinearVelocity},
                                                         {"frameangvel", Type::AngularVelocity},
                                                         {"framelinacc", Type::LinearAcceleration}};
const std::map<std::string, Type, std::less<>> kOfCoordinates{
    {"jointpos", Type::JointPosition},    {"jointvel", Type::JointSpeed},
    {"tendonpos", Type::JointPosition},   {"tendonvel", Type::JointSpeed},
    {"actuatorpos", Type::JointPosition}, {"actuatorvel", Type::JointSpeed},
    {"actuatorfrc", Type::DriveForce}};

constexpr const char* kNotMeasured = "what this sensor measures is not among the readings of a scene";

}  // namespace

std::optional<Shape> MjcfReader::siteVolume(const Tag& site) {
  const std::vector<double> size = site.numbers("size", 1, 3).value_or(std::vector<double>{.005});
  const std::string type = site.text("type").value_or("sphere");
  const auto at = [&](std::size_t k) { return k < size.size() ? size[k] : 0; };
  if (std::count_if(size.begin(), size.end(), [](double each) { return !(each > 0); }) > 0)
    return std::nullopt;
  if (type == "sphere") return Shape::sphere(at(0));
  if (type == "box" && size.size() == 3) return Shape::box({at(0), at(1), at(2)});
  if (type == "capsule" && size.size() >= 2) return Shape::capsule(at(0), at(1));
  if (type == "cylinder" && size.size() >= 2) return Shape::cylinder(at(0), at(1));
  return std::nullopt;
}

std::optional<MjcfSite> MjcfReader::frameOf(const Tag& tag, const char* typeKey, const char* nameKey) const {
  const std::string type = tag.need(typeKey), name = tag.need(nameKey);
  const auto missing = [&] { tag.fail(nameKey, "the name of a " + type, "\"" + name + "\""); };
  if (type == "site") return siteOf(tag, nameKey);
  if (type == "body" || type == "xbody") {
    const int index = linkOf(tag, nameKey);
    const Link& own = model_.links[static_cast<std::size_t>(index)];
    Pose pose;
    if (type == "body" && own.mass.volume > 0) pose.p = principal(own.mass).center;
    return MjcfSite{index, pose, {}};
  }
  if (type == "geom") {
    const auto found = geoms_.find(name);
    if (found == geoms_.end()) missing();
    const Geom& geom = model_.links[static_cast<std::size_t>(found->second.first)]
                           .geoms[static_cast<std::size_t>(found->second.second)];
    // the frame of a mesh is that of its inertia in MuJoCo
    if (geom.shape.type == ShapeType::Hull) return std::nullopt;
    return MjcfSite{found->second.first, geom.pose, {}};
  }
  if (type == "camera") {
    const auto found = std::ranges::find(cameras_, name, &MjcfCamera::name);
    if (found == cameras_.end()) missing();
    return MjcfSite{found->link, found->pose, {}};
  }
  return std::nullopt;
}

void MjcfReader::readSensor(const Tag& tag) {
  source_.use(tag.node());
  ModelSensor out;
  out.place = tag.place(), out.what = tag.describe();
  SensorDef& sensor = out.sensor;
  sensor.name = tag.name(), sensor.cutoff = tag.number("cutoff", 0);
  const auto unused = [&](const std::string& why) {
    tag.useAll();
    report_.note(Effect::None, out.place, out.what, why);
  };
  const auto mount = [&](const MjcfSite& frame, int& link, Vec3& position, Quat& orientation) {
    link = frame.link, position = frame.pose.p, orientation = frame.pose.q;
  };
  const std::string type = tag.type();
  if (const auto found = kAtSites.find(type); found != kAtSites.end()) {
    if (!tag.has("site")) return unused(kNotMeasured);
    const MjcfSite& site = siteOf(tag, "site");
    sensor.type = found->second;
    mount(site, out.link, sensor.position, sensor.orientation);
    if (sensor.type == Type::Touch && !site.volume)
      return unused("the volume of its site is none that is known");
    if (site.volume) sensor.volume = *site.volume;
  } else if (const auto frame = kOfFrames.find(type); frame != kOfFrames.end()) {
    sensor.type = frame->second;
    const std::optional<MjcfSite> own = frameOf(tag, "objtype", "objname");
    if (!own) return unused("the frame of an object of this kind");
    mount(*own, out.link, sensor.position, sensor.orientation);
    if (tag.has("reftype")) {
      const std::optional<MjcfSite> reference = frameOf(tag, "reftype", "refname");
      if (!reference) return unused("the frame of an object of this kind");
      mount(*reference, out.reference, sensor.referencePosition, sensor.referenceOrientation);
    }
    const bool isOriented = sensor.type == Type::Orientation ||
                            (sensor.type >= Type::XAxis && sensor.type <= Type::ZAxis);
    if (isOriented && tag.text("objtype") == "body")
      report_.note(Effect::None, out.place, type + ".objtype",
                   "the axes of a body are those of its frame, as of an xbody");
  } else if (const auto axis = kOfCoordinates.find(type); axis != kOfCoordinates.end()) {
    sensor.type = axis->second;
    if (!readCoordinate(tag, out)) return unused("its actuator is none of a joint or tendon");
  } else if (type == "clock") {
    sensor.type = Type::Time;
  } else {
    return unused(kNotMeasured);
  }
  model_.sensors.push_back(std::move(out));
}

bool MjcfReader::readCoordinate(const Tag& tag, ModelSensor& out) {
  const std::string type = tag.type();
  if (type.starts_with("joint")) {
    const std::string name = tag.need("joint");
    const auto found = dofByName_.find(name);
    if (found == dofByName_.end()) tag.fail("joint", "the name of a hinge or slide", "\"" + name + "\"");
    out.dof = found->second;
    return true;
  }
  if (type.starts_with("tendon")) {
    const std::string name = tag.need("tendon");
    const auto found = tendonByName_.find(name);
    if (found == tendonByName_.end()) tag.fail("tendon", "the name of a tendon", "\"" + name + "\"");
    out.tendon = static_cast<int>(found->second);
    return true;
  }
  const std::string name = tag.need("actuator");
  const auto found = actuatorByName_.find(name);
  if (found == actuatorByName_.end()) return false;
  const MjcfActuator& actuator = found->second;
  out.dof = actuator.dof, out.tendon = actuator.tendon;
  out.sensor.scale = out.sensor.type == Type::DriveForce ? 1 / actuator.gear : actuator.gear;
  return true;
}

void MjcfReader::finishSensors() {
  std::erase_if(model_.sensors, [&](const ModelSensor& each) {
    if (each.sensor.type != Type::DriveForce || !sharedCoordinates_.contains({each.dof, each.tendon}))
      return false;
    report_.note(Effect::None, each.place, each.what,
                 "other actuators or springs act on the same coordinate, and their forces are one");
    return true;
  });
}

}  // namespace rubble::convert

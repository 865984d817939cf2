#include "convert/urdf_unused.h"

#include "convert/unused.h"

namespace rubble::convert {
namespace {

const Reasons& elements() {
  static const Reasons all{
      {"visual", {Effect::None, "how it looks"}},
      {"material", {Effect::None, "how it looks"}},
      {"texture", {Effect::None, "how it looks"}},
      {"transmission", {Effect::None, "between actuators and joints; the scene has no actuators"}},
      {"gazebo", {Effect::Lost, "extensions of Gazebo"}},
      {"mujoco", {Effect::Lost, "extensions of MuJoCo"}},
      {"drake:proximity_properties", {Effect::Lost, "extensions of Drake"}},
      {"ros2_control", {Effect::None, "interfaces of controllers"}},
      {"sensor", {Effect::None, "readings; the state of bodies and joints is in the interface of World"}},
      {"calibration", {Effect::None, "calibration of a real joint"}},
      {"safety_controller", {Effect::None, "limits of a controller"}},
      {"contact", {Effect::Lost, "properties of contacts"}},
      {"verbose", {Effect::None, "a comment"}},
      // SRDF
      {"group", {Effect::None, "groups of links for planning"}},
      {"group_state", {Effect::None, "poses for planning"}},
      {"end_effector", {Effect::None, "groups of links for planning"}},
      {"virtual_joint", {Effect::None, "how planning places the robot; see --floating-base"}},
      {"passive_joint", {Effect::None, "which joints have actuators"}},
      {"joint_property", {Effect::None, "properties for planning"}},
      {"link_sphere_approximation", {Effect::None, "spheres for planning"}},
  };
  return all;
}
const Reasons& attributes() {
  static const Reasons all{
      {"robot.version", {Effect::None, "of the format"}},
      {"link.type", {Effect::None, "an old attribute without effect"}},
      {"limit.effort", {Effect::None, "largest force of an actuator; the scene has none"}},
      {"limit.velocity", {Effect::Approximate, "speeds of joints are not limited"}},
      {"limit.acceleration", {Effect::Approximate, "accelerations of joints are not limited"}},
      {"limit.jerk", {Effect::None, "for planning"}},
      {"disable_collisions.reason", {Effect::None, "a comment"}},
  };
  return all;
}
const Reasons& anywhere() {
  static const Reasons all{
      {"name", {Effect::None, "nothing refers to it"}},
      {"xmlns:xacro", {Effect::None, "a name space that nothing uses"}},
  };
  return all;
}

}  // namespace

void noteUnusedUrdf(const Source& source, Report& report) {
  noteUnused(source, {elements(), attributes(), anywhere()}, report);
}

}  // namespace rubble::convert

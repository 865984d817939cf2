#pragma once
/// From a model to a scene. Links without a degree of freedom become part of their parent, links that are
/// fixed to the world static bodies, degrees of freedom joints.
#include <map>

#include "convert/model.h"
#include "io/scene_json.h"

namespace rubble::convert {

/// The scene, its looks and its sensors. Throws Error at the link of a moving body without mass.
void assemble(const Model& model, io::SceneFile& out, Report& report);

/// Where a coordinate of a model is read: q = offset + sign times the position of an axis.
struct AxisReading {
  int joint = -1;  ///< -1: nowhere
  int axis = 0;
  double sign = 1, offset = 0;
};

/// Where the links of a model are, and what they become.
struct Layout {
  std::vector<int> root;      ///< of each link: the link that its body is made of; -1: fixed to the world
  std::vector<Pose> inRoot;   ///< pose of each link in the frame of its root (of the world: of the file)
  std::vector<Pose> inWorld;  ///< at the beginning
  std::vector<Vec3> velocity, angularVelocity;        ///< at the beginning, of their origins [m/s], [rad/s]
  std::vector<int> bodyOf;                            ///< of each root: index of the body; -1 for others
  std::vector<std::vector<int>> members;              ///< of each root: its links
  std::vector<std::vector<int>> staticOf;             ///< of each link that is fixed to the world: its bodies
  std::vector<std::vector<Contact>> contactsOf;       ///< of each body: those of its geoms
  std::vector<int> jointOf;                           ///< of each link: its joint; -1: none
  std::map<std::pair<int, int>, AxisReading> axisOf;  ///< of degrees of freedom
  std::vector<AxisReading> axisOfTendon;
};

int rootOf(const Layout& layout, int link);
/// Of a degree of freedom, or else of a tendon.
AxisReading axisOf(const Layout& layout, const std::pair<int, int>& dof, int tendon);
/// Index of its body, or kWorld.
int bodyIndex(const Layout& layout, int link);
/// Pose of a link in the frame of its body; of the world for static ones.
Pose poseInBody(const Layout& layout, int link);

/// Bodies of all links (assemble_bodies.cpp).
void addBodies(const Model& model, Layout& layout, Scene& scene, Report& report);
/// What is drawn of them, where that is not their shape alone (assemble_looks.cpp).
std::vector<Look> looksOf(const Model& model, const Layout& layout);
/// Collision filters and exclusions (assemble_filters.cpp).
void addFilters(const Model& model, const Layout& layout, Scene& scene, Report& report);
/// Limits, drive, friction and motor of a coordinate that is `zero` where the joint has 0. `sign`: of its
/// direction (assemble_dofs.cpp).
JointAxis axisOf(const Coordinate& coordinate, double sign, double zero);
/// Of a sum or coupling of joints, one of which is no axis of the joint of its body.
inline constexpr const char* kSeveralJoints =
    "of several joints of a body it takes the turn about the axis, or the travel along it, at the beginning";
/// Joints of all degrees of freedom, loops, couplings and tendons (assemble_joints.cpp).
void addJoints(const Model& model, Layout& layout, Scene& scene, Report& report);
/// Sensors (assemble_sensors.cpp).
std::vector<SensorDef> sensorsOf(const Model& model, const Layout& layout, Report& report);
/// Actuators (assemble_actuators.cpp).
std::vector<ActuatorDef> actuatorsOf(const Model& model, const Layout& layout, Report& report);
/// A joint of the tree. Its bodies are left to the caller.
struct TreeJoint {
  JointDef joint;
  bool childIsA = true;  ///< is the link body A?
  struct Axis {
    int axis = -1;    ///< -1: none
    double sign = 1;  ///< the axis is at `sign` times the coordinate of the degree of freedom plus `shift`
    double shift = 0;
  };
  std::vector<Axis> axes;  ///< of each degree of freedom, whose coordinate is measured from its reference
};
/// The joint of a tendon, whose coordinate is `zero` where the joint has 0, or of a coupling that no gear or
/// rack can be: nothing if its bodies are more than four, or for another reason, which is reported
/// (assemble_tendons.cpp).
std::optional<JointDef> tendonOf(const Model& model, const Layout& layout, const Scene& scene,
                                 const Tendon& tendon, double& zero, Report& report);
std::optional<JointDef> cam(const Model& model, const Layout& layout, const Scene& scene,
                            const Coupling& coupling, Report& report);
/// Has the joint of the link the coordinate as an axis that a tendon can read?
bool isReadable(const Model& model, const Layout& layout, const Scene& scene, const std::pair<int, int>& dof);
/// One joint of all degrees of freedom of a link (assemble_dofs.cpp).
TreeJoint jointOf(const Link& link, const Pose& inParentBody, Report& report);

}  // namespace rubble::convert

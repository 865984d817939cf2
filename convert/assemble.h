#pragma once
/// From a model to a scene. Links without a degree of freedom become part of their parent, links that are
/// fixed to the world static bodies, degrees of freedom joints.
#include "convert/model.h"

namespace rubble::convert {

/// Throws Error at the link of a moving body without mass.
Scene assemble(const Model& model, Report& report);

/// Where the links of a model are, and what they become.
struct Layout {
  std::vector<int> root;      ///< of each link: the link that its body is made of; -1: fixed to the world
  std::vector<Pose> inRoot;   ///< pose of each link in the frame of its root (of the world: of the file)
  std::vector<Pose> inWorld;  ///< at the beginning
  std::vector<Vec3> velocity, angularVelocity;   ///< at the beginning, of their origins [m/s], [rad/s]
  std::vector<int> bodyOf;                       ///< of each root: index of the body; -1 for others
  std::vector<std::vector<int>> members;         ///< of each root: its links
  std::vector<std::vector<int>> staticOf;        ///< of each link that is fixed to the world: its bodies
  std::vector<std::vector<Contact>> contactsOf;  ///< of each body: those of its geoms
};

int rootOf(const Layout& layout, int link);
/// Index of its body, or kWorld.
int bodyIndex(const Layout& layout, int link);
/// Pose of a link in the frame of its body; of the world for static ones.
Pose poseInBody(const Layout& layout, int link);

/// Bodies of all links (assemble_bodies.cpp).
void addBodies(const Model& model, Layout& layout, Scene& scene, Report& report);
/// Collision filters and exclusions (assemble_filters.cpp).
void addFilters(const Model& model, const Layout& layout, Scene& scene, Report& report);
/// Limits, drive, friction and motor of a coordinate that is `zero` where the joint has 0. `sign`: of its
/// direction (assemble_dofs.cpp).
JointAxis axisOf(const Coordinate& coordinate, double sign, double zero);
/// Of a sum or coupling of joints, one of which is not alone in its body.
inline constexpr const char* kSeveralJoints =
    "of several joints of a body it takes the turn about the axis, or the travel along it, at the beginning";
/// Joints of all degrees of freedom, loops, couplings and tendons (assemble_joints.cpp).
void addJoints(const Model& model, const Layout& layout, Scene& scene, Report& report);
/// A joint of the tree. Its bodies are left to the caller.
struct TreeJoint {
  JointDef joint;
  bool childIsA = true;  ///< is the link body A?
};
/// The joint of a tendon, or of a coupling that no gear or rack can be: nothing if its bodies are more than
/// four, or for another reason, which is reported (assemble_tendons.cpp).
std::optional<JointDef> tendonOf(const Model& model, const Layout& layout, const Tendon& tendon,
                                 Report& report);
std::optional<JointDef> cam(const Model& model, const Layout& layout, const Coupling& coupling,
                            Report& report);
/// One joint of all degrees of freedom of a link (assemble_dofs.cpp).
TreeJoint jointOf(const Link& link, const Pose& inParentBody, Report& report);

}  // namespace rubble::convert

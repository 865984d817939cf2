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
  std::vector<int> bodyOf;    ///< of each root: index of the body; -1 for others
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
/// Joints of all degrees of freedom, loops and couplings (assemble_joints.cpp).
void addJoints(const Model& model, const Layout& layout, Scene& scene, Report& report);
/// A joint of the tree. Its bodies are left to the caller.
struct TreeJoint {
  JointDef joint;
  bool childIsA = true;  ///< is the link body A?
};
/// One joint of all degrees of freedom of a link (assemble_dofs.cpp).
TreeJoint jointOf(const Link& link, const Pose& inParentBody, Report& report);

}  // namespace rubble::convert

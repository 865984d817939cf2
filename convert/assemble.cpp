#include "convert/assemble.h"

namespace rubble::convert {
namespace {

/// Motion of a link by its degrees of freedom at the beginning.
Pose startMotion(const Link& link) {
  Pose out;
  for (const Dof& dof : link.dofs) {
    if (dof.type == DofType::Slide) {
      out = out * Pose{dof.start * dof.axis, {}};
      continue;
    }
    const Quat turn = dof.type == DofType::Ball ? dof.startTurn : fromAxisAngle(dof.axis, dof.start);
    out = out * Pose{dof.anchor - rotate(turn, dof.anchor), turn};
  }
  return out;
}

Layout layoutOf(const Model& model) {
  const std::size_t count = model.links.size();
  Layout out;
  out.root.resize(count), out.inRoot.resize(count), out.inWorld.resize(count);
  out.bodyOf.assign(count, -1), out.members.resize(count), out.staticOf.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Link& link = model.links[i];
    const auto parent = static_cast<std::size_t>(link.parent);
    const bool atTop = link.parent < 0;
    out.inWorld[i] = link.start ? *link.start
                                : (atTop ? Pose{} : out.inWorld[parent]) * link.pose * startMotion(link);
    out.root[i] = link.moves() ? static_cast<int>(i) : atTop ? -1 : out.root[parent];
    if (out.root[i] >= 0) out.members[static_cast<std::size_t>(out.root[i])].push_back(static_cast<int>(i));
    out.inRoot[i] = link.moves() ? Pose{} : (atTop ? Pose{} : out.inRoot[parent]) * link.pose;
  }
  return out;
}

}  // namespace

int rootOf(const Layout& layout, int link) {
  return link < 0 ? -1 : layout.root[static_cast<std::size_t>(link)];
}

int bodyIndex(const Layout& layout, int link) {
  const int root = rootOf(layout, link);
  return root < 0 ? kWorld : layout.bodyOf[static_cast<std::size_t>(root)];
}

Pose poseInBody(const Layout& layout, int link) {
  return link < 0 ? Pose{} : layout.inRoot[static_cast<std::size_t>(link)];
}

Scene assemble(const Model& model, Report& report) {
  Scene scene;
  scene.name = model.name;
  scene.gravity = model.gravity;
  Layout layout = layoutOf(model);
  addBodies(model, layout, scene, report);
  addJoints(model, layout, scene, report);
  addFilters(model, layout, scene, report);
  return scene;
}

}  // namespace rubble::convert

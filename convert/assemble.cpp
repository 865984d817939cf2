#include "convert/assemble.h"

#include <algorithm>

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

/// Velocity of each link by those of its parent and its degrees of freedom. Each of these moves in the frame
/// that those before it give.
void addVelocities(const Model& model, Layout& layout) {
  layout.velocity.resize(model.links.size()), layout.angularVelocity.resize(model.links.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const bool atTop = link.parent < 0;
    const auto parent = static_cast<std::size_t>(std::max(link.parent, 0));
    Vec3 v, w;
    Pose frame = atTop ? link.pose : layout.inWorld[parent] * link.pose;
    const Vec3 origin = layout.inWorld[i].p;
    if (!atTop) {
      w = layout.angularVelocity[parent];
      v = layout.velocity[parent] + cross(w, origin - layout.inWorld[parent].p);
    }
    if (link.free) v = link.velocity, w = link.angularVelocity;
    for (const Dof& dof : link.dofs) {
      if (dof.type == DofType::Ball) {
        const Vec3 turn = rotate(layout.inWorld[i].q, dof.startSpeed);
        w += turn, v += cross(turn, origin - frame * dof.anchor);
      } else {
        const Vec3 axis = dof.startSpeed.x * rotate(frame.q, dof.axis);
        if (dof.type == DofType::Slide)
          v += axis;
        else
          w += axis, v += cross(axis, origin - frame * dof.anchor);
      }
      Link one;
      one.dofs = {dof};
      frame = frame * startMotion(one);
    }
    layout.velocity[i] = v, layout.angularVelocity[i] = w;
  }
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
  addVelocities(model, out);
  return out;
}

void addObjects(const Model& model, const Layout& layout, Scene& scene, Report& report) {
  for (const SoftObject& each : model.objects) {
    const int index = static_cast<int>(scene.deformables.size());
    scene.deformables.push_back(each.object);
    DeformableDef& object = common(scene.deformables.back());
    for (const auto& [vertex, link] : each.pins) {
      const int body = bodyIndex(layout, link);
      if (body == kWorld) {
        object.fixed.push_back(vertex);
        continue;
      }
      AttachmentDef pin;
      pin.object = index, pin.vertices = {vertex}, pin.body = body;
      scene.attachments.push_back(pin);
    }
    report.converted(each.place, "flexible object" + inQuotes(object.name),
                     "deformable" + inQuotes(object.name));
  }
}

}  // namespace

int rootOf(const Layout& layout, int link) {
  return link < 0 ? -1 : layout.root[static_cast<std::size_t>(link)];
}

AxisReading axisOf(const Layout& layout, const std::pair<int, int>& dof, int tendon) {
  if (tendon >= 0) return layout.axisOfTendon[static_cast<std::size_t>(tendon)];
  const auto found = layout.axisOf.find(dof);
  return found == layout.axisOf.end() ? AxisReading{} : found->second;
}

int bodyIndex(const Layout& layout, int link) {
  const int root = rootOf(layout, link);
  return root < 0 ? kWorld : layout.bodyOf[static_cast<std::size_t>(root)];
}

Pose poseInBody(const Layout& layout, int link) {
  return link < 0 ? Pose{} : layout.inRoot[static_cast<std::size_t>(link)];
}

void assemble(const Model& model, io::SceneFile& out, Report& report) {
  Scene& scene = out.scene;
  scene.name = model.name;
  scene.gravity = model.gravity;
  Layout layout = layoutOf(model);
  addBodies(model, layout, scene, report);
  addJoints(model, layout, scene, report);
  addFilters(model, layout, scene, report);
  addObjects(model, layout, scene, report);
  out.appearance.looks = looksOf(model, layout);
  out.sensors = sensorsOf(model, layout, report);
  out.actuators = actuatorsOf(model, layout, report);
}

}  // namespace rubble::convert

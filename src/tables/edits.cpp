#include "tables/exclusions.h"
#include "tables/soft_edit.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

std::vector<int> slotsOf(const HostTables& tables, const std::vector<int>& ids) {
  std::vector<int> slots;
  slots.reserve(ids.size());
  for (const int id : ids) slots.push_back(slotOf(tables, id));
  return slots;
}

EngineJoint inSlots(const HostTables& tables, EngineJoint joint) {
  for (int* body : {&joint.a, &joint.b, &joint.frameBodyA, &joint.frameBodyB}) *body = slotOf(tables, *body);
  return joint;
}

std::vector<EngineAttachment> inSlots(const HostTables& tables, std::vector<EngineAttachment> attachments) {
  for (EngineAttachment& a : attachments) a.body = slotOf(tables, a.body);
  return attachments;
}

namespace {

/// One overload for each kind of edit.
struct Apply {
  HostTables& tables;

  int slot(int id) const { return slotOf(tables, id); }

  void operator()(const SetBody& e) const {
    setBodyCount(tables, e.id + 1);
    setBody(tables, slot(e.id), e.body);
    if (e.number < 0) return;
    tables.view().idOf[slot(e.id)] = e.number, tables.view().worldOfBody[slot(e.id)] = e.world;
  }
  void operator()(const SetBodyState& e) const { setBodyState(tables, slot(e.id), e.state); }
  void operator()(const AddForce& e) const {
    const SolverData& s = tables.view();
    s.force[slot(e.id)] += Vec3(e.force), s.torque[slot(e.id)] += Vec3(e.torque);
  }
  void operator()(const AddVelocity& e) const { addVelocity(tables, slot(e.id), e.change); }
  void operator()(const ForgetContacts& e) const { forgetContacts(tables, slotsOf(tables, e.ids)); }
  void operator()(const AddShape& e) const { addShape(tables, *e.shape, e.partSurfaces); }
  void operator()(const SetSurfaces& e) const { setSurfaces(tables, e.surfaces); }
  void operator()(const SetPlanes& e) const { setPlanes(tables, slotsOf(tables, e.ids), e.firstOfWorld); }
  void operator()(const SetJoint& e) const {
    const int type = static_cast<int>(e.joint.type);
    if (e.slot >= tables.jointIds[type]) setJointCount(tables, type, e.slot + 1);
    (e.keepsState ? editJoint : setJoint)(tables, e.slot, inSlots(tables, e.joint));
  }
  void operator()(const SetExcluded& e) const {
    std::vector<int> changed;
    setExcluded(tables, e.a, e.b, e.excluded, changed, e.world);
  }
  void operator()(const SetDeformables& e) const {
    setSoft(tables, e.objects, inSlots(tables, e.attachments));
  }
  void operator()(const SetVertices& e) const { setVertexStates(tables, e.first, e.positions, e.velocities); }
  void operator()(const AddVertexForce& e) const { tables.view().vertexForce[e.vertex] += Vec3(e.force); }
};

}  // namespace

void apply(HostTables& tables, const Edit& edit) { std::visit(Apply{tables}, edit); }

}  // namespace rubble::RUBBLE_CORE

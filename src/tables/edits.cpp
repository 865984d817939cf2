#include <algorithm>

#include "stages/pairs/filter.h"
#include "tables/exclusions.h"
#include "tables/soft_edit.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

std::vector<EngineAttachment> inSlots(const HostTables& tables, std::vector<EngineAttachment> attachments) {
  for (EngineAttachment& a : attachments) a.body = slotOf(tables, a.body);
  return attachments;
}

bool rolls(const Material& m) { return m.rollingFriction > 0 || m.torsionalFriction > 0; }
bool ruleRolls(const EngineMaterialRule& r) { return r.coefficients[3] > 0 || r.coefficients[4] > 0; }

/// Elements that the tables need for a list of edits. One overload for each kind of edit.
struct Needs {
  const HostTables& tables;
  int bodies = 0, joints[JointTypes::kSize] = {}, vectors = 0, indices = 0, parts = 0, surfaces = 0,
      rules = 0, planes = 0, exclusions = 0;
  bool rolling = tables.view().rolls, rollingRules = false;

  void operator()(const SetBody& e) { bodies = std::max(bodies, e.id + 1); }
  void operator()(const AddBodies& e) { bodies = std::max(bodies, e.ids); }
  void operator()(const SetBodyState&) {}
  void operator()(const AddForce&) {}
  void operator()(const AddVelocity&) {}
  void operator()(const ForgetContacts&) {}
  void operator()(const AddShape& e) {
    vectors = std::max(vectors, e.place.vectors + static_cast<int>(e.shape->vectors.size()));
    indices = std::max(indices, e.place.indices + static_cast<int>(e.shape->indices.size()));
    parts = std::max(parts, e.place.parts + static_cast<int>(e.shape->parts.size()));
  }
  void operator()(const DropShape&) {}
  void operator()(const SetSurfaces& e) {
    surfaces = std::max(surfaces, static_cast<int>(e.surfaces.size()));
    rules = std::max(rules, static_cast<int>(e.rules.size()));
    rolling |= std::ranges::any_of(e.surfaces, rolls);
    rollingRules |= std::ranges::any_of(e.rules, ruleRolls);
  }
  void operator()(const SetPlanes& e) { planes = std::max(planes, static_cast<int>(e.ids.size())); }
  void operator()(const SetJoint& e) {
    int& count = joints[static_cast<int>(e.joint.type)];
    count = std::max(count, e.slot + 1);
  }
  void operator()(const SetExcluded& e) {
    exclusions += e.excluded && !isExcluded(tables.view(), {std::min(e.a, e.b), std::max(e.a, e.b), e.world});
  }
  void operator()(const SetDeformables&) {}
  void operator()(const SetVertices&) {}
  void operator()(const AddVertexForce&) {}
};

void reserve(HostTables& tables, const Needs& needs) {
  if (needs.bodies > 0) reserveBodies(tables, needs.bodies);
  for (int type = 0; type < JointTypes::kSize; ++type)
    if (needs.joints[type] > 0) tables.reserve(perJoint(type), slotsFor(needs.joints[type]));
  tables.reserve(Per::ShapeVector, needs.vectors);
  tables.reserve(Per::ShapeIndex, needs.indices);
  tables.reserve(Per::ShapePart, needs.parts);
  tables.reserve(Per::Surface, needs.surfaces);
  tables.reserve(Per::MaterialRule, needs.rules);
  tables.reserve(Per::Plane, needs.planes);
  reserveExclusions(tables, needs.exclusions);
  if ((needs.rolling && needs.bodies > 0) || needs.rollingRules)
    tables.reserve(Per::Rolling, tables.capacity(Per::ActivePair));
}

/// Applies an edit for which there is memory. One overload for each kind of edit.
struct Apply {
  HostTables& tables;

  int slot(int id) const { return slotOf(tables, id); }

  void operator()(const SetBody& e) const {
    setBodyCount(tables, e.id + 1);
    (e.keepsState ? setBodyParams : setBody)(tables, slot(e.id), e.body);
    if (e.number < 0) return;
    tables.view().idOf[slot(e.id)] = e.number, tables.view().worldOfBody[slot(e.id)] = e.world;
  }
  void operator()(const AddBodies& e) const {
    for (int k = 0; k < e.count; ++k) (*this)(e.at(k));
  }
  void operator()(const SetBodyState& e) const { setBodyState(tables, slot(e.id), e.state); }
  void operator()(const AddForce& e) const {
    const SolverData& s = tables.view();
    s.force[slot(e.id)] += Vec3(e.force), s.torque[slot(e.id)] += Vec3(e.torque);
  }
  void operator()(const AddVelocity& e) const { addVelocity(tables, slot(e.id), e.change); }
  void operator()(const ForgetContacts& e) const { forgetContacts(tables, e.ids); }
  void operator()(const AddShape& e) const { addShape(tables, *e.shape, e.partSurfaces, e.place); }
  void operator()(const DropShape&) const {}
  void operator()(const SetSurfaces& e) const { setSurfaces(tables, e); }
  void operator()(const SetPlanes& e) const { setPlanes(tables, e.ids, e.firstOfWorld); }
  void operator()(const SetJoint& e) const {
    const int type = static_cast<int>(e.joint.type);
    if (e.slot >= tables.jointIds[type]) setJointCount(tables, type, e.slot + 1);
    (e.keepsState ? editJoint : setJoint)(tables, e.slot, e.joint);
  }
  void operator()(const SetExcluded& e) const { setExcluded(tables, e.a, e.b, e.excluded, nullptr, e.world); }
  void operator()(const SetDeformables&) const {}
  void operator()(const SetVertices& e) const { setVertexStates(tables, e.first, e.positions, e.velocities); }
  void operator()(const AddVertexForce& e) const { tables.view().vertexForce[e.vertex] += Vec3(e.force); }
};

}  // namespace

void apply(HostTables& tables, std::span<const Edit> edits) {
  Needs needs{tables};
  for (const Edit& edit : edits) std::visit([&](const auto& e) { needs(e); }, edit);
  reserve(tables, needs);
  if (edits.size() == 1)
    if (const auto* const soft = std::get_if<SetDeformables>(&edits[0]))
      return setSoft(tables, soft->objects, inSlots(tables, soft->attachments));
  [&]() noexcept {
    for (const Edit& edit : edits) std::visit(Apply{tables}, edit);
  }();
}

}  // namespace rubble::RUBBLE_CORE

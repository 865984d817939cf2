#include "tables/table_edit.h"

#include <algorithm>
#include <bit>

#include "stages/joints/joints.h"
#include "tables/shape_edit.h"
#include "tables/soft_edit.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// BodyTrait bits of a material.
int traitsOf(const SurfaceData& m) {
  return (m.rolling > Real(0) || m.torsional > Real(0) ? 1 << static_cast<int>(BodyTrait::Rolls) : 0) |
         (m.restitution > Real(0) ? 1 << static_cast<int>(BodyTrait::Bounces) : 0);
}

/// BodyTrait bits of the body in a slot, whose materials must be in the tables.
int traitsOf(const SolverData& s, int slot) {
  const BodyParams& p = s.params[slot];
  if (p.kind == BodyKind::Removed) return 0;
  const BodyFilter& f = s.filter[slot];
  const CollisionFilter usual;
  const bool filtered = f.sensor || f.layers != usual.layers || f.mask != usual.mask ||
                        f.group != usual.group;
  int traits = (!isPrimitive(p.shape.kind) ? 1 << static_cast<int>(BodyTrait::GeneralShape) : 0) |
               (s.extras[slot].locks != 0 ? 1 << static_cast<int>(BodyTrait::Locked) : 0) |
               (filtered ? 1 << static_cast<int>(BodyTrait::Filtered) : 0) |
               (p.restitution > Real(0) ? 1 << static_cast<int>(BodyTrait::Bounces) : 0);
  if (p.surface >= 0) traits |= traitsOf(s.surface[p.surface]);
  if (p.shape.kind != ShapeKind::Compound) return traits;
  const int first = s.shapeIndex[p.shape.data + 2], parts = s.shapeIndex[p.shape.data + 3];
  for (int k = first; k < first + parts; ++k)
    if (s.shapePart[k].surface >= 0) traits |= traitsOf(s.surface[s.shapePart[k].surface]);
  return traits;
}

}  // namespace

void reserveNodes(HostTables& tables) {
  for (const Per per : {Per::NodeLevel, Per::Member})
    tables.reserve(per, (tables.capacity(Per::Body) + tables.capacity(Per::SoftNode)) * kCoarseLevels);
}

void clearBodySlots(HostTables& tables, int begin) {
  SolverData& s = tables.view();
  for (int i = begin; i < s.bodies; ++i) {
    s.idOf[i] = s.placeOf[i] = i;
    s.worldOfBody[i] = 0;
    s.params[i] = {};
    s.nodeOfBody[i] = -1;
    s.extras[i] = {};
    s.filter[i] = {};
    s.orientation[i] = Quat{};
    // a new body owns no pairs
    s.oldPairOffset[i + 1] = s.oldPairOffset[i];
  }
  if (s.features == 0) return;
  // nor do the corners of new bodies
  int* const offset = s.oldPointPairOffset;
  const int owners = ownersOf(s, begin);
  std::fill(offset + owners + 1, offset + s.owners() + 1, offset[owners]);
}

namespace {
int cellsFor(int slots) {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * slots))));
}
}  // namespace

void reserveBodies(HostTables& tables, int ids) {
  const int slots = slotsFor(ids);
  if (slots <= tables.view().bodies) return;
  tables.reserve(Per::Body, slots);
  tables.reserve(Per::BodySlot, tables.capacity(Per::Body) * kPairSlots);
  reserveNodes(tables);
  tables.reserve(Per::Node, tables.capacity(Per::Body) + tables.capacity(Per::Vertex));
  tables.reserve(Per::Level, kCoarseLevels);
  tables.reserve(Per::Cell, cellsFor(slots));
  if (tables.view().features > 0) {
    tables.reserve(Per::PointOwner, ownersOf(tables.view(), slots));
    tables.reserve(Per::PointOwnerSlot, tables.capacity(Per::PointOwner) * kPointPairSlots);
  }
}

void setBodyCount(HostTables& tables, int ids) {
  reserveBodies(tables, ids);
  tables.bodyIds = std::max(tables.bodyIds, ids);
  const int before = tables.view().bodies, slots = slotsFor(ids);
  if (slots <= before) return;
  tables.view().cells = cellsFor(slots);
  tables.view().bodies = slots;
  clearBodySlots(tables, before);
}

void setBodyParams(HostTables& tables, int slot, const EngineBody& body) {
  SolverData& s = tables.view();
  RUBBLE_ASSERT(slot >= 0 && slot < s.bodies);
  BodyParams& p = s.params[slot];
  p.shape = shapeData(body.shape);
  const auto kind = static_cast<BodyKind>(body.kind);
  if (p.kind != kind) tables.trees.touch(slot);
  p.kind = kind;
  const bool dynamic = p.kind == BodyKind::Dynamic;
  p.mass = dynamic ? static_cast<Real>(body.mass) : Real(0);
  p.inertia = dynamic ? Vec3(body.inertia) : Vec3{0, 0, 0};
  p.radius = static_cast<Real>(body.radius);
  p.muStatic = static_cast<Real>(body.staticFriction);
  p.muDynamic = static_cast<Real>(body.dynamicFriction);
  p.restitution = static_cast<Real>(body.restitution);
  p.gravityScale = static_cast<Real>(body.gravityScale);
  p.surface = body.surface;
  // Member by member: padding is hashed too, and that of a temporary is undefined.
  BodyExtras& extras = s.extras[slot];
  extras.linearDamping = static_cast<Real>(body.linearDamping),
  extras.angularDamping = static_cast<Real>(body.angularDamping);
  extras.locks = dynamic ? body.locks : 0;
  const CollisionFilter& f = body.filter;
  s.filter[slot] = {f.layers, f.mask, f.group, body.sensor};
  TraitCounts traits = tables.traits();
  traits.count(extras.traits, -1);
  extras.traits = traitsOf(s, slot);
  traits.count(extras.traits, 1);
  tables.setTraits(traits);
  // as many old rolling rows as old manifolds, also in the first step with such materials
  if (s.rolls) tables.reserve(Per::Rolling, tables.capacity(Per::ActivePair));
}

void setBody(HostTables& tables, int slot, const EngineBody& body) {
  setBodyParams(tables, slot, body);
  const SolverData& s = tables.view();
  s.color[slot] = 0;
  s.force[slot] = s.torque[slot] = {0, 0, 0};
  s.pushed[slot] = 0;
  s.islandMassLength[slot] = 0;
  s.correction[slot] = {0, 0, 0};
  setBodyState(tables, slot, body.state);
}

BodyState bodyState(const HostTables& tables, int slot) {
  const SolverData& s = tables.view();
  using rubble::Quat;
  using rubble::Vec3;
  return {s.position[slot], Quat(s.orientation[slot]), Vec3(s.velocity[slot]), Vec3(s.angularVelocity[slot])};
}

void setBodyState(HostTables& tables, int slot, const BodyState& state) {
  SolverData& s = tables.view();
  s.position[slot] = state.position;
  s.orientation[slot] = normalize(Quat(state.orientation));
  s.velocity[slot] = s.previousVelocity[slot] = Vec3(state.velocity);
  s.angularVelocity[slot] = Vec3(state.angularVelocity);
  wakeBody(s, slot);
}

void forgetContacts(HostTables& tables, std::span<const int> ids) {
  SolverData& s = tables.view();
  const auto goes = [&](int slot) { return slot >= 0 && std::ranges::binary_search(ids, tableId(s, slot)); };
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k)
    if (goes(s.oldPair[k].owner) || goes(s.oldPair[k].other)) forgetOldPair(s, k);
  for (const int id : ids) forgetVertexContacts(tables, slotOf(tables, id));
}

void abandonStep(HostTables& tables) {
  SolverData& s = tables.view();
  *s.counters = {};
  std::ranges::fill(firstOf(s.oldPairOffset, s.bodies + 1), 0);
  std::ranges::fill(firstOf(s.oldPointPairOffset, s.owners() + 1), 0);
  s.oldActivePairOffset[0] = 0;
  std::ranges::fill(firstOf(s.neighborSearch, s.bodies), NeighborSearch{});
  tables.trees.touchAll();
  // reserving may have moved the manifold tables
  tables.aliasRows();
}

void endForces(HostTables& tables) {
  const SolverData& s = tables.view();
  const Vec3 none{0, 0, 0};
  std::ranges::fill(firstOf(s.force, s.bodies), none), std::ranges::fill(firstOf(s.torque, s.bodies), none),
      std::ranges::fill(firstOf(s.vertexForce, s.vertices), none);
}

void addVelocity(HostTables& tables, int slot, const rubble::Vec3& change) {
  changeVelocity(tables.view(), slot, change);
}

bool inOtherOrder(const SolverData& s) {
  for (int i = 0; i < s.bodies; ++i)
    if (s.placeOf[i] != i) return true;
  return false;
}

void scatterRows(HostTables& tables, StateArray which, const ArrayView& rows, const ArrayView& values) {
  const ScatterRows scatter(which, rows, values);
  for (int k = 0; k < static_cast<int>(rows.shape[0]); ++k) scatter(tables.view(), k);
}

void setPlanes(HostTables& tables, std::span<const int> ids, std::span<const int> firstOfWorld) {
  tables.reserve(Per::Plane, static_cast<int>(ids.size()));
  SolverData& s = tables.view();
  s.planes = static_cast<int>(ids.size());
  for (int i = 0; i < s.planes; ++i) s.planeBody[i] = slotOf(tables, ids[static_cast<std::size_t>(i)]);
  std::ranges::copy(firstOfWorld, &s.firstPlane[0]);
}

}  // namespace rubble::RUBBLE_CORE

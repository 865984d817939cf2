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

Distribution distribution(std::vector<double>& values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  for (const double v : values) d.mean += v;
  d.mean /= static_cast<double>(values.size());
  d.p99 = values[static_cast<std::size_t>(.99 * static_cast<double>(values.size() - 1))];
  d.max = values.back();
  return d;
}

}  // namespace

void reserveNodes(HostTables& tables) {
  tables.reserve(Per::NodeLevel,
                 (tables.capacity(Per::Body) + tables.capacity(Per::SoftNode)) * kCoarseLevels);
}

void setBodyCount(HostTables& tables, int slots) {
  if (slots <= tables.view().bodies) return;
  tables.reserve(Per::Body, slots);
  tables.reserve(Per::BodySlot, tables.capacity(Per::Body) * kPairSlots);
  reserveNodes(tables);
  tables.reserve(Per::Node, tables.capacity(Per::Body) + tables.capacity(Per::Vertex));
  tables.reserve(Per::Level, kCoarseLevels);
  const int cells = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * slots))));
  tables.reserve(Per::Cell, cells);
  if (tables.view().features > 0) {
    // the corners of new bodies own no pairs
    const int owners = tables.view().owners(), more = owners + kCornerSlots * (slots - tables.view().bodies);
    tables.reserve(Per::PointOwner, more);
    tables.reserve(Per::PointOwnerSlot, tables.capacity(Per::PointOwner) * kPointPairSlots);
    int* const offset = tables.view().oldPointPairOffset;
    std::fill(offset + owners + 1, offset + more + 1, offset[owners]);
  }
  SolverData& s = tables.view();
  s.cells = cells;
  for (int i = s.bodies; i < slots; ++i) {
    s.idOf[i] = s.placeOf[i] = i;
    s.params[i] = {};
    s.nodeOfBody[i] = -1;
    s.extras[i] = {};
    s.filter[i] = {};
    s.orientation[i] = Quat{};
    // a new body owns no pairs
    s.oldPairOffset[i + 1] = s.oldPairOffset[i];
    s.exclusionOffset[i + 1] = s.exclusionOffset[i];
  }
  s.bodies = slots;
}

void setBody(HostTables& tables, int slot, const EngineBody& body) {
  SolverData& s = tables.view();
  BodyParams& p = s.params[slot];
  p.shape = shapeData(body.shape);
  // a new body has no joints yet, and the joints of a removed one were removed before
  const auto kind = static_cast<BodyKind>(body.kind);
  s.treesStale |= p.kind != kind && p.kind != BodyKind::Removed && kind != BodyKind::Removed;
  p.kind = kind;
  const bool dynamic = p.kind == BodyKind::Dynamic;
  p.mass = dynamic ? static_cast<Real>(body.mass.mass) : Real(0);
  p.inertia = dynamic ? Vec3(body.mass.inertia) : Vec3{0, 0, 0};
  p.radius = static_cast<Real>(body.radius);
  p.muStatic = static_cast<Real>(body.material.staticFriction);
  p.muDynamic = static_cast<Real>(body.material.dynamicFriction);
  p.restitution = static_cast<Real>(body.material.restitution);
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

void forgetContacts(HostTables& tables, int slot) {
  SolverData& s = tables.view();
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k)
    if (s.oldPair[k].owner == slot || s.oldPair[k].other == slot) forgetOldPair(s, k);
  forgetVertexContacts(tables, slot);
}

void forgetContactsOf(HostTables& tables, std::span<const int> slots) {
  SolverData& s = tables.view();
  std::vector<char> gone(static_cast<std::size_t>(s.bodies), 0);
  for (const int slot : slots) gone[static_cast<std::size_t>(slot)] = 1;
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k) {
    const Pair& p = s.oldPair[k];
    if (!gone[static_cast<std::size_t>(p.owner)] &&
        !(p.other >= 0 && gone[static_cast<std::size_t>(p.other)]))
      continue;
    forgetOldPair(s, k);
  }
  for (const int slot : slots) forgetVertexContacts(tables, slot);
}

void abandonStep(HostTables& tables) {
  SolverData& s = tables.view();
  *s.counters = {};
  std::fill_n(s.oldPairOffset, s.bodies + 1, 0);
  std::fill_n(s.oldPointPairOffset, s.owners() + 1, 0);
  s.oldActivePairOffset[0] = 0;
  s.treesStale = 1;
  // reserving may have moved the manifold tables
  tables.aliasRows();
}

void endForces(HostTables& tables) {
  const SolverData& s = tables.view();
  const Vec3 none{0, 0, 0};
  std::fill_n(s.force, s.bodies, none), std::fill_n(s.torque, s.bodies, none),
      std::fill_n(s.vertexForce, s.vertices, none);
}

void addVelocity(HostTables& tables, int slot, const rubble::Vec3& change) {
  changeVelocity(tables.view(), slot, change);
}

bool inOtherOrder(const SolverData& s) {
  for (int i = 0; i < s.bodies; ++i)
    if (s.idOf[i] != i) return true;
  return false;
}

BodyOrder orderOf(const HostTables& tables) {
  const SolverData& s = tables.view();
  const std::size_t bodies = static_cast<std::size_t>(s.bodies);
  return {{s.placeOf, bodies}, {s.idOf, bodies}};
}

void scatterRows(HostTables& tables, StateArray which, const ArrayView& rows, const ArrayView& values) {
  const ScatterRows scatter(which, rows, values);
  for (int k = 0; k < static_cast<int>(rows.shape[0]); ++k) scatter(tables.view(), k);
}

void setPlanes(HostTables& tables, const std::vector<int>& slots) {
  tables.reserve(Per::Plane, static_cast<int>(slots.size()));
  std::copy(slots.begin(), slots.end(), tables.view().planeBody);
  tables.view().planes = static_cast<int>(slots.size());
}

void setExclusions(HostTables& tables, const std::vector<std::pair<int, int>>& pairs) {
  tables.reserve(Per::Exclusion, static_cast<int>(pairs.size()));
  SolverData& s = tables.view();
  std::size_t k = 0;
  for (int i = 0; i < s.bodies; ++i) {
    s.exclusionOffset[i] = static_cast<int>(k);
    for (; k < pairs.size() && pairs[k].first == i; ++k) s.exclusionBody[k] = pairs[k].second;
  }
  s.exclusionOffset[s.bodies] = s.exclusions = static_cast<int>(k);
}

namespace {

/// Calls visit(pair, manifold) for every pair of the last step that has contact points.
template <class Visit> void forEachManifold(const SolverData& s, Visit&& visit) {
  for (int k = 0; k < s.oldPairOffset[s.bodies]; ++k)
    if (const int m = manifoldOfOld(s, k); m >= 0 && s.oldManifold[m].count > 0 && s.oldPair[k].other >= 0)
      visit(ordered(s.oldPair[k]), s.oldManifold[m]);
}

/// The two surface points of a contact point, relative to the center of A.
struct SurfacePoints {
  Vec3 onA, onB;
};
SurfacePoints surfacePoints(const SolverData& s, const OrderedPair& o, const Manifold& m, int point) {
  return {rotate(s.orientation[o.a], pointOnA(m, point)),
          centerDistance(s, o.a, o.b) + rotate(s.orientation[o.b], pointOnB(m, point))};
}

}  // namespace

std::vector<EngineContact> contactsOf(const HostTables& tables) {
  const SolverData& s = tables.view();
  std::vector<EngineContact> out;
  forEachManifold(s, [&](const OrderedPair& o, const Manifold& m) {
    // a sleeping pair has no rows, but keeps its multipliers
    const bool sleeps = m.row < 0 && (isAsleep(s, o.a) || isAsleep(s, o.b));
    if (m.row < 0 && !sleeps) return;
    const ContactRows* const r = sleeps ? nullptr : &s.contact[m.row];
    const Vec3 n = r ? r->n : m.normal;
    Vec3 t1, t2;
    tangentBasis(n, t1, t2);
    for (int k = 0; k < m.count; ++k) {
      const SurfacePoints x = surfacePoints(s, o, m, k);
      const Vec3 force = r ? n * r->load[k].lambdaN + t1 * r->load[k].lambda1 + t2 * r->load[k].lambda2
                           : n * m.lambdaN[k] + t1 * m.lambda1[k] + t2 * m.lambda2[k];
      out.push_back({o.a, o.b, s.position[o.a] + Vec3d((x.onA + x.onB) * Real(.5)), Vec3d(n), Vec3d(force),
                     static_cast<double>(dot(n, x.onA - x.onB))});
    }
  });
  return out;
}

std::vector<EngineTouch> touchesOf(const HostTables& tables) {
  const SolverData& s = tables.view();
  std::vector<EngineTouch> out;
  forEachManifold(s, [&](const OrderedPair& o, const Manifold& m) {
    bool touch = false;
    for (int k = 0; k < m.count; ++k) {
      const SurfacePoints x = surfacePoints(s, o, m, k);
      const bool loaded = m.row >= 0 && s.contact[m.row].load[k].lambdaN > Real(0);
      touch |= loaded ||
               dot(m.normal, x.onA - x.onB) > -kInactiveGap * pairLength(s.params[o.a], s.params[o.b]);
    }
    if (touch) out.push_back({o.a, o.b, isSensor(s, o.a) || isSensor(s, o.b)});
  });
  return out;
}

std::vector<int> sleepersOf(const HostTables& tables) {
  const SolverData& s = tables.view();
  std::vector<int> out;
  for (int i = 0; i < s.bodies; ++i)
    if (s.asleep[i] != 0 && s.params[i].kind == BodyKind::Dynamic) out.push_back(i);
  return out;
}

Quality qualityOf(const HostTables& tables) {
  const SolverData& s = tables.view();
  Quality q;
  std::vector<double> depths;
  for (const EngineContact& c : contactsOf(tables)) depths.push_back(std::max(0.0, c.depth));
  int joints = 0;
  addSoftQuality(tables, q, depths, joints);
  q.penetration = distribution(depths);
  forEachType(JointTypes{}, [&]<class F>() {
    const int type = typeIndex<F>(JointTypes{});
    for (int i = 0; i < s.joints[type]; ++i) {
      if (!active<F>(s, i)) continue;
      const double gap = jointStateOf(tables, type, i).gap;
      q.jointGapMean += gap;
      q.jointGapMax = std::max(q.jointGapMax, gap);
      ++joints;
    }
  });
  if (joints > 0) q.jointGapMean /= joints;

  for (int i = 0; i < s.bodies; ++i) {
    const BodyParams& p = s.params[i];
    if (p.kind != BodyKind::Dynamic) continue;
    const Vec3 w = rotateInverse(s.orientation[i], s.angularVelocity[i]);
    const double v2 = dot(Vec3d(s.velocity[i]), Vec3d(s.velocity[i]));
    q.kineticEnergy += .5 *
                       (static_cast<double>(p.mass) * v2 + static_cast<double>(dot(w, mul(p.inertia, w))));
    q.potentialEnergy -= static_cast<double>(p.mass * p.gravityScale) *
                         dot(Vec3d(s.step.gravity), s.position[i]);
    q.maxSpeed = std::max(q.maxSpeed, std::sqrt(v2));
  }
  return q;
}

}  // namespace rubble::RUBBLE_CORE

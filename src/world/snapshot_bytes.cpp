/// Snapshots as bytes: a header, the records of the world, and the state of the engine.
#include <any>

#include <rubble/info.h>
#include <rubble/version.h>

#include "cook/cook.h"
#include "world/archive.h"
#include "world/batch.h"
#include "world/world_impl.h"

namespace rubble {

template <class A, class R> void fields(A& a, Vec3T<R>& v) { all(a, v.x, v.y, v.z); }
template <class A, class R> void fields(A& a, QuatT<R>& q) { all(a, q.s, q.v); }
template <class A, class Tag> void fields(A& a, Id<Tag>& id) { all(a, id.index, id.generation); }

template <class A> void fields(A& a, Material& m) {
  all(a, m.staticFriction, m.dynamicFriction, m.restitution, m.frictionCombine, m.restitutionCombine,
      m.rollingFriction, m.torsionalFriction, m.surfaceVelocity, m.oneWay, m.name);
}
template <class A> void fields(A& a, MaterialPair& p) {
  all(a, p.a, p.b, p.staticFriction, p.dynamicFriction, p.restitution, p.rollingFriction,
      p.torsionalFriction);
}
template <class A> void fields(A& a, MassProperties& m) { all(a, m.mass, m.inertia, m.center, m.axes); }
template <class A> void fields(A& a, Shape& s) {
  all(a, s.type, s.halfExtents, s.radius, s.halfLength, s.rounding, s.geometry, s.userData);
}
template <class A> void fields(A& a, ShapePartDef& p) {
  all(a, p.shape, p.position, p.orientation, p.material, p.density);
}
template <class A> void fields(A& a, ShapeGeometry& g) {
  all(a, g.points, g.triangles, g.twoSided, g.parts, g.counts, g.origin, g.spacing, g.samples, g.mass);
}
template <class A> void fields(A& a, CollisionFilter& f) { all(a, f.layers, f.mask, f.group); }
template <class A> void fields(A& a, BodyDef& b) {
  all(a, b.name, b.motion, b.shape, b.material, b.density, b.mass, b.inertia, b.position, b.orientation,
      b.velocity, b.angularVelocity, b.gravityScale, b.linearDamping, b.angularDamping, b.lockTranslation,
      b.lockRotation, b.filter, b.sensor, b.userData);
}
template <class A> void fields(A& a, JointAxis& x) {
  all(a, x.min, x.max, x.limitStiffness, x.limitDamping, x.targetPosition, x.targetSpeed, x.driveStiffness,
      x.driveDamping, x.maxDriveForce, x.friction, x.armature, x.damping, x.motorForce);
}
/// Members of a type that has none in JointDef. Those that an extension adds are not known.
template <class A> void fields(A& a, std::any& own) {
  bool isTendon = own.type() == typeid(TendonFields);
  if (own.has_value() && !isTendon)
    throw Error("snapshot", "joints and elements of types that Rubble has", "one of an extension");
  fields(a, isTendon);
  if (!isTendon) return;
  if constexpr (A::kReads) own = TendonFields{};
  TendonFields& tendon = std::any_cast<TendonFields&>(own);
  all(a, tendon.path, tendon.terms, tendon.wraps);
}
template <class A> void fields(A& a, JointDef& j) {
  all(a, j.name, j.type, j.bodyA, j.bodyB, j.frameBodyA, j.frameBodyB, j.anchorA, j.anchorB, j.frameA,
      j.frameB, j.orientationAtoB, j.driveOrientation, j.stiffness, j.damping, j.dampingRatio);
  all(a, j.angularStiffness, j.angularDamping, j.angularDampingRatio, j.maxForce, j.maxTorque, j.length,
      j.ratio, j.swingY, j.swingZ, j.friction, j.driveStiffness, j.driveDamping, j.maxDriveTorque);
  all(a, j.breakForce, j.breakTorque, j.pulleyA, j.pulleyB, j.axes, j.collide, j.userData, j.own);
}
template <class A> void fields(A& a, ElementDef& e) { all(a, e.type, e.vertices, e.fields); }
template <class A> void fields(A& a, DeformableDef& d) {
  all(a, d.name, d.vertices, d.start, d.fixed, d.velocity, d.angularVelocity, d.material, d.gravityScale,
      d.collide, d.collideSurface, d.collideSelf, d.collideVertices, d.elements, d.userData);
}
template <class A> void fields(A& a, TetSolidDef& d) {
  fields(a, static_cast<DeformableDef&>(d));
  all(a, d.tetrahedra, d.youngsModulus, d.poissonRatio, d.density, d.viscosity, d.yieldStress, d.hardening,
      d.contactRadius);
}
template <class A> void fields(A& a, ClothDef& d) {
  fields(a, static_cast<DeformableDef&>(d));
  all(a, d.triangles, d.thickness, d.youngsModulus, d.poissonRatio, d.density, d.viscosity,
      d.bendingStiffness, d.restFolded, d.bendingDamping, d.tearStretch, d.pressure);
}
template <class A> void fields(A& a, CableDef& d) {
  fields(a, static_cast<DeformableDef&>(d));
  all(a, d.closed, d.radius, d.youngsModulus, d.density, d.viscosity, d.breakForce);
}
template <class A> void fields(A& a, NetDef::Edge& e) {
  all(a, e.a, e.b, e.stiffness, e.damping, e.restLength);
}
template <class A> void fields(A& a, NetDef& d) {
  fields(a, static_cast<DeformableDef&>(d));
  all(a, d.masses, d.edges, d.triangles, d.contactRadius, d.breakForce);
}
template <class A> void fields(A& a, ParticlesDef& d) {
  fields(a, static_cast<DeformableDef&>(d));
  all(a, d.radius, d.density);
}
template <class A> void fields(A& a, AttachmentDef& d) {
  all(a, d.name, d.object, d.vertices, d.weights, d.body, d.anchor, d.otherObject, d.otherVertices,
      d.otherWeights, d.stiffness, d.breakForce);
}

template <class A> void fields(A& a, ShapeFrame& f) { all(a, f.center, f.axes); }
template <class A> void fields(A& a, BodyRecord& r) {
  all(a, r.def, r.mass, r.frame, r.radius, r.shape, r.joints);
}
template <class A> void fields(A& a, EngineGroup& g) { all(a, g.mode, g.stiffness, g.damping, g.bound); }
template <class A> void fields(A& a, JointConstants& c) { fields(a, c.bytes()); }
template <class A> void fields(A& a, EngineJoint& j) {
  all(a, j.type, j.a, j.b, j.frameBodyA, j.frameBodyB, j.alive, j.isRigid, j.anchorA, j.anchorB, j.frameA,
      j.frameB, j.aToB, j.constants, j.groups, j.axes, j.breakForce, j.breakTorque, j.turned);
}
template <class A> void fields(A& a, JointRecord& r) {
  all(a, r.def, r.a, r.b, r.frameBodyA, r.frameBodyB, r.engine, r.engineSlot, r.broken);
}
template <class A> void fields(A& a, SoftRange& r) {
  all(a, r.vertex, r.edge, r.face);
  for (int& element : r.element) fields(a, element);
}
template <class A> void fields(A& a, SoftRecord& r) {
  all(a, r.def, r.order, r.range, r.surface);
  if constexpr (A::kReads) r.model = cookDeformable(r.def, "snapshot");
}
template <class A> void fields(A& a, AttachmentRecord& r) {
  all(a, r.def, r.object, r.otherObject, r.body, r.anchor, r.order, r.engineIndex);
}
template <class A> void fields(A& a, Touch& t) {
  all(a, t.a, t.b, t.sensor, t.userDataA, t.userDataB, t.shapeUserDataA, t.shapeUserDataB);
}
template <class A, class I, class Def> void fields(A& a, Slots<I, Def>& slots) {
  slots.forLists([&](auto& items, auto& free) {
    items.resize(countOf(a, items.size()));
    for (auto& item : items) {
      all(a, item.generation, item.alive);
      if (item.alive) fields(a, item.def);
    }
    fields(a, free);
  });
}
template <class A> void fields(A& a, RangeSpace::Range& r) { all(a, r.first, r.size); }
template <class A> void fields(A& a, ShapeRecord& r) {
  all(a, r.shape, r.place.vectors, r.place.indices, r.place.parts, r.bodies, r.held);
  if constexpr (A::kReads)
    if (r.shape.geometry) r.cooked = std::make_shared<const CookedShape>(cook(r.shape, "snapshot"));
}
template <class A> void fields(A& a, WorldShapes& shapes) {
  shapes.forMembers([&](auto& records, ShapeSpace& space) {
    fields(a, records);
    space.forMembers([&](auto& member) { fields(a, member); });
  });
  if constexpr (A::kReads) shapes.linkAll();
}
template <class A> void fields(A& a, Tuning& t) {
  all(a, t.startStiffness, t.tangentStiffness, t.maxStiffness, t.contactPolicy, t.jointPolicy,
      t.loadAcceleration, t.contactRampRate, t.jointRampRate, t.literalBeta, t.errorRetention,
      t.driftCorrection, t.warmStartDecay, t.coarseCorrection, t.jointTrees, t.acceleration);
  all(a, t.coneHessian, t.dormantRows, t.impactRule, t.compliantRows, t.contactMargin, t.sleepSpeed,
      t.sleepDelay, t.recycleTolerance);
}
template <class A> void fields(A& a, Params& p) {
  all(a, p.dt, p.iterations, p.substeps, p.preset, p.sortInterval, p.sleeping, p.tuning);
}
template <class A> void fields(A& a, Event::Push& p) { all(a, p.body, p.velocity, p.angularVelocity); }
template <class A> void fields(A& a, Event::Turn& t) {
  all(a, t.joint, t.axis, t.targetPosition, t.targetSpeed, t.length, t.dragTo, t.motorForce);
}
template <class A> void fields(A& a, Event& e) {
  all(a, e.step, e.add, e.remove, e.removeJoints, e.setVelocity, e.setJoint);
}
template <class A> void fields(A& a, Registry& r) {
  all(a, r.bodies, r.joints, r.softs, r.attachments, r.softNames, r.sceneSofts, r.softOrder, r.bodyNames,
      r.jointNames, r.sceneBodies, r.shapes, r.surfaces, r.materialPairs);
  all(a, r.freeJointSlots, r.jointSlots, r.exclusions, r.planes, r.touches, r.sleepers, r.hasUnlistedBreaks,
      r.gravity, r.step, r.time, r.script, r.nextEvent, r.partsOfEvent, r.actuators);
}

namespace {

constexpr std::string_view kMagic = "rubble snapshot 4\n";

/// What has to be equal for bytes to be read: the version, and the layout of the tables.
std::string layoutOf(bool doublePrecision) {
#if defined(RUBBLE_HAS_REFERENCE)
  const std::uint64_t layout = doublePrecision ? f64::tableLayout() : f32::tableLayout();
#else
  if (doublePrecision) throw Error("snapshot", "one in single precision", "one of backend \"reference\"");
  const std::uint64_t layout = f32::tableLayout();
#endif
  return std::string(RUBBLE_VERSION_TEXT) + ", layout " + std::to_string(layout);
}

}  // namespace

std::vector<std::byte> Snapshot::bytes() const {
  if (!data) throw Error("snapshot", "one made by World::snapshot", "an empty one");
  if (dynamic_cast<const WorldSnapshot*>(data->engine.get()))
    throw Error("snapshot", "one of a world of its own", "one of many worlds");
  return withMemory("bytes", [&] {
    ArchiveWriter content;
    Registry registry = data->registry;
    Params params = data->params;
    std::vector<std::byte> engine = data->engine->bytes();
    all(content, registry, params, engine);
    ArchiveWriter out;
    out.raw(kMagic.data(), kMagic.size());
    bool doublePrecision = data->doublePrecision;
    std::string layout = layoutOf(doublePrecision);
    std::uint64_t hash = hashOf(content.bytes);
    all(out, doublePrecision, layout, hash, content.bytes);
    return std::move(out.bytes);
  });
}

Snapshot Snapshot::fromBytes(std::span<const std::byte> bytes) {
  return withMemory("fromBytes", [&] {
    ArchiveReader in(bytes);
    std::string magic(std::min(bytes.size(), kMagic.size()), ' ');
    in.raw(magic.data(), magic.size());
    if (magic != kMagic) throw Error("snapshot", "bytes made by Snapshot::bytes", "others");
    auto data = std::make_shared<Snapshot::Data>();
    std::string layout;
    std::uint64_t hash;
    std::vector<std::byte> content;
    all(in, data->doublePrecision, layout);
    if (const std::string own = layoutOf(data->doublePrecision); layout != own)
      throw Error("snapshot", "one of Rubble " + own, "one of Rubble " + layout);
    all(in, hash, content);
    if (!in.atEnd() || hash != hashOf(content)) throw Error("snapshot", "undamaged bytes", "damaged ones");
    ArchiveReader records(content);
    std::vector<std::byte> engine;
    all(records, data->registry, data->params, engine);
    data->engine = std::make_shared<SavedState>(std::move(engine));
    return Snapshot{std::move(data)};
  });
}

}  // namespace rubble

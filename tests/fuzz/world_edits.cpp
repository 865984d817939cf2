#include <algorithm>
#include <cmath>

#include "tests/fuzz/definitions.h"
#include "tests/fuzz/target.h"
#include "tests/fuzz/world_script.h"

namespace rubble::fuzz {
namespace {

constexpr std::size_t kMostBodies = 40, kMostJoints = 40, kMostObjects = 5, kMostAttachments = 8;

/// Lists of World are by index.
template <class Id> void insert(std::vector<Id>& ids, Id id) {
  const auto less = [](const Id& a, const Id& b) { return a.index < b.index; };
  ids.insert(std::lower_bound(ids.begin(), ids.end(), id, less), id);
}

}  // namespace

void WorldScript::addBodies() {
  std::vector<BodyDef> bodies;
  for (int more = 1 + in_.below(3); more > 0; --more) bodies.push_back(body(in_));
  if (alive_.bodies.size() + bodies.size() > kMostBodies) return;
  for (const BodyId id : world_.addBodies(bodies)) insert(alive_.bodies, id);
}

void WorldScript::addJoint() {
  const JointDef def = joint(in_);
  const BodyId a = pick(alive_.bodies), b = pickBodyOrWorld();
  BodyId frameBodyA, frameBodyB;
  if (def.type == JointType::Gear || def.type == JointType::Rack)
    frameBodyA = pickBodyOrWorld(), frameBodyB = pickBodyOrWorld();
  if (alive_.joints.size() >= kMostJoints) return;
  insert(alive_.joints, world_.addJoint(def, a, b, frameBodyA, frameBodyB));
}

void WorldScript::addDeformable() {
  const Deformable def = deformable(in_);
  if (alive_.deformables.size() >= kMostObjects) return;
  insert(alive_.deformables, world_.addDeformable(def));
}

void WorldScript::addAttachment() {
  const DeformableId object = pick(alive_.deformables);
  if (!world_.alive(object) || alive_.attachments.size() >= kMostAttachments) return;
  const BodyId body = pickBodyOrWorld();
  const DeformableId other = in_.flag() ? pick(alive_.deformables) : DeformableId{};
  const int otherVertices = world_.alive(other) ? world_.vertexCount(other) : 0;
  const AttachmentDef def = attachment(in_, world_.vertexCount(object), otherVertices);
  insert(alive_.attachments, world_.addAttachment(def, object, body, other));
}

void WorldScript::remove() {
  switch (in_.below(4)) {
    case 0: {
      std::vector<BodyId> gone;
      for (int more = 1 + in_.below(3); more > 0; --more) gone.push_back(pick(alive_.bodies));
      world_.removeBodies(gone);
      for (const BodyId id : gone) std::erase(alive_.bodies, id);
      break;
    }
    case 1: {
      const JointId id = pick(alive_.joints);
      world_.removeJoint(id);
      std::erase(alive_.joints, id);
      break;
    }
    case 2: {
      const DeformableId id = pick(alive_.deformables);
      world_.removeDeformable(id);
      std::erase(alive_.deformables, id);
      break;
    }
    default: {
      const AttachmentId id = pick(alive_.attachments);
      world_.removeAttachment(id);
      std::erase(alive_.attachments, id);
    }
  }
  noteRemoved();
}

void WorldScript::setBody() {
  const BodyId id = pick(alive_.bodies);
  const bool teleports = in_.flag();
  const Vec3 position = in_.vector(-3, 3);
  const Quat orientation = in_.rotation();
  if (teleports)
    world_.setState(id, {position, orientation, in_.vector(-20, 20), {}});
  else
    world_.setTarget(id, position, orientation);
}

void WorldScript::push() {
  const BodyId id = pick(alive_.bodies);
  const double size = in_.ratio(1, 1e5);
  const Vec3 force = size * in_.vector(-1, 1);
  switch (in_.below(4)) {
    case 0:
      return world_.applyForce(id, force);
    case 1:
      return world_.applyForceAt(id, force, in_.vector(-2, 2));
    case 2:
      return world_.applyTorque(id, force);
    default:
      return world_.applyImpulse(id, force * .01);
  }
}

void WorldScript::changeJoint() {
  const JointId id = pick(alive_.joints);
  switch (in_.below(7)) {
    case 0: {
      const double low = in_.between(-1, 1);
      return world_.setLimits(id, in_.below(6), low, low + 1);
    }
    case 1:
      return world_.setTargetPosition(id, in_.below(6), 1);
    case 2:
      if (in_.flag()) return world_.setMotorForce(id, in_.below(6), in_.between(-5, 5));
      return world_.setTargetSpeed(id, in_.below(6), 5);
    case 3:
      return world_.setLength(id, in_.between(-.5, 2));
    case 4: {
      const BodyId body = pick(alive_.bodies);
      if (alive_.joints.size() >= kMostJoints) return;
      return insert(alive_.joints, world_.addDragJoint(body, in_.vector(-2, 2), 1e3));
    }
    case 5:
      return world_.setDragTarget(id, in_.vector(-3, 3));
    default: {
      JointDef def = joint(in_);
      if (world_.alive(id)) def.type = world_.definition(id).type;
      return world_.setDefinition(id, def);
    }
  }
}

void WorldScript::changeVertices() {
  const DeformableId id = pick(alive_.deformables);
  if (in_.flag()) return world_.applyVertexForce(id, in_.below(40) - 1, in_.vector(-100, 100));
  std::vector<Vec3> positions = world_.positions(id), velocities = world_.velocities(id);
  for (Vec3& x : positions) x += in_.vector(-.2, .2);
  for (Vec3& v : velocities) v += in_.vector(-1, 1);
  world_.setVertices(id, positions, velocities);
}

void WorldScript::changeSettings() {
  Params params = world_.params();
  switch (in_.below(6)) {
    case 0:
      return world_.setGravity(in_.vector(-30, 30));
    case 1:
      params.dt = in_.ratio(1e-4, .2);
      break;
    case 2:
      params.iterations = 1 + in_.below(8), params.substeps = 1 + in_.below(3);
      break;
    case 3:
      params.sleeping = in_.flag();
      break;
    default: {
      const std::vector<ParamField>& fields = paramFields();
      const ParamField& field = fields[static_cast<std::size_t>(in_.byte()) % fields.size()];
      const double factor = in_.ratio(.25, 4);
      setParam(params, field.name, field.get(params) * factor);
    }
  }
  world_.setParams(params);
}

void WorldScript::arrange() {
  const BodyId a = pick(alive_.bodies), b = pick(alive_.bodies);
  switch (in_.below(4)) {
    case 0:
      return world_.setCollide(a, b, in_.flag());
    case 1:
      return world_.sortBodies();
    case 2: {
      static constexpr const char* kKinds[] = {"pairs", "manifolds", "incidences", "colors", "unknown"};
      const char* const kind = kKinds[in_.below(5)];
      return world_.reserve(kind, in_.byte() * 16);
    }
    default:
      return world_.wake(a);
  }
}

void WorldScript::query() {
  QueryFilter filter;
  filter.sensors = in_.flag();
  filter.ignore = pick(alive_.bodies);
  const Vec3 from = in_.vector(-3, 3), way = in_.vector(-5, 5);
  const auto expectBody = [&](bool hit, BodyId id) {
    if (hit) expect(world_.alive(id) && id != filter.ignore, "a query finds a body that it must not find");
  };
  switch (in_.below(4)) {
    case 0: {
      const RayHit hit = world_.castRays(std::vector<RayQuery>{{from, way, 10, filter}}).front();
      expectBody(hit.hit, hit.body);
      if (hit.hit) expect(hit.distance >= 0 && hit.distance <= 10, "a ray hits beyond its length");
      return;
    }
    case 1: {
      const Shape shape = solidShape(in_);
      const CastQuery cast{shape, from, in_.rotation(), way, filter};
      const CastHit hit = world_.castShapes({&cast, 1}).front();
      expectBody(hit.hit, hit.body);
      if (hit.hit) expect(hit.fraction >= 0 && hit.fraction <= 1, "a cast hits beyond its way");
      return;
    }
    case 2: {
      const Shape shape = solidShape(in_);
      const OverlapQuery overlap{shape, from, in_.rotation(), filter};
      const std::vector<std::vector<BodyId>> found = world_.overlaps({&overlap, 1});
      for (const BodyId id : found.front()) expectBody(true, id);
      return;
    }
    default: {
      const ClosestHit hit = world_.closestPoints(std::vector<ClosestQuery>{{from, 5, filter}}).front();
      expectBody(hit.hit, hit.body);
      if (hit.hit) expect(hit.distance >= 0 && hit.distance <= 5.001, "a closest point lies too far away");
    }
  }
}

}  // namespace rubble::fuzz

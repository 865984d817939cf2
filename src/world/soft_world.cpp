/// The deformable objects of a world.
#include <algorithm>
#include <numeric>

#include "cook/checks.h"
#include "world/table_additions.h"

namespace rubble {

namespace {

/// Ids in the order in which their objects were added.
template <class Id, class Record> std::vector<Id> inOrder(const Slots<Id, Record>& slots) {
  std::vector<Id> ids = slots.ids();
  std::sort(ids.begin(), ids.end(), [&](Id a, Id b) { return slots[a].order < slots[b].order; });
  return ids;
}

/// Weights of one side of an attachment: not negative, sum 1.
std::vector<double> sideWeights(const std::vector<int>& vertices, const std::vector<double>& weights,
                                int count, const Path& path) {
  if (vertices.empty()) throw Error(path, "at least one vertex", "none");
  for (const int v : vertices)
    if (v < 0 || v >= count) throw Error(path, "indices below " + std::to_string(count), std::to_string(v));
  if (weights.empty()) return std::vector<double>(vertices.size(), 1.0 / double(vertices.size()));
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const bool isMean = std::ranges::all_of(weights, [](double w) { return w >= 0; }) &&
                      std::abs(sum - 1) < 1e-6;
  if (weights.size() != vertices.size() || !isMean)
    throw Error(path, "a weight of at least 0 for each vertex, which add up to 1",
                std::to_string(weights.size()) + " of sum " + std::to_string(sum));
  return weights;
}

}  // namespace

int World::Impl::placeMaterial(const Material& material) {
  if (material.name.empty()) return -1;
  TableAdditions tables(registry, *cooked);
  const int surface = tables.surfaceOf(material, Quat{});
  tables.prepare(registry);
  engine->apply(tables.edits());
  tables.commit(registry);
  return surface;
}

DeformableId World::Impl::addSoft(const Deformable& def, const Path& path) {
  const std::string& name = common(def).name;
  if (!name.empty() && registry.softNames.contains(name))
    throw Error(path + ".name", "a name that no other deformable object has", "\"" + name + "\"");
  SoftRecord record{def, cookDeformable(def, path), registry.softOrder, {}};
  registry.softs.prepare();
  if (!name.empty()) registry.softNames.emplace(name, registry.softs.next());
  Undo unname([&] { registry.softNames.erase(name); });
  record.surface = placeMaterial(common(def).material);
  unname.keep();
  ++registry.softOrder;
  softChanged = true;
  return registry.softs.add(std::move(record));
}

SoftRecord World::Impl::redefined(DeformableId id, const Deformable& def) const {
  requireAlive(id);
  const SoftRecord& old = registry.softs[id];
  const auto same = [](bool is, const char* field, const std::string& wanted, const std::string& got) {
    if (!is) throw Error(Path("deformable") + field, wanted, got);
  };
  same(def.index() == old.def.index(), "", "an object of the same kind", "one of another kind");
  const DeformableDef &now = common(def), &was = common(old.def);
  same(now.name == was.name, ".name", "that of the object, \"" + was.name + "\"", "\"" + now.name + "\"");
  same(now.vertices.size() == was.vertices.size(), ".vertices",
       "as many as the object has, " + std::to_string(was.vertices.size()),
       std::to_string(now.vertices.size()));
  SoftRecord record = old;
  record.def = def, record.model = cookDeformable(def, "deformable");
  if (record.range.vertex >= 0 && !record.before) record.before = old.model;
  return record;
}

void World::Impl::redefine(DeformableId id, const Deformable& def) { apply(id, redefined(id, def)); }

void World::Impl::apply(DeformableId id, SoftRecord record) {
  registry.softs.prepare(0);
  record.surface = placeMaterial(common(record.def).material);
  registry.softs.edit(id) = std::move(record);
  softChanged = true;
}

void World::setDefinition(DeformableId id, const Deformable& deformable) {
  withMemory("setDefinition", [&] { impl_->redefine(id, deformable); });
  impl_->pass(inputs::SetDeformableDefinition{id, deformable});
}

void World::Impl::removeSoft(DeformableId id) {
  requireAlive(id);
  registry.softs.prepare();
  registry.attachments.prepare(registry.attachments.count());
  for (int slot = 0; slot < registry.attachments.size(); ++slot) {
    const auto a = registry.attachments.at(slot);
    if (a && (registry.attachments[*a].object == id || registry.attachments[*a].otherObject == id))
      registry.attachments.remove(*a);
  }
  const std::string& name = common(registry.softs[id].def).name;
  if (!name.empty()) registry.softNames.erase(name);
  registry.softs.remove(id);
  softChanged = true;
}

void checkNumbers(const AttachmentDef& def, const Path& path) {
  if (!(def.stiffness > 0))
    throw Error(path + ".stiffness", "a number above 0 or infinity", std::to_string(def.stiffness));
  if (!(def.breakForce > 0))
    throw Error(path + ".breakForce", "a number above 0 or infinity", std::to_string(def.breakForce));
  if (def.anchor) checks::finite(*def.anchor, path + ".anchor");
}

AttachmentId World::Impl::addAttachment(const AttachmentDef& def, DeformableId object, BodyId body,
                                        DeformableId other, const Path& path) {
  requireAlive(object);
  requireAliveIfAny(body), requireAliveIfAny(other);
  checkNumbers(def, path);
  AttachmentRecord record{def, object, other, body, {}, registry.softOrder, -1};
  const auto countOf = [&](DeformableId id) { return int(registry.softs[id].model->vertices.size()); };
  record.def.weights = sideWeights(def.vertices, def.weights, countOf(object), path + ".vertices");
  std::size_t corners = def.vertices.size();
  if (other.index >= 0) {
    record.def.otherWeights = sideWeights(def.otherVertices, def.otherWeights, countOf(other),
                                          path + ".otherVertices");
    corners += def.otherVertices.size();
  }
  if (corners > 4) throw Error(path + ".vertices", "four vertices at most", std::to_string(corners));
  if (def.anchor) {
    record.anchor = *def.anchor;
  } else if (other.index < 0) {
    const SoftRecord& soft = registry.softs[object];
    std::vector<Vec3> at(std::size_t(countOf(object)));
    if (soft.range.vertex >= 0)
      engine->read(Fetch::Vertices).vertexStates(soft.range.vertex, at, {});
    else
      std::transform(soft.model->vertices.begin(), soft.model->vertices.end(), at.begin(),
                     [](const auto& v) { return v.position; });
    for (std::size_t i = 0; i < def.vertices.size(); ++i)
      record.anchor += record.def.weights[i] * at[std::size_t(def.vertices[i])];
    if (body.index >= 0) {
      const BodyState state = registry.bodies[body].frame.toAuthor(bodyState(body));
      record.anchor = rotateInverse(state.orientation, record.anchor - state.position);
    }
  }
  registry.attachments.prepare();
  ++registry.softOrder;
  softChanged = true;
  return registry.attachments.add(std::move(record));
}

void World::Impl::removeAttachment(AttachmentId id) {
  requireAlive(id);
  registry.attachments.prepare();
  registry.attachments.remove(id);
  softChanged = true;
}

void World::Impl::flush() {
  if (!softChanged) return;
  std::vector<EngineSoftObject> objects;
  const std::vector<DeformableId> softs = inOrder(registry.softs);
  std::vector<SoftRange> ranges(static_cast<std::size_t>(registry.softs.size()));  // by slot
  const auto meetsOthers = [&](DeformableId id) {
    return (registry.softs[id].model->collides & kCollidesWithSurfaces) != 0;
  };
  const bool surfacesMeet = std::ranges::count_if(softs, meetsOthers) > 1;
  SoftRange next;
  next.vertex = 0;
  for (const DeformableId id : softs) {
    const SoftRecord& r = registry.softs[id];
    objects.push_back({r.model, next, r.range, r.surface, r.before, surfacesMeet});
    ranges[std::size_t(id.index)] = next;
    next.vertex += int(r.model->vertices.size());
    const auto counts = elementCounts(*r.model);
    for (std::size_t k = 0; k < counts.size(); ++k) next.element[k] += counts[k];
    next.edge += int(r.model->edges.size()), next.face += int(r.model->faces.size());
  }
  std::vector<EngineAttachment> attachments;
  const std::vector<AttachmentId> order = inOrder(registry.attachments);
  for (const AttachmentId id : order) {
    const AttachmentRecord& r = registry.attachments[id];
    EngineAttachment a;
    int corner = 0;
    const auto addSide = [&](DeformableId object, const std::vector<int>& vertices,
                             const std::vector<double>& weights, double sign) {
      const SoftRecord& soft = registry.softs[object];
      for (std::size_t i = 0; i < vertices.size(); ++i, ++corner) {
        const SoftModel::Vertex& vertex = soft.model->vertices[std::size_t(vertices[i])];
        a.v[corner] = ranges[std::size_t(object.index)].vertex + vertices[i];
        a.weight[corner] = sign * weights[i];
        if (vertex.mass > 0 && weights[i] != 0) {
          const double mass = vertex.mass / (weights[i] * weights[i]);
          a.mass = a.mass > 0 ? std::min(a.mass, mass) : mass;
        }
        a.length = corner == 0 ? vertex.length : std::min(a.length, vertex.length);
      }
    };
    addSide(r.object, r.def.vertices, r.def.weights, -1);
    a.isVertexVertex = r.otherObject.index >= 0;
    if (a.isVertexVertex) addSide(r.otherObject, r.def.otherVertices, r.def.otherWeights, 1);
    a.body = a.isVertexVertex ? kWorld : r.body.index;
    if (a.body == kWorld)
      a.worldPoint = r.anchor;
    else
      a.anchor = registry.bodies[r.body].frame.pointToEngine(r.anchor);
    a.bound = r.def.breakForce;
    a.compliance = r.def.stiffness == kHard ? 0 : 1 / r.def.stiffness;
    a.previous = r.engineIndex;
    attachments.push_back(a);
  }
  registry.softs.prepare(0), registry.attachments.prepare(0);
  engine->apply(SetDeformables{std::move(objects), std::move(attachments)});
  for (const DeformableId id : softs) {
    SoftRecord& record = registry.softs.edit(id);
    record.range = ranges[std::size_t(id.index)], record.before = nullptr;
  }
  for (std::size_t k = 0; k < order.size(); ++k) registry.attachments.edit(order[k]).engineIndex = int(k);
  softChanged = false;
}

DeformableId World::addDeformable(const Deformable& deformable) {
  const DeformableId id = withMemory("addDeformable",
                                     [&] { return impl_->addSoft(deformable, "deformable"); });
  impl_->pass(inputs::AddDeformable{deformable});
  return id;
}
void World::removeDeformable(DeformableId id) {
  withMemory("removeDeformable", [&] { impl_->removeSoft(id); });
  impl_->pass(inputs::RemoveDeformable{id});
}
bool World::alive(DeformableId id) const { return impl_->registry.softs.alive(id); }
std::vector<DeformableId> World::deformables() const {
  return withMemory("deformables", [&] { return impl_->registry.softs.ids(); });
}
DeformableId World::findDeformable(const std::string& name) const {
  const auto it = impl_->registry.softNames.find(name);
  if (it == impl_->registry.softNames.end())
    throw Error("deformable", "the name of a deformable object", "\"" + name + "\"");
  return it->second;
}
DeformableId World::deformableAt(int sceneIndex) const {
  const std::vector<DeformableId>& ids = impl_->registry.sceneSofts;
  if (sceneIndex < 0 || static_cast<std::size_t>(sceneIndex) >= ids.size())
    throw Error("deformable", "an index below " + std::to_string(ids.size()), std::to_string(sceneIndex));
  return ids[static_cast<std::size_t>(sceneIndex)];
}
const Deformable& World::definition(DeformableId id) const {
  impl_->requireAlive(id);
  return impl_->registry.softs[id].def;
}
int World::vertexCount(DeformableId id) const {
  impl_->requireAlive(id);
  return int(impl_->registry.softs[id].model->vertices.size());
}
std::vector<Vec3> World::positions(DeformableId id) const {
  return withMemory("positions", [&] {
    std::vector<Vec3> out(static_cast<std::size_t>(vertexCount(id)));
    impl_->flush();
    impl_->engine->read(Fetch::Vertices).vertexStates(impl_->registry.softs[id].range.vertex, out, {});
    return out;
  });
}
std::vector<Vec3> World::velocities(DeformableId id) const {
  return withMemory("velocities", [&] {
    std::vector<Vec3> out(static_cast<std::size_t>(vertexCount(id)));
    impl_->flush();
    impl_->engine->read(Fetch::Vertices).vertexStates(impl_->registry.softs[id].range.vertex, {}, out);
    return out;
  });
}
ArrayView World::array(VertexArray which) const {
  checks::enumeration(which, VertexArray::Velocity, "array");
  return withMemory("array", [&] {
    impl_->flush();
    ArrayView view = impl_->engine->array(which);
    view.epoch = impl_->epoch;
    return view;
  });
}
int World::firstVertex(DeformableId id) const {
  impl_->requireAlive(id);
  return withMemory("firstVertex", [&] {
    impl_->flush();
    return impl_->registry.softs[id].range.vertex;
  });
}
std::vector<double> World::masses(DeformableId id) const {
  return withMemory("masses", [&] {
    impl_->requireAlive(id);
    std::vector<double> out;
    for (const SoftModel::Vertex& v : impl_->registry.softs[id].model->vertices) out.push_back(v.mass);
    return out;
  });
}
void World::setVertices(DeformableId id, std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  withMemory("setVertices", [&] {
    const auto count = static_cast<std::size_t>(vertexCount(id));
    if (positions.size() != count || velocities.size() != count)
      throw Error("vertices", std::to_string(count) + " positions and velocities",
                  std::to_string(positions.size()) + " and " + std::to_string(velocities.size()));
    checks::finite(positions, "vertices");
    checks::finite(velocities, "vertices");
    impl_->flush();
    impl_->engine->apply(SetVertices{impl_->registry.softs[id].range.vertex,
                                     {positions.begin(), positions.end()},
                                     {velocities.begin(), velocities.end()}});
  });
  impl_->pass(inputs::SetVertices{id, positions, velocities});
}
void World::applyVertexForce(DeformableId id, int vertex, const Vec3& force) {
  withMemory("applyVertexForce", [&] {
    if (vertex < 0 || vertex >= vertexCount(id))
      throw Error("vertex", "an index below " + std::to_string(vertexCount(id)), std::to_string(vertex));
    checks::finite(force, "force");
    impl_->flush();
    impl_->engine->apply(AddVertexForce{impl_->registry.softs[id].range.vertex + vertex, force});
  });
  impl_->pass(inputs::ApplyVertexForce{id, vertex, force});
}

EngineSoftTargets World::Impl::softTargets() {
  EngineSoftTargets out;
  constexpr int kMembranes = typeIndex<host::Membrane>(host::ElementTypes{}),
                kSprings = typeIndex<host::Spring>(host::ElementTypes{});
  for (const DeformableId id : registry.softs.ids()) {
    const SoftRecord& r = registry.softs[id];
    const SoftModel& m = *r.model;
    const int first = static_cast<int>(out.positions.size());
    out.positions.resize(out.positions.size() + m.vertices.size());
    engine->read(Fetch::Vertices)
        .vertexStates(r.range.vertex, std::span(out.positions).last(m.vertices.size()), {});
    const auto counts = elementCounts(m);
    const auto alive = [&](int type) {
      return engine->read().elementsAlive(type, r.range.element[type], counts[std::size_t(type)]);
    };
    const double radius = m.vertices[0].radius;
    const auto add = [&](std::size_t index, auto&& corners, double thick) {
      EngineSoftPiece piece{id.index, static_cast<int>(index), {-1, -1, -1}, thick};
      int k = 0;
      for (const int v : corners) piece.v[k++] = first + v;
      out.pieces.push_back(piece);
    };
    const std::vector<char> whole = alive(kMembranes), unbroken = alive(kSprings);
    for (std::size_t i = 0; i < m.surface.size(); ++i)
      if (whole.empty() || whole[i]) add(i, m.surface[i], 0);
    for (std::size_t i = 0; m.surface.empty() && i < unbroken.size(); ++i)
      if (unbroken[i]) add(i, m.list<SpringModel>()[i].v, radius);
    for (std::size_t i = 0; m.surface.empty() && unbroken.empty() && i < m.vertices.size(); ++i)
      add(i, std::array{static_cast<int>(i)}, radius);
  }
  return out;
}

World::Surface World::surface(DeformableId id) const {
  return withMemory("surface", [&] {
    Surface out;
    out.id = id;
    out.vertices = positions(id);
    const SoftRecord& r = impl_->registry.softs[id];
    const SoftModel& m = *r.model;
    const auto counts = elementCounts(m);
    const auto alive = [&](int type) {
      return impl_->engine->read().elementsAlive(type, r.range.element[type], counts[std::size_t(type)]);
    };
    constexpr int kMembranes = typeIndex<host::Membrane>(host::ElementTypes{}),
                  kSprings = typeIndex<host::Spring>(host::ElementTypes{});
    const std::vector<char> whole = alive(kMembranes);
    for (std::size_t i = 0; i < m.surface.size(); ++i)
      if (whole.empty() || whole[i]) out.triangles.push_back(m.surface[i]);
    const std::vector<char> unbroken = alive(kSprings);
    for (std::size_t i = 0; i < unbroken.size(); ++i)
      if (unbroken[i]) out.segments.push_back(m.list<SpringModel>()[i].v);
    out.radius = m.vertices[0].radius;
    out.spheres = std::holds_alternative<ParticlesDef>(r.def);
    return out;
  });
}

AttachmentId World::addAttachment(const AttachmentDef& attachment, DeformableId object, BodyId body,
                                  DeformableId otherObject) {
  const AttachmentId id = withMemory("addAttachment", [&] {
    return impl_->addAttachment(attachment, object, body, otherObject, "attachment");
  });
  impl_->pass(inputs::AddAttachment{attachment, object, body, otherObject});
  return id;
}
void World::removeAttachment(AttachmentId id) {
  withMemory("removeAttachment", [&] { impl_->removeAttachment(id); });
  impl_->pass(inputs::RemoveAttachment{id});
}
bool World::alive(AttachmentId id) const { return impl_->registry.attachments.alive(id); }
std::vector<AttachmentId> World::attachments() const {
  return withMemory("attachments", [&] { return impl_->registry.attachments.ids(); });
}
World::AttachmentEnds World::endsOf(AttachmentId id) const {
  impl_->requireAlive(id);
  const AttachmentRecord& record = impl_->registry.attachments[id];
  return {record.object, record.otherObject, record.body, record.anchor};
}
JointState World::state(AttachmentId id) const {
  return withMemory("state", [&] {
    impl_->requireAlive(id);
    impl_->flush();
    return impl_->engine->read().attachmentState(impl_->registry.attachments[id].engineIndex);
  });
}

std::vector<VertexContact> World::vertexContacts() const {
  return withMemory("vertexContacts", [&] {
    impl_->flush();
    const Registry& r = impl_->registry;
    const std::vector<DeformableId> order = inOrder(r.softs);
    // the object of a vertex: the last one that starts at or before it
    const auto owner = [&](int vertex, int& local) {
      const auto next = std::upper_bound(order.begin(), order.end(), vertex, [&](int v, DeformableId id) {
        return v < r.softs[id].range.vertex;
      });
      const DeformableId id = *(next - 1);
      local = vertex - r.softs[id].range.vertex;
      return id;
    };
    std::vector<VertexContact> out;
    for (const EngineVertexContact& c : impl_->engine->read().vertexContacts()) {
      VertexContact v{{}, -1, {}, {}, -1, c.normal, c.depth, c.force};
      v.object = owner(c.vertex, v.vertex);
      if (c.otherVertex >= 0) v.otherObject = owner(c.otherVertex, v.otherVertex);
      if (c.body >= 0) v.body = r.bodies.at(c.body).value_or(BodyId{});
      out.push_back(v);
    }
    return out;
  });
}

}  // namespace rubble

#include "world/batch.h"

#include <algorithm>
#include <cstring>

#include "forces/joint_record.h"
#include "world/joint_build.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

/// Adds the numbers of `count` objects to a place in the tables.
void advance(SoftRange& at, const SoftRange& count) {
  at.vertex += count.vertex, at.edge += count.edge, at.face += count.face;
  for (int k = 0; k < SoftRange::kElementTypes; ++k) at.element[k] += count.element[k];
}

SoftRange sizeOf(const SoftModel& model) {
  SoftRange size;
  size.vertex = static_cast<int>(model.vertices.size());
  size.edge = static_cast<int>(model.edges.size()), size.face = static_cast<int>(model.faces.size());
  std::ranges::copy(elementCounts(model), size.element);
  return size;
}

/// A number above `least` that is not in use: the lowest of the spare ones, or the next new one.
int takeSpare(std::vector<int>& spare, int& next, int least = -1) {
  std::ranges::sort(spare);
  const auto found = std::ranges::upper_bound(spare, least);
  if (found == spare.end()) return next++;
  const int number = *found;
  spare.erase(found);
  return number;
}

template <class T> T& slotAt(std::vector<T>& list, int i) { return list[static_cast<std::size_t>(i)]; }

}  // namespace

std::vector<std::byte> WorldSnapshot::bytes() const {
  std::vector<std::byte> out = state;
  const auto* dt = reinterpret_cast<const std::byte*>(&previousDt);
  out.insert(out.end(), dt, dt + sizeof previousDt);
  return out;
}

Batch::Batch(std::unique_ptr<Engine> engine, const Params& params, std::shared_ptr<const int> family)
    : engine_(std::move(engine)),
      family_(std::move(family)),
      jointSlots_(static_cast<std::size_t>(engineJointTypes())),
      spareJoints_(jointSlots_.size()) {
  if (!engine_->batch()) throw Error("backend", "one that can hold many worlds", "another");
  setParams(params);
}

void Batch::setParams(const Params& params) {
  if (params.sortInterval != 0)
    throw Error("sortInterval", "0 for many worlds", std::to_string(params.sortInterval));
  const bool changed = params_ != params;
  params_ = params;
  wakesAll_ |= changed && !members_.empty();
  EngineSettings settings;
  settings.params = params;
  engine_->configure(settings);
}

int Batch::addWorld() {
  Member& member = members_.emplace_back();
  member.joints.resize(jointSlots_.size());
  layoutChanged_ = planesChanged_ = true;
  member.first.vertex = member.count.vertex = 0;
  return count() - 1;
}

void Batch::configure(int world, const EngineSettings& settings) {
  if (settings.params != params_)
    throw Error("params", "those of all worlds: Worlds::setParams changes them", "others");
  settings_[world] = settings;
}

int Batch::surfaceOf(const Material& material) {
  const auto found = std::ranges::find(surfaces_, material);
  if (found != surfaces_.end()) return static_cast<int>(found - surfaces_.begin());
  surfaces_.push_back(material);
  return static_cast<int>(surfaces_.size()) - 1;
}

void Batch::flushRules() {
  SetSurfaces edit{surfaces_};
  for (int world = 0; world < count(); ++world) {
    WorldReferences& own = slotAt(members_, world).references;
    const auto kindInTables = [&](int kind) {
      return materialKind(surfaces_, slotAt(own.surfaces, kind - 1).name);
    };
    for (EngineMaterialRule rule : own.rules) {
      const int low = kindInTables(rule.low), high = kindInTables(rule.high);
      rule.low = std::min(low, high), rule.high = std::max(low, high);
      rule.world = world;
      edit.rules.push_back(rule);
    }
  }
  sortRules(edit.rules);
  if (edit.rules != rules_) engine_->apply(edit);
  rules_ = std::move(edit.rules);
  rulesChanged_ = false;
}

int Batch::placeShape(const AddShape& shape) {
  const auto [found, isNew] = shapes_.try_emplace(shape.shape);
  ShapeInTables& own = found->second;
  if (isNew) {
    own.place = space_.take(*shape.shape);
    engine_->apply(AddShape{shape.shape, shape.partSurfaces, own.place});
  }
  ++own.uses;
  return own.place.indices;
}

void Batch::dropShape(const std::shared_ptr<const CookedShape>& shape) {
  const auto found = shapes_.find(shape);
  if (--found->second.uses > 0) return;
  space_.prepare(1);
  space_.give(found->second.place, *shape);
  shapes_.erase(found);
}

/// Applies an edit in the numbers of a world to the tables.
struct Batch::Translate {
  Batch& batch;
  int world;
  Member& member;

  int body(int id) const { return id < 0 ? id : slotAt(member.bodies, id); }
  static int beginOf(const AddShape& shape) { return shape.place.indices; }
  template <class Ids> void bodies(Ids& ids) const {
    for (int& id : ids) id = body(id);
  }
  int surface(int index) const { return index < 0 ? index : slotAt(member.surfaces, index); }
  /// Places a shape of the world in the tables.
  void place(AddShape shape) const {
    for (int& part : shape.partSurfaces) part = surface(part);
    const WorldShape placed{shape.place.indices, batch.placeShape(shape),
                            static_cast<int>(shape.shape->indices.size())};
    member.shapes.insert(std::ranges::upper_bound(member.shapes, placed.base, {}, &WorldShape::base), placed);
    batch.layoutChanged_ = true;
  }

  void operator()(SetBody e) const {
    if (e.id >= static_cast<int>(member.bodies.size())) {
      member.bodies.push_back(takeSpare(batch.spareBodies_, batch.bodies_));
      batch.layoutChanged_ = true;
    }
    e.number = e.id, e.world = world, e.id = body(e.id);
    e.body.surface = surface(e.body.surface);
    if (int& data = e.body.shape.data; data >= 0) {
      const auto after = std::ranges::upper_bound(member.shapes, data, {}, &WorldShape::base);
      data += (after - 1)->baseInTables - (after - 1)->base;
    }
    batch.engine_->apply(e);
  }
  void operator()(const AddBodies& e) const {
    for (int k = 0; k < e.count; ++k) (*this)(e.at(k));
  }
  void operator()(SetBodyState e) const { e.id = body(e.id), batch.engine_->apply(e); }
  void operator()(AddForce e) const { e.id = body(e.id), batch.engine_->apply(e); }
  void operator()(AddVelocity e) const { e.id = body(e.id), batch.engine_->apply(e); }
  void operator()(ForgetContacts e) const {
    bodies(e.ids);
    std::ranges::sort(e.ids);
    batch.engine_->apply(e);
  }
  void operator()(const AddShape& e) const {
    std::vector<AddShape>& own = member.references.shapes;
    own.insert(std::ranges::upper_bound(own, e.place.indices, {}, beginOf), e);
    place(e);
  }
  void operator()(const DropShape& e) const {
    std::vector<AddShape>& own = member.references.shapes;
    const auto at = std::ranges::lower_bound(own, e.place.indices, {}, beginOf);
    batch.dropShape(at->shape);
    member.shapes.erase(member.shapes.begin() + (at - own.begin()));
    own.erase(at);
    batch.layoutChanged_ = true;
  }
  void operator()(const SetSurfaces& e) const {
    WorldReferences& own = member.references;
    const std::size_t before = batch.surfaces_.size();
    const std::size_t kept = own.surfaces.size();
    const bool extends = kept <= e.surfaces.size() &&
                         std::ranges::equal(own.surfaces, std::span(e.surfaces).first(kept));
    if (!extends) member.surfaces.clear();
    batch.rulesChanged_ |= own.rules != e.rules || (!extends && !e.rules.empty());
    batch.layoutChanged_ |= !extends || member.surfaces.size() < e.surfaces.size();
    own.surfaces = e.surfaces, own.rules = e.rules;
    for (std::size_t k = member.surfaces.size(); k < e.surfaces.size(); ++k)
      member.surfaces.push_back(batch.surfaceOf(e.surfaces[k]));
    // bodies need their materials at once
    if (batch.surfaces_.size() > before) batch.engine_->apply(SetSurfaces{batch.surfaces_, batch.rules_});
  }
  void operator()(SetPlanes e) const {
    member.references.planes = std::move(e.ids);
    batch.planesChanged_ = true;
  }
  void operator()(SetJoint e) const {
    const int type = static_cast<int>(e.joint.type);
    std::vector<int>& slots = slotAt(member.joints, type);
    if (e.slot >= static_cast<int>(slots.size())) {
      // the order of joints in a world is that of their slots
      slots.push_back(takeSpare(slotAt(batch.spareJoints_, type), slotAt(batch.jointSlots_, type),
                                slots.empty() ? -1 : slots.back()));
      batch.layoutChanged_ = true;
    }
    e.slot = slotAt(slots, e.slot);
    for (int* end : {&e.joint.a, &e.joint.b, &e.joint.frameBodyA, &e.joint.frameBodyB}) *end = body(*end);
    batch.engine_->apply(e);
  }
  void operator()(SetExcluded e) const {
    const std::pair<int, int> pair = std::minmax(e.a, e.b);
    if (e.excluded)
      member.references.excluded.insert(pair);
    else
      member.references.excluded.erase(pair);
    e.world = world;
    batch.engine_->apply(e);
  }
  void operator()(SetDeformables e) const {
    WorldReferences& own = member.references;
    // where the tables have an object or attachment of the list before
    for (EngineSoftObject& object : e.objects) {
      const int from = object.previous.vertex;
      object.previous.vertex = -1;
      if (from < 0) continue;
      for (const EngineSoftObject& before : own.objects) {
        if (before.at.vertex != from || before.model != (object.before ? object.before : object.model))
          continue;
        object.previous = before.previous;
        if (before.before) object.before = before.before;
      }
    }
    for (EngineAttachment& a : e.attachments)
      if (a.previous >= 0) a.previous = slotAt(own.attachments, a.previous).previous;
    own.objects = std::move(e.objects), own.attachments = std::move(e.attachments);
    batch.softsChanged_ = true;
  }
  void operator()(SetVertices e) const {
    batch.flush();
    e.first += member.first.vertex;
    batch.engine_->apply(e);
  }
  void operator()(AddVertexForce e) const {
    batch.flush();
    e.vertex += member.first.vertex;
    batch.engine_->apply(e);
  }
};

void Batch::apply(int world, const Edit& edit) {
  std::visit(Translate{*this, world, slotAt(members_, world)}, edit);
}

void Batch::flushSofts() {
  std::vector<EngineSoftObject> objects;
  std::vector<EngineAttachment> attachments;
  SoftRange next;
  next.vertex = 0;
  for (Member& member : members_) {
    member.first = next;
    for (EngineSoftObject& object : member.references.objects) {
      EngineSoftObject& placed = objects.emplace_back(object);
      placed.at = next;
      if (placed.surface >= 0) placed.surface = slotAt(member.surfaces, placed.surface);
      object.previous = next, object.before = nullptr;
      advance(next, sizeOf(*object.model));
    }
    member.count = next;
    member.count.vertex -= member.first.vertex, member.count.edge -= member.first.edge,
        member.count.face -= member.first.face;
    for (int k = 0; k < SoftRange::kElementTypes; ++k) member.count.element[k] -= member.first.element[k];
    member.firstAttachment = static_cast<int>(attachments.size());
    member.attachments = static_cast<int>(member.references.attachments.size());
    for (EngineAttachment& a : member.references.attachments) {
      EngineAttachment& placed = attachments.emplace_back(a);
      for (int& v : placed.v)
        if (v >= 0) v += member.first.vertex;
      if (placed.body >= 0) placed.body = slotAt(member.bodies, placed.body);
      a.previous = static_cast<int>(attachments.size()) - 1;
    }
  }
  engine_->apply(SetDeformables{std::move(objects), std::move(attachments)});
  softsChanged_ = false, layoutChanged_ = true;
}

void Batch::flush() {
  if (rulesChanged_) flushRules();
  if (softsChanged_) flushSofts();
  if (layoutChanged_) {
    std::vector<WorldLayout> layouts;
    for (const Member& m : members_)
      layouts.push_back(
          {m.bodies, m.first, m.count, m.firstAttachment, m.attachments, m.joints, m.shapes, m.surfaces});
    worlds().setLayout(layouts, spareBodies_);
    layoutChanged_ = false, rowsChanged_ = true;
  }
  for (const auto& [world, settings] : std::exchange(settings_, {})) {
    WorldSettings own = worlds().settingsOf(world);
    own.gravity = settings.gravity, own.wakeAll |= settings.wakeAll;
    worlds().setSettings(world, own);
  }
  // each world wakes in its next step, which may be another one
  for (int world = 0; wakesAll_ && world < count(); ++world) {
    WorldSettings own = worlds().settingsOf(world);
    own.wakeAll = true;
    worlds().setSettings(world, own);
  }
  wakesAll_ = false;
  if (planesChanged_) {
    SetPlanes planes;
    for (const Member& member : members_) {
      planes.firstOfWorld.push_back(static_cast<int>(planes.ids.size()));
      for (const int id : member.references.planes)
        planes.ids.push_back(member.bodies[static_cast<std::size_t>(id)]);
    }
    planes.firstOfWorld.push_back(static_cast<int>(planes.ids.size()));
    engine_->apply(planes);
    planesChanged_ = false;
  }
}

std::shared_ptr<const WorldSnapshot> Batch::snapshot(int world) {
  flush();
  const Member& member = slotAt(members_, world);
  auto out = std::make_shared<WorldSnapshot>();
  out->family = family_;
  out->state = worlds().takeWorld(world);
  out->previousDt = worlds().settingsOf(world).previousDt;
  out->bodies = member.bodies.size();
  for (const std::vector<int>& slots : member.joints) out->joints.push_back(slots.size());
  out->references = member.references;
  return out;
}

const WorldSnapshot& Batch::own(const EngineSnapshot& snapshot) const {
  const auto* found = dynamic_cast<const WorldSnapshot*>(&snapshot);
  if (!found || found->family != family_)
    throw Error("snapshot", "one of a world of the same batch", "another");
  return *found;
}

void Batch::takeReferences(int world, const WorldSnapshot& snapshot) {
  Member& member = slotAt(members_, world);
  const Translate translate{*this, world, member};
  while (member.bodies.size() < snapshot.bodies)
    translate(SetBody{static_cast<int>(member.bodies.size()), {}});
  while (member.bodies.size() > snapshot.bodies) {
    translate(SetBody{static_cast<int>(member.bodies.size()) - 1, {}});
    spareBodies_.push_back(member.bodies.back());
    member.bodies.pop_back();
    layoutChanged_ = true;
  }
  for (std::size_t type = 0; type < snapshot.joints.size(); ++type) {
    std::vector<int>& slots = member.joints[type];
    while (slots.size() > snapshot.joints[type]) {
      SetJoint none{static_cast<int>(slots.size()) - 1, {}};
      none.joint.type = static_cast<int>(type);
      translate(none);
      spareJoints_[type].push_back(slots.back());
      slots.pop_back();
      layoutChanged_ = true;
    }
    while (member.joints[type].size() < snapshot.joints[type]) {
      SetJoint none{static_cast<int>(member.joints[type].size()), {}};
      none.joint.type = static_cast<int>(type);
      translate(none);
    }
  }
  const WorldReferences &to = snapshot.references, before = member.references;
  for (const auto& [a, b] : before.excluded)
    if (!to.excluded.contains({a, b})) translate(SetExcluded{a, b, false});
  for (const auto& [a, b] : to.excluded)
    if (!before.excluded.contains({a, b})) translate(SetExcluded{a, b, true});
  planesChanged_ |= before.planes != to.planes;
  WorldReferences& now = member.references;
  now.planes = to.planes;
  if (before.surfaces != to.surfaces) translate(SetSurfaces{to.surfaces, to.rules});
  const auto sameShapes = [](const AddShape& a, const AddShape& b) {
    return a.shape == b.shape && a.place == b.place;
  };
  if (!std::ranges::equal(before.shapes, to.shapes, sameShapes)) {
    now.shapes = to.shapes;
    member.shapes.clear();
    for (const AddShape& shape : to.shapes) translate.place(shape);
    for (const AddShape& shape : before.shapes) dropShape(shape.shape);
  }
  const auto sameModels = [](const EngineSoftObject& a, const EngineSoftObject& b) {
    return a.model == b.model;
  };
  const auto sameEnds = [](const EngineAttachment& a, const EngineAttachment& b) {
    return std::ranges::equal(a.v, b.v) && a.body == b.body;
  };
  if (std::ranges::equal(before.objects, to.objects, sameModels) &&
      std::ranges::equal(before.attachments, to.attachments, sameEnds))
    return;
  now.objects = to.objects, now.attachments = to.attachments;
  for (EngineSoftObject& object : now.objects) object.previous.vertex = -1;
  for (EngineAttachment& a : now.attachments) a.previous = -1;
  softsChanged_ = true;
}

void Batch::restore(std::span<const int> list, std::span<const WorldSnapshot* const> snapshots) {
  std::vector<std::pair<int, const WorldSnapshot*>> changes;
  for (std::size_t k = 0; k < list.size(); ++k) changes.emplace_back(list[k], snapshots[k]);
  std::ranges::sort(changes);
  for (const auto& [world, snapshot] : changes) takeReferences(world, *snapshot);
  flush();
  std::vector<int> order;
  std::vector<std::span<const std::byte>> states;
  for (const auto& [world, snapshot] : changes) {
    order.push_back(world), states.emplace_back(snapshot->state);
    WorldSettings settings = worlds().settingsOf(world);
    settings.previousDt = snapshot->previousDt, settings.wakeAll = false;
    worlds().setSettings(world, settings);
  }
  worlds().putWorlds(order, states);
}

}  // namespace rubble

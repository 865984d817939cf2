#include "world/batch.h"

#include <algorithm>

#include "forces/joint_record.h"
#include "world/batch_translation.h"
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

/// A number above `least` that is not in use: the lowest of the spare ones, or the next new one. There will
/// be room to give all of them back.
int takeSpare(std::vector<int>& spare, int& next, int least = -1) {
  std::ranges::sort(spare);
  const auto found = std::ranges::upper_bound(spare, least);
  if (found == spare.end()) {
    reserveMore(spare, next + 1 - static_cast<int>(spare.size()));
    return next++;
  }
  const int number = *found;
  spare.erase(found);
  return number;
}

}  // namespace

Batch::Batch(std::unique_ptr<Engine> engine, const Params& params, std::shared_ptr<const int> family)
    : engine_(std::move(engine)), family_(std::move(family)) {
  own_.jointSlots.resize(static_cast<std::size_t>(engineJointTypes()));
  own_.spareJoints.resize(own_.jointSlots.size());
  if (!engine_->batch()) throw Error("backend", "one that can hold many worlds", "another");
  setParams(params);
}

void Batch::setParams(const Params& params) {
  if (params.sortInterval != 0)
    throw Error("sortInterval", "0 for many worlds", std::to_string(params.sortInterval));
  const bool changed = params_ != params;
  EngineSettings settings;
  settings.params = params;
  engine_->configure(settings);
  params_ = params;
  wakesAll_ |= changed && !own_.members.empty();
}

int Batch::addWorld() {
  Member member;
  member.joints.resize(own_.jointSlots.size());
  member.first.vertex = member.count.vertex = 0;
  own_.members.push_back(std::move(member));
  own_.changed.layout = own_.changed.planes = true;
  return count() - 1;
}

void Batch::dropWorld() noexcept {
  Member& member = own_.members.back();
  const int world = count() - 1;
  // an engine on a host needs no memory for these
  try {
    for (const auto& [a, b] : member.references.excluded) engine_->apply(SetExcluded{a, b, false, world});
    for (std::size_t type = 0; type < member.joints.size(); ++type)
      for (const int slot : member.joints[type]) {
        SetJoint none{slot, {}};
        none.joint.type = static_cast<int>(type);
        engine_->apply(none);
      }
    for (const int body : member.bodies) engine_->apply(SetBody{body, {}});
  } catch (const std::bad_alloc&) {
  }
  for (std::size_t type = 0; type < member.joints.size(); ++type)
    for (const int slot : member.joints[type]) own_.spareJoints[type].push_back(slot);
  own_.spareBodies.insert(own_.spareBodies.end(), member.bodies.begin(), member.bodies.end());
  for (const AddShape& shape : member.references.shapes) dropShape(shape.shape);
  own_.changed = {true, true, true, true, own_.changed.settings};
  own_.members.pop_back();
}

void Batch::configure(int world, const EngineSettings& settings) {
  if (settings.params != params_)
    throw Error("params", "those of all worlds: Worlds::setParams changes them", "others");
  slotAt(own_.members, world).settings = settings;
  own_.changed.settings = true;
}

int Batch::takeBody() { return takeSpare(own_.spareBodies, own_.bodies); }
int Batch::takeJoint(int type, int least) {
  return takeSpare(slotAt(own_.spareJoints, type), slotAt(own_.jointSlots, type), least);
}

int Batch::surfaceOf(const Material& material) {
  const auto found = std::ranges::find(own_.surfaces, material);
  if (found != own_.surfaces.end()) return static_cast<int>(found - own_.surfaces.begin());
  own_.surfaces.push_back(material);
  return static_cast<int>(own_.surfaces.size()) - 1;
}

ShapePlace Batch::placeShape(const AddShape& shape, std::vector<Edit>& edits) {
  if (const auto found = own_.shapes.find(shape.shape); found != own_.shapes.end()) {
    ++found->second.uses;
    return found->second.place;
  }
  own_.space.prepare(static_cast<int>(own_.shapes.size()) + 1);
  ShapeInTables& placed = own_.shapes[shape.shape];
  placed = {own_.space.take(*shape.shape), 1};
  Undo undo([&] { dropShape(shape.shape); });
  edits.push_back(AddShape{shape.shape, shape.partSurfaces, placed.place});
  undo.keep();
  return placed.place;
}

void Batch::dropShape(const std::shared_ptr<const CookedShape>& shape) noexcept {
  const auto found = own_.shapes.find(shape);
  if (--found->second.uses > 0) return;
  own_.space.give(found->second.place, *shape);
  own_.shapes.erase(found);
}

void Batch::apply(int world, std::span<const Edit> edits) {
  // as most calls between steps are: they need no list
  if (edits.size() == 1) {
    const auto applied = [&]<class E>(const E& edit) {
      if constexpr (std::is_same_v<E, SetBodyState> || std::is_same_v<E, AddForce> ||
                    std::is_same_v<E, AddVelocity>) {
        E inTables = edit;
        inTables.id = slotAt(rowsOf(world), edit.id);
        engine_->apply(inTables);
        return true;
      }
      return false;
    };
    if (std::visit(applied, edits[0])) return;
  }
  const auto isOfVertices = [](const Edit& edit) {
    return std::holds_alternative<SetVertices>(edit) || std::holds_alternative<AddVertexForce>(edit);
  };
  if (std::ranges::any_of(edits, isOfVertices)) flush();
  Translation translation(*this, world);
  for (const Edit& edit : edits) translation.add(edit);
  if (!translation.edits().empty()) engine_->apply(translation.edits());
  translation.keep();
}

void Batch::flushRules() {
  SetSurfaces edit{own_.surfaces};
  for (int world = 0; world < count(); ++world) {
    WorldReferences& own = slotAt(own_.members, world).references;
    const auto kindInTables = [&](int kind) {
      return materialKind(own_.surfaces, slotAt(own.surfaces, kind - 1).name);
    };
    for (EngineMaterialRule rule : own.rules) {
      const int low = kindInTables(rule.low), high = kindInTables(rule.high);
      rule.low = std::min(low, high), rule.high = std::max(low, high);
      rule.world = world;
      edit.rules.push_back(rule);
    }
  }
  sortRules(edit.rules);
  if (edit.rules != own_.rules) engine_->apply(edit);
  own_.rules = std::move(edit.rules);
  own_.changed.rules = false;
}

void Batch::flushSofts() {
  struct Place {
    SoftRange first, count;
    int firstAttachment, attachments;
  };
  std::vector<Place> places;
  std::vector<EngineSoftObject> objects;
  std::vector<EngineAttachment> attachments;
  SoftRange next;
  next.vertex = 0;
  for (const Member& member : own_.members) {
    const WorldReferences& own = member.references;
    const SoftRange first = next;
    for (const EngineSoftObject& object : own.objects) {
      EngineSoftObject& placed = objects.emplace_back(object);
      placed.at = next;
      if (placed.surface >= 0) placed.surface = slotAt(member.surfaces, placed.surface);
      advance(next, sizeOf(*object.model));
    }
    SoftRange size = next;
    size.vertex -= first.vertex, size.edge -= first.edge, size.face -= first.face;
    for (int k = 0; k < SoftRange::kElementTypes; ++k) size.element[k] -= first.element[k];
    places.push_back(
        {first, size, static_cast<int>(attachments.size()), static_cast<int>(own.attachments.size())});
    for (const EngineAttachment& a : own.attachments) {
      EngineAttachment& placed = attachments.emplace_back(a);
      for (int& v : placed.v)
        if (v >= 0) v += first.vertex;
      if (placed.body >= 0) placed.body = slotAt(member.bodies, placed.body);
    }
  }
  engine_->apply(SetDeformables{objects, std::move(attachments)});

  auto object = objects.begin();
  for (std::size_t w = 0; w < places.size(); ++w) {
    Member& member = own_.members[w];
    member.first = places[w].first, member.count = places[w].count;
    member.firstAttachment = places[w].firstAttachment, member.attachments = places[w].attachments;
    for (EngineSoftObject& own : member.references.objects) own.previous = object++->at, own.before = nullptr;
    for (int k = 0; k < member.attachments; ++k)
      slotAt(member.references.attachments, k).previous = member.firstAttachment + k;
  }
  own_.changed.softs = false, own_.changed.layout = true;
}

void Batch::flushPlanes() {
  SetPlanes planes;
  for (const Member& member : own_.members) {
    planes.firstOfWorld.push_back(static_cast<int>(planes.ids.size()));
    for (const int id : member.references.planes) planes.ids.push_back(slotAt(member.bodies, id));
  }
  planes.firstOfWorld.push_back(static_cast<int>(planes.ids.size()));
  engine_->apply(planes);
  own_.changed.planes = false;
}

void Batch::flush() {
  if (own_.changed.rules) flushRules();
  if (own_.changed.softs) flushSofts();
  if (own_.changed.layout) {
    std::vector<WorldLayout> layouts;
    for (const Member& m : own_.members)
      layouts.push_back(
          {m.bodies, m.first, m.count, m.firstAttachment, m.attachments, m.joints, m.shapes, m.surfaces});
    worlds().setLayout(layouts, own_.spareBodies);
    own_.changed.layout = false, rowsChanged_ = true;
  }
  // each world wakes in its next step, which may be another one
  for (int world = 0; (own_.changed.settings || wakesAll_) && world < count(); ++world) {
    std::optional<EngineSettings>& given = slotAt(own_.members, world).settings;
    if (!given && !wakesAll_) continue;
    WorldSettings own = worlds().settingsOf(world);
    if (given) own.gravity = given->gravity, own.wakeAll |= given->wakeAll;
    own.wakeAll |= wakesAll_;
    worlds().setSettings(world, own);
    given.reset();
  }
  own_.changed.settings = wakesAll_ = false;
  if (own_.changed.planes) flushPlanes();
}

}  // namespace rubble

// Snapshots of a world of a batch.
#include <algorithm>

#include "world/batch_translation.h"

namespace rubble {

namespace {

bool sameShapesOf(const WorldReferences& a, const WorldReferences& b) {
  return std::ranges::equal(a.shapes, b.shapes, [](const AddShape& x, const AddShape& y) {
    return x.shape == y.shape && x.place == y.place;
  });
}
bool sameSoftsOf(const WorldReferences& a, const WorldReferences& b) {
  const auto sameModels = [](const EngineSoftObject& x, const EngineSoftObject& y) {
    return x.model == y.model;
  };
  const auto sameEnds = [](const EngineAttachment& x, const EngineAttachment& y) {
    return std::ranges::equal(x.v, y.v) && x.body == y.body;
  };
  return std::ranges::equal(a.objects, b.objects, sameModels) &&
         std::ranges::equal(a.attachments, b.attachments, sameEnds);
}
bool sameSurfacesOf(const WorldReferences& a, const WorldReferences& b) {
  return a.surfaces == b.surfaces && a.rules == b.rules;
}

}  // namespace

std::vector<std::byte> WorldSnapshot::bytes() const {
  std::vector<std::byte> out = state;
  const auto* dt = reinterpret_cast<const std::byte*>(&previousDt);
  out.insert(out.end(), dt, dt + sizeof previousDt);
  return out;
}

std::shared_ptr<const WorldSnapshot> Batch::snapshot(int world) {
  flush();
  const Member& member = slotAt(own_.members, world);
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

bool Batch::sameElements(int world, const WorldSnapshot& snapshot) const {
  const Member& member = slotAt(own_.members, world);
  const WorldReferences &own = member.references, &to = snapshot.references;
  const auto sameCount = [](const std::vector<int>& slots, std::size_t count) {
    return slots.size() == count;
  };
  return member.bodies.size() == snapshot.bodies &&
         std::ranges::equal(member.joints, snapshot.joints, sameCount) && own.excluded == to.excluded &&
         own.planes == to.planes && sameSurfacesOf(own, to) && sameShapesOf(own, to) && sameSoftsOf(own, to);
}

void Batch::takeElements(int world, const WorldSnapshot& snapshot) {
  Member& member = slotAt(own_.members, world);
  Translation translation(*this, world);
  const WorldReferences &to = snapshot.references, &now = member.references;
  const auto bodyCount = static_cast<int>(member.bodies.size());
  for (int k = bodyCount; k < static_cast<int>(snapshot.bodies); ++k) translation(SetBody{k, {}});
  for (int k = bodyCount; k > static_cast<int>(snapshot.bodies); --k) translation(SetBody{k - 1, {}});
  for (std::size_t type = 0; type < snapshot.joints.size(); ++type) {
    const auto joint = [&](std::size_t slot) {
      SetJoint none{static_cast<int>(slot), {}};
      none.joint.type = static_cast<int>(type);
      translation(none);
    };
    const std::size_t had = member.joints[type].size();
    for (std::size_t k = had; k > snapshot.joints[type]; --k) joint(k - 1);
    for (std::size_t k = had; k < snapshot.joints[type]; ++k) joint(k);
  }
  const std::set<std::pair<int, int>> excluded = now.excluded;
  for (const auto& [a, b] : excluded)
    if (!to.excluded.contains({a, b})) translation(SetExcluded{a, b, false});
  for (const auto& [a, b] : to.excluded)
    if (!excluded.contains({a, b})) translation(SetExcluded{a, b, true});
  if (now.planes != to.planes) translation(SetPlanes{to.planes});
  if (!sameSurfacesOf(now, to)) translation(SetSurfaces{to.surfaces, to.rules});
  if (!sameShapesOf(now, to)) translation.placeAll(to.shapes);
  if (!sameSoftsOf(now, to)) {
    SetDeformables softs{to.objects, to.attachments};
    for (EngineSoftObject& object : softs.objects) object.previous.vertex = -1;
    for (EngineAttachment& a : softs.attachments) a.previous = -1;
    translation(std::move(softs));
  }
  if (!translation.edits().empty()) engine_->apply(translation.edits());
  translation.keep();
  // there is room for all that are spare
  for (; member.bodies.size() > snapshot.bodies; member.bodies.pop_back(), own_.changed.layout = true)
    own_.spareBodies.push_back(member.bodies.back());
  for (std::size_t type = 0; type < snapshot.joints.size(); ++type)
    for (std::vector<int>& slots = member.joints[type]; slots.size() > snapshot.joints[type];
         slots.pop_back(), own_.changed.layout = true)
      own_.spareJoints[type].push_back(slots.back());
}

std::unique_ptr<Batch::Restoring> Batch::prepareToRestore(std::span<const int> list,
                                                          std::span<const WorldSnapshot* const> snapshots) {
  flush();
  std::unique_ptr<Restoring> out(new Restoring(*this));
  for (std::size_t k = 0; k < list.size(); ++k) out->changes_.emplace_back(list[k], snapshots[k]);
  std::ranges::sort(out->changes_);
  const auto keepsElements = [&](const auto& change) { return sameElements(change.first, *change.second); };
  if (!std::ranges::all_of(out->changes_, keepsElements)) {
    std::function<void()> putBack = worlds().backup();
    Records before = own_;
    before.makeRoom();
    out->before_ = std::move(before);
    out->putBack_ = std::move(putBack);
    for (const auto& [world, snapshot] : out->changes_) takeElements(world, *snapshot);
    flush();
  }
  std::vector<int> order;
  std::vector<std::span<const std::byte>> states;
  for (const auto& [world, snapshot] : out->changes_)
    order.push_back(world), states.emplace_back(snapshot->state);
  out->put_ = worlds().prepareToPut(order, states);
  return out;
}

void Batch::Restoring::commit() {
  before_.reset();
  for (const auto& [world, snapshot] : changes_) {
    WorldSettings settings = batch_.worlds().settingsOf(world);
    settings.previousDt = snapshot->previousDt, settings.wakeAll = false;
    batch_.worlds().setSettings(world, settings);
  }
  put_();
}

Batch::Restoring::~Restoring() {
  if (!before_ || !putBack_) return;
  putBack_();
  Records& own = batch_.own_;
  before_->rules = std::move(own.rules);  // the tables keep these until flush()
  own = std::move(*before_);
  own.changed.layout = own.changed.planes = own.changed.rules = true;
  batch_.rowsChanged_ = true;
}

}  // namespace rubble

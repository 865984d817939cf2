#pragma once
/// Edits of a world of a batch in the numbers of the tables.
#include <algorithm>

#include "world/batch.h"
#include "world/world_impl.h"

namespace rubble {

/// Edits in the numbers of a world, in those of the tables. What they change in the records of the batch is
/// taken back at the end of its life, unless keep() was called.
class Batch::Translation {
 public:
  Translation(Batch& batch, int world)
      : batch_(batch),
        own_(batch.own_),
        world_(world),
        member_(slotAt(own_.members, world)),
        changedBefore_(own_.changed),
        bodiesBefore_(own_.bodies),
        ownBodiesBefore_(member_.bodies.size()),
        surfacesBefore_(own_.surfaces.size()) {}
  ~Translation() {
    if (!kept_) takeBack();
  }
  Translation(const Translation&) = delete;
  Translation& operator=(const Translation&) = delete;

  void add(const Edit& edit) { std::visit(*this, edit); }
  std::span<const Edit> edits() const { return edits_; }
  void keep() noexcept {
    for (const std::shared_ptr<const CookedShape>& shape : dropped_) batch_.dropShape(shape);
    kept_ = true;
  }

  void operator()(SetBody e) {
    if (e.id >= static_cast<int>(member_.bodies.size())) addBody();
    translate(e);
    edits_.push_back(std::move(e));
  }
  void operator()(const AddBodies& e) {
    while (static_cast<int>(member_.bodies.size()) < e.ids) addBody();
    edits_.push_back(AddBodies{own_.bodies, e.count, [this, at = e.at](int k) {
                                 SetBody body = at(k);
                                 translate(body);
                                 return body;
                               }});
  }
  void operator()(SetBodyState e) { e.id = body(e.id), edits_.push_back(e); }
  void operator()(AddForce e) { e.id = body(e.id), edits_.push_back(e); }
  void operator()(AddVelocity e) { e.id = body(e.id), edits_.push_back(e); }
  void operator()(ForgetContacts e) {
    for (int& id : e.ids) id = body(id);
    std::ranges::sort(e.ids);
    edits_.push_back(std::move(e));
  }
  void operator()(const AddShape& e) {
    keepShapes();
    std::vector<AddShape>& shapes = member_.references.shapes;
    shapes.insert(std::ranges::upper_bound(shapes, e.place.indices, {}, beginOf), e);
    place(e);
  }
  void operator()(const DropShape& e) {
    keepShapes();
    std::vector<AddShape>& shapes = member_.references.shapes;
    const auto at = std::ranges::lower_bound(shapes, e.place.indices, {}, beginOf);
    dropped_.push_back(at->shape);
    member_.shapes.erase(member_.shapes.begin() + (at - shapes.begin()));
    shapes.erase(at);
    own_.changed.layout = true;
  }
  /// Places a shape of the world in the tables.
  void place(AddShape shape) {
    for (int& part : shape.partSurfaces) part = surface(part);
    reserveMore(placed_), reserveMore(member_.shapes);
    const WorldShape placed{shape.place.indices, batch_.placeShape(shape, edits_).indices,
                            static_cast<int>(shape.shape->indices.size())};
    placed_.push_back(shape.shape);
    member_.shapes.insert(std::ranges::upper_bound(member_.shapes, placed.base, {}, &WorldShape::base),
                          placed);
    own_.changed.layout = true;
  }
  /// The world has these shapes, in place of those that it had.
  void placeAll(const std::vector<AddShape>& shapes) {
    keepShapes();
    for (const AddShape& shape : member_.references.shapes) dropped_.push_back(shape.shape);
    member_.references.shapes = shapes;
    member_.shapes.clear();
    for (const AddShape& shape : shapes) place(shape);
  }
  void operator()(const SetSurfaces& e) {
    WorldReferences& to = member_.references;
    if (!surfaces_) surfaces_.emplace(Surfaces{to.surfaces, to.rules, member_.surfaces});
    const std::size_t before = own_.surfaces.size(), kept = to.surfaces.size();
    const bool extends = kept <= e.surfaces.size() &&
                         std::ranges::equal(to.surfaces, std::span(e.surfaces).first(kept));
    if (!extends) member_.surfaces.clear();
    own_.changed.rules |= to.rules != e.rules || (!extends && !e.rules.empty());
    own_.changed.layout |= !extends || member_.surfaces.size() < e.surfaces.size();
    to.surfaces = e.surfaces, to.rules = e.rules;
    for (std::size_t k = member_.surfaces.size(); k < e.surfaces.size(); ++k)
      member_.surfaces.push_back(batch_.surfaceOf(e.surfaces[k]));
    // bodies need their materials at once
    if (own_.surfaces.size() > before) edits_.push_back(SetSurfaces{own_.surfaces, own_.rules});
  }
  void operator()(SetPlanes e) {
    if (!planes_) planes_.emplace(std::move(member_.references.planes));
    member_.references.planes = std::move(e.ids);
    own_.changed.planes = true;
  }
  void operator()(SetJoint e) {
    const int type = static_cast<int>(e.joint.type);
    std::vector<int>& slots = slotAt(member_.joints, type);
    if (e.slot >= static_cast<int>(slots.size())) {
      if (slotsBefore_.empty()) {
        std::vector<std::size_t> sizes;
        for (const std::vector<int>& each : member_.joints) sizes.push_back(each.size());
        slotsBefore_ = own_.jointSlots, ownSlotsBefore_ = std::move(sizes);
      }
      reserveMore(slots);
      // the order of joints in a world is that of their slots
      slots.push_back(batch_.takeJoint(type, slots.empty() ? -1 : slots.back()));
      own_.changed.layout = true;
    }
    e.slot = slotAt(slots, e.slot);
    for (int* end : {&e.joint.a, &e.joint.b, &e.joint.frameBodyA, &e.joint.frameBodyB}) *end = body(*end);
    edits_.push_back(std::move(e));
  }
  void operator()(SetExcluded e) {
    reserveMore(exclusions_);
    const Pair pair = std::minmax(e.a, e.b);
    std::set<Pair>& excluded = member_.references.excluded;
    if (e.excluded) {
      if (excluded.insert(pair).second) exclusions_.push_back({pair, {}});
    } else if (auto node = excluded.extract(pair)) {
      exclusions_.push_back({pair, std::move(node)});
    }
    e.world = world_;
    edits_.push_back(e);
  }
  void operator()(SetDeformables e) {
    WorldReferences& to = member_.references;
    // where the tables have an object or attachment of the list before
    for (EngineSoftObject& object : e.objects) {
      const int from = object.previous.vertex;
      object.previous.vertex = -1;
      if (from < 0) continue;
      for (const EngineSoftObject& before : to.objects) {
        if (before.at.vertex != from || before.model != (object.before ? object.before : object.model))
          continue;
        object.previous = before.previous;
        if (before.before) object.before = before.before;
      }
    }
    for (EngineAttachment& a : e.attachments)
      if (a.previous >= 0) a.previous = slotAt(to.attachments, a.previous).previous;
    softs_.emplace(std::move(to.objects), std::move(to.attachments));
    to.objects = std::move(e.objects), to.attachments = std::move(e.attachments);
    own_.changed.softs = true;
  }
  void operator()(SetVertices e) { e.first += member_.first.vertex, edits_.push_back(std::move(e)); }
  void operator()(AddVertexForce e) { e.vertex += member_.first.vertex, edits_.push_back(e); }

 private:
  using Pair = std::pair<int, int>;
  struct Exclusion {
    Pair pair;
    std::set<Pair>::node_type erased;  ///< empty: it was added
  };
  struct Surfaces {
    std::vector<Material> surfaces;
    std::vector<EngineMaterialRule> rules;
    std::vector<int> inTables;
  };

  int body(int id) const { return id < 0 ? id : slotAt(member_.bodies, id); }
  int surface(int index) const { return index < 0 ? index : slotAt(member_.surfaces, index); }
  static int beginOf(const AddShape& shape) { return shape.place.indices; }
  void translate(SetBody& e) const {
    e.number = e.id, e.world = world_, e.id = body(e.id);
    e.body.surface = surface(e.body.surface);
    if (int& data = e.body.shape.data; data >= 0) {
      const auto after = std::ranges::upper_bound(member_.shapes, data, {}, &WorldShape::base);
      data += (after - 1)->baseInTables - (after - 1)->base;
    }
  }
  void addBody() {
    reserveMore(member_.bodies);
    member_.bodies.push_back(batch_.takeBody());
    own_.changed.layout = true;
  }
  void keepShapes() {
    if (!shapes_) shapes_.emplace(member_.references.shapes, member_.shapes);
  }
  static void giveBack(std::vector<int>& taken, std::size_t before, std::vector<int>& spare, int& next,
                       int nextBefore) {
    for (; taken.size() > before; taken.pop_back())
      if (taken.back() < nextBefore) spare.push_back(taken.back());
    next = nextBefore;
  }
  void takeBack() noexcept {
    WorldReferences& to = member_.references;
    giveBack(member_.bodies, ownBodiesBefore_, own_.spareBodies, own_.bodies, bodiesBefore_);
    for (std::size_t type = 0; type < slotsBefore_.size(); ++type)
      giveBack(member_.joints[type], ownSlotsBefore_[type], own_.spareJoints[type], own_.jointSlots[type],
               slotsBefore_[type]);
    for (auto e = exclusions_.rbegin(); e != exclusions_.rend(); ++e)
      if (e->erased)
        to.excluded.insert(std::move(e->erased));
      else
        to.excluded.erase(e->pair);
    if (shapes_) to.shapes.swap(shapes_->first), member_.shapes.swap(shapes_->second);
    for (const std::shared_ptr<const CookedShape>& shape : placed_) batch_.dropShape(shape);
    if (surfaces_) {
      to.surfaces.swap(surfaces_->surfaces), to.rules.swap(surfaces_->rules);
      member_.surfaces.swap(surfaces_->inTables);
    }
    own_.surfaces.erase(own_.surfaces.begin() + static_cast<std::ptrdiff_t>(surfacesBefore_),
                        own_.surfaces.end());
    if (planes_) to.planes.swap(*planes_);
    if (softs_) to.objects.swap(softs_->first), to.attachments.swap(softs_->second);
    own_.changed = changedBefore_;
  }

  Batch& batch_;
  Records& own_;
  const int world_;
  Member& member_;
  std::vector<Edit> edits_;
  bool kept_ = false;
  // how it was before
  const Changed changedBefore_;
  const int bodiesBefore_;
  const std::size_t ownBodiesBefore_, surfacesBefore_;
  std::vector<int> slotsBefore_;
  std::vector<std::size_t> ownSlotsBefore_;
  std::vector<Exclusion> exclusions_;
  std::vector<std::shared_ptr<const CookedShape>> placed_, dropped_;
  std::optional<std::pair<std::vector<AddShape>, std::vector<WorldShape>>> shapes_;
  std::optional<Surfaces> surfaces_;
  std::optional<std::vector<int>> planes_;
  std::optional<std::pair<std::vector<EngineSoftObject>, std::vector<EngineAttachment>>> softs_;
};

}  // namespace rubble

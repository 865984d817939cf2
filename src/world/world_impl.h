#pragma once
#include <optional>
#include <unordered_map>

#include "backend/engine.h"

namespace rubble {

/// Alive objects of one kind by slot; a freed slot is used again with the next generation.
template <class Id, class Def>
class Slots {
 public:
  Id add(Def def) {
    if (free_.empty()) {
      items_.push_back({std::move(def), 0, true});
      return {static_cast<std::int32_t>(items_.size() - 1), 0};
    }
    const std::int32_t index = free_.back();
    free_.pop_back();
    Item& item = items_[static_cast<std::size_t>(index)];
    item = {std::move(def), item.generation + 1, true};
    return {index, item.generation};
  }
  void remove(Id id) {
    items_[static_cast<std::size_t>(id.index)].alive = false;
    free_.push_back(id.index);
  }
  bool alive(Id id) const {
    return id.index >= 0 && static_cast<std::size_t>(id.index) < items_.size() && items_[static_cast<std::size_t>(id.index)].alive &&
           items_[static_cast<std::size_t>(id.index)].generation == id.generation;
  }
  Def& operator[](Id id) { return items_[static_cast<std::size_t>(id.index)].def; }
  const Def& operator[](Id id) const { return items_[static_cast<std::size_t>(id.index)].def; }
  std::optional<Id> at(int index) const {
    const Item& item = items_[static_cast<std::size_t>(index)];
    return item.alive ? std::optional<Id>(Id{index, item.generation}) : std::nullopt;
  }
  int size() const { return static_cast<int>(items_.size()); }
  std::vector<Id> ids() const {
    std::vector<Id> out;
    for (int i = 0; i < size(); ++i)
      if (const auto id = at(i)) out.push_back(*id);
    return out;
  }

 private:
  struct Item {
    Def def;
    std::uint32_t generation;
    bool alive;
  };
  std::vector<Item> items_;
  std::vector<std::int32_t> free_;
};

struct BodyRecord {
  BodyDef def;
  MassProperties mass;
};

struct JointRecord {
  JointDef def;
  BodyId a, b;        ///< index -1: the world
  int engineSlot;     ///< among the joints of its type
};

/// Everything of a world but its engine: copied whole into a snapshot.
struct Registry {
  Slots<BodyId, BodyRecord> bodies;
  Slots<JointId, JointRecord> joints;
  std::unordered_map<std::string, BodyId> bodyNames;
  std::unordered_map<std::string, JointId> jointNames;
  std::vector<BodyId> sceneBodies;
  std::vector<int> freeJointSlots[2];
  int jointSlots[2] = {0, 0};
  Vec3 gravity;
  std::int64_t step = 0;
  double time = 0;
};

struct World::Impl {
  std::unique_ptr<Engine> engine;
  Registry registry;
  Params params;
  bool settingsChanged = true;
  bool planesChanged = true;
  bool exclusionsChanged = true;

  BodyId addBody(const BodyDef& def, const std::string& path);
  JointId addJoint(const JointDef& def, BodyId a, BodyId b);
  void removeBody(BodyId id);
  void removeJoint(JointId id);
  void requireAlive(BodyId id) const;
  void requireAlive(JointId id) const;
  /// Brings the engine up to date with all edits since the last step.
  void flush();
};

struct Snapshot::Data {
  Registry registry;
  Params params;
  std::vector<std::byte> engine;
};

}  // namespace rubble

#pragma once
#include <optional>
#include <set>
#include <unordered_map>

#include <rubble/events.h>

#include "backend/ordered_engine.h"
#include "world/body_record.h"
#include "world/joint_build.h"
#include "world/shape_frame.h"

namespace rubble {

/// Alive objects of one kind by slot; a freed slot is used again with the next generation. Copies share their
/// items until one of them is edited: a snapshot costs nothing here.
template <class Id, class Def> class Slots {
 public:
  Id add(Def def) {
    std::vector<Item>& items = own(items_);
    std::vector<std::int32_t>& free = own(free_);
    if (free.empty()) {
      items.push_back({std::move(def), 0, true});
      return {static_cast<std::int32_t>(items.size() - 1), 0};
    }
    const std::int32_t index = free.back();
    free.pop_back();
    Item& item = items[static_cast<std::size_t>(index)];
    item = {std::move(def), item.generation + 1, true};
    return {index, item.generation};
  }
  void remove(Id id) {
    own(items_)[static_cast<std::size_t>(id.index)].alive = false;
    own(free_).push_back(id.index);
  }
  bool alive(Id id) const {
    return id.index >= 0 && id.index < size() && item(id.index).alive &&
           item(id.index).generation == id.generation;
  }
  const Def& operator[](Id id) const { return item(id.index).def; }
  /// To change it.
  Def& edit(Id id) { return own(items_)[static_cast<std::size_t>(id.index)].def; }
  std::optional<Id> at(int index) const {
    return item(index).alive ? std::optional<Id>(Id{index, item(index).generation}) : std::nullopt;
  }
  int size() const { return static_cast<int>(items_->size()); }
  int count() const { return size() - static_cast<int>(free_->size()); }
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
  const Item& item(int index) const { return (*items_)[static_cast<std::size_t>(index)]; }
  /// The one copy that may be edited.
  template <class T> static T& own(std::shared_ptr<T>& shared) {
    if (shared.use_count() > 1) shared = std::make_shared<T>(*shared);
    return *shared;
  }

  std::shared_ptr<std::vector<Item>> items_ = std::make_shared<std::vector<Item>>();
  std::shared_ptr<std::vector<std::int32_t>> free_ = std::make_shared<std::vector<std::int32_t>>();
};

/// What is made of the definition of a body before anything of the world changes.
struct ReadyBody {
  std::shared_ptr<const CookedShape> cooked;
  MassProperties mass;
};

/// What the name of a body is expected to be.
inline constexpr const char* kOwnName = "a name that no other body has";

/// Null if there is none with the geometry of that shape.
const CookedEntry* findCooked(std::span<const CookedEntry> entries, const Shape& shape);

/// More are of no use to any machine, and what runs them has no bound of its own.
inline constexpr int kMostThreads = 1024;

/// Throws Error with the path of what is not finite, or not a rotation.
void validate(const BodyState& state, const std::string& path);

struct JointRecord {
  JointDef def;
  BodyId a, b;  ///< index -1: the world
  BodyId carrierA, carrierB;
  EngineJoint engine;  ///< as the engine has it
  int engineSlot;      ///< among the joints of its type
  bool broken = false;
};

/// Two bodies that touch, by rising slot.
struct Touch {
  BodyId a, b;
  bool sensor;
};

struct SoftRecord {
  Deformable def;
  std::shared_ptr<const SoftModel> model;
  std::int64_t order;  ///< objects lie in the tables in the order in which they were added
  SoftRange range;     ///< in the tables; vertex -1: not there yet
};

struct AttachmentRecord {
  AttachmentDef def;
  SoftId object, otherObject;  ///< other: index -1: no seam
  BodyId body;                 ///< index -1: the world
  Vec3 anchor;                 ///< in the frame of the body, or in the world [m]
  std::int64_t order;
  int engineIndex = -1;  ///< -1: not there yet
};

/// Everything of a world but its engine: copied whole into a snapshot.
struct Registry {
  Slots<BodyId, BodyRecord> bodies;
  Slots<JointId, JointRecord> joints;
  Slots<SoftId, SoftRecord> softs;
  Slots<AttachmentId, AttachmentRecord> attachments;
  std::unordered_map<std::string, SoftId> softNames;
  std::vector<SoftId> sceneSofts;
  std::int64_t softOrder = 0;
  std::unordered_map<std::string, BodyId> bodyNames;
  std::unordered_map<std::string, JointId> jointNames;
  std::vector<BodyId> sceneBodies;
  std::vector<CookedEntry> shapes;  ///< whose geometry the engine keeps in its tables
  int shapeIndices = 0, shapeParts = 0;
  std::vector<Material> surfaces;  ///< that the engine keeps in its table
  std::vector<int> freeJointSlots[kEngineJointTypes];
  int jointSlots[kEngineJointTypes] = {};
  std::set<std::pair<int, int>> exclusions;  ///< slots (low, high), besides those of joints
  std::vector<Touch> touches;                ///< after the last step whose events were collected, sorted
  std::vector<int> sleepers;                 ///< likewise, slots
  Vec3 gravity;
  std::int64_t step = 0;
  double time = 0;
};

/// Copies of poses under way: the oldest first, of buffers that take turns.
struct PoseRing {
  struct Frame {
    std::int64_t step = 0;
    double time = 0;
  };
  std::unique_ptr<PoseCopies> host;  ///< where the engine has none of its own
  Frame frames[2];
  std::int64_t begun = 0, taken = 0;
};

struct World::Impl {
  std::unique_ptr<OrderedEngine> engine;
  Registry registry;
  Params params;
  bool settingsChanged = true;
  bool planesChanged = true;
  bool exclusionsChanged = true;
  bool doublePrecision = false;  ///< of the engine: its snapshots are of no use to others
  std::int64_t epoch = 0;
  PoseRing poses;
  bool softChanged = false;
  bool disturbed = false;  ///< something that acts on all bodies has changed: none sleeps on
  bool wantsEvents = false;
  Events events;

  /// The shape as the engine takes it. What has the geometry of a shape that the engine has, or of one in
  /// `fresh`, is not cooked again.
  std::shared_ptr<const CookedShape> cookShape(const Shape& shape, const std::string& path,
                                               std::vector<CookedEntry>& fresh) const;
  /// Where its indices begin in the tables of the engine; shapes with the same geometry are there once.
  int placeShape(const Shape& shape, const std::shared_ptr<const CookedShape>& cooked);
  /// Place among the engine's materials, -1 for one that needs none.
  int surfaceOf(const Material& material);
  /// Throws Error for a body that cannot be made, and changes nothing.
  ReadyBody ready(const BodyDef& def, const std::string& path, std::vector<CookedEntry>& fresh) const;
  BodyId addBody(const BodyDef& def, const ReadyBody& ready);
  /// All of the list, or, with an Error, none.
  std::vector<BodyId> addBodies(std::span<const BodyDef> bodies, const std::string& list);
  JointId addJoint(const JointDef& def, BodyId a, BodyId b, BodyId carrierA, BodyId carrierB);
  /// Another definition of the same type for a joint.
  void redefine(JointId id, const JointDef& def);
  /// The same with an axis changed by edit(JointAxis&).
  template <class Edit> void editAxis(JointId id, int axis, Edit&& edit) {
    requireAlive(id);
    JointDef def = registry.joints[id].def;
    if (axis < 0 || axis >= axisCount(def.type))
      throw Error("axis", "one of " + std::to_string(axisCount(def.type)) + " axes of this joint, from 0",
                  std::to_string(axis));
    edit(def.axes[static_cast<std::size_t>(axis)]);
    redefine(id, def);
  }
  /// Notes the joints that have broken in this step.
  void findBroken(std::vector<JointId>& broken);
  JointBodies jointBodies(const JointRecord& joint) const;
  void wakeBodiesOf(const JointRecord& joint);
  /// The same with anchors and frames in the axes of the engine.
  JointDef inEngineFrames(JointDef def, BodyId a, BodyId b) const;
  void removeBody(BodyId id);
  void removeBodies(std::span<const BodyId> ids);
  void removeJoint(JointId id);
  void exclude(BodyId a, BodyId b, bool excluded);
  void requireAlive(BodyId id) const;
  void requireAlive(JointId id) const;
  PoseCopies& poseCopies();
  SoftId addSoft(const Deformable& def, const std::string& path);
  AttachmentId addAttachment(const AttachmentDef& def, SoftId object, BodyId body, SoftId other,
                             const std::string& path);
  void removeSoft(SoftId id);
  void removeAttachment(AttachmentId id);
  void removeAttachmentsOf(BodyId id);
  void requireAlive(SoftId id) const;
  void requireAlive(AttachmentId id) const;
  /// Brings the tables of deformable objects up to date.
  void flushSoft();
  void wake(BodyId id);
  void collectEvents(const StepReport& report);
  void collectContacts();
  void collectBreaks(const std::vector<JointId>& broken);
  void collectSleeps();
  /// Brings the engine up to date with all edits since the last step.
  void flush();
};

struct Snapshot::Data {
  Registry registry;
  Params params;
  bool doublePrecision = false;
  std::shared_ptr<const EngineSnapshot> engine;
};

}  // namespace rubble

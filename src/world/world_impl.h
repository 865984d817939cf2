#pragma once
#include <optional>
#include <set>
#include <unordered_map>

#include <rubble/events.h>

#include "backend/engine.h"
#include "world/body_record.h"
#include "world/joint_build.h"
#include "world/shape_frame.h"

namespace rubble {

/// Live objects of one kind by slot. A freed slot is reused with the next generation. Copies share their
/// items until one of them is edited (copy on write), so a snapshot is free.
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
  /// The item for writing.
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
  /// Copies a shared list before it is written.
  template <class T> static T& own(std::shared_ptr<T>& shared) {
    if (shared.use_count() > 1) shared = std::make_shared<T>(*shared);
    return *shared;
  }

  std::shared_ptr<std::vector<Item>> items_ = std::make_shared<std::vector<Item>>();
  std::shared_ptr<std::vector<std::int32_t>> free_ = std::make_shared<std::vector<std::int32_t>>();
};

/// Everything derived from the definition of a body before the world is changed.
struct ReadyBody {
  std::shared_ptr<const CookedShape> cooked;
  MassProperties mass;
};

/// Expectation in the error for a duplicate name.
inline constexpr const char* kOwnName = "a name that no other body has";

/// Throws Error unless World::scatter can take these arrays.
void checkScatter(StateArray which, const ArrayView& rows, const ArrayView& values);

/// Null if no shape has the same geometry.
const CookedEntry* findCooked(std::span<const CookedEntry> entries, const Shape& shape);

bool sameMaterial(const Material& a, const Material& b);

/// Throws Error if no such engine can be made.
std::unique_ptr<Engine> makeEngine(const WorldOptions& options);

/// A sanity bound: the thread pool itself has none.
inline constexpr int kMostThreads = 1024;

/// Throws Error with the path of a value that is not finite, or of an invalid rotation.
void validate(const BodyState& state, const Path& path);

struct JointRecord {
  JointDef def;
  BodyId a, b;  ///< index -1: the world
  BodyId frameBodyA, frameBodyB;
  EngineJoint engine;  ///< as the engine has it
  int engineSlot;      ///< index among the joints of its type
  bool broken = false;
};

/// Two touching bodies, in ascending order of slots.
struct Touch {
  BodyId a, b;
  bool sensor;
};

struct SoftRecord {
  Deformable def;
  std::shared_ptr<const SoftModel> model;
  std::int64_t order;  ///< objects are in the tables in the order in which they were added
  SoftRange range;     ///< in the tables; vertex -1: not placed yet
};

struct AttachmentRecord {
  AttachmentDef def;
  DeformableId object, otherObject;  ///< other: index -1: not a vertex-vertex attachment
  BodyId body;                       ///< index -1: the world
  Vec3 anchor;                       ///< in the body frame, or in the world [m]
  std::int64_t order;
  int engineIndex = -1;  ///< -1: not placed yet
};

/// All data of a world except its engine. A snapshot copies it.
struct Registry {
  Slots<BodyId, BodyRecord> bodies;
  Slots<JointId, JointRecord> joints;
  Slots<DeformableId, SoftRecord> softs;
  Slots<AttachmentId, AttachmentRecord> attachments;
  std::unordered_map<std::string, DeformableId> softNames;
  std::vector<DeformableId> sceneSofts;
  std::int64_t softOrder = 0;
  std::unordered_map<std::string, BodyId> bodyNames;
  std::unordered_map<std::string, JointId> jointNames;
  std::vector<BodyId> sceneBodies;
  std::vector<CookedEntry> shapes;  ///< those with geometry in the tables of the engine
  int shapeIndices = 0, shapeParts = 0;
  std::vector<Material> surfaces;  ///< those in the material table of the engine
  /// By joint type of the engine.
  std::vector<std::vector<int>> freeJointSlots{static_cast<std::size_t>(engineJointTypes())};
  std::vector<int> jointSlots = std::vector<int>(freeJointSlots.size());
  std::set<std::pair<int, int>> exclusions;  ///< (low, high), without those of joints
  std::vector<int> planes;                   ///< bodies, ascending
  std::vector<Touch> touches;                ///< of the last step with events enabled, sorted
  std::vector<int> sleepers;                 ///< of the same step, slots
  Vec3 gravity;
  std::int64_t step = 0;
  double time = 0;
};

/// Pending copies of poses, oldest first. Two buffers alternate.
struct PoseRing {
  struct Frame {
    std::int64_t step = 0;
    double time = 0;
  };
  std::unique_ptr<PoseCopies> host;  ///< for engines without asynchronous copies
  Frame frames[2];
  std::int64_t begun = 0, taken = 0;
};

struct World::Impl {
  std::unique_ptr<Engine> engine;
  Registry registry;
  Params params;
  bool doublePrecision = false;  ///< of the engine; snapshots of the other precision cannot be restored
  std::int64_t epoch = 0;
  PoseRing poses;
  bool softChanged = false;
  bool sortSoon = false;  ///< the next step sorts the bodies
  bool wantsEvents = false;
  std::string difference;                            ///< of the reports
  bool inBatch = false;                              ///< parameters are those of all worlds of a batch
  std::shared_ptr<std::vector<CookedEntry>> cooked;  ///< shapes of other worlds of the batch, or null
  Events events;

  /// Adds everything but events.
  void build(const Scene& scene);
  /// After a step that takes part in no other.
  void finishStep(StepReport& report);
  /// Takes over everything of a snapshot but the state of its engine.
  void restoreRecords(const Snapshot::Data& data);
  /// The cooked shape. Geometry that the engine or `fresh` already has is not cooked again.
  std::shared_ptr<const CookedShape> cookShape(const Shape& shape, const Path& path,
                                               std::vector<CookedEntry>& fresh) const;
  /// Offset of its indices in the tables of the engine. Equal geometry is stored once.
  int placeShape(const Shape& shape, const std::shared_ptr<const CookedShape>& cooked);
  /// Index into the materials of the engine, or -1 if the material needs no entry.
  int surfaceOf(const Material& material);
  /// Throws Error for a body that cannot be made, without changing anything.
  ReadyBody ready(const BodyDef& def, const Path& path, std::vector<CookedEntry>& fresh) const;
  BodyId addBody(const BodyDef& def, const ReadyBody& ready);
  /// Adds all bodies or, with an Error, none.
  std::vector<BodyId> addBodies(std::span<const BodyDef> bodies, const std::string& list);
  JointId addJoint(const JointDef& def, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB);
  /// Redefines a joint, with the same type.
  void redefine(JointId id, const JointDef& def);
  /// Redefines a joint whose axis is changed by edit(JointAxis&).
  template <class Edit> void editAxis(JointId id, int axis, Edit&& edit) {
    requireAlive(id);
    JointDef def = registry.joints[id].def;
    if (axis < 0 || axis >= axisCount(def.type))
      throw Error("axis", "one of " + std::to_string(axisCount(def.type)) + " axes of this joint, from 0",
                  std::to_string(axis));
    edit(def.axes[static_cast<std::size_t>(axis)]);
    redefine(id, def);
  }
  /// Records the joints that broke in this step.
  void findBroken(std::vector<JointId>& broken);
  JointBodies jointBodies(const JointRecord& joint) const;
  void wakeBodiesOf(const JointRecord& joint);
  /// The definition with anchors and frames in the engine frames of its bodies.
  JointDef inEngineFrames(JointDef def, BodyId a, BodyId b) const;
  void removeBody(BodyId id);
  void removeBodies(std::span<const BodyId> ids);
  void removeJoint(JointId id);
  void exclude(BodyId a, BodyId b, bool excluded);
  void requireAlive(BodyId id) const;
  /// In the engine frame.
  BodyState bodyState(BodyId id) const { return engine->bodyState(id.index); }
  void requireAlive(JointId id) const;
  PoseCopies& poseCopies();
  DeformableId addSoft(const Deformable& def, const Path& path);
  AttachmentId addAttachment(const AttachmentDef& def, DeformableId object, BodyId body, DeformableId other,
                             const Path& path);
  void removeSoft(DeformableId id);
  void removeAttachment(AttachmentId id);
  void removeAttachmentsOf(BodyId id);
  void requireAlive(DeformableId id) const;
  void requireAlive(AttachmentId id) const;
  /// Sends edits of deformable objects, which the engine takes all at once.
  void flush();
  void wake(BodyId id);
  void collectEvents(const StepReport& report);
  void collectContacts();
  void collectBreaks(const std::vector<JointId>& broken);
  void collectSleeps();
  /// Whether they never collide: by an exclusion of their own, or by a joint.
  bool excludes(BodyId a, BodyId b) const;
  /// Tells the engine whether the two bodies collide.
  void updateExclusion(BodyId a, BodyId b);
  /// Adds or removes a joint in the records of its bodies.
  void listJoint(JointId id, const JointRecord& joint, bool listed);
  void setPlanes();
  /// Gives parameters and gravity to the engine. `wakesAll`: they have changed, and act on all bodies.
  void configure(bool wakesAll);
};

struct Snapshot::Data {
  Registry registry;
  Params params;
  bool doublePrecision = false;
  std::shared_ptr<const EngineSnapshot> engine;
};

}  // namespace rubble

#pragma once
#include <algorithm>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>

#include <rubble/actuators.h>
#include <rubble/events.h>

#include "backend/engine.h"
#include "world/body_record.h"
#include "world/joint_build.h"
#include "world/log.h"
#include "world/shape_frame.h"
#include "world/world_shapes.h"

namespace rubble {

/// Expectation in the error for a duplicate name.
inline constexpr const char* kOwnName = "a name that no other body has";

/// Throws Error unless World::scatter can take these arrays.
void checkScatter(StateArray which, const ArrayView& rows, const ArrayView& values);
void checkScatter(JointArray which, const ArrayView& rows, const ArrayView& values);

bool ofSameMaterials(const MaterialPair& p, const MaterialPair& q);
/// The materials with those rules of which both materials are among them.
SetSurfaces surfacesEdit(std::vector<Material> surfaces, std::span<const MaterialPair> pairs);
void sortRules(std::vector<EngineMaterialRule>& rules);
/// Also where the geometry is an equal copy. User data does not matter.
bool sameShape(const Shape& a, const Shape& b);
/// A part of a compound; null: the whole of another shape. Throws Error if there is no such part.
const ShapePartDef* partOf(const Shape& shape, int part);
/// Shape::userData of a part of a compound, or of another shape.
std::uint64_t partUserData(const Shape& shape, int part);

/// Throws Error if no such engine can be made.
std::unique_ptr<Engine> makeEngine(const WorldOptions& options);
bool runsOnDevice(const std::string& backend);

/// A sanity bound: the thread pool itself has none.
inline constexpr int kMostThreads = 1024;

/// Throws Error with the path of a value that is not finite, or of an invalid rotation.
void validate(const BodyState& state, const Path& path);

/// Throws Error for a stiffness, a threshold or an anchor that cannot be.
void checkNumbers(const AttachmentDef& def, const Path& path);

/// What World::castRayArrays gives of rays in host memory.
struct HostRayHits {
  std::vector<float> distances, normals;
  std::vector<int> bodies;
};

struct BodyChange;

/// Definitions of actuators in one world.
using ActuatorList = std::shared_ptr<const std::vector<ActuatorDef>>;

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
  std::uint64_t userDataA, userDataB, shapeUserDataA, shapeUserDataB;
};

struct SoftRecord {
  Deformable def;
  std::shared_ptr<const SoftModel> model;
  std::int64_t order;  ///< objects are in the tables in the order in which they were added
  SoftRange range;     ///< in the tables; vertex -1: not placed yet
  int surface = -1;    ///< index into the materials, -1: a material without a name
  std::shared_ptr<const SoftModel> before = nullptr;  ///< as EngineSoftObject::before
};

struct AttachmentRecord {
  AttachmentDef def;
  DeformableId object, otherObject;  ///< other: index -1: not a vertex-vertex attachment
  BodyId body;                       ///< index -1: the world
  Vec3 anchor;                       ///< in the body frame, or in the world [m]
  std::int64_t order;
  int engineIndex = -1;  ///< -1: not placed yet
};

/// Calls undo() at the end of its scope, unless keep() was called.
template <class F> class Undo {
 public:
  explicit Undo(F undo) : undo_(std::move(undo)) {}
  ~Undo() {
    if (active_) undo_();
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;
  void keep() { active_ = false; }

 private:
  F undo_;
  bool active_ = true;
};

/// Calls f(). The want of memory becomes an OutOfMemory that names the call.
template <class F> decltype(auto) withMemory(const char* call, F&& f) try {
  return f();
} catch (const std::bad_alloc&) {
  throw OutOfMemory(call);
}

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
  WorldShapes shapes;
  std::vector<Material> surfaces;           ///< those in the material table of the engine
  std::vector<MaterialPair> materialPairs;  ///< at most one of two names
  /// By joint type of the engine.
  std::vector<std::vector<int>> freeJointSlots{static_cast<std::size_t>(engineJointTypes())};
  std::vector<int> jointSlots = std::vector<int>(freeJointSlots.size());
  std::set<std::pair<int, int>> exclusions;  ///< (low, high), without those of joints
  std::vector<int> planes;                   ///< bodies, ascending
  std::vector<Touch> touches;                ///< of the last step with events enabled, sorted
  std::vector<int> sleepers;                 ///< of the same step, slots
  /// Joints broke in the last step, which had no memory to list them.
  bool hasUnlistedBreaks = false;
  /// Scripted events of the scene, by step, and the first that has not been applied. Null: none.
  std::shared_ptr<const std::vector<Event>> script;
  int nextEvent = 0;
  int partsOfEvent = 0;  ///< of that event which were applied before memory ended
  Vec3 gravity;
  std::int64_t step = 0;
  double time = 0;
  /// In snapshots: controls and then activations of each of World::Impl::actuators, and their definitions.
  std::vector<std::vector<double>> actuators;
  std::vector<ActuatorList> actuatorDefinitions;
};

/// Controls and activations of rubble::Actuators. Shape: worlds x actuators.
struct ActuatorState {
  ActuatorList first;                                   ///< definitions at the beginning
  std::vector<ActuatorList> definitions;                ///< of each world, the first ones until they differ
  std::vector<double> firstControls, firstActivations;  ///< of one world, at the beginning
  std::vector<double> controls, activations;
};

/// Throws the Error of an invalid ray, number i of a list.
void checkRay(const RayQuery& ray, std::size_t i);
/// A valid ray as a query, and its hit.
EngineQuery queryOf(const RayQuery& ray, const Registry& registry);
RayHit hitOf(const EngineHit& found, const RayQuery& ray, const Registry& registry);

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

/// An edit first makes everything that needs memory, then gives the engine its edits, which applies all or
/// none, and then changes the registry, for which there is room. So an edit without memory changes nothing.
struct World::Impl {
  std::unique_ptr<Engine> engine;
  Registry registry;
  // What every step looks at follows the end of the registry, in the same lines of the cache: each step of a
  // batch visits thousands of worlds.
  bool softChanged = false;
  bool jointRowsChanged = true;  ///< since sendJointRows()
  bool sortSoon = false;         ///< the next step sorts the bodies
  bool wantsEvents = false;
  std::string difference;       ///< of the reports
  std::vector<JointId> broken;  ///< that no report has listed
  Params params;
  bool doublePrecision = false;  ///< of the engine; snapshots of the other precision cannot be restored
  std::int64_t epoch = 0;
  PoseRing poses;
  HostRayHits rayHits;
  LogSink log;
  IdleCalls idle;
  TaskSystem tasks;  ///< of the host
  inputs::Sink inputs;
  bool inBatch = false;  ///< parameters are those of all worlds of a batch
  /// Also of the other worlds of a batch.
  std::shared_ptr<CookedShapes> cooked = std::make_shared<CookedShapes>();
  Events events;
  /// Those that act on this world in the order in which they were made, and which of their worlds it is.
  std::vector<std::pair<std::weak_ptr<ActuatorState>, std::size_t>> actuators;

  /// Tells the sink of inputs, if there is one, of a call.
  template <class Call> void pass(Call&& call) {
    if (inputs) inputs(inputs::Call(std::forward<Call>(call)));
  }

  void build(const Scene& scene);
  void setScript(std::vector<Event> events);
  /// Steps until the next scripted event is due; not positive: it is.
  std::int64_t stepsToEvent() const {
    if (!registry.script || registry.nextEvent == static_cast<int>(registry.script->size()))
      return std::numeric_limits<std::int64_t>::max();
    return (*registry.script)[static_cast<std::size_t>(registry.nextEvent)].step - registry.step;
  }
  /// Counts steps of this world, alone or with others. `listsAnew`: joints that broke before are listed.
  void countSteps(int number, const StepReport& last, bool listsAnew) noexcept {
    registry.step += number;
    for (; number > 0; --number) registry.time += params.dt;  // with the bits of single steps
    registry.hasUnlistedBreaks |= last.brokenJoints > 0;
    if (listsAnew) broken.clear();
    if (last.difference.empty()) difference.clear();
  }
  /// Collects what is to be reported of the last step that was counted.
  void finishStep(const StepReport& taken);
  /// Adds the joints that broke to `broken`, if that was not done yet.
  void findUnlistedBreaks();
  void addActuators(const std::shared_ptr<ActuatorState>& state, std::size_t world);
  /// What a snapshot has of them, and back.
  std::vector<std::vector<double>> actuatorValues(std::vector<ActuatorList>* definitions) const;
  void setActuatorValues(const std::vector<std::vector<double>>& values,
                         const std::vector<ActuatorList>& definitions);
  /// Restores the engine, with the rules of materials that the records have.
  void restoreEngine(const EngineSnapshot& snapshot, const Registry& from);
  /// Takes over everything of a snapshot but the state of its engine. Needs no memory.
  void restoreRecords(Registry&& from, const Params& own);
  /// Adds valid bodies, or none: an Error names that of `list` which cannot be made.
  std::vector<BodyId> addBodies(std::span<const BodyDef> bodies, const Path& list);
  JointId addJoint(const JointDef& def, BodyId a, BodyId b, BodyId frameBodyA, BodyId frameBodyB);
  /// A dynamic body after an angular impulse about its center of mass [N m s].
  BodyState turned(BodyId id, const Vec3& angularImpulse) const;
  /// Redefines a body: as World::setDefinition.
  void redefine(BodyId id, BodyDef def);
  // The two halves of it, and likewise of joints and deformable objects: the first one throws Error for a
  // definition that cannot be and edits nothing.
  BodyChange redefined(BodyId id, BodyDef def);
  void apply(BodyChange&& change);
  /// Redefines a body whose definition is changed by edit(BodyDef&).
  template <class Edit> void editBody(const char* call, BodyId id, Edit&& edit) {
    withMemory(call, [&] {
      requireAlive(id);
      BodyDef def = registry.bodies[id].def;
      edit(def);
      redefine(id, def);
    });
  }
  /// The joint with another definition.
  EngineJoint changedJoint(const JointRecord& record, const JointDef& def) const;
  /// Redefines a joint, with the same type.
  void redefine(JointId id, const JointDef& def);
  EngineJoint redefined(JointId id, const JointDef& def) const;
  void apply(JointId id, JointDef def, EngineJoint joint);
  /// Tells the engine what the rows of joint arrays are, if that has changed.
  void sendJointRows();
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
  JointBodies jointBodies(const JointRecord& joint) const;
  /// Appends the end of a shape, if it ends with so many uses less.
  void addDrop(std::vector<Edit>& edits, ShapeId id, int uses) const;
  /// Appends the edits that wake a body, or those of a joint.
  void addWake(std::vector<Edit>& edits, BodyId id);
  void addWakes(std::vector<Edit>& edits, const JointRecord& joint);
  /// The definition with anchors and frames in the engine frames of its bodies.
  JointDef inEngineFrames(JointDef def, BodyId a, BodyId b) const;
  void removeBodies(std::span<const BodyId> ids);
  void push(BodyId id, const Vec3& force, const Vec3& torque);
  void removeJoint(JointId id);
  /// Makes room, so that dropJoint() needs no memory for these joints.
  void prepareToDrop(std::span<const JointId> ids);
  /// Removes a joint from the registry.
  void dropJoint(JointId id);
  void exclude(BodyId a, BodyId b, bool excluded);
  void requireAlive(BodyId id) const;
  /// In the engine frame.
  bool isDynamic(BodyId id) const { return registry.bodies[id].def.motion == Motion::Dynamic; }
  BodyState bodyState(BodyId id) const { return engine->bodyState(id.index); }
  void requireAlive(JointId id) const;
  void requireAlive(ShapeId id) const;
  PoseCopies& poseCopies();
  /// Index of a named material among those of the engine, -1 for one without a name.
  int placeMaterial(const Material& material);
  DeformableId addSoft(const Deformable& def, const Path& path);
  AttachmentId addAttachment(const AttachmentDef& def, DeformableId object, BodyId body, DeformableId other,
                             const Path& path);
  void removeSoft(DeformableId id);
  /// The pieces of all deformable objects, where the last step has put them.
  EngineSoftTargets softTargets();
  /// Replaces hits of rays on bodies, or none, by those on deformable objects that come before.
  void addObjectHits(std::span<EngineQuery> queries, std::span<const EngineHit> bodies,
                     std::span<const RayQuery> rays, std::span<RayHit> hits);
  /// Redefines an object: as World::setDefinition.
  void redefine(DeformableId id, const Deformable& def);
  SoftRecord redefined(DeformableId id, const Deformable& def) const;
  void apply(DeformableId id, SoftRecord record);
  void removeAttachment(AttachmentId id);
  void requireAlive(DeformableId id) const;
  void requireAlive(AttachmentId id) const;
  /// The same unless it is the id of none, which may be that of the world.
  template <class Id> void requireAliveIfAny(Id id) const {
    if (id != Id{}) requireAlive(id);
  }
  /// Sends edits of deformable objects, which the engine takes all at once.
  void flush();
  void collectEvents(std::span<const JointId> broken);
  std::vector<Touch> collectContacts(Events& to) const;
  void collectBreaks(Events& to, std::span<const JointId> broken) const;
  std::vector<int> collectSleeps(Events& to) const;
  /// Whether they never collide by a joint, `without` these joints (ascending).
  bool jointExcludes(BodyId a, BodyId b, std::span<const JointId> without = {}) const;
  /// The edit that tells the engine whether the two bodies collide, none if one of them is the world.
  void addExclusion(std::vector<Edit>& edits, BodyId a, BodyId b, bool excluded) const;
  /// Adds or removes a joint in the records of its bodies.
  void listJoint(JointId id, const JointRecord& joint, bool listed);
  /// Replaces all rules of pairs of materials.
  void setMaterialPairs(std::vector<MaterialPair> pairs);
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

#pragma once
/// What the opaque handles of the C API hold.
#include <memory>
#include <optional>

#include <rubble/worlds.h>
#include <nlohmann/json.hpp>

#include "c_api/guard.h"
#include "io/recording.h"
#include "io/scene_reader.h"
#include "scenes/registry.h"

struct rb_scene {
  explicit rb_scene(std::string folder) : reader(faults, std::move(folder)) {}
  std::vector<rubble::io::Fault> faults;  ///< of the call in progress
  rubble::io::SceneReader reader;
  rubble::io::SceneFile file;
};

struct rb_shape {
  rubble::Shape shape;
};

struct rb_snapshot {
  rubble::Snapshot snapshot;
  std::vector<std::byte> bytes = {};  ///< of the last rb_snapshot_bytes()
};

/// A world, and the lists that its last calls returned.
struct rb_world {
  std::shared_ptr<rubble::World> world;
  rubble::Appearance appearance;  ///< of its scene
  rubble::StepReport report;
  std::vector<rb_body_id> bodies, added, overlapping;
  std::vector<rb_shape_id> shapes;
  std::vector<rb_joint_id> joints, jointsOf, axisJoints;
  std::vector<std::int32_t> axes;
  std::vector<rb_deformable_id> deformables;
  std::vector<rb_attachment_id> attachments;
  std::vector<rb_contact_point> contacts, contactsOf, eventPoints;
  std::vector<rb_vertex_contact> vertexContacts;
  std::vector<rb_solver_state> solverStates, vertexSolverStates;
  std::vector<rb_contact_event> contactEvents;
  std::vector<rb_joint_event> jointEvents;
  std::vector<rb_sleep_event> sleepEvents;
  std::vector<std::int64_t> offsets, hitOffsets;
  std::vector<rb_hit> hits;  ///< of queries that give all
  std::vector<double> surfaceVertices;
  std::vector<std::int32_t> surfaceTriangles, surfaceSegments;
  rubble::DebugDraw drawing;
  std::vector<rb_debug_line> drawnLines;
  std::vector<rb_debug_triangle> drawnTriangles;
  std::vector<rb_debug_text> drawnTexts;
};

struct rb_worlds {
  std::shared_ptr<rubble::Worlds> worlds;
  std::vector<std::int32_t> rows = {};  ///< returned last
  std::vector<double> values = {};
};

struct rb_run {
  std::shared_ptr<rubble::scenes::Runner> runner;
  rb_world world;  ///< that of the runner
  bool isJudged = false;
};

struct rb_recorder {
  std::unique_ptr<rubble::io::RecordingWriter> writer;
};

struct rb_recording {
  rubble::io::RecordingReader reader;
  rubble::io::RecordedFrame frame = {};
  std::vector<rb_pose> poses = {};
  std::vector<double> vertices = {};
};

namespace rubble::c {

/// An id in a text of JSON.
template <class Id> nlohmann::ordered_json idJson(Id id) { return {id.index, id.generation}; }

inline World& worldOf(rb_world* handle) { return *need(handle, "world").world; }
inline const World& worldOf(const rb_world* handle) { return *need(handle, "world").world; }

/// A scene of these bodies at their present poses. Bodies with index -1 (the world) are left out.
class Surroundings {
 public:
  explicit Surroundings(const World& world) : world_(world) {}
  /// Index of a body in scene(), which has it from then on; kWorld for the world.
  int add(BodyId id);
  /// The body of an index.
  BodyId id(int index) const { return index == kWorld ? BodyId{} : ids_[static_cast<std::size_t>(index)]; }
  Scene& scene() { return scene_; }

 private:
  const World& world_;
  Scene scene_;
  std::vector<BodyId> ids_;
};

}  // namespace rubble::c

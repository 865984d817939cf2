#include <concepts>
#include <fstream>
#include <utility>

#include "io/input_json.h"
#include "io/input_log.h"
#include "io/json_value.h"
#include "io/scene_json.h"
#include "io/soft_json.h"

namespace rubble::io {

nlohmann::ordered_json bareAttachment(const AttachmentDef& attachment) {
  nlohmann::ordered_json json = attachmentJson(attachment, nullptr);
  for (const char* key : {"object", "body", "other_object"}) json.erase(key);
  return json;
}

namespace {

using Ordered = nlohmann::ordered_json;

/// Throws Error for a value at `key` that is not what was expected.
[[noreturn]] void refuse(const char* key, const std::string& expected, const Ordered& json) {
  throw Error(key, expected, json.is_number() ? json.dump() : std::string(json.type_name()));
}

/// A line of a log. What writes a part of it calls itself for each level; definitions have two around them.
Ordered lineOf(const std::string& text) {
  constexpr int kMost = static_cast<int>(kMostJsonLevels) + 2;
  return Ordered::parse(text, [](int depth, Ordered::parse_event_t, const Ordered&) {
    if (depth > kMost)
      throw Error("line", "at most " + std::to_string(kMost) + " lists and objects within one another",
                  "more");
    return true;
  });
}

/// The library would convert real numbers, also those that no T has.
template <std::integral T> T wholeOf(const Ordered& json, const char* key) {
  const bool fits = json.is_number_unsigned()
                        ? std::in_range<T>(json.get<std::uint64_t>())
                        : json.is_number_integer() && std::in_range<T>(json.get<std::int64_t>());
  if (!fits) refuse(key, "a whole number of " + std::to_string(8 * sizeof(T)) + " bits", json);
  return json.get<T>();
}
/// Lists of exactly N values.
const Ordered& listOf(const Ordered& json, std::size_t count, const char* key) {
  if (!json.is_array() || json.size() != count) refuse(key, "a list of " + std::to_string(count), json);
  return json;
}
Vec3 vectorOf(const Ordered& json) {
  listOf(json, 3, "vector");
  return {json[0], json[1], json[2]};
}
Quat rotationOf(const Ordered& json) {
  listOf(json, 4, "orientation");
  return {json[0], {json[1], json[2], json[3]}};
}
template <class Id> Id idOf(const Ordered& json) {
  listOf(json, 2, "id");
  return {wholeOf<std::int32_t>(json[0], "id"), wholeOf<std::uint32_t>(json[1], "id")};
}
template <class Id> std::vector<Id> idsOf(const Ordered& json) {
  std::vector<Id> out;
  for (const Ordered& each : json) out.push_back(idOf<Id>(each));
  return out;
}
std::vector<Vec3> vectorsOf(const Ordered& json) {
  std::vector<Vec3> out;
  for (const Ordered& each : json) out.push_back(vectorOf(each));
  return out;
}
BodyState stateOf(const Ordered& json) {
  listOf(json, 4, "state");
  return {vectorOf(json[0]), rotationOf(json[1]), vectorOf(json[2]), vectorOf(json[3])};
}

JointDef jointOf(const Ordered& json) {
  // its frames are those of the bodies, so their poses do not matter
  Scene around;
  around.bodies.resize(4);
  return parseJoint(json.dump(), around, {0, 1, 2, 3});
}

/// Rows and values of scatter(), packed.
struct Rows {
  std::vector<std::int32_t> rows;
  std::vector<double> values;
  std::int64_t columns;

  Rows(const Ordered& c, std::int64_t numbers) : columns(numbers) {
    for (const Ordered& row : c.at("rows")) rows.push_back(wholeOf<std::int32_t>(row, "rows"));
    values = c.at("values").get<std::vector<double>>();
    if (values.size() != rows.size() * static_cast<std::size_t>(columns))
      throw Error("values", std::to_string(columns) + " numbers per row", std::to_string(values.size()));
  }
  ArrayView rowView() const { return packedArray(rows.data(), std::ssize(rows)); }
  ArrayView valueView() const { return packedArray(values.data(), std::ssize(rows), columns); }
};

/// One log and the world that follows it.
class Replayer {
 public:
  Replayer(const Ordered& head, const ReplayOptions& options)
      : scene_(sceneOf(head)),
        options_(optionsOf(head, options)),
        world_(scene_, options_),
        names_(head.at("tables")) {
    if (!options.record.empty()) record_.emplace(options.record, scene_, options_, world_);
  }

  World& world() { return world_; }
  void finish() {
    if (record_) record_->finish();
  }

  /// Makes a call but a step.
  void call(const std::string& name, const Ordered& c) {
    if (name == "add_bodies") {
      world_.addBodies(parseBodies(c.at("bodies").dump()));
    } else if (name == "remove_bodies") {
      world_.removeBodies(idsOf<BodyId>(c.at("ids")));
    } else if (name == "set_collide") {
      world_.setCollide(idOf<BodyId>(c.at("a")), idOf<BodyId>(c.at("b")), c.at("collide"));
    } else if (name == "set_states") {
      std::vector<BodyState> states;
      for (const Ordered& each : c.at("states")) states.push_back(stateOf(each));
      world_.setStates(idsOf<BodyId>(c.at("ids")), states);
    } else if (name == "set_target") {
      world_.setTarget(idOf<BodyId>(c.at("id")), vectorOf(c.at("position")), rotationOf(c.at("orientation")));
    } else if (name == "apply_forces") {
      world_.applyForces(idsOf<BodyId>(c.at("ids")), vectorsOf(c.at("forces")), vectorsOf(c.at("torques")));
    } else if (name == "apply_impulses") {
      world_.applyImpulses(idsOf<BodyId>(c.at("ids")), vectorsOf(c.at("impulses")));
    } else if (name == "wake") {
      world_.wake(idOf<BodyId>(c.at("id")));
    } else if (name == "sort_bodies") {
      world_.sortBodies();
    } else if (name == "scatter") {
      scatter(c);
    } else if (name == "scatter_joints") {
      const Rows rows(c, 1);
      world_.scatter(static_cast<JointArray>(wholeOf<int>(c.at("array"), "array")), rows.rowView(),
                     rows.valueView());
    } else if (name == "set_body_definition") {
      world_.setDefinition(idOf<BodyId>(c.at("id")), parseBody(c.at("body").dump()));
    } else if (name == "add_joint") {
      const std::vector<BodyId> bodies = idsOf<BodyId>(listOf(c.at("bodies"), 4, "bodies"));
      world_.addJoint(jointOf(c.at("joint")), bodies[0], bodies[1], bodies[2], bodies[3]);
    } else if (name == "remove_joint") {
      world_.removeJoint(idOf<JointId>(c.at("id")));
    } else if (name == "set_definition") {
      world_.setDefinition(idOf<JointId>(c.at("id")), jointOf(c.at("joint")));
    } else if (name == "add_deformable") {
      world_.addDeformable(parseDeformable(c.at("deformable").dump()));
    } else if (name == "remove_deformable") {
      world_.removeDeformable(idOf<DeformableId>(c.at("id")));
    } else if (name == "add_attachment") {
      world_.addAttachment(parseAttachment(c.at("attachment").dump()), idOf<DeformableId>(c.at("object")),
                           idOf<BodyId>(c.at("body")), idOf<DeformableId>(c.at("other_object")));
    } else if (name == "remove_attachment") {
      world_.removeAttachment(idOf<AttachmentId>(c.at("id")));
    } else if (name == "set_vertices") {
      world_.setVertices(idOf<DeformableId>(c.at("id")), vectorsOf(c.at("positions")),
                         vectorsOf(c.at("velocities")));
    } else if (name == "apply_vertex_force") {
      world_.applyVertexForce(idOf<DeformableId>(c.at("id")), wholeOf<int>(c.at("vertex"), "vertex"),
                              vectorOf(c.at("force")));
    } else if (name == "set_params") {
      Params params = world_.params();
      parseParams(c.at("params").dump(), params);
      world_.setParams(params);
    } else if (name == "set_gravity") {
      world_.setGravity(vectorOf(c.at("gravity")));
    } else if (name == "set_material_pair") {
      const MaterialPair pair = parseMaterialPair(c.at("pair").dump());
      c.at("removed") ? world_.removeMaterialPair(pair.a, pair.b) : world_.setMaterialPair(pair);
    } else if (name == "set_deformable_definition") {
      world_.setDefinition(idOf<DeformableId>(c.at("id")), parseDeformable(c.at("deformable").dump()));
    } else if (name == "take_snapshot") {
      snapshots_.push_back(world_.snapshot());
    } else if (name == "restore") {
      const auto number = wholeOf<std::uint32_t>(c.at("snapshot"), "snapshot");
      if (number >= snapshots_.size())
        refuse("snapshot", "one of the " + std::to_string(snapshots_.size()) + " that were taken", number);
      world_.restore(snapshots_[number]);
    } else {
      throw Error("call", "one of the calls of inputs.h", "\"" + name + "\"");
    }
  }

  /// The first table whose hash is another; a table that only one of the builds has is left out.
  std::optional<std::string> differenceFrom(const Ordered& hashes) const {
    for (const TableHash& own : world_.tableHashes())
      for (std::size_t k = 0; k < names_.size(); ++k)
        if (names_[k] == own.table && hashes.at(k) != own.hash) return own.table;
    return {};
  }

 private:
  static Scene sceneOf(const Ordered& head) {
    std::vector<Fault> faults;
    SceneFile file = parseScene(head.at("scene").dump(), faults);
    if (!faults.empty()) throw errorOf(faults.front());
    return std::move(file.scene);
  }
  static WorldOptions optionsOf(const Ordered& head, const ReplayOptions& options) {
    WorldOptions out;
    out.backend = options.backend.empty() ? head.at("backend").get<std::string>() : options.backend;
    out.threads = options.threads;
    parseParams(head.at("params").dump(), out.params);
    return out;
  }

  void scatter(const Ordered& c) {
    const auto which = static_cast<StateArray>(wholeOf<int>(c.at("array"), "array"));
    const Rows rows(c, which == StateArray::Orientation ? 4 : 3);
    world_.scatter(which, rows.rowView(), rows.valueView());
  }

  Scene scene_;
  WorldOptions options_;
  World world_;
  std::vector<std::string> names_;
  std::vector<Snapshot> snapshots_;
  std::optional<InputLog> record_;
};

/// Replays the lines behind the head, and counts all.
Replay replayLines(std::ifstream& in, std::string line, const ReplayOptions& options, int& number) {
  const Ordered head = lineOf(line);
  if (head.at("format") != kInputFormat)
    refuse("format", std::string("\"") + kInputFormat + "\"", head.at("format"));
  Replay result;
  result.recordedBy = head.at("build");
  Replayer replayer(head, options);
  const auto compare = [&](const Ordered& hashes) {
    if (auto table = replayer.differenceFrom(hashes)) result.difference = {result.steps, *table};
  };
  compare(head.at("hashes"));
  while (!result.difference && std::getline(in, line)) {
    ++number;
    const Ordered call = lineOf(line);
    if (const std::string name = call.at("call"); name != "step") {
      replayer.call(name, call);
      continue;
    }
    const Ordered& hashes = call.at("hashes");
    replayer.world().step();
    ++result.steps;
    compare(hashes);
  }
  result.hash = replayer.world().hash();
  replayer.finish();
  return result;
}

}  // namespace

Replay replayInputs(const std::string& file, const ReplayOptions& options) {
  std::ifstream in(file);
  if (!in) throw Error(file, "a file that can be read", "none");
  std::string line;
  int number = 1;
  if (!std::getline(in, line)) throw Error(file, "a log of inputs", "an empty file");
  const auto place = [&] { return file + ", line " + std::to_string(number); };
  try {
    return replayLines(in, std::move(line), options, number);
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error& error) {
    if (error.path().empty()) throw Error(place() + ": " + error.what());
    throw Error(place() + ": " + error.path(), error.expected(), error.found());
  } catch (const nlohmann::json::exception& error) {
    // without the name of the library's exception
    const std::string text = error.what();
    throw Error(place(), "a line of an input log", text.substr(text.find("] ") + 2));
  }
}

}  // namespace rubble::io

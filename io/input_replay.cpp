#include <fstream>

#include "io/input_json.h"
#include "io/input_log.h"
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

Vec3 vectorOf(const Ordered& json) { return {json.at(0), json.at(1), json.at(2)}; }
Quat rotationOf(const Ordered& json) { return {json.at(0), {json.at(1), json.at(2), json.at(3)}}; }
template <class Id> Id idOf(const Ordered& json) { return {json.at(0), json.at(1)}; }
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

JointDef jointOf(const Ordered& json) {
  // its frames are those of the bodies, so their poses do not matter
  Scene around;
  around.bodies.resize(4);
  return parseJoint(json.dump(), around, {0, 1, 2, 3});
}

/// Rows of a packed array.
template <class T> ArrayView viewOf(const std::vector<T>& content, std::int64_t columns, const char* type) {
  ArrayView view;
  view.data = content.data();
  view.shape[0] = static_cast<std::int64_t>(content.size()) / columns, view.shape[1] = columns;
  view.strides[0] = columns * static_cast<std::int64_t>(sizeof(T)), view.strides[1] = sizeof(T);
  view.typestr = type;
  return view;
}

/// One log and the world that follows it.
class Replayer {
 public:
  Replayer(const Ordered& head, const std::string& backend, int threads)
      : world_(sceneOf(head), optionsOf(head, backend, threads)), names_(head.at("tables")) {}

  World& world() { return world_; }

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
      for (const Ordered& s : c.at("states"))
        states.push_back({vectorOf(s.at(0)), rotationOf(s.at(1)), vectorOf(s.at(2)), vectorOf(s.at(3))});
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
      const auto rows = c.at("rows").get<std::vector<std::int32_t>>();
      const auto values = c.at("values").get<std::vector<double>>();
      world_.scatter(static_cast<JointArray>(c.at("array").get<int>()), viewOf(rows, 1, "<i4"),
                     viewOf(values, 1, "<f8"));
    } else if (name == "set_body_definition") {
      world_.setDefinition(idOf<BodyId>(c.at("id")), parseBody(c.at("body").dump()));
    } else if (name == "add_joint") {
      const std::vector<BodyId> bodies = idsOf<BodyId>(c.at("bodies"));
      world_.addJoint(jointOf(c.at("joint")), bodies.at(0), bodies.at(1), bodies.at(2), bodies.at(3));
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
      world_.applyVertexForce(idOf<DeformableId>(c.at("id")), c.at("vertex"), vectorOf(c.at("force")));
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
      world_.restore(snapshots_.at(c.at("snapshot").get<std::size_t>()));
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
  static WorldOptions optionsOf(const Ordered& head, const std::string& backend, int threads) {
    WorldOptions options;
    options.backend = backend.empty() ? head.at("backend").get<std::string>() : backend;
    options.threads = threads;
    parseParams(head.at("params").dump(), options.params);
    return options;
  }

  void scatter(const Ordered& c) {
    const int which = c.at("array");
    const std::int64_t columns = static_cast<StateArray>(which) == StateArray::Orientation ? 4 : 3;
    const auto rows = c.at("rows").get<std::vector<std::int32_t>>();
    const auto values = c.at("values").get<std::vector<double>>();
    world_.scatter(static_cast<StateArray>(which), viewOf(rows, 1, "<i4"), viewOf(values, columns, "<f8"));
  }

  World world_;
  std::vector<std::string> names_;
  std::vector<Snapshot> snapshots_;
};

}  // namespace

Replay replayInputs(const std::string& file, const std::string& backend, int threads) {
  std::ifstream in(file);
  if (!in) throw Error(file, "a file that can be read", "none");
  std::string line;
  int number = 1;
  if (!std::getline(in, line)) throw Error(file, "a log of inputs", "an empty file");
  try {
    const Ordered head = Ordered::parse(line);
    if (head.at("format") != kInputFormat)
      throw Error(file, std::string("a log of \"") + kInputFormat + "\"", head.at("format").dump());
    Replay result;
    result.recordedBy = head.at("build");
    Replayer replayer(head, backend, threads);
    const auto compare = [&](const Ordered& hashes) {
      if (auto table = replayer.differenceFrom(hashes)) result.difference = {result.steps, *table};
    };
    compare(head.at("hashes"));
    while (!result.difference && std::getline(in, line)) {
      ++number;
      const Ordered call = Ordered::parse(line);
      if (const std::string name = call.at("call"); name != "step") {
        replayer.call(name, call);
        continue;
      }
      replayer.world().step();
      ++result.steps;
      compare(call.at("hashes"));
    }
    result.hash = replayer.world().hash();
    return result;
  } catch (const nlohmann::json::exception& error) {
    // without the name of the library's exception
    const std::string text = error.what();
    throw Error(file + ", line " + std::to_string(number), "a line of an input log",
                text.substr(text.find("] ") + 2));
  }
}

}  // namespace rubble::io

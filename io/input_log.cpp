#include "io/input_log.h"

#include <algorithm>

#include <rubble/info.h>

#include "io/definition_json.h"
#include "io/input_json.h"
#include "io/scene_json.h"
#include "io/shape_json.h"

namespace rubble::io {
namespace {

using Ordered = nlohmann::ordered_json;

template <class Id> Ordered idsJson(std::span<const Id> ids) {
  Ordered json = Ordered::array();
  for (const Id id : ids) json.push_back(inputJson(id));
  return json;
}
Ordered vectorsJson(std::span<const Vec3> vectors) {
  Ordered json = Ordered::array();
  for (const Vec3& v : vectors) json.push_back(inputJson(v));
  return json;
}

/// Rows of 32-bit integers, or of numbers of either size.
Ordered rowsJson(const ArrayView& view) {
  Ordered json = Ordered::array();
  for (std::int64_t row = 0; row < view.shape[0]; ++row)
    for (std::int64_t column = 0; column < view.shape[1]; ++column) {
      const char* const at = static_cast<const char*>(view.data) + row * view.strides[0] +
                             column * view.strides[1];
      if (view.typestr[1] == 'i')
        json.push_back(*reinterpret_cast<const std::int32_t*>(at));
      else if (view.typestr[2] == '8')
        json.push_back(*reinterpret_cast<const double*>(at));
      else
        json.push_back(static_cast<double>(*reinterpret_cast<const float*>(at)));
    }
  return json;
}

/// Arguments of each call but of those that read the world or its snapshots.
struct Arguments {
  Ordered operator()(const inputs::AddBodies& c) const {
    Ordered json = Ordered::array();
    for (const BodyDef& body : c.bodies) json.push_back(Ordered::parse(toJson(body)));
    return {{"bodies", json}};
  }
  Ordered operator()(const inputs::RemoveBodies& c) const { return {{"ids", idsJson(c.ids)}}; }
  Ordered operator()(const inputs::SetCollide& c) const {
    return {{"a", inputJson(c.a)}, {"b", inputJson(c.b)}, {"collide", c.collide}};
  }
  Ordered operator()(const inputs::SetStates& c) const {
    Ordered states = Ordered::array();
    for (const BodyState& s : c.states)
      states.push_back({inputJson(s.position), inputJson(s.orientation), inputJson(s.velocity),
                        inputJson(s.angularVelocity)});
    return {{"ids", idsJson(c.ids)}, {"states", states}};
  }
  Ordered operator()(const inputs::SetTarget& c) const {
    return {{"id", inputJson(c.id)},
            {"position", inputJson(c.position)},
            {"orientation", inputJson(c.orientation)}};
  }
  Ordered operator()(const inputs::ApplyForces& c) const {
    return {{"ids", idsJson(c.ids)}, {"forces", vectorsJson(c.forces)}, {"torques", vectorsJson(c.torques)}};
  }
  Ordered operator()(const inputs::ApplyImpulses& c) const {
    return {{"ids", idsJson(c.ids)}, {"impulses", vectorsJson(c.impulses)}};
  }
  Ordered operator()(const inputs::Wake& c) const { return {{"id", inputJson(c.id)}}; }
  Ordered operator()(const inputs::SortBodies&) const { return Ordered::object(); }
  Ordered operator()(const inputs::Scatter& c) const {
    if (c.values.device) throw Error("inputs", "arrays in host memory", "device memory");
    return {{"array", static_cast<int>(c.which)}, {"rows", rowsJson(c.rows)}, {"values", rowsJson(c.values)}};
  }
  Ordered operator()(const inputs::ScatterJoints& c) const {
    if (c.values.device) throw Error("inputs", "arrays in host memory", "device memory");
    return {{"array", static_cast<int>(c.which)}, {"rows", rowsJson(c.rows)}, {"values", rowsJson(c.values)}};
  }
  Ordered operator()(const inputs::AddJoint& c) const {
    return {{"joint", bareJoint(c.joint)},
            {"bodies", {inputJson(c.a), inputJson(c.b), inputJson(c.frameBodyA), inputJson(c.frameBodyB)}}};
  }
  Ordered operator()(const inputs::RemoveJoint& c) const { return {{"id", inputJson(c.id)}}; }
  Ordered operator()(const inputs::SetDefinition& c) const {
    return {{"id", inputJson(c.id)}, {"joint", bareJoint(c.joint)}};
  }
  Ordered operator()(const inputs::SetBodyDefinition& c) const {
    return {{"id", inputJson(c.id)}, {"body", Ordered::parse(toJson(c.body))}};
  }
  Ordered operator()(const inputs::AddDeformable& c) const {
    return {{"deformable", Ordered::parse(toJson(c.deformable))}};
  }
  Ordered operator()(const inputs::RemoveDeformable& c) const { return {{"id", inputJson(c.id)}}; }
  Ordered operator()(const inputs::AddAttachment& c) const {
    return {{"attachment", bareAttachment(c.attachment)},
            {"object", inputJson(c.object)},
            {"body", inputJson(c.body)},
            {"other_object", inputJson(c.otherObject)}};
  }
  Ordered operator()(const inputs::RemoveAttachment& c) const { return {{"id", inputJson(c.id)}}; }
  Ordered operator()(const inputs::SetVertices& c) const {
    return {{"id", inputJson(c.id)},
            {"positions", vectorsJson(c.positions)},
            {"velocities", vectorsJson(c.velocities)}};
  }
  Ordered operator()(const inputs::ApplyVertexForce& c) const {
    return {{"id", inputJson(c.id)}, {"vertex", c.vertex}, {"force", inputJson(c.force)}};
  }
  Ordered operator()(const inputs::SetParams& c) const {
    return {{"params", Ordered::parse(toJson(c.params))}};
  }
  Ordered operator()(const inputs::SetMaterialPair& c) const {
    return {{"pair", materialPairJson(c.pair)}, {"removed", c.removed}};
  }
  Ordered operator()(const inputs::SetDeformableDefinition& c) const {
    return {{"id", inputJson(c.id)}, {"deformable", Ordered::parse(toJson(c.deformable))}};
  }
  Ordered operator()(const inputs::SetGravity& c) const { return {{"gravity", inputJson(c.gravity)}}; }
};

Ordered hashesJson(const World& world) {
  Ordered json = Ordered::array();
  for (const TableHash& each : world.tableHashes()) json.push_back(each.hash);
  return json;
}

}  // namespace

InputLog::InputLog(const std::string& file, const Scene& scene, const WorldOptions& options, World& world)
    : out_(file), world_(world) {
  SceneFile initial;
  initial.scene = scene;
  initial.scene.events.clear();  // they are calls
  const BuildInfo build = buildInfo();
  Ordered names = Ordered::array();
  for (const TableHash& each : world.tableHashes()) names.push_back(each.table);
  writeLine({{"format", kInputFormat},
             {"build", build.version + ", " + build.commit + ", " + build.compiler},
             {"backend", options.backend},
             {"params", Ordered::parse(toJson(world.params()))},
             {"scene", Ordered::parse(toJson(initial))},
             {"tables", names},
             {"hashes", hashesJson(world)}});
  world.setInputSink([this](const inputs::Call& call) {
    Ordered line = std::visit(
        [this]<class C>(const C& c) -> Ordered {
          if constexpr (std::is_same_v<C, inputs::Step>) {
            return {{"hashes", hashesJson(world_)}};
          } else if constexpr (std::is_same_v<C, inputs::TakeSnapshot>) {
            snapshots_.push_back(c.snapshot);
            return Ordered::object();
          } else if constexpr (std::is_same_v<C, inputs::Restore>) {
            const auto found = std::ranges::find(snapshots_, c.snapshot.data, &Snapshot::data);
            if (found == snapshots_.end())
              throw Error("inputs", "a snapshot that was taken in this log", "another");
            return {{"snapshot", found - snapshots_.begin()}};
          } else {
            return Arguments{}(c);
          }
        },
        call);
    line["call"] = kInputNames[call.index()];
    writeLine(line);
  });
}

InputLog::~InputLog() { world_.setInputSink({}); }

void InputLog::writeLine(const Ordered& json) {
  // names of materials may be no UTF-8
  out_.stream() << json.dump(-1, ' ', false, Ordered::error_handler_t::replace) << '\n';
}

void InputLog::finish() {
  world_.setInputSink({});
  out_.finish();
}

}  // namespace rubble::io

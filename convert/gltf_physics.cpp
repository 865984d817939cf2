#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include <rubble/error.h>

#include "convert/colors.h"
#include "convert/free_model.h"
#include "convert/geometry.h"
#include "convert/gltf.h"
#include "convert/gltf_file.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

constexpr const char* kPhysics = "KHR_physics_rigid_bodies";
constexpr double kLargest = 1e15;
constexpr int kMostDepth = 200;

/// An object of the file with typed access. Keys that are read count as known; finish() notes the others.
class Reader {
 public:
  Reader(const GltfJson& json, std::string where, Report& report)
      : json_(json), where_(std::move(where)), report_(report) {}

  bool isThere() const { return json_.is_object(); }
  Place place() const { return {where_, 0}; }
  std::string path(const std::string& key) const { return where_ + "." + key; }
  const GltfJson& get(const char* key) {
    known_.insert(key);
    return GltfFile::child(json_, key);
  }
  Reader child(const char* key) { return {get(key), path(key), report_}; }
  double number(const char* key, double otherwise) {
    const GltfJson& value = get(key);
    if (value.is_null()) return otherwise;
    if (!value.is_number() || !(std::fabs(value.get<double>()) <= kLargest))
      throw Error(path(key), "a number of at most 1e15", value.dump().substr(0, 40));
    return value.get<double>();
  }
  double atLeast0(const char* key, double otherwise) {
    const double value = number(key, otherwise);
    if (value < 0) throw Error(path(key), "a number of at least 0", std::to_string(value));
    return value;
  }
  bool flag(const char* key, bool otherwise) {
    const GltfJson& value = get(key);
    if (value.is_null()) return otherwise;
    if (!value.is_boolean()) throw Error(path(key), "true or false", value.dump().substr(0, 40));
    return value.get<bool>();
  }
  std::string text(const char* key) {
    const GltfJson& value = get(key);
    return value.is_string() ? value.get<std::string>() : "";
  }
  std::vector<double> numbers(const char* key, std::vector<double> otherwise) {
    const GltfJson& value = get(key);
    if (value.is_null()) return otherwise;
    std::vector<double> out;
    if (value.is_array())
      for (const GltfJson& each : value)
        if (each.is_number() && std::fabs(each.get<double>()) <= kLargest) out.push_back(each.get<double>());
    if (!value.is_array() || out.size() != value.size() ||
        (!otherwise.empty() && out.size() != otherwise.size()))
      throw Error(path(key), std::to_string(otherwise.size()) + " numbers", value.dump().substr(0, 40));
    return out;
  }
  Vec3 vector(const char* key, const Vec3& otherwise = {}) {
    const auto v = numbers(key, {otherwise.x, otherwise.y, otherwise.z});
    return {v[0], v[1], v[2]};
  }
  Quat quaternion(const char* key) {
    const auto q = numbers(key, {0, 0, 0, 1});
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    if (!(norm > 1e-10)) throw Error(path(key), "a quaternion of some length", "one of length 0");
    return normalize(Quat{q[3] / norm, q[0] / norm, q[1] / norm, q[2] / norm});
  }
  void finish() {
    if (!isThere()) return;
    for (const auto& [key, value] : json_.items())
      if (!known_.contains(key) && key != "name" && key != "extras")
        report_.note(Effect::Lost, place(), key, "a property that is not known here");
  }

 private:
  const GltfJson& json_;
  std::string where_;
  Report& report_;
  std::set<std::string> known_;
};

class PhysicsReader {
 public:
  PhysicsReader(const std::string& bytes, const std::string& name, Folders& folders, Report& report)
      : file_(bytes, name), folders_(folders), report_(report) {}

  Model read() {
    Link world;
    world.name = "world", world.place = {file_.name(), 0};
    model_.links.push_back(world);
    model_.name = std::filesystem::path(file_.name()).stem().string();
    physics_ = &GltfFile::child(GltfFile::child(file_.json(), "extensions"), kPhysics);
    nodes_ = &GltfFile::child(file_.json(), "nodes");
    const std::size_t count = nodes_->is_array() ? nodes_->size() : 0;
    linkOf_.assign(count, -1), frameOf_.resize(count), seen_.assign(count, false);
    const Affine up = Affine::of({{}, quatOfEuler({std::numbers::pi / 2, 0, 0}, "xyz")});
    for (const std::size_t root : roots(count)) visit(root, up, -1, 0);
    const bool isChosen = GltfFile::child(file_.json(), "scenes").is_array();
    if (const auto lost = std::find(seen_.begin(), seen_.end(), false); !isChosen && lost != seen_.end())
      throw Error(where(static_cast<std::size_t>(lost - seen_.begin())), "a tree of nodes", "a cycle");
    for (std::size_t i = 0; i < count; ++i)
      if (seen_[i]) addCollider(i);
    for (std::size_t i = 0; i < count; ++i)
      if (seen_[i]) addDrawn(i);
    finishMasses();
    for (std::size_t i = 0; i < count; ++i)
      if (seen_[i]) addJoint(i);
    filterBodies();
    return std::move(model_);
  }

 private:
  std::string where(std::size_t node) const { return file_.name() + "#/nodes/" + std::to_string(node); }
  Reader physicsOf(std::size_t node) {
    return {GltfFile::child(GltfFile::child((*nodes_)[node], "extensions"), kPhysics),
            where(node) + "/" + kPhysics, report_};
  }
  std::string nameOf(std::size_t node) const {
    const GltfJson& name = GltfFile::child((*nodes_)[node], "name");
    return name.is_string() ? name.get<std::string>() : "node" + std::to_string(node);
  }
  std::vector<std::size_t> indices(const GltfJson& list, std::size_t count, const std::string& who) const {
    std::vector<std::size_t> out;
    if (list.is_null()) return out;
    if (!list.is_array()) throw Error(who, "a list of nodes", "something else");
    for (const GltfJson& each : list) {
      if (!each.is_number_integer() || each.get<std::int64_t>() < 0 || each.get<std::size_t>() >= count)
        throw Error(who, "indices of nodes", each.dump().substr(0, 40));
      out.push_back(each.get<std::size_t>());
    }
    return out;
  }
  std::vector<std::size_t> roots(std::size_t count) const {
    const GltfJson& scenes = GltfFile::child(file_.json(), "scenes");
    if (scenes.is_array() && !scenes.empty()) {
      const GltfJson& chosen = GltfFile::child(file_.json(), "scene");
      const GltfJson& scene = file_.entry(scenes, chosen.is_null() ? GltfJson(0) : chosen,
                                          file_.name() + "#/scene");
      return indices(GltfFile::child(scene, "nodes"), count, file_.name() + "#/scenes");
    }
    std::vector<bool> isChild(count, false);
    for (std::size_t i = 0; i < count; ++i)
      for (const std::size_t child : indices(GltfFile::child((*nodes_)[i], "children"), count, where(i)))
        isChild[child] = true;
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < count; ++i)
      if (!isChild[i]) out.push_back(i);
    return out;
  }

  void visit(std::size_t i, const Affine& parent, int link, int depth) {
    if (seen_[i] || depth > kMostDepth)
      throw Error(where(i), "a tree of at most 200 levels", "another graph");
    seen_[i] = true;
    const GltfJson& node = (*nodes_)[i];
    Reader own(node, where(i), report_);
    Affine local;
    if (node.contains("matrix")) {
      const auto m = own.numbers("matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
      local = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
    } else {
      local = Affine::of({own.vector("translation"), own.quaternion("rotation")}) *
              Affine::scaling(own.vector("scale", {1, 1, 1}));
    }
    frameOf_[i] = parent * local;
    if (!frameOf_[i].isFinite()) throw Error(where(i), "a frame of finite numbers", "others");
    Reader physics = physicsOf(i);
    Reader motion = physics.child("motion");
    if (motion.isThere()) link = addBody(i, motion);
    linkOf_[i] = link;
    for (const char* key : {"collider", "trigger", "joint"}) physics.get(key);
    physics.finish();
    if (!GltfFile::child(GltfFile::child(GltfFile::child(node, "extensions"), kPhysics), "trigger").is_null())
      report_.note(Effect::Lost, {where(i), 0}, "trigger" + inQuotes(nameOf(i)), "a trigger");
    for (const std::size_t child : indices(GltfFile::child(node, "children"), seen_.size(), where(i)))
      visit(child, frameOf_[i], link, depth + 1);
  }

  int addBody(std::size_t i, Reader& motion) {
    Link link;
    link.name = nameOf(i);
    link.place = {where(i), 0};
    link.parent = 0;
    link.pose = frameOf_[i].rigid();
    link.kinematic = motion.flag("isKinematic", false), link.free = !link.kinematic;
    link.gravityScale = motion.number("gravityFactor", 1);
    const Quat turn = link.pose.q;
    link.velocity = rotate(turn, motion.vector("linearVelocity"));
    link.angularVelocity = rotate(turn, motion.vector("angularVelocity"));
    Given given{motion.atLeast0("mass", 0), std::nullopt, std::nullopt,
                motion.quaternion("inertiaOrientation")};
    if (!motion.get("centerOfMass").is_null())
      given.center = inverse(link.pose) * (frameOf_[i] * motion.vector("centerOfMass"));
    if (!motion.get("inertiaDiagonal").is_null()) given.inertia = motion.vector("inertiaDiagonal");
    motion.finish();
    model_.links.push_back(std::move(link));
    given_.resize(model_.links.size()), solids_.resize(model_.links.size());
    given_.back() = given;
    return static_cast<int>(model_.links.size()) - 1;
  }

  void finishMasses() {
    for (std::size_t i = 1; i < model_.links.size(); ++i) {
      Link& link = model_.links[i];
      if (link.kinematic) continue;
      const Given& given = given_[i];
      MassProperties out;
      constexpr double kUsualDensity = 1000, kRadius = 0.1;
      if (solids_[i].volume > 0)
        out = principal(placed(solids_[i], {}, {}, kUsualDensity));
      else
        out.mass = 1, out.inertia = Vec3{1, 1, 1} * (0.4 * kRadius * kRadius);
      if (given.mass > 0) out.inertia *= given.mass / out.mass, out.mass = given.mass;
      if (given.center) out.center = *given.center;
      if (given.inertia && std::min({given.inertia->x, given.inertia->y, given.inertia->z}) > 0)
        out.inertia = *given.inertia, out.axes = given.axes;
      link.mass = sumsOf(out);
    }
  }

  Material materialOf(const GltfJson& index, const std::string& who) {
    Material out;
    if (index.is_null()) return out;
    Reader own(file_.entry(GltfFile::child(*physics_, "physicsMaterials"), index, who),
               file_.name() + "#/physicsMaterials/" + index.dump(), report_);
    out.dynamicFriction = own.atLeast0("dynamicFriction", 0.6);
    out.staticFriction = std::max(own.atLeast0("staticFriction", 0.6), out.dynamicFriction);
    out.restitution = std::min(own.atLeast0("restitution", 0), 1.);
    const auto combine = [&](const char* key) {
      const std::string rule = own.text(key);
      return rule == "minimum"    ? Combine::Minimum
             : rule == "maximum"  ? Combine::Maximum
             : rule == "multiply" ? Combine::Multiply
                                  : Combine::Average;
    };
    out.frictionCombine = combine("frictionCombine"), out.restitutionCombine = combine("restitutionCombine");
    own.finish();
    return out;
  }

  void addCollider(std::size_t i) {
    Reader physics = physicsOf(i);
    Reader collider = physics.child("collider");
    if (!collider.isThere()) return;
    Reader geometry = collider.child("geometry");
    FreeShape shape;
    const GltfJson &implicit = geometry.get("shape"), &mesh = geometry.get("mesh"),
                   &node = geometry.get("node");
    if (!implicit.is_null()) {
      if (!implicitShape(implicit, shape)) return;
    } else {
      const GltfJson* index = &mesh;
      if (mesh.is_null() && !node.is_null())
        index = &GltfFile::child(file_.entry(*nodes_, node, geometry.path("node")), "mesh");
      if (index->is_null()) index = &GltfFile::child((*nodes_)[i], "mesh");
      shape.type = FreeShape::Type::Mesh;
      shape.mesh = file_.mesh(*index, geometry.path("mesh"), folders_);
      shape.as = geometry.flag("convexHull", false) ? FreeShape::Mesh::Hull : FreeShape::Mesh::Triangles;
    }
    geometry.get("convexHull");
    geometry.finish();
    const int index = std::max(linkOf_[i], 0);
    Link& link = model_.links[static_cast<std::size_t>(index)];
    given_.resize(model_.links.size()), solids_.resize(model_.links.size());
    Geom like;
    like.name = nameOf(i), like.place = {where(i), 0};
    like.material = materialOf(collider.get("physicsMaterial"), collider.path("physicsMaterial"));
    const GltfJson& filter = collider.get("collisionFilter");
    if (!filter.is_null()) filters_[index] = filter;
    collider.finish();
    const bool isStatic = index == 0 || link.kinematic;
    if (addShape(link, shape, Affine::of(inverse(link.pose)) * frameOf_[i], like, isStatic,
                 solids_[static_cast<std::size_t>(index)], report_))
      report_.converted(like.place, "collider" + inQuotes(like.name),
                        index == 0 ? "static shape" : "shape of body" + inQuotes(link.name));
  }

  /// What is seen of a node: each part of its mesh in the color of its material.
  void addDrawn(std::size_t i) {
    const GltfJson& index = GltfFile::child((*nodes_)[i], "mesh");
    if (index.is_null()) return;
    const std::string who = where(i) + ".mesh";
    try {
      addDrawn(i, index, who);
    } catch (const Error& error) {
      report_.note(Effect::None, {where(i), 0}, "mesh" + inQuotes(nameOf(i)), error.what());
    }
  }
  void addDrawn(std::size_t i, const GltfJson& index, const std::string& who) {
    const GltfJson& parts = GltfFile::child(file_.entry(GltfFile::child(file_.json(), "meshes"), index, who),
                                            "primitives");
    Link& link = model_.links[static_cast<std::size_t>(std::max(linkOf_[i], 0))];
    const Affine toLink = Affine::of(inverse(link.pose)) * frameOf_[i];
    for (std::size_t k = 0; parts.is_array() && k < parts.size(); ++k) {
      TriangleMesh mesh = file_.mesh(index, who, folders_, k);
      for (Vec3& point : mesh.vertices) point = toLink * point;
      if (std::optional<Shape> shape = drawnMesh(std::move(mesh)))
        link.drawn.push_back(
            {std::move(*shape), {}, colorOf(GltfFile::child(parts[k], "material"), who), -1});
    }
  }

  std::optional<Vec3> colorOf(const GltfJson& material, const std::string& who) {
    if (material.is_null()) return std::nullopt;
    const GltfJson& own = file_.entry(GltfFile::child(file_.json(), "materials"), material, who);
    Reader surface(GltfFile::child(own, "pbrMetallicRoughness"), who, report_);
    const std::vector<double> color = surface.numbers("baseColorFactor", {1, 1, 1, 1});
    return srgbOf({color[0], color[1], color[2]});
  }

  bool implicitShape(const GltfJson& index, FreeShape& out) {
    const GltfJson& list = GltfFile::child(
        GltfFile::child(GltfFile::child(file_.json(), "extensions"), "KHR_implicit_shapes"), "shapes");
    Reader shape(file_.entry(list, index, file_.name() + "#/KHR_implicit_shapes"),
                 file_.name() + "#/KHR_implicit_shapes/" + index.dump(), report_);
    const std::string type = shape.text("type");
    Reader own = shape.child(type.c_str());
    out.axis = 1;
    if (type == "box") {
      out.size = own.vector("size", {1, 1, 1});
    } else if (type == "sphere") {
      out.type = FreeShape::Type::Sphere, out.radius = own.number("radius", 0.5);
    } else if (type == "capsule" || type == "cylinder") {
      out.type = type == "capsule" ? FreeShape::Type::Capsule : FreeShape::Type::Cylinder;
      out.height = own.number("height", 0.5);
      out.radius = own.number("radiusBottom", 0.25), out.topRadius = own.number("radiusTop", 0.25);
    } else if (type == "plane") {
      out.type = FreeShape::Type::Plane;
      own.number("sizeX", 0), own.number("sizeZ", 0), own.flag("doubleSided", false);
    } else {
      report_.note(Effect::Lost, shape.place(), "shape", "a shape of the type '" + type + "'");
      return false;
    }
    own.finish(), shape.finish();
    return true;
  }

  void addJoint(std::size_t i) {
    Reader physics = physicsOf(i);
    Reader joint = physics.child("joint");
    if (!joint.isThere()) return;
    const GltfJson& other = joint.get("connectedNode");
    file_.entry(*nodes_, other, joint.path("connectedNode"));
    const auto connected = other.get<std::size_t>();
    FreeJoint out;
    out.place = {where(i), 0};
    out.linkA = linkOf_[connected], out.linkB = linkOf_[i];
    const auto inLink = [&](std::size_t node, int link) {
      const Pose world = frameOf_[node].rigid();
      return link < 0 ? world : inverse(model_.links[static_cast<std::size_t>(link)].pose) * world;
    };
    const Pose a = inLink(connected, out.linkA), b = inLink(i, out.linkB);
    const GltfJson& index = joint.get("joint");
    Reader settings(file_.entry(GltfFile::child(*physics_, "physicsJoints"), index, joint.path("joint")),
                    file_.name() + "#/physicsJoints/" + index.dump(), report_);
    std::array<JointAxis, 6> axes;
    readLimits(settings, axes), readDrives(settings, axes);
    settings.finish();
    out.joint = jointOfAxes(axes);
    out.joint.name = nameOf(i);
    out.joint.collide = joint.flag("enableCollision", false);
    out.joint.anchorA = a.p, out.joint.anchorB = b.p, out.joint.frameA = a.q, out.joint.frameB = b.q;
    joint.finish();
    model_.joints.push_back(std::move(out));
  }

  void readLimits(Reader& settings, std::array<JointAxis, 6>& axes) {
    const GltfJson& list = settings.get("limits");
    for (std::size_t k = 0; list.is_array() && k < list.size(); ++k) {
      Reader limit(list[k], settings.path("limits") + "[" + std::to_string(k) + "]", report_);
      const double low = limit.number("min", -kLargest), high = limit.number("max", kLargest);
      const double stiffness = limit.number("stiffness", kLargest), damping = limit.atLeast0("damping", 0);
      std::vector<std::size_t> chosen;
      for (const auto& [key, first] : {std::pair{"linearAxes", 0u}, {"angularAxes", 3u}})
        for (const double axis : limit.numbers(key, {}))
          if (axis == 0 || axis == 1 || axis == 2) chosen.push_back(first + static_cast<std::size_t>(axis));
      limit.finish();
      if (chosen.size() > 1 && low != high && (low > -kLargest || high < kLargest))
        report_.note(Effect::Approximate, limit.place(), "limit",
                     "a limit of several axes together bounds each of them");
      for (const std::size_t axis : chosen) {
        JointAxis& own = axes[axis];
        own.min = low > -kLargest ? low : -kFree, own.max = high < kLargest ? high : kFree;
        if (own.min > own.max) own.min = own.max = 0;
        if (stiffness > 0 && stiffness < kLargest) own.limitStiffness = stiffness, own.limitDamping = damping;
      }
    }
  }
  void readDrives(Reader& settings, std::array<JointAxis, 6>& axes) {
    const GltfJson& list = settings.get("drives");
    for (std::size_t k = 0; list.is_array() && k < list.size(); ++k) {
      Reader drive(list[k], settings.path("drives") + "[" + std::to_string(k) + "]", report_);
      const double axis = drive.number("axis", 0);
      if (axis != 0 && axis != 1 && axis != 2)
        throw Error(drive.path("axis"), "0, 1 or 2", std::to_string(axis));
      JointAxis& own = axes[(drive.text("type") == "angular" ? 3u : 0u) + static_cast<std::size_t>(axis)];
      own.driveStiffness = drive.atLeast0("stiffness", 0), own.driveDamping = drive.atLeast0("damping", 0);
      own.targetPosition = drive.number("positionTarget", 0),
      own.targetSpeed = drive.number("velocityTarget", 0);
      const double most = drive.number("maxForce", kLargest);
      if (most > 0 && most < kLargest) own.maxDriveForce = most;
      if (drive.text("mode") == "acceleration")
        report_.note(Effect::Approximate, drive.place(), "mode",
                     "a drive of accelerations has its stiffness and damping as for a mass or inertia of 1");
      drive.finish();
    }
  }

  /// Pairs of bodies whose filters keep them apart.
  void filterBodies() {
    const GltfJson& list = GltfFile::child(*physics_, "collisionFilters");
    struct Systems {
      std::set<std::string> own, never, only;
    };
    std::map<int, Systems> systems;
    for (const auto& [link, index] : filters_) {
      Reader own(file_.entry(list, index, file_.name() + "#/collisionFilters"),
                 file_.name() + "#/collisionFilters/" + index.dump(), report_);
      const auto names = [&](const char* key) {
        std::set<std::string> out;
        const GltfJson& texts = own.get(key);
        for (std::size_t i = 0; texts.is_array() && i < texts.size(); ++i)
          if (texts[i].is_string()) out.insert(texts[i].get<std::string>());
        return out;
      };
      systems[link] = {names("collisionSystems"), names("notCollideWithSystems"),
                       names("collideWithSystems")};
      own.finish();
    }
    const auto meets = [](const std::set<std::string>& a, const std::set<std::string>& b) {
      return std::any_of(a.begin(), a.end(), [&](const std::string& each) { return b.contains(each); });
    };
    const auto apart = [&](const Systems& a, const Systems& b) {
      return meets(a.never, b.own) || (!a.only.empty() && !meets(a.only, b.own));
    };
    constexpr std::size_t kMostPairs = 1000000;
    for (auto a = systems.begin(); a != systems.end(); ++a)
      for (auto b = std::next(a); b != systems.end(); ++b) {
        if (!apart(a->second, b->second) && !apart(b->second, a->second)) continue;
        if (model_.exclusions.size() >= kMostPairs)
          throw Error(file_.name(), "at most a million pairs that do not collide", "more");
        model_.exclusions.emplace_back(a->first == 0 ? -1 : a->first, b->first == 0 ? -1 : b->first);
      }
  }

  struct Given {
    double mass = 0;  ///< 0: by density
    std::optional<Vec3> center, inertia;
    Quat axes;
  };

  GltfFile file_;
  Folders& folders_;
  Report& report_;
  Model model_;
  const GltfJson* physics_ = nullptr;
  const GltfJson* nodes_ = nullptr;
  std::vector<int> linkOf_;  ///< of each node; -1: the world
  std::vector<Affine> frameOf_;
  std::vector<bool> seen_;
  std::vector<Given> given_;       ///< of each link
  std::vector<SolidSums> solids_;  ///< of each link, at density 1
  std::map<int, GltfJson> filters_;
};

}  // namespace

Model readGltf(const std::string& bytes, const std::string& file, Folders& folders, Report& report) {
  return PhysicsReader(bytes, file, folders, report).read();
}

bool isGltfFile(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending != ".gltf" && ending != ".glb") return false;
  try {
    const GltfFile content(bytesOf(file, file), file);
    const GltfJson& used = GltfFile::child(content.json(), "extensionsUsed");
    return used.is_array() && std::find(used.begin(), used.end(), GltfJson(kPhysics)) != used.end();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace rubble::convert

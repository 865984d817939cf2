/// USD scenes with UsdPhysics: the tree of prims, bodies and their masses, filters, and the report.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <numbers>

#include <rubble/error.h>

#include "convert/rotations.h"
#include "convert/usd_reader.h"

namespace rubble::convert {
namespace {

/// Most pairs of bodies that filters may name.
constexpr std::size_t kMostPairs = 1000000;

bool isJoint(const std::string& type) { return type.starts_with("Physics") && type.ends_with("Joint"); }

}  // namespace

bool isUsdFile(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  return ending == ".usd" || ending == ".usda" || ending == ".usdc" || ending == ".usdz";
}

Model UsdReader::read(const std::string& bytes, const std::string& file) {
  std::vector<usd::Missing> missing;
  UsdFiles files(folders_);
  const usd::Find find = [&](const std::string& asset, const std::string& layer, const std::string& who) {
    return files.find(asset, layer, who);
  };
  const usd::Read read = [&](const std::string& name, const std::string& who) {
    return files.read(name, who);
  };
  std::string name = file;
  const std::string content = files.open(bytes, name);
  const usd::Stage stage = usd::openStage(content, name, find, read, missing);
  for (const usd::Missing& each : missing)
    report_.note(Effect::Lost, {each.file, each.line}, "reference of " + each.prim, each.why);
  stage_ = &stage.root;
  metersPerUnit_ = stage.metersPerUnit, kilogramsPerUnit_ = stage.kilogramsPerUnit;
  if (!(metersPerUnit_ > 1e-9 && metersPerUnit_ < 1e9))
    throw Error(file + ": metersPerUnit", "1e-9 to 1e9", "others");
  if (!(kilogramsPerUnit_ > 1e-9 && kilogramsPerUnit_ < 1e9))
    throw Error(file + ": kilogramsPerUnit", "1e-9 to 1e9", "others");
  yUp_ = stage.upAxis == "Y";
  model_.name = std::filesystem::path(file).stem().string();
  Link world;
  world.name = "world", world.place = {file, 1};
  model_.links.push_back(world);
  bodyPrims_.push_back(nullptr);
  Affine root = Affine::scaling({metersPerUnit_, metersPerUnit_, metersPerUnit_});
  if (yUp_) root = Affine::of({{}, quatOfEuler({std::numbers::pi / 2, 0, 0}, "xyz")}) * root;
  placed_.push_back({&stage.root, "/", root, -1});
  for (const auto& child : stage.root.children) visit(*child, "/" + child->name, root, -1);
  // joints, materials and bodies are all known now
  for (std::size_t i = 1; i < placed_.size(); ++i) {
    const UsdPrim prim = at(*placed_[i].prim);
    const usd::Prim& own = prim.prim();
    if (own.type == "PhysicsScene") readScene(prim);
    if (own.hasSchema("PhysicsCollisionAPI") && prim.flag("physics:collisionEnabled", true))
      addCollider(prim, placed_[i]);
  }
  for (std::size_t i = 1; i < placed_.size(); ++i) addDrawn(at(*placed_[i].prim), placed_[i]);
  for (std::size_t i = 1; i < model_.links.size(); ++i) finishMass(static_cast<int>(i));
  for (std::size_t i = 1; i < placed_.size(); ++i)
    if (isJoint(placed_[i].prim->type)) addJoint(at(*placed_[i].prim), placed_[i]);
  addFilters();
  noteUnused();
  return std::move(model_);
}

void UsdReader::readScene(const UsdPrim& prim) {
  if (hasScene_) return report_.note(Effect::Lost, prim.place(), "PhysicsScene", "a second scene");
  hasScene_ = true;
  const double size = prim.number("physics:gravityMagnitude", -INFINITY, true);
  const Vec3 along = prim.vector("physics:gravityDirection").value_or(Vec3{});
  const double gravity = std::isfinite(size) && size >= 0 ? length(size) : 9.81;
  const Vec3 down = rubble::length(along) > 1e-9 ? normalize(along) : yUp_ ? Vec3{0, -1, 0} : Vec3{0, 0, -1};
  model_.gravity = gravity * rotate(placed_.front().world.rigid().q, down);
  report_.converted(prim.place(), "PhysicsScene" + inQuotes(prim.prim().name), "gravity");
}

void UsdReader::visit(const usd::Prim& prim, const std::string& path, const Affine& parent, int link) {
  if (prim.kind == usd::Prim::Kind::Def) placeAll(prim, path, parent, link);
}

void UsdReader::placeAll(const usd::Prim& prim, const std::string& path, const Affine& parent, int link) {
  if (!prim.active) return;
  if (placed_.size() > usd::kMostPrims)
    throw Error(prim.file + ": " + path, "at most 500000 prims, with those of instances", "more");
  if (std::count(path.begin(), path.end(), '/') > usd::kMostDepth)
    throw Error(prim.file + ": " + prim.name, "at most 100 levels, with those of instances", "more");
  const UsdPrim own = at(prim);
  bool resets = false;
  const Affine local = localFrame(own, resets);
  const Affine world = (resets ? placed_.front().world : parent) * local;
  if (prim.hasSchema("PhysicsRigidBodyAPI") && own.flag("physics:rigidBodyEnabled", true)) {
    if (link >= 0 && !resets)
      report_.note(Effect::Approximate, own.place(), "PhysicsRigidBodyAPI",
                   "a body below another one is a body of its own");
    link = addBody(own, path, parent, world);
  } else if (resets) {
    link = -1;
  }
  byPath_[path] = placed_.size();
  placed_.push_back({&prim, path, world, link, instance_});
  if (prim.type == "Camera") addCamera(own, world);
  if (prim.type == "PointInstancer") return addInstances(prim, path, world, link);
  for (const auto& child : prim.children) visit(*child, path + "/" + child->name, world, link);
}

int UsdReader::addBody(const UsdPrim& prim, const std::string& path, const Affine& parent,
                       const Affine& world) {
  if (!world.isFinite()) prim.fail("xformOpOrder", "a frame of finite numbers", "others");
  Link link;
  link.name = path.substr(1);
  link.place = prim.place();
  link.parent = 0;
  link.pose = world.rigid();
  link.kinematic = prim.flag("physics:kinematicEnabled", false);
  link.free = !link.kinematic;
  link.velocity = parent.direction(prim.vector("physics:velocity").value_or(Vec3{}));
  link.angularVelocity = std::numbers::pi / 180 *
                         rotate(parent.rigid().q, prim.vector("physics:angularVelocity").value_or(Vec3{}));
  prim.flag("physics:startsAsleep", false);
  // of PhysX, and written by many programs
  if (prim.flag("physxRigidBody:disableGravity", false)) link.gravityScale = 0;
  link.linearDamping = std::max(prim.number("physxRigidBody:linearDamping", 0), 0.);
  link.angularDamping = std::max(prim.number("physxRigidBody:angularDamping", 0), 0.);
  model_.links.push_back(std::move(link));
  bodyPrims_.push_back(&prim.prim());
  return static_cast<int>(model_.links.size()) - 1;
}

void UsdReader::finishMass(int index) {
  Link& link = model_.links[static_cast<std::size_t>(index)];
  if (!link.free) return;
  const UsdPrim prim = at(*bodyPrims_[static_cast<std::size_t>(index)]);
  const bool given = prim.prim().hasSchema("PhysicsMassAPI");
  const double unit = kilogramsPerUnit_, volume = std::pow(metersPerUnit_, 3);
  const double mass = given ? prim.number("physics:mass", 0) * unit : 0,
               density = given ? prim.number("physics:density", 0) * unit / volume : 0;
  if (mass < 0) prim.fail("physics:mass", "a number of at least 0", "less");
  if (density < 0) prim.fail("physics:density", "a number of at least 0", "less");
  SolidSums sums;
  for (const Collider& each : colliders_) {
    if (each.link != index || !(each.solid.volume > 0)) continue;
    constexpr double kUsualDensity = 1000;
    const double own = each.mass > 0             ? each.mass / each.solid.volume
                       : each.density > 0        ? each.density
                       : density > 0             ? density
                       : each.surfaceDensity > 0 ? each.surfaceDensity
                                                 : kUsualDensity;
    sums += placed(each.solid, {}, {}, own);
  }
  MassProperties out;
  if (sums.volume > 0) {
    out = principal(sums);
  } else {
    // as a ball of 0.1 m, which USD takes for bodies without colliders
    constexpr double kRadius = 0.1;
    out.mass = 1;
    out.inertia = Vec3{1, 1, 1} * (0.4 * kRadius * kRadius);
  }
  if (mass > 0) out.inertia *= mass / out.mass, out.mass = mass;
  const auto center = given ? prim.numbers("physics:centerOfMass", 3) : std::nullopt;
  const Affine frame = placed_[byPath_.at("/" + link.name)].world;
  if (center && std::isfinite((*center)[0]) && std::isfinite((*center)[1]) && std::isfinite((*center)[2]))
    out.center = inverse(link.pose) * (frame * Vec3{(*center)[0], (*center)[1], (*center)[2]});
  const Quat axes = (given ? prim.quaternion("physics:principalAxes") : std::nullopt).value_or(Quat{});
  const Vec3 moments = given ? prim.vector("physics:diagonalInertia").value_or(Vec3{}) : Vec3{};
  if (moments.x > 0 && moments.y > 0 && moments.z > 0) {
    out.inertia = moments * (unit * metersPerUnit_ * metersPerUnit_);
    out.axes = axes;
  }
  link.mass = sumsOf(out);
}

void UsdReader::addFilters() {
  // bodies of each prim and of all below it
  const auto linksBelow = [&](const std::string& path) {
    std::set<int> out;
    const auto found = byPath_.find(path);
    if (found == byPath_.end()) return out;
    out.insert(placed_[found->second].link);
    for (std::size_t i = found->second + 1; i < placed_.size() && placed_[i].path.starts_with(path + "/");
         ++i)
      out.insert(placed_[i].link);
    return out;
  };
  const auto linksOf = [&](const Placed& from, const std::string& target) {
    const std::string path = inInstance(from, target);
    if (!byPath_.contains(path))
      report_.note(Effect::Lost, at(*from.prim).place(), "filter" + inQuotes(from.prim->name),
                   "the prim '" + path + "' is not there");
    return linksBelow(path);
  };
  std::size_t pairs = 0;
  const auto exclude = [&](const std::set<int>& a, const std::set<int>& b, const UsdPrim& prim) {
    pairs += a.size() * b.size();
    if (pairs > kMostPairs) prim.fail("physics:filteredPairs", "at most a million pairs", "more");
    for (const int i : a)
      for (const int j : b)
        if (i != j && i >= 0 && j >= 0) model_.exclusions.emplace_back(std::min(i, j), std::max(i, j));
  };
  // groups with one name to merge by are one group
  const auto nameOf = [](const UsdPrim& prim, const Placed& each) {
    const std::string name = prim.text("physics:mergeGroup");
    return name.empty() ? each.path : name;
  };
  std::map<std::string, std::set<int>> groups;
  std::map<std::string, std::string> groupAt;
  std::set<int> all;
  for (const Collider& each : colliders_) all.insert(each.link);
  for (const Placed& each : placed_) {
    const UsdPrim prim = at(*each.prim);
    if (const auto* targets = prim.targets("physics:filteredPairs")) {
      const std::set<int> own = linksBelow(each.path);
      for (const std::string& target : *targets) exclude(own, linksOf(each, target), prim);
      report_.converted(prim.place(), "filtered pairs" + inQuotes(each.prim->name),
                        "pairs that do not collide");
    }
    if (each.prim->type != "PhysicsCollisionGroup") continue;
    groupAt[each.path] = nameOf(prim, each);
    std::set<int> members;
    if (const auto* included = prim.targets("collection:colliders:includes"))
      for (const std::string& target : *included) members.merge(linksOf(each, target));
    if (const auto* excluded = prim.targets("collection:colliders:excludes"))
      for (const std::string& target : *excluded)
        for (const int link : linksOf(each, target)) members.erase(link);
    groups[nameOf(prim, each)].merge(members);
    prim.text("collection:colliders:expansionRule");
  }
  for (const Placed& each : placed_) {
    if (each.prim->type != "PhysicsCollisionGroup") continue;
    const UsdPrim prim = at(*each.prim);
    std::set<int> named;
    if (const auto* targets = prim.targets("physics:filteredGroups"))
      for (const std::string& target : *targets) {
        const std::set<int>& members = groups[groupAt[inInstance(each, target)]];
        named.insert(members.begin(), members.end());
      }
    const std::set<int>& own = groups[groupAt[each.path]];
    if (prim.flag("physics:invertFilteredGroups", false)) {
      std::set<int> others;
      std::set_difference(all.begin(), all.end(), named.begin(), named.end(),
                          std::inserter(others, others.end()));
      named = std::move(others);
    }
    exclude(own, named, prim);
    report_.converted(prim.place(), "PhysicsCollisionGroup" + inQuotes(each.prim->name),
                      "pairs that do not collide");
  }
  std::sort(model_.exclusions.begin(), model_.exclusions.end());
  model_.exclusions.erase(std::unique(model_.exclusions.begin(), model_.exclusions.end()),
                          model_.exclusions.end());
}

void UsdReader::noteUnused() {
  std::set<const usd::Prim*> noted;
  for (const Placed& each : placed_) {
    const Place place{each.prim->file, each.prim->line};
    if (!noted.insert(each.prim).second) continue;
    for (const usd::Property& property : each.prim->properties) {
      if (used_.contains(&property)) continue;
      const std::string& name = property.name;
      const bool physics = name.starts_with("physics:") || name.starts_with("drive:") ||
                           name.starts_with("limit:"),
                 vendor = name.starts_with("physx") || name.starts_with("newton") || name.starts_with("mjc:");
      const Place at = property.line > 0 ? Place{property.file, property.line} : place;
      if (physics || vendor)
        report_.note(vendor ? Effect::Approximate : Effect::Lost, at, each.prim->type + "." + name,
                     vendor ? "settings of one engine" : "an attribute that is not known here");
      else
        report_.note(Effect::None, at, each.prim->type + "." + name, "how it looks");
    }
  }
}

Model readUsd(const std::string& bytes, const std::string& file, Folders& folders, Report& report) {
  return UsdReader(folders, report).read(bytes, file);
}

}  // namespace rubble::convert

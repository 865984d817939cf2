#include "convert/urdf.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "convert/geometry.h"
#include "convert/mesh/mesh_import.h"
#include "convert/packages.h"
#include "convert/rotations.h"
#include "convert/tag.h"
#include "convert/urdf_mass.h"
#include "convert/urdf_unused.h"

namespace rubble::convert {
namespace {

/// A joint as the file gives it.
struct UrdfJoint {
  pugi::xml_node node;
  std::string parent, child;
};

class UrdfReader {
 public:
  UrdfReader(Source& source, const ImportOptions& options, Report& report)
      : source_(source),
        options_(options),
        report_(report),
        packages_(source.folders(), source.home(), options.packages) {}

  Model read(pugi::xml_node root) {
    model_.name = Tag(source_, root).name();
    model_.staticParentsCollide = false;
    for (const pugi::xml_node& node : source_.children(root, "link")) addName(node);
    for (const pugi::xml_node& node : source_.children(root, "joint")) addJoint(node);
    for (const pugi::xml_node& node : source_.children(root, "material"))
      if (const auto color = colorOf(node)) colors_[Tag(source_, node).name()] = *color;
    addRoots(root);
    if (model_.links.size() != links_.size())
      throw Error(source_.path(root), "one tree of links",
                  std::to_string(links_.size() - model_.links.size()) + " links in a loop of joints");
    for (const pugi::xml_node& node : mimics_) addMimic(node);
    giveMissingMasses(model_, report_);
    return std::move(model_);
  }

 private:
  void addName(pugi::xml_node node) {
    const Tag tag(source_, node);
    if (!links_.emplace(tag.need("name"), node).second)
      tag.fail("name", "a name that no other link has", "\"" + tag.name() + "\"");
  }

  std::string linkName(const pugi::xml_node& joint, const char* end) {
    const pugi::xml_node node = joint.child(end);
    if (!node) throw Error(source_.path(joint) + "." + end, "the name of a link", "none");
    const Tag tag(source_, node);
    const std::string name = tag.need("link");
    if (!links_.contains(name)) tag.fail("link", "the name of a link", "\"" + name + "\"");
    return name;
  }

  void addJoint(pugi::xml_node node) {
    const Tag tag(source_, node);
    const UrdfJoint joint{node, linkName(node, "parent"), linkName(node, "child")};
    if (!isChild_.emplace(joint.child, true).second)
      throw Error(tag.path("child"), "a link that is the child of one joint", "\"" + joint.child + "\"");
    jointsOf_[joint.parent].push_back(joint);
  }

  /// The trees of all links without a parent.
  void addRoots(const pugi::xml_node& root) {
    for (const pugi::xml_node& node : source_.children(root, "link")) {
      const std::string name = node.attribute("name").value();
      if (isChild_.contains(name)) continue;
      if (!model_.links.empty())
        report_.note(Effect::Approximate, source_.place(node), "link" + inQuotes(name),
                     "a further link without a parent: a robot of its own");
      addLinks(name, -1);
    }
    if (model_.links.empty()) throw Error(source_.path(root), "a link without a parent", "none");
  }

  /// The links of the tree below one, parents first.
  void addLinks(const std::string& root, int parent) {
    std::vector<std::pair<UrdfJoint, int>> open{{{{}, "", root}, parent}};
    while (!open.empty()) {
      const auto [joint, above] = open.back();
      open.pop_back();
      const int index = static_cast<int>(model_.links.size());
      model_.links.push_back(readLink(links_.at(joint.child)));
      Link& link = model_.links.back();
      link.parent = above;
      if (joint.node)
        readJoint(joint.node, link, index);
      else if (options_.floatingBase)
        link.free = true;
      auto& below = jointsOf_[joint.child];
      for (auto next = below.rbegin(); next != below.rend(); ++next) open.emplace_back(*next, index);
    }
  }

  Pose originOf(const pugi::xml_node& parent) {
    const pugi::xml_node node = parent.child("origin");
    if (!node) return {};
    const Tag tag(source_, node);
    return {tag.vector("xyz").value_or(Vec3{}), quatOfRpy(tag.vector("rpy").value_or(Vec3{}))};
  }

  Link readLink(pugi::xml_node node) {
    Link link;
    link.name = node.attribute("name").value();
    link.place = source_.place(node);
    linkIndex_[link.name] = static_cast<int>(model_.links.size());
    const std::vector<pugi::xml_node> collisions = source_.children(node, "collision");
    solid_ = {};
    for (const pugi::xml_node& each : collisions) readGeometry(each, {1, 1}, link);
    link.drawn.clear();
    // without an inertial: water, as in MuJoCo
    constexpr double kDensity = 1000;
    if (const pugi::xml_node inertial = node.child("inertial"))
      readInertial(inertial, link);
    else
      link.mass = placed(solid_, {}, {}, kDensity);
    // what is seen stands for links that nothing collides with
    for (const pugi::xml_node& each : source_.children(node, "visual")) {
      Link seen;
      readGeometry(each, {0, 0}, seen);
      const std::optional<Vec3> color = colorOf(each.child("material"));
      for (DrawnShape& drawn : seen.drawn) {
        drawn.color = color;
        drawn.geom = collisions.empty() && drawn.geom >= 0 ? static_cast<int>(link.geoms.size()) : -1;
        link.drawn.push_back(std::move(drawn));
      }
      if (collisions.empty()) link.geoms.insert(link.geoms.end(), seen.geoms.begin(), seen.geoms.end());
    }
    return link;
  }

  /// Of a material that has a color itself, or names one of the robot that has.
  std::optional<Vec3> colorOf(pugi::xml_node material) {
    if (!material) return std::nullopt;
    const Tag tag(source_, material);
    source_.use(material);
    const std::string name = tag.name();
    if (const pugi::xml_node color = material.child("color")) {
      const Tag own(source_, color);
      const auto rgba = own.numbers("rgba", 4, 4);
      source_.use(color);
      const auto share = [&](std::size_t k) { return std::clamp((*rgba)[k], 0., 1.); };
      if (rgba) return Vec3{share(0), share(1), share(2)};
    }
    const auto found = colors_.find(name);
    return found == colors_.end() ? std::nullopt : std::optional(found->second);
  }

  void readInertial(pugi::xml_node node, Link& link) {
    const Tag tag(source_, node);
    const auto child = [&](const char* name) {
      const pugi::xml_node found = node.child(name);
      if (!found) tag.fail(name, "an element", "none");
      return Tag(source_, found);
    };
    const Tag mass = child("mass"), inertia = child("inertia");
    const double value = mass.needNumber("value");
    if (value < 0) mass.fail("value", "a mass of at least 0 [kg]", std::to_string(value));
    const std::array<double, 6> tensor{inertia.needNumber("ixx"), inertia.needNumber("iyy"),
                                       inertia.needNumber("izz"), inertia.number("ixy", 0),
                                       inertia.number("ixz", 0),  inertia.number("iyz", 0)};
    const Pose origin = originOf(node);
    if (value > 0)
      link.mass = placed(massOfInertial(value, tensor, solid_, tag.place(), report_), origin.p, origin.q, 1);
  }

  void readGeometry(pugi::xml_node node, const Contact& contact, Link& link) {
    const Tag tag(source_, node);
    Geom geom;
    geom.name = tag.name();
    geom.place = tag.place();
    geom.contact = contact;
    geom.pose = originOf(node);
    const pugi::xml_node geometry = node.child("geometry");
    if (!geometry)
      return report_.note(contact.any() ? Effect::Lost : Effect::None, tag.place(), tag.describe(),
                          "it has no geometry");
    source_.use(geometry);
    for (const pugi::xml_node& shape : source_.children(geometry)) {
      SolidSums solid;
      std::optional<Shape> drawn;
      const bool isThere = readShape(Tag(source_, shape), geom, solid, drawn);
      if (isThere || drawn)
        link.drawn.push_back(
            {drawn.value_or(geom.shape), geom.pose, {}, isThere ? static_cast<int>(link.geoms.size()) : -1});
      if (!isThere) continue;
      link.geoms.push_back(geom);
      solid_ += placed(solid, geom.pose.p, geom.pose.q, 1);
    }
  }

  double length(const Tag& tag, const char* key) const {
    const double value = tag.needNumber(key);
    if (!(value > 0)) tag.fail(key, "a length above 0 [m]", std::to_string(value));
    return value;
  }

  /// `solid`: its integrals at density 1, in its own frame.
  bool readShape(const Tag& tag, Geom& geom, SolidSums& solid, std::optional<Shape>& drawn) {
    const std::string type = tag.type();
    if (type == "box") {
      const auto size = tag.vector("size");
      if (!size || !(std::min({size->x, size->y, size->z}) > 0))
        tag.fail("size", "three lengths above 0 [m]", "others");
      geom.shape = Shape::box(*size / 2);
    } else if (type == "sphere") {
      geom.shape = Shape::sphere(length(tag, "radius"));
    } else if (type == "cylinder") {
      geom.shape = Shape::cylinder(length(tag, "radius"), length(tag, "length") / 2);
    } else if (type == "capsule") {
      geom.shape = Shape::capsule(length(tag, "radius"), length(tag, "length") / 2);
    } else if (type == "mesh") {
      return readMesh(tag, geom, solid, drawn);
    } else {
      report_.note(Effect::Lost, tag.place(), type, "a geometry that URDF does not have");
      return false;
    }
    solid = sumsOf(massProperties(geom.shape, 1));
    return true;
  }

  bool readMesh(const Tag& tag, Geom& geom, SolidSums& solid, std::optional<Shape>& drawn) {
    const Effect loss = geom.contact.any() ? Effect::Lost : Effect::None;
    const std::string name = tag.need("filename");
    const Vec3 scale = tag.vector("scale").value_or(Vec3{1, 1, 1});
    TriangleMesh mesh;
    try {
      const std::string file = packages_.find(name, tag.path("filename")).string();
      mesh = readSurfaceAsWritten(file);
    } catch (const Error& error) {
      report_.note(loss, tag.place(), "mesh" + inQuotes(name), error.what());
      return false;
    }
    for (Vec3& point : mesh.vertices) point = mul(point, scale);
    drawn = drawnMesh(mesh);
    try {
      bool reduced = false;
      geom.shape = Shape::hull(cornersOf(mesh.vertices, reduced, tag.path("filename")));
      if (loss == Effect::Lost)
        report_.note(Effect::Approximate, tag.place(), "mesh",
                     "the convex hull of a mesh, with at most 64 corners, takes part in contacts");
    } catch (const Error&) {
      report_.note(loss, tag.place(), "mesh" + inQuotes(name),
                   "it has no convex hull (it is flat, or this build has no qhull)");
      return false;
    }
    solid = massOf(mesh, MeshMass::Legacy, tag.path("filename"));
    return true;
  }

  void readJoint(pugi::xml_node node, Link& link, int index) {
    const Tag tag(source_, node);
    const std::vector<std::string> types{"revolute", "continuous", "prismatic", "fixed",
                                         "floating", "planar",     "spherical"};
    tag.need("type");
    const std::string type = types[tag.choice("type", types, 0)];
    link.pose = originOf(node);
    if (type == "fixed") return;
    if (type == "floating") {
      link.free = true;
      report_.converted(tag.place(), tag.describe(), "free body" + inQuotes(link.name));
      return;
    }
    Vec3 axis{1, 0, 0};
    if (const pugi::xml_node found = node.child("axis")) {
      const Tag axisTag(source_, found);
      axis = axisTag.vector("xyz").value_or(axis);
      if (!(rubble::length(axis) > 1e-10)) axisTag.fail("xyz", "a direction", "a vector of length 0");
    }
    Dof dof;
    dof.name = tag.name();
    dof.place = tag.place();
    dof.axis = normalize(axis);
    readDynamics(node, dof);
    if (type == "spherical") {
      dof.type = DofType::Ball;
    } else if (type == "planar") {
      const Quat frame = quatOfZ(dof.axis);
      for (const Vec3& along : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
        Dof slide = dof;
        slide.type = DofType::Slide;
        slide.axis = rotate(frame, along);
        link.dofs.push_back(slide);
      }
    } else {
      dof.type = type == "prismatic" ? DofType::Slide : DofType::Hinge;
      if (type != "continuous") readLimit(node, tag, dof);
      if (node.child("mimic")) mimics_.push_back(node);
    }
    dofIndex_[dof.name] = {index, static_cast<int>(link.dofs.size())};
    link.dofs.push_back(dof);
  }

  void readDynamics(const pugi::xml_node& joint, Dof& dof) {
    const pugi::xml_node node = joint.child("dynamics");
    if (!node) return;
    const Tag tag(source_, node);
    dof.damping = tag.number("damping", 0);
    dof.friction = tag.number("friction", 0);
    if (dof.damping < 0) tag.fail("damping", "a number of at least 0", std::to_string(dof.damping));
    if (dof.friction < 0) tag.fail("friction", "a number of at least 0", std::to_string(dof.friction));
  }

  void readLimit(const pugi::xml_node& joint, const Tag& jointTag, Dof& dof) {
    const pugi::xml_node node = joint.child("limit");
    if (!node)
      return report_.note(Effect::Approximate, jointTag.place(), jointTag.describe(),
                          "its type has limits, and it has none: it moves without");
    const Tag tag(source_, node);
    dof.range = {tag.number("lower", 0), tag.number("upper", 0)};
    if ((*dof.range)[0] <= (*dof.range)[1]) return;
    std::swap((*dof.range)[0], (*dof.range)[1]);
    report_.note(Effect::Approximate, tag.place(), "limit.lower", "above the upper limit: both are swapped");
  }

  void addMimic(pugi::xml_node node) {
    const Tag joint(source_, node), tag(source_, node.child("mimic"));
    const std::string other = tag.need("joint");
    const auto found = dofIndex_.find(other);
    if (found == dofIndex_.end())
      return report_.note(Effect::Lost, tag.place(), "mimic of" + inQuotes(joint.name()),
                          "the joint '" + other + "' does not move");
    if (other == joint.name()) tag.fail("joint", "another joint", "itself");
    if (dofOf(found->second).type == DofType::Ball)
      tag.fail("joint", "a joint with one axis", "a spherical one");
    model_.couplings.push_back({joint.name() + "_mimic",
                                tag.place(),
                                dofIndex_.at(joint.name()),
                                found->second,
                                {tag.number("offset", 0), tag.number("multiplier", 1), 0, 0, 0}});
  }

  const Dof& dofOf(const std::pair<int, int>& at) const {
    return model_.links[static_cast<std::size_t>(at.first)].dofs[static_cast<std::size_t>(at.second)];
  }

  Source& source_;
  const ImportOptions& options_;
  Report& report_;
  Packages packages_;
  Model model_;
  std::map<std::string, pugi::xml_node> links_;
  std::map<std::string, std::vector<UrdfJoint>> jointsOf_;  ///< by the name of their parent
  std::map<std::string, bool> isChild_;
  std::map<std::string, int> linkIndex_;
  std::map<std::string, std::pair<int, int>> dofIndex_;
  std::vector<pugi::xml_node> mimics_;
  std::map<std::string, Vec3> colors_;  ///< of the materials of the robot
  SolidSums solid_;                     ///< of the collision shapes of the present link at density 1
};

/// A file that is not expanded has elements of xacro, or expressions.
bool isXacro(const pugi::xml_node& node) {
  if (std::string_view(node.name()).starts_with("xacro:")) return true;
  for (const pugi::xml_attribute& attribute : node.attributes())
    if (std::string_view(attribute.value()).find("${") != std::string_view::npos) return true;
  return std::any_of(node.begin(), node.end(), isXacro);
}

}  // namespace

Model readUrdf(Source& source, pugi::xml_node root, const ImportOptions& options, Report& report) {
  if (isXacro(root))
    throw Error(report.file, "a URDF file (expand it first: xacro robot.xacro > robot.urdf)", "a xacro file");
  source.use(root);
  Model model = UrdfReader(source, options, report).read(root);
  if (!options.srdf.empty()) readSrdf(source, options.srdf, model, report);
  noteUnusedUrdf(source, report);
  return model;
}

void readSrdf(Source& source, const std::string& file, Model& model, Report& report) {
  const pugi::xml_node root = source.load(file, "--srdf");
  const Tag robot(source, root);
  if (robot.type() != "robot") throw Error(robot.path("name"), "a <robot>", "<" + robot.type() + ">");
  robot.name();
  const auto linkOf = [&](const Tag& tag, const char* key) {
    const std::string name = tag.need(key);
    const auto found = std::find_if(model.links.begin(), model.links.end(),
                                    [&](const Link& link) { return link.name == name; });
    if (found == model.links.end()) tag.fail(key, "the name of a link", "\"" + name + "\"");
    return static_cast<int>(found - model.links.begin());
  };
  for (const pugi::xml_node& node : source.children(root, "disable_collisions")) {
    const Tag tag(source, node);
    model.exclusions.emplace_back(linkOf(tag, "link1"), linkOf(tag, "link2"));
    report.converted(tag.place(), "disable_collisions", "pair of bodies that do not collide");
  }
}

}  // namespace rubble::convert

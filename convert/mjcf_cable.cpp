/// <composite> of the type cable: a chain of bodies with ball joints, as MuJoCo makes it before version 4;
/// and the elasticity of plugins "mujoco.elasticity.cable" of such chains.
#include <cmath>
#include <numbers>
#include <sstream>

#include "convert/mjcf_reader.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

constexpr const char* kPlugin = "mujoco.elasticity.cable";
constexpr int kMostPoints = 10000;
/// Elements and attributes of all segments together.
constexpr std::size_t kMostInAll = 2000000;

/// Torsion constant and second moments about y and z of the section of a segment along x [m4].
std::optional<Vec3> sectionOf(const Shape& shape) {
  if (shape.type == ShapeType::Capsule || shape.type == ShapeType::Cylinder) {
    const double second = std::numbers::pi * std::pow(shape.radius, 4) / 4;
    return Vec3{2 * second, second, second};
  }
  if (shape.type != ShapeType::Box) return std::nullopt;
  const double y = shape.halfExtents.y, z = shape.halfExtents.z, a = std::max(y, z), b = std::min(y, z);
  const double torsion = a * std::pow(b, 3) * (16. / 3 - 3.36 * b / a * (1 - std::pow(b / a, 4) / 12));
  return Vec3{torsion, 4. / 3 * y * std::pow(z, 3), 4. / 3 * z * std::pow(y, 3)};
}

/// Points of a cable: written, or on a curve of lines, sines and cosines.
std::vector<Vec3> pointsOf(const Tag& tag) {
  std::vector<Vec3> out;
  if (const auto given = tag.numbers("vertex", 6, 3 * kMostPoints)) {
    if (given->size() % 3 != 0) tag.fail("vertex", "three numbers for each", std::to_string(given->size()));
    for (std::size_t i = 0; i < given->size(); i += 3)
      out.push_back({(*given)[i], (*given)[i + 1], (*given)[i + 2]});
  } else {
    const auto counts = tag.numbers("count", 1, 3).value_or(std::vector<double>{1});
    if (!(counts[0] >= 2 && counts[0] <= kMostPoints) || counts[0] != std::floor(counts[0]))
      tag.fail("count", "2 to 10000 points", std::to_string(counts[0]));
    auto size = tag.numbers("size", 1, 3).value_or(std::vector<double>{1});
    size.resize(3);
    std::istringstream words(tag.need("curve"));
    std::string curve[3] = {"0", "0", "0"};
    for (std::string& each : curve)
      if (!(words >> each)) break;
    for (int i = 0; i < static_cast<int>(counts[0]); ++i) {
      const double s = i / (counts[0] - 1), angle = std::numbers::pi * s * size[2];
      const auto at = [&](const std::string& kind) {
        if (kind == "s") return s * size[0];
        if (kind == "cos(s)") return size[1] * std::cos(angle);
        if (kind == "sin(s)") return size[1] * std::sin(angle);
        if (!kind.empty() && kind != "0") tag.fail("curve", "s, cos(s), sin(s) or 0", inQuotes(kind));
        return 0.;
      };
      out.push_back({at(curve[0]), at(curve[1]), at(curve[2])});
    }
  }
  for (std::size_t i = 1; i < out.size(); ++i)
    if (!(length(out[i] - out[i - 1]) > 0))
      tag.fail("vertex", "points apart from each other", "two at one place");
  return out;
}

/// Frames of segments, x along each. The first one turns its y to where the cable bends; the others are
/// turned with their segments, without twist.
std::vector<Quat> framesAlong(const std::vector<Vec3>& points) {
  constexpr double kStraight = 1e-10;
  std::vector<Quat> out;
  Vec3 normal{0, 1, 0}, before;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3 along = normalize(points[i + 1] - points[i]);
    if (i == 0) {
      const Vec3 next = points.size() > 2 ? normalize(points[2] - points[1]) : along,
                 bend = cross(along, next);
      if (length(bend) > kStraight) normal = cross(normalize(bend), along);
      if (length(cross(along, normal)) < kStraight) normal = {0, 0, 1};
    } else {
      const Vec3 axis = cross(before, along);
      if (length(axis) > kStraight)
        normal = rotate(fromAxisAngle(normalize(axis), std::atan2(length(axis), dot(before, along))), normal);
    }
    normal = normalize(normal - dot(normal, along) * along);
    out.push_back(quatOfAxes(along, normal, cross(along, normal)));
    before = along;
  }
  return out;
}

/// Elements and attributes in an element.
std::size_t sizeOf(const pugi::xml_node& node) {
  std::size_t out = 1;
  for ([[maybe_unused]] const pugi::xml_attribute& each : node.attributes()) ++out;
  for (const pugi::xml_node& child : node.children()) out += sizeOf(child);
  return out;
}

std::string textOf(const Vec3& v) {
  std::ostringstream out;
  out.precision(17), out << v.x << ' ' << v.y << ' ' << v.z;
  return out.str();
}

void set(pugi::xml_node node, const char* key, const std::string& value) {
  node.remove_attribute(key);
  node.append_attribute(key) = value.c_str();
}

}  // namespace

bool MjcfReader::isCable(pugi::xml_node node) const {
  if (std::string_view(node.name()) == "composite")
    return std::string_view(node.attribute("type").value()) == "cable";
  if (const pugi::xml_attribute plugin = node.attribute("plugin"))
    return plugin.value() == std::string_view(kPlugin);
  return cables_.contains(node.attribute("instance").value());
}

/// Adds the bodies of a cable to its element, one after the other, each in the frame of the one before.
void MjcfReader::expandCable(const Tag& tag, const std::string& childClass) {
  pugi::xml_node node = tag.node();
  const std::string prefix = tag.text("prefix").value_or("");
  const std::size_t initial = tag.choice("initial", {"none", "free", "ball"}, 2);
  const std::vector<Vec3> points = pointsOf(tag);
  if (points.size() * sizeOf(node) > kMostInAll)
    tag.fail("count", "fewer segments of a composite of this size", std::to_string(points.size()));
  const std::vector<Quat> frames = framesAlong(points);
  const pugi::xml_node joint = node.child("joint"), geom = node.child("geom"), site = node.child("site"),
                       plugin = node.child("plugin");
  const Pose pose{tag.vector("offset").value_or(Vec3{}), orientationOf(tag)};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool isFirst = i == 0, isLast = i + 1 == frames.size();
    const std::string number = isFirst ? "first" : isLast ? "last" : std::to_string(i);
    const double along = length(points[i + 1] - points[i]);
    const Pose at = isFirst ? pose * Pose{points[0], frames[0]}
                            : Pose{{length(points[i] - points[i - 1]), 0, 0},
                                   conjugate(frames[i - 1]) * frames[i]};
    pugi::xml_node body = node.append_child("body");
    set(body, "name", prefix + "B_" + number), set(body, "pos", textOf(at.p));
    std::ostringstream turn;
    turn.precision(17), turn << at.q.s << ' ' << textOf(at.q.v);
    set(body, "quat", turn.str());
    if (!isFirst || initial > 0) {
      const bool isFree = isFirst && initial == 1;
      pugi::xml_node ball = isFree || !joint ? body.append_child(isFree ? "freejoint" : "joint")
                                             : body.append_copy(joint);
      ball.remove_attribute("kind");
      set(ball, "name", prefix + "J_" + number);
      if (!isFree) set(ball, "type", "ball");
    }
    pugi::xml_node segment = geom ? body.append_copy(geom) : body.append_child("geom");
    set(segment, "name", prefix + "G" + std::to_string(i));
    const Tag own = tagOf(segment, childClass);
    const std::string type = own.text("type").value_or("sphere");
    if (type == "box") {
      const Vec3 size = own.vector("size").value_or(Vec3{});
      set(segment, "pos", textOf({along / 2, 0, 0})),
          set(segment, "size", textOf({along / 2, size.y, size.z}));
    } else {
      if (type != "capsule" && type != "cylinder") tag.fail("geom.type", "capsule, cylinder or box", type);
      set(segment, "fromto", "0 0 0 " + textOf({along, 0, 0}));
    }
    if (plugin) {
      pugi::xml_node copy = body.append_copy(plugin);
      if (!copy.attribute("instance")) set(copy, "instance", "composite_" + prefix);
    }
    if (!isFirst && !isLast) continue;
    pugi::xml_node end = site ? body.append_copy(site) : body.append_child("site");
    set(end, "name", prefix + "S_" + number), set(end, "pos", textOf({isLast ? along : 0, 0, 0}));
  }
}

void MjcfReader::readComposite(const Tag& tag, const MjcfScope& scope) {
  if (!tag.node().child("body")) {
    const auto use = [&](const auto& self, const pugi::xml_node& node) -> void {
      for (const pugi::xml_node& child : node.children()) {
        source_.use(child);
        for (const pugi::xml_attribute& attribute : child.attributes()) source_.use(attribute);
        self(self, child);
      }
    };
    use(use, tag.node());  // what of them is not used is reported of their copies
    expandCable(tag, scope.childClass);
  }
  MjcfScope inner = scope;
  int count = 0;
  for (const pugi::xml_node& body : tag.node().children("body")) {
    const int index = static_cast<int>(model_.links.size());
    source_.use(body);
    readBody(Tag(source_, body), inner);
    inner = {index, {}, scope.childClass, scope.suffix, scope.depth};
    ++count;
  }
  report_.converted(tag.place(), "composite" + inQuotes(tag.text("prefix").value_or("")),
                    std::to_string(count) + " bodies of a cable");
}

void MjcfReader::readExtension(pugi::xml_node node) {
  for (const pugi::xml_node& child : source_.children(node, "plugin")) {
    if (!isCable(child)) continue;
    source_.use(child), source_.use(child.attribute("plugin"));
    for (const pugi::xml_node& instance : source_.children(child, "instance")) {
      source_.use(instance);
      readCableConfig(instance, cables_[Tag(source_, instance).need("name")]);
    }
  }
}

void MjcfReader::readCableConfig(pugi::xml_node node, MjcfCable& cable) {
  for (const pugi::xml_node& child : source_.children(node, "config")) {
    const Tag config(source_, child);
    source_.use(child);
    const std::string key = config.need("key");
    if (key == "twist") cable.twist = config.needNumber("value");
    if (key == "bend") cable.bend = config.needNumber("value");
    if (key == "flat") cable.isFlat = config.need("value") == "true";
    if (key == "vmax") source_.use(child.attribute("value"));
  }
  if (cable.twist < 0 || cable.bend < 0)
    Tag(source_, node).fail("config", "moduli of at least 0 [Pa]", "others");
}

void MjcfReader::readPlugin(const Tag& tag, const MjcfScope& scope) {
  const std::string instance = tag.text("instance").value_or("");
  tag.text("plugin");
  if (scope.link == 0) tag.fail("plugin", "a plugin of a body that is not the world", "another");
  const std::string name = instance + scope.suffix;
  MjcfCable& cable = cables_[name];
  if (name != instance && cable.links.empty()) {
    const auto shared = cables_.find(instance);
    if (shared != cables_.end()) cable = shared->second, cable.links.clear();
  }
  readCableConfig(tag.node(), cable);
  cable.links.push_back(scope.link);
}

void MjcfReader::finishCables() {
  if (!compiler_.springs) return;
  for (const auto& [name, cable] : cables_)
    for (std::size_t k = 1; k < cable.links.size(); ++k) {
      Link& own = link(cable.links[k]);
      const auto section = own.geoms.empty() ? std::nullopt : sectionOf(own.geoms.front().shape);
      if (own.parent != cable.links[k - 1] || own.dofs.size() != 1 || own.dofs[0].type != DofType::Ball ||
          !section) {
        report_.note(Effect::Lost, own.place, "plugin of body" + inQuotes(own.name),
                     "elasticity of a segment without one ball joint, or of another shape");
        continue;
      }
      const double along = length(own.pose.p);
      if (!(along > 0)) continue;
      const Vec3 stiffness = mul(*section, Vec3{cable.twist, cable.bend, cable.bend}) / along;
      own.dofs[0].spring = {stiffness, cable.isFlat ? conjugate(own.pose.q) : Quat{}};
      report_.converted(own.place, "plugin of body" + inQuotes(own.name), "springs of bending and twist");
    }
}

}  // namespace rubble::convert

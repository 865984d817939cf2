#include <algorithm>
#include <cmath>

#include <rubble/error.h>

#include "convert/assemble.h"
#include "convert/names.h"
#include "cook/shape_traits.h"

namespace rubble::convert {
namespace {

/// Relative difference below which mass properties are those of a shape [1].
constexpr double kSame = 1e-12;

bool sameMass(const MassProperties& a, const MassProperties& b) {
  if (std::fabs(a.mass - b.mass) > kSame * b.mass) return false;
  const double size = std::max({b.inertia.x, b.inertia.y, b.inertia.z});
  if (length(a.inertia - b.inertia) > kSame * size) return false;
  return lengthSquared(a.center - b.center) * b.mass <= kSame * kSame * size && a.axes == b.axes;
}

/// A box with these mass properties, for links without geometry.
ShapePartDef boxOf(const MassProperties& mass) {
  const Vec3& i = mass.inertia;
  const auto half = [&](double sum) {
    return std::sqrt(std::max(sum, 1e-12 * (i.x + i.y + i.z)) * 1.5 / mass.mass);
  };
  ShapePartDef part;
  part.shape = Shape::box({half(i.y + i.z - i.x), half(i.x + i.z - i.y), half(i.x + i.y - i.z)});
  part.position = mass.center;
  part.orientation = mass.axes;
  return part;
}

/// Parts and material of the geoms of a body.
struct Parts {
  std::vector<ShapePartDef> parts;
  std::optional<Material> material;

  void add(const Geom& geom, const Pose& pose) {
    if (!material) material = geom.material;
    ShapePartDef part{geom.shape, pose.p, pose.q};
    const Material& m = geom.material;
    if (m.staticFriction != material->staticFriction || m.rollingFriction != material->rollingFriction ||
        m.torsionalFriction != material->torsionalFriction)
      part.material = m;
    parts.push_back(std::move(part));
  }
};

class BodyBuilder {
 public:
  BodyBuilder(const Model& model, Layout& layout, Scene& scene, Report& report)
      : model_(model), layout_(layout), scene_(scene), report_(report) {}

  void build() {
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      if (layout_.root[i] == static_cast<int>(i)) addMoving(static_cast<int>(i));
      if (layout_.root[i] < 0) addStatic(static_cast<int>(i));
    }
  }

 private:
  const Link& link(int i) const { return model_.links[static_cast<std::size_t>(i)]; }
  std::string nameOf(int i) const {
    return link(i).name.empty() ? "body_" + std::to_string(i + 1) : link(i).name;
  }
  /// The convex geoms of a link; others that cannot be on a moving body are lost.
  void addParts(int i, Parts& colliding, Parts& visual) {
    for (const Geom& geom : link(i).geoms) {
      if (!traitsOf(geom.shape.type).isConvex) {
        if (!geom.contact.any()) continue;
        report_.note(Effect::Lost, geom.place, "geom" + inQuotes(geom.name),
                     std::string("a ") + keyword(geom.shape.type) + " is possible on static bodies only");
        continue;
      }
      (geom.contact.any() ? colliding : visual)
          .add(geom, layout_.inRoot[static_cast<std::size_t>(i)] * geom.pose);
    }
  }

  /// A name that no other body has and that scene files take: "world" is the world itself there, in whose
  /// place stands `instead`, and a final '*' stands for a prefix.
  std::string freeName(std::string name, const std::string& instead) {
    if (name == "world") name = instead;
    if (name.ends_with('*')) name.back() = '_';
    return names_.unique(name);
  }

  void addMoving(int root) {
    const Link& own = link(root);
    const std::string name = freeName(nameOf(root), "world_body");
    SolidSums sums;
    Parts colliding, visual;
    std::vector<Contact> contacts;
    for (const int member : layout_.members[static_cast<std::size_t>(root)]) {
      const Link& each = link(member);
      const Pose& pose = layout_.inRoot[static_cast<std::size_t>(member)];
      sums += placed(each.mass, pose.p, pose.q, 1);
      addParts(member, colliding, visual);
      for (const Geom& geom : each.geoms)
        if (geom.contact.any()) contacts.push_back(geom.contact);
      if (each.gravityScale != own.gravityScale)
        report_.note(Effect::Approximate, each.place, "body.gravcomp",
                     "bodies fixed to one another take that of the first one");
      report_.converted(each.place, "link" + inQuotes(nameOf(member)),
                        (member == root ? "body" : "part of body") + inQuotes(name));
    }
    BodyDef body;
    body.name = name;
    body.motion = own.kinematic ? Motion::Kinematic : Motion::Dynamic;
    const Pose& pose = layout_.inWorld[static_cast<std::size_t>(root)];
    body.position = pose.p, body.orientation = pose.q;
    body.gravityScale = own.gravityScale;
    body.linearDamping = own.linearDamping, body.angularDamping = own.angularDamping;
    body.velocity = layout_.velocity[static_cast<std::size_t>(root)];
    body.angularVelocity = layout_.angularVelocity[static_cast<std::size_t>(root)];
    std::optional<MassProperties> mass;
    if (!own.kinematic) {
      const std::string path = own.place.text() + ": " + body.name;
      if (!(sums.volume > 0))
        throw Error(path + ".mass",
                    "a mass above 0 of a body that moves (an inertial, or geometry with a density)", "none");
      mass = principal(sums);
      if (!own.free || own.velocityOfOrigin)
        body.velocity += cross(body.angularVelocity, rotate(pose.q, mass->center));
      checkInertia(*mass, path + ".inertia");
    }
    if (colliding.parts.empty()) body.filter.layers = body.filter.mask = 0;
    Parts& parts = colliding.parts.empty() ? visual : colliding;
    if (parts.parts.empty())
      parts.parts.push_back(mass ? boxOf(*mass) : ShapePartDef{Shape::sphere(.01), {}, {}});
    if (parts.material) body.material = *parts.material;
    setShape(body, std::move(parts.parts), mass);
    layout_.bodyOf[static_cast<std::size_t>(root)] = add(std::move(body), std::move(contacts));
  }

  static void checkInertia(const MassProperties& mass, const std::string& path) {
    const Vec3& i = mass.inertia;
    constexpr double kRoundOff = 1 + 1e-9;
    if (!(std::min({i.x, i.y, i.z}) > 0))
      throw Error(path, "principal moments above 0", std::to_string(std::min({i.x, i.y, i.z})));
    if (2 * std::max({i.x, i.y, i.z}) > (i.x + i.y + i.z) * kRoundOff)
      throw Error(path, "principal moments none of which is above the sum of the others",
                  std::to_string(i.x) + " " + std::to_string(i.y) + " " + std::to_string(i.z));
  }

  /// A single shape where its own mass properties are those wanted, else a compound.
  static void setShape(BodyDef& body, std::vector<ShapePartDef> parts, std::optional<MassProperties> mass) {
    if (mass) body.mass = mass->mass;
    const ShapePartDef& first = parts.front();
    if (parts.size() == 1 && first.position == Vec3{} && first.orientation == Quat{} &&
        first.shape.type != ShapeType::Hull) {
      MassProperties own = massProperties(first.shape, 1);
      const double density = mass ? mass->mass / own.mass : 1;
      own.mass *= density, own.inertia *= density;
      if (!mass || sameMass(own, *mass)) {
        body.shape = first.shape;
        return;
      }
    }
    body.shape = Shape::compound(std::move(parts), mass);
  }

  /// One static body for each geom that collides.
  void addStatic(int i) {
    const Link& own = link(i);
    std::string became;
    for (const Geom& geom : own.geoms) {
      if (!geom.contact.any()) {
        report_.note(Effect::None, geom.place, "geom" + inQuotes(geom.name),
                     "nothing collides with it: it is in pictures alone");
        continue;
      }
      BodyDef body;
      body.motion = Motion::Static;
      body.name = freeName(!geom.name.empty() ? geom.name : nameOf(i), keyword(geom.shape.type));
      body.shape = geom.shape;
      body.material = geom.material;
      const Pose at = layout_.inWorld[static_cast<std::size_t>(i)] * geom.pose;
      body.position = at.p, body.orientation = at.q;
      became += (became.empty() ? "static body" : ", static body") + inQuotes(body.name);
      layout_.staticOf[static_cast<std::size_t>(i)].push_back(add(std::move(body), {geom.contact}));
    }
    report_.converted(own.place, "link" + inQuotes(nameOf(i)),
                      became.empty() ? "a frame fixed to the world" : became);
  }

  int add(BodyDef body, std::vector<Contact> contacts) {
    layout_.contactsOf.push_back(std::move(contacts));
    scene_.bodies.push_back(std::move(body));
    return static_cast<int>(scene_.bodies.size()) - 1;
  }

  const Model& model_;
  Layout& layout_;
  Scene& scene_;
  Report& report_;
  Names names_;
};

}  // namespace

void addBodies(const Model& model, Layout& layout, Scene& scene, Report& report) {
  BodyBuilder(model, layout, scene, report).build();
}

}  // namespace rubble::convert

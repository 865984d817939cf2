#include <rubble/debug_draw.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include <rubble/mesh.h>

namespace rubble {

namespace {

constexpr std::uint32_t kStatic = 0x9aa0a6, kKinematic = 0x4a7fd0, kDynamic = 0xd9a05b, kAsleep = 0x8a70b0,
                        kSensor = 0x50b070, kSoft = 0xc06070, kContact = 0xe0c000, kJoint = 0x30a0a0,
                        kBroken = 0xe03030, kText = 0xffffff, kBounds = 0x707070;

class Drawer {
 public:
  Drawer(const World& world, const DebugDrawOptions& options) : world_(world), options_(options) {}

  DebugDraw draw() {
    for (const BodyId id : world_.bodies()) body(id);
    for (const DeformableId id : world_.deformables()) deformable(id);
    if (options_.contacts)
      for (const ContactPoint& p : world_.contacts())
        out_.lines.push_back({p.position, p.position + p.force * options_.forceScale, kContact});
    if (options_.joints)
      for (const JointId id : world_.joints()) joint(id);
    return std::move(out_);
  }

 private:
  std::uint32_t colorOf(BodyId id, const BodyDef& def) const {
    if (def.sensor) return kSensor;
    if (def.motion == Motion::Static) return kStatic;
    if (def.motion == Motion::Kinematic) return kKinematic;
    return world_.asleep(id) ? kAsleep : kDynamic;
  }

  void body(BodyId id) {
    const BodyDef& def = world_.definition(id);
    const BodyState state = world_.state(id);
    const auto place = [&](const Vec3& p) { return state.position + rotate(state.orientation, p); };
    const std::uint32_t color = colorOf(id, def);
    if (options_.surfaces || options_.edges) {
      const ShapeMesh& mesh = meshOf(def.shape);
      for (const auto& [a, b, c] : mesh.triangles)
        triangle(place(at(mesh.points, a)), place(at(mesh.points, b)), place(at(mesh.points, c)), color);
    }
    if (options_.bounds) {
      Vec3 low = place(Vec3{}), high = low;
      for (const Vec3& p : meshOf(def.shape).points)
        for (int axis = 0; axis < 3; ++axis) {
          const double x = place(p)[axis];
          low[axis] = std::min(low[axis], x), high[axis] = std::max(high[axis], x);
        }
      box(low, high);
    }
    if (options_.names && !def.name.empty()) out_.texts.push_back({state.position, def.name, kText});
  }

  void deformable(DeformableId id) {
    if (!options_.surfaces && !options_.edges) return;
    const World::Surface surface = world_.surface(id);
    for (const auto& [a, b, c] : surface.triangles)
      triangle(at(surface.vertices, a), at(surface.vertices, b), at(surface.vertices, c), kSoft);
    for (const auto& [a, b] : surface.segments)
      out_.lines.push_back({at(surface.vertices, a), at(surface.vertices, b), kSoft});
    if (!surface.spheres) return;
    const Vec3 axes[] = {{surface.radius, 0, 0}, {0, surface.radius, 0}, {0, 0, surface.radius}};
    for (const Vec3& p : surface.vertices)
      for (const Vec3& axis : axes) out_.lines.push_back({p - axis, p + axis, kSoft});
  }

  void joint(JointId id) {
    const JointDef& def = world_.definition(id);
    const auto [a, b] = world_.bodiesOf(id);
    const std::uint32_t color = world_.state(id).broken ? kBroken : kJoint;
    const Vec3 onA = pointOf(a, def.anchorA), onB = pointOf(b, def.anchorB);
    if (a.index >= 0) out_.lines.push_back({world_.state(a).position, onA, color});
    out_.lines.push_back({onA, onB, color});
    if (b.index >= 0) out_.lines.push_back({onB, world_.state(b).position, color});
  }

  Vec3 pointOf(BodyId id, const Vec3& anchor) const {
    if (id.index < 0) return anchor;
    const BodyState state = world_.state(id);
    return state.position + rotate(state.orientation, anchor);
  }

  void triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t color) {
    if (options_.surfaces) out_.triangles.push_back({{a, b, c}, color});
    if (!options_.edges) return;
    out_.lines.push_back({a, b, color}), out_.lines.push_back({b, c, color}),
        out_.lines.push_back({c, a, color});
  }

  /// The twelve edges of a box.
  void box(const Vec3& low, const Vec3& high) {
    const auto corner = [&](int bits) {
      return Vec3{bits & 1 ? high.x : low.x, bits & 2 ? high.y : low.y, bits & 4 ? high.z : low.z};
    };
    for (int from = 0; from < 8; ++from)
      for (const int axis : {1, 2, 4})
        if (!(from & axis)) out_.lines.push_back({corner(from), corner(from | axis), kBounds});
  }

  /// Bodies of equal shape share its triangles.
  const ShapeMesh& meshOf(const Shape& shape) {
    const Key key{shape.type,
                  shape.geometry.get(),
                  {shape.halfExtents.x, shape.halfExtents.y, shape.halfExtents.z, shape.radius,
                   shape.halfLength, shape.rounding}};
    const auto [place, isNew] = meshes_.try_emplace(key);
    if (!isNew) return place->second;
    if (shape.type != ShapeType::Plane) return place->second = shapeMesh(shape, options_.segments);
    if (options_.planeSize > 0) {
      const double h = options_.planeSize / 2;
      place->second.points = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
      place->second.triangles = {{0, 1, 2}, {0, 2, 3}};
    }
    return place->second;
  }

  static const Vec3& at(const std::vector<Vec3>& points, int i) {
    return points[static_cast<std::size_t>(i)];
  }

  using Key = std::tuple<ShapeType, const ShapeGeometry*, std::array<double, 6>>;
  const World& world_;
  const DebugDrawOptions& options_;
  std::map<Key, ShapeMesh> meshes_;
  DebugDraw out_;
};

}  // namespace

DebugDraw debugDraw(const World& world, const DebugDrawOptions& options) {
  return Drawer(world, options).draw();
}

}  // namespace rubble

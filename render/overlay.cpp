#include "render/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/picture.h"

namespace rubble::render {
namespace {

constexpr std::uint32_t kTouching = 0x18a36b, kOpen = 0x3d6fd0, kForce = 0xd1302a, kLink = 0x2b2f36,
                        kBounds = 0x2d5f9e;
constexpr std::array<std::uint32_t, 3> kAxes{0xd8342b, 0x2f9e44, 0x2b62d9};
constexpr float kDot = 6, kForceWidth = 2;
/// Of the axes of a joint's frame and of a normal, over the size of a body.
constexpr double kAxisLength = .6, kNormalLength = .3;
/// Of an arrow's head, over its length.
constexpr double kHead = .18, kHeadWidth = .08;

struct Arrow {
  Vec3 at, force;
};

void addArrow(const Vec3& from, const Vec3& way, std::uint32_t rgb, std::vector<Line>& lines) {
  const Vec3 tip = from + way, ahead = normalize(way);
  const Vec3 side = normalize(cross(ahead, std::fabs(ahead.z) < .9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0})) *
                    (kHeadWidth * length(way));
  const Vec3 other = cross(ahead, side), back = tip - way * kHead;
  lines.push_back({from, tip, rgb, kForceWidth});
  for (const Vec3& edge : {side, -side, other, -other}) lines.push_back({tip, back + edge, rgb, kForceWidth});
}

/// Vertices of objects, fetched once each.
class Vertices {
 public:
  explicit Vertices(const World& world) : world_(world) {}
  const Vec3& of(DeformableId object, int vertex) {
    if (object != object_ || positions_.empty()) positions_ = world_.positions(object), object_ = object;
    return positions_[static_cast<std::size_t>(vertex)];
  }

 private:
  const World& world_;
  DeformableId object_;
  std::vector<Vec3> positions_;
};

void addContacts(const World& world, const Overlays& overlays, double size, std::vector<Line>& lines,
                 std::vector<Arrow>& arrows) {
  const auto add = [&](const Vec3& at, const Vec3& normal, double depth, const Vec3& force) {
    if (overlays.forces && lengthSquared(force) > 0) arrows.push_back({at, force});
    if (!overlays.contacts) return;
    const std::uint32_t rgb = depth > 0 || lengthSquared(force) > 0 ? kTouching : kOpen;
    lines.push_back({at, at, rgb, kDot});
    lines.push_back({at, at + normal * (kNormalLength * size), rgb});
  };
  for (const ContactPoint& c : world.contacts()) add(c.position, c.normal, c.depth, c.force);
  Vertices vertices(world);
  for (const VertexContact& c : world.vertexContacts())
    add(vertices.of(c.object, c.vertex), c.normal, c.depth, c.force);
}

void addJoints(const World& world, const Overlays& overlays, double size, std::vector<Line>& lines,
               std::vector<Arrow>& arrows) {
  for (const JointId id : world.joints()) {
    const JointState state = world.state(id);
    if (state.broken) continue;
    const Frame a = jointFrame(world, id, 0), b = jointFrame(world, id, 1);
    if (overlays.forces && lengthSquared(state.force) > 0) arrows.push_back({b.position, state.force});
    if (!overlays.joints) continue;
    const auto [bodyA, bodyB] = world.bodiesOf(id);
    addFrame(a, kAxisLength * size, 2, lines);
    addFrame(b, kAxisLength * size, 1, lines);
    lines.push_back({a.position, b.position, kLink});
    if (bodyA.index >= 0) lines.push_back({world.state(bodyA).position, a.position, kLink, 1});
    if (bodyB.index >= 0) lines.push_back({world.state(bodyB).position, b.position, kLink, 1});
  }
  for (const AttachmentId id : world.attachments()) {
    const JointState state = world.state(id);
    const World::AttachmentEnds ends = world.endsOf(id);
    if (state.broken || ends.otherObject.index >= 0) continue;
    const Vec3 at = ends.body.index < 0 ? ends.anchor
                                        : world.state(ends.body).position +
                                              rotate(world.state(ends.body).orientation, ends.anchor);
    if (overlays.forces && lengthSquared(state.force) > 0) arrows.push_back({at, state.force});
    if (overlays.joints) lines.push_back({at, at, kLink, kDot});
  }
}

void addBounds(const World& world, std::vector<Line>& lines) {
  for (const io::PictureBody& body : io::pictureBodies(world)) {
    if (body.shape.type == ShapeType::Plane) continue;
    Vec3 low, high;
    if (body.deforms) {
      const std::vector<Vec3>& points = body.shape.geometry->points;
      low = high = points.front();
      for (const Vec3& p : points)
        for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    } else {
      high = {io::extentAlong(body, {1, 0, 0}), io::extentAlong(body, {0, 1, 0}),
              io::extentAlong(body, {0, 0, 1})};
      low = -high;
    }
    addBox(body.position + low, body.position + high, kBounds, lines);
  }
}

}  // namespace

Overlays overlaysNamed(const std::vector<std::string>& names) {
  Overlays overlays;
  for (const std::string& name : names) {
    if (name == "contacts")
      overlays.contacts = true;
    else if (name == "forces")
      overlays.forces = true;
    else if (name == "joints")
      overlays.joints = true;
    else if (name == "bounds")
      overlays.bounds = true;
    else
      throw Error("--show", "contacts, forces, joints or bounds", name);
  }
  return overlays;
}

Frame jointFrame(const World& world, JointId id, int side) {
  const JointDef& def = world.definition(id);
  const Vec3& anchor = side == 0 ? def.anchorA : def.anchorB;
  const Quat& frame = side == 0 ? def.frameA : def.frameB;
  const BodyId body = world.bodiesOf(id)[static_cast<std::size_t>(side)];
  if (body.index < 0) return {anchor, frame};
  const BodyState state = world.state(body);
  return {state.position + rotate(state.orientation, anchor), state.orientation * frame};
}

void addFrame(const Frame& frame, double length, float width, std::vector<Line>& lines) {
  for (int i = 0; i < 3; ++i) {
    Vec3 axis;
    axis[i] = length;
    lines.push_back({frame.position, frame.position + rotate(frame.orientation, axis),
                     kAxes[static_cast<std::size_t>(i)], width});
  }
}

void addBox(const Vec3& low, const Vec3& high, std::uint32_t rgb, std::vector<Line>& lines) {
  const auto corner = [&](int i) {
    return Vec3{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
  };
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if (!(i & bit)) lines.push_back({corner(i), corner(i | bit), rgb, 1});
}

std::vector<Line> overlayLines(const World& world, const Overlays& overlays, double size) {
  std::vector<Line> lines;
  std::vector<Arrow> arrows;
  if (overlays.contacts || overlays.forces) addContacts(world, overlays, size, lines, arrows);
  if (overlays.joints || overlays.forces) addJoints(world, overlays, size, lines, arrows);
  if (overlays.bounds) addBounds(world, lines);
  double largest = 0;
  for (const Arrow& arrow : arrows) largest = std::max(largest, length(arrow.force));
  for (const Arrow& arrow : arrows)
    addArrow(arrow.at, arrow.force * (kLongestForce * size / largest), kForce, lines);
  return lines;
}

}  // namespace rubble::render

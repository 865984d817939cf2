#include "io/picture_stands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rubble::io {
namespace {

/// Thickness of a stand over the size of what it carries [1].
constexpr double kStandThickness = .12;
/// Room below an axle over the reach of what turns on it, where the world has no ground [1].
constexpr double kRoom = 1.2;
/// A body is a shaft if it is this much longer than wide [1].
constexpr double kShaft = 3;
/// Half length of a rail without limits over that of what slides on it [1].
constexpr double kRail = 2.5;
/// Half size of the bearing of a shaft, and of its post, over the half width of the shaft [1].
constexpr double kBearing = 1.3, kBearingPost = .6;
/// How far a post stands from what turns, and rises above its axle, over its half width [1].
constexpr double kPostGap = 1.6, kPostRise = 1.5;
/// A post or rail along what it carries, over the half length of that [1].
constexpr double kOverlength = 1.1;
/// Half width of a rail over that of a post, but at most this share of that of what slides on it [1].
constexpr double kRailThickness = 1.5, kRailWidest = .8;
/// Room under what turns, over its reach, that a post wants [1].
constexpr double kPostRoom = 1.05;
/// Radius of the wheel of a pulley over the size of the bodies of its world, and half its width over that
/// radius or size [1].
constexpr double kWheel = 3, kWheelWidth = .3;
/// Cosine of the angle to the vertical below which an axis is upright [1].
constexpr double kUpright = .9;
/// Of the wheel of a pulley, red, green and blue (sRGB): brown.
constexpr Vec3 kWheelColor{.55, .40, .27};
/// A stand is at most so many times as high as what it carries is large [1].
constexpr double kHighest = 16;

/// What a joint holds in the world. `anchor` and `axis` are of the world, along which the coordinate of the
/// joint grows as the body moves. `body` is as it was added.
struct Held {
  JointId joint;
  BodyId id;
  PictureBody body;
  Vec3 anchor, axis;

  double along() const { return extentAlong(body, axis); }
  double reach() const { return boundingRadius(body.shape); }
  /// Of all that it sweeps about the axle.
  double swept() const { return reach() + length(body.position - anchor); }
};

Held heldBy(const World& world, JointId id) {
  const JointDef& joint = world.definition(id);
  const auto [a, b] = world.bodiesOf(id);
  const bool isA = b.index < 0;
  const BodyDef& body = world.definition(isA ? a : b);
  return {id,
          isA ? a : b,
          {body.shape, body.position, body.orientation},
          isA ? joint.anchorB : joint.anchorA,
          rotate(isA ? joint.frameB : joint.frameA, Vec3{isA ? 1. : -1., 0, 0})};
}

bool isInWorld(const World& world, JointId id) {
  const auto [a, b] = world.bodiesOf(id);
  return (a.index < 0) != (b.index < 0);
}

Vec3 acrossOf(const Vec3& axis, const Vec3& wish) {
  const Vec3 across = wish - axis * dot(wish, axis);
  const Vec3 other = cross(axis, std::fabs(axis.x) < .6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  return length(across) > 1e-6 ? normalize(across) : normalize(other);
}

class Stands {
 public:
  explicit Stands(const World& world) : world_(world), up_(normalize(-world.gravity(), {0, 0, 1})) {
    for (const JointId id : world.joints())
      if (needsStand(world, id) && !world.state(id).broken) joints_.push_back(id);
    ground_ = ground();
    for (const JointId id : joints_) {
      const JointType type = world.definition(id).type;
      if (type == JointType::Pulley) {
        addPulley(world.definition(id));
        continue;
      }
      const Held held = heldBy(world, id);
      if (type == JointType::Slider)
        addRail(held);
      else if (isUpright(held.axis))
        addPost(held);
      else
        addAxle(held);
    }
  }
  std::vector<PictureBody> take() { return std::move(parts_); }

 private:
  double height(const Vec3& point) const { return dot(point, up_); }
  bool isUpright(const Vec3& axis) const { return std::fabs(dot(axis, up_)) > kUpright; }
  Vec3 onGround(const Vec3& point) const { return point - up_ * (height(point) - ground_); }

  PictureBody& add(const Shape& shape, const Vec3& position, const Quat& orientation) {
    PictureBody& part = parts_.emplace_back();
    part.shape = shape, part.position = position, part.orientation = orientation;
    part.motion = Motion::Static;
    part.key = kStandKeys + static_cast<std::uint32_t>(parts_.size() - 1);
    return part;
  }
  void beam(const Vec3& from, const Vec3& to, double half) {
    add(Shape::box({length(to - from) / 2, half, half}), (from + to) * .5, frameAlong(to - from));
  }

  /// Height of the highest static plane that is level; else below all bodies as they were added, with room
  /// for what turns about level axes [m].
  double ground() const {
    double plane = -std::numeric_limits<double>::infinity(), lowest = -plane;
    for (const BodyId id : world_.bodies()) {
      const BodyDef& body = world_.definition(id);
      const double at = height(body.position);
      if (body.shape.type != ShapeType::Plane)
        lowest = std::min(lowest, at - extentAlong({body.shape, body.position, body.orientation}, up_));
      else if (dot(rotate(body.orientation, Vec3{0, 0, 1}), up_) > .99)
        plane = std::max(plane, at);
    }
    if (std::isfinite(plane)) return plane;
    for (const JointId id : joints_) {
      if (world_.definition(id).type != JointType::Hinge) continue;
      const Held held = heldBy(world_, id);
      if (!isUpright(held.axis)) lowest = std::min(lowest, height(held.anchor) - kRoom * held.swept());
    }
    return lowest;
  }

  double thickness(double reach, double along) const {
    return kStandThickness * std::min(reach, 4 * along + .1 * reach) / 2;
  }
  bool isInReach(const Vec3& anchor, double reach) const {
    return height(anchor) > ground_ && height(anchor) - ground_ < kHighest * reach;
  }
  /// Does another joint of the body lie on that side of it?
  bool isTaken(const Held& held, double side) const {
    return std::ranges::any_of(world_.jointsOf(held.id), [&](JointId id) {
      const JointDef& joint = world_.definition(id);
      if (id == held.joint || joint.type == JointType::Gear || joint.type == JointType::Rack) return false;
      const Vec3 anchor = world_.bodiesOf(id)[0] == held.id ? joint.anchorA : joint.anchorB;
      return side * dot(rotate(held.body.orientation, anchor), held.axis) > .9 * held.along();
    });
  }

  /// What turns about an upright axis: a post along it.
  void addPost(const Held& held) {
    const double half = thickness(held.reach(), held.along());
    if (isInReach(held.anchor, held.reach()))
      beam(onGround(held.anchor), held.anchor + up_ * (kOverlength * held.along()), half);
  }

  /// What turns about another axis: an axle between two posts, and a bearing if it is a shaft.
  void addAxle(const Held& held) {
    const double along = held.along(), reach = held.reach(), half = thickness(reach, along);
    if (!isInReach(held.anchor, held.swept())) return;
    const Vec3 level = acrossOf(up_, held.axis);
    const double wide = extentAlong(held.body, cross(up_, level));
    if (along > kShaft * wide) {
      const Vec3 bearing = level * (kBearing * wide);
      beam(held.anchor - bearing, held.anchor + bearing, kBearing * wide);
      beam(onGround(held.anchor), held.anchor, kBearingPost * wide);
      return;
    }
    std::array<bool, 2> free{!isTaken(held, -1), !isTaken(held, 1)};
    if (!free[0] && !free[1]) free = {true, true};
    addPosts(held.anchor + level * dot(held.body.position - held.anchor, level), level,
             along + kPostGap * half, half, free, height(held.anchor) - ground_ > kPostRoom * reach);
  }
  /// An axle of half length `wide`, with posts at those of its ends that are free.
  void addPosts(const Vec3& anchor, const Vec3& axis, double wide, double half,
                const std::array<bool, 2>& free, bool hasRoom) {
    const Vec3 ends[2] = {anchor - axis * (free[0] ? wide : wide / 2),
                          anchor + axis * (free[1] ? wide : wide / 2)};
    for (const std::size_t side : {0u, 1u})
      if (hasRoom && free[side]) beam(onGround(ends[side]), ends[side] + up_ * (kPostRise * half), half);
    beam(ends[0], ends[1], half);
  }

  /// Bodies that connect a body to the world by other joints than its own to the world.
  struct Linkage {
    double sum = 0, longest = 0;  ///< of the distances between the joints of each body [m]
    Vec3 start, end;              ///< joints of the first body, and to the world
  };
  Vec3 anchorOn(JointId id, BodyId body) const {
    const JointDef& joint = world_.definition(id);
    return world_.bodiesOf(id)[0] == body ? joint.anchorA : joint.anchorB;
  }
  /// Goes on from a body that was entered by a joint. Returns false if no way is found to the world.
  bool follow(BodyId body, JointId from, std::vector<BodyId>& visited, Linkage& link) const {
    visited.push_back(body);
    for (const JointId id : world_.jointsOf(body)) {
      const JointType type = world_.definition(id).type;
      if (id == from || type == JointType::Gear || type == JointType::Rack) continue;
      const auto [a, b] = world_.bodiesOf(id);
      const BodyId other = a == body ? b : a;
      if (std::ranges::find(visited, other) != visited.end()) continue;
      Linkage more = link;
      if (body == visited.front()) {
        const BodyDef& first = world_.definition(body);
        more.start = first.position + rotate(first.orientation, anchorOn(id, body));
      } else {
        const double apart = length(anchorOn(id, body) - anchorOn(from, body));
        more.sum += apart, more.longest = std::max(more.longest, apart);
      }
      if (other.index < 0) more.end = anchorOn(id, other);
      if (other.index >= 0 && !follow(other, id, visited, more)) continue;
      link = more;
      return true;
    }
    return false;
  }
  /// How far what slides may go, as limits of its joint [m]: its own, or those of the linkage that moves it.
  std::array<double, 2> travel(const Held& held) const {
    const JointAxis& limits = world_.definition(held.joint).axes[0];
    std::vector<BodyId> visited;
    Linkage link;
    if (std::isfinite(limits.min) || std::isfinite(limits.max) || !follow(held.id, held.joint, visited, link))
      return {limits.min, limits.max};
    const double at = dot(link.start - link.end, held.axis), far = link.sum - std::fabs(at),
                 near = std::max(2 * link.longest - link.sum, 0.) - std::fabs(at);
    return at > 0 ? std::array{near, far} : std::array{-far, -near};
  }

  /// What slides: a rail on the side away from all that it is joined to, or below it.
  void addRail(const Held& held) {
    const double along = held.along();
    const auto [least, most] = travel(held);
    const bool upright = isUpright(held.axis);
    Vec3 wish = -up_;
    if (upright)
      for (const JointId id : world_.jointsOf(held.id))
        for (const BodyId other : world_.bodiesOf(id))
          if (other.index >= 0 && other != held.id)
            wish = held.body.position - world_.definition(other).position;
    const Vec3 side = acrossOf(held.axis, wish);
    const double half = std::min(kRailThickness * thickness(held.reach(), along),
                                 kRailWidest * extentAlong(held.body, side));
    const Vec3 middle = held.body.position + side * (extentAlong(held.body, side) + half);
    const auto end = [&](double limit, double direction) {
      const double way = std::isfinite(limit) ? limit + direction * along
                                              : direction * along * (upright ? kOverlength : kRail);
      return middle + held.axis * way;
    };
    Vec3 low = end(least, -1), high = end(most, 1);
    if (upright) {
      if (height(low) > height(high)) std::swap(low, high);
      if (isInReach(high, held.swept())) beam(onGround(low), high, half);
      return;
    }
    beam(low, high, half);
    for (const Vec3& foot : {low, high})
      if (height(foot) - ground_ > half) beam(onGround(foot), foot, half);
  }

  /// A rope over two points: a wheel between them, or one for each if they are far apart.
  void addPulley(const JointDef& joint) {
    const Vec3 way = joint.pulleyB - joint.pulleyA;
    const Vec3 along = acrossOf(up_, way), axis = cross(along, up_);
    const double size = typicalSize(pictureBodiesOf(world_)), apart = length(way);
    const double radius = std::min(apart / 2, kWheel * size), half = kWheelWidth * std::min(radius, size);
    if (!(radius > 0)) return;
    std::vector<Vec3> centers{joint.pulleyA + way * .5};
    if (radius < apart / 2) centers = {joint.pulleyA + along * radius, joint.pulleyB - along * radius};
    for (const Vec3& center : centers) {
      add(Shape::cylinder(radius, half), center, frameAlong(axis) * fromAxisAngle({0, 1, 0}, std::acos(0.)))
          .color = kWheelColor;
      addPosts(center, axis, half + kPostGap * half / 2, half / 2, {true, true}, height(center) > ground_);
    }
  }
  static std::vector<PictureBody> pictureBodiesOf(const World& world) {
    std::vector<PictureBody> bodies;
    for (const BodyId id : world.bodies()) bodies.emplace_back().shape = world.definition(id).shape;
    return bodies;
  }

  const World& world_;
  Vec3 up_;
  double ground_ = 0;
  std::vector<JointId> joints_;
  std::vector<PictureBody> parts_;
};

}  // namespace

bool needsStand(const World& world, JointId id) {
  const JointType type = world.definition(id).type;
  return type == JointType::Pulley ||
         ((type == JointType::Hinge || type == JointType::Slider) && isInWorld(world, id));
}

std::vector<PictureBody> standsOf(const World& world) { return Stands(world).take(); }

}  // namespace rubble::io

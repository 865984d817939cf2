/// Machines as they are drawn: wheels of gears and racks have teeth, and what moves in the world has a stand.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "io/picture_stands.h"

namespace rubble::io {
namespace {

constexpr double kPi = std::numbers::pi;
/// Worlds with more bodies or joints are drawn plainly.
constexpr std::size_t kMostBodies = 200, kMostJoints = 60;
/// Teeth of a wheel; the larger wheel of a pair may have more, and one with more than kMostDrawnTeeth is
/// drawn plainly.
constexpr int kFewTeeth = 10, kMostTeeth = 40, kMostDrawnTeeth = 400;
/// Addendum and half widths of a tooth at its root and tip, over the pitch [1].
constexpr double kAddendum = .22, kRootHalf = .31, kTipHalf = .15;

/// A wheel: its axis and sizes in the frame of its body.
struct Wheel {
  std::size_t body = 0;
  Vec3 axis;
  double radius = 0, half = 0;  ///< of the pitch circle, of the thickness [m]
};

Vec3 acrossOf(const Vec3& axis) {
  return normalize(cross(axis, std::fabs(axis.x) < .6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

/// Spheres, and boxes and cylinders whose axis is that of the wheel, are drawn as wheels.
bool wheelOf(const BodyDef& body, const Vec3& axis, Wheel& wheel) {
  const Shape& shape = body.shape;
  const Vec3 a = abs(axis);
  const int along = a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
  wheel.axis = axis;
  if (shape.type == ShapeType::Cylinder) {
    wheel.radius = shape.radius, wheel.half = shape.halfLength;
    return a.z > .99;
  }
  if (shape.type == ShapeType::Sphere) {
    wheel.radius = shape.radius, wheel.half = .35 * shape.radius;
    return true;
  }
  if (shape.type != ShapeType::Box || a[along] < .99) return false;
  const double one = shape.halfExtents[(along + 1) % 3], other = shape.halfExtents[(along + 2) % 3];
  wheel.radius = std::min(one, other), wheel.half = shape.halfExtents[along];
  return std::max(one, other) < 1.2 * wheel.radius;  // a wheel, and not an arm
}

/// A disc with teeth, one of them at the angle `phase` about the axis.
Shape toothedWheel(const Wheel& wheel, int teeth, double phase) {
  const Vec3 right = acrossOf(wheel.axis), up = cross(wheel.axis, right);
  const double pitch = 2 * kPi / teeth, addendum = kAddendum * wheel.radius * pitch;
  std::vector<Vec3> points{wheel.axis * -wheel.half, wheel.axis * wheel.half};
  std::vector<std::array<int, 3>> triangles;
  const int around = 4 * teeth;
  for (int i = 0; i < around; ++i) {
    constexpr double kAt[4] = {-kRootHalf, -kTipHalf, kTipHalf, kRootHalf};
    const double angle = phase + pitch * (i / 4 + kAt[i % 4]),
                 r = wheel.radius + (i % 4 == 1 || i % 4 == 2 ? addendum : -addendum);
    const Vec3 rim = right * (r * std::cos(angle)) + up * (r * std::sin(angle));
    points.push_back(rim + points[0]);
    points.push_back(rim + points[1]);
    const int low = 2 + 2 * i, nextLow = 2 + 2 * ((i + 1) % around);
    triangles.push_back({0, nextLow, low});
    triangles.push_back({1, low + 1, nextLow + 1});
    triangles.push_back({low, nextLow, nextLow + 1});
    triangles.push_back({low, nextLow + 1, low + 1});
  }
  return Shape::mesh(std::move(points), std::move(triangles));
}

/// Angle of a direction (body frame) about the axis of a wheel.
double angleOf(const Wheel& wheel, const Vec3& direction) {
  const Vec3 right = acrossOf(wheel.axis);
  return std::atan2(dot(direction, cross(wheel.axis, right)), dot(direction, right));
}

/// Teeth such that both wheels have a whole number of them.
int teethFor(double ratio) {
  int best = kFewTeeth;
  double least = 1;
  for (int teeth = kFewTeeth; teeth <= kMostTeeth; ++teeth) {
    const double other = teeth * ratio, error = std::fabs(other - std::round(other));
    if (other >= kFewTeeth - .5 && error < least - 1e-6) least = error, best = teeth;
  }
  return best;
}

/// A number of teeth that can be drawn, or one above kMostDrawnTeeth.
int wholeTeeth(double teeth) {
  return static_cast<int>(std::lround(std::clamp(teeth, 3.0, kMostDrawnTeeth + 1.0)));
}

using Drawn = std::unordered_map<std::size_t, std::pair<Shape, int>>;

void addGear(const JointDef& joint, const BodyDef& a, const BodyDef& b, std::size_t slotA, std::size_t slotB,
             Drawn& drawn) {
  Wheel wheelA, wheelB;
  const Vec3 axisA = rotate(joint.frameA, Vec3{1, 0, 0}), axisB = rotate(joint.frameB, Vec3{1, 0, 0});
  const bool hasA = wheelOf(a, axisA, wheelA), hasB = wheelOf(b, axisB, wheelB);
  if (!hasA && !hasB) return;
  const Vec3 axis = rotate(a.orientation, axisA), other = rotate(b.orientation, axisB);
  const bool parallel = std::fabs(dot(axis, other)) > .99;
  Vec3 apart = b.position - a.position;
  apart -= axis * dot(apart, axis);
  const double distance = length(apart), ratio = std::max(1e-3, std::fabs(joint.ratio));
  if (parallel && hasA && hasB && distance > 1e-6)
    wheelA.radius = distance / (1 + ratio), wheelB.radius = distance - wheelA.radius;
  int teeth = teethFor(ratio);
  if (const auto known = drawn.find(slotB); known != drawn.end())
    teeth = wholeTeeth(known->second.second / ratio);
  if (const auto known = drawn.find(slotA); known != drawn.end()) teeth = known->second.second;
  const int teethB = wholeTeeth(teeth * ratio);
  // a tooth of A meets a gap of B between the two
  const double atA = angleOf(wheelA, rotateInverse(a.orientation, apart)),
               atB = angleOf(wheelB, rotateInverse(b.orientation, -apart)) + kPi / teethB;
  const auto draw = [&](std::size_t slot, const Wheel& wheel, int count, double phase) {
    if (count <= kMostDrawnTeeth && !drawn.contains(slot))
      drawn[slot] = {toothedWheel(wheel, count, phase), count};
  };
  if (hasA) draw(slotA, wheelA, teeth, atA);
  if (hasB) draw(slotB, wheelB, teethB, atB);
}

}  // namespace

bool hasMachines(const World& world) {
  if (world.bodies().size() > kMostBodies) return false;
  const std::vector<JointId> joints = world.joints();
  return joints.size() <= kMostJoints && std::ranges::any_of(joints, [&](JointId id) {
           const JointType type = world.definition(id).type;
           return type == JointType::Gear || type == JointType::Rack || needsStand(world, id);
         });
}

void drawMachines(const World& world, std::vector<PictureBody>& bodies) {
  if (!hasMachines(world)) return;
  std::unordered_map<int, std::size_t> slots;
  const std::vector<BodyId> ids = world.bodies();
  for (std::size_t i = 0; i < ids.size(); ++i) slots[ids[i].index] = i;
  Drawn drawn;
  for (const JointId id : world.joints()) {
    const JointDef& joint = world.definition(id);
    const auto [a, b] = world.bodiesOf(id);
    if (world.state(id).broken) continue;
    if (joint.type == JointType::Gear && a.index >= 0 && b.index >= 0)
      addGear(joint, world.definition(a), world.definition(b), slots[a.index], slots[b.index], drawn);
    Wheel pinion;
    if (joint.type == JointType::Rack && a.index >= 0 &&
        wheelOf(world.definition(a), rotate(joint.frameA, Vec3{1, 0, 0}), pinion)) {
      pinion.radius = std::fabs(joint.ratio);
      drawn[slots[a.index]] = {toothedWheel(pinion, 16, 0), 16};
    }
  }
  for (const auto& [slot, wheel] : drawn) bodies[slot].shape = wheel.first, bodies[slot].isWheel = true;
  const std::vector<PictureBody> stands = standsOf(world);
  bodies.insert(bodies.end(), stands.begin(), stands.end());
}

}  // namespace rubble::io

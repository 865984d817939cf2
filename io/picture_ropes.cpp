/// Joints that hold by a length have nothing of their own to be seen: they are drawn as tubes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "forces/joint_kind.h"
#include "io/picture.h"

namespace rubble::io {
namespace {

/// Radius of a tube over the half size of a typical body.
constexpr double kThickness = .08;

bool isRope(JointType type) { return kindOf(type).has("length"); }

Vec3 anchorOf(const World& world, BodyId body, const Vec3& anchor) {
  if (body.index < 0) return anchor;
  const BodyState state = world.state(body);
  return state.position + rotate(state.orientation, anchor);
}

}  // namespace

bool hasRopes(const World& world) {
  const std::vector<JointId> joints = world.joints();
  return std::any_of(joints.begin(), joints.end(),
                     [&](const JointId id) { return isRope(world.definition(id).type); });
}

void addRopes(const World& world, std::vector<PictureBody>& bodies) {
  if (!hasRopes(world)) return;
  const double radius = kThickness * typicalSize(bodies);
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  const auto add = [&](const Vec3& a, const Vec3& b) {
    if (std::isfinite(lengthSquared(a) + lengthSquared(b))) addTube(a, b, radius, points, triangles);
  };
  for (const JointId id : world.joints()) {
    const JointDef& joint = world.definition(id);
    if (!isRope(joint.type) || world.state(id).broken) continue;
    const auto [bodyA, bodyB] = world.bodiesOf(id);
    const Vec3 a = anchorOf(world, bodyA, joint.anchorA), b = anchorOf(world, bodyB, joint.anchorB);
    if (!kindOf(joint.type).has("pulley_a")) {
      add(a, b);
      continue;
    }
    add(a, joint.pulleyA);
    add(joint.pulleyA, joint.pulleyB);
    add(joint.pulleyB, b);
  }
  if (points.empty()) return;
  // Taken as a solid, so that tubes have insides and outsides.
  PictureBody mesh{Shape::mesh(points, triangles, false), {}, {}, 0, kRopeKey, Motion::Dynamic};
  mesh.deforms = true;
  mesh.value = std::numeric_limits<double>::quiet_NaN();
  bodies.push_back(std::move(mesh));
}

}  // namespace rubble::io

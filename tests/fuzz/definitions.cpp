#include "tests/fuzz/definitions.h"

namespace rubble::fuzz {
namespace {

double extent(ByteSource& in) { return in.seldom() ? in.ratio(1e-4, 1e3) : in.ratio(.02, 1); }

Shape roundShape(ByteSource& in) {
  const double radius = extent(in);
  return in.flag() ? Shape::capsule(radius, extent(in)) : Shape::sphere(radius);
}

Shape boxShape(ByteSource& in) {
  const double x = extent(in), y = extent(in);
  const Vec3 half{x, y, extent(in)};
  return Shape::box(half, in.flag() ? in.between(0, .5) * std::min({half.x, half.y, half.z}) : 0);
}

Shape turnedShape(ByteSource& in) {
  const double radius = extent(in), half = extent(in);
  if (in.flag()) return Shape::cone(radius, half);
  return Shape::cylinder(radius, half, in.flag() ? in.between(0, .4) * std::min(radius, half) : 0);
}

Shape hullShape(ByteSource& in) {
  const double size = extent(in);
  std::vector<Vec3> points{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  for (int more = in.below(12); more > 0; --more) points.push_back(in.vector(-size, size));
  return Shape::hull(points, in.flag() ? in.between(0, .3) * size : 0);
}

Shape convexShape(ByteSource& in) {
  switch (in.below(4)) {
    case 0:
      return roundShape(in);
    case 1:
      return boxShape(in);
    case 2:
      return turnedShape(in);
    default:
      return hullShape(in);
  }
}

Shape compoundShape(ByteSource& in) {
  std::vector<ShapePartDef> parts;
  for (int more = 1 + in.below(3); more > 0; --more) {
    ShapePartDef& part = parts.emplace_back();
    part.shape = convexShape(in);
    part.position = in.vector(-.5, .5);
    part.orientation = in.rotation();
    part.density = in.ratio(.1, 10);
    if (in.flag()) part.material = material(in);
  }
  return Shape::compound(parts);
}

/// A ball with bumps.
Shape distanceShape(ByteSource& in) {
  const std::array<int, 3> counts{3 + in.below(3), 3 + in.below(3), 3 + in.below(3)};
  const double spacing = in.ratio(.05, .5);
  std::vector<double> distances;
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x) {
        const Vec3 at = spacing * (Vec3{double(x), double(y), double(z)} - Vec3{1, 1, 1});
        distances.push_back(std::sqrt(dot(at, at)) - in.between(.6, 1.2) * spacing);
      }
  return Shape::distanceField(counts, in.vector(-1, 0), spacing, distances);
}

Shape meshShape(ByteSource& in) {
  std::vector<Vec3> vertices;
  for (int i = 0; i < 9; ++i) vertices.push_back(Vec3{i % 3 - 1., i / 3 - 1., 0} + in.vector(-.4, .4));
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < 4; ++i) {
    const int v = i % 2 + 3 * (i / 2);
    triangles.push_back({v, v + 1, v + 4}), triangles.push_back({v, v + 4, v + 3});
  }
  for (int more = in.below(4); more > 0; --more) triangles.push_back({in.below(9), in.below(9), in.below(9)});
  return Shape::mesh(vertices, triangles, in.flag());
}

Shape heightShape(ByteSource& in) {
  const int x = 2 + in.below(4), y = 2 + in.below(4);
  std::vector<double> heights;
  for (int i = 0; i < x * y; ++i) heights.push_back(in.between(-.5, .5));
  return Shape::heightField(x, y, {in.ratio(.1, 2), in.ratio(.1, 2), 1}, heights);
}

JointAxis axis(ByteSource& in) {
  JointAxis out;
  if (in.flag()) out.min = in.between(-1, .5), out.max = out.min + in.between(0, 1);
  if (in.seldom()) out.min = out.max = in.between(-1, 1);
  if (in.flag()) out.limitStiffness = in.ratio(1, 1e7), out.limitDamping = in.between(0, 100);
  if (in.flag()) {
    out.targetPosition = in.between(-1, 1), out.targetSpeed = in.between(-5, 5);
    out.driveStiffness = in.seldom() ? kHard : in.ratio(1, 1e6) - 1;
    out.driveDamping = in.seldom() ? kHard : in.ratio(1, 1e4) - 1;
    out.maxDriveForce = in.flag() ? in.ratio(.1, 1e4) : kHard;
  }
  if (in.flag()) out.friction = in.ratio(.01, 100);
  if (in.seldom()) out.armature = in.ratio(1e-4, 10), out.damping = in.between(0, 10);
  if (in.seldom()) out.motorForce = in.between(-10, 10);
  return out;
}

}  // namespace

Material material(ByteSource& in) {
  Material out;
  out.dynamicFriction = in.between(0, 1.5);
  out.staticFriction = out.dynamicFriction + in.between(0, .5);
  if (in.flag()) out.restitution = in.between(0, 1);
  out.frictionCombine = static_cast<Combine>(in.below(6));
  out.restitutionCombine = static_cast<Combine>(in.below(6));
  if (in.flag()) out.rollingFriction = in.between(0, .1), out.torsionalFriction = in.between(0, .1);
  if (in.seldom()) out.surfaceVelocity = in.vector(-2, 2);
  return out;
}

Shape solidShape(ByteSource& in) {
  switch (in.below(8)) {
    case 0:
      return compoundShape(in);
    case 1:
      return distanceShape(in);
    default:
      return convexShape(in);
  }
}

Shape anyShape(ByteSource& in) {
  switch (in.below(8)) {
    case 0:
      return Shape::plane();
    case 1:
      return meshShape(in);
    case 2:
      return heightShape(in);
    default:
      return solidShape(in);
  }
}

BodyDef body(ByteSource& in) {
  BodyDef out;
  const int motion = in.below(8);
  out.motion = motion == 0 ? Motion::Static : motion == 1 ? Motion::Kinematic : Motion::Dynamic;
  out.shape = out.motion == Motion::Dynamic ? solidShape(in) : anyShape(in);
  out.position = in.vector(-2, 2);
  out.orientation = in.rotation();
  if (in.flag()) out.velocity = in.seldom() ? in.vector(-1e3, 1e3) : in.vector(-10, 10);
  if (in.flag()) out.angularVelocity = in.vector(-20, 20);
  out.material = material(in);
  if (in.flag()) out.mass = in.seldom() ? in.ratio(1e-6, 1e6) : in.ratio(.1, 100);
  if (in.seldom()) out.gravityScale = in.between(-2, 2);
  if (in.flag()) out.linearDamping = in.between(0, 5), out.angularDamping = in.between(0, 5);
  if (in.seldom()) out.lockTranslation = {in.flag(), in.flag(), in.flag()};
  if (in.seldom()) out.lockRotation = {in.flag(), in.flag(), in.flag()};
  if (in.seldom()) out.filter = {in.byte(), in.byte(), in.below(3) - 1};
  out.sensor = in.seldom();
  return out;
}

JointDef joint(ByteSource& in) {
  JointDef out;
  // kinds of JointType; one in 16 is a gimbal
  constexpr int kKinds = 15, kGimbal = 240;
  const int kind = in.byte();
  out.type = kind >= kGimbal ? jointType("gimbal") : static_cast<JointType>(kind % kKinds);
  if (kind >= kGimbal) {
    GimbalFields fields;
    fields.offsetB = in.vector(-1, 1);
    fields.offsetA = in.vector(-1, 1);
    fields.tiltB = in.between(-1.4, 1.4);
    fields.tiltA = in.between(-1.4, 1.4);
    out.own = fields;
  }
  out.anchorA = in.vector(-1, 1), out.anchorB = in.vector(-1, 1);
  out.frameA = in.rotation(), out.frameB = in.rotation();
  if (in.flag()) out.orientationAtoB = in.rotation();
  if (in.flag()) {
    out.stiffness = in.ratio(1, 1e8);
    in.flag() ? out.damping = in.between(0, 1e3) : out.dampingRatio = in.between(0, 2);
    out.angularStiffness = in.ratio(1, 1e6);
    in.flag() ? out.angularDamping = in.between(0, 100) : out.angularDampingRatio = in.between(0, 2);
  }
  if (in.seldom()) out.maxForce = in.ratio(1, 1e5), out.maxTorque = in.ratio(1, 1e5);
  if (in.flag()) out.length = in.between(0, 2);
  if (in.flag()) out.ratio = in.between(-3, 3);
  if (in.flag()) out.swingY = in.between(.1, 3), out.swingZ = in.between(.1, 3);
  if (in.flag()) out.friction = in.between(0, 10);
  if (in.flag()) {
    out.driveStiffness = in.ratio(1, 1e4), out.driveDamping = in.between(0, 100);
    out.driveOrientation = in.rotation();
  }
  if (in.seldom()) out.breakForce = in.ratio(1, 1e4), out.breakTorque = in.ratio(1, 1e4);
  out.pulleyA = in.vector(-2, 2), out.pulleyB = in.vector(-2, 2);
  for (int axes = in.below(4), k = 0; k < axes; ++k)
    out.axes[static_cast<std::size_t>(in.below(6))] = axis(in);
  out.collide = in.flag();
  return out;
}

}  // namespace rubble::fuzz

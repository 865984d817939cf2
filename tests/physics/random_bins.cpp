#include "tests/physics/random_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace rubble::test {
namespace {

constexpr double kSizeRatio = 50, kDensityRatio = 1000;
constexpr double kBinGravity = 9.81;

struct RandomShape {
  Shape shape;
  double radius;     ///< of a sphere about the origin of its frame that holds it [m]
  double thickness;  ///< [m]
  bool round;        ///< it rolls
};

/// A shape that a sphere of that radius holds.
RandomShape randomShape(Random& random, double r) {
  const auto share = [&](double low) { return random.uniform(low, 1); };
  switch (random.below(8)) {
    case 0:
      return {Shape::sphere(r), r, 2 * r, true};
    case 1: {
      const Vec3 half = r / std::sqrt(3.) * Vec3{share(.15), share(.15), share(.5)};
      return {Shape::box(half), length(half), 2 * std::min({half.x, half.y, half.z}), false};
    }
    case 2: {
      const double radius = r * random.uniform(.15, .6);
      return {Shape::capsule(radius, r - radius), r, 2 * radius, true};
    }
    case 3: {
      const double radius = r * random.uniform(.2, .9), half = std::sqrt(r * r - radius * radius);
      return {Shape::cylinder(radius, half), r, 2 * std::min(radius, half), true};
    }
    case 4: {
      const double radius = r * random.uniform(.3, .8), half = std::sqrt(r * r - radius * radius);
      return {Shape::cone(radius, half), r, std::min(radius, half), true};
    }
    case 5: {
      const Vec3 half = r / std::sqrt(3.) * Vec3{share(.3), share(.3), share(.5)};
      const double thin = std::min({half.x, half.y, half.z});
      return {Shape::box(half, thin * random.uniform(.1, .6)), length(half), 2 * thin, false};
    }
    case 6: {
      std::vector<Vec3> points;
      const double flat = random.uniform(.3, 1);
      for (int k = 0; k < 12; ++k) {
        const Vec3 d = random.direction();
        points.push_back(r * Vec3{d.x, d.y, flat * d.z});
      }
      return {Shape::hull(points), r, .5 * flat * r, false};
    }
    default: {
      const double arm = r / std::sqrt(3.) * .98, thin = arm * random.uniform(.15, .5);
      return {Shape::compound({{Shape::box({arm, thin, thin}), {}, {}},
                               {Shape::box({thin, arm, thin}), {0, 0, thin}, {}},
                               {Shape::sphere(thin), {0, 0, -thin}, {}}}),
              r, 2 * thin, false};
    }
  }
}

BodyDef wall(const Shape& shape, const Vec3& position, const Quat& orientation = {}) {
  BodyDef def;
  def.motion = Motion::Static;
  def.shape = shape;
  def.position = position;
  def.orientation = orientation;
  return def;
}

/// Six sides that face the inside of a box.
Shape insideOfBox(const Vec3& half, bool twoSided, int cells) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1., 1.}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3, first = static_cast<int>(points.size());
      for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
          Vec3 p;
          p[axis] = sign * half[axis];
          p[u] = half[u] * (2. * i / cells - 1), p[v] = half[v] * (2. * j / cells - 1);
          points.push_back(p);
        }
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          const int a = first + j * (cells + 1) + i, b = a + 1, c = a + cells + 2, d = a + cells + 1;
          // counter-clockwise seen from inside
          if (sign < 0)
            triangles.push_back({a, b, c}), triangles.push_back({a, c, d});
          else
            triangles.push_back({a, c, b}), triangles.push_back({a, d, c});
        }
    }
  return Shape::mesh(points, triangles, twoSided);
}

void addBoxes(Scene& scene, const Vec3& half, double thick, bool floor) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1., 1.}) {
      if (axis == 2 && sign < 0 && !floor) continue;
      Vec3 size = half + Vec3{thick, thick, thick} * 2, at;
      size[axis] = thick;
      at[axis] = sign * (half[axis] + thick);
      scene.bodies.push_back(wall(Shape::box(size), at));
    }
}

void addWalls(Bin& bin, Random& random) {
  static const std::array<const char*, 6> kinds = {"thick boxes", "thin boxes",     "planes",
                                                   "mesh",        "two-sided mesh", "heights"};
  const Vec3& half = bin.inner;
  const double width = 2 * std::min(half.x, half.y);
  const std::size_t kind = static_cast<std::size_t>(random.below(6));
  bin.kind = kinds[kind];
  Scene& scene = bin.scene;
  if (kind == 0) {
    addBoxes(scene, half, width * random.uniform(.2, 1), true);
  } else if (kind == 1) {
    addBoxes(scene, half, width * random.logUniform(.002, .02), true);
  } else if (kind == 2) {
    const double q = std::numbers::pi / 2;
    scene.bodies.push_back(wall(Shape::plane(), {0, 0, -half.z}));
    scene.bodies.push_back(wall(Shape::plane(), {0, 0, half.z}, fromAxisAngle({1, 0, 0}, 2 * q)));
    scene.bodies.push_back(wall(Shape::plane(), {-half.x, 0, 0}, fromAxisAngle({0, 1, 0}, q)));
    scene.bodies.push_back(wall(Shape::plane(), {half.x, 0, 0}, fromAxisAngle({0, 1, 0}, -q)));
    scene.bodies.push_back(wall(Shape::plane(), {0, -half.y, 0}, fromAxisAngle({1, 0, 0}, -q)));
    scene.bodies.push_back(wall(Shape::plane(), {0, half.y, 0}, fromAxisAngle({1, 0, 0}, q)));
  } else if (kind <= 4) {
    scene.bodies.push_back(wall(insideOfBox(half, kind == 4, 1 + random.below(8)), {}));
  } else {
    addBoxes(scene, half, width * .3, false);
    const int n = 12 + random.below(20);
    const double spacing = 2.2 * std::max(half.x, half.y) / (n - 1), wave = random.uniform(.02, .12) * width;
    const double ax = random.uniform(1, 3) / width * std::numbers::pi,
                 ay = random.uniform(1, 3) / width * std::numbers::pi;
    std::vector<double> heights;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        heights.push_back(-wave * (1 + std::sin(ax * i * spacing) * std::cos(ay * j * spacing)));
    const double start = -spacing * (n - 1) / 2;
    scene.bodies.push_back(
        wall(Shape::heightField(n, n, {spacing, spacing, 0}, heights), {start, start, -half.z}));
    bin.inner.z += wave, bin.center.z -= wave;  // down to the lowest hollow
  }
  bin.walls = static_cast<int>(scene.bodies.size());
}

constexpr std::array kJoints = {JointType::Ball,      JointType::Fixed,         JointType::Hinge,
                                JointType::Slider,    JointType::Distance,      JointType::Rope,
                                JointType::Spring,    JointType::AngularSpring, JointType::SwingTwist,
                                JointType::Universal, JointType::SixDof};

/// Every joint resists its motion a little: what hangs freely swings for long.
JointDef randomJoint(Random& random, const Scene& scene, int a, int b, double mass, double size) {
  const JointType type = kJoints[static_cast<std::size_t>(random.below(static_cast<int>(kJoints.size())))];
  const Vec3 point = (scene.bodies[static_cast<std::size_t>(a)].position +
                      scene.bodies[static_cast<std::size_t>(b)].position) *
                     .5;
  JointDef joint = jointAt(scene, type, a, b, point, random.rotation());
  const double force = mass * kBinGravity;
  if (type == JointType::Spring || type == JointType::AngularSpring) {
    joint.stiffness = 20 * force / size, joint.dampingRatio = .5;
    joint.angularStiffness = 5 * force * size, joint.angularDampingRatio = .5;
  }
  if (type == JointType::Distance || type == JointType::Rope || type == JointType::Spring) {
    joint.anchorA = joint.anchorB = {};
    joint.length = -1;
  }
  if (type == JointType::Ball || type == JointType::SwingTwist) joint.friction = .05 * force * size;
  if (type == JointType::SwingTwist) joint.swingY = joint.swingZ = random.uniform(.3, 1.5);
  if (type == JointType::Hinge) joint.axes[0].friction = .05 * force * size;
  if (type == JointType::Slider)
    joint.axes[0].friction = .3 * force, joint.axes[0].min = -.2 * size, joint.axes[0].max = .2 * size;
  if (type == JointType::SixDof)
    for (JointAxis& axis : joint.axes) axis.min = -random.uniform(0, .3), axis.max = random.uniform(0, .3);
  return joint;
}

}  // namespace

Bin randomBin(std::uint64_t seed) {
  Random random(seed * 7919 + 17);
  Bin bin;
  bin.scene.gravity = {0, 0, -kBinGravity};
  const double large = random.logUniform(.1, 1), small = large / random.logUniform(2, kSizeRatio);
  const int count = 16 + random.below(32);
  const double half = 2.2 * large;
  bin.inner = {half, half * random.uniform(.8, 1.3), 0};
  // from the floor up, row by row: spheres about the bodies do not touch
  std::vector<RandomShape> shapes;
  std::vector<Vec3> places;
  double top = 0;
  const double highest = large * 60;
  for (int k = 0; k < count; ++k) {
    shapes.push_back(randomShape(random, random.logUniform(small, large) / 2));
    const double r = shapes.back().radius;
    for (int attempt = 0;; ++attempt) {
      const Vec3 p{random.uniform(-bin.inner.x + r, bin.inner.x - r),
                   random.uniform(-bin.inner.y + r, bin.inner.y - r),
                   r + random.uniform(0, std::min(highest, top + (attempt + 1) * .05 * large))};
      bool free = true;
      for (std::size_t j = 0; j < places.size() && free; ++j)
        free = length(p - places[j]) > 1.02 * (r + shapes[j].radius);
      if (!free) continue;
      places.push_back(p);
      top = std::max(top, p.z + r);
      break;
    }
  }
  bin.inner.z = .5 * (top + 2 * large);
  addWalls(bin, random);
  const double floor = -.5 * (top + 2 * large), lift = bin.kind == "heights" ? .01 * large : 0;
  const double speed = std::sqrt(2 * kBinGravity * random.uniform(0, 20));
  const double spin = random.logUniform(1, 50);
  for (int k = 0; k < count; ++k) {
    const RandomShape& s = shapes[static_cast<std::size_t>(k)];
    BodyDef def;
    def.shape = s.shape;
    def.position = places[static_cast<std::size_t>(k)] + Vec3{0, 0, floor + lift};
    def.orientation = random.rotation();
    def.density = 1000 * random.logUniform(1 / std::sqrt(kDensityRatio), std::sqrt(kDensityRatio));
    def.velocity = {random.uniform(-1, 1), random.uniform(-1, 1), -speed};
    def.angularVelocity = spin * random.uniform(0, 1) * random.direction();
    def.material.staticFriction = def.material.dynamicFriction = random.uniform(.3, .9);
    def.material.rollingFriction = .05 * s.radius;
    def.material.torsionalFriction = .05 * s.radius;
    bin.scene.bodies.push_back(def);
    bin.size.push_back(2 * s.radius);
    bin.thickness.push_back(s.thickness);
  }
  // some neighbors are joined
  for (int k = 0; k + 1 < count; ++k) {
    if (random.below(5) != 0) continue;
    int nearest = -1;
    for (int j = k + 1; j < count; ++j)
      if (nearest < 0 || length(places[std::size_t(j)] - places[std::size_t(k)]) <
                             length(places[std::size_t(nearest)] - places[std::size_t(k)]))
        nearest = j;
    const int a = bin.walls + k, b = bin.walls + nearest;
    const auto massOf = [&](int i) {
      const BodyDef& d = bin.scene.bodies[static_cast<std::size_t>(i)];
      return massProperties(d.shape, d.density).mass;
    };
    bin.scene.joints.push_back(
        randomJoint(random, bin.scene, a, b, std::min(massOf(a), massOf(b)),
                    std::min(bin.size[std::size_t(k)], bin.size[std::size_t(nearest)])));
  }
  bin.dt = std::array{1. / 30, 1. / 60, 1. / 60, 1. / 240}[static_cast<std::size_t>(random.below(4))];
  bin.iterations = random.below(3) == 0 ? 10 : 4;
  return bin;
}

bool BinOutcome::holds() const {
  return outside == 0 && restless == 0 && depth <= .05 && energyGain <= 1e-3 && quarantined == 0;
}

BinOutcome settle(const Bin& bin, const std::string& backend, int threads) {
  constexpr double kSeconds = 10, kWatched = 2, kStill = .02;
  WorldOptions options;
  options.backend = backend;
  options.threads = threads;
  options.timings = false;
  options.params.dt = bin.dt;
  options.params.iterations = bin.iterations;
  World world(bin.scene, options);
  BinOutcome out;
  const int steps = static_cast<int>(std::lround(kSeconds / bin.dt));
  const auto count = static_cast<int>(bin.size.size());
  const int thrown = static_cast<int>(bin.scene.bodies.size()) - count;
  const auto energy = [&] {
    const Quality q = world.quality();
    return q.kineticEnergy + q.potentialEnergy;
  };
  const double start = energy(), scale = world.quality().kineticEnergy + 1e-9;
  const double least = *std::min_element(bin.size.begin(), bin.size.end());
  // the origin of the frame of a hull may be outside of it
  std::vector<Vec3> centerOfMass;
  for (int k = 0; k < count; ++k) centerOfMass.push_back(world.massOf(world.bodyAt(thrown + k)).center);
  std::vector<bool> gone(std::size_t(count), false);
  const auto indexOf = [&](BodyId id) { return static_cast<int>(id.index) - thrown; };
  for (int i = 0; i < steps; ++i) {
    const StepReport report = world.step();
    out.quarantined += report.quarantined;
    if (i % 10 == 0 || i + 1 == steps) {
      const double gain = (energy() - start) / scale;
      if (gain > out.energyGain) out.energyGain = gain;
      for (int k = 0; k < count; ++k) {
        if (gone[std::size_t(k)]) continue;
        const BodyState body = world.state(world.bodyAt(thrown + k));
        const Vec3 d = abs(body.position + rotate(body.orientation, centerOfMass[std::size_t(k)]) -
                           bin.center) -
                       bin.inner;
        if (std::max({d.x, d.y, d.z}) > .05 * least) {
          gone[std::size_t(k)] = true;
          out.what += " body " + std::to_string(k) + " left at step " + std::to_string(i);
        }
      }
    }
    if (i < steps - static_cast<int>(kWatched / bin.dt)) continue;
    for (const ContactPoint& c : world.contacts()) {
      const int a = indexOf(c.a), b = indexOf(c.b);
      const double thin = std::min(a >= 0 ? bin.thickness[std::size_t(a)] : 1e300,
                                   b >= 0 ? bin.thickness[std::size_t(b)] : 1e300);
      if (c.depth / thin > out.depth) out.depth = c.depth / thin, out.depthMetres = c.depth;
    }
  }
  for (int k = 0; k < count; ++k) {
    if (gone[std::size_t(k)]) {
      ++out.outside;
      continue;
    }
    const BodyState s = world.state(world.bodyAt(thrown + k));
    const double size = bin.size[std::size_t(k)];
    const double moving = (length(s.velocity) + .5 * size * length(s.angularVelocity)) /
                          (kStill * std::sqrt(kBinGravity * size));
    if (moving > 1) ++out.restless;
    if (moving > 10) ++out.unsettled;
  }
  return out;
}

}  // namespace rubble::test

#include "build.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "cook/cook.h"

namespace rubble::scenes {

Argument count(const std::string& name, int value, int min, int max, const std::string& doc) {
  return {name, double(value), double(min), double(max), "1", doc, true};
}

Argument quantity(const std::string& name, double value, double min, double max, const std::string& unit,
                  const std::string& doc) {
  return {name, value, min, max, unit, doc, false};
}

Argument flag(const std::string& name, bool value, const std::string& doc) {
  return {name, value ? 1.0 : 0.0, 0, 1, "1", doc, true};
}

std::vector<Argument> stackArguments(std::vector<Argument> own, double density) {
  own.push_back(quantity("density", density, 1e-3, 1e7, "kg/m3",
                         "density of a brick; everything else keeps its ratio to it"));
  own.push_back(
      quantity("length_scale", 1, .01, 100, "1", "factor on all lengths; speeds scale with its square root"));
  return own;
}

double value(const Arguments& arguments, const std::string& name) {
  const auto found = arguments.find(name);
  if (found == arguments.end()) throw Error("argument " + name, "a value", "none");
  return found->second;
}

int whole(const Arguments& arguments, const std::string& name) {
  return int(std::lround(value(arguments, name)));
}

Spec variant(const Spec& base, const std::string& name, const std::string& doc, const Arguments& defaults,
             int steps) {
  Spec spec = base;
  spec.name = name;
  spec.doc = doc;
  if (steps > 0) spec.steps = steps;
  for (const auto& [key, number] : defaults) {
    const auto found = std::find_if(spec.arguments.begin(), spec.arguments.end(),
                                    [&, name = key](const Argument& a) { return a.name == name; });
    if (found == spec.arguments.end())
      throw Error("scene " + name + ", argument " + key, "an argument of " + base.name, "an unknown one");
    found->value = number;
  }
  return spec;
}

Spec testedInFull(Spec spec) {
  spec.testArguments = {};
  spec.testSteps = 0;
  return spec;
}

Scale scaleOf(const Arguments& arguments) {
  const double length = value(arguments, "length_scale");
  return {length, value(arguments, "density"), std::sqrt(length)};
}

Scene emptyScene(const Vec3& up, double gravity) {
  Scene scene;
  scene.gravity = -gravity * up;
  return scene;
}

BodyDef ground(const Vec3& up, double height, double friction) {
  // The shortest turn of local z to `up`.
  const double c = dot(kUpZ, up);
  const Quat turn = c < -.999999 ? Quat{0, 1, 0, 0} : normalize(Quat{1 + c, cross(kUpZ, up)});
  BodyDef body;
  body.name = "ground";
  body.motion = Motion::Static;
  body.shape = Shape::plane();
  body.material = {friction, friction, 0};
  body.position = height * up;
  body.orientation = turn;
  return body;
}

BodyDef block(const Vec3& halfExtents, const Vec3& position, double density) {
  BodyDef body;
  body.shape = Shape::box(halfExtents);
  body.density = density;
  body.position = position;
  return body;
}

void shuffleBodies(Scene& scene, std::size_t first) {
  // std::shuffle differs between standard libraries
  std::mt19937 random;
  for (std::size_t k = scene.bodies.size(); k > first + 1; --k)
    std::swap(scene.bodies[k - 1], scene.bodies[first + random() % (k - first)]);
}

void setFriction(Scene& scene, double friction) {
  for (BodyDef& body : scene.bodies) body.material = {friction, friction, body.material.restitution};
}

JointDef ballJoint(int a, const Vec3& anchorA, int b, const Vec3& anchorB, const std::string& name) {
  JointDef joint;
  joint.name = name;
  joint.type = JointType::Ball;
  joint.bodyA = a;
  joint.bodyB = b;
  joint.anchorA = anchorA;
  joint.anchorB = anchorB;
  return joint;
}

void addAt(Scene& scene, int step, std::vector<BodyDef> bodies) {
  Event event;
  event.step = step;
  event.add = std::move(bodies);
  scene.events.push_back(std::move(event));
}

Vec3 upOf(const Scene& scene) { return normalize(-scene.gravity, kUpZ); }

Claim within(const std::string& metric, double min, double max, const std::string& why) {
  return {metric, min, max, why};
}
Claim atMost(const std::string& metric, double max, const std::string& why) {
  return {metric, -kNoBound, max, why};
}
Claim atLeast(const std::string& metric, double min, const std::string& why) {
  return {metric, min, kNoBound, why};
}

std::vector<Claim> standsClaims(double drop, const std::string& why) {
  return {within("top_drop_m", -drop, drop, why), atMost("bricks_lost", 0, "every brick stays"),
          atMost("quarantined", 0, "every state stays finite")};
}

std::vector<Claim> smashClaims(double lengthScale) {
  return {atLeast("smash_moved_ratio", .01, "the ball opens the stack"),
          atLeast("smash_lowest_m", -.1 * lengthScale, "no brick is below the ground")};
}

std::vector<Claim> operator+(std::vector<Claim> a, const std::vector<Claim>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

namespace {

/// Of a sphere about the shape's origin that holds it [m].
double radiusOf(const Shape& shape) {
  const CookedShape cooked = cook(shape);
  return cooked.radius + length(cooked.unit.center);
}

struct Bounds {
  Vec3 low{kNoBound, kNoBound, kNoBound}, high{-kNoBound, -kNoBound, -kNoBound};

  void add(const BodyDef& body) {
    // Half spaces and slabs are left out: with them all else would be too small in the picture.
    if (body.shape.type == ShapeType::Plane) return;
    const double r = radiusOf(body.shape);
    if (body.motion == Motion::Static && r > 20) return;
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], body.position[i] - r);
      high[i] = std::max(high[i], body.position[i] + r);
    }
  }
};

}  // namespace

Camera overview(const Arguments&, const Scene& scene) {
  Bounds bounds;
  for (const BodyDef& body : scene.bodies) bounds.add(body);
  for (const Event& event : scene.events)
    for (const BodyDef& body : event.add) bounds.add(body);
  if (!(bounds.low.x <= bounds.high.x)) return {{4, -6, 4}, {}};
  const Vec3 up = upOf(scene);
  // Right-handed: front is towards the viewer.
  const Vec3 front = std::fabs(up.z) > .5 ? Vec3{0, -1, 0} : Vec3{0, 0, 1};
  const Vec3 right = cross(up, front);
  const Vec3 center = .5 * (bounds.low + bounds.high);
  const double radius = .5 * length(bounds.high - bounds.low);
  // A sphere of that radius fills a view of 40 degrees at 2.9 radii.
  const Vec3 direction = normalize(.62 * right + .75 * front + .42 * up);
  return {center + 2.4 * radius * direction, center};
}

}  // namespace rubble::scenes

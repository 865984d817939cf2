#include "tests/locality/visitors.h"

#include <algorithm>
#include <cmath>

#include "tests/support/scenes.h"

namespace rubble::test {
namespace {

/// Unit vectors whose last one is against gravity.
struct Frame {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, up{0, 0, 1};
};
Frame frameOf(const Scene& scene) {
  Frame f;
  const double g = length(scene.gravity);
  if (!(g > 0)) return f;
  f.up = scene.gravity / -g;
  f.x = normalize(cross(std::fabs(f.up.x) < .5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, f.up));
  f.y = cross(f.up, f.x);
  return f;
}

/// Turns z to up.
Quat uprightIn(const Scene& scene) {
  return frameAlong(frameOf(scene).up) * fromAxisAngle(Vec3{0, 1, 0}, std::acos(0.));
}

/// A thick slab whose top lies at a point.
void addSlab(Scene& scene, const Vec3& top, double half) {
  const Frame f = frameOf(scene);
  BodyDef slab = body(Shape::box({half, half, half}), top - f.up * half);
  slab.motion = Motion::Static;
  slab.orientation = uprightIn(scene);
  scene.bodies.push_back(slab);
}

int addAt(Scene& scene, BodyDef def, const Vec3& at, double x, double y, double up) {
  const Frame f = frameOf(scene);
  def.position = at + f.x * x + f.y * y + f.up * up;
  scene.bodies.push_back(def);
  return static_cast<int>(scene.bodies.size()) - 1;
}

/// One body over a slab.
void addBody(Scene& scene, const Vec3& at, const BodyDef& def) {
  addSlab(scene, at, 2);
  addAt(scene, def, at, 0, 0, .6);
}

void addPebbles(Scene& scene, const Vec3& at, int count, double height) {
  addSlab(scene, at, 2);
  for (int i = 0; i < count; ++i)
    addAt(scene, body(Shape::sphere(.01), {}), at, .025 * (i % 60 - 30), .025 * (i / 60 - 25), .01 + height);
}

/// A heap of pebbles in random order, more than all other objects.
void addDust(Scene& scene, const Vec3& at, int count) {
  addSlab(scene, at, 2);
  for (int i = 0; i < count; ++i) {
    const int k = i * 2017 % count;
    addAt(scene, body(Shape::sphere(.01), {}), at, .025 * (k % 70 - 35), .025 * (k / 70 - 35), .012);
  }
}

/// Named materials with a rule, on a one-way slab: one box slides, one comes from below.
void addRuled(Scene& scene, const Vec3& at) {
  const Frame f = frameOf(scene);
  addSlab(scene, at, 2);
  Material& slab = scene.bodies.back().material;
  slab.name = "visited", slab.oneWay = {0, 0, 1};
  BodyDef box = body(Shape::box({0.2, 0.2, 0.1}), {});
  box.material.name = "visitor", box.material.rollingFriction = 0.01;
  box.velocity = f.x * 2;
  addAt(scene, box, at, 0, 0, 0.2);
  box.velocity = f.up * 40;
  addAt(scene, box, at, 1, 0, -4.5);
  scene.materialPairs.push_back({"visited", "visitor", 0.1, 0.05, 0.5, 0.02});
}

/// A hanging chain of capsules, whose joints are of a type.
void addChain(Scene& scene, const Vec3& at, int links, JointType type) {
  const Frame f = frameOf(scene);
  int last = kWorld;
  for (int i = 0; i < links; ++i) {
    BodyDef link = body(Shape::capsule(.02, .05), {});
    link.orientation = uprightIn(scene);
    const int own = addAt(scene, link, at, 0, 0, -.1 * i);
    JointDef joint = jointAt(scene, type, own, last, at + f.up * (.05 - .1 * i));
    if (type == JointType::Hinge) joint.axes[0].min = -.2, joint.axes[0].max = .3;
    scene.joints.push_back(joint);
    last = own;
  }
  scene.bodies.back().velocity = f.x * 2;
}

void addDeformable(Scene& scene, const Vec3& at, Deformable object) {
  addSlab(scene, at, 2);
  const Frame f = frameOf(scene);
  for (Vec3& v : common(object).vertices) v = at + f.x * v.x + f.y * v.y + f.up * v.z;
  scene.deformables.push_back(std::move(object));
}

ParticlesDef particle() {
  ParticlesDef out;
  out.vertices = {{0, 0, .3}};
  return out;
}

BodyDef heavyBlock() {
  BodyDef def = body(Shape::box({.5, .5, .5}), {});
  def.density = 1e6;
  return def;
}

BodyDef roller() {
  BodyDef def = body(Shape::sphere(.2), {});
  def.material.rollingFriction = def.material.torsionalFriction = .01;
  def.velocity = {1, 0, 0};
  return def;
}

BodyDef bouncer() {
  BodyDef def = body(Shape::sphere(.2), {});
  def.material.restitution = .8;
  return def;
}

BodyDef locked() {
  BodyDef def = body(Shape::box({.2, .1, .3}), {});
  def.lockTranslation[0] = def.lockRotation[1] = true;
  return def;
}

BodyDef sensor() {
  BodyDef def = body(Shape::box({.3, .3, .3}), {});
  def.sensor = true;
  return def;
}

BodyDef filtered() {
  BodyDef def = body(Shape::box({.2, .2, .2}), {});
  def.filter.layers = 2;
  def.filter.group = -3;
  return def;
}

BodyDef conveyor() {
  BodyDef def = body(Shape::box({.2, .2, .2}), {});
  def.material.surfaceVelocity = {.5, 0, 0};
  return def;
}

BodyDef movingMesh() {
  BodyDef def = body(Shape::mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, .1}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}),
                     {});
  def.motion = Motion::Kinematic;
  def.velocity = {.3, 0, 0};
  return def;
}

Visitor oneBody(const char* name, BodyDef (*make)()) {
  return {name, [make](Scene& scene, const Vec3& at) { addBody(scene, at, make()); }};
}
Visitor oneShape(const char* name, Shape (*make)()) {
  return {name, [make](Scene& scene, const Vec3& at) { addBody(scene, at, body(make(), {})); }};
}

}  // namespace

std::vector<Visitor> visitors(int pebbles) {
  return {
      {"grain", [](Scene& s, const Vec3& at) { addDeformable(s, at, particle()); }},
      {"cloth",
       [](Scene& s, const Vec3& at) {
         addDeformable(s, at, clothSheet({-.5, -.5, .3}, {1, 0, 0}, {0, 1, 0}, 5, 5));
       }},
      {"rope",
       [](Scene& s, const Vec3& at) {
         addDeformable(s, at, straightCable({-.5, 0, .3}, {.5, 0, .3}, 10));
       }},
      {"soft ball",
       [](Scene& s, const Vec3& at) {
         addDeformable(s, at, tetBall({0, 0, .5}, .3, 3));
       }},
      {"pebbles at rest", [=](Scene& s, const Vec3& at) { addPebbles(s, at, pebbles, 0); }},
      {"pebbles that fall", [=](Scene& s, const Vec3& at) { addPebbles(s, at, pebbles, .5); }},
      {"dust in no order", [=](Scene& s, const Vec3& at) { addDust(s, at, pebbles); }},
      {"pair rule and one-way surface", addRuled},
      {"joint with limits", [](Scene& s, const Vec3& at) { addChain(s, at, 2, JointType::Hinge); }},
      {"tree of 65", [](Scene& s, const Vec3& at) { addChain(s, at, 65, JointType::Ball); }},
      {"tree of 1,000", [](Scene& s, const Vec3& at) { addChain(s, at, 1000, JointType::Ball); }},
      oneBody("heavy block", heavyBlock),
      oneBody("roller", roller),
      oneBody("bouncer", bouncer),
      oneBody("locked", locked),
      oneBody("sensor", sensor),
      oneBody("filtered", filtered),
      oneBody("belt", conveyor),
      oneBody("moving mesh", movingMesh),
      oneShape("cone", [] { return Shape::cone(.2, .2); }),
      oneShape("hull",
               [] {
                 return Shape::hull({{0, 0, 0}, {.3, 0, 0}, {0, .3, 0}, {0, 0, .3}});
               }),
  };
}

Vec3 farFrom(const Scene& scene) {
  constexpr double kFar = 700, kReach = 20;  // [m]
  const Frame f = frameOf(scene);
  // planes are everywhere: visitors must be on the outer side of each, the nearest and the furthest alike
  const auto isClear = [&](const Vec3& at) {
    return std::none_of(scene.bodies.begin(), scene.bodies.end(), [&](const BodyDef& b) {
      if (b.shape.type != ShapeType::Plane) return false;
      const Vec3 outward = rotate(b.orientation, Vec3{0, 0, 1});
      return dot(outward, at - b.position) < kReach || dot(outward, 4 * at - b.position) < kReach;
    });
  };
  for (const double x : {0., .1, -.1, .5, -.5})
    for (const double y : {0., .1, -.1, .5, -.5})
      if (const Vec3 at = kFar * normalize(f.up + x * f.x + y * f.y); isClear(at)) return at;
  return {};
}

Scene withVisitorsFirst(const Scene& scene, const std::vector<Visitor>& visitors) {
  const Vec3 far = farFrom(scene);
  if (far == Vec3{}) return scene;
  Scene out;
  out.gravity = scene.gravity;
  for (std::size_t k = 0; k < visitors.size(); ++k)
    visitors[k].addTo(out, far * (1 + .1 * static_cast<double>(k)));
  const auto shift = static_cast<int>(out.bodies.size());
  const auto moved = [shift](int body) { return body == kWorld ? kWorld : body + shift; };
  for (const BodyDef& body : scene.bodies) out.bodies.push_back(body);
  for (JointDef joint : scene.joints) {
    for (int* body : {&joint.bodyA, &joint.bodyB, &joint.frameBodyA, &joint.frameBodyB}) *body = moved(*body);
    out.joints.push_back(joint);
  }
  for (const auto& [a, b] : scene.exclusions) out.exclusions.push_back({moved(a), moved(b)});
  return out;
}

}  // namespace rubble::test

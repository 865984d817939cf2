/// The same scene in other units of length, mass and time. The only scales are gravity, the step and the
/// bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/expect.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// Lengths, masses and gravity times these; times follow as sqrt(length / gravity).
struct Scale {
  double length = 1, mass = 1, gravity = 1;
  double time() const { return std::sqrt(length / gravity); }
  double speed() const { return length / time(); }
};

void scaleJoint(JointDef& joint, const Scale& k) {
  joint.anchorA *= k.length, joint.anchorB *= k.length;
  if (joint.length > 0) joint.length *= k.length;
}

void scaleDeformable(Deformable& deformable, const Scale& k) {
  DeformableDef& d = common(deformable);
  for (Vec3& v : d.vertices) v *= k.length;
  d.velocity *= k.speed();
  const double volume = k.length * k.length * k.length, pressure = k.mass * k.gravity / (k.length * k.length);
  if (auto* soft = std::get_if<TetSolidDef>(&deformable)) {
    soft->density *= k.mass / volume, soft->youngsModulus *= pressure;
    soft->contactRadius *= k.length;
  }
  if (auto* cloth = std::get_if<ClothDef>(&deformable)) {
    cloth->density *= k.mass / volume, cloth->youngsModulus *= pressure;
    cloth->thickness *= k.length;
  }
}

Scene scaled(Scene scene, const Scale& k) {
  scene.gravity *= k.gravity;
  for (BodyDef& def : scene.bodies) {
    def.position *= k.length, def.velocity *= k.speed(), def.angularVelocity *= 1 / k.time();
    Shape& s = def.shape;
    s.halfExtents *= k.length, s.radius *= k.length, s.halfLength *= k.length;
    def.density *= k.mass / (k.length * k.length * k.length);
    if (def.mass) *def.mass *= k.mass;
  }
  for (JointDef& joint : scene.joints) scaleJoint(joint, k);
  for (Deformable& d : scene.deformables) scaleDeformable(d, k);
  return scene;
}

struct Sample {
  const char* name;
  std::function<Scene()> scene;
  int steps;
};

/// Positions over lengths and velocities over speeds, after the steps of a sample. Rates of relaxation are
/// parameters per second: they go with time.
std::vector<Vec3> outcome(const Sample& sample, const Scale& k, const std::string& backend = "cpu") {
  WorldOptions o = test::options(6, backend);
  o.params.dt = k.time() / 64;
  Tuning& t = o.params.tuning;
  t.errorRetention = .95, t.driftCorrection /= k.time(), t.sleepDelay *= k.time();
  t.warmStartDecay = std::pow(t.warmStartDecay, 1 / k.time());
  o.params.sleeping = true;
  const Scene scene = scaled(sample.scene(), k);
  World world(scene, o);
  test::run(world, sample.steps);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodyState s = world.state(world.bodyAt(static_cast<int>(i)));
    out.push_back(s.position / k.length), out.push_back(s.velocity / k.speed());
  }
  for (std::size_t i = 0; i < scene.deformables.size(); ++i) {
    Vec3 sum{0, 0, 0};
    const std::vector<Vec3> places = world.positions(world.deformableAt(static_cast<int>(i)));
    for (const Vec3& p : places) sum += p;
    out.push_back(sum / (k.length * static_cast<double>(places.size())));
  }
  return out;
}

/// Largest difference of two outcomes.
double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, length(a[i] - b[i]));
  return out;
}

Scene dominoes() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 12; ++i)
    scene.bodies.push_back(test::body(Shape::box({.0625, .25, .5}), {.5 * i, 0, .5}));
  scene.bodies[1].angularVelocity = {0, 2, 0}, scene.bodies[1].velocity = {1, 0, 0};
  return scene;
}

Scene smashedPile() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int z = 0; z < 5; ++z)
    for (int x = 0; x < 5; ++x)
      scene.bodies.push_back(test::body(Shape::box({.5, .25, .125}), {x + .5 * (z % 2), 0, .125 + .25 * z}));
  scene.bodies.push_back(test::body(Shape::sphere(.5), {2.5, -4, .75}));
  scene.bodies.back().velocity = {0, 12, 1};
  return scene;
}

Scene bouncing() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 3; ++i) {
    scene.bodies.push_back(
        test::body(i == 1 ? Shape::box({.5, .25, .25}) : Shape::sphere(.25), {2. * i, 0, 2}));
    scene.bodies.back().material.restitution = .5 + .25 * i;
  }
  return scene;
}

Scene chain() {
  Scene scene = test::emptyScene();
  for (int i = 0; i < 8; ++i) {
    scene.bodies.push_back(test::body(Shape::box({.25, .0625, .0625}), {.5 * i + .25, 0, 0}));
    scene.joints.push_back(test::ball(i, {-.25, 0, 0}, i - 1, i == 0 ? Vec3{} : Vec3{.25, 0, 0}));
  }
  return scene;
}

Scene pendulumWithLimits() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::body(Shape::box({.5, .125, .125}), {.5, 0, 0}));
  JointDef hinge = jointAt(scene, JointType::Hinge, 0, kWorld, {0, 0, 0}, frameAlong({0, 1, 0}));
  hinge.axes[0].min = -1, hinge.axes[0].max = 1;
  scene.joints.push_back(hinge);
  return scene;
}

Scene slide() {
  Scene scene = test::emptyScene({4, 0, -8});
  scene.bodies.push_back(test::ground(.4));
  scene.bodies.push_back(test::body(Shape::box({.5, .5, .25}), {0, 0, .25}, .4));
  scene.bodies.push_back(test::body(Shape::box({.5, .5, .25}), {0, 4, .25}, .6));
  return scene;
}

Scene bulletAtPlate() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::body(Shape::box({.0625, 1, 1}), {0, 0, 1}));
  scene.bodies.push_back(test::body(Shape::sphere(.0625), {-2.03, .1, 1.3}));
  scene.bodies.back().velocity = {120, 0, 0};
  return scene;
}

Scene ragdoll() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  scene.bodies.push_back(test::body(Shape::box({.25, .125, .375}), {0, 0, 2}));
  const auto limb = [&](double x, double z, double length, int to, const Vec3& at) {
    const int own = static_cast<int>(scene.bodies.size());
    BodyDef def = test::body(Shape::capsule(.0625, length / 2), {x, 0, z});
    scene.bodies.push_back(def);
    JointDef joint = jointAt(scene, JointType::SwingTwist, own, to, at);
    joint.swingY = joint.swingZ = .6;
    joint.axes[1].min = -.3, joint.axes[1].max = .3;
    scene.joints.push_back(joint);
    return own;
  };
  for (const double side : {-1., 1.}) {
    const int thigh = limb(side * .15, 1.35, .3, 1, {side * .15, 0, 1.6});
    limb(side * .15, .85, .3, thigh, {side * .15, 0, 1.1});
    limb(side * .4, 2.1, .3, 1, {side * .3, 0, 2.3});
  }
  scene.bodies[1].angularVelocity = {1, .5, 0};
  return scene;
}

const Sample kSamples[] = {{"tower", [] { return test::tower(8); }, 200},
                           {"dominoes", dominoes, 200},
                           {"smashed pile", smashedPile, 200},
                           {"bounce", bouncing, 200},
                           {"chain", chain, 200},
                           {"pendulum with limits", pendulumWithLimits, 200},
                           {"slide", slide, 100},
                           {"bullet", bulletAtPlate, 100},
                           {"ragdoll", ragdoll, 150}};

/// Powers of four scale every number of a step exactly, so that motions that would part by chaos agree too.
TEST(Similarity, OfLengthsHoldsOverSixOrders) {
  for (const Sample& sample : kSamples) {
    const std::vector<Vec3> one = outcome(sample, {});
    for (const double k : {1. / 1024, 1024.})
      EXPECT_LT(difference(outcome(sample, {k, k * k * k, 1}), one), .01)
          << sample.name << " at length " << k;
  }
}

TEST(Similarity, OfMassesHolds) {
  for (const Sample& sample : kSamples)
    EXPECT_LT(difference(outcome(sample, {1, 1024, 1}), outcome(sample, {})), .01) << sample.name;
}

TEST(Similarity, OfTimesHolds) {
  for (const Sample& sample : kSamples)
    EXPECT_LT(difference(outcome(sample, {1, 1, 64}), outcome(sample, {})), .01) << sample.name;
}

}  // namespace
}  // namespace rubble

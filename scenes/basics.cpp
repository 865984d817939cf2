/// One or two bodies with closed forms.
#include <cmath>
#include <numbers>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "motion_probes.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfCube{.5, .5, .5};

BodyDef named(const std::string& name, BodyDef body) {
  body.name = name;
  return body;
}

// Flight.

Scene buildFall(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(named("cube", block(kHalfCube, {0, 0, value(arguments, "height")}, 1000)));
  return scene;
}

Scene buildProjectile(const Arguments& arguments) {
  const double angle = value(arguments, "angle") * std::numbers::pi / 180;
  Scene scene = emptyScene(kUpZ, 9.81);
  BodyDef cube = named("cube", block(kHalfCube, {0, 0, .5}, 1000));
  cube.velocity = value(arguments, "speed") * Vec3{portable::cos(angle), 0, portable::sin(angle)};
  cube.angularVelocity = {0, 3, 0};
  scene.bodies.push_back(cube);
  return scene;
}

Probes flightProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(ballisticProbe(scene, "cube"));
  return probes;
}

std::vector<Claim> flightClaims(const Arguments&) {
  return {atMost("position_error_ratio", 1e-4, "implicit Euler in closed form, to rounding")};
}

// Rest and rebound.

Scene buildDrop(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, .5));
  scene.bodies.push_back(named("cube", block(kHalfCube, {0, 0, 4}, 1)));
  setFriction(scene, .5);
  return scene;
}

Probes dropProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(stackProbe(scene, kNoBound));
  return probes;
}

std::vector<Claim> dropClaims(const Arguments&) {
  return {within("top_drop_m", 2.998, 3.002, "it rests on the ground, within 2 mm"),
          atMost("max_speed_m_s", 1e-3, "and is still")};
}

constexpr double kBounceRadius = .5;

Scene buildBounce(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef sphere;
  sphere.name = "sphere";
  sphere.shape = Shape::sphere(kBounceRadius);
  sphere.position = {0, 0, kBounceRadius + value(arguments, "height")};
  sphere.material.restitution = value(arguments, "restitution");
  scene.bodies.push_back(sphere);
  return scene;
}

Probes bounceProbes(const Arguments& arguments, const Scene& scene) {
  Probes probes;
  probes.push_back(reboundProbe(scene, "sphere", kBounceRadius, value(arguments, "height")));
  return probes;
}

std::vector<Claim> bounceClaims(const Arguments& arguments) {
  const double e = value(arguments, "restitution");
  return {within("restitution_found", e - .05, e + .05,
                 "the rebound is as high as the restitution says, within 0.05")};
}

// Pendulum: a rod that hangs by its end.

constexpr Vec3 kHalfRod{.1, .5, .1};

/// T = 2 pi sqrt(I / (m g d)) with I about the pivot [s].
double rodPeriod(double gravity) {
  const double d = kHalfRod.y;
  const double inertia = (kHalfRod.x * kHalfRod.x + kHalfRod.y * kHalfRod.y) / 3 + d * d;  // over the mass
  return 2 * std::numbers::pi * std::sqrt(inertia / (gravity * d));
}

Scene buildPendulum(const Arguments& arguments) {
  const double angle = value(arguments, "angle") * std::numbers::pi / 180;
  Scene scene = emptyScene(kUpY, 9.81);
  BodyDef rod = named(
      "rod",
      block(kHalfRod, {kHalfRod.y * portable::sin(angle), -kHalfRod.y * portable::cos(angle), 0}, 1000));
  rod.orientation = fromAxisAngle(Vec3{0, 0, 1}, angle);
  scene.bodies.push_back(rod);
  scene.joints.push_back(ballJoint(kWorld, {}, 0, {0, kHalfRod.y, 0}, "pivot"));
  return scene;
}

Probes pendulumProbes(const Arguments&, const Scene& scene) {
  Probes probes;
  probes.push_back(periodProbe("rod", rodPeriod(length(scene.gravity))));
  return probes;
}

std::vector<Claim> pendulumClaims(const Arguments&) {
  return {within("period_error", -.01, .01, "2 pi sqrt(I / (m g d)), within 1 %"),
          atMost("joint_gap_max_m", 1e-3, "the pivot stays")};
}

// Free spin about the middle axis of inertia.

Scene buildSpin(const Arguments& arguments) {
  const double speed = value(arguments, "speed");
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef body = named("body", block({.5, .3, .1}, {}, 1000));
  body.angularVelocity = {.01 * speed, speed, .01 * speed};
  scene.bodies.push_back(body);
  return scene;
}

Probes spinProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(spinProbe("body", {0, 1, 0}));
  return probes;
}

std::vector<Claim> spinClaims(const Arguments&) {
  return {atMost("momentum_error", 1e-3, "angular momentum stays"),
          atLeast("energy_ratio", .99, "energy stays within 1 %"),
          atMost("energy_ratio_max", 1.001, "and is not gained"),
          atLeast("flips", 1, "the middle axis is unstable: the body turns over")};
}

// Free motion of a body with three moments of inertia: the spin in its own frame is periodic.

constexpr Vec3 kFreeHalf{.5, .3, .1};

Scene buildFree(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef body = named("body", block(kFreeHalf, {}, 1000));
  body.angularVelocity = value(arguments, "speed") * Vec3{.36, .48, .8};
  scene.bodies.push_back(body);
  return scene;
}

/// 4 K(m) / p, from Euler's equations for a spin w about the principal axes, with moments in rising order
/// [s].
double freePeriod(Vec3 moments, const Vec3& w) {
  double energy2 = 0, momentum2 = 0;
  for (int k = 0; k < 3; ++k)
    energy2 += moments[k] * w[k] * w[k], momentum2 += moments[k] * moments[k] * w[k] * w[k];
  // about the axis of the least moment it goes as about that of the largest
  if (momentum2 < energy2 * moments.y) std::swap(moments.x, moments.z);
  const double a = (moments.z - moments.y) * (momentum2 - energy2 * moments.x),
               b = (moments.y - moments.x) * (energy2 * moments.z - momentum2);
  const double p = std::sqrt(a / (moments.x * moments.y * moments.z)), m = b / a;
  double x = 1, y = std::sqrt(1 - m);
  for (int k = 0; k < 40; ++k) {
    const double mean = (x + y) / 2;
    y = std::sqrt(x * y), x = mean;
  }
  return 2 * std::numbers::pi / (x * p);
}

/// period_error: of the spin about the middle axis, from the first to the last time at which it passes zero.
class FreePeriodProbe final : public Probe {
 public:
  void start(const World& world) override {
    const MassProperties mass = world.massOf(world.findBody("body"));
    exact_ = freePeriod(mass.inertia, spinOf(world));
    middle_ = spinOf(world).y;
  }
  void afterStep(const World& world, const StepReport&) override {
    const double middle = spinOf(world).y, dt = world.params().dt;
    if ((middle > 0) != (middle_ > 0)) {
      last_ = world.time() - dt * middle / (middle - middle_);
      if (passages_++ == 0) first_ = last_;
    }
    middle_ = middle;
  }
  void finish(const World&, Metrics& metrics) override {
    if (passages_ > 2) metrics["period_error"] = 2 * (last_ - first_) / (passages_ - 1) / exact_ - 1;
  }

 private:
  static Vec3 spinOf(const World& world) {
    const BodyId id = world.findBody("body");
    const BodyState s = world.state(id);
    return rotateInverse(s.orientation * world.massOf(id).axes, s.angularVelocity);
  }

  double exact_ = 0, middle_ = 0, first_ = 0, last_ = 0;
  int passages_ = 0;
};

// Impact.

Scene buildImpact(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef a = named("a", block(kHalfCube, {-1.5, 0, 0}, 1000));
  a.velocity = {value(arguments, "speed"), 0, 0};
  scene.bodies.push_back(a);
  scene.bodies.push_back(named("b", block(kHalfCube, {.5, 0, 0}, 1000 * value(arguments, "ratio"))));
  return scene;
}

Probes impactProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(impactProbe("a", "b"));
  return probes;
}

std::vector<Claim> impactClaims(const Arguments&) {
  return {atMost("momentum_error", 1e-3, "momentum stays"),
          within("closing_speed_ratio", -.05, .05, "they neither bounce nor go on closing")};
}

}  // namespace

std::vector<Spec> basicSpecs() {
  Spec fall;
  fall.name = "free-fall";
  fall.doc = "A cube falls for 2 s.";
  fall.arguments = {quantity("height", 25, 0, 1000, "m", "of the start")};
  fall.build = buildFall;
  fall.probes = flightProbes;
  fall.claims = flightClaims;
  fall.camera = overview;
  fall.steps = 120;
  fall.iterations = 4;
  fall.tags = {"basic"};

  Spec projectile = fall;
  projectile.name = "projectile";
  projectile.doc = "A cube is thrown and tumbles on its way.";
  projectile.arguments = {quantity("speed", 15, 1, 100, "m/s", "at the start"),
                          quantity("angle", 45, 0, 90, "deg", "over the horizon")};
  projectile.build = buildProjectile;

  Spec drop = fall;
  drop.name = "drop";
  drop.doc = "A cube falls on the ground and rests (after avbd-demo3d).";
  drop.arguments = {};
  drop.build = buildDrop;
  drop.probes = dropProbes;
  drop.claims = dropClaims;
  drop.steps = 300;

  Spec bounce = fall;
  bounce.name = "bounce";
  bounce.doc = "A sphere falls and rebounds.";
  bounce.arguments = {quantity("restitution", .5, .2, 1, "1", "of the sphere"),
                      quantity("height", 2, .5, 20, "m", "of the drop")};
  bounce.build = buildBounce;
  bounce.probes = bounceProbes;
  bounce.claims = bounceClaims;
  bounce.steps = 180;
  bounce.iterations = 10;

  Spec pendulum = fall;
  pendulum.name = "pendulum";
  pendulum.doc = "A rod on a ball joint swings.";
  pendulum.arguments = {quantity("angle", 5, 1, 10, "deg", "at the start, from the vertical")};
  pendulum.build = buildPendulum;
  pendulum.probes = pendulumProbes;
  pendulum.claims = pendulumClaims;
  pendulum.steps = 420;
  pendulum.iterations = 10;
  pendulum.tags = {"basic", "joint"};

  Spec spin = fall;
  spin.name = "spinning-body";
  spin.doc = "A free body spins about its middle axis of inertia and turns over again and again.";
  spin.arguments = {quantity("speed", 5, 1, 20, "rad/s", "of the spin")};
  spin.build = buildSpin;
  spin.probes = spinProbes;
  spin.claims = spinClaims;
  spin.steps = 600;

  Spec free = fall;
  free.name = "free-body";
  free.doc = "A free body with three moments of inertia: its spin has the period of Euler's equations.";
  free.arguments = {quantity("speed", 5, 1, 20, "rad/s", "of the spin")};
  free.build = buildFree;
  free.probes = [](const Arguments&, const Scene&) {
    Probes probes;
    probes.push_back(std::make_unique<FreePeriodProbe>());
    return probes;
  };
  free.claims = [](const Arguments&) {
    return std::vector<Claim>{within("period_error", -.01, .01, "the closed form, within 1 %")};
  };
  free.steps = 600;

  Spec impact = fall;
  impact.name = "impact";
  impact.doc = "A cube runs into another at rest, without gravity and without rebound.";
  impact.arguments = {quantity("speed", 2, .1, 10, "m/s", "of the first cube"),
                      quantity("ratio", 2, .01, 100, "1", "mass of the second cube over the first")};
  impact.build = buildImpact;
  impact.probes = impactProbes;
  impact.claims = impactClaims;
  impact.steps = 120;
  impact.iterations = 20;

  return {fall, projectile, drop, bounce, pendulum, spin, free, impact};
}

}  // namespace rubble::scenes

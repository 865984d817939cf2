/// Optional properties of bodies: damping, locked axes, layers, sensors, sleep.
#include <algorithm>
#include <cmath>

#include "build.h"
#include "families.h"
#include "math/portable.h"
#include "probe_parts.h"
#include "probes.h"

namespace rubble::scenes {
namespace {

constexpr Vec3 kHalfCube{.5, .5, .5};

// Damping.

Scene buildDamping(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 0);
  BodyDef body = block(kHalfCube, {}, 1000);
  body.name = "cube";
  body.velocity = {4, 0, 0}, body.angularVelocity = {0, 0, 3};
  body.linearDamping = value(arguments, "linear"), body.angularDamping = value(arguments, "angular");
  scene.bodies.push_back(body);
  return scene;
}

class DampingProbe final : public BodyProbe {
 public:
  explicit DampingProbe(const BodyDef& def) : BodyProbe(def.name), def_(def) {}
  void afterStep(const World& world, const StepReport&) override {
    const BodyState now = state(world);
    const double v = portable::exp(-def_.linearDamping * world.time()),
                 w = portable::exp(-def_.angularDamping * world.time());
    error_ = std::max(
        {error_, length(now.velocity - v * def_.velocity) / length(def_.velocity),
         length(now.angularVelocity - w * def_.angularVelocity) / length(def_.angularVelocity)});
  }
  void finish(const World&, Metrics& metrics) override { metrics["damping_error"] = error_; }

 private:
  BodyDef def_;
  double error_ = 0;
};

// Planar scenes: y translation and rotations about x and z are locked.

Scene buildPlanar(const Arguments& arguments) {
  constexpr Vec3 kHalfBrick{.5, .5, .25};
  const int rows = whole(arguments, "rows");
  Scene scene = emptyScene(kUpZ, 10);
  scene.bodies.push_back(ground(kUpZ, 0, .5));
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < rows - row; ++k) {
      BodyDef brick = block(kHalfBrick, {1.1 * k + .55 * row, 0, .25 + .5 * row}, 1000);
      brick.lockTranslation = {false, true, false};
      brick.lockRotation = {true, false, true};
      // motion that the locks must prevent
      brick.angularVelocity = {.5, 0, .5};
      scene.bodies.push_back(brick);
    }
  setFriction(scene, .5);
  return scene;
}

class PlaneProbe final : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      const BodyState s = world.state(id);
      out_ = std::max(
          {out_, std::fabs(s.position.y), std::fabs(s.orientation.v.x), std::fabs(s.orientation.v.z)});
    }
  }
  void finish(const World&, Metrics& metrics) override { metrics["out_of_plane"] = out_; }

 private:
  double out_ = 0;
};

// Layers: three shelves, one above the other, each for cubes of its own layer.

Scene buildLayers(const Arguments&) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  scene.bodies[0].filter.layers = 0xffffffffu;
  for (int layer = 0; layer < 3; ++layer) {
    BodyDef shelf = block({4, 1, .1}, {0, 0, 2 + 2.0 * layer}, 1000);
    shelf.motion = Motion::Static;
    shelf.filter = {1u << layer, 1u << layer, 0};
    scene.bodies.push_back(shelf);
  }
  for (int layer = 0; layer < 4; ++layer) {
    BodyDef cube = block(kHalfCube, {-3 + 2.0 * layer, 0, 8}, 1000);
    cube.name = "cube" + std::to_string(layer);
    cube.filter = {1u << layer, 0xffffffffu, 0};
    scene.bodies.push_back(cube);
  }
  return scene;
}

class LayersProbe final : public Probe {
 public:
  void finish(const World& world, Metrics& metrics) override {
    double error = 0;
    for (int layer = 0; layer < 4; ++layer) {
      const double rest = layer < 3 ? 2 + 2.0 * layer + .1 + .5 : .5;
      error = std::max(
          error, std::fabs(world.state(world.findBody("cube" + std::to_string(layer))).position.z - rest));
    }
    metrics["rest_error_m"] = error;
  }
};

// Sensor: balls fall through a gate that counts them.

Scene buildGate(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef gate = block({3, 3, .5}, {0, 0, 3}, 1000);
  gate.name = "gate";
  gate.motion = Motion::Static;
  gate.sensor = true;
  scene.bodies.push_back(gate);
  for (int i = 0; i < whole(arguments, "balls"); ++i) {
    BodyDef ball;
    ball.shape = Shape::sphere(.2);
    ball.position = {-2.0 + i % 5, -1.0 + i / 5 % 3, 5 + .7 * i};
    scene.bodies.push_back(ball);
  }
  return scene;
}

class GateProbe final : public Probe {
 public:
  explicit GateProbe(int balls) : balls_(balls) {}
  void afterStep(const World& world, const StepReport&) override {
    const BodyId gate = world.findBody("gate");
    for (const ContactEvent& e : world.events().contacts) {
      if (!e.sensor || (e.a != gate && e.b != gate)) continue;
      in_ += e.phase == Phase::Begin, out_ += e.phase == Phase::End;
      push_ = std::max(push_, length(e.impulse));
    }
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["in_ratio"] = in_ / double(balls_);
    metrics["out_ratio"] = out_ / double(balls_);
    metrics["push_n_s"] = push_;
  }

 private:
  int balls_, in_ = 0, out_ = 0;
  double push_ = 0;
};

// Sleep: a wall of bricks comes to rest, sleeps, is hit and sleeps again; a second one is left alone.

constexpr double kBricks = 2 * 24;

Scene buildSleepers(const Arguments&) {
  constexpr Vec3 kHalfBrick{.5, .25, .25};
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  for (const double y : {0.0, 12.0})
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 6; ++k)
        scene.bodies.push_back(block(kHalfBrick, {1.02 * k + (row % 2 ? .3 : 0), y, .25 + .5 * row}, 1000));
  BodyDef ball;
  ball.name = "ball";
  ball.shape = Shape::sphere(.4);
  ball.position = {2.5, -4, 1.5};
  ball.velocity = {0, 12, 1};
  addAt(scene, 150, {ball});
  return scene;
}

class SleepProbe final : public Probe {
 public:
  void afterStep(const World& world, const StepReport& report) override {
    if (world.stepCount() == 149) before_ = report.sleepingBodies;
    if (world.time() > 2.6) least_ = std::min(least_, report.sleepingBodies);
    last_ = report.sleepingBodies;
  }
  void finish(const World&, Metrics& metrics) override {
    metrics["asleep_before_ratio"] = before_ / kBricks;
    metrics["asleep_least_ratio"] = least_ / kBricks;
    metrics["asleep_end_ratio"] = last_ / kBricks;
  }

 private:
  int before_ = 0, least_ = 1 << 30, last_ = 0;
};

Spec basic(const std::string& name, const std::string& doc, int steps) {
  Spec spec;
  spec.name = name;
  spec.doc = doc;
  spec.camera = overview;
  spec.steps = steps;
  spec.tags = {"body"};
  return spec;
}

template <class P, class... A> Probes one(A&&... arguments) {
  Probes probes;
  probes.push_back(std::make_unique<P>(std::forward<A>(arguments)...));
  return probes;
}

}  // namespace

std::vector<Spec> bodySpecs() {
  Spec damping = basic("damping", "A free cube flies and spins through a medium.", 120);
  damping.arguments = {quantity("linear", .5, 0, 100, "1/s", "damping of the velocity"),
                       quantity("angular", 2, 0, 100, "1/s", "of the spin")};
  damping.build = buildDamping;
  damping.probes = [](const Arguments&, const Scene& scene) { return one<DampingProbe>(scene.bodies[0]); };
  damping.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("damping_error", 1e-4, "exp(-c t), at any time step")};
  };

  Spec planar = basic("planar-pyramid",
                      "A pyramid of bricks that can move in a plane only (after avbd-demo2d).", 300);
  planar.arguments = {count("rows", 12, 1, 100, "rows of bricks")};
  planar.build = buildPlanar;
  planar.probes = [](const Arguments&, const Scene& scene) {
    Probes probes = one<PlaneProbe>();
    probes.push_back(stackProbe(scene, kNoBound));
    return probes;
  };
  planar.claims = [](const Arguments&) {
    return standsClaims(.02, "the pyramid stands") +
           std::vector<Claim>{atMost("out_of_plane", 0, "no brick leaves the plane or turns out of it")};
  };
  planar.testArguments = {{"rows", 8}};

  Spec layers = basic("layers", "Cubes fall through shelves until one of their own layer.", 180);
  layers.build = buildLayers;
  layers.probes = [](const Arguments&, const Scene&) { return one<LayersProbe>(); };
  layers.claims = [](const Arguments&) {
    return std::vector<Claim>{atMost("rest_error_m", 3e-3, "each rests where its layer is")};
  };

  Spec gate = basic("sensor-gate", "Balls fall through a sensor.", 240);
  gate.arguments = {count("balls", 12, 1, 15, "balls")};
  gate.build = buildGate;
  gate.probes = [](const Arguments& arguments, const Scene&) {
    return one<GateProbe>(whole(arguments, "balls"));
  };
  gate.claims = [](const Arguments&) {
    return std::vector<Claim>{within("in_ratio", 1, 1, "each comes in once"),
                              within("out_ratio", 1, 1, "and goes out once"),
                              atMost("push_n_s", 0, "and is not pushed")};
  };
  gate.events = true;

  Spec sleepers = basic("sleepers", "Two walls fall asleep; one is hit by a ball, and they sleep again.",
                        700);
  sleepers.build = buildSleepers;
  sleepers.probes = [](const Arguments&, const Scene&) { return one<SleepProbe>(); };
  sleepers.claims = [](const Arguments&) {
    return std::vector<Claim>{within("asleep_before_ratio", 1, 1, "both walls sleep before the ball comes"),
                              within("asleep_least_ratio", .5, .5, "the ball wakes one of them"),
                              atLeast("asleep_end_ratio", 1, "all sleep at the end")};
  };
  sleepers.sleeping = true;
  return {damping, planar, layers, gate, sleepers};
}

}  // namespace rubble::scenes

/// Scenes of shapes in motion: a marble run, a tumbler, conveyors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "families.h"
#include "math/portable.h"
#include "probes.h"
#include "shape_parts.h"

namespace rubble::scenes {
namespace {

constexpr double kPi = std::numbers::pi;

// A gutter winds down into a basin.

constexpr double kCoil = 2, kGutter = .3, kTurns = 2, kDrop = 1.6;  // radii, turns, and fall of a turn [m]

/// Middle line of the gutter at t in [0, 1].
Vec3 onCoil(double t) {
  const double angle = 2 * kPi * kTurns * t;
  return {kCoil * portable::cos(angle), kCoil * portable::sin(angle), 1.2 + kDrop * kTurns * (1 - t)};
}

Shape gutter(int along, int across) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= along; ++i) {
    const double t = double(i) / along;
    const Vec3 middle = onCoil(t);
    const Vec3 outward = normalize(Vec3{middle.x, middle.y, 0});
    for (int k = 0; k <= across; ++k) {
      // from the inner rim down and up to the outer one
      const double a = kPi * k / across;
      points.push_back(middle + outward * (-kGutter * portable::cos(a)) +
                       Vec3{0, 0, -kGutter * portable::sin(a)});
    }
  }
  for (int i = 0; i < along; ++i)
    for (int k = 0; k < across; ++k) {
      const int a = i * (across + 1) + k, b = a + across + 1;
      // seen from within the gutter
      triangles.push_back({a, a + 1, b + 1});
      triangles.push_back({a, b + 1, b});
    }
  return Shape::mesh(std::move(points), std::move(triangles), true);
}

Scene buildMarbles(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  BodyDef run;
  run.name = "gutter";
  run.motion = Motion::Static;
  run.shape = gutter(600, 16);
  scene.bodies.push_back(run);
  const int count = whole(arguments, "marbles");
  for (int i = 0; i < count; ++i) {
    BodyDef marble;
    marble.name = "marble" + std::to_string(i);
    marble.shape = Shape::sphere(.09);
    marble.density = 2500;
    const double t = .01 + .016 * i;
    marble.position = onCoil(t) - Vec3{0, 0, kGutter - .1};
    scene.bodies.push_back(marble);
  }
  return scene;
}

/// Marbles that have left the gutter at its end and not over its rim.
class ArrivalProbe : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      const Vec3 p = world.state(id).position;
      // within reach of the gutter's middle line all the way down to its end
      const double r = portable::hypot(p.x, p.y), angle = portable::atan2(p.y, p.x);
      double nearest = 1e30;
      for (int turn = 0; turn <= int(kTurns); ++turn) {
        const double t = (angle + 2 * kPi * turn) / (2 * kPi * kTurns);
        if (t < -.02 || t > 1.02) continue;
        nearest = std::min(nearest, portable::hypot(r - kCoil, p.z - onCoil(t).z));
      }
      if (nearest > 1.2 * kGutter && p.z > .9 + kGutter) lost_ = true;
      if (std::size_t(id.index) >= low_.size()) low_.resize(std::size_t(id.index) + 1);
      low_[std::size_t(id.index)] = p.z < .5;
    }
  }
  void finish(const World& world, Metrics& metrics) override {
    int marbles = 0, down = 0;
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      ++marbles;
      down += std::size_t(id.index) < low_.size() && low_[std::size_t(id.index)];
    }
    metrics["arrived_ratio"] = marbles > 0 ? double(down) / marbles : 0;
    metrics["left_gutter"] = lost_;
  }

 private:
  std::vector<bool> low_;
  bool lost_ = false;
};

Probes marbleProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(std::make_unique<ArrivalProbe>());
  return probes;
}

std::vector<Claim> marbleClaims(const Arguments&) {
  return {within("arrived_ratio", 1, 1, "every marble comes down"),
          within("left_gutter", 0, 0, "none over the rim"),
          atMost("quarantined", 0, "every state stays finite")};
}

// A drum that turns, with things in it.

constexpr int kStaves = 12;
constexpr double kDrum = 2, kDrumDepth = 1.2;

Scene buildTumbler(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  std::vector<ShapePartDef> parts;
  const double half = kDrum * portable::tan(kPi / kStaves);
  for (int i = 0; i < kStaves; ++i) {
    const double angle = 2 * kPi * i / kStaves;
    const Quat q = fromAxisAngle(Vec3{0, 1, 0}, angle);
    parts.push_back({Shape::box({.15, kDrumDepth, half + .1}), rotate(q, Vec3{kDrum + .15, 0, 0}), q});
    // every third stave carries a blade
    if (i % 3 == 0)
      parts.push_back({Shape::box({.25, kDrumDepth, .06}), rotate(q, Vec3{kDrum - .25, 0, 0}), q});
  }
  for (const double side : {-1.0, 1.0})
    parts.push_back({Shape::box({kDrum + .3, .1, kDrum + .3}), {0, side * (kDrumDepth + .1), 0}, {}});
  BodyDef drum;
  drum.name = "drum";
  drum.motion = Motion::Kinematic;
  drum.shape = Shape::compound(std::move(parts));
  drum.position = {0, 0, 3};
  drum.angularVelocity = {0, value(arguments, "speed"), 0};
  scene.bodies.push_back(drum);
  const int count = whole(arguments, "things");
  for (int i = 0; i < count; ++i) {
    BodyDef body;
    body.shape = mixedShape(.16, i);
    body.position = {.42 * (i % 5 - 2), .42 * (i / 5 % 5 - 2), 2.2 + .42 * (i / 25)};
    scene.bodies.push_back(body);
  }
  return scene;
}

Probes tumblerProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(insideProbe({-2.1, -1.2, .9}, {2.1, 1.2, 5.1}));
  return probes;
}

std::vector<Claim> tumblerClaims(const Arguments&) {
  return {within("inside_ratio", 1, 1, "nothing leaves the drum"),
          atMost("penetration_p99_m", .03, "nothing is crushed"),
          atMost("quarantined", 0, "every state stays finite")};
}

// Three belts: the second takes over from the first, a centimetre lower, and the third carries to the side.

constexpr double kBeltHalf = 2.5, kBeltSpeed = 1.5;

Scene buildConveyor(const Arguments& arguments) {
  Scene scene = emptyScene(kUpZ, 9.81);
  scene.bodies.push_back(ground(kUpZ));
  const auto belt = [&](const std::string& name, const Vec3& position, const Vec3& half, const Vec3& speed) {
    BodyDef body;
    body.name = name;
    body.motion = Motion::Static;
    body.shape = Shape::box(half);
    body.position = position;
    body.material.surfaceVelocity = speed;
    scene.bodies.push_back(body);
  };
  const double speed = kBeltSpeed;
  belt("belt0", {0, 0, 1}, {kBeltHalf, .6, .1}, {speed, 0, 0});
  belt("belt1", {2 * kBeltHalf, 0, .99}, {kBeltHalf, .6, .1}, {speed, 0, 0});
  belt("belt2", {3 * kBeltHalf + .6, 0, .8}, {.6, 4, .1}, {0, speed, 0});
  const int count = whole(arguments, "parcels");
  for (int i = 0; i < count; ++i) {
    BodyDef parcel;
    parcel.name = "parcel" + std::to_string(i);
    parcel.shape = i % 3 == 0   ? Shape::box({.2, .25, .15})
                   : i % 3 == 1 ? Shape::cylinder(.2, .15)
                                : Shape::hull(prismCorners(6, .22, .15));
    parcel.density = 200;
    parcel.position = {-kBeltHalf + .4 + .8 * i, .1 * (i % 3 - 1), 1.25};
    scene.bodies.push_back(parcel);
  }
  return scene;
}

/// belt_speed_m_s: mean speed along x of the parcels that lie on the first two belts, 1.5 s after the start;
/// delivered_ratio: share of the parcels that have come to the third belt at the end, or left it in its
/// direction.
class ParcelProbe : public Probe {
 public:
  void afterStep(const World& world, const StepReport&) override {
    if (done_ || world.time() < 1.5) return;
    done_ = true;
    int count = 0;
    for (const BodyId id : world.bodies()) {
      const BodyState s = world.state(id);
      if (world.definition(id).motion != Motion::Dynamic || s.position.x > 3 * kBeltHalf - .3) continue;
      sum_ += s.velocity.x;
      ++count;
    }
    if (count > 0) sum_ /= count;
  }
  void finish(const World& world, Metrics& metrics) override {
    int all = 0, delivered = 0;
    for (const BodyId id : world.bodies()) {
      if (world.definition(id).motion != Motion::Dynamic) continue;
      ++all;
      delivered += world.state(id).position.y > 1;
    }
    if (done_) metrics["belt_speed_m_s"] = sum_;
    metrics["delivered_ratio"] = all > 0 ? double(delivered) / all : 0;
  }

 private:
  bool done_ = false;
  double sum_ = 0;
};

Probes conveyorProbes(const Arguments&, const Scene&) {
  Probes probes;
  probes.push_back(std::make_unique<ParcelProbe>());
  return probes;
}

std::vector<Claim> conveyorClaims(const Arguments&) {
  return {within("belt_speed_m_s", kBeltSpeed - .02, kBeltSpeed + .02, "parcels move with the belt"),
          within("delivered_ratio", 1, 1, "all come to the third belt and go along with it"),
          atMost("quarantined", 0, "every state stays finite")};
}

}  // namespace

std::vector<Spec> shapeMotionSpecs() {
  Spec marbles;
  marbles.name = "marble-run";
  marbles.doc = "Marbles run down a winding gutter of triangles.";
  marbles.arguments = {count("marbles", 12, 1, 30, "marbles that start one behind the other")};
  marbles.build = buildMarbles;
  marbles.probes = marbleProbes;
  marbles.claims = marbleClaims;
  marbles.camera = overview;
  marbles.steps = 720;
  marbles.iterations = 4;
  marbles.tags = {"shape", "friction"};

  Spec tumbler = marbles;
  tumbler.name = "tumbler";
  tumbler.doc = "A drum with blades turns and tumbles shapes of every kind.";
  tumbler.arguments = {count("things", 150, 1, 400, "bodies in the drum"),
                       quantity("speed", 1, .1, 4, "rad/s", "of the drum")};
  tumbler.build = buildTumbler;
  tumbler.probes = tumblerProbes;
  tumbler.claims = tumblerClaims;
  tumbler.steps = 600;
  tumbler.testArguments = {{"things", 50}};
  tumbler.testSteps = 240;
  tumbler.tags = {"shape"};

  Spec conveyor = marbles;
  conveyor.name = "conveyor";
  conveyor.doc = "Belts carry parcels along, over a joint and round a corner.";
  conveyor.arguments = {count("parcels", 6, 1, 6, "parcels on the first belt")};
  conveyor.build = buildConveyor;
  conveyor.probes = conveyorProbes;
  conveyor.claims = conveyorClaims;
  conveyor.steps = 600;
  conveyor.tags = {"shape", "friction"};
  return {marbles, tumbler, conveyor};
}

}  // namespace rubble::scenes

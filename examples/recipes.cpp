// Short answers to "how do I ...?". Each function is one page of docs/howto.
#include <rubble/mesh.h>
#include <rubble/rubble.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>

using namespace rubble;

namespace {

BodyDef bodyOf(const Shape& shape, const Vec3& position, Motion motion = Motion::Dynamic) {
  BodyDef body;
  body.shape = shape;
  body.position = position;
  body.motion = motion;
  return body;
}

// howto/triggers.md
int ballsThroughGate() {
  enum Kind : std::uint64_t { kGate = 1, kBall };
  Scene scene;
  scene.bodies.push_back(bodyOf(Shape::plane(), {}, Motion::Static));
  BodyDef gate = bodyOf(Shape::box({0.5, 2, 1}), {0, 0, 1}, Motion::Static);
  gate.sensor = true;  // reports, and pushes nothing
  gate.userData = kGate;
  scene.bodies.push_back(gate);
  for (int i = 0; i < 5; ++i) {
    BodyDef ball = bodyOf(Shape::sphere(0.2), {-3.0 - i, 0.5 * i - 1, 0.3});
    ball.velocity = {4, 0, 0};
    ball.userData = kBall;
    scene.bodies.push_back(ball);
  }
  WorldOptions options;
  options.events = true;
  World world(scene, options);
  int entered = 0;
  for (int step = 0; step < 180; ++step) {
    world.step();
    for (const ContactEvent& event : world.events().contacts)
      entered += event.sensor && event.phase == Phase::Begin;
  }
  return entered;
}

// howto/interpolation.md
/// Plays a world at a fixed time step under frames of any length, and gives poses between two steps.
class Interpolated {
 public:
  Interpolated(World& world, BodyId body)
      : world_(world), body_(body), before_(world.state(body)), after_(before_) {}

  /// Takes the steps that `seconds` of the frame make necessary.
  BodyState frame(double seconds) {
    const double dt = world_.params().dt;
    ahead_ += std::min(seconds, 0.25);  // after a long pause the game goes on, it does not catch up
    for (; ahead_ >= dt; ahead_ -= dt) {
      world_.step();
      before_ = after_;
      after_ = world_.state(body_);
    }
    const double share = ahead_ / dt;
    BodyState shown = after_;
    shown.position = before_.position + (after_.position - before_.position) * share;
    const Quat a = before_.orientation, b = after_.orientation;
    const double sign = a.s * b.s + dot(a.v, b.v) < 0 ? -1 : 1;  // q and -q are one rotation
    shown.orientation = normalize(Quat{a.s + (sign * b.s - a.s) * share, a.v + (b.v * sign - a.v) * share});
    return shown;
  }

 private:
  World& world_;
  BodyId body_;
  BodyState before_, after_;
  double ahead_ = 0;  // time that no step has used yet [s]
};

// howto/ragdoll.md
/// A body, a head and an arm: the head on a cone, the elbow on a hinge.
Scene figure() {
  Scene scene;
  scene.bodies = {
      bodyOf(Shape::plane(), {}, Motion::Static), bodyOf(Shape::box({0.12, 0.18, 0.3}, 0.05), {0, 0, 1.3}),
      bodyOf(Shape::sphere(0.12), {0, 0, 1.75}), bodyOf(Shape::capsule(0.05, 0.12), {0, 0.28, 1.4}),
      bodyOf(Shape::capsule(0.04, 0.12), {0, 0.28, 1.05})};
  const Quat alongZ = frameAlong({0, 0, 1}), alongY = frameAlong({0, 1, 0});
  SwingTwistJoint neck{.bodyA = 2, .bodyB = 1};
  neck.swingY = neck.swingZ = 0.6;       // half angles of the cone [rad]
  neck.axes[1] = {.min = -1, .max = 1};  // twist [rad]
  neck.friction = 1;                     // stiff muscles [N m]
  const SwingTwistJoint shoulder{.bodyA = 3, .bodyB = 1, .swingY = 1.4, .swingZ = 1.4};
  const HingeJoint elbow{.bodyA = 4, .bodyB = 3, .axis = {.min = -2.4, .max = 0.05}};
  scene.joints = {jointAt(scene, neck, {0, 0, 1.62}, alongZ),
                  jointAt(scene, shoulder, {0, 0.22, 1.55}, alongZ),
                  jointAt(scene, elbow, {0, 0.28, 1.22}, alongY)};
  return scene;
}

// howto/threads.md
/// Four worlds in four threads. Each world uses one thread, so that they do not wait for one another.
std::vector<std::uint64_t> fourWorlds() {
  std::vector<std::future<std::uint64_t>> running;
  for (int i = 0; i < 4; ++i)
    running.push_back(std::async(std::launch::async, [] {
      WorldOptions options;
      options.threads = 1;
      World world(figure(), options);
      for (int step = 0; step < 60; ++step) world.step();
      return world.hash();
    }));
  std::vector<std::uint64_t> hashes;
  for (auto& world : running) hashes.push_back(world.get());
  return hashes;
}

// howto/meshes.md
/// A bowl as a mesh, a gem as a hull, a table as a compound.
Scene shapesFromPoints() {
  std::vector<Vec3> rim;
  std::vector<std::array<int, 3>> triangles;
  constexpr int kRings = 8, kAround = 24;
  for (int ring = 0; ring <= kRings; ++ring)
    for (int k = 0; k < kAround; ++k) {
      const double r = 1.5 * ring / kRings, angle = 2 * 3.14159265 * k / kAround;
      rim.push_back({r * std::cos(angle), r * std::sin(angle), 0.5 * r * r});
      const int at = ring * kAround + k, next = ring * kAround + (k + 1) % kAround;
      if (ring == 0) continue;
      triangles.push_back({at, next, next - kAround});  // counter-clockwise, seen from above
      if (ring > 1) triangles.push_back({at, next - kAround, at - kAround});
    }
  Scene scene;
  scene.bodies.push_back(bodyOf(Shape::mesh(rim, triangles), {}, Motion::Static));
  const std::vector<Vec3> gem{{0.2, 0, 0},  {-0.2, 0, 0}, {0, 0.2, 0},
                              {0, -0.2, 0}, {0, 0, 0.3},  {0, 0, -0.3}};
  scene.bodies.push_back(bodyOf(Shape::hull(gem), {0.5, 0, 1.5}));
  std::vector<ShapePartDef> parts(3);
  parts[0].shape = Shape::box({0.3, 0.2, 0.02}), parts[0].position = {0, 0, 0.2};
  parts[1].shape = parts[2].shape = Shape::box({0.02, 0.02, 0.1});
  parts[1].position = {-0.25, 0, 0.1}, parts[2].position = {0.25, 0, 0.1};
  const Shape table = Shape::compound(parts);
  scene.bodies.push_back(bodyOf(table, {-0.3, 0.2, 1.5}));
  return scene;
}

// shapes.md
/// Rocks of one shape: it is cooked once, and freed with the last of them.
bool rocksShareTheirShape(World& world, const std::vector<Vec3>& points) {
  Shape rock = Shape::hull(points);
  rock.userData = 7;                        // of the caller: hits and contact events return it
  const ShapeId id = world.addShape(rock);  // cooked now, and kept while no body has it
  std::vector<BodyId> rocks;
  for (int k = 0; k < 10; ++k) rocks.push_back(world.addBody(bodyOf(world.definition(id), {2.0 * k, 0, 9})));
  world.removeShape(id);  // from here on it ends with the last body that has it
  const bool shared = world.shapeOf(rocks.front()) == id && world.useCount(id) == 10;
  world.removeBodies(rocks);
  return shared && !world.alive(id);
}

}  // namespace

int main() {
  const int entered = ballsThroughGate();
  std::printf("%d balls went through the gate\n", entered);

  Scene drop;
  drop.bodies.push_back(bodyOf(Shape::sphere(0.5), {0, 0, 10}));
  World dropped(drop);
  Interpolated ball(dropped, dropped.bodyAt(0));
  double last = 10, largest = 0, smallest = 1;
  for (int frame = 0; frame < 144; ++frame) {  // one second at 144 Hz
    const double height = ball.frame(1.0 / 144).position.z, fall = last - height;
    if (frame > 72) largest = std::max(largest, fall), smallest = std::min(smallest, fall);
    last = height;
  }
  std::printf("between two pictures it falls %.3f to %.3f m\n", smallest, largest);

  World doll(figure());
  double bent = 0;
  for (int step = 0; step < 180; ++step) {
    doll.step();
    bent = std::max(bent, doll.state(doll.joints()[2]).axes[0].position);
  }
  std::printf("the elbow bends backward by at most %.2f rad\n", bent);

  const std::vector<std::uint64_t> hashes = fourWorlds();
  const bool equal = std::ranges::all_of(hashes, [&](std::uint64_t hash) { return hash == hashes[0]; });
  std::printf("four worlds in four threads: %s\n", equal ? "the same bits" : "different bits");

  World bowl(shapesFromPoints());
  for (int step = 0; step < 240; ++step) bowl.step();
  const double low = std::min(bowl.state(bowl.bodyAt(1)).position.z, bowl.state(bowl.bodyAt(2)).position.z);
  std::printf("gem and table rest in the bowl, %.1f m above its lowest point\n", low);
  const bool shared = rocksShareTheirShape(bowl, {{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}});
  std::printf("rocks share their shape: %s\n", shared ? "yes" : "no");
  return shared && entered == 5 && smallest > 0.03 && largest < 0.09 && bent < 0.15 && equal && low > 0 ? 0
                                                                                                        : 1;
}

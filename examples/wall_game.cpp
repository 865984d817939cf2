// A game: a player walks to a wall, throws balls at it until it breaks, and leaves through the hole.
#include <rubble/rubble.h>

#include <cstdio>

namespace {

using namespace rubble;

// What a body is, in its user data.
enum Kind : std::uint64_t { kGround = 1, kBrick, kPlayer, kBall, kExit };

BodyDef bodyOf(Kind kind, const Shape& shape, const Vec3& position) {
  BodyDef body;
  body.shape = shape;
  body.position = position;
  body.userData = kind;
  return body;
}

Scene level() {
  Scene scene;
  scene.bodies.push_back(bodyOf(kGround, Shape::plane(), {}));
  scene.bodies[0].motion = Motion::Static;
  // a wall of 8 x 6 bricks across the way; neighbors are glued until a force of 400 N parts them
  constexpr int kWide = 8, kHigh = 6;
  const auto brickAt = [](int column, int row) { return 1 + column + kWide * row; };
  for (int row = 0; row < kHigh; ++row)
    for (int column = 0; column < kWide; ++column)
      scene.bodies.push_back(
          bodyOf(kBrick, Shape::box({0.15, 0.25, 0.15}), {8, 0.5 * column - 1.75, 0.15 + 0.3 * row}));
  for (int row = 0; row < kHigh; ++row)
    for (int column = 0; column < kWide; ++column) {
      const auto glue = [&](int other, const Vec3& half) {
        const Vec3 between = scene.bodies[std::size_t(brickAt(column, row))].position + half;
        const FixedJoint joint{
            .bodyA = brickAt(column, row), .bodyB = other, .breakForce = 400, .collide = true};
        scene.joints.push_back(jointAt(scene, joint, between));
      };
      if (column + 1 < kWide) glue(brickAt(column + 1, row), {0, 0.25, 0});
      if (row + 1 < kHigh) glue(brickAt(column, row + 1), {0, 0, 0.15});
    }
  // the exit behind the wall reports who is in it
  BodyDef exit = bodyOf(kExit, Shape::box({0.5, 3, 1}), {11, 0, 1});
  exit.motion = Motion::Static;
  exit.sensor = true;
  scene.bodies.push_back(exit);
  BodyDef player = bodyOf(kPlayer, Shape::capsule(0.3, 0.5), {0, 0, 0.8});
  player.name = "player";
  player.mass = 80;
  player.lockRotation = {true, true, true};
  scene.bodies.push_back(player);
  return scene;
}

}  // namespace

int main() {
  WorldOptions options;
  options.events = true;
  options.params.iterations = 6;
  World world(level(), options);
  const BodyId player = world.findBody("player");
  int score = 0, throws = 0;
  bool out = false;
  for (int step = 0; step < 1200 && !out; ++step) {
    // the player: walk to the wall, throw once per second while it stands, then walk on
    const BodyState state = world.state(player);
    const RayHit ahead = world.castRay({state.position + Vec3{0.5, 0, 0.2}, {1, 0, 0}, 4, {}});
    const bool blocked = ahead.hit && ahead.userData == kBrick;
    const double speed = state.position.x < 4 || !blocked ? 3 : 0;
    world.setVelocity(player, {speed, -state.position.y, state.velocity.z}, {});
    if (speed == 0 && step % 60 == 0) {
      BodyDef ball = bodyOf(kBall, Shape::sphere(0.15), state.position + Vec3{0.6, 0, 0.3});
      ball.mass = 12;
      ball.velocity = {18, 0.3 * (throws % 3 - 1), 1};
      world.addBody(ball);
      ++throws;
    }
    world.step();

    // what happened
    for (const JointEvent& broken : world.events().joints) score += broken.force == Vec3{} ? 0 : 10;
    for (const ContactEvent& contact : world.events().contacts) {
      const bool isExit = contact.userDataA == kExit || contact.userDataB == kExit;
      const bool isPlayer = contact.userDataA == kPlayer || contact.userDataB == kPlayer;
      out |= contact.sensor && contact.phase == Phase::Begin && isExit && isPlayer;
    }
  }
  std::printf("%s after %.1f s, %d throws, score %d\n", out ? "out" : "caught", world.time(), throws, score);
  return out && score > 0 ? 0 : 1;
}

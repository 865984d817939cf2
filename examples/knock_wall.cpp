// Knocks a wall over. The argument is the part of the tutorial to stop at, 1 to 6.
#include <rubble/rubble.h>

#include <cstdio>
#include <cstdlib>

using namespace rubble;

namespace {

// 1. A wall of ten levels of bricks.
Scene wall() {
  Scene scene;
  for (int level = 0; level < 10; ++level)
    for (int column = 0; column < 10; ++column) {
      BodyDef brick;  // 1000 kg/m3, friction 0.6
      brick.shape = Shape::box({0.25, 0.125, 0.125});
      brick.position = {0.5 * column + 0.25 * (level % 2), 0, 0.125 + 0.25 * level};
      scene.bodies.push_back(brick);
    }
  return scene;
}

// 2. A floor.
BodyDef floorPlane() {
  BodyDef body;
  body.motion = Motion::Static;
  body.shape = Shape::plane();
  return body;
}

// 3. A ball that flies at the wall.
BodyDef cannonBall() {
  BodyDef body;
  body.shape = Shape::sphere(0.4);
  body.density = 3000;
  body.position = {2.5, -3, 1.2};
  body.velocity = {0, 15, 2};
  return body;
}

// 4. How many bricks have left their place?
int fallen(const World& world, const Scene& scene) {
  int count = 0;
  for (int brick = 0; brick < 100; ++brick) {
    const Vec3 start = scene.bodies[std::size_t(brick)].position;
    count += length(world.state(world.bodyAt(brick)).position - start) > 0.1;
  }
  return count;
}

// 5. Mortar: neighbors in a level are glued, until a force of 2000 N parts them.
void addMortar(Scene& scene) {
  for (int brick = 0; brick < 99; ++brick) {
    if (brick % 10 == 9) continue;
    const Vec3 between = scene.bodies[std::size_t(brick)].position + Vec3{0.25, 0, 0};
    const FixedJoint glue{.bodyA = brick, .bodyB = brick + 1, .breakForce = 2000};
    scene.joints.push_back(jointAt(scene, glue, between));
  }
}

}  // namespace

int main(int count, char** arguments) {
  const int part = count > 1 ? std::atoi(arguments[1]) : 6;
  Scene scene = wall();
  if (part >= 2) scene.bodies.push_back(floorPlane());
  if (part >= 5) addMortar(scene);
  WorldOptions options;
  options.params.iterations = 4;
  World world(scene, options);
  int broken = 0;
  for (int step = 0; step < 240; ++step) {
    if (part >= 3 && step == 60) world.addBody(cannonBall());
    // 6. Without gravity the pieces fly on.
    if (part >= 6 && step == 60) world.setGravity({});
    broken += world.step().brokenJoints;
  }
  std::printf("part %d: the first brick is at %.1f m", part, world.state(world.bodyAt(0)).position.z);
  if (part >= 4) std::printf(", %d of 100 bricks have left their place", fallen(world, scene));
  if (part >= 5) std::printf(", %d joints broke", broken);
  std::printf("\n");
  return 0;
}

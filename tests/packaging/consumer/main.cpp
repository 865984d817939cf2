#include <rubble/rubble.h>
#include <cstdio>

int main() {
  rubble::Scene scene;
  rubble::BodyDef ground;
  ground.motion = rubble::Motion::Static;
  ground.shape = rubble::Shape::plane();
  scene.bodies.push_back(ground);
  for (int level = 0; level < 10; ++level) {
    rubble::BodyDef brick;  // 1000 kg/m3 and friction 0.6, unless said otherwise
    brick.shape = rubble::Shape::box({0.5, 0.25, 0.25});
    brick.position = {0.2 * (level % 2), 0, 0.25 + 0.5 * level};
    scene.bodies.push_back(brick);
  }

  rubble::World world(scene);
  for (int step = 0; step < 120; ++step) world.step();
  std::printf("the top brick rests at %.2f m\n", world.state(world.bodyAt(10)).position.z);
}

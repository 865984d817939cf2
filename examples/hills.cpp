// A car with springs, motors and steering drives over the hills of a height field.
#include <rubble/rubble.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace {

using namespace rubble;

constexpr int kSamples = 81;
constexpr double kSpacing = 1.5;

double heightAt(double x, double y) { return 0.8 * std::sin(x / 7) * std::cos(y / 9); }

Scene landscape() {
  Scene scene;
  std::vector<double> heights;
  const double half = kSpacing * (kSamples - 1) / 2;
  for (int j = 0; j < kSamples; ++j)
    for (int i = 0; i < kSamples; ++i) heights.push_back(heightAt(i * kSpacing - half, j * kSpacing - half));
  BodyDef land;
  land.motion = Motion::Static;
  land.shape = Shape::heightField(kSamples, kSamples, {kSpacing, kSpacing, 0}, heights);
  land.position = {-half, -half, 0};
  land.material.staticFriction = land.material.dynamicFriction = 1;
  scene.bodies.push_back(land);

  BodyDef chassis;
  chassis.name = "chassis";
  chassis.shape = Shape::box({1.6, 0.7, 0.25});
  chassis.mass = 800;
  chassis.position = {-40, 0, heightAt(-40, 0) + 1.2};
  scene.bodies.push_back(chassis);
  for (int k = 0; k < 4; ++k) {
    const bool front = k < 2;
    const Vec3 hub = chassis.position + Vec3{front ? 1.2 : -1.2, k % 2 ? 0.95 : -0.95, -0.45};
    BodyDef wheel;
    wheel.shape = Shape::sphere(0.35);
    wheel.mass = 20;
    wheel.position = hub;
    wheel.material = land.material;
    const int body = int(scene.bodies.size());
    scene.bodies.push_back(wheel);
    // six axes: x and y translation locked, z a spring; rotation about y free (the axle), about z the
    // steering
    const JointAxis locked{.min = 0, .max = 0};
    const JointAxis spring{.min = -0.15, .max = 0.15, .driveStiffness = 20000, .driveDamping = 2500};
    const JointAxis motor{.driveDamping = kHard, .maxDriveForce = front ? 0. : 400.};
    const SixDofJoint joint{.name = "wheel" + std::to_string(k),
                            .bodyA = body,
                            .bodyB = 1,
                            .axes = {locked, locked, spring, locked, motor, locked}};
    scene.joints.push_back(jointAt(scene, joint, hub));
  }
  return scene;
}

}  // namespace

int main() {
  World world(landscape());
  const BodyId chassis = world.findBody("chassis");
  for (const char* wheel : {"wheel2", "wheel3"})
    world.setTargetSpeed(world.findJoint(wheel), 4, 14);  // rad/s
  double lowest = 1;
  for (int step = 0; step < 600; ++step) {
    world.step();
    // upright: the z axis of the chassis against gravity
    lowest = std::min(lowest, rotate(world.state(chassis).orientation, Vec3{0, 0, 1}).z);
  }
  const BodyState state = world.state(chassis);
  std::printf("drove %.0f m, never tilted by more than %.0f degrees\n", state.position.x + 40,
              std::acos(lowest) * 57.2958);
  return state.position.x > -10 && lowest > 0.7 ? 0 : 1;
}

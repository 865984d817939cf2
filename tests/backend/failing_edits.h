#pragma once
/// Worlds with a bit of everything, and calls of them whose allocations fail.
#include <functional>

#include "tests/backend/failing_calls.h"
#include "tests/support/scenes.h"

namespace rubble::test {

/// A bit of everything, with a joint that breaks in the first steps.
inline Scene sceneOfAll() {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  for (int i = 0; i < 5; ++i) scene.bodies.push_back(unitCube({0, 1.2 * i, .5}));
  scene.bodies[1].name = "first";
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.bodies.push_back(body(Shape::hull(corners), {3, 0, .2}));
  scene.bodies.back().material.rollingFriction = .1;
  scene.bodies.push_back(body(Shape::sphere(.3), {4, 0, 2}));
  scene.joints.push_back(ball(1, {0, .6, 0}, 2, {0, -.6, 0}));
  scene.joints.back().collide = false;
  scene.joints.back().name = "link";
  scene.joints.push_back(ball(kWorld, {4, 0, 2.5}, 7, {0, 0, .5}));
  scene.joints.back().breakForce = 1;
  scene.exclusions.emplace_back(3, 4);
  ClothDef cloth = clothSheet({5, 0, 1}, {1, 0, 0}, {0, 1, 0}, 2, 2);
  cloth.name = "cloth";
  scene.deformables.emplace_back(cloth);
  AttachmentDef attachment;
  attachment.vertices = {0};
  attachment.body = 3;
  scene.attachments.push_back(attachment);
  return scene;
}

inline WorldOptions optionsOfAll() {
  WorldOptions own = options(2);
  own.events = true;
  own.params.sleeping = true;
  return own;
}

/// A call. What it is given is made once, while memory does not fail.
struct FailingCall {
  const char* name;
  std::function<void(World&)> take;
};

inline BodyDef marble(const char* name) {
  BodyDef def = body(Shape::cone(.2, .3), {-3, 0, 1});
  def.name = name;
  def.material.torsionalFriction = .2;
  return def;
}
inline BodyDef oddBody() {
  std::vector<ShapePartDef> parts(2);
  parts[0].shape = Shape::sphere(.2);
  parts[1].shape = Shape::box({.2, .1, .1});
  parts[1].position = {.3, 0, 0};
  parts[1].material.emplace();
  return body(Shape::compound(parts), {-2, 0, 3});
}
inline Deformable cableNamed(const char* name) {
  CableDef cable = straightCable({6, 0, 2}, {7, 0, 2}, 4);
  cable.name = name;
  return cable;
}
inline AttachmentDef attachmentOf(int vertex) {
  AttachmentDef out;
  out.vertices = {vertex};
  return out;
}
inline JointId firstJoint(const World& world) { return world.findJoint("link"); }
inline BodyId bodyOf(const World& world, int k) { return world.bodyAt(k); }

/// Worlds of the scene after some steps, with or without a snapshot that shares their definitions.
class Started {
 public:
  explicit Started(Scene scene = sceneOfAll()) : scene_(std::move(scene)) {}
  World world() const {
    World world(scene_, optionsOfAll());
    world.addShape(held_);
    run(world, 2);
    return world;
  }

 private:
  Scene scene_;
  Shape held_ = Shape::hull({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
};

/// Each call fails at each of its allocations, and leaves a world as it was.
inline void expectUndisturbed(const std::vector<FailingCall>& calls, bool lasting,
                              const Started& started = Started()) {
  for (const FailingCall& call : calls) {
    World reference = started.world();
    const std::uint64_t before = reference.hash();
    call.take(reference);
    const std::uint64_t after = reference.hash();
    run(reference, 3);
    forEachAllocation(call.name, [&](long k) {
      World world = started.world();
      const Snapshot sharing = k % 2 ? world.snapshot() : Snapshot{};
      const Outcome outcome = outcomeWithout(k, lasting, call.name, [&] { call.take(world); });
      if (outcome == Outcome::OutOfMemory) {
        EXPECT_EQ(world.hash(), before) << call.name << " " << k;
        call.take(world);
      }
      EXPECT_EQ(world.hash(), after) << call.name << " " << k;
      run(world, 3);
      EXPECT_EQ(world.hash(), reference.hash()) << call.name << " " << k;
      return outcome != Outcome::Whole && !testing::Test::HasFailure();
    });
  }
}

}  // namespace rubble::test

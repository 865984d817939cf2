// Bodies in another order on the device: what tests/world/order_test.cpp says of the CPU.
#include <cuda_runtime_api.h>

#include <cstring>

#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaOrder : public CudaTest {
 protected:
  /// mixedScene() with its bricks taken alternately from both ends and a ball at rest, `steps` steps old,
  /// then optionally sorted, and one step older.
  static World world(const std::string& backend, bool sorted, int steps = 40) {
    World w(scrambled(), optionsFor(backend));
    run(w, steps);
    if (sorted) w.sortBodies();
    EXPECT_EQ(w.step().sorted, sorted);
    return w;
  }
  static Scene scrambled() {
    Scene scene = mixedScene();
    const int bricks = 4 * 4 * 6;
    std::vector<BodyDef> bodies(scene.bodies.begin() + 1, scene.bodies.begin() + 1 + bricks);
    const auto brick = [&](int i) {
      return bodies[static_cast<std::size_t>(i % 2 ? bricks - 1 - i / 2 : i / 2)];
    };
    for (int i = 0; i < bricks; ++i) scene.bodies[static_cast<std::size_t>(1 + i)] = brick(i);
    scene.bodies[static_cast<std::size_t>(1 + bricks)].velocity = {};
    return scene;
  }
};

TEST_F(CudaOrder, ChangesNoneOfTheirStates) {
  World as = world("cuda", false), sorted = world("cuda", true);
  EXPECT_LT(distance(as, sorted), 2e-5);
  run(as, 5), run(sorted, 5);
  EXPECT_LT(distance(as, sorted), 1e-3);
  const Quality a = as.quality(), b = sorted.quality();
  EXPECT_NEAR(a.penetration.mean, b.penetration.mean, 1e-4);
}

TEST_F(CudaOrder, IsThatOfTheCpu) {
  World cpu = world("cpu", true, 3), cuda = world("cuda", true, 3);
  EXPECT_LT(distance(cpu, cuda), 1e-4);
  const StepReport a = cpu.step(), b = cuda.step();
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.colors, b.colors);
}

TEST_F(CudaOrder, IsTheSameEachTime) {
  World a = world("cuda", true), b = world("cuda", true);
  run(a, 20), run(b, 20);
  EXPECT_EQ(a.hash(), b.hash());
}

TEST_F(CudaOrder, LetsEditsAndArraysFindTheirBodies) {
  World w = world("cuda", true);
  const ArrayView position = w.array(StateArray::Position);
  const auto rowIs = [&](BodyId id) {
    Vec3 row;
    cudaStreamSynchronize(reinterpret_cast<cudaStream_t>(position.stream));
    const char* const at = static_cast<const char*>(position.data) + id.index * position.strides[0];
    EXPECT_EQ(cudaMemcpy(&row, at, sizeof row, cudaMemcpyDefault), cudaSuccess);
    return row == w.state(id).position;
  };
  for (const BodyId id : w.bodies()) EXPECT_TRUE(rowIs(id)) << id.index;
  run(w, 3);
  for (const BodyId id : w.bodies()) EXPECT_TRUE(rowIs(id)) << id.index;
  w.beginPoses();
  const PoseFrame frame = w.takePoses();
  for (const BodyId id : w.bodies()) {
    double z;
    std::memcpy(&z,
                static_cast<const char*>(frame.position.data) + id.index * frame.position.strides[0] +
                    2 * frame.position.strides[1],
                sizeof z);
    EXPECT_EQ(z, w.state(id).position.z);
  }

  const BodyId pushed = w.bodyAt(30), moved = w.bodyAt(31), gone = w.bodyAt(32);
  BodyState state = w.state(moved);
  state.position = {20, 20, 5};
  w.setState(moved, state);
  const double before = w.state(pushed).velocity.z;
  w.applyImpulse(pushed, {0, 0, 1e4});
  EXPECT_GT(w.state(pushed).velocity.z, before + 5);
  w.removeBody(gone);
  const BodyId fresh = w.addBody(boxAt({-20, 20, 5}));
  EXPECT_EQ(fresh.index, gone.index);
  w.applyForce(fresh, {0, 0, 9.81 * w.massOf(fresh).mass});
  w.step();
  EXPECT_NEAR(w.state(moved).position.x, 20, 1e-3);
  EXPECT_NEAR(w.state(fresh).velocity.z, 0, 1e-4);
  // forces that are pending during a sort act on the body that they were applied to
  w.applyForce(fresh, {0, 0, 9.81 * w.massOf(fresh).mass});
  w.sortBodies();
  w.step();
  EXPECT_NEAR(w.state(fresh).velocity.z, 0, 1e-4);
  w.step();
  EXPECT_LT(w.state(fresh).velocity.z, -.1);
}

TEST_F(CudaOrder, IsInSnapshots) {
  World w = world("cuda", false);
  const Snapshot before = w.snapshot();
  w.sortBodies();
  run(w, 3);
  const Snapshot after = w.snapshot();
  run(w, 5);
  const std::uint64_t sorted = w.hash();
  w.restore(before);
  run(w, 2);
  w.restore(after);
  run(w, 5);
  EXPECT_EQ(w.hash(), sorted);
  // the CPU restores it and continues in step
  World cpu(scrambled(), optionsFor("cpu"));
  cpu.restore(after);
  run(cpu, 1);
  w.restore(after);
  run(w, 1);
  EXPECT_LT(distance(cpu, w), 1e-4);
}

TEST_F(CudaOrder, JointsAndTreesGoOn) {
  World as = world("cuda", false), sorted = world("cuda", true);
  for (const JointId id : sorted.joints()) EXPECT_NEAR(sorted.state(id).gap, as.state(id).gap, 1e-4);
  run(sorted, 60);
  for (const JointId id : sorted.joints()) EXPECT_LT(sorted.state(id).gap, 5e-3);
}

TEST_F(CudaOrder, IsMadeAsOftenAsAskedInAWorldWithClothToo) {
  Scene scene = plane();
  for (const double x : {3., -5., .2, 7., -9., .9})
    scene.bodies.push_back(boxAt({x, .3 * x, x > 0 && x < 1 ? 2.1 : 1}));
  ClothDef cloth = clothSheet({-1, -1, 1.5}, {2, 0, 0}, {0, 2, 0}, 8, 8);
  for (const int corner : {0, 8, 72, 80}) cloth.fixed.push_back(corner);
  scene.deformables.push_back(cloth);
  WorldOptions often = optionsFor("cuda");
  often.params.sortInterval = 8;
  World sorted(scene, often), as(scene, optionsFor("cuda"));
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(sorted.step().sorted, i % 8 == 0) << i;
    EXPECT_FALSE(as.step().sorted);
  }
  EXPECT_FALSE(as.vertexContacts().empty());
  EXPECT_LT(distance(as, sorted), 1e-3);
}

}  // namespace
}  // namespace rubble::test

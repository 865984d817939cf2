// The step on the device: the same bits from run to run, and what the CPU finds.
#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

class CudaStep : public CudaTest {};

TEST_F(CudaStep, GivesTheSameBitsEachTime) {
  World a(mixedScene(), optionsFor("cuda")), b(mixedScene(), optionsFor("cuda"));
  for (int i = 0; i < 60; ++i) {
    a.step(), b.step();
    ASSERT_EQ(a.hash(), b.hash()) << "after step " << i;
  }
}

TEST_F(CudaStep, FindsWhatTheCpuFindsInTheFirstStep) {
  World cpu(mixedScene(), optionsFor("cpu")), cuda(mixedScene(), optionsFor("cuda"));
  const StepReport a = cpu.step(), b = cuda.step();
  EXPECT_EQ(a.bodies, b.bodies);
  EXPECT_EQ(a.pairs, b.pairs);
  EXPECT_EQ(a.manifolds, b.manifolds);
  EXPECT_EQ(a.contacts, b.contacts);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.colorRounds, b.colorRounds);
  EXPECT_EQ(b.clashes, 0);
  EXPECT_EQ(b.quarantined, 0);
}

TEST_F(CudaStep, AgreesWithTheCpuWhileAPileSettles) {
  World cpu(brickPile(5, 8), optionsFor("cpu")), cuda(brickPile(5, 8), optionsFor("cuda"));
  run(cpu, 60), run(cuda, 60);
  EXPECT_LT(distance(cpu, cuda), 1e-3);
  const Quality a = cpu.quality(), b = cuda.quality();
  EXPECT_NEAR(a.penetration.mean, b.penetration.mean, 1e-4);
  EXPECT_NEAR(a.potentialEnergy, b.potentialEnergy, 1e-4 * std::fabs(a.potentialEnergy));
  EXPECT_EQ(cpu.contacts().empty(), cuda.contacts().empty());
}

/// More columns than blocks that solve them, of 12 to 51 cubes: the lowest ones are none (stages/columns).
TEST_F(CudaStep, AgreesWithTheCpuOnColumnsOfManyHeights) {
  constexpr int kColumns = 80, kLeast = 12, kHeights = 40;
  Scene scene = plane();
  for (int k = 0; k < kColumns; ++k)
    for (int level = 0; level < kLeast + k % kHeights; ++level)
      scene.bodies.push_back(boxAt({3.0 * k, 0, level + .5}));
  World cpu(scene, optionsFor("cpu")), cuda(scene, optionsFor("cuda"));
  run(cpu, 60), run(cuda, 60);
  EXPECT_LT(distance(cpu, cuda), 1e-3);
  EXPECT_EQ(cuda.step().quarantined, 0);
}

/// A build with RUBBLE_STRICT promises the bits of the CPU.
TEST_F(CudaStep, HasTheBitsOfTheCpuInAStrictBuild) {
  const std::vector<std::string> features = buildInfo().features;
  if (std::none_of(features.begin(), features.end(),
                   [](const std::string& f) { return f.find("strict") != std::string::npos; }))
    GTEST_SKIP() << "not a strict build";
  World cpu(mixedScene(), optionsFor("cpu")), cuda(mixedScene(), optionsFor("cuda"));
  for (int i = 0; i < 90; ++i) {
    cpu.step(), cuda.step();
    ASSERT_TRUE(sameStates(cpu, cuda)) << "after step " << i;
  }
}

/// Loops have other numbers of lanes on a device of few multiprocessors.
TEST_F(CudaStep, LaidOutForASmallDeviceAgrees) {
  for (const Scene& scene : {brickPile(5, 8), brickPile(24, 12), mixedScene()}) {
    if (!scene.joints.empty() && !isStrict()) continue;  // a ball strikes there
    World all(scene, optionsFor("cuda")), few(scene, optionsFor("small-cuda"));
    run(all, 40), run(few, 40);
    if (isStrict())
      EXPECT_TRUE(sameStates(all, few));
    else
      EXPECT_LT(distance(all, few), 1e-3);
    EXPECT_EQ(few.step().quarantined, 0);
  }
}

TEST_F(CudaStep, AgreesWithTheCpuWithJoints) {
  Scene chain = mixedScene();
  // the links and their joints alone: nothing chaotic
  chain.bodies.erase(chain.bodies.begin(), chain.bodies.end() - 6);
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    chain.joints[i].bodyA = static_cast<int>(i);
    chain.joints[i].bodyB = static_cast<int>(i) - 1;
  }
  World cpu(chain, optionsFor("cpu")), cuda(chain, optionsFor("cuda"));
  run(cpu, 60), run(cuda, 60);
  EXPECT_LT(distance(cpu, cuda), 1e-2);
  for (const JointId joint : cuda.joints()) {
    EXPECT_NEAR(cpu.state(joint).gap, cuda.state(joint).gap, 1e-3);
    EXPECT_LT(cuda.state(joint).gap, .05);
  }
}

/// Forces of trees are small differences of large numbers. If the coordinates of the back-substitution
/// differ in one bit from those of the summed blocks, limits that are just reached rotate elbows by 0.02 rad
/// per step in free fall.
TEST_F(CudaStep, AgreesWithTheCpuWithLimitsAndFrictionInTrees) {
  Scene arms;
  for (int i = 0; i < 16; ++i) {
    const Quat turn = fromAxisAngle(normalize(Vec3{1., .3 * i, -.2 * i}), .4 * i);
    const Vec3 start{3. * i, 0, 0}, along = rotate(turn, Vec3{1, 0, 0});
    for (int k = 0; k < 3; ++k) {
      BodyDef limb;
      limb.shape = Shape::box({.15, .05, .04});
      limb.position = start + .3 * k * along;
      limb.orientation = turn;
      limb.mass = 2;
      arms.bodies.push_back(limb);
      if (k == 0) continue;
      JointDef elbow = jointAt(arms, JointType::Hinge, 3 * i + k, 3 * i + k - 1,
                               start + (.3 * k - .15) * along, turn);
      elbow.axes[0].min = 0, elbow.axes[0].max = 2.2;
      elbow.axes[0].friction = .5;
      arms.joints.push_back(elbow);
    }
  }
  World cpu(arms, optionsFor("cpu")), cuda(arms, optionsFor("cuda"));
  run(cpu, 10), run(cuda, 10);
  EXPECT_LT(distance(cpu, cuda), 1e-5);
}

/// The plate has a block or a warp of its own in each stage that loops over its contacts. The ball strikes
/// the heap.
TEST_F(CudaStep, AgreesWithTheCpuWhereOneBodyTouchesAHundred) {
  Scene heap = plane();
  BodyDef plate;
  plate.shape = Shape::box({5, 5, .25});
  plate.position = {0, 0, .25};
  heap.bodies.push_back(plate);
  for (int i = 0; i < 100; ++i)
    heap.bodies.push_back(boxAt({-4.05 + .9 * (i % 10), -4.05 + .9 * (i / 10), .5 + .4}, .4));
  BodyDef ball;
  ball.shape = Shape::sphere(.3);
  ball.position = {-12, .1, 1.5};
  ball.velocity = {90, 0, 0};
  heap.bodies.push_back(ball);
  World cpu(heap, optionsFor("cpu")), cuda(heap, optionsFor("cuda")), again(heap, optionsFor("cuda"));
  for (int i = 0; i < 12; ++i) {
    cpu.step(), cuda.step(), again.step();
    ASSERT_LT(distance(cpu, cuda), 1e-4) << "after step " << i;
    ASSERT_TRUE(sameStates(cuda, again)) << "after step " << i;
  }
}

TEST_F(CudaStep, TakesForcesThroughAllSubstepsAndEndsThem) {
  Scene scene;
  scene.gravity = {};
  scene.bodies.push_back(boxAt({}));
  scene.bodies.push_back(boxAt({5, 0, 0}));
  WorldOptions options = optionsFor("cuda");
  options.params.substeps = 3;
  World world(scene, options);
  const BodyId id = world.bodyAt(0);
  const double mass = world.massOf(id).mass;
  for (int i = 1; i <= 4; ++i) {
    world.applyForce(id, {6 * mass, 0, 0});
    world.step();
    EXPECT_NEAR(world.state(id).velocity.x, .1 * i, 1e-5);
  }
  run(world, 3);
  EXPECT_NEAR(world.state(id).velocity.x, .4, 1e-5);
  EXPECT_EQ(world.state(world.bodyAt(1)).velocity, Vec3{});
}

TEST_F(CudaStep, MeasuresStagesOnlyIfAsked) {
  WorldOptions options = optionsFor("cuda");
  World with(brickPile(3, 3), options);
  options.timings = false;
  World without(brickPile(3, 3), options);
  for (int i = 0; i < 8; ++i) {
    const StepReport a = with.step(), b = without.step();
    EXPECT_GT(a.stageMs("primal"), 0) << i;
    EXPECT_GT(a.stageMs("narrow"), 0) << i;
    EXPECT_TRUE(b.stages.empty()) << i;
  }
  EXPECT_EQ(with.hash(), without.hash());
  EXPECT_GT(with.memoryBytes(), 0u);
}

TEST_F(CudaStep, TakesNewParametersWhileRunning) {
  World cpu(brickPile(3, 4), optionsFor("cpu")), cuda(brickPile(3, 4), optionsFor("cuda"));
  for (World* world : {&cpu, &cuda}) {
    run(*world, 10);
    Params params = world->params();
    params.iterations = 8;
    params.dt = 1.0 / 120;
    params.substeps = 2;
    world->setParams(params);
    run(*world, 10);
    world->setGravity({0, 0, -5});
    run(*world, 10);
  }
  EXPECT_LT(distance(cpu, cuda), 1e-3);
}

TEST_F(CudaStep, RunsAWorldWithoutBodies) {
  World world(Scene{}, optionsFor("cuda"));
  const StepReport report = run(world, 3);
  EXPECT_EQ(report.bodies, 0);
  EXPECT_EQ(report.contacts, 0);
  world.addBody(boxAt({0, 0, 10}));
  run(world, 3);
  EXPECT_LT(world.state(world.bodies()[0]).position.z, 10);
}

}  // namespace
}  // namespace rubble::test

// Several GPUs of this process that step one world: the bits of one GPU, at any number of them. Where there
// are fewer GPUs than ranks, some have several.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "scenes/registry.h"
#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

/// Ranks that share a GPU wait for one another's kernels. Streams that share a hardware queue then wait in a
/// circle, so there are as many queues as CUDA gives. It reads this before its first call.
[[maybe_unused]] const bool kManyQueues = setenv("CUDA_DEVICE_MAX_CONNECTIONS", "32", 0) == 0;

int gpus() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

WorldOptions onRanks(int count, int cutInterval = 0, RankExchange exchange = RankExchange::Stores) {
  WorldOptions options = optionsFor("distributed");
  options.ranks.exchange = exchange;
  options.ranks.cutInterval = cutInterval, options.ranks.timeout = 20;
  for (int rank = 0; rank < count; ++rank) options.ranks.devices.push_back(rank % gpus());
  return options;
}

/// Strict builds step on one GPU.
class CudaPeers : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (isStrict()) GTEST_SKIP() << "a strict build";
  }
};

/// Small scenes of the registry, with the smash.
class CudaPeersScene : public CudaPeers, public testing::WithParamInterface<const char*> {};

TEST_P(CudaPeersScene, HasTheBitsOfOneGpu) {
  const scenes::Spec& spec = scenes::find(GetParam());
  const auto job = [&] {
    scenes::Job made = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
    made.probes.clear();
    return made;
  };
  constexpr int kSteps = 300, kCompared = 60;
  std::vector<std::uint64_t> one;
  for (const int count : {1, 2, 3, 4, 8}) {
    // ranks that share GPUs may wait for one another for ever: two on the only one are for machines with no
    // more
    if (count > std::max(2, gpus())) continue;
    for (const int cutInterval : count == 2 ? std::vector{0, 7} : std::vector{0}) {
      WorldOptions options = onRanks(count, cutInterval);
      const scenes::Job of = job();
      options.params.iterations = of.iterations, options.params.substeps = of.substeps;
      options.params.dt = of.dt;
      scenes::Runner runner(job(), options);
      std::vector<std::uint64_t> hashes;
      for (int i = 0; i < kSteps; ++i) {
        runner.step();
        if (i % kCompared == kCompared - 1) hashes.push_back(runner.world().hash());
      }
      if (count == 1)
        one = hashes;
      else
        EXPECT_EQ(hashes, one) << count << " ranks, cut interval " << cutInterval;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaPeersScene,
                         testing::Values("pile-1k", "ring-5k", "gables", "chains", "ragdolls", "gear-train",
                                         "break-row", "bounce-ladder", "bullet-plate", "rolling",
                                         "every-shape", "sleepers", "soft-blocks", "mixed-trampoline"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase_if(name, [](unsigned char c) { return !std::isalnum(c); });
                           return name;
                         });

/// Ranks that do not reach one another's memory, on one GPU or several, through the host.
class CudaLettersScene : public CudaPeers, public testing::WithParamInterface<const char*> {};

TEST_P(CudaLettersScene, HasTheBitsOfOneGpu) {
  const scenes::Spec& spec = scenes::find(GetParam());
  constexpr int kSteps = 40;
  std::uint64_t one = 0;
  for (const int count : {1, 3}) {
    scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
    job.probes.clear();
    WorldOptions options = onRanks(count, 9, RankExchange::Letters);
    options.ranks.nccl = false;
    options.params.iterations = job.iterations, options.params.substeps = job.substeps;
    options.params.dt = job.dt;
    scenes::Runner runner(std::move(job), options);
    for (int i = 0; i < kSteps; ++i) runner.step();
    if (count == 1)
      one = runner.world().hash();
    else
      EXPECT_EQ(runner.world().hash(), one);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaLettersScene,
                         testing::Values("pile-1k", "ring-5k", "chains", "ragdolls", "break-row",
                                         "bounce-ladder", "bullet-plate", "rolling", "soft-blocks"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::erase_if(name, [](unsigned char c) { return !std::isalnum(c); });
                           return name;
                         });

TEST_F(CudaPeers, KeepTheBitsThroughEditsSortsAndSnapshots) {
  World one(mixedScene(), onRanks(1)), two(mixedScene(), onRanks(2, 5));
  for (int i = 0; i < 60; ++i) {
    for (World* world : {&one, &two}) {
      if (i == 7) world->removeBody(world->bodyAt(5));
      if (i % 6 == 1) world->addBody(boxAt({.3 * i, .1 * i, 9}));
      if (i == 0 || i == 20) world->sortBodies();
      if (i == 31) world->applyImpulse(world->bodyAt(12), {1, 2, 3});
      if (i == 40) world->restore(world->snapshot());
      world->step();
    }
    if (i % 4 == 3) {
      ASSERT_EQ(one.hash(), two.hash()) << "after step " << i;
    }
  }
}

TEST_F(CudaPeers, DivideTheBodies) {
  World world(brickPile(12, 12), onRanks(2));
  StepReport report;
  for (int i = 0; i < 20; ++i) report = world.step();
  ASSERT_EQ(report.ranks.size(), 2u);
  for (const RankReport& rank : report.ranks) {
    EXPECT_GT(rank.bodies, 12 * 12 * 12 / 4);
    EXPECT_GT(rank.ghosts, 0);
  }
  EXPECT_EQ(report.ranks[0].bodies + report.ranks[1].bodies, 12 * 12 * 12);
}

TEST_F(CudaPeers, NameAGpuThatDoesNotExist) {
  WorldOptions options = onRanks(2);
  options.ranks.devices.back() = gpus();
  EXPECT_THROW(World(mixedScene(), options), Error);
}

/// One GPU runs out of memory while the scene grows: the step of all ends with an error.
TEST_F(CudaPeers, EndTogetherIfOneRunsOutOfMemory) {
  if (gpus() < 2) GTEST_SKIP() << "needs two GPUs";
  WorldOptions options = onRanks(2);
  options.ranks.timeout = 5;
  World world(brickPile(30, 30), options);
  world.step();
  // takes what is left on the second one
  ASSERT_EQ(cudaSetDevice(1), cudaSuccess);
  std::vector<void*> taken;
  for (std::size_t bytes = std::size_t{1} << 34; bytes >= std::size_t{1} << 20; bytes /= 2)
    for (void* p = nullptr; cudaMalloc(&p, bytes) == cudaSuccess;) taken.push_back(p);
  cudaGetLastError();
  ASSERT_EQ(cudaSetDevice(0), cudaSuccess);
  const auto begin = std::chrono::steady_clock::now();
  std::string message;
  try {
    world.reserve("pairs", 40000000);
    for (int i = 0; i < 50; ++i) {
      for (int k = 0; k < 400; ++k) world.addBody(boxAt({1.1 * (k % 20), 1.1 * (k / 20), 40. + 1.1 * i}));
      world.step();
    }
  } catch (const Error& error) {
    message = error.what();
  }
  for (void* p : taken) cudaFree(p);
  EXPECT_NE(message.find("out of device memory"), std::string::npos) << message;
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

}  // namespace
}  // namespace rubble::test

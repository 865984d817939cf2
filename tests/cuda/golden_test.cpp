// Recorded hashes of runs on the device (tests/golden.txt). They change with the method and with the order of
// sums only. If this test fails while all others pass, check whether the change was intended. The message has
// the new row.
#include <cuda_runtime_api.h>

#include <algorithm>

#include "tests/cuda/cuda_scenes.h"
#include "tests/support/golden.h"

namespace rubble::test {
namespace {

/// What recorded them: compute capability of the device, and toolkit of the code, which may contract products
/// and sums in other ways.
constexpr int kCapability = 90, kToolkit = 13000;

class CudaGolden : public CudaTest, public testing::WithParamInterface<Golden> {};

TEST_P(CudaGolden, HashIsTheRecordedOne) {
  int device = 0, major = 0, minor = 0;
  cudaGetDevice(&device);
  cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device);
  cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, device);
  if (10 * major + minor != kCapability || CUDART_VERSION != kToolkit)
    GTEST_SKIP() << "recorded with another device or toolkit";
  if (isStrict()) GTEST_SKIP() << "recorded with another build";
  const Golden& golden = GetParam();
  const scenes::Spec& spec = scenes::find(golden.scene);
  World world(spec.build(scenes::resolve(spec, spec.testArguments)), optionsFor("cuda"));
  run(world, golden.steps / 2);
  if (golden.sorts) world.sortBodies();
  run(world, golden.steps - golden.steps / 2);
  EXPECT_EQ(world.hash(), golden.hash) << rowOf(golden, world.hash());
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaGolden,
                         testing::ValuesIn(goldens("cuda-" + std::to_string(kCapability) + "-" +
                                                   std::to_string(kToolkit))),
                         [](const auto& info) { return info.param.name(); });

/// A strict build has the hashes of the CPU.
class CudaStrictGolden : public CudaTest, public testing::WithParamInterface<Golden> {};

TEST_P(CudaStrictGolden, HashIsThatOfTheCpu) {
  if (!isStrict()) GTEST_SKIP() << "not a strict build";
  const std::uint64_t hash = hashOf(GetParam(), optionsFor("cuda"));
  EXPECT_EQ(hash, GetParam().hash) << rowOf(GetParam(), hash);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaStrictGolden, testing::ValuesIn(goldens("cpu")),
                         [](const auto& info) { return info.param.name(); });

/// Scenes with joints, manifolds of few points, pairs that come and go, and soft things.
class CudaLockstep : public CudaTest, public testing::WithParamInterface<const char*> {};

TEST_P(CudaLockstep, ShowsNoDifferenceFromTheCpuAfterAnyKernel) {
  if (!isStrict()) GTEST_SKIP() << "not a strict build";
  const scenes::Spec& spec = scenes::find(GetParam());
  World world(spec.build(scenes::resolve(spec, spec.testArguments)), optionsFor("lockstep-cuda"));
  run(world, 8);
  EXPECT_EQ(world.firstDifference(), "");
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaLockstep,
                         testing::Values("hinge-pendulum", "ragdoll", "bowl", "silo", "breakable-wall",
                                         "plates-on-cloth"));

class CudaLockstepTables : public CudaTest {};

TEST_F(CudaLockstepTables, AreComparedWholeAfterTheyGrew) {
  if (!isStrict()) GTEST_SKIP() << "not a strict build";
  World world(emptyScene({0, 0, -kGravity}), optionsFor("lockstep-cuda"));
  for (int layer = 0; layer < 4; ++layer) {
    for (int k = 0; k < 40; ++k) world.addBody(body(Shape::box({.2, .2, .2}), {.4 * k, 0, .4 * layer}));
    run(world, 2);
  }
  EXPECT_EQ(world.firstDifference(), "");
}

}  // namespace
}  // namespace rubble::test

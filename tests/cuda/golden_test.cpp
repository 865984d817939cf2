// Recorded hashes of runs on the device. They change with the method and with the order of sums only. If
// this test fails while all others pass, check whether the change was intended. The message has the new
// number.
#include <cuda_runtime_api.h>

#include "scenes/registry.h"
#include "tests/cuda/cuda_scenes.h"

namespace rubble::test {
namespace {

/// What recorded them: compute capability of the device, and toolkit of the code, which may contract products
/// and sums in other ways.
constexpr int kCapability = 90, kToolkit = 13000;

struct Golden {
  const char* scene;  ///< of the registry, at the size of its tests
  int steps;
  bool sorted;  ///< with the bodies sorted in the middle
  std::uint64_t hash;
};

class CudaGolden : public CudaTest, public testing::WithParamInterface<Golden> {};

TEST_P(CudaGolden, HashIsTheRecordedOne) {
  int device = 0, major = 0, minor = 0;
  cudaGetDevice(&device);
  cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device);
  cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, device);
  if (10 * major + minor != kCapability || CUDART_VERSION != kToolkit)
    GTEST_SKIP() << "recorded with another device or toolkit";
  for (const std::string& feature : buildInfo().features)
    if (feature.find("strict") != std::string::npos) GTEST_SKIP() << "recorded with another build";
  const Golden& golden = GetParam();
  const scenes::Spec& spec = scenes::find(golden.scene);
  World world(spec.build(scenes::resolve(spec, spec.testArguments)), optionsFor("cuda"));
  run(world, golden.steps / 2);
  if (golden.sorted) world.sortBodies();
  run(world, golden.steps - golden.steps / 2);
  EXPECT_EQ(world.hash(), golden.hash) << golden.scene;
}

INSTANTIATE_TEST_SUITE_P(Scenes, CudaGolden,
                         testing::Values(Golden{"pile-1k", 60, false, 1375911635626754874u},
                                         Golden{"pile-1k", 60, true, 12621792144315724266u},
                                         Golden{"ring", 60, false, 10009704091013997584u},
                                         Golden{"ragdoll", 60, false, 16994915369974632873u},
                                         Golden{"joint-grid", 30, true, 15215938411805847947u},
                                         Golden{"soft-beam", 60, false, 1886527713512875948u},
                                         Golden{"cloth-folds", 60, false, 1575440808954512219u}),
                         [](const auto& info) {
                           std::string name = info.param.scene;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name + (info.param.sorted ? "_sorted" : "");
                         });

}  // namespace
}  // namespace rubble::test

// Actuators of batches on the device.
#include "tests/cuda/cuda_test.h"
#include "tests/support/actuator_claims.h"

namespace rubble::test {
namespace {

class CudaActuators : public CudaTest {};

TEST_F(CudaActuators, HaveInEachWorldTheBitsThatTheyHaveAlone) {
  for (const int count : {1, 35, 300}) expectActuatorsAlone(options(4, "cuda"), count, false);
}
TEST_F(CudaActuators, GoBackWithTheSnapshotsOfTheirWorlds) { expectActuatorsGoBack(options(4, "cuda")); }

/// The step is that of the CPU, up to round-off of single precision.
TEST_F(CudaActuators, DoWhatThoseOfTheCpuDo) {
  constexpr int kWorlds = 8, kSteps = 5;
  constexpr double kTolerance = 1e-4;  // [m], [1], and of forces of 40 N
  Worlds cpu(options(4, "cpu")), cuda(options(4, "cuda"));
  std::vector<Actuators> actuators;
  for (Worlds* const worlds : {&cpu, &cuda}) {
    worlds->addCopies(actuatedScene(), kWorlds);
    Actuators& own = actuators.emplace_back(actuatorsOf(), *worlds);
    for (int step = 0; step < kSteps; ++step) {
      for (int w = 0; w < kWorlds; ++w) setControls(rowOf(own.controls(), w), w, step);
      own.apply(*worlds), worlds->step();
    }
  }
  for (std::size_t k = 0; k < actuators[0].activations().size(); ++k) {
    EXPECT_NEAR(actuators[0].activations()[k], actuators[1].activations()[k], kTolerance) << k;
    EXPECT_NEAR(actuators[0].forces()[k], actuators[1].forces()[k], 40 * kTolerance) << k;
  }
  for (int w = 0; w < kWorlds; ++w)
    for (const BodyId id : cpu[w].bodies())
      EXPECT_LT(length(cpu[w].state(id).position - cuda[w].state(id).position), kTolerance)
          << "world " << w << ", body " << id.index;
}

}  // namespace
}  // namespace rubble::test

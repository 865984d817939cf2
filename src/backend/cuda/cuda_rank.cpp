// GPUs that step one world together: each has an engine, and a host thread or a process.
#include "backend/cuda/cuda_engine.h"
#include "backend/cuda_team.h"
#include "backend/distributed/rank_team.h"

namespace rubble::RUBBLE_CORE {

namespace {

int present() {
  int device = 0;
  checkCuda(cudaGetDevice(&device), "cudaGetDevice");
  return device;
}

int deviceCount() {
  int count = 0;
  checkCuda(cudaGetDeviceCount(&count), "cudaGetDeviceCount");
  return count;
}

/// Ranks store into one another's memory.
void requireReach(const std::vector<int>& devices) {
  for (const int a : devices)
    for (const int b : devices) {
      int reaches = 1;
      if (a != b) checkCuda(cudaDeviceCanAccessPeer(&reaches, a, b), "cudaDeviceCanAccessPeer");
      if (!reaches)
        throw Error("ranks.devices", "GPUs that reach one another's memory",
                    std::to_string(a) + " and " + std::to_string(b));
    }
}

class CudaRank final : public DividedEngine {
 public:
  /// The device is the current one.
  CudaRank(Transport& transport, const RankOptions& options, bool timings)
      : device_(present()), cuda_({.timings = timings}) {
    cuda_.divide(transport, options);
  }
  ObservableEngine& engine() override { return cuda_; }
  int enter() override {
    const int before = present();
    checkCuda(cudaSetDevice(device_), "cudaSetDevice");
    return before;
  }
  void leave(int before) override { cudaSetDevice(before); }
  void settle() override { cuda_.settle(); }
  void gatherState() override { cuda_.gatherState(); }
  void sortWhole() override {
    cuda_.sortBodies();
    restart();
  }
  void restart() override { cuda_.restart(); }
  std::vector<RankReport> reports() const override { return cuda_.reports(); }

 private:
  int device_;
  CudaEngine cuda_;
};

}  // namespace

std::unique_ptr<Engine> makeCudaTeam(const RankOptions& ranks, bool timings) {
  const int devices = deviceCount();
  for (const int device : ranks.devices)
    if (device < 0 || device >= devices)
      throw Error("ranks.devices", "GPUs from 0 to " + std::to_string(devices - 1), std::to_string(device));
  if (ranks.exchange != RankExchange::Letters) requireReach(ranks.devices);
  RankOptions options = ranks;
  options.count = static_cast<int>(ranks.devices.size());
  return std::make_unique<RankTeam>(options, [&](Transport& transport) -> std::unique_ptr<DividedEngine> {
    checkCuda(cudaSetDevice(ranks.devices[static_cast<std::size_t>(transport.rank())]), "cudaSetDevice");
    return std::make_unique<CudaRank>(transport, options, timings && transport.rank() == 0);
  });
}

std::unique_ptr<Engine> makeCudaRank(std::unique_ptr<Transport> transport, const RankOptions& ranks,
                                     bool timings) {
  if (ranks.devices.front() < 0)
    throw Error("ranks.devices", "a GPU from 0 on", std::to_string(ranks.devices.front()));
  checkCuda(cudaSetDevice(ranks.devices.front() % deviceCount()), "cudaSetDevice");
  RankOptions options = ranks;
  options.exchange = RankExchange::Letters;
  auto rank = std::make_unique<CudaRank>(*transport, options, timings && transport->rank() == 0);
  return std::make_unique<RankEngine>(std::move(transport), std::move(rank));
}

}  // namespace rubble::RUBBLE_CORE

// Interface of the CUDA backend to the rest of the library, whether or not it is built.
#include <rubble/info.h>

#include "backend/cuda_team.h"

namespace rubble {

#if defined(RUBBLE_HAS_CUDA)

namespace f32 {
std::string deviceStatus();
bool deviceReady();
std::unique_ptr<Engine> makeCudaEngine(const CudaOptions& options);
std::unique_ptr<Engine> makeCudaTeam(const RankOptions& ranks, bool timings);
std::unique_ptr<Engine> makeCudaRank(std::unique_ptr<Transport> transport, const RankOptions& ranks,
                                     bool timings);
}  // namespace f32

std::string cudaStatus() { return f32::deviceStatus(); }
bool cudaReady() {
  static const bool ready = f32::deviceReady();  // may take seconds: initializes the driver
  return ready;
}
std::unique_ptr<Engine> makeCudaEngine(const CudaOptions& options) {
  return cudaReady() ? f32::makeCudaEngine(options) : nullptr;
}
std::unique_ptr<Engine> makeCudaTeam(const RankOptions& ranks, bool timings) {
  return f32::makeCudaTeam(ranks, timings);
}
std::unique_ptr<Engine> makeCudaRank(std::unique_ptr<Transport> transport, const RankOptions& ranks,
                                     bool timings) {
  return f32::makeCudaRank(std::move(transport), ranks, timings);
}

#else

std::string cudaStatus() { return "off: built without CUDA"; }
bool cudaReady() { return false; }
std::unique_ptr<Engine> makeCudaEngine(const CudaOptions&) { return nullptr; }
std::unique_ptr<Engine> makeCudaTeam(const RankOptions&, bool) { return nullptr; }
std::unique_ptr<Engine> makeCudaRank(std::unique_ptr<Transport>, const RankOptions&, bool) { return nullptr; }

#endif

}  // namespace rubble

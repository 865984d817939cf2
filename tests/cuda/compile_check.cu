// Compiled, never run: nvcc must compile every header that host and device share, and every kernel of the
// step, without a warning.
#include "backend/cuda/cuda_executor.cuh"
#include "core_headers.h"

namespace rubble::RUBBLE_CORE {

// with it every kernel that the step names
template void step(CudaExecutor&);

}  // namespace rubble::RUBBLE_CORE

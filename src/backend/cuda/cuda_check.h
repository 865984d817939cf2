#pragma once
#include <cuda_runtime_api.h>

#include <string>

#include <rubble/error.h>

namespace rubble {

/// Throws Error if a CUDA call failed. `call` is its name.
inline void checkCuda(cudaError_t status, const char* call) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // clears the error, so that the next call does not report it again
  throw Error(std::string("CUDA: ") + call + ": " + cudaGetErrorString(status));
}

}  // namespace rubble

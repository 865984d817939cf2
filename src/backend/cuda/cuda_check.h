#pragma once
#include <cuda_runtime_api.h>

#include <string>

#include <rubble/error.h>

namespace rubble {

/// Throws Error if a CUDA call failed; `call` names it.
inline void checkCuda(cudaError_t status, const char* call) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // told here once: the next call starts clean
  throw Error(std::string("CUDA: ") + call + ": " + cudaGetErrorString(status));
}

}  // namespace rubble

#include <cuda_runtime.h>

#include "backend/cuda/cuda_stepper.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr int kEditThreads = 128;

__global__ void scatterWords(int* to, const int* from, const int* slots, int count, int words) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= count * words) return;
  const int k = i / words, word = i - k * words;
  to[static_cast<std::size_t>(slots[k]) * static_cast<std::size_t>(words) + static_cast<std::size_t>(word)] = from[i];
}

__device__ bool contains(const int* sorted, int count, int value) {
  int low = 0, high = count;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (sorted[middle] < value)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && sorted[low] == value;
}

__global__ void forgetManifolds(const __grid_constant__ View s, const int* slots, int count, int pairs) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= pairs || !(contains(slots, count, s.oldPair[i].owner) || contains(slots, count, s.oldPair[i].other))) return;
  s.oldPair[i].other = -1;
  s.oldManifold[i].count = 0;
}

__global__ void repeatOffset(int* offsets, int begin, int end) {
  const int i = begin + static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < end) offsets[i + 1] = offsets[begin];
}

unsigned blocksFor(std::size_t n) { return static_cast<unsigned>((n + kEditThreads - 1) / kEditThreads); }

}  // namespace

void scatterElements(cudaStream_t stream, void* to, const void* from, const int* slots, int count, std::size_t elementBytes) {
  const int words = static_cast<int>(elementBytes / sizeof(int));
  // a launch for so many elements that their words can be counted by an int
  constexpr int kMostWords = 1 << 28;
  const int most = kMostWords / words;
  for (int done = 0; done < count; done += most) {
    const int n = count - done < most ? count - done : most;
    const int* const source = static_cast<const int*>(from) + static_cast<std::size_t>(done) * static_cast<std::size_t>(words);
    scatterWords<<<blocksFor(static_cast<std::size_t>(n) * static_cast<std::size_t>(words)), kEditThreads, 0, stream>>>(
        static_cast<int*>(to), source, slots + done, n, words);
    checkCuda(cudaGetLastError(), "scatterWords");
  }
}

void forgetContactsOf(cudaStream_t stream, const View& device, const int* slots, int count, int pairs) {
  if (pairs <= 0 || count <= 0) return;
  forgetManifolds<<<blocksFor(static_cast<std::size_t>(pairs)), kEditThreads, 0, stream>>>(device, slots, count, pairs);
  checkCuda(cudaGetLastError(), "forgetManifolds");
}

void startPairOffsets(cudaStream_t stream, const View& device, int begin, int end) {
  if (end <= begin) return;
  repeatOffset<<<blocksFor(static_cast<std::size_t>(end - begin)), kEditThreads, 0, stream>>>(device.oldPairOffset, begin, end);
  checkCuda(cudaGetLastError(), "repeatOffset");
}

namespace {

/// Empty if the device can run the step, else why not.
std::string problem(int& device, cudaDeviceProp& properties) {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0) {
    cudaGetLastError();
    return status == cudaSuccess || status == cudaErrorNoDevice ? "no device found"
                                                                : std::string("no device found: ") + cudaGetErrorString(status);
  }
  if (const cudaError_t got = cudaGetDevice(&device); got != cudaSuccess) return cudaGetErrorString(got);
  if (const cudaError_t got = cudaGetDeviceProperties(&properties, device); got != cudaSuccess) return cudaGetErrorString(got);
  cudaFuncAttributes attributes{};
  if (cudaFuncGetAttributes(&attributes, scatterWords) == cudaSuccess) return "";
  cudaGetLastError();
  return std::string(properties.name) + " is of compute capability " + std::to_string(properties.major) + "." +
         std::to_string(properties.minor) + ", which this build has no code for";
}

}  // namespace

std::string deviceStatus() {
  int device = 0;
  cudaDeviceProp properties{};
  const std::string why = problem(device, properties);
  if (!why.empty()) return "off: " + why;
  int runtime = 0;
  cudaRuntimeGetVersion(&runtime);
  return std::string("on: ") + properties.name + ", " + std::to_string(properties.totalGlobalMem >> 30) + " GiB, compute capability " +
         std::to_string(properties.major) + "." + std::to_string(properties.minor) + ", CUDA " + std::to_string(runtime / 1000) + "." +
         std::to_string(runtime % 1000 / 10);
}

bool deviceReady() {
  int device = 0;
  cudaDeviceProp properties{};
  return problem(device, properties).empty();
}

}  // namespace rubble::RUBBLE_CORE

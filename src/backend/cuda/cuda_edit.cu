#include <cuda_runtime.h>

#include <algorithm>

#include "backend/cuda/cuda_stepper.h"
#include "stages/pairs/active_pairs.h"

namespace rubble::RUBBLE_CORE {

namespace {

constexpr int kEditThreads = 128;

/// Pieces per launch: they are passed as kernel arguments.
constexpr int kMostPieces = 32;
struct ScatterList {
  ScatterPiece piece[kMostPieces];
};

/// One row of blocks per piece, one thread per word.
__global__ void scatterWords(const __grid_constant__ ScatterList list) {
  const ScatterPiece& p = list.piece[blockIdx.y];
  const std::size_t words = static_cast<std::size_t>(p.words),
                    all = static_cast<std::size_t>(p.count) * words;
  const std::size_t stride = static_cast<std::size_t>(gridDim.x) * blockDim.x;
  for (std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x; i < all;
       i += stride) {
    const std::size_t k = i / words;
    static_cast<int*>(p.to)[static_cast<std::size_t>(p.slots[k]) * words +
                            (i - k * words)] = static_cast<const int*>(p.from)[i];
  }
}

/// One thread per word.
__global__ void gatherWords(int* to, const int* from, const int* placeOf, int words, std::size_t all) {
  const std::size_t i = static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= all) return;
  const std::size_t id = i / static_cast<std::size_t>(words);
  to[i] = from[static_cast<std::size_t>(placeOf[id]) * static_cast<std::size_t>(words) +
               (i - id * static_cast<std::size_t>(words))];
}

__global__ void copyMotion(const __grid_constant__ SolverData s, int i, BodyMotionState* to) {
  *to = {s.position[i],         s.orientation[i], s.velocity[i], s.angularVelocity[i],
         s.previousVelocity[i], s.asleep[i],      s.stillTime[i]};
}

__global__ void changeVelocities(const __grid_constant__ SolverData s, const int* slots, const Vec3d* changes,
                                 int count) {
  const int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k >= count) return;
  changeVelocity(s, slots[k], changes[k]);
}

__global__ void scatterRowsOf(const __grid_constant__ SolverData s, const ScatterRows rows, int count) {
  const int k = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k < count) rows(s, k);
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

__global__ void forgetManifolds(const __grid_constant__ SolverData s, const int* slots, int count,
                                int pairs) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= pairs ||
      !(contains(slots, count, s.oldPair[i].owner) || contains(slots, count, s.oldPair[i].other)))
    return;
  forgetOldPair(s, i);
}

__global__ void forgetPoints(const __grid_constant__ SolverData s, const int* slots, int count) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= s.oldPointPairOffset[s.owners()]) return;
  const int owner = s.oldPointPair[i].vertex, cornersFrom = s.vertices + s.edges;
  if (!contains(slots, count, s.oldPointPair[i].other) &&
      !(owner >= cornersFrom && contains(slots, count, (owner - cornersFrom) / kCornerSlots)))
    return;
  s.oldPointPair[i].other = -1;
  s.oldPointContact[i].active = 0;
}

__global__ void repeatOffset(int* offsets, int begin, int end) {
  const int i = begin + static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < end) offsets[i + 1] = offsets[begin];
}

unsigned blocksFor(std::size_t n) { return static_cast<unsigned>((n + kEditThreads - 1) / kEditThreads); }

}  // namespace

void scatterPieces(cudaStream_t stream, const std::vector<ScatterPiece>& pieces) {
  constexpr std::size_t kMostBlocks = 4096;
  for (std::size_t first = 0; first < pieces.size(); first += kMostPieces) {
    const std::size_t n = std::min<std::size_t>(kMostPieces, pieces.size() - first);
    ScatterList list{};
    std::size_t most = 1;
    for (std::size_t k = 0; k < n; ++k) {
      list.piece[k] = pieces[first + k];
      most = std::max(most, static_cast<std::size_t>(list.piece[k].count) *
                                static_cast<std::size_t>(list.piece[k].words));
    }
    const dim3 blocks(std::min<unsigned>(blocksFor(most), kMostBlocks), static_cast<unsigned>(n));
    scatterWords<<<blocks, kEditThreads, 0, stream>>>(list);
    checkCuda(cudaGetLastError(), "scatterWords");
  }
}

void gatherById(cudaStream_t stream, void* to, const void* from, const int* placeOf, int count, int words) {
  if (count == 0) return;
  const std::size_t all = static_cast<std::size_t>(count) * static_cast<std::size_t>(words);
  gatherWords<<<blocksFor(all), kEditThreads, 0, stream>>>(
      static_cast<int*>(to), static_cast<const int*>(from), placeOf, words, all);
  checkCuda(cudaGetLastError(), "gatherById");
}

void readMotion(cudaStream_t stream, const SolverData& device, int slot, BodyMotionState* to) {
  copyMotion<<<1, 1, 0, stream>>>(device, slot, to);
  checkCuda(cudaGetLastError(), "copyMotion");
}

void addVelocities(cudaStream_t stream, const SolverData& device, const int* slots, const Vec3d* changes,
                   int count) {
  changeVelocities<<<blocksFor(static_cast<std::size_t>(count)), kEditThreads, 0, stream>>>(device, slots,
                                                                                            changes, count);
  checkCuda(cudaGetLastError(), "changeVelocities");
}

void scatterStateRows(cudaStream_t stream, const SolverData& device, const ScatterRows& rows, int count) {
  scatterRowsOf<<<blocksFor(static_cast<std::size_t>(count)), kEditThreads, 0, stream>>>(device, rows, count);
  checkCuda(cudaGetLastError(), "scatterRowsOf");
}

void forgetContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count, int pairs) {
  if (pairs <= 0 || count <= 0) return;
  forgetManifolds<<<blocksFor(static_cast<std::size_t>(pairs)), kEditThreads, 0, stream>>>(device, slots,
                                                                                           count, pairs);
  checkCuda(cudaGetLastError(), "forgetManifolds");
}

void forgetVertexContactsOf(cudaStream_t stream, const SolverData& device, const int* slots, int count,
                            int pairs) {
  if (pairs <= 0 || count <= 0) return;
  forgetPoints<<<blocksFor(static_cast<std::size_t>(pairs)), kEditThreads, 0, stream>>>(device, slots, count);
  checkCuda(cudaGetLastError(), "forgetPoints");
}

void startPairOffsets(cudaStream_t stream, const SolverData& device, int begin, int end) {
  if (end <= begin) return;
  repeatOffset<<<blocksFor(static_cast<std::size_t>(end - begin)), kEditThreads, 0, stream>>>(
      device.oldPairOffset, begin, end);
  checkCuda(cudaGetLastError(), "repeatOffset");
}

void startCornerOffsets(cudaStream_t stream, const SolverData& device, int begin, int end) {
  if (end <= begin) return;
  repeatOffset<<<blocksFor(static_cast<std::size_t>(end - begin)), kEditThreads, 0, stream>>>(
      device.oldPointPairOffset, begin, end);
  checkCuda(cudaGetLastError(), "repeatOffset");
}

namespace {

/// Empty if the device can run the step, otherwise the reason.
std::string problem(int& device, cudaDeviceProp& properties) {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0) {
    cudaGetLastError();
    return status == cudaSuccess || status == cudaErrorNoDevice
               ? "no device found"
               : std::string("no device found: ") + cudaGetErrorString(status);
  }
  if (const cudaError_t got = cudaGetDevice(&device); got != cudaSuccess) return cudaGetErrorString(got);
  if (const cudaError_t got = cudaGetDeviceProperties(&properties, device); got != cudaSuccess)
    return cudaGetErrorString(got);
  cudaFuncAttributes attributes{};
  if (cudaFuncGetAttributes(&attributes, scatterWords) == cudaSuccess) return "";
  cudaGetLastError();
  return std::string(properties.name) + " is of compute capability " + std::to_string(properties.major) +
         "." + std::to_string(properties.minor) + ", which this build has no code for";
}

}  // namespace

std::string deviceStatus() {
  int device = 0;
  cudaDeviceProp properties{};
  const std::string why = problem(device, properties);
  if (!why.empty()) return "off: " + why;
  int runtime = 0;
  cudaRuntimeGetVersion(&runtime);
  return std::string("on: ") + properties.name + ", " + std::to_string(properties.totalGlobalMem >> 30) +
         " GiB, compute capability " + std::to_string(properties.major) + "." +
         std::to_string(properties.minor) + ", CUDA " + std::to_string(runtime / 1000) + "." +
         std::to_string(runtime % 1000 / 10);
}

bool deviceReady() {
  int device = 0;
  cudaDeviceProp properties{};
  return problem(device, properties).empty();
}

}  // namespace rubble::RUBBLE_CORE

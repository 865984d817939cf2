/// Poses of a world on a CUDA device, straight into the buffer that OpenGL draws from.
#include <cuda_gl_interop.h>
#include <cuda_runtime_api.h>

#include <algorithm>
#include <array>
#include <vector>

#include <rubble/error.h>

#include "render/pose_feed.h"

namespace rubble::render {
namespace {

constexpr int kWarp = 32, kBlock = 256;
constexpr float kFar = 1e30f;

void check(cudaError_t status, const char* call) {
  if (status == cudaSuccess) return;
  cudaGetLastError();
  throw Error(std::string("CUDA: ") + call + ": " + cudaGetErrorString(status));
}

/// Memory of the device, or page-locked memory of the host, that grows.
template <class T, bool OnHost> class Array {
 public:
  Array() = default;
  ~Array() { release(); }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  void reserve(std::size_t count) {
    if (count <= room_) return;
    release();
    if constexpr (OnHost)
      check(cudaMallocHost(&data_, count * sizeof(T)), "cudaMallocHost");
    else
      check(cudaMalloc(&data_, count * sizeof(T)), "cudaMalloc");
    room_ = count;
  }
  T* data() const { return data_; }

 private:
  void release() {
    if constexpr (OnHost)
      cudaFreeHost(data_);
    else
      cudaFree(data_);
    data_ = nullptr;
    room_ = 0;
  }
  T* data_ = nullptr;
  std::size_t room_ = 0;
};

/// Two texels: center and nothing; quaternion, scalar last.
struct Texels {
  float4 place, turn;
};
struct Box {
  float3 low, high;
};

struct Rows {
  const char *position, *orientation;
  std::int64_t positionStride, orientationStride;  ///< [bytes]
  double x, y, z;                                  ///< origin of the renderer's frame [m]
};

__device__ float4 product(const float4& a, const float4& b) {
  return {a.w * b.x + b.w * a.x + a.y * b.z - a.z * b.y, a.w * b.y + b.w * a.y + a.z * b.x - a.x * b.z,
          a.w * b.z + b.w * a.z + a.x * b.y - a.y * b.x, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
__device__ float3 turned(const float4& q, const float3& v) {
  const float3 t{2 * (q.y * v.z - q.z * v.y), 2 * (q.z * v.x - q.x * v.z), 2 * (q.x * v.y - q.y * v.x)};
  return {v.x + q.w * t.x + q.y * t.z - q.z * t.y, v.y + q.w * t.y + q.z * t.x - q.x * t.z,
          v.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

/// One warp per range of slots.
__global__ void FillPoses(const PoseSource* sources, const SlotRange* ranges, int rangeCount, Rows rows,
                          Texels* out, Box* boxes) {
  const int range = (blockIdx.x * blockDim.x + threadIdx.x) / kWarp, lane = threadIdx.x % kWarp;
  if (range >= rangeCount) return;
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (unsigned k = lane; k < ranges[range].count; k += kWarp) {
    const unsigned slot = ranges[range].first + k;
    const PoseSource& s = sources[slot];
    Texels texels{{kNowhere, kNowhere, kNowhere, 0}, {0, 0, 0, 1}};
    if (s.row >= 0) {
      const double* const p = reinterpret_cast<const double*>(rows.position + s.row * rows.positionStride);
      const float* const o = reinterpret_cast<const float*>(rows.orientation +
                                                            s.row * rows.orientationStride);
      const float4 q{o[1], o[2], o[3], o[0]};
      const float3 shift = turned(q, {s.place[0], s.place[1], s.place[2]});
      const float3 at{static_cast<float>(p[0] - rows.x) + shift.x,
                      static_cast<float>(p[1] - rows.y) + shift.y,
                      static_cast<float>(p[2] - rows.z) + shift.z};
      const float4 turn = product(q, {s.turn[0], s.turn[1], s.turn[2], s.turn[3]});
      if (isfinite(at.x + at.y + at.z + turn.x + turn.y + turn.z + turn.w)) {
        texels = {{at.x, at.y, at.z, 0}, turn};
        box.low = {fminf(box.low.x, at.x - s.radius), fminf(box.low.y, at.y - s.radius),
                   fminf(box.low.z, at.z - s.radius)};
        box.high = {fmaxf(box.high.x, at.x + s.radius), fmaxf(box.high.y, at.y + s.radius),
                    fmaxf(box.high.z, at.z + s.radius)};
      }
    }
    out[slot] = texels;
  }
  for (int step = kWarp / 2; step > 0; step /= 2) {
    box.low.x = fminf(box.low.x, __shfl_down_sync(0xffffffffu, box.low.x, step));
    box.low.y = fminf(box.low.y, __shfl_down_sync(0xffffffffu, box.low.y, step));
    box.low.z = fminf(box.low.z, __shfl_down_sync(0xffffffffu, box.low.z, step));
    box.high.x = fmaxf(box.high.x, __shfl_down_sync(0xffffffffu, box.high.x, step));
    box.high.y = fmaxf(box.high.y, __shfl_down_sync(0xffffffffu, box.high.y, step));
    box.high.z = fmaxf(box.high.z, __shfl_down_sync(0xffffffffu, box.high.z, step));
  }
  if (lane == 0) boxes[range] = box;
}

class CudaPoseFeed final : public PoseFeed {
 public:
  CudaPoseFeed() {
    check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "cudaStreamCreateWithFlags");
    check(cudaEventCreateWithFlags(&ready_, cudaEventDisableTiming), "cudaEventCreateWithFlags");
  }
  ~CudaPoseFeed() override {
    if (resource_) cudaGraphicsUnregisterResource(resource_);
    cudaEventDestroy(ready_);
    cudaStreamDestroy(stream_);
  }

  void setSlots(std::span<const PoseSource> sources, std::span<const SlotRange> ranges) override {
    sources_.reserve(sources.size());
    ranges_.reserve(ranges.size());
    boxes_.reserve(ranges.size());
    host_.reserve(ranges.size());
    check(cudaMemcpy(sources_.data(), sources.data(), sources.size_bytes(), cudaMemcpyHostToDevice),
          "cudaMemcpy of sources");
    check(cudaMemcpy(ranges_.data(), ranges.data(), ranges.size_bytes(), cudaMemcpyHostToDevice),
          "cudaMemcpy of ranges");
    rangeCount_ = ranges.size();
  }

  void fill(unsigned buffer, int storage, const PoseArrays& arrays, std::span<Bounds> bounds) override {
    const auto is = [](const ArrayView& view, const char* type) {
      return view.device && std::string(view.typestr) == type;
    };
    if (!is(arrays.position, "<f8") || !is(arrays.orientation, "<f4"))
      throw Error("poses", "<f8 and <f4 on the device", "others");
    if (bounds.size() != rangeCount_)
      throw Error("poses.bounds", std::to_string(rangeCount_) + " of them", std::to_string(bounds.size()));
    bind(buffer, storage);
    wait(arrays.position.stream);
    if (arrays.orientation.stream != arrays.position.stream) wait(arrays.orientation.stream);
    check(cudaGraphicsMapResources(1, &resource_, stream_), "cudaGraphicsMapResources");
    void* out = nullptr;
    std::size_t bytes = 0;
    check(cudaGraphicsResourceGetMappedPointer(&out, &bytes, resource_),
          "cudaGraphicsResourceGetMappedPointer");
    const Rows rows{static_cast<const char*>(arrays.position.data),
                    static_cast<const char*>(arrays.orientation.data),
                    arrays.position.strides[0],
                    arrays.orientation.strides[0],
                    arrays.origin.x,
                    arrays.origin.y,
                    arrays.origin.z};
    const int count = static_cast<int>(rangeCount_);
    if (count > 0) {
      FillPoses<<<(count * kWarp + kBlock - 1) / kBlock, kBlock, 0, stream_>>>(
          sources_.data(), ranges_.data(), count, rows, static_cast<Texels*>(out), boxes_.data());
      check(cudaGetLastError(), "FillPoses");
      check(cudaMemcpyAsync(host_.data(), boxes_.data(), rangeCount_ * sizeof(Box), cudaMemcpyDeviceToHost,
                            stream_),
            "cudaMemcpyAsync");
    }
    check(cudaGraphicsUnmapResources(1, &resource_, stream_), "cudaGraphicsUnmapResources");
    check(cudaStreamSynchronize(stream_), "cudaStreamSynchronize");
    for (std::size_t i = 0; i < rangeCount_; ++i) {
      const Box& b = host_.data()[i];
      bounds[i] = {{b.low.x, b.low.y, b.low.z}, {b.high.x, b.high.y, b.high.z}};
    }
  }

 private:
  void bind(unsigned buffer, int storage) {
    if (resource_ && buffer == buffer_ && storage == storage_) return;
    if (resource_) cudaGraphicsUnregisterResource(resource_);
    resource_ = nullptr;
    check(cudaGraphicsGLRegisterBuffer(&resource_, buffer, cudaGraphicsRegisterFlagsWriteDiscard),
          "cudaGraphicsGLRegisterBuffer");
    buffer_ = buffer, storage_ = storage;
  }
  /// Behind the work that has the arrays ready.
  void wait(std::uintptr_t stream) {
    if (stream == 0) return;
    check(cudaEventRecord(ready_, reinterpret_cast<cudaStream_t>(stream)), "cudaEventRecord");
    check(cudaStreamWaitEvent(stream_, ready_, 0), "cudaStreamWaitEvent");
  }

  cudaStream_t stream_ = nullptr;
  cudaEvent_t ready_ = nullptr;
  cudaGraphicsResource_t resource_ = nullptr;
  unsigned buffer_ = 0;
  int storage_ = -1;
  Array<PoseSource, false> sources_;
  Array<SlotRange, false> ranges_;
  Array<Box, false> boxes_;
  Array<Box, true> host_;
  std::size_t rangeCount_ = 0;
};

}  // namespace

std::unique_ptr<PoseFeed> makePoseFeed(std::string& why) {
  int device = 0;
  std::array<int, 16> devices{};
  unsigned count = 0;
  if (cudaGetDevice(&device) != cudaSuccess) {
    cudaGetLastError();
    why = "no CUDA device";
    return nullptr;
  }
  const cudaError_t status = cudaGLGetDevices(&count, devices.data(), static_cast<unsigned>(devices.size()),
                                              cudaGLDeviceListAll);
  if (status != cudaSuccess) {
    cudaGetLastError();
    why = std::string("OpenGL draws with no CUDA device: ") + cudaGetErrorString(status);
    return nullptr;
  }
  if (std::find(devices.begin(), devices.begin() + count, device) == devices.begin() + count) {
    why = "OpenGL draws with another device than CUDA device " + std::to_string(device);
    return nullptr;
  }
  return std::make_unique<CudaPoseFeed>();
}

}  // namespace rubble::render

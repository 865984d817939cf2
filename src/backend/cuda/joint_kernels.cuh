#pragma once
/// Kernels of joints. A joint has up to a thousand bytes, of which a thread reads a word here and another
/// there, each from a sector of its own. So the block of a group of joints first copies them to shared
/// memory, where neighboring lanes copy neighboring words. Then its warps process one part of each joint.
#include <cuda_pipeline.h>

#include "backend/cuda/kernels.cuh"

namespace rubble::RUBBLE_CORE {

/// Joints of one type in shared memory. Strides are odd numbers of quads, so that the lanes of a warp, each
/// with a joint of its own, read from different banks.
template <class F> class JointGroup {
  static_assert(kGroupJoints == kWarp);
  template <class T> static constexpr int kStride = static_cast<int>((sizeof(T) + 15) / 16 | 1) * 16;

 public:
  static constexpr int kBytes = kGroupJoints * (kStride<JointSpec<F>> + kStride<Joint<F>>);
  /// Copies of joints of few parts, which are small, cost more than they save (7 % of joint-grid). Larger
  /// joints than a kernel may declare room for are read where they are.
  static constexpr int kLeastParts = 3, kMostBytes = 48 << 10;
  static constexpr bool kPays = (F::Parts::kCount >= kLeastParts) && (kBytes <= kMostBytes);

  __device__ explicit JointGroup(char* memory)
      : specs_(memory), joints_(memory + kGroupJoints * kStride<JointSpec<F>>) {}
  __device__ const JointSpec<F>& spec(int k) const {
    return *reinterpret_cast<const JointSpec<F>*>(specs_ + k * kStride<JointSpec<F>>);
  }
  __device__ Joint<F>& joint(int k) const {
    return *reinterpret_cast<Joint<F>*>(joints_ + k * kStride<Joint<F>>);
  }

  /// The first `count` joints are those that indexOf() names. All threads of a block call these.
  template <class IndexOf> __device__ void load(const SolverData& s, int count, IndexOf&& indexOf) const {
    copy(s.specsOf<F>(), count, indexOf,
         [&](int k, int at) { return specs_ + k * kStride<JointSpec<F>> + at; });
    copy(s.jointsOf<F>(), count, indexOf,
         [&](int k, int at) { return joints_ + k * kStride<Joint<F>> + at; });
    __pipeline_commit();
    __pipeline_wait_prior(0);
    __syncthreads();
  }
  template <class IndexOf> __device__ void store(const SolverData& s, int count, IndexOf&& indexOf) const {
    static_assert(alignof(Joint<F>) % sizeof(int4) == 0);
    __syncthreads();
    constexpr int kQuads = static_cast<int>(sizeof(Joint<F>) / sizeof(int4));
    for (int n = static_cast<int>(threadIdx.x); n < count * kQuads; n += static_cast<int>(blockDim.x)) {
      const int k = n / kQuads, quad = n % kQuads;
      reinterpret_cast<int4*>(s.jointsOf<F>() + indexOf(k))[quad] = *reinterpret_cast<const int4*>(
          joints_ + k * kStride<Joint<F>> + quad * 16);
    }
  }

 private:
  template <class T, class IndexOf, class To>
  __device__ static void copy(const T* from, int count, IndexOf&& indexOf, To&& to) {
    static_assert(sizeof(T) % sizeof(int) == 0 && alignof(T) >= alignof(int));
    constexpr int kUnit = alignof(T) % sizeof(int4) == 0 ? sizeof(int4) : sizeof(int),
                  kUnits = static_cast<int>(sizeof(T)) / kUnit;
    for (int n = static_cast<int>(threadIdx.x); n < count * kUnits; n += static_cast<int>(blockDim.x)) {
      const int k = n / kUnits, at = n % kUnits * kUnit;
      __pipeline_memcpy_async(to(k, at), reinterpret_cast<const char*>(from + indexOf(k)) + at, kUnit);
    }
  }

  char *specs_, *joints_;
};

/// Kernels that take a joint itself, which may be a copy: operator()(s, PartIndex, spec, joint), or for
/// BeginJoints its phases.
template <class Kernel>
concept Staged = requires {
  typename Kernel::StagedJoint;
  requires JointGroup<typename Kernel::StagedJoint>::kPays;
};
constexpr int groupsOf(int joints) { return (joints + kGroupJoints - 1) / kGroupJoints; }
template <Staged Kernel> constexpr int elementsPerJoint() {
  if constexpr (requires { Kernel::kPerJoint; })
    return max(Kernel::kPerJoint, 1);
  else
    return 1;
}
/// Threads per block: a warp for each part.
template <Staged Kernel> inline constexpr int kStagedThreads = (Kernel::StagedJoint::Parts::kCount)*kWarp;

/// One joint of a group by the warps of its block, one for each part.
template <class Kernel, class F>
__device__ void runOnGroup(const SolverData& s, const Kernel& kernel, const PartIndex& at, bool on,
                           const JointSpec<F>& spec, Joint<F>& joint) {
  if (on) kernel(s, at, spec, joint);
}
template <class F>
__device__ void runOnGroup(const SolverData& s, const BeginJoints<F>&, const PartIndex& at, bool on,
                           const JointSpec<F>& spec, Joint<F>& joint) {
  JointStart<F> x;
  if (on && at.part == 0 && BeginJoints<F>::begin(s, at.joint, spec, joint, x)) chooseParts(x, spec, joint);
  __syncthreads();
  const bool begun = on && joint.active;
  if (begun) {
    if (at.part != 0) BeginJoints<F>::find(s, spec, joint, x);
    forEachPart<F>([&]<int I, class P>() {
      if (I == at.part) beginPartOf<F, I, P>(x, spec, joint);
    });
  }
  __syncthreads();
  if (begun && at.part == 0) placeJoint(x, spec, joint);
}

/// The joints of n elements, which are joints or the parts of joints in groups.
template <Staged Kernel>
__global__ void __launch_bounds__(kStagedThreads<Kernel>)
    runStaged(const __grid_constant__ SolverData s, const Kernel kernel, Count n, Gate gate) {
  using F = typename Kernel::StagedJoint;
  __shared__ __align__(16) char memory[JointGroup<F>::kBytes];
  gate.enter([&] {
    const JointGroup<F> group(memory);
    const int joints = n.list ? *n.counted : s.joints[typeIndex<F>(JointTypes{})];
    const int lane = static_cast<int>(threadIdx.x) % kWarp, part = static_cast<int>(threadIdx.x) / kWarp;
    for (int first = static_cast<int>(blockIdx.x) * kWarp; first < joints;
         first += static_cast<int>(gridDim.x) * kWarp) {
      const int count = min(kWarp, joints - first);
      const auto indexOf = [&](int k) { return n.list ? n.list[first + k] : first + k; };
      group.load(s, count, indexOf);
      const bool on = lane < count;
      const int k = on ? lane : 0;
      runOnGroup(s, kernel, {indexOf(k), part}, on, group.spec(k), group.joint(k));
      group.store(s, count, indexOf);
      __syncthreads();
    }
  });
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The barrier of several GPUs of one process: after stores into the tables of others a kernel raises a flag
/// at each and waits for theirs. Barriers are counted on the device, so that a captured graph may hold them.
#include "backend/cuda/kernels.cuh"
#include "backend/peers/peer_data.h"

namespace rubble::RUBBLE_CORE {

/// Flags of one device, in its memory, and where those of others are.
struct PeerSignals {
  int rank, ranks;
  unsigned* epoch;           ///< barriers so far
  unsigned* arrived;         ///< blocks of this kernel that have stored; 0 between kernels
  unsigned* flag;            ///< [ranks] barriers that others have reached
  unsigned* of[kMostPeers];  ///< `flag` of each device
  unsigned long long limit;  ///< longest wait [ns]
  /// Some GPU has several ranks: ranks wait for one another on the host, for kernels of one that wait could
  /// keep those of another from running.
  bool shared;
};

__device__ inline unsigned long long nanoseconds() {
  unsigned long long now;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(now));
  return now;
}
__device__ inline void raiseFlag(unsigned* flag, unsigned value) {
  asm volatile("st.release.sys.global.u32 [%0], %1;" ::"l"(flag), "r"(value) : "memory");
}
__device__ inline unsigned readFlag(const unsigned* flag) {
  unsigned value;
  asm volatile("ld.acquire.sys.global.u32 %0, [%1];" : "=r"(value) : "l"(flag) : "memory");
  return value;
}

/// The barrier, by one block: all that this device has stored comes before the flags. A device that does not
/// answer in time stops the step.
__device__ inline void meetPeers(const PeerSignals& g, Control* control) {
  __threadfence_system();
  if (g.shared) return;
  const int r = static_cast<int>(threadIdx.x);
  const unsigned epoch = *g.epoch + 1;
  if (r < g.ranks && r != g.rank) {
    raiseFlag(g.of[r] + g.rank, epoch);
    const unsigned long long begin = nanoseconds();
    while (static_cast<int>(readFlag(g.flag + r) - epoch) < 0)
      if (nanoseconds() - begin > g.limit) {
        lack(control, 0, kLostPeer, r);
        break;
      }
  }
  __syncthreads();
  if (r == 0) *g.epoch = epoch;
}

/// The same at the end of a kernel that stores: by its last block that has done so.
__device__ inline void meetAfterStores(const PeerSignals& g, Control* control) {
  __threadfence_system();
  __shared__ bool last;
  __syncthreads();
  if (threadIdx.x == 0) last = atomicAdd(g.arrived, 1u) + 1 == gridDim.x;
  __syncthreads();
  if (!last) return;
  if (threadIdx.x == 0) *g.arrived = 0;
  meetPeers(g, control);
}

}  // namespace rubble::RUBBLE_CORE

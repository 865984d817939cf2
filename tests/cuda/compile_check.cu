// Compiled, never run: nvcc must take every header that host and device share, without a warning.
#include <rubble/math.h>

#include "core_headers.h"

namespace rubble {

__global__ void rotateAll(QuatT<float> q, const Vec3T<float>* in, Vec3T<float>* out, int count) {
  const int i = int(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) out[i] = rotate(q, in[i]);
}

}  // namespace rubble

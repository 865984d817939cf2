#pragma once
/// Where the arrays of a world (rubble/arrays.h) are, and the CUDA stream that writes them.
#include <cstdint>

namespace rubble {

struct DeviceStream {
  int device = -1;            ///< number of the CUDA device; -1: arrays are in host memory
  std::uintptr_t stream = 0;  ///< on which the engine works, as ArrayView::stream; 0 in host memory
};

}  // namespace rubble

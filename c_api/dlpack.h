#pragma once
/// The structs of DLPack 0.8 (https://dmlc.github.io/dlpack), the exchange format of array libraries.
#include <cstdint>
#include <memory>

#include <rubble/arrays.h>

namespace rubble::c::dlpack {

enum DeviceType : std::int32_t { kCpu = 1, kCuda = 2 };
enum TypeCode : std::uint8_t { kInt = 0, kFloat = 2 };

struct Device {
  std::int32_t type, id;
};

struct Type {
  std::uint8_t code, bits;
  std::uint16_t lanes;
};

struct Tensor {
  void* data;
  Device device;
  std::int32_t dimensions;
  Type type;
  std::int64_t* shape;
  std::int64_t* strides;  ///< in elements
  std::uint64_t byteOffset;
};

struct ManagedTensor {
  Tensor tensor;
  void* context;
  void (*deleter)(ManagedTensor*);
};

/// An array as a tensor, which keeps `owner` and then `reader` until its deleter is called. `device`: number
/// of the CUDA device, unless the array is in host memory.
ManagedTensor* tensorOf(const ArrayView& array, int device, std::shared_ptr<const void> owner,
                        std::shared_ptr<void> reader);

/// The same, for a reader on a stream. `owner`: a World or Worlds that has the array.
template <class Owner>
ManagedTensor* tensorOn(const std::shared_ptr<Owner>& owner, const ArrayView& array, std::uint64_t stream) {
  return tensorOf(array, owner->deviceStream().device, owner,
                  array.device ? owner->addReader(static_cast<std::uintptr_t>(stream)) : nullptr);
}

}  // namespace rubble::c::dlpack

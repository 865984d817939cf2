#include "c_api/dlpack.h"

#include <utility>

#include <rubble/c/world.h>
#include <rubble/error.h>

namespace rubble::c::dlpack {

namespace {

/// A tensor and what it points to.
struct OwnedTensor {
  ManagedTensor managed;
  std::int64_t shape[2], strides[2];
  std::shared_ptr<const void> owner;
  std::shared_ptr<void> reader;

  static void destroy(ManagedTensor* tensor) { delete static_cast<OwnedTensor*>(tensor->context); }
};

}  // namespace

ManagedTensor* tensorOf(const ArrayView& array, int device, std::shared_ptr<const void> owner,
                        std::shared_ptr<void> reader) {
  const std::int64_t size = array.typestr[2] - '0';
  auto out = std::make_unique<OwnedTensor>();
  out->owner = std::move(owner), out->reader = std::move(reader);
  for (int k = 0; k < 2; ++k) {
    if (array.strides[k] % size != 0) throw Error("array", "strides of whole numbers", "others");
    out->shape[k] = array.shape[k], out->strides[k] = array.strides[k] / size;
  }
  const std::uint8_t code = array.typestr[1] == 'i' ? kInt : kFloat;
  out->managed.tensor = {const_cast<void*>(array.data),
                         {array.device ? kCuda : kCpu, array.device ? device : 0},
                         2,
                         {code, static_cast<std::uint8_t>(8 * size), 1},
                         out->shape,
                         out->strides,
                         0};
  out->managed.context = out.get();
  out->managed.deleter = OwnedTensor::destroy;
  return &out.release()->managed;
}

}  // namespace rubble::c::dlpack

extern "C" void rb_dlpack_delete(void* tensor) {
  auto* const managed = static_cast<rubble::c::dlpack::ManagedTensor*>(tensor);
  if (managed && managed->deleter) managed->deleter(managed);
}

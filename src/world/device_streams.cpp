/// Streams that read the arrays of worlds.
#include "backend/device_arrays.h"
#include "world/worlds_impl.h"

namespace rubble {

namespace {

DeviceStream streamOf(const DeviceArrays* arrays) { return arrays ? arrays->deviceStream() : DeviceStream{}; }

std::shared_ptr<void> readerOf(DeviceArrays* arrays, std::uintptr_t stream) {
  return arrays && stream != 0 ? arrays->addReader(stream) : nullptr;
}

}  // namespace

DeviceStream World::deviceStream() const { return streamOf(impl_->engine->deviceArrays()); }

std::shared_ptr<void> World::addReader(std::uintptr_t stream) const {
  return withMemory("addReader", [&] { return readerOf(impl_->engine->deviceArrays(), stream); });
}

DeviceStream Worlds::deviceStream() const {
  return impl_->batches.empty() ? DeviceStream{} : streamOf(impl_->batches[0]->engine().deviceArrays());
}

std::shared_ptr<void> Worlds::addReader(std::uintptr_t stream) const {
  if (impl_->batches.empty()) return nullptr;
  return withMemory("addReader",
                    [&] { return readerOf(impl_->batches[0]->engine().deviceArrays(), stream); });
}

}  // namespace rubble

#pragma once
/// Arrays of an engine in the memory of a device, and the streams that read them.
#include <cstdint>
#include <memory>

#include <rubble/streams.h>

namespace rubble {

class DeviceArrays {
 public:
  virtual ~DeviceArrays() = default;
  virtual DeviceStream deviceStream() const = 0;
  /// As World::addReader, for a stream other than 0.
  virtual std::shared_ptr<void> addReader(std::uintptr_t stream) = 0;
};

}  // namespace rubble

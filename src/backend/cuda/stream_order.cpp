#include "backend/cuda/stream_order.h"

#include <algorithm>

namespace rubble {

namespace {

/// Makes a device the current one of this thread, for as long as it exists. Handles of default streams are
/// those of the current device, and events belong to it.
class OnDevice {
 public:
  explicit OnDevice(int device) {
    checkCuda(cudaGetDevice(&before_), "cudaGetDevice");
    if (before_ != device) checkCuda(cudaSetDevice(device), "cudaSetDevice");
  }
  ~OnDevice() { cudaSetDevice(before_); }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;

 private:
  int before_ = 0;
};

bool isCapturing(cudaStream_t stream) {
  cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
  return cudaStreamIsCapturing(stream, &status) != cudaSuccess || status != cudaStreamCaptureStatusNone;
}

}  // namespace

StreamOrder::StreamOrder(cudaStream_t own) : own_(own) {
  checkCuda(cudaGetDevice(&device_), "cudaGetDevice");
}

/// The reader of a stream, or an unused one.
StreamOrder::Reader& StreamOrder::Readers::at(cudaStream_t stream) {
  const auto find = [&](auto&& fits) {
    const auto found = std::ranges::find_if(list, [&](const auto& reader) { return fits(*reader); });
    return found == list.end() ? nullptr : found->get();
  };
  if (Reader* const same = find([&](const Reader& r) { return r.stream == stream; })) return *same;
  if (Reader* const unused = find([](const Reader& r) { return r.uses == 0 && !r.pending; })) return *unused;
  return *list.emplace_back(std::make_unique<Reader>());
}

/// The last use may end while the stream still reads, so its end is recorded now: later the stream may not
/// exist. What a stream that is being captured reads is the matter of those who launch the graph.
void StreamOrder::Readers::end(Reader& reader) noexcept {
  const std::lock_guard lock(mutex);
  if (--reader.uses > 0) return;
  reader.pending = !isCapturing(reader.stream) && reader.done.tryRecord(reader.stream);
  if (!reader.pending) cudaGetLastError();
}

std::shared_ptr<void> StreamOrder::addReader(cudaStream_t stream) {
  const OnDevice here(device_);
  auto use = std::make_shared<Use>(readers_);
  const std::lock_guard lock(readers_->mutex);
  Reader& reader = readers_->at(stream);
  ready_.record(own_);
  ready_.holdBack(stream);
  // of an earlier stream, which may have had the same handle
  if (std::exchange(reader.pending, false)) reader.done.holdBack(own_);
  reader.stream = stream;
  ++reader.uses;
  use->reader = &reader;
  // the handles of default streams mean others in the thread that ends the use
  if (stream == cudaStreamLegacy && !legacy_) legacy_ = use;
  if (stream == cudaStreamPerThread && !perThread_) perThread_ = use;
  return use;
}

void StreamOrder::beginWriting() {
  if (writings_ == 0) {
    const std::lock_guard lock(readers_->mutex);
    for (const std::unique_ptr<Reader>& reader : readers_->list) {
      if (reader->uses > 0) reader->done.record(reader->stream);
      if (reader->uses > 0 || std::exchange(reader->pending, false)) reader->done.holdBack(own_);
    }
  }
  ++writings_;
}

/// A stream that no longer exists is reported by the next beginWriting().
void StreamOrder::endWriting() noexcept {
  if (--writings_ > 0) return;
  const std::lock_guard lock(readers_->mutex);
  bool recorded = false;
  for (const std::unique_ptr<Reader>& reader : readers_->list) {
    if (reader->uses == 0) continue;
    if (!recorded && !(recorded = ready_.tryRecord(own_))) break;
    if (!ready_.tryHoldBack(reader->stream)) cudaGetLastError();
  }
}

bool StreamOrder::isOrdered(cudaStream_t stream) const {
  if (!stream || stream == own_) return true;
  const std::lock_guard lock(readers_->mutex);
  return std::ranges::any_of(
      readers_->list, [&](const auto& reader) { return reader->uses > 0 && reader->stream == stream; });
}

void StreamOrder::follow(std::uintptr_t stream) {
  const auto handle = reinterpret_cast<cudaStream_t>(stream);
  if (isOrdered(handle)) return;
  given_.record(handle);
  given_.holdBack(own_);
}

void StreamOrder::lead(std::uintptr_t stream) {
  const auto handle = reinterpret_cast<cudaStream_t>(stream);
  if (isOrdered(handle)) return;
  given_.record(own_);
  given_.holdBack(handle);
}

}  // namespace rubble

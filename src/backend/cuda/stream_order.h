#pragma once
/// Orders the stream of an engine and the streams that read its arrays, by events. Nothing waits on the host.
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "backend/cuda/device_memory.h"

namespace rubble {

/// Readers are the legacy default stream, from the first array that was handed out on, and the streams of
/// addReader(). What the engine writes comes after their work so far, and before their later work.
class StreamOrder {
 public:
  /// `own`: stream of the engine, on the current device.
  explicit StreamOrder(cudaStream_t own);
  StreamOrder(const StreamOrder&) = delete;
  StreamOrder& operator=(const StreamOrder&) = delete;

  int device() const { return device_; }
  /// Adds the legacy default stream to the readers. Call with each array that is handed out.
  void handOut() {
    if (!legacy_) addReader(cudaStreamLegacy);
  }
  /// Adds a reader, which stays one while the result exists. The result may end in any thread, also after the
  /// engine. The stream must exist until then. Default streams stay readers.
  std::shared_ptr<void> addReader(cudaStream_t stream);

  /// Encloses work of the engine that writes arrays. Those inside of another do nothing.
  class Writing {
   public:
    explicit Writing(StreamOrder& order) : order_(order) { order_.beginWriting(); }
    ~Writing() { order_.endWriting(); }
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;

   private:
    StreamOrder& order_;
  };

  // Inside of Writing: memory of a caller that `stream` (as ArrayView::stream) uses before and after.
  /// Later work of the engine waits for the stream.
  void follow(std::uintptr_t stream);
  /// Later work of the stream waits for the engine.
  void lead(std::uintptr_t stream);

 private:
  struct Reader {
    cudaStream_t stream = nullptr;
    int uses = 0;          ///< 0: it has ended
    bool pending = false;  ///< the engine has not been ordered behind `done` yet
    StreamEvent done;      ///< end of the work that may read
  };
  /// Shared with uses, which end in any thread.
  struct Readers {
    std::mutex mutex;
    std::vector<std::unique_ptr<Reader>> list;

    Reader& at(cudaStream_t stream);
    void end(Reader& reader) noexcept;
  };

  /// The result of addReader().
  struct Use {
    explicit Use(std::shared_ptr<Readers> all) : readers(std::move(all)) {}
    ~Use() {
      if (reader) readers->end(*reader);
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

    std::shared_ptr<Readers> readers;
    Reader* reader = nullptr;
  };

  void beginWriting();
  void endWriting() noexcept;
  /// Whether Writing orders the engine and this stream, or nothing is to be ordered.
  bool isOrdered(cudaStream_t stream) const;

  cudaStream_t own_;
  int device_ = 0;
  int writings_ = 0;  ///< Writing that exist
  StreamEvent ready_, given_;
  std::shared_ptr<Readers> readers_ = std::make_shared<Readers>();
  std::shared_ptr<void> legacy_, perThread_;
};

}  // namespace rubble

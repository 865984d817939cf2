#include "platform/drop_behind.h"

#include <condition_variable>
#include <mutex>
#include <thread>

#if defined(__linux__)
#include <fcntl.h>
#include <unistd.h>
#endif

namespace rubble::platform {

#if defined(__linux__)

namespace {

/// A window is stored at once, and taken from the cache after as many bytes again as the disk may be behind.
constexpr std::uint64_t kWindow = 8u << 20, kBehind = 64u << 20;

}  // namespace

struct DropBehind::Worker {
  int descriptor;
  std::mutex mutex;
  std::condition_variable changed;
  std::uint64_t end = 0;  ///< of what was written
  bool isOver = false;
  std::thread thread;

  explicit Worker(const std::filesystem::path& file)
      : descriptor(open(file.c_str(), O_RDONLY | O_CLOEXEC)), thread([this] { run(); }) {}
  ~Worker() {
    {
      const std::lock_guard lock(mutex);
      isOver = true;
    }
    changed.notify_one();
    thread.join();
    if (descriptor >= 0) close(descriptor);
  }

  void run() {
    for (std::uint64_t begin = 0;; begin += kWindow) {
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return isOver || end - begin >= kWindow; });
        if (isOver) return;
      }
      sync_file_range(descriptor, static_cast<off_t>(begin), kWindow, SYNC_FILE_RANGE_WRITE);
      // Pages that are not stored yet stay, so each is asked for more than once.
      if (begin >= 2 * kBehind)
        posix_fadvise(descriptor, static_cast<off_t>(begin - 2 * kBehind), kBehind, POSIX_FADV_DONTNEED);
    }
  }
};

DropBehind::DropBehind(const std::filesystem::path& file) : file_(file) {}
DropBehind::~DropBehind() = default;

void DropBehind::written(std::uint64_t end) {
  if (end < kWindow || file_.empty()) return;
  if (!worker_) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(file_, none)) {
      file_.clear();
      return;
    }
    worker_ = std::make_unique<Worker>(file_);
  }
  bool isWindow;
  {
    const std::lock_guard lock(worker_->mutex);
    isWindow = worker_->end / kWindow != end / kWindow;
    worker_->end = end;
  }
  if (isWindow) worker_->changed.notify_one();
}

#else

struct DropBehind::Worker {};
DropBehind::DropBehind(const std::filesystem::path& file) : file_(file) {}
DropBehind::~DropBehind() = default;
void DropBehind::written(std::uint64_t) {}

#endif

}  // namespace rubble::platform

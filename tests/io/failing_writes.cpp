#include "tests/io/failing_writes.h"

#include <atomic>
#include <cerrno>
#include <limits>

#include "tests/support/sanitizer.h"

#if defined(__linux__) && !defined(RUBBLE_HAS_SANITIZER) && !defined(RUBBLE_HAS_THREAD_SANITIZER)
#define RUBBLE_WRITES_FAIL 1
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>
#endif

namespace {

constexpr long kNeverFails = std::numeric_limits<long>::max();
std::atomic<long> writesLeft{kNeverFails};
std::atomic<bool> writesFailOn{false}, writeFailed{false};
/// A write that failed was written in part.
std::atomic<bool> cutsNext{false};

}  // namespace

#if defined(RUBBLE_WRITES_FAIL)
namespace {

enum class Fate { Whole, Half, None };

Fate fateOfWrite(int file) {
  constexpr int kLastOfConsole = 2;
  if (file <= kLastOfConsole || writesLeft == kNeverFails) return Fate::Whole;
  if (cutsNext.exchange(false)) return Fate::None;
  const long left = writesLeft.fetch_sub(1);
  if (left > 0 || (left < 0 && !writesFailOn)) return Fate::Whole;
  writeFailed = true;
  // what is left of it fails next
  if (left == 0) cutsNext = true;
  return left == 0 ? Fate::Half : Fate::None;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) ssize_t write(int file, const void* bytes, size_t count) {
  const Fate fate = fateOfWrite(file);
  if (fate == Fate::None || (fate == Fate::Half && count < 2)) {
    if (fate == Fate::Half) cutsNext = false;
    errno = ENOSPC;
    return -1;
  }
  return syscall(SYS_write, file, bytes, fate == Fate::Half ? count / 2 : count);
}
extern "C" __attribute__((visibility("default"))) ssize_t writev(int file, const iovec* parts, int count) {
  const Fate fate = fateOfWrite(file);
  if (fate == Fate::Half && parts[0].iov_len > 1)
    return syscall(SYS_write, file, parts[0].iov_base, parts[0].iov_len / 2);
  if (fate == Fate::Whole) return syscall(SYS_writev, file, parts, count);
  cutsNext = false;
  errno = ENOSPC;
  return -1;
}
#endif

namespace rubble::test {

FailingWrites::FailingWrites(long first, bool lasting) {
  writeFailed = cutsNext = false, writesFailOn = lasting, writesLeft = first;
}
FailingWrites::~FailingWrites() { writesLeft = kNeverFails, cutsNext = false; }
bool FailingWrites::hasFailed() const { return writeFailed; }

#if defined(RUBBLE_WRITES_FAIL)
bool writesFail() { return true; }
#else
bool writesFail() { return false; }
#endif

}  // namespace rubble::test

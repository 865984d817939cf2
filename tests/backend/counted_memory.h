#pragma once
/// Every `new` of the program, and every calloc (of tables), is counted, and can be made to fail.
namespace rubble::test {

/// False with the sanitizer of threads: nothing is counted then, and nothing fails.
bool countsAllocations();
/// Allocations of all threads so far.
long allocations();

/// While it lives, allocations of this thread fail: the `first`-th from now on (from 0), and with `lasting`
/// all after it.
class FailingMemory {
 public:
  FailingMemory(long first, bool lasting);
  ~FailingMemory();
  FailingMemory(const FailingMemory&) = delete;
  FailingMemory& operator=(const FailingMemory&) = delete;
  /// Has any failed?
  bool hasFailed() const;
};

/// The same for all other threads, together. One at a time.
class FailingMemoryOfOthers {
 public:
  FailingMemoryOfOthers(long first, bool lasting);
  ~FailingMemoryOfOthers();
  FailingMemoryOfOthers(const FailingMemoryOfOthers&) = delete;
  FailingMemoryOfOthers& operator=(const FailingMemoryOfOthers&) = delete;
  bool hasFailed() const;
};

}  // namespace rubble::test

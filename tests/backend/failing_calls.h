#pragma once
/// Calls whose allocations fail, one after another.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include <new>

#include "tests/backend/counted_memory.h"

namespace rubble::test {

inline constexpr long kMostAllocations = 10000;

/// Calls try_(k) for every allocation that can fail, until one call of it needs fewer.
template <class Try> void forEachAllocation(const char* name, Try&& try_) {
  long k = 0;
  while (k < kMostAllocations && try_(k)) ++k;
  ASSERT_LT(k, kMostAllocations) << name;
}

enum class Outcome {
  Whole,       ///< it needed no more allocations than that
  WithoutIt,   ///< one failed, and it found another way
  OutOfMemory  ///< it threw
};

/// A call without its k-th allocation, in this thread or (FailingMemoryOfOthers) in all others.
template <class Failing = FailingMemory, class Call>
Outcome outcomeWithout(long k, bool lasting, const char* name, Call&& call) {
  const Failing failing(k, lasting);
  try {
    call();
    return failing.hasFailed() ? Outcome::WithoutIt : Outcome::Whole;
  } catch (const OutOfMemory&) {
    EXPECT_TRUE(failing.hasFailed()) << name << " " << k;
  } catch (const std::bad_alloc&) {
    EXPECT_TRUE(lasting) << name << " " << k << ": there was memory for an Error";
  }
  return Outcome::OutOfMemory;
}

}  // namespace rubble::test

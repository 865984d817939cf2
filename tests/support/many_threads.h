#pragma once
#if defined(RUBBLE_HAS_TBB)
#include <tbb/global_control.h>
#endif

namespace rubble::test {

/// While it lives, `count` threads of a test are threads on a machine of fewer cores too. Builds without
/// oneTBB need none.
class ManyThreads {
 public:
#if defined(RUBBLE_HAS_TBB)
  explicit ManyThreads(int count)
      : control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)) {}

 private:
  tbb::global_control control_;
#else
  explicit ManyThreads(int) {}
#endif
};

}  // namespace rubble::test

#pragma once
/// Parallel loops of a world, on threads of the library or of the host.
#include <algorithm>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <rubble/tasks.h>

namespace rubble {

/// Calls f(begin, end) for ranges that make up [0, n), on the tasks of the host.
template <class F> void forEachPart(const TaskSystem& tasks, int n, int grain, F&& f) {
  struct Loop {
    F& f;
    int n, parts;
    int begin(int part) const { return static_cast<int>(static_cast<long long>(n) * part / parts); }
  } loop{f, n, std::max(1, std::min(tasks.parts, (n + grain - 1) / grain))};
  const auto part = [](void* context, int k) {
    const Loop& own = *static_cast<Loop*>(context);
    own.f(own.begin(k), own.begin(k + 1));
  };
  if (loop.parts == 1) return f(0, n);
  tasks.run(loop.parts, part, &loop);
}

/// Calls f(begin, end) for ranges that make up [0, n), none below `grain` but a single one.
template <class F> void forEachRange(const TaskSystem& tasks, int n, int grain, F&& f) {
  if (tasks.run) return forEachPart(tasks, n, grain, f);
  tbb::parallel_for(tbb::blocked_range<int>(0, n, static_cast<std::size_t>(grain)),
                    [&](const tbb::blocked_range<int>& range) { f(range.begin(), range.end()); });
}

}  // namespace rubble

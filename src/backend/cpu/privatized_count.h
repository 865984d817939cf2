#pragma once
/// Kernels in which all elements increment the same few counters. Each task counts its range privately and
/// then adds the sums to the shared counters, which avoids contention.
#include <algorithm>

#include "stages/bodies/coloring.h"
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// `InParts<Kernel>::run(s, kernel, begin, end)` is equivalent to the kernel for the indices of [begin, end).
/// The primary template is empty: no such version.
template <class Kernel> struct InParts {};

/// Colors below this number are counted privately. Elements of higher colors are rare and handled one by one.
inline constexpr int kCountedColors = 128;

/// Calls count(color) once per element of a low color and other(i, color) for elements of higher colors.
/// Elements with colorOf(i) < 0 are skipped.
template <class ColorOf, class Count, class Other>
void visitColors(int begin, int end, ColorOf&& colorOf, Count&& count, Other&& other) {
  for (int i = begin; i < end; ++i) {
    const int color = colorOf(i);
    if (color >= kCountedColors)
      other(i, color);
    else if (color >= 0)
      count(i, color);
  }
}
template <class ColorOf> void addColors(int begin, int end, ColorOf&& colorOf, int* total) {
  int own[kCountedColors] = {};
  visitColors(
      begin, end, colorOf, [&](int, int c) { ++own[c]; }, [&](int, int c) { atomicCount(&total[c], 1); });
  for (int c = 0; c < kCountedColors; ++c)
    if (own[c] > 0) atomicCount(&total[c], own[c]);
}
/// `left`: number of elements of each color that are not placed yet.
template <class ColorOf>
void listColors(int begin, int end, ColorOf&& colorOf, const int* offset, int* left, int* list) {
  int place[kCountedColors] = {};
  visitColors(
      begin, end, colorOf, [&](int, int c) { ++place[c]; },
      [&](int i, int c) { list[offset[c] + atomicCount(&left[c], -1) - 1] = i; });
  for (int c = 0; c < kCountedColors; ++c)
    if (const int own = place[c]; own > 0) place[c] = offset[c] + atomicCount(&left[c], -own) - own;
  visitColors(
      begin, end, colorOf, [&](int i, int c) { list[place[c]++] = i; }, [](int, int) {});
}

inline auto sweptColor(const SolverData& s) {
  return [&s](int i) { return isSwept(s, i) ? s.color[i] : -1; };
}
inline auto sweptVertexColor(const SolverData& s) {
  return [&s](int v) { return isDynamicVertex(s, v) ? s.vertexColor[v] : -1; };
}
template <> struct InParts<CountColors> {
  static void run(const SolverData& s, const CountColors&, int begin, int end) {
    addColors(begin, end, sweptColor(s), s.colorCount);
  }
};
template <> struct InParts<CountVertexColors> {
  static void run(const SolverData& s, const CountVertexColors&, int begin, int end) {
    addColors(begin, end, sweptVertexColor(s), s.vertexColorCount);
  }
};
template <> struct InParts<FillColors> {
  static void run(const SolverData& s, const FillColors&, int begin, int end) {
    listColors(begin, end, sweptColor(s), s.colorOffset, s.colorCount, s.colorBody);
  }
};
template <> struct InParts<FillVertexColors> {
  static void run(const SolverData& s, const FillVertexColors&, int begin, int end) {
    listColors(begin, end, sweptVertexColor(s), s.vertexColorOffset, s.vertexColorCount, s.colorVertex);
  }
};

/// Nearly every pair of a pile counts its contacts.
template <> struct InParts<TestPairs> {
  static void run(const SolverData& s, const TestPairs&, int begin, int end) {
    ManifoldCount sum;
    for (int i = begin; i < end; ++i) sum += TestPairs::take(s, i);
    addToCounters(s, sum);
  }
};
/// In a smash most pairs are appended to `tested`: so many at once, which fill 1 KB of the stack.
inline constexpr int kAppended = 256;
template <class L> struct InParts<RecycleManifolds<L>> {
  static void run(const SolverData& s, const RecycleManifolds<L>&, int begin, int end) {
    ManifoldCount sum;
    int tested[kAppended], count = 0;
    const auto append = [&] {
      if (count > 0) std::copy_n(tested, count, &s.tested[atomicCount(&s.counters->tested, count)]);
      count = 0;
    };
    for (int i = begin; i < end; ++i) {
      ManifoldCount own;
      if (RecycleManifolds<L>::reuses(s, i, own)) {
        sum += own;
        continue;
      }
      if (count == kAppended) append();
      tested[count++] = i;
    }
    append();
    addToCounters(s, sum);
  }
};

/// Nodes with consecutive indices often have the same root.
template <> struct InParts<FlattenAggregates> {
  static void run(const SolverData& s, const FlattenAggregates& kernel, int begin, int end) {
    int leader = -1, count = 0;
    const auto tell = [&] {
      if (count > 0) atomicCount(&s.nodeCount[atLevel(s, kernel.level, leader)], count);
      count = 0;
    };
    for (int i = begin; i < end; ++i) {
      const int own = flatten(s, kernel.level, i);
      if (own != leader) tell();
      leader = own;
      if (mayJoin(s, i)) ++count;
    }
    tell();
  }
};

}  // namespace rubble::RUBBLE_CORE

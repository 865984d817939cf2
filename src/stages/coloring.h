#pragma once
/// Colours: dynamic bodies that share a row block have different ones, so that a colour can be solved in parallel. Incremental
/// Jones-Plassmann with hashed priorities: colours are kept from step to step, and only bodies that clash choose anew.
#include "stages/incidence.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline bool outranks(int a, int b) {
  const std::uint32_t ha = hash32(static_cast<std::uint32_t>(a)), hb = hash32(static_cast<std::uint32_t>(b));
  return ha != hb ? ha > hb : a > b;
}

/// Smallest colour that no neighbour of body i has.
RUBBLE_HD inline int smallestFreeColor(const View& s, int i) {
  const int begin = s.entryOffset[i], end = s.entryOffset[i + 1];
  for (int base = 0;; base += 64) {
    std::uint64_t used = 0;
    for (int k = begin; k < end; ++k) {
      if (s.entry[k].other < 0) continue;
      const int c = s.color[s.entry[k].other] - base;
      if (c >= 0 && c < 64) used |= std::uint64_t{1} << c;
    }
    if (~used == 0) continue;
    int c = 0;
    while (used >> c & 1) ++c;
    return base + c;
  }
}

/// Does body i share a colour with a neighbour of higher rank? Then it is to take `next`.
RUBBLE_HD inline bool clashes(const View& s, int i, int& next) {
  const int own = s.color[i];
  for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) {
    const int other = s.entry[k].other;
    if (other < 0 || s.color[other] != own || !outranks(other, i)) continue;
    next = smallestFreeColor(s, i);
    return true;
  }
  return false;
}

/// The bodies that clash, and what they choose. Only these can clash later: a choice avoids the colours of all neighbours that keep theirs.
struct FindClashes {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!isDynamic(s, i)) return;
    if (!clashes(s, i, s.nextColor[i])) {
      raiseColors(s, s.color[i]);
      return;
    }
    s.clashing[atomicCount(&s.counters->clashing, 1)] = i;
    atomicCount(&s.counters->clashes, 1);
  }
  RUBBLE_HD static void raiseColors(const View& s, int color) {
    // most bodies find it high enough
    if (s.counters->colors <= color) atomicRaise(&s.counters->colors, color + 1);
  }
};

/// One round: those that clashed take their choice, and choose again if a neighbour has made the same. Reads `color`, writes `nextColor`, so
/// that the order inside a round is of no consequence.
struct TakeColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int k) const {
    const int i = s.clashing[k];
    s.color[i] = s.nextColor[i];
    FindClashes::raiseColors(s, s.color[i]);
  }
};
struct ProposeColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int k) const {
    const int i = s.clashing[k];
    if (clashes(s, i, s.nextColor[i])) atomicCount(&s.counters->clashes, 1);
  }
};

/// Population of each colour.
struct CountColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (isDynamic(s, i)) atomicCount(&s.colorCount[s.color[i]], 1);
  }
};

/// Bodies by colour. The order inside a colour has no influence on results: its bodies share nothing.
struct FillColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!isDynamic(s, i)) return;
    const int color = s.color[i];
    s.colorBody[s.colorOffset[color] + atomicCount(&s.colorCount[color], -1) - 1] = i;
  }
};

}  // namespace rubble::RUBBLE_CORE

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

/// One round: a body that clashes with a neighbour of higher rank chooses anew. Reads `color`, writes `nextColor`.
struct ProposeColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const int own = s.color[i];
    int next = own;
    if (s.params[i].kind == BodyKind::Dynamic) {
      for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) {
        const int other = s.entry[k].other;
        if (other < 0 || s.color[other] != own || !outranks(other, i)) continue;
        atomicCount(&s.counters->clashes, 1);
        next = smallestFreeColor(s, i);
        break;
      }
    }
    s.nextColor[i] = next;
  }
};

struct TakeColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    s.color[i] = s.nextColor[i];
    if (s.params[i].kind == BodyKind::Dynamic) atomicRaise(&s.counters->colors, s.color[i] + 1);
  }
};

/// Population of each colour.
struct CountColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.params[i].kind == BodyKind::Dynamic) atomicCount(&s.colorCount[s.color[i]], 1);
  }
};

/// Bodies by colour. The order inside a colour has no influence on results: its bodies share nothing.
struct FillColors {
  static constexpr const char* kName = "coloring";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.params[i].kind != BodyKind::Dynamic) return;
    const int color = s.color[i];
    s.colorBody[s.colorOffset[color] + atomicCount(&s.colorCount[color], -1) - 1] = i;
  }
};

}  // namespace rubble::RUBBLE_CORE

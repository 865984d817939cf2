#pragma once
/// Sets that are united in parallel: a forest whose roots lead themselves.
#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int findLeader(const int* leader, int i) {
  while (leader[i] != i) i = leader[i];
  return i;
}

/// Unites the sets of a and b; the lower leader leads, so the result does not depend on the order of unions.
RUBBLE_HD inline void unite(int* leader, int a, int b) {
  for (;;) {
    a = findLeader(leader, a), b = findLeader(leader, b);
    if (a == b) return;
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (atomicClaim(&leader[high], high, low) == high) return;
  }
}

}  // namespace rubble::RUBBLE_CORE

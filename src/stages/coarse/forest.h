#pragma once
/// Parallel union-find: disjoint sets as a forest in which a root is its own parent.
#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Other threads may unite sets meanwhile: each parent that is read has been one.
RUBBLE_HD inline int findRoot(const int* root, int i) {
  for (;;) {
    const int parent = atomicLoad(&root[i]);
    if (parent == i) return i;
    i = parent;
  }
}

/// Unites the sets of a and b. The lower root wins, so the result does not depend on the order of unions.
RUBBLE_HD inline void unite(int* root, int a, int b) {
  for (;;) {
    a = findRoot(root, a), b = findRoot(root, b);
    if (a == b) return;
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (atomicClaim(&root[high], high, low) == high) return;
  }
}

}  // namespace rubble::RUBBLE_CORE

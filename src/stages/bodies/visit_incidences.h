#pragma once
/// A loop over the constraints of a body.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// visit(incidence) for those of a body, in their order. A device asks for several at a time: a body with a
/// hundred contacts would hold up all others if each waited for the one before.
template <class Visit> RUBBLE_HD void visitIncidences(const SolverData& s, int body, Visit&& visit) {
  const int begin = s.incidenceOffset[body], end = s.incidenceOffset[body + 1];
#if RUBBLE_DEVICE_CODE
  constexpr int kAhead = 4;
#else
  constexpr int kAhead = 1;
#endif
  for (int k = begin; k < end; k += kAhead) {
    Incidence some[kAhead];
    RUBBLE_UNROLL
    for (int j = 0; j < kAhead; ++j) some[j] = s.incidence[min(k + j, end - 1)];
    RUBBLE_UNROLL
    for (int j = 0; j < kAhead; ++j)
      if (k + j < end) visit(some[j]);
  }
}

}  // namespace rubble::RUBBLE_CORE

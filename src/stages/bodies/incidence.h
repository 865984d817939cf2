#pragma once
/// Incidence lists: the constraints of each dynamic body in compressed (CSR) form, sorted by type and index.
#include "stages/bodies/visit_incidences.h"
#include "stages/coarse/aggregates.h"

namespace rubble::RUBBLE_CORE {

template <class Blocks> struct CountIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Blocks::visitIncidences(s, i,
                            [&](int body, std::uint32_t, int) { atomicCount(&s.incidenceCount[body], 1); });
  }
};

/// In no fixed order; SortIncidences follows.
template <class Blocks> struct FillIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Blocks::visitIncidences(s, i, [&](int body, std::uint32_t code, int other) {
      const int slot = s.incidenceOffset[body] + atomicCount(&s.incidenceCount[body], -1) - 1;
      const bool inner = Blocks::kRelative && other >= 0 && s.plan.coarseCorrection;
      s.incidence[slot] = {code, other, inner ? separateLevels(s, body, other) : kCoarseLevels};
    });
  }
};

struct SortIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Incidence* const first = s.incidence + s.incidenceOffset[i];
    const int count = s.incidenceOffset[i + 1] - s.incidenceOffset[i];
    if (count < 2) return;
    // most bodies: sorted in registers
    constexpr int kFew = 8, kInsertion = 24;
    if (count <= kFew) {
      Incidence own[kFew];
      RUBBLE_UNROLL
      for (int k = 0; k < kFew; ++k) own[k] = k < count ? first[k] : Incidence{};
      RUBBLE_UNROLL
      for (int k = 0; k < kFew; ++k) {
        int place = 0;
        RUBBLE_UNROLL
        for (int j = 0; j < kFew; ++j) place += j < count && own[j].code < own[k].code ? 1 : 0;
        if (k < count) first[place] = own[k];
      }
      return;
    }
    if (count <= kInsertion) {
      for (int k = 1; k < count; ++k) {
        const Incidence e = first[k];
        int j = k;
        for (; j > 0 && first[j - 1].code > e.code; --j) first[j] = first[j - 1];
        first[j] = e;
      }
      return;
    }
    // heap sort: in place and without recursion, for the few bodies with many contacts
    const auto sift = [&](int root, int size) {
      for (int child = 2 * root + 1; child < size; child = 2 * root + 1) {
        if (child + 1 < size && first[child].code < first[child + 1].code) ++child;
        if (first[root].code >= first[child].code) return;
        const Incidence e = first[root];
        first[root] = first[child];
        first[child] = e;
        root = child;
      }
    };
    for (int k = count / 2 - 1; k >= 0; --k) sift(k, count);
    for (int k = count - 1; k > 0; --k) {
      const Incidence e = first[0];
      first[0] = first[k];
      first[k] = e;
      sift(0, k);
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

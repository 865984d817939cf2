#pragma once
/// Replaces the contacts and elements of some worlds of a batch on the device. All others keep their bits.
#include <cuda_runtime_api.h>

#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// Contacts of bodies on the device: those of the last step, a copy, or a list of a few worlds.
struct ContactTables {
  const int* pairOffset;  ///< by body
  const Pair* pair;
  const PairTest* test;
  const int* activeOffset;  ///< by pair
  const Manifold* manifold;
  const ContactRows* row;
  const RollingRows* rolling;  ///< one per manifold, or null
};
/// Those of the last step in these tables.
inline ContactTables contactTables(const SolverData& s, bool rolls) {
  return {s.oldPairOffset,
          s.oldPair,
          s.oldPairTest,
          s.oldActivePairOffset,
          s.oldManifold,
          s.contact,
          rolls ? &s.oldRolling[0] : nullptr};
}

/// Numbers of pairs, active pairs and rows.
struct ContactCounts {
  int pairs = 0, active = 0, rows = 0;
};

/// Each world has the contacts of `a` or those of `b`. All pointers are device memory.
struct Splice {
  ContactTables a, b;
  const int* firstInB;    ///< [worlds] first body of the world in `b`; -1: it has those of `a`
  ContactCounts* counts;  ///< [worlds + 1] of each world; after countSplice(): of the worlds before it
};
/// Counts, in the order of the stream. The last element of `counts` receives the sums.
void countSplice(cudaStream_t stream, const SolverData& device, const Splice& splice);
/// Writes the contacts of all worlds to the tables, which have room.
void writeSplice(cudaStream_t stream, const SolverData& device, const Splice& splice);

/// Copies the state of the bodies and joints of paused worlds from a copy of the tables.
void putBackPaused(cudaStream_t stream, const SolverData& device, const SolverData& copy);

}  // namespace rubble::RUBBLE_CORE

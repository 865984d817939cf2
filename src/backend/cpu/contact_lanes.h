#pragma once
/// Contacts of two bodies or slices, or two contacts, in the lanes of registers of eight numbers. Compiled
/// where there are such registers; sums have the order and the bits of the stages.
#include "forces/contact_pair.h"
#include "platform/prefetch.h"
#include "stages/coarse/coarse.h"

#if defined(RUBBLE_HAS_REAL8) && defined(__AVX2__)
#define RUBBLE_EIGHT_LANES 1
#else
#define RUBBLE_EIGHT_LANES 0
#endif

namespace rubble::RUBBLE_CORE {

/// Prefetches the rows of a contact.
RUBBLE_NEAR void fetchContact(const SolverData& s, std::uint32_t code) {
  const auto* const rows = reinterpret_cast<const char*>(&s.contact[constraintIndex(code)]);
  constexpr std::size_t kLine = 64;  // bytes of a cache line
  for (std::size_t k = 0; k < sizeof(ContactRows); k += kLine) prefetch(rows + k);
}

#if RUBBLE_EIGHT_LANES

inline Block6T<Real4> halfOf(const Block6T<Real8>& block, bool high) {
  Block6T<Real4> half;
  const auto* const from = reinterpret_cast<const Real4Aliased*>(&block);
  auto* const to = reinterpret_cast<Real4Aliased*>(&half);
  for (std::size_t k = 0; k < sizeof half / sizeof(Real4); ++k) to[k] = from[2 * k + (high ? 1 : 0)];
  return half;
}

/// Adds the contacts of two bodies or slices to their blocks. next(half, code, shift) takes the next contact
/// of one of them, and leaves `shift` alone if the block is about the center of its body; false: no more.
template <bool shifted, class Next>
void addContacts(const SolverData& s, Next&& next, Block6& low, Block6& high) {
  // no contact: adds zeros, which leave a sum as it is
  static constexpr ContactRows kNone{};
  static constexpr Displacement kStill{};
  Block6T<Real8> sum;
  bool has[2] = {false, false};
  for (;;) {
    ContactPair pair;
    bool onA[2], more[2];
    PaddedVec3 shift[2] = {Vec3{0, 0, 0}, Vec3{0, 0, 0}};
    for (int half = 0; half < 2; ++half) {
      std::uint32_t code = 0;
      more[half] = next(half, code, shift[half]);
      has[half] |= more[half];
      const ContactRows& r = more[half] ? s.contact[constraintIndex(code)] : kNone;
      pair.rows[half] = &r;
      pair.a[half] = more[half] ? &s.dx[r.a] : &kStill, pair.b[half] = more[half] ? &s.dx[r.b] : &kStill;
      onA[half] = constraintSide(code) == 0;
    }
    if (!more[0] && !more[1]) break;
    if constexpr (shifted) {
      const Quad<Real8> both = LaneAccess<Real8>::splatQuad(&shift[0].x, &shift[1].x);
      const Vec3T<Real8> shifts{both.x, both.y, both.z};
      accumulateContacts(s.plan.coneHessian, pair, onA, sum, &shifts);
    } else {
      accumulateContacts(s.plan.coneHessian, pair, onA, sum);
    }
  }
  if (has[0]) addLanes(low, halfOf(sum, false));
  if (has[1]) addLanes(high, halfOf(sum, true));
}

/// Adds the contacts of two bodies, whose incidences are [next, end). Advances `next` to the first joint.
inline void addContactsOfTwo(const SolverData& s, int* next, const int (&end)[2], Block6& low, Block6& high) {
  addContacts<false>(
      s,
      [&](int half, std::uint32_t& code, PaddedVec3&) {
        if (next[half] >= end[half]) return false;
        code = s.incidence[next[half]].code;
        if (constraintType(code) != kContactType) return false;
        ++next[half];
        return true;
      },
      low, high);
}

/// Adds the boundary contacts of two slices.
inline void addBoundaryContactsOfTwo(const SolverData& s, const int* slice, Block6& low, Block6& high) {
  int k[2] = {s.boundaryOffset[slice[0]], s.boundaryOffset[slice[1]]};
  const int end[2] = {s.boundaryOffset[slice[0] + 1], s.boundaryOffset[slice[1] + 1]};
  addContacts<true>(
      s,
      [&](int half, std::uint32_t& code, PaddedVec3& shift) {
        while (k[half] < end[half] && constraintType(s.boundary[k[half]].code) != kContactType) ++k[half];
        if (k[half] >= end[half]) return false;
        const BoundaryConstraint& c = s.boundary[k[half]++];
        const ContactRows& r = s.contact[constraintIndex(c.code)];
        const Aggregate& aggregate = s.aggregate[s.slice[slice[half]].aggregate];
        code = c.code;
        shift = shiftOf(aggregate, c.shift, s.dx[constraintSide(code) == 0 ? r.a : r.b].dp);
        return true;
      },
      low, high);
}

/// The dual update of two contacts.
inline void updateTwoDuals(const SolverData& s, int i, int j) {
  ContactRows &low = s.contact[i], &high = s.contact[j];
  const StepConstants& c = s.stepOf(low.a);
  if (&s.stepOf(high.a) != &c) {
    UpdateContactDuals<Real4>{}(s, i), UpdateContactDuals<Real4>{}(s, j);
    return;
  }
  updateContactDuals(c, low, high,
                     {{&low, &high}, {&s.dx[low.a], &s.dx[high.a]}, {&s.dx[low.b], &s.dx[high.b]}});
}

#endif

}  // namespace rubble::RUBBLE_CORE

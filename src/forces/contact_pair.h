#pragma once
/// Two contacts at once: the points of one in the low half of a Real8, those of the other in the high half.
/// Each half has the bits of contact.h.
#include "forces/contact.h"

#if defined(RUBBLE_HAS_REAL8)

namespace rubble::RUBBLE_CORE {

template <> struct LaneAccess<Real8> {
  static Real8 splat(Real a) { return Real8{a, a, a, a, a, a, a, a}; }
  static Real8 splat(const Real8& a) { return a; }
  /// A number of each contact.
  static Real8 splat(Real low, Real high) {
    return joined(LaneAccess<Real4>::splat(low), LaneAccess<Real4>::splat(high));
  }
  template <class T> static Quad<Real8> loadQuad(const T* low, const T* high) {
    static_assert(sizeof(T) == sizeof(Real4));
    const auto at = [&](int k) { return load(low + k, high + k); };
    return transposed({at(0), at(1), at(2), at(3)});
  }
  template <class T> static void storeQuad(T* low, T* high, const Quad<Real8>& q) {
    const Quad<Real8> v = transposed(q);
    auto *const l = reinterpret_cast<Real4Aliased*>(low), *const h = reinterpret_cast<Real4Aliased*>(high);
    l[0] = lowOf(v.x), l[1] = lowOf(v.y), l[2] = lowOf(v.z), l[3] = lowOf(v.w);
    h[0] = highOf(v.x), h[1] = highOf(v.y), h[2] = highOf(v.z), h[3] = highOf(v.w);
  }
  /// Four numbers of each contact, which lie side by side.
  static Quad<Real8> splatQuad(const Real* low, const Real* high) {
    const Real8 both = load(low, high);
    return {repeated<0>(both), repeated<1>(both), repeated<2>(both), repeated<3>(both)};
  }

 private:
  static Real8 load(const void* low, const void* high) {
    return joined(*static_cast<const Real4Aliased*>(low), *static_cast<const Real4Aliased*>(high));
  }
  static Quad<Real8> transposed(const Quad<Real8>& q) {
    const Real8 a = firstOfBoth(q.x, q.y), b = firstOfBoth(q.z, q.w);
    const Real8 c = lastOfBoth(q.x, q.y), d = lastOfBoth(q.z, q.w);
    return {firstHalves(a, b), lastHalves(a, b), firstHalves(c, d), lastHalves(c, d)};
  }
};

/// Two contacts and the displacements of their bodies.
struct ContactPair {
  const ContactRows* rows[2];
  const Displacement *a[2], *b[2];
};

/// Motion of one body of each contact, as in Displacement.
struct PairDisplacement {
  Vec3T<Real8> dp, dw;
  explicit PairDisplacement(const Displacement* const (&body)[2]) {
    const auto both = [&](const Vec3& low, const Vec3& high) {
      const Quad<Real8> q = LaneAccess<Real8>::splatQuad(&low.x, &high.x);
      return Vec3T<Real8>{q.x, q.y, q.z};
    };
    dp = both(body[0]->dp, body[1]->dp), dw = both(body[0]->dw, body[1]->dw);
  }
};

RUBBLE_NEAR ContactFrame<Real8> contactFrame(const ContactPair& pair) {
  using A = LaneAccess<Real8>;
  const ContactRows &low = *pair.rows[0], &high = *pair.rows[1];
  static_assert(offsetof(ContactRows, most) == offsetof(ContactRows, n) + 3 * sizeof(Real) &&
                offsetof(ContactRows, offset) % (4 * sizeof(Real)) == 0);
  const Quad<Real8> offset = A::splatQuad(&low.offset.x, &high.offset.x);
  return contactFrame<Real8>(A::splatQuad(&low.n.x, &high.n.x), {offset.x, offset.y, offset.z},
                             A::loadQuad(low.place, high.place), A::loadQuad(low.load, high.load),
                             A::loadQuad(low.slip, high.slip));
}

/// accumulateContact() for two contacts; onA: which body of each.
RUBBLE_NEAR void accumulateContacts(bool coneHessian, const ContactPair& pair, const bool (&onA)[2],
                                    Block6T<Real8>& block, const Vec3T<Real8>* shift = nullptr) {
  const ContactFrame<Real8> f = contactFrame(pair);
  const Real8 sign = LaneAccess<Real8>::splat(onA[0] ? Real(-1) : Real(1), onA[1] ? Real(-1) : Real(1));
  const Vec3T<Real8> lever = select(sign < Real8{}, f.rA, f.rB);
  accumulateContact(coneHessian, f, sign, shift ? lever + *shift : lever, PairDisplacement(pair.a),
                    PairDisplacement(pair.b), block, Real(1));
}

/// updateContactDuals() for two contacts of one world.
RUBBLE_NEAR void updateContactDuals(const StepConstants& c, ContactRows& low, ContactRows& high,
                                    const ContactPair& pair) {
  using A = LaneAccess<Real8>;
  const StiffnessRule first = normalRule(c, low), second = normalRule(c, high);
  const StiffnessRuleT<Real8> rule{first.policy, A::splat(first.start, second.start),
                                   A::splat(first.limit, second.limit), A::splat(first.beta, second.beta),
                                   A::splat(first.perLoad, second.perLoad)};
  const ContactDuals<Real8> duals = contactDuals(c, contactFrame(pair), rule,
                                                 A::splat(low.length, high.length), PairDisplacement(pair.a),
                                                 PairDisplacement(pair.b));
  A::storeQuad(low.load, high.load, duals.load);
  A::storeQuad(low.slip, high.slip, duals.slip);
}

}  // namespace rubble::RUBBLE_CORE

#endif

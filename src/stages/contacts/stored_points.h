#pragma once
/// What the points of a contact pass to the next step, and what they support.
#include "collision/manifold.h"
#include "stages/bodies/corrections.h"
#include "stages/contacts/materials.h"
#include "stages/contacts/rolled.h"

namespace rubble::RUBBLE_CORE {

/// Rotations and tangents for storing the points of a contact.
struct StoredFrame {
  Displacement a, b;
  Quat rotationA, rotationB;
  Vec3 t1, t2;
};
RUBBLE_HD inline StoredFrame storedFrame(const Vec3& n, const Displacement& a, const Displacement& b) {
  StoredFrame f{a, b, expRotation(a.dw), expRotation(b.dw), {}, {}};
  tangentBasis(n, f.t1, f.t2);
  return f;
}

/// State of points at the beginning of the step: the multipliers, which are set for impacts alone, and the
/// drift since they stuck.
template <class L> struct PointsBefore {
  Vec3T<L> lambda{};
  L drift1{}, drift2{};
};
using PointBefore = PointsBefore<Real>;
RUBBLE_HD inline Vec3 multipliersBefore(const Manifold& m, int k) {
  return {m.lambdaN[k], m.lambda1[k], m.lambda2[k]};
}
RUBBLE_HD inline PointBefore pointBefore(const Manifold& m, int k, bool impact) {
  PointBefore before;
  if (impact) before.lambda = multipliersBefore(m, k);
  if (m.stick >> k & 1) before.drift1 = m.drift1[k], before.drift2 = m.drift2[k];
  return before;
}
/// Saves the multipliers with which point k of rows i began the step, if any contact may bounce (bounce.h).
RUBBLE_HD inline void noteBefore(const SolverData& s, int i, const Manifold& m, int k) {
  if (i < s.counters->bounceRows) s.bounce[i].before[k] = multipliersBefore(m, k);
}

/// Displacement of contact points at levers r from A (or B) by the rotation of that body, as sweptBy().
template <class L>
RUBBLE_HD RUBBLE_NEAR Vec3T<L> sweptPoints(const SolverData& s, const ContactRows& of, bool onA,
                                           const StoredFrame& f, const Vec3T<L>& r) {
  const Vec3& dw = onA ? f.a.dw : f.b.dw;
  const Quat& turn = onA ? f.rotationA : f.rotationB;
  if constexpr (sizeof(L) == sizeof(Real)) {
    return sweptBy(s, of, onA, dw, turn, r);
  } else {
    if (dot(dw, dw) < kUnrolled2) return rotate(splatQuat<L>(turn), r) - r;
    Vec3T<L> swept{};
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Vec3 own = sweptBy(s, of, onA, dw, turn, {r.x[k], r.y[k], r.z[k]});
      swept.x[k] = own.x, swept.y[k] = own.y, swept.z[k] = own.z;
    }
    return swept;
  }
}

/// State that points of rows r pass to the next step. An impact passes on the multipliers from `before` it,
/// not its own. M: mask of L. `sticks`: which points stick.
template <class L, class M>
RUBBLE_HD RUBBLE_NEAR PointMemoryT<L> storedPoints(const SolverData& s, const ContactRows& r,
                                                   const StoredFrame& f, int lane, M impact,
                                                   const PointsBefore<L>& before, M& sticks) {
  using A = LaneAccess<L>;
  const Quad<L> place = A::loadQuad(r.place, lane), load = A::loadQuad(r.load, lane),
                slip = A::loadQuad(r.slip, lane);
  const L zero = A::splat(0);
  const auto active = load.w > zero;
  PointMemoryT<L> m{select(impact, before.lambda.x, load.x),
                    select(impact, before.lambda.y, load.y),
                    select(impact, before.lambda.z, load.z),
                    select(active, load.w, A::splat(r.start)),
                    select(active, slip.w, A::splat(r.start * s.step->tangentStiffness)),
                    zero,
                    zero};
  // a point slips if its tangential force is on the cone
  const L lt2 = load.y * load.y + load.z * load.z, bound = slip.z * load.x;
  sticks = (load.x > zero) & (lt2 < bound * bound * (Real(1) - Real(1e-5)));
  const Vec3T<L> rA{place.x, place.y, place.z}, rB = rA + splatVector<L>(r.offset);
  const auto of = [](const Vec3& a) { return splatVector<L>(a); };
  if (!allOf(sticks) && r.muStatic != r.muDynamic) {
    // a slipping point passes on the drift that its row has not corrected, which is its slip
    const Vec3T<L> d = (of(f.a.dp) + cross(of(f.a.dw), rA)) - (of(f.b.dp) + cross(of(f.b.dw), rB));
    m.drift1 = slip.x + along<L>(f.t1, d);
    m.drift2 = slip.y + along<L>(f.t2, d);
  }
  if (!anyOf(sticks)) return m;
  // exact rotations here: errors of the linearized ones would accumulate from step to step
  const Vec3T<L> dA = of(f.a.dp) + sweptPoints<L>(s, r, true, f, rA);
  const Vec3T<L> d = dA - (of(f.b.dp) + sweptPoints<L>(s, r, false, f, rB));
  // the offsets that the row had for surface velocity and settling are no drift; the surface's motion is
  L drift1 = before.drift1 + along<L>(f.t1, d), drift2 = before.drift2 + along<L>(f.t2, d);
  if (s.surfaces > 0) {
    const Vec3 surfaceShift = pairMaterial(s, s.pair[s.activePair[r.manifold]], {r.a, r.b}).surfaceShift;
    drift1 += A::splat(dot(f.t1, surfaceShift));
    drift2 += A::splat(dot(f.t2, surfaceShift));
  }
  m.drift1 = select(sticks, drift1, m.drift1), m.drift2 = select(sticks, drift2, m.drift2);
  return m;
}

/// The same for point k.
struct StoredPoint {
  PointMemory memory;
  bool sticks;
};
RUBBLE_HD inline StoredPoint storedPoint(const SolverData& s, const ContactRows& r, const StoredFrame& f,
                                         int k, bool impact, const PointBefore& before) {
  StoredPoint point;
  point.memory = storedPoints<Real>(s, r, f, k, impact, before, point.sticks);
  return point;
}

/// Stores the state of all points of rows i, all at once.
template <class L> void storePoints(const SolverData& s, int i);

#if !defined(__CUDACC__)
template <> inline void storePoints<Real4>(const SolverData& s, int i) {
  using L = Real4;
  using A = LaneAccess<L>;
  const ContactRows& r = s.contact[i];
  Manifold& m = s.manifold[r.manifold];
  const StoredFrame f = storedFrame(r.n, s.dx[r.a], s.dx[r.b]);
  const L zero = A::splat(0);
  const auto isSet = [&](unsigned bits) { return A::flags(bits, 0) != zero; };
  const auto impact = isSet(m.impact), stuck = isSet(m.stick), used = isSet((1u << m.count) - 1);
  const auto drift = [&](const Lanes& before) { return select(stuck, A::load(before, 0), zero); };
  const PointsBefore<L> before{{A::load(m.lambdaN, 0), A::load(m.lambda1, 0), A::load(m.lambda2, 0)},
                               drift(m.drift1),
                               drift(m.drift2)};
  for (int k = 0; k < m.count; ++k) noteBefore(s, i, m, k);
  auto sticks = stuck;
  PointMemoryT<L> memory = storedPoints<L>(s, r, f, 0, impact, before, sticks);
  const auto keep = [&](L& a, const Lanes& old) { a = select(used, a, A::load(old, 0)); };
  if (m.count < kLanes) {
    keep(memory.lambdaN, m.lambdaN), keep(memory.lambda1, m.lambda1), keep(memory.lambda2, m.lambda2);
    keep(memory.kN, m.kN), keep(memory.kT, m.kT);
    keep(memory.drift1, m.drift1), keep(memory.drift2, m.drift2);
  }
  remember(m, 0, memory);
  const L stickFlags = select(sticks & used, A::splat(1), zero);
  unsigned stick = 0;
  // sums in the order in which four lanes are added
  static_assert(kLanes == 4);
  PointSupport even, odd;
  for (int k = 0; k < m.count; ++k) {
    if (stickFlags[static_cast<std::size_t>(k)] != Real(0)) stick |= 1u << k;
    PointSupport& sum = k % 2 == 0 ? even : odd;
    sum = sum + pointSupport(s, r, f.t1, f.t2, k, !(m.impact >> k & 1));
  }
  m.stick = static_cast<ManifoldBits>(stick);
  s.support[i] = supportOf(r, even + odd);
}
#endif

}  // namespace rubble::RUBBLE_CORE

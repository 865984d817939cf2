#pragma once
/// From pairs to contact rows and back: narrow phase, warm start, dormancy, and what is kept for the next step.
#include "solver/warmstart.h"
#include "stages/broad_phase.h"

namespace rubble::RUBBLE_CORE {

/// A pair with the lower index first.
struct OrderedPair {
  int a, b;
};
RUBBLE_HD inline OrderedPair ordered(const Pair& p) { return p.owner < p.other ? OrderedPair{p.owner, p.other} : OrderedPair{p.other, p.owner}; }

RUBBLE_HD inline Real pairLength(const BodyParams& a, const BodyParams& b) {
  // the smaller dynamic body; a fixed one says nothing about the scale of the contact
  const Real ra = a.kind == BodyKind::Dynamic ? a.radius : Real(0), rb = b.kind == BodyKind::Dynamic ? b.radius : Real(0);
  return 2 * (ra > Real(0) && rb > Real(0) ? min(ra, rb) : max(ra, rb));
}

RUBBLE_HD inline Vec3 centreDistance(const View& s, int a, int b) { return Vec3(s.position[b] - s.position[a]); }

/// Narrow phase of one pair, matched with its manifold of the step before.
struct UpdateManifolds {
  static constexpr const char* kName = "narrow";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Pair p = s.pair[i];
    const OrderedPair o = ordered(p);
    const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
    PairPose pose{s.orientation[o.a], s.orientation[o.b], centreDistance(s, o.a, o.b), pairLength(pa, pb), 0};
    // a plane has no centre: measure from the foot of the other body's
    const Vec3 relative = s.velocity[o.a] - s.velocity[o.b];
    const Real approach = length(relative) + length(s.spin[o.a]) * pa.radius + length(s.spin[o.b]) * pb.radius;
    pose.margin = max(s.step.contactMargin * pose.length, s.step.dt * approach);

    const Manifold* old = nullptr;
    for (int k = s.oldPairOffset[p.owner]; k < s.oldPairOffset[p.owner + 1]; ++k)
      if (s.oldPair[k].other == p.other) old = &s.oldManifold[k];
    s.manifold[i] = updateManifold(pa.shape, pb.shape, pose, old, s.step.recycleTolerance);
    const Manifold& m = s.manifold[i];
    s.touching[i] = m.count > 0;
    if (m.count > 0) atomicCount(&s.counters->contacts, m.count);
    if (m.recycled && m.count > 0) atomicCount(&s.counters->recycled, 1);
  }
};

/// What the points of a touching pair have in common at x^t.
struct PairRows {
  OrderedPair bodies;
  Quat qa, qb;
  Vec3 t;
  Real muStatic, restitution;
  StiffnessRule normal, tangent;
};

/// Begins the rows of a touching pair: everything but its points. `r` is all zeros.
RUBBLE_HD inline PairRows beginRows(const View& s, int i, ContactRows& r) {
  const StepConstants& c = s.step;
  const Manifold& m = s.manifold[i];
  const OrderedPair o = ordered(s.pair[i]);
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  PairRows p;
  p.bodies = o;
  p.qa = s.orientation[o.a], p.qb = s.orientation[o.b];
  p.t = centreDistance(s, o.a, o.b);
  r.a = o.a, r.b = o.b, r.pair = i;
  r.n = m.normal;
  r.offset = -p.t;
  r.length = pairLength(pa, pb);
  const Real lighter = pa.kind != BodyKind::Dynamic ? pb.mass : pb.kind != BodyKind::Dynamic ? pa.mass : min(pa.mass, pb.mass);
  r.start = startStiffness(c, lighter);
  p.muStatic = std::sqrt(pa.muStatic * pb.muStatic);
  r.muDynamic = std::sqrt(pa.muDynamic * pb.muDynamic);
  p.restitution = max(pa.restitution, pb.restitution);
  p.normal = contactRule(c, r.start, r.length);
  p.tangent = tangentRule(c, p.normal);
  return p;
}

/// Rows of point k, in lane `to` of r: geometry, regularised errors, warm start [S 12] [S 17]. Returns whether it stops a fast approach.
RUBBLE_HD inline bool buildPoint(const View& s, const Manifold& m, const PairRows& p, int k, ContactRows& r, int to) {
  const StepConstants& c = s.step;
  const OrderedPair& o = p.bodies;
  const Vec3 xa = rotate(p.qa, pointOnA(m, k)), xb = p.t + rotate(p.qb, pointOnB(m, k));
  const Vec3 lever = (xa + xb) * Real(.5);
  r.rAx[to] = lever.x, r.rAy[to] = lever.y, r.rAz[to] = lever.z;
  const Real depth = dot(r.n, xa - xb);
  const Vec3 approach = s.velocity[o.a] + cross(s.spin[o.a], lever) - s.velocity[o.b] - cross(s.spin[o.b], lever - p.t);
  const Real closing = dot(r.n, approach);
  const bool hits = closing > kImpactSpeed && depth + closing * c.dt > Real(0);
  r.c0[to] = hits && p.restitution > Real(0) ? p.restitution * closing * c.dt : inheritedViolation(c, depth);

  const bool stuck = m.stick >> k & 1, isNew = m.kN[k] == Real(0);
  r.drift1[to] = stuck ? m.drift1[k] : Real(0), r.drift2[to] = stuck ? m.drift2[k] : Real(0);
  r.mu[to] = stuck || isNew ? p.muStatic : r.muDynamic;
  const Real lambda = min(warmMultiplier(c, m.lambdaN[k], true), c.maxMultiplier);
  Real l1 = warmMultiplier(c, m.lambda1[k], true), l2 = warmMultiplier(c, m.lambda2[k], true);
  const Real size2 = l1 * l1 + l2 * l2, bound = p.muStatic * lambda;
  if (size2 > bound * bound) {
    const Real cut = bound / std::sqrt(size2);
    l1 *= cut, l2 *= cut;
  }
  r.lambdaN[to] = lambda, r.lambda1[to] = l1, r.lambda2[to] = l2;
  r.kN[to] = isNew ? coldStart(p.normal.start).k : warmStiffness(c, p.normal, m.kN[k], lambda);
  r.kT[to] = isNew ? coldStart(p.tangent.start).k : warmStiffness(c, p.tangent, m.kT[k], std::sqrt(l1 * l1 + l2 * l2));
  return hits && c.impactRule;
}

/// Rows of a touching pair at x^t.
struct BuildContactRows {
  static constexpr const char* kName = "rows";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Manifold& m = s.manifold[i];
    if (m.count == 0) return;
    m.row = s.rowOfPair[i];
    ContactRows r;
    memset(static_cast<void*>(&r), 0, sizeof r);  // points that are not used too
    const PairRows p = beginRows(s, i, r);
    r.mu = splatLanes(p.muStatic);
    m.impact = 0;
    for (int k = 0; k < m.count; ++k)
      if (buildPoint(s, m, p, k, r, k)) m.impact |= static_cast<std::uint8_t>(1u << k);
    s.contact[m.row] = r;
  }
};

/// Displacement of a body at its inertial target.
RUBBLE_HD inline Displacement targetDisplacement(const View& s, int body) {
  if (s.params[body].kind != BodyKind::Dynamic) return s.moved[body];
  const Pose& y = s.target[body].y;
  return {y.p, 0, logRotation(y.q), 0};
}

/// A point counts as staying open if its gap at the inertial targets is more than this share of L: the gap of bodies that merely rest is
/// round-off, and of no consequence.
inline constexpr Real kDormantGap = Real(1e-3);

/// Is point k without load, and does it stay open with its bodies at a and b?
RUBBLE_HD inline bool staysOpen(const ContactRows& r, int k, const Displacement& a, const Displacement& b) {
  if (r.lambdaN[k] != Real(0)) return false;
  const ContactFrame<Real> f = contactFrame<Real>(r, k);
  return r.c0[k] + along(r.n, relativeDisplacement(f, a, b)) < -kDormantGap * r.length;
}

/// Points without load that stay open at the inertial targets of both bodies take no part in the step: k = 0.
struct MarkDormant {
  static constexpr const char* kName = "dormant";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!s.step.dormantRows) return;
    ContactRows& r = s.contact[i];
    bool any = false;
    for (int k = 0; k < kLanes; ++k) any |= r.lambdaN[k] == Real(0) && r.kN[k] > Real(0);
    if (!any) return;
    const Displacement a = targetDisplacement(s, r.a), b = targetDisplacement(s, r.b);
    for (int k = 0; k < kLanes; ++k)
      if (staysOpen(r, k, a, b)) r.kN[k] = r.kT[k] = Real(0);
  }
};

/// The dual update of all contacts.
template <class L>
struct UpdateContactDuals {
  static constexpr const char* kName = "dual";
  RUBBLE_HD void operator()(const View& s, int i) const {
    constexpr int kStep = sizeof(L) / sizeof(Real);
    ContactRows& r = s.contact[i];
    for (int lane = 0; lane < kLanes; lane += kStep) updateContactDuals<L>(s.step, r, s.moved[r.a], s.moved[r.b], lane);
  }
};

/// Turns and tangents that storing the points of a contact takes.
struct StoredFrame {
  Displacement a, b;
  Quat turnA, turnB;
  Vec3 t1, t2;
};
RUBBLE_HD inline StoredFrame storedFrame(const View& s, const ContactRows& r) {
  StoredFrame f;
  f.a = s.moved[r.a], f.b = s.moved[r.b];
  f.turnA = expRotation(f.a.dw), f.turnB = expRotation(f.b.dw);
  tangentBasis(r.n, f.t1, f.t2);
  return f;
}

/// Hands multipliers, stiffness and drift of point k to the manifold. The multipliers of an impact are not kept: those before it are.
/// Returns whether the point sticks.
RUBBLE_HD inline bool storePoint(const View& s, const ContactRows& r, const StoredFrame& f, Manifold& m, int k) {
  if (!(m.impact >> k & 1)) {
    m.lambdaN[k] = r.lambdaN[k], m.lambda1[k] = r.lambda1[k], m.lambda2[k] = r.lambda2[k];
  }
  m.kN[k] = r.kN[k] > Real(0) ? r.kN[k] : r.start;
  m.kT[k] = r.kN[k] > Real(0) ? r.kT[k] : r.start * s.step.tangentStiffness;
  // a sliding point has been given the dynamic coefficient; with equal ones the force on the cone tells
  const Real lt2 = r.lambda1[k] * r.lambda1[k] + r.lambda2[k] * r.lambda2[k], bound = r.mu[k] * r.lambdaN[k];
  const bool stuck = r.lambdaN[k] > Real(0) && lt2 < bound * bound * (Real(1) - Real(1e-5));
  if (!stuck) {
    m.drift1[k] = m.drift2[k] = Real(0);
    return false;
  }
  // exact displacements here: errors of the linear ones would add up from step to step
  const Vec3 rA{r.rAx[k], r.rAy[k], r.rAz[k]}, rB = rA + r.offset;
  const Vec3 d = (f.a.dp + rotate(f.turnA, rA) - rA) - (f.b.dp + rotate(f.turnB, rB) - rB);
  m.drift1[k] = r.drift1[k] + dot(f.t1, d);
  m.drift2[k] = r.drift2[k] + dot(f.t2, d);
  return true;
}

struct StoreContacts {
  static constexpr const char* kName = "store";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const ContactRows& r = s.contact[i];
    Manifold& m = s.manifold[r.pair];
    const StoredFrame f = storedFrame(s, r);
    m.stick = 0;
    for (int k = 0; k < m.count; ++k)
      if (storePoint(s, r, f, m, k)) m.stick |= static_cast<std::uint8_t>(1u << k);
  }
};

}  // namespace rubble::RUBBLE_CORE

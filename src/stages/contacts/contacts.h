#pragma once
/// From near pairs to contact rows and back: narrow phase, warm start, and what is kept for the next step.
#include "collision/sweep.h"
#include "solver/warmstart.h"
#include "stages/bodies/corrections.h"
#include "stages/coarse/cells.h"
#include "stages/contacts/materials.h"
#include "stages/contacts/rolled.h"
#include "stages/pairs/active_pairs.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int countPoints(unsigned bits) {
  int count = 0;
  for (int k = 0; k < kLanes; ++k) count += bits >> k & 1;
  return count;
}

/// What manifold i was in the step before, or null.
RUBBLE_HD inline const Manifold* manifoldBefore(const SolverData& s, int i) {
  const int old = s.manifoldBefore[s.activePair[i]];
  return old < 0 ? nullptr : &s.oldManifold[old];
}

/// Notes which points of manifold i take part in the step. Those of one without any are forgotten.
RUBBLE_HD inline void keepManifold(const SolverData& s, int i, const OrderedPair& o, const PairPose& pair,
                                   Manifold m) {
  const ActivationRule awake = activationRule(s, o);
  m.awake = 0;
  for (int k = 0; k < m.count; ++k)
    if (awake(s, o, pair, m.normal, pointAt(m, k, m.normal, pair.qA, pair.qB, pair.t), m.lambdaN[k]))
      m.awake |= static_cast<std::uint8_t>(1u << k);
  if (m.awake == 0) forgetPoints(m);
  // a sensor has points, and no rows
  const bool rows = m.awake != 0 && !isSensor(s, o.a) && !isSensor(s, o.b);
  s.manifold[i] = m;
  s.hasRows[i] = rows;
  if (!rows) return;
  atomicCount(&s.counters->contacts, countPoints(m.awake));
  if (m.recycled) atomicCount(&s.counters->recycled, 1);
}

/// What a part has of a surface is gathered anew in every step.
RUBBLE_HD inline bool mayRecycle(const SolverData& s, const OrderedPair& o) {
  return !s.generalShapes || !(isSurface(s.params[o.a].shape.kind) || isSurface(s.params[o.b].shape.kind));
}

/// A pair of which no body moves has everything kept as it is.
RUBBLE_HD inline bool keepAsleep(const SolverData& s, int i, const Pair& p, const Manifold* old) {
  if (!old || !s.step.sleeping || moves(s, p.owner) || moves(s, p.other)) return false;
  s.manifold[i] = *old;
  s.manifold[i].row = -1;
  s.hasRows[i] = 0;
  return true;
}

/// Narrow phase of near pairs that have hardly moved: the manifold of the step before. The others are listed.
struct RecycleManifolds {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const int pair = s.activePair[i];
    const Pair p = s.pair[pair];
    const OrderedPair o = ordered(p);
    const PairPose pose = pairPose(s, o);
    const Manifold* const old = manifoldBefore(s, i);
    if (keepAsleep(s, i, p, old)) return;
    if (old && mayRecycle(s, o) && recyclable(s.pairTest[pair], old->count, pose, s.step.recycleTolerance))
      keepManifold(s, i, o, pose, recycledManifold(*old, pose));
    else
      s.tested[atomicCount(&s.counters->tested, 1)] = i;
  }
};

/// Narrow phase of the listed pairs of plain shapes: a new manifold, whose points are matched with the old
/// ones. Others follow in TestGeneralPairs.
struct TestPairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int t) const {
    const int i = s.tested[t], pair = s.activePair[i];
    const OrderedPair o = ordered(s.pair[pair]);
    if (s.generalShapes && !isPrimitivePair(s, o.a, o.b)) return;
    const PairPose pose = pairPose(s, o);
    const RawManifold raw = collide(s.params[o.a].shape, s.params[o.b].shape, pose);
    s.pairTest[pair] = pairTest(raw, pose);
    keepManifold(s, i, o, pose, testedManifold(raw, pose, manifoldBefore(s, i)));
  }
};

/// What the points of a pair with rows have in common at x^t.
struct PairRows {
  OrderedPair bodies;
  Quat qa, qb;
  Vec3 t;
  Real mu;  ///< friction of this step, static or dynamic
  bool bothMove;
  Real heavier;   ///< k_start by the mass of the heavier body [N/m]
  Vec3 belt;      ///< [m], see PairMaterial
  Vec3 settling;  ///< [m], see relativeSettling()
  StiffnessRule normal, tangent;
};

/// A point this deep, over half the thickness of its dynamic body [1], in what does not yield: whatever
/// presses the body there, it goes no deeper than fast bodies may (stages/ccd/fast_bodies.h).
inline constexpr Real kPressedDepth = Real(.1);

/// Notes bodies that are pressed into static or kinematic ones.
RUBBLE_HD inline void notePressed(const SolverData& s, const OrderedPair& o, Real depth) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const bool moves = pa.kind == BodyKind::Dynamic;
  if (moves == (pb.kind == BodyKind::Dynamic)) return;
  if (depth > kPressedDepth * innerRadiusOf(s.shapeTables(), (moves ? pa : pb).shape))
    s.fast[moves ? o.a : o.b] = 1;
}

/// Share of the way within which friction would stop a load that counts as slip [1].
inline constexpr Real kLeastSlip = Real(.01);

/// Did the points of a manifold slip together in the step before? One after another reaches its cone as the
/// push grows, the least loaded first; those yield at the static coefficient until most of the load is on its
/// cones and moves on there.
RUBBLE_HD inline bool slides(const Manifold& m, Real muStatic) {
  Real load = 0, stiffness = 0, yielding = 0, slip = 0;
  for (int k = 0; k < m.count; ++k) {
    load += m.lambdaN[k], stiffness += m.kT[k];
    if (m.stick >> k & 1) continue;
    yielding += m.lambdaN[k];
    slip += m.lambdaN[k] * std::sqrt(m.drift1[k] * m.drift1[k] + m.drift2[k] * m.drift2[k]);
  }
  return 2 * yielding > load && slip * stiffness > kLeastSlip * muStatic * load * load;
}

/// Speed at which the fastest of the points of a manifold that stop an approach in this step closes, 0: none
/// does [m/s].
RUBBLE_HD inline Real fastestPoint(const SolverData& s, const Manifold& m, const PairRows& p, const Vec3& n,
                                   Real length) {
  Real fastest = 0;
  const int a = p.bodies.a, b = p.bodies.b;
  if (!(pairSpeed(s, a, b, s.params[a], s.params[b]).closing > impactSpeed(s.step, length))) return fastest;
  for (int k = 0; k < m.count; ++k) {
    const PointAt point = pointAt(m, k, n, p.qa, p.qb, p.t);
    const Real closing = closingSpeed(s, p.bodies, n, point.lever, p.t);
    if (hits(s.step, closing, point.depth, length)) fastest = max(fastest, closing);
  }
  return fastest;
}
/// The load of an impact stands for so many times the mass that it stops [1]: more would not let rows follow
/// their bodies within the iterations, less does not carry the impact on through a heap.
inline constexpr Real kImpactMasses = 100;

/// What a load stands for moves the bodies of a contact by no more than this share of half the thickness of
/// the thinner one in a step [1]: they rest three tenths as deep in one another (docs/method.md).
inline constexpr Real kMostGive = Real(.05);

/// The mass that a load stands for over dt^2, for each newton: a weight |lambda| stands for |lambda| / a,
/// what ends a speed in the step for up to kImpactMasses |lambda| dt / speed; `thin`: half the thickness of
/// the thinner body. [1/m]
RUBBLE_HD inline Real stiffnessPerLoad(const StepConstants& c, Real speed, Real thin) {
  const Real give = c.loadAcceleration * c.dt * c.dt;
  return Real(1) / max(thin > Real(0) ? min(give, kMostGive * thin) : give, speed * c.dt / kImpactMasses);
}

/// Ceiling of |lambda| of a contact whose bodies close at that speed [N].
RUBBLE_HD inline Real largestLoad(const SolverData& s, const OrderedPair& o, Real closing) {
  const Real inverseDt = s.step.inverseDt;
  Real mass = 0, massLength = 0;
  for (const int body : {o.a, o.b}) {
    const BodyParams& p = s.params[body];
    if (p.kind != BodyKind::Dynamic) continue;
    const Real island = fromFloatBits(s.islandMassLength[body]);
    mass = max(mass, p.mass), massLength = max(massLength, island > Real(0) ? island : kUnreached);
  }
  return max(kContactShare * massLength * inverseDt * inverseDt, kMostImpacts * mass * closing * inverseDt);
}

/// Begins the rows of manifold i: everything but its points. `r` is all zeros.
RUBBLE_HD inline PairRows beginRows(const SolverData& s, int i, ContactRows& r) {
  const StepConstants& c = s.step;
  const Manifold& m = s.manifold[i];
  const Pair& pair = s.pair[s.activePair[i]];
  const OrderedPair o = ordered(pair);
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  PairRows p;
  p.bodies = o;
  p.qa = s.orientation[o.a], p.qb = s.orientation[o.b];
  p.t = centreDistance(s, o.a, o.b);
  r.a = o.a, r.b = o.b, r.manifold = i;
  r.n = m.normal;
  r.offset = -p.t;
  r.length = pairLength(pa, pb);
  const Real lighter = pa.kind != BodyKind::Dynamic   ? pb.mass
                       : pb.kind != BodyKind::Dynamic ? pa.mass
                                                      : min(pa.mass, pb.mass);
  r.start = startStiffness(c, lighter);
  const PairMaterial material = pairMaterial(s, pair, o);
  p.bothMove = pa.kind == BodyKind::Dynamic && pb.kind == BodyKind::Dynamic;
  r.muStatic = material.muStatic, r.muDynamic = material.muDynamic;
  p.mu = r.muStatic != r.muDynamic && slides(m, r.muStatic) ? r.muDynamic : r.muStatic;
  r.restitution = material.restitution;
  r.most = largestLoad(s, o, pairSpeed(s, o.a, o.b, pa, pb).closing);
  p.belt = material.belt;
  p.heavier = startStiffness(c, max(pa.mass, pb.mass));
  p.settling = relativeSettling(s, o.a, o.b);
  p.normal = contactRule(c, r.start, r.length);
  const ShapeTables tables = s.shapeTables();
  const Real thin = thinner(innerRadiusOf(tables, pa.shape), innerRadiusOf(tables, pb.shape));
  const Real speed = max(fastestPoint(s, m, p, r.n, r.length), impactSpeedBoundOf(s, o.a, o.b));
  p.normal.perLoad = r.perLoad = stiffnessPerLoad(c, speed, thin);
  p.tangent = tangentRule(c, p.normal);
  return p;
}

/// Rows of point k, in lane `to` of r: geometry, regularised errors, warm start [S 12] [S 17]. Returns
/// whether it stops a fast approach.
RUBBLE_HD inline bool buildPoint(const SolverData& s, const Manifold& m, const PairRows& p, int k,
                                 ContactRows& r, int to) {
  const StepConstants& c = s.step;
  const OrderedPair& o = p.bodies;
  const PointAt point = pointAt(m, k, m.normal, p.qa, p.qb, p.t);
  const Real closing = closingSpeed(s, o, r.n, point.lever, p.t);
  const bool impact = hits(c, closing, point.depth, r.length), awake = m.awake >> k & 1;
  if (point.depth > c.contactMargin * r.length) notePressed(s, o, point.depth);
  if (awake && r.restitution > Real(0) && s.counters->bounces == 0 && isImpact(c, closing, r.length))
    atomicRaise(&s.counters->bounces, 1);

  const bool stuck = m.stick >> k & 1, isNew = m.kN[k] == Real(0);
  Real drift1 = stuck ? m.drift1[k] : Real(0), drift2 = stuck ? m.drift2[k] : Real(0);
  StiffnessRule normal = p.normal;
  Real most = r.most;
  if (p.bothMove) {
    normal.limit = contactCeiling(c, p.heavier, r.length, point.depth);
    most = min(most, normal.limit / normal.perLoad);
  }
  const Real lambda = min(warmMultiplier(c, m.lambdaN[k], true), most);
  Real l1 = warmMultiplier(c, m.lambda1[k], true), l2 = warmMultiplier(c, m.lambda2[k], true);
  const Real size2 = l1 * l1 + l2 * l2, bound = p.mu * lambda;
  if (size2 > bound * bound) {
    const Real cut = bound / std::sqrt(size2);
    l1 *= cut, l2 *= cut;
  }
  const Real kN = !awake  ? Real(0)
                  : isNew ? coldStart(normal.start).k
                          : warmStiffness(c, normal, m.kN[k], lambda);
  const Real kT = !awake  ? Real(0)
                  : isNew ? coldStart(p.tangent.start).k
                          : warmStiffness(c, p.tangent, m.kT[k], std::sqrt(l1 * l1 + l2 * l2));
  // The drift is corrected by the part driftCorrection of it: what belts move and what settles is made good
  // in full.
  Vec3 t1, t2;
  tangentBasis(r.n, t1, t2);
  const Real settling1 = dot(t1, p.settling), settling2 = dot(t2, p.settling);
  const Real share = settlingShare(settling1 * settling1 + settling2 * settling2, bound, kT);
  drift1 += (dot(t1, p.belt) + share * settling1) / c.driftCorrection;
  drift2 += (dot(t2, p.belt) + share * settling2) / c.driftCorrection;
  r.place[to] = {point.lever, inheritedViolation(c, point.depth)};
  r.load[to] = {lambda, l1, l2, kN};
  r.slip[to] = {drift1, drift2, p.mu, kT};
  return impact && c.impactRule;
}

/// Does point k hold its bodies together now, up to the gap below which a point is not dormant?
RUBBLE_HD inline bool holdsAt(const ContactRows& r, int k) {
  return r.load[k].kN > Real(0) && r.place[k].c0 > -kInactiveGap * r.length;
}

/// Level of the groups at which rows unite their bodies: the finest at which these share a cell (cells.h), if
/// a point holds them together or stops their approach in this step (bits of `impact`): what strikes together
/// moves on together, and sweeps over one body at a time find that last.
RUBBLE_HD inline int joinLevel(const SolverData& s, const ContactRows& r, int impact) {
  for (int k = 0; k < kLanes; ++k)
    if (holdsAt(r, k) || (impact >> k & 1)) return finestSharedLevel(s, r.a, r.b);
  return kCoarseLevels;
}

/// Rows of manifold i at x^t. Points that are not awake have k = 0.
struct BuildContactRows {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0) return;
    Manifold& m = s.manifold[i];
    m.row = s.rowOffset[i];
    ContactRows r;
    memset(static_cast<void*>(&r), 0, sizeof r);  // points that are not used too
    const PairRows p = beginRows(s, i, r);
    for (PointSlip& slip : r.slip) slip.mu = p.mu;
    m.impact = 0;
    for (int k = 0; k < m.count; ++k)
      if (buildPoint(s, m, p, k, r, k)) m.impact |= static_cast<std::uint8_t>(1u << k);
    s.contact[m.row] = r;
    s.joinLevel[m.row] = joinLevel(s, r, m.impact);
  }
};

/// The dual update of all contacts.
template <class L> struct UpdateContactDuals {
  static constexpr const char* kStage = "dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    constexpr int kStep = sizeof(L) / sizeof(Real);
    ContactRows& r = s.contact[i];
    for (int lane = 0; lane < kLanes; lane += kStep)
      updateContactDuals<L>(s.step, r, s.dx[r.a], s.dx[r.b], lane);
  }
};

/// Turns and tangents that storing the points of a contact takes.
struct StoredFrame {
  Displacement a, b;
  Quat turnA, turnB;
  Vec3 t1, t2;
};
RUBBLE_HD inline StoredFrame storedFrame(const SolverData& s, const ContactRows& r) {
  StoredFrame f;
  f.a = s.dx[r.a], f.b = s.dx[r.b];
  f.turnA = expRotation(f.a.dw), f.turnB = expRotation(f.b.dw);
  tangentBasis(r.n, f.t1, f.t2);
  return f;
}

/// What a point brought into the step: multipliers, which only an impact asks for, and the drift since it
/// stuck.
struct PointBefore {
  Vec3 lambda{0, 0, 0};
  Real drift1 = 0, drift2 = 0;
};
RUBBLE_HD inline Vec3 multipliersBefore(const Manifold& m, int k) {
  return {m.lambdaN[k], m.lambda1[k], m.lambda2[k]};
}
RUBBLE_HD inline PointBefore pointBefore(const Manifold& m, int k, bool impact) {
  PointBefore before;
  if (impact) before.lambda = multipliersBefore(m, k);
  if (m.stick >> k & 1) before.drift1 = m.drift1[k], before.drift2 = m.drift2[k];
  return before;
}
/// Notes the multipliers with which point k of rows i began the step, where something may bounce (bounce.h).
RUBBLE_HD inline void noteBefore(const SolverData& s, int i, const Manifold& m, int k) {
  if (i < s.counters->bounceRows) s.bounce[i].before[k] = multipliersBefore(m, k);
}

/// What point k hands on to the next step, and whether it sticks. The multipliers of an impact are not kept:
/// those `before` it are.
struct StoredPoint {
  PointMemory memory;
  bool sticks;
};
RUBBLE_HD inline StoredPoint storedPoint(const SolverData& s, const ContactRows& r, const StoredFrame& f,
                                         int k, bool impact, const PointBefore& before) {
  const PointLoad load = r.load[k];
  const PointSlip slip = r.slip[k];
  const Vec3 lambda = impact ? before.lambda : Vec3{load.lambdaN, load.lambda1, load.lambda2};
  const bool active = load.kN > Real(0);
  PointMemory m{lambda.x,
                lambda.y,
                lambda.z,
                active ? load.kN : r.start,
                active ? slip.kT : r.start * s.step.tangentStiffness,
                0,
                0};
  // the force on the cone tells
  const Real lt2 = load.lambda1 * load.lambda1 + load.lambda2 * load.lambda2, bound = slip.mu * load.lambdaN;
  const bool stuck = load.lambdaN > Real(0) && lt2 < bound * bound * (Real(1) - Real(1e-5));
  if (!stuck) {
    if (r.muStatic == r.muDynamic) return {m, false};
    // what the row still wants to take back is its slip
    const Vec3 rA = r.place[k].rA, d = (f.a.dp + cross(f.a.dw, rA)) - (f.b.dp + cross(f.b.dw, rA + r.offset));
    m.drift1 = s.step.driftCorrection * slip.drift1 + dot(f.t1, d);
    m.drift2 = s.step.driftCorrection * slip.drift2 + dot(f.t2, d);
    return {m, false};
  }
  // exact displacements here: errors of the linear ones would add up from step to step
  const Vec3 rA = r.place[k].rA;
  const Vec3 dA = f.a.dp + sweptBy(s, r.a, f.a.dw, f.turnA, rA, r.n);
  const Vec3 d = dA - (f.b.dp + sweptBy(s, r.b, f.b.dw, f.turnB, rA + r.offset, -r.n));
  // what stood for belts and settling in the row is no drift; the way of the belt is
  m.drift1 = before.drift1 + dot(f.t1, d);
  m.drift2 = before.drift2 + dot(f.t2, d);
  if (s.surfaces > 0) {
    const Vec3 belt = pairMaterial(s, s.pair[s.activePair[r.manifold]], {r.a, r.b}).belt;
    m.drift1 += dot(f.t1, belt);
    m.drift2 += dot(f.t2, belt);
  }
  return {m, true};
}

/// The last dual update, and what the points hand on to the next step.
template <class L> struct FinishContacts {
  static constexpr const char* kStage = "store";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    UpdateContactDuals<L>{}(s, i);
    const ContactRows& r = s.contact[i];
    Manifold& m = s.manifold[r.manifold];
    const StoredFrame f = storedFrame(s, r);
    std::uint8_t stick = 0;
    // in the order in which four lanes add
    static_assert(kLanes == 4);
    PointSupport even, odd;
    for (int k = 0; k < m.count; ++k) {
      const bool impact = m.impact >> k & 1;
      const PointBefore before = pointBefore(m, k, impact);
      noteBefore(s, i, m, k);
      const StoredPoint point = storedPoint(s, r, f, k, impact, before);
      remember(m, k, point.memory);
      if (point.sticks) stick |= static_cast<std::uint8_t>(1u << k);
      const PointSupport own = pointSupport(s, r, f.t1, f.t2, k, !impact);
      if (k % 2 == 0)
        even = even + own;
      else
        odd = odd + own;
    }
    m.stick = stick;
    s.support[i] = supportOf(r, even + odd);
  }
};

}  // namespace rubble::RUBBLE_CORE

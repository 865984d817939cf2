#pragma once
/// From active pairs to contact rows and back: narrow phase, warm start, and the state kept for the next
/// step.
#include "collision/sweep.h"
#include "solver/warmstart.h"
#include "stages/coarse/cells.h"
#include "stages/contacts/arcs.h"
#include "stages/contacts/round_sides.h"
#include "stages/contacts/stored_points.h"
#include "stages/pairs/active_pairs.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline int countPoints(unsigned bits) {
  int count = 0;
  for (int k = 0; k < kLanes; ++k) count += bits >> k & 1;
  return count;
}

/// The manifold of the same pair in the previous step, or null.
RUBBLE_HD inline const Manifold* manifoldBefore(const SolverData& s, int i) {
  const int old = s.manifoldBefore[s.activePair[i]];
  return old < 0 ? nullptr : &s.oldManifold[old];
}

/// What manifolds add to the counters of a step.
struct ManifoldCount {
  int contacts = 0, recycled = 0;
  RUBBLE_HD ManifoldCount& operator+=(const ManifoldCount& a) {
    contacts += a.contacts, recycled += a.recycled;
    return *this;
  }
};
RUBBLE_HD inline void addToCounters(const SolverData& s, const ManifoldCount& count) {
  if (count.contacts > 0) atomicCount(&s.counters->contacts, count.contacts);
  if (count.recycled > 0) atomicCount(&s.counters->recycled, count.recycled);
}

/// Stores manifold i and marks its active points. Returns what it adds to the counters. A manifold without
/// active points loses its memory.
RUBBLE_HD inline ManifoldCount keepManifold(const SolverData& s, int i, const OrderedPair& o,
                                            const PairPose& pair, Manifold m) {
  // points that carry load do not need the targets of the bodies
  unsigned active = 0;
  for (int k = 0; k < m.count; ++k) active |= (m.lambdaN[k] != Real(0) ? 1u : 0u) << k;
  if (const unsigned all = (1u << m.count) - 1; active != all) {
    const ActivationRule isActivePoint = activationRule(s, o);
    for (int k = 0; k < m.count; ++k)
      if (isActivePoint(s, o, pair, m.normal, pointAt(m, k, m.normal, pair.qA, pair.qB, pair.t),
                        m.lambdaN[k]))
        active |= 1u << k;
  }
  m.activePoints = static_cast<ManifoldBits>(active);
  if (m.activePoints == 0) forgetPoints(m);
  // a sensor has contact points but no rows
  const bool rows = m.activePoints != 0 && !isSensor(s, o.a) && !isSensor(s, o.b);
  s.manifold[i] = m;
  s.hasRows[i] = rows;
  if (!rows) return {};
  return {countPoints(m.activePoints), m.recycled ? 1 : 0};
}

/// Against a mesh, height field or distance field the contact points are gathered anew in every step.
RUBBLE_HD inline bool mayRecycle(const SolverData& s, const OrderedPair& o) {
  return !s.generalShapes || !(isSurface(s.params[o.a].shape.kind) || isSurface(s.params[o.b].shape.kind));
}

/// Keeps the manifold of a pair unchanged if neither body can move.
RUBBLE_HD inline bool keepAsleep(const SolverData& s, int i, const Pair& p, const Manifold* old) {
  if (!old || !s.plan.sleeping || moves(s, p.owner) || moves(s, p.other)) return false;
  s.manifold[i] = *old;
  s.manifold[i].row = -1;
  s.hasRows[i] = 0;
  return true;
}

/// Has pair i hardly moved since the full test that its previous manifold comes from? If the manifold has
/// points, `pose` needs no margin.
RUBBLE_HD inline bool hardlyMoved(const SolverData& s, int i, const PairPose& pose, const Manifold& old) {
  return recyclable(s.pairTest[s.activePair[i]], old.count, pose, s.step->recycleTolerance);
}

/// Narrow phase of active pairs that have hardly moved: reuses the previous manifold. All other pairs are
/// appended to `tested`, and so are those whose points roll.
template <class L> struct RecycleManifolds {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    ManifoldCount count;
    if (!reuses(s, i, count)) s.tested[atomicCount(&s.counters->tested, 1)] = i;
    addToCounters(s, count);
  }
  /// Is the previous manifold of pair i good enough as it is? Then stores it; `count` gets what it adds to
  /// the counters.
  RUBBLE_HD static bool reuses(const SolverData& s, int i, ManifoldCount& count) {
    const Pair p = s.pair[s.activePair[i]];
    const OrderedPair o = ordered(p);
    const Manifold* const old = manifoldBefore(s, i);
    PairPose pose = pairPoseWithoutMargin(s, o);
    if (old && old->count == 0) setMargin(s, o, pose);
    if (keepAsleep(s, i, p, old)) return true;
    if (!old || rolls(*old) || !mayRecycle(s, o) || !hardlyMoved(s, i, pose, *old)) return false;
    count = keepManifold(s, i, o, pose, recycledManifold<L>(*old, pose));
    return true;
  }
};

/// Narrow phase of pair i, one of the `tested` ones: rolls on its previous manifold, or takes that of a full
/// test, fullTest(pose), whose points are matched with the previous ones.
template <class FullTest>
RUBBLE_HD ManifoldCount testPair(const SolverData& s, int i, const Pair& p, const OrderedPair& o,
                                 FullTest&& fullTest) {
  const PairPose pose = pairPose(s, o);
  const Manifold* const old = manifoldBefore(s, i);
  if (old && rolls(*old) && hardlyMoved(s, i, pose, *old))
    return keepManifold(s, i, o, pose, rolledManifold(s, p, o, pose, *old));
  const RawManifold raw = fullTest(pose);
  s.pairTest[s.activePair[i]] = pairTest(raw, pose);
  Manifold m = testedManifold(raw, pose, old);
  noteRoundSides(s, p, o, pose, m);
  return keepManifold(s, i, o, pose, m);
}

/// The `tested` pairs of primitive shapes. TestGeneralPairs processes the other ones.
struct TestPairs {
  static constexpr const char* kStage = "narrow";
  RUBBLE_HD void operator()(const SolverData& s, int t) const { addToCounters(s, take(s, t)); }
  RUBBLE_HD static ManifoldCount take(const SolverData& s, int t) {
    const int i = s.tested[t];
    const Pair p = s.pair[s.activePair[i]];
    const OrderedPair o = ordered(p);
    if (s.generalShapes && !isPrimitivePair(s, o.a, o.b)) return {};
    return testPair(s, i, p, o, [&](const PairPose& pose) {
      return collide(s.params[o.a].shape, s.params[o.b].shape, pose);
    });
  }
};

/// A pair at x^t.
struct PairPlace {
  OrderedPair bodies;
  Quat qa, qb;
  Vec3 t;       ///< p_B - p_A [m]
  Real length;  ///< L [m]
};
RUBBLE_HD inline PairPlace pairPlace(const SolverData& s, const OrderedPair& o) {
  return {o, loadUnchanging(s.orientation[o.a]), loadUnchanging(s.orientation[o.b]),
          centerDistance(s, o.a, o.b), pairLength(s.params[o.a], s.params[o.b])};
}
RUBBLE_HD inline PairPlace pairPlace(const SolverData& s, int manifold) {
  return pairPlace(s, ordered(s.pair[s.activePair[manifold]]));
}

/// Contact points at x^t.
template <class L> struct PointMotion {
  PointsAt<L> at;
  L closing;  ///< closing speed [m/s]
};
template <class L>
RUBBLE_HD RUBBLE_NEAR PointMotion<L> pointMotion(const SolverData& s, const Manifold& m, const PairPlace& p,
                                                 int lane) {
  const PointsAt<L> at = pointsAt<L>(m, lane, m.normal, p.qa, p.qb, p.t);
  return {at, closingSpeed(s, p.bodies, m.normal, at.lever, p.t)};
}
/// The closing speed of a point if it stops a fast approach in this step, otherwise 0 [m/s].
RUBBLE_HD inline Real stoppedSpeed(const SolverData& s, const PairPlace& p, Real closing, Real depth) {
  return hits(s.stepOf(p.bodies.a), closing, depth, p.length) ? closing : Real(0);
}

/// Quantities shared by all contact points of a pair at x^t.
struct PairRows {
  OrderedPair bodies;
  Real mu;  ///< friction coefficient of this step, static or dynamic
  bool bothMove;
  Real heavier;       ///< k_start from the mass of the heavier body [N/m]
  Vec3 surfaceShift;  ///< [m], see PairMaterial
  Vec3 settling;      ///< [m], see relativeSettling()
  StiffnessRule normal, tangent;
};

/// Depth of a contact point in an immovable body, over half the thickness of the dynamic body [1]. A body
/// pressed deeper is flagged for CCD, which bounds how much deeper it may go (stages/ccd/fast_bodies.h).
inline constexpr Real kPressedDepth = Real(.1);

/// Flags bodies that are pressed into static or kinematic ones.
RUBBLE_HD inline void notePressed(const SolverData& s, const OrderedPair& o, Real depth) {
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  const bool moves = pa.kind == BodyKind::Dynamic;
  if (moves == (pb.kind == BodyKind::Dynamic)) return;
  if (depth > kPressedDepth * innerRadiusOf(s.shapeTables(), (moves ? pa : pb).shape))
    atomicRaise(&s.fast[moves ? o.a : o.b], 1);
}

/// Least displacement that counts as slip, as a share of the displacement over which friction reaches its
/// cone [1].
inline constexpr Real kLeastSlip = Real(.01);

/// Did the contact slip as a whole in the previous step? As the tangential force grows, points reach their
/// cones one after another, the least loaded first. They yield at the static coefficient until most of the
/// load is on its cone and slips.
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

/// The load of an impact corresponds to at most this many times the stopped mass [1]. With more, rows do not
/// follow their bodies within the iterations. With less, the impact does not propagate through a pile.
inline constexpr Real kImpactMasses = 100;

/// Largest displacement of the bodies per step under the mass that corresponds to their load, over half the
/// thickness of the thinner body [1]. The resting penetration is 0.3 of it (docs/research/method.md).
inline constexpr Real kMostGive = Real(.05);

/// Stiffness per unit of load [1/m]: the mass that a load corresponds to, over dt^2, per newton. A weight
/// |lambda| corresponds to the mass |lambda| / a. An approach that stops in the step corresponds to at most
/// kImpactMasses |lambda| dt / speed. `thin`: half the thickness of the thinner body [m]. `gain`: columnGain,
/// 1 without a column.
RUBBLE_HD inline Real stiffnessPerLoad(const StepConstants& c, Real speed, Real thin, Real gain) {
  const Real full = c.loadAcceleration * c.dt * c.dt,
             give = (thin > Real(0) ? min(full, kMostGive * thin) : full) / gain;
  return Real(1) / max(give, speed * c.dt / kImpactMasses);
}

/// Factor of the stiffness of a contact in a column of N bodies [1]: (N / kStiffColumn)^2. N would keep the
/// share of the slowest compression that an iteration corrects, and N^2 also keeps a column from buckling.
RUBBLE_HD inline Real columnGain(const SolverData& s, const OrderedPair& o) {
  const bool aMoves = isDynamic(s, o.a), bMoves = isDynamic(s, o.b);
  const int ofA = columnBefore(s, o.a), ofB = columnBefore(s, o.b);
  const int bodies = aMoves && bMoves ? min(ofA, ofB) : aMoves ? ofA : bMoves ? ofB : 0;
  const Real relative = static_cast<Real>(bodies) / Real(kStiffColumn);
  return max(Real(1), relative * relative);
}

/// Upper bound of |lambda| of a contact with this closing speed [N].
RUBBLE_HD inline Real largestLoad(const SolverData& s, const OrderedPair& o, Real closing) {
  const Real inverseDt = s.step->inverseDt;
  Real mass = 0, massLength = 0;
  for (const int body : {o.a, o.b}) {
    const BodyParams& p = s.params[body];
    if (p.kind != BodyKind::Dynamic) continue;
    const Real island = fromFloatBits(s.islandMassLength[body]);
    mass = max(mass, p.mass), massLength = max(massLength, island > Real(0) ? island : kUnreached);
  }
  return max(kContactShare * massLength * inverseDt * inverseDt, kMostImpacts * mass * closing * inverseDt);
}

/// Initializes the rows of manifold i except for its points. `r` must be all zeros. `fastest`: closing speed
/// of the fastest contact point that stops an approach in this step, 0 if there is none [m/s].
RUBBLE_HD inline PairRows beginRows(const SolverData& s, int i, const PairPlace& place, Real fastest,
                                    ContactRows& r) {
  const Manifold& m = s.manifold[i];
  const OrderedPair& o = place.bodies;
  const StepConstants& c = s.stepOf(o.a);
  const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
  PairRows p;
  p.bodies = o;
  r.a = o.a, r.b = o.b, r.manifold = i;
  r.n = m.normal;
  r.offset = -place.t;
  r.length = place.length;
  const Real lighter = pa.kind != BodyKind::Dynamic   ? pb.mass
                       : pb.kind != BodyKind::Dynamic ? pa.mass
                                                      : min(pa.mass, pb.mass);
  r.start = startStiffness(c, lighter);
  const PairMaterial material = pairMaterial(s, s.pair[s.activePair[i]], o);
  p.bothMove = pa.kind == BodyKind::Dynamic && pb.kind == BodyKind::Dynamic;
  r.muStatic = material.muStatic, r.muDynamic = material.muDynamic;
  p.mu = r.muStatic != r.muDynamic && slides(m, r.muStatic) ? r.muDynamic : r.muStatic;
  r.restitution = material.restitution;
  r.most = largestLoad(s, o, pairSpeed(s, o.a, o.b, pa, pb).closing);
  p.surfaceShift = material.surfaceShift;
  p.heavier = startStiffness(c, max(pa.mass, pb.mass));
  p.settling = relativeSettling(s, o.a, o.b);
  p.normal = contactRule(c, r.start, r.length);
  const ShapeTables tables = s.shapeTables();
  const Real thin = thinner(innerRadiusOf(tables, pa.shape), innerRadiusOf(tables, pb.shape));
  const Real speed = max(fastest, impactSpeedBoundOf(s, o.a, o.b));
  p.normal.perLoad = r.perLoad = stiffnessPerLoad(c, speed, thin, columnGain(s, o));
  p.tangent = tangentRule(c, p.normal);
  return p;
}

/// Rows of points, in the order of ContactRows.
template <class L> struct PointRows { Quad<L> place, load, slip; };

/// Rows of points of a manifold: geometry, regularized errors, warm start [S 12] [S 17].
template <class L>
RUBBLE_HD RUBBLE_NEAR PointRows<L> pointRows(const SolverData& s, const Manifold& m, const PairRows& p,
                                             const PointsAt<L>& point, const ContactRows& r, int lane) {
  using A = LaneAccess<L>;
  const StepConstants& c = s.stepOf(p.bodies.a);
  const L zero = A::splat(0), oldN = A::load(m.kN, lane), oldT = A::load(m.kT, lane);
  const auto isActive = A::flags(m.activePoints, lane) != zero, stuck = A::flags(m.stick, lane) != zero,
             isNew = oldN == zero;
  StiffnessRuleT<L> normal = ruleOfPoints<L>(p.normal);
  const StiffnessRuleT<L> tangent = ruleOfPoints<L>(p.tangent);
  L most = A::splat(r.most);
  if (p.bothMove) {
    normal.limit = contactCeiling<L>(c, p.heavier, r.length, point.depth);
    most = minOf(most, normal.limit / normal.perLoad);
  }
  const L lambda = minOf(warmMultiplier(c, A::load(m.lambdaN, lane), true), most);
  L l1 = warmMultiplier(c, A::load(m.lambda1, lane), true),
    l2 = warmMultiplier(c, A::load(m.lambda2, lane), true);
  const L size2 = l1 * l1 + l2 * l2, bound = p.mu * lambda, cut = bound / sqrtOf(size2);
  const auto beyond = size2 > bound * bound;
  l1 = select(beyond, l1 * cut, l1), l2 = select(beyond, l2 * cut, l2);
  const auto stiffness = [&](const StiffnessRuleT<L>& rule, L old, L load) {
    return select(isActive, select(isNew, rule.start, warmStiffness(c, rule, old, load)), zero);
  };
  const L kN = stiffness(normal, oldN, lambda), kT = stiffness(tangent, oldT, sqrtOf(l1 * l1 + l2 * l2));
  // Rows correct only the share driftCorrection of a drift; displacements by surface velocity and settling
  // are corrected in full.
  Vec3 t1, t2;
  tangentBasis(r.n, t1, t2);
  const Real settling1 = dot(t1, p.settling), settling2 = dot(t2, p.settling);
  const L share = settlingShare(settling1 * settling1 + settling2 * settling2, bound, kT);
  const auto drift = [&](const Lanes& old, const Vec3& along, Real settling) {
    return c.driftCorrection *
           (select(stuck, A::load(old, lane), zero) +
            (A::splat(dot(along, p.surfaceShift)) + share * settling) / A::splat(c.driftCorrection));
  };
  return {{point.lever.x, point.lever.y, point.lever.z, inheritedViolation(c, point.depth)},
          {lambda, l1, l2, kN},
          {drift(m.drift1, t1, settling1), drift(m.drift2, t2, settling2), A::splat(p.mu), kT}};
}

/// Does point k stop a fast approach? Notes what that, and its depth, mean for other stages.
RUBBLE_HD inline bool notePoint(const SolverData& s, const Manifold& m, const PairRows& p,
                                const ContactRows& r, int k, Real depth, Real closing) {
  const StepConstants& c = s.stepOf(p.bodies.a);
  if (depth > c.contactMargin * r.length) notePressed(s, p.bodies, depth);
  if ((m.activePoints >> k & 1) && r.restitution > Real(0) && atomicLoad(&s.counters->bounces) == 0 &&
      isImpact(c, closing, r.length))
    atomicRaise(&s.counters->bounces, 1);
  return hits(c, closing, depth, r.length) && c.impactRule;
}

/// Builds the rows of point k in lane `to` of r. Returns whether the point stops a fast approach.
RUBBLE_HD inline bool buildPoint(const SolverData& s, const Manifold& m, const PairRows& p,
                                 const PointMotion<Real>& motion, int k, ContactRows& r, int to) {
  using A = LaneAccess<Real>;
  const PointRows<Real> rows = pointRows<Real>(s, m, p, motion.at, r, k);
  A::storeQuad(r.place, to, rows.place), A::storeQuad(r.load, to, rows.load);
  A::storeQuad(r.slip, to, rows.slip);
  return notePoint(s, m, p, r, k, motion.at.depth, motion.closing);
}

#if !defined(__CUDACC__)
/// The same for all points at once. Returns the bits of those that stop a fast approach.
inline unsigned buildPoints(const SolverData& s, const Manifold& m, const PairRows& p,
                            const PointMotion<Real4>& motion, ContactRows& r) {
  using A = LaneAccess<Real4>;
  PointRows<Real4> rows = pointRows<Real4>(s, m, p, motion.at, r, 0);
  if (m.count < kLanes) {
    const Real4 zero = A::splat(0);
    const auto isUsed = A::flags((1u << m.count) - 1, 0) != zero;
    for (Quad<Real4>* const quad : {&rows.place, &rows.load, &rows.slip})
      *quad = {select(isUsed, quad->x, zero), select(isUsed, quad->y, zero), select(isUsed, quad->z, zero),
               select(isUsed, quad->w, zero)};
    rows.slip.z = A::splat(p.mu);
  }
  A::storeQuad(r.place, 0, rows.place), A::storeQuad(r.load, 0, rows.load);
  A::storeQuad(r.slip, 0, rows.slip);
  unsigned impact = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k)
    if (notePoint(s, m, p, r, static_cast<int>(k), motion.at.depth[k], motion.closing[k])) impact |= 1u << k;
  return impact;
}
#endif

/// Does point k touch, up to the gap beyond which a point is inactive?
RUBBLE_HD inline bool holdsAt(const ContactRows& r, int k) {
  return r.load[k].kN > Real(0) && r.place[k].c0 > -kInactiveGap * r.length;
}

/// Level of the aggregates at which a contact unites its bodies: the finest level at which they share a cell
/// (cells.h). It unites them only if a point touches or stops an approach in this step (bits of `impact`).
/// Bodies move together after an impact, and body-by-body sweeps converge slowly to that motion.
RUBBLE_HD inline int joinLevel(const SolverData& s, const ContactRows& r, int impact) {
  for (int k = 0; k < kLanes; ++k)
    if (holdsAt(r, k) || (impact >> k & 1)) return finestSharedLevel(s, r.a, r.b);
  return kNoTouch;
}

/// Rows of manifold i at x^t. Inactive points have k = 0.
template <class L> struct BuildContactRows {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.hasRows[i] == 0) return;
    Manifold& m = s.manifold[i];
    m.row = s.rowOffset[i];
    ContactRows r;
    memset(static_cast<void*>(&r), 0, sizeof r);  // including unused points
    const PairPlace place = pairPlace(s, i);
    Real fastest = 0;
    unsigned impact = 0;
    if constexpr (sizeof(L) == sizeof(Real)) {
      PointMotion<Real> motion[kLanes];
      for (int k = 0; k < m.count; ++k) {
        motion[k] = pointMotion<Real>(s, m, place, k);
        fastest = max(fastest, stoppedSpeed(s, place, motion[k].closing, motion[k].at.depth));
      }
      const PairRows p = beginRows(s, i, place, fastest, r);
      for (PointSlip& slip : r.slip) slip.mu = p.mu;
      for (int k = 0; k < m.count; ++k)
        if (buildPoint(s, m, p, motion[k], k, r, k)) impact |= 1u << k;
    } else {
      const PointMotion<L> motion = pointMotion<L>(s, m, place, 0);
      for (std::size_t k = 0; k < static_cast<std::size_t>(m.count); ++k)
        fastest = max(fastest, stoppedSpeed(s, place, motion.closing[k], motion.at.depth[k]));
      impact = buildPoints(s, m, beginRows(s, i, place, fastest, r), motion, r);
    }
    m.impact = static_cast<ManifoldBits>(impact);
    s.contact[m.row] = r;
    s.rowBodies[m.row] = {r.a, r.b, i};
    s.joinLevel[m.row] = joinLevel(s, r, m.impact);
  }
};

/// Adds to the errors of the rows of manifold i what they leave out of a motion on an arc. Few worlds have
/// any, so rows are built without it.
struct AddArcs {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->arcs == 0 || s.hasRows[i] == 0) return;
    ContactRows& r = s.contact[s.manifold[i].row];
    const int arc = arcBody(s, {r.a, r.b});
    if (arc < 0) return;
    const bool onA = arc == r.a;
    const int part = partAt(s, r, onA);
    Vec3 t1, t2;
    tangentBasis(r.n, t1, t2);
    for (int k = 0; k < kLanes; ++k) {
      if (!(r.load[k].kN > Real(0))) continue;
      const Vec3 rA = r.place[k].rA;
      const Vec3 shift = onA ? arcShift(s, arc, part, rA, r.n) : -arcShift(s, arc, part, rA + r.offset, -r.n);
      r.place[k].c0 += dot(r.n, shift);
      r.slip[k].drift1 += dot(t1, shift), r.slip[k].drift2 += dot(t2, shift);
    }
  }
};

/// The dual update of one contact.
template <class L> struct UpdateContactDuals {
  static constexpr const char* kStage = "dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    constexpr int kStep = sizeof(L) / sizeof(Real);
    ContactRows& r = s.contact[i];
    for (int lane = 0; lane < kLanes; lane += kStep)
      updateContactDuals<L>(s.stepOf(r.a), r, s.dx[r.a], s.dx[r.b], lane);
  }
};

/// The last dual update; stores the state that the points pass to the next step.
template <class L> struct FinishContacts {
  static constexpr const char* kStage = "store";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    UpdateContactDuals<L>{}(s, i);
    store(s, i);
  }
  /// Stores what the dual update has left.
  RUBBLE_HD static void store(const SolverData& s, int i) {
    if constexpr (sizeof(L) > sizeof(Real)) {
      storePoints<L>(s, i);
    } else {
      const ContactRows& r = s.contact[i];
      Manifold& m = s.manifold[r.manifold];
      const StoredFrame f = storedFrame(r.n, s.dx[r.a], s.dx[r.b]);
      unsigned stick = 0;
      PointSupport even, odd;
      for (int k = 0; k < m.count; ++k) {
        const bool impact = m.impact >> k & 1;
        const PointBefore before = pointBefore(m, k, impact);
        noteBefore(s, i, m, k);
        const StoredPoint point = storedPoint(s, r, f, k, impact, before);
        remember(m, k, point.memory);
        if (point.sticks) stick |= 1u << k;
        PointSupport& sum = k % 2 == 0 ? even : odd;
        sum = sum + pointSupport(s, r, f.t1, f.t2, k, !impact);
      }
      m.stick = static_cast<ManifoldBits>(stick);
      s.support[i] = supportOf(r, even + odd);
    }
  }
};

}  // namespace rubble::RUBBLE_CORE

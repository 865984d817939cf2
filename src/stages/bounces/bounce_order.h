#pragma once
/// Contacts that act one after another; bounce.h describes the method.
#include "stages/bounces/impact.h"

namespace rubble::RUBBLE_CORE {

/// A contact takes part in an impact if its load changes by this share of impactSpeed() [1]. It has ended
/// when it closes by less than the second share.
inline constexpr Real kBounceReach = Real(.1), kBounceRest = Real(.02);
/// Largest number of rounds. Contacts that still close are left to the next step, and counted.
inline constexpr int kBounceRounds = 256;
/// Gauss-Seidel sweeps over the points of a contact.
inline constexpr int kBounceSweeps = 12;

enum BounceState : int { kBounceSeed = 1, kBounceTakesPart = 2, kBounceActed = 4 };
/// State of a body: not reached, in order, or with the velocity of the step.
enum BounceBody : int { kUnmoved, kInOrder, kAsSolved };

RUBBLE_HD inline bool isAsSolved(const SolverData& s, const ContactRows& r) {
  return (isDynamic(s, r.a) && s.bounceBody[r.a] == kAsSolved) ||
         (isDynamic(s, r.b) && s.bounceBody[r.b] == kAsSolved);
}
/// Separation speed after an approach with speed `closing` (bounce.h) [m/s].
RUBBLE_HD inline Real bounceSpeed(Real e, Real closing, const Bounce& bounce, Real inverseDt) {
  const Real b = bounce.change / 2, a = bounce.change * inverseDt;
  const Real squared = b * b + e * e * (closing * closing - 2 * b * closing + 2 * a * bounce.gap) -
                       2 * a * bounce.end;
  return max(b + std::sqrt(max(squared, Real(0))), Real(0));
}

/// Proposes the time at which a contact acts: the time until its gap closes [s].
struct ProposeBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    const ContactRows& r = s.contact[i];
    bounce.time = -1;
    if (isAsSolved(s, r)) {
      if (!(bounce.state & kBounceSeed) || (bounce.state & kBounceActed)) return;
      bounce.time = max(bounce.gap, Real(0)) / max(bounce.start, impactSpeed(s.stepOf(r.a), r.length));
    } else {
      const Impact impact(s, r);
      const BodyMotion a = motionOf(s, r.a), b = motionOf(s, r.b);
      Real fastest = 0;
      for (int k = 0; k < kLanes; ++k)
        if (actsAt(r, k)) fastest = max(fastest, impact.closing(k, a, b));
      if (!(fastest > kBounceRest * impactSpeed(s.stepOf(r.a), r.length))) return;
      bounce.time = max(bounce.gap, Real(0)) / fastest;
    }
    if (s.counters->bounceRounds < kBounceRounds) atomicCount(&s.counters->bounceLeft, 1);
  }
};

/// Does contact i act before j? Ties are broken by body ids.
RUBBLE_HD inline bool actsBefore(const SolverData& s, int i, int j) {
  const Real ti = s.bounce[i].time, tj = s.bounce[j].time;
  if (ti != tj) return ti < tj;
  const auto first = [&](const ContactRows& r) { return min(s.idOf[r.a], s.idOf[r.b]); };
  const auto second = [&](const ContactRows& r) { return max(s.idOf[r.a], s.idOf[r.b]); };
  const ContactRows &a = s.contact[i], &b = s.contact[j];
  if (first(a) != first(b)) return first(a) < first(b);
  if (second(a) != second(b)) return second(a) < second(b);
  return i < j;
}

struct ActBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart) || bounce.time < Real(0)) return;
    const ContactRows& r = s.contact[i];
    if (!isFirst(s, i, r.a) || !isFirst(s, i, r.b)) return;
    BodyMotion a = motionOf(s, r.a), b = motionOf(s, r.b);
    if (isAsSolved(s, r))
      giveBack(s, r, bounce, a, b);
    else
      act(s, r, bounce, a, b);
    bounce.state |= kBounceActed;
    if (!isFinite(a.v) || !isFinite(a.w) || !isFinite(b.v) || !isFinite(b.w)) return;
    limitSpin(a.w, s.step->dt), limitSpin(b.w, s.step->dt);
    if (isDynamic(s, r.a)) s.velocity[r.a] = a.v, s.angularVelocity[r.a] = a.w;
    if (isDynamic(s, r.b)) s.velocity[r.b] = b.v, s.angularVelocity[r.b] = b.w;
  }

 private:
  RUBBLE_HD static bool isFirst(const SolverData& s, int i, int body) {
    if (!isDynamic(s, body)) return true;
    for (int k = s.incidenceOffset[body]; k < s.incidenceOffset[body + 1]; ++k) {
      const std::uint32_t code = s.incidence[k].code;
      if (constraintType(code) != kContactType) break;
      const int j = constraintIndex(code);
      const Bounce& other = s.bounce[j];
      if (j != i && (other.state & kBounceTakesPart) && other.time >= Real(0) && actsBefore(s, j, i))
        return false;
    }
    return true;
  }

  /// Reduction of the closing speed of each point by impulses `p`.
  RUBBLE_HD static void effectOf(const Impact& impact, const Real (&p)[kLanes], Real (&effect)[kLanes]) {
    BodyMotion a{{0, 0, 0}, {0, 0, 0}}, b = a;
    impact.push(p, 1, a, b);
    for (int k = 0; k < kLanes; ++k) effect[k] = actsAt(impact.r, k) ? -impact.closing(k, a, b) : Real(0);
  }

  RUBBLE_HD static void act(const SolverData& s, const ContactRows& r, const Bounce& bounce, BodyMotion& a,
                            BodyMotion& b) {
    const Impact impact(s, r);
    Real c[kLanes], matrix[kLanes][kLanes], p[kLanes] = {}, effect[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      c[k] = actsAt(r, k) ? impact.closing(k, a, b) : Real(0);
      Real unit[kLanes] = {};
      unit[k] = actsAt(r, k) ? Real(1) : Real(0);
      effectOf(impact, unit, matrix[k]);
    }
    // starts from the loads of the step, scaled
    Real work = 0, stiff = 0;
    for (int k = 0; k < kLanes; ++k) p[k] = actsAt(r, k) ? max(r.load[k].lambdaN, Real(0)) : Real(0);
    effectOf(impact, p, effect);
    for (int k = 0; k < kLanes; ++k) work += p[k] * c[k], stiff += p[k] * effect[k];
    const Real scale = stiff > Real(0) ? max(work / stiff, Real(0)) : Real(0);
    for (Real& each : p) each *= scale;
    for (int sweep = 0; sweep < kBounceSweeps; ++sweep) {
      for (int k = 0; k < kLanes; ++k) {
        if (!actsAt(r, k) || !(matrix[k][k] > Real(0))) continue;
        Real left = c[k];
        for (int j = 0; j < kLanes; ++j) left -= matrix[j][k] * p[j];
        p[k] = max(p[k] + left / matrix[k][k], Real(0));
      }
    }
    Real sum = 0;
    effectOf(impact, p, effect);
    work = stiff = 0;
    for (int k = 0; k < kLanes; ++k) sum += p[k], work += p[k] * c[k], stiff += p[k] * effect[k];
    if (!(sum > Real(0)) || !(stiff > Real(0)) || !(work > Real(0))) return;
    const Real closing = work / sum;
    Real back = 0;
    if (r.restitution > Real(0) && closing > impactSpeed(s.stepOf(r.a), r.length)) {
      const bool asPredicted = (bounce.state & kBounceSeed) && !(bounce.state & kBounceActed);
      back = asPredicted ? bounceSpeed(r.restitution, closing, bounce, s.step->inverseDt) / closing
                         : r.restitution;
    }
    // the plastic part never exceeds what ends the approach, so energy does not grow
    const Real given = min(work / stiff, Real(1)) * (1 + back);
    impact.push(p, given, a, b);
    rub(s, r, impact, p, given, a, b);
  }

  /// Friction at the points, each within the cone of `given` times its impulse. It only opposes the remaining
  /// tangential motion.
  RUBBLE_HD static void rub(const SolverData& s, const ContactRows& r, const Impact& impact,
                            const Real (&p)[kLanes], Real given, BodyMotion& a, BodyMotion& b) {
    Vec3 t1, t2, surfaceShift{0, 0, 0};
    tangentBasis(r.n, t1, t2);
    if (s.surfaces > 0)
      surfaceShift = s.step->inverseDt *
                     pairMaterial(s, s.pair[s.activePair[r.manifold]], {r.a, r.b}).surfaceShift;
    Real room[kLanes], resists[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      room[k] = actsAt(r, k) ? r.slip[k].mu * given * p[k] : Real(0);
      if (!(room[k] > Real(0))) continue;
      const auto answer = [&](const Vec3& t) {
        BodyMotion ma{{0, 0, 0}, {0, 0, 0}}, mb = ma;
        impact.strike(k, t, ma, mb);
        return -impact.relative(k, ma, mb);
      };
      const Vec3 along1 = answer(t1), along2 = answer(t2);
      const Real k11 = dot(t1, along1), k22 = dot(t2, along2), k12 = dot(t1, along2);
      resists[k] = (k11 + k22) / 2 + std::sqrt((k11 - k22) * (k11 - k22) / 4 + k12 * k12);
    }
    for (int sweep = 0; sweep < kBounceSweeps; ++sweep)
      for (int k = 0; k < kLanes; ++k) {
        if (!(room[k] > Real(0))) continue;
        Vec3 u = impact.relative(k, a, b) + surfaceShift;
        u -= dot(r.n, u) * r.n;
        const Real speed = length(u);
        if (!(speed > Real(0))) continue;
        const Real impulse = min(speed / resists[k], room[k]);
        room[k] -= impulse;
        impact.strike(k, (impulse / speed) * u, a, b);
      }
  }

  /// Restitution in addition to the velocities of the step.
  RUBBLE_HD static void giveBack(const SolverData& s, const ContactRows& r, const Bounce& bounce,
                                 BodyMotion& a, BodyMotion& b) {
    const Impact impact(s, r);
    Real p[kLanes] = {}, effect[kLanes], load = 0;
    for (int k = 0; k < kLanes; ++k)
      if (actsAt(r, k)) p[k] = max(bounce.impulse[k], Real(0)), load += p[k];
    const Real closing = bounce.start + bounce.change;
    if (!(load > Real(0)) || !(closing > Real(0))) return;
    effectOf(impact, p, effect);
    Real stiff = 0, parting = 0;
    for (int k = 0; k < kLanes; ++k)
      stiff += p[k] * effect[k], parting -= actsAt(r, k) ? p[k] * impact.closing(k, a, b) : Real(0);
    const Real e = bounceSpeed(r.restitution, closing, bounce, s.step->inverseDt) / closing;
    const Displacement toA = targetDisplacement(s, r.a), toB = targetDisplacement(s, r.b);
    const BodyMotion freeA{s.step->inverseDt * toA.dp, s.step->inverseDt * toA.dw},
        freeB{s.step->inverseDt * toB.dp, s.step->inverseDt * toB.dw};
    const Real lost = max(impact.energy(freeA, freeB) - impact.energy(a, b), Real(0));
    // (stiff / 2) x^2 + parting x = work
    const Real work = e * e * min(load * closing / 2, lost);
    const Real x = stiff > Real(0) ? (std::sqrt(parting * parting + 2 * stiff * work) - parting) / stiff
                                   : Real(0);
    impact.push(p, max(x, Real(0)), a, b);
  }
};

/// The next step is warm-started with the loads before the impact.
struct EndBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    if (bounce.time >= Real(0)) atomicCount(&s.counters->bouncesLeft, 1);
    Manifold& m = s.manifold[s.contact[i].manifold];
    for (int k = 0; k < m.count; ++k)
      m.lambdaN[k] = bounce.before[k].x, m.lambda1[k] = bounce.before[k].y, m.lambda2[k] = bounce.before[k].z;
  }
};

}  // namespace rubble::RUBBLE_CORE

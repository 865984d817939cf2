#pragma once
/// Restitution: what an impact gives back, as impulses after the velocities of the step are known.
///
/// The rows of a step know no restitution: bodies that meet end it in touch, with the velocities of a plastic impact. What way and velocity are in such a
/// step must differ where e > 0, so this pass corrects velocities alone. Three parts:
///
///   seeds     contacts with e > 0 that closed faster than impactSpeed() at x^t and bear a load at the end
///   reach     from them along contacts in which the step has changed the load as an impact does, through dynamic bodies
///   in order  what the step has added to the loads of these contacts is taken back, so bodies have the velocities from before the impact; then contacts act
///             one after another, the earliest first, until none closes. Those of which none shares a body act in one round
///
/// One contact acts on two free bodies. Impulses p >= 0 of its points end the approach (a plastic impact, K p = c), and (1 + w / c) p are given:
///
///   (w - b)^2 = b^2 + e^2 (c^2 - 2 b c + 2 a d),   b = a dt / 2
///
/// with c the closing speed, d the gap at x^t and a the acceleration along the normal; w = e c without acceleration. The discrete free flight
/// v' = v + a dt, p' = p + v' dt keeps v^2 / 2 - a p - a dt v / 2, and the bounce has e^2 of it. Kinetic energy never grows without a, momentum is exact.
///
/// A body whose velocity the contacts do not explain (a joint took part) keeps the velocity of the step, and so do those that it reaches: their seeds give back
/// e^2 of the work that ended the approach, P c / 2, on top of it.
#include "stages/bodies.h"

namespace rubble::RUBBLE_CORE {

/// A contact takes part in an impact that changes its load by so much of impactSpeed() [1], and has ended when it closes by less.
inline constexpr Real kBounceReach = Real(.1), kBounceRest = Real(.02);
/// Rounds of contacts that act; what closes after them is left to the next step, and counted.
inline constexpr int kBounceRounds = 256;
/// Sweeps over the points of a contact.
inline constexpr int kBounceSweeps = 12;

enum BounceState : int { kBounceSeed = 1, kBounceTakesPart = 2, kBounceActed = 4 };
/// Of bodies: no part, part, part with what the step gave them.
enum BounceBody : int { kUnmoved, kInOrder, kAsSolved };

/// How an impulse at a point moves a body.
struct Mobility {
  Real inverseMass;
  Sym3 inertia;  ///< 0 for what does not turn
  int locks;
  bool moves;

  RUBBLE_HD Vec3 linear(const Vec3& impulse) const { return moves ? unlocked(inverseMass * impulse, locks) : Vec3{0, 0, 0}; }
  RUBBLE_HD Vec3 angular(Vec3 moment) const {
    if (!moves) return {0, 0, 0};
    moment = unlocked(moment, locks >> 3);
    return unlocked(solve(Block3{inertia, moment}), locks >> 3);
  }
};
RUBBLE_HD inline Mobility mobility(const View& s, int body) {
  if (!isDynamic(s, body)) return {0, {}, 0, false};
  const BodyTarget& t = s.target[body];
  Mobility m{Real(1) / t.mass.mass, t.mass.inertia, t.locks, true};
  const auto keep = [&](int axis) { return (m.locks >> (3 + axis) & 1) == 0; };
  if (!keep(0) || !keep(1)) m.inertia.xy = 0;
  if (!keep(0) || !keep(2)) m.inertia.xz = 0;
  if (!keep(1) || !keep(2)) m.inertia.yz = 0;
  return m;
}

RUBBLE_HD inline Motion motionOf(const View& s, int body) { return {s.velocity[body], s.spin[body]}; }

/// A contact between two bodies that move.
struct Impact {
  const ContactRows& r;
  Mobility a, b;

  RUBBLE_HD Impact(const View& s, const ContactRows& rows) : r(rows), a(mobility(s, rows.a)), b(mobility(s, rows.b)) {}
  RUBBLE_HD Vec3 leverA(int k) const { return r.place[k].rA; }
  RUBBLE_HD Vec3 leverB(int k) const { return r.place[k].rA + r.offset; }
  RUBBLE_HD Real closing(int k, const Motion& ma, const Motion& mb) const {
    return dot(r.n, ma.v + cross(ma.w, leverA(k)) - mb.v - cross(mb.w, leverB(k)));
  }
  /// Adds impulses along the normal that push the bodies apart.
  RUBBLE_HD void push(const Real (&p)[kLanes], Real times, Motion& ma, Motion& mb) const {
    Real sum = 0;
    Vec3 momentA{0, 0, 0}, momentB{0, 0, 0};
    for (int k = 0; k < kLanes; ++k) {
      sum += p[k];
      momentA += cross(leverA(k), p[k] * r.n), momentB += cross(leverB(k), p[k] * r.n);
    }
    ma.v -= a.linear(times * sum * r.n), ma.w -= a.angular(times * momentA);
    mb.v += b.linear(times * sum * r.n), mb.w += b.angular(times * momentB);
  }
};

/// Does a point take part in the step?
RUBBLE_HD inline bool actsAt(const ContactRows& r, int k) { return r.load[k].kN > Real(0); }

/// Contacts of a step in which something may bounce.
struct CountBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int) const { s.counters->bounceRows = s.counters->bounces > 0 ? s.counters->manifolds : 0; }
};

struct StartBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->bounceRows > 0) s.bounceBody[i] = kUnmoved;
  }
};

RUBBLE_HD inline void reachBody(const View& s, int body, int how) {
  if (isDynamic(s, body)) atomicRaise(&s.bounceBody[body], how);
}

/// Seeds, and what every contact would hand on. Reads velocities of x^t.
struct FindBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const StepConstants& c = s.step;
    const ContactRows& r = s.contact[i];
    Bounce& bounce = s.bounce[i];
    const Impact impact(s, r);
    const Displacement toA = targetDisplacement(s, r.a), toB = targetDisplacement(s, r.b);
    const Motion startA = motionOf(s, r.a), startB = motionOf(s, r.b), freeA{c.inverseDt * toA.dp, c.inverseDt * toA.dw}, freeB{c.inverseDt * toB.dp, c.inverseDt * toB.dw};
    const Real fast = impactSpeed(c, r.length);
    Real load = 0, change = 0, closing = 0, free = 0, gap = 0;
    bool seed = false;
    for (int k = 0; k < kLanes; ++k) {
      bounce.impulse[k] = 0;
      if (!actsAt(r, k)) continue;
      const Real lambda = r.load[k].lambdaN, speed = impact.closing(k, startA, startB);
      bounce.impulse[k] = (lambda - bounce.before[k].x) * c.dt;
      load += lambda, change += absOf(bounce.impulse[k]);
      closing += lambda * speed, free += lambda * impact.closing(k, freeA, freeB);
      gap += lambda * max(-r.place[k].c0, Real(0));
      seed |= r.restitution > Real(0) && lambda > Real(0) && speed > fast;
    }
    if (load > Real(0)) closing /= load, free /= load, gap /= load;
    bounce.start = closing, bounce.change = free - closing, bounce.gap = gap;
    bounce.carries = load > Real(0) && change * (impact.a.inverseMass + impact.b.inverseMass) > kBounceReach * fast;
    bounce.state = seed ? kBounceSeed | kBounceTakesPart : 0;
    bounce.time = -1;
    if (!seed) return;
    reachBody(s, r.a, kInOrder), reachBody(s, r.b, kInOrder);
    atomicCount(&s.counters->bounceSpread, 1);
  }
};

/// One round of the reach.
RUBBLE_HD inline bool isReached(const View& s, const ContactRows& r) { return s.bounceBody[r.a] * isDynamic(s, r.a) + s.bounceBody[r.b] * isDynamic(s, r.b) > 0; }
struct ReachBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const ContactRows& r = s.contact[i];
    if (!s.bounce[i].carries || !isReached(s, r)) return;
    s.bounce[i].state |= kBounceTakesPart;
    reachBody(s, r.a, kInOrder), reachBody(s, r.b, kInOrder);
  }
};
struct FindReach {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Bounce& b = s.bounce[i];
    if (b.carries && !(b.state & kBounceTakesPart) && isReached(s, s.contact[i])) atomicCount(&s.counters->bounceSpread, 1);
  }
};

/// Velocities from before the impact.
struct TakeBackBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->bounceRows == 0 || s.bounceBody[i] == kUnmoved || !isDynamic(s, i)) return;
    const Mobility m = mobility(s, i);
    Vec3 taken{0, 0, 0}, takenMoment{0, 0, 0}, kept{0, 0, 0}, keptMoment{0, 0, 0};
    bool alone = true;
    for (int k = s.entryOffset[i]; k < s.entryOffset[i + 1]; ++k) {
      const std::uint32_t code = s.entry[k].code;
      const int row = entryIndex(code);
      if (entryType(code) != kContactType || !(s.bounce[row].state & kBounceTakesPart)) {
        alone = false;
        continue;
      }
      const ContactRows& r = s.contact[row];
      const bool onA = entrySide(code) == 0;
      const Real sign = onA ? Real(-1) : Real(1);
      Vec3 t1, t2;
      tangentBasis(r.n, t1, t2);
      for (int p = 0; p < kLanes; ++p) {
        if (!actsAt(r, p)) continue;
        const Vec3 lever = onA ? r.place[p].rA : r.place[p].rA + r.offset;
        const Vec3 back = sign * s.bounce[row].impulse[p] * r.n;
        const Vec3 left = sign * s.step.dt * (s.bounce[row].before[p].x * r.n + r.load[p].lambda1 * t1 + r.load[p].lambda2 * t2);
        taken += back, takenMoment += cross(lever, back);
        kept += left, keptMoment += cross(lever, left);
      }
    }
    Motion& solved = s.bounceMotion[i];
    solved = motionOf(s, i);
    Motion now{solved.v - m.linear(taken), solved.w - m.angular(takenMoment)};
    if (alone && !s.rolls) {
      // nothing else acts on it: what iterations have left out does not count
      const Displacement to = targetDisplacement(s, i);
      now = {s.step.inverseDt * to.dp + m.linear(kept), s.step.inverseDt * to.dw + m.angular(keptMoment)};
    }
    if (!isFinite(now.v) || !isFinite(now.w)) return;
    s.velocity[i] = now.v, s.spin[i] = now.w;
  }
};

/// Closing speed of a contact, by the loads of its points.
RUBBLE_HD inline Real meanClosing(const Impact& impact, const Motion& a, const Motion& b) {
  Real load = 0, closing = 0;
  for (int k = 0; k < kLanes; ++k) {
    if (!actsAt(impact.r, k)) continue;
    load += impact.r.load[k].lambdaN, closing += impact.r.load[k].lambdaN * impact.closing(k, a, b);
  }
  return load > Real(0) ? closing / load : Real(0);
}

/// Contacts with bodies whose velocities from before the impact are not what they were: something else took part.
struct CheckBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    const ContactRows& r = s.contact[i];
    const Impact impact(s, r);
    Real change = 0;
    for (const Real p : bounce.impulse) change += absOf(p);
    constexpr Real kUnexplained = Real(.2);
    const Real off = meanClosing(impact, motionOf(s, r.a), motionOf(s, r.b)) - bounce.start;
    const Real allowed = kUnexplained * change * (impact.a.inverseMass + impact.b.inverseMass) + 2 * absOf(bounce.change) + impactSpeed(s.step, r.length) / 2;
    if (absOf(off) <= allowed) return;
    reachBody(s, r.a, kAsSolved), reachBody(s, r.b, kAsSolved);
    atomicCount(&s.counters->bounceBound, 1);
  }
};
RUBBLE_HD inline bool isAsSolved(const View& s, const ContactRows& r) {
  return (isDynamic(s, r.a) && s.bounceBody[r.a] == kAsSolved) || (isDynamic(s, r.b) && s.bounceBody[r.b] == kAsSolved);
}
struct ReachSolved {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const ContactRows& r = s.contact[i];
    if ((s.bounce[i].state & kBounceTakesPart) && isAsSolved(s, r)) reachBody(s, r.a, kAsSolved), reachBody(s, r.b, kAsSolved);
  }
};
struct FindSolved {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const ContactRows& r = s.contact[i];
    if (!(s.bounce[i].state & kBounceTakesPart) || !isAsSolved(s, r)) return;
    const auto behind = [&](int body) { return isDynamic(s, body) && s.bounceBody[body] != kAsSolved; };
    if (behind(r.a) || behind(r.b)) atomicCount(&s.counters->bounceBound, 1);
  }
};
struct RestoreSolved {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (s.counters->bounceRows == 0 || s.bounceBody[i] != kAsSolved || !isDynamic(s, i)) return;
    s.velocity[i] = s.bounceMotion[i].v, s.spin[i] = s.bounceMotion[i].w;
  }
};

/// Speed at which bodies part that closed with c; see above.
RUBBLE_HD inline Real bounceSpeed(Real e, Real closing, Real change, Real gap, Real inverseDt) {
  const Real b = change / 2;
  return b + std::sqrt(max(b * b + e * e * (closing * closing - 2 * b * closing + 2 * change * inverseDt * gap), Real(0)));
}

/// When a contact is to act: the time until its gap is closed.
struct ProposeBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    const ContactRows& r = s.contact[i];
    bounce.time = -1;
    if (isAsSolved(s, r)) {
      if (!(bounce.state & kBounceSeed) || (bounce.state & kBounceActed)) return;
      bounce.time = bounce.gap / max(bounce.start, impactSpeed(s.step, r.length));
    } else {
      const Impact impact(s, r);
      const Motion a = motionOf(s, r.a), b = motionOf(s, r.b);
      Real fastest = 0;
      for (int k = 0; k < kLanes; ++k)
        if (actsAt(r, k)) fastest = max(fastest, impact.closing(k, a, b));
      if (!(fastest > kBounceRest * impactSpeed(s.step, r.length))) return;
      bounce.time = bounce.gap / fastest;
    }
    if (s.counters->bounceTurns < kBounceRounds) atomicCount(&s.counters->bounceLeft, 1);
  }
};

/// Is contact i before j in the order in which contacts act?
RUBBLE_HD inline bool actsBefore(const View& s, int i, int j) {
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
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart) || bounce.time < Real(0)) return;
    const ContactRows& r = s.contact[i];
    if (!isFirst(s, i, r.a) || !isFirst(s, i, r.b)) return;
    Motion a = motionOf(s, r.a), b = motionOf(s, r.b);
    if (isAsSolved(s, r)) giveBack(s, r, bounce, a, b);
    else act(s, r, bounce, a, b);
    bounce.state |= kBounceActed;
    if (!isFinite(a.v) || !isFinite(a.w) || !isFinite(b.v) || !isFinite(b.w)) return;
    if (isDynamic(s, r.a)) s.velocity[r.a] = a.v, s.spin[r.a] = a.w;
    if (isDynamic(s, r.b)) s.velocity[r.b] = b.v, s.spin[r.b] = b.w;
  }

 private:
  RUBBLE_HD static bool isFirst(const View& s, int i, int body) {
    if (!isDynamic(s, body)) return true;
    for (int k = s.entryOffset[body]; k < s.entryOffset[body + 1]; ++k) {
      const std::uint32_t code = s.entry[k].code;
      if (entryType(code) != kContactType) break;
      const int j = entryIndex(code);
      const Bounce& other = s.bounce[j];
      if (j != i && (other.state & kBounceTakesPart) && other.time >= Real(0) && actsBefore(s, j, i)) return false;
    }
    return true;
  }

  /// What a unit of impulses `p` takes from the closing speed of each point.
  RUBBLE_HD static void effectOf(const Impact& impact, const Real (&p)[kLanes], Real (&effect)[kLanes]) {
    Motion a{{0, 0, 0}, {0, 0, 0}}, b = a;
    impact.push(p, 1, a, b);
    for (int k = 0; k < kLanes; ++k) effect[k] = actsAt(impact.r, k) ? -impact.closing(k, a, b) : Real(0);
  }

  RUBBLE_HD static void act(const View& s, const ContactRows& r, const Bounce& bounce, Motion& a, Motion& b) {
    const Impact impact(s, r);
    Real c[kLanes], matrix[kLanes][kLanes], p[kLanes] = {}, effect[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      c[k] = actsAt(r, k) ? impact.closing(k, a, b) : Real(0);
      Real unit[kLanes] = {};
      unit[k] = actsAt(r, k) ? Real(1) : Real(0);
      effectOf(impact, unit, matrix[k]);
    }
    // begins with the loads of the step, to scale
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
    if (r.restitution > Real(0) && closing > impactSpeed(s.step, r.length)) {
      const bool asPredicted = (bounce.state & kBounceSeed) && !(bounce.state & kBounceActed);
      back = asPredicted ? bounceSpeed(r.restitution, closing, bounce.change, bounce.gap, s.step.inverseDt) / closing : r.restitution;
    }
    // never more than ends the approach: energy
    impact.push(p, min(work / stiff, Real(1)) * (1 + back), a, b);
  }

  /// On top of the velocities of the step.
  RUBBLE_HD static void giveBack(const View& s, const ContactRows& r, const Bounce& bounce, Motion& a, Motion& b) {
    const Impact impact(s, r);
    Real p[kLanes] = {}, effect[kLanes], load = 0;
    for (int k = 0; k < kLanes; ++k)
      if (actsAt(r, k)) p[k] = max(bounce.impulse[k], Real(0)), load += p[k];
    const Real closing = bounce.start + bounce.change;
    if (!(load > Real(0)) || !(closing > Real(0))) return;
    effectOf(impact, p, effect);
    Real stiff = 0, parting = 0;
    for (int k = 0; k < kLanes; ++k) stiff += p[k] * effect[k], parting -= actsAt(r, k) ? p[k] * impact.closing(k, a, b) : Real(0);
    const Real e = bounceSpeed(r.restitution, closing, bounce.change, bounce.gap, s.step.inverseDt) / closing;
    // (stiff / 2) x^2 + parting x = e^2 load closing / 2
    const Real x = stiff > Real(0) ? (std::sqrt(parting * parting + stiff * e * e * load * closing) - parting) / stiff : Real(0);
    impact.push(p, max(x, Real(0)), a, b);
  }
};

/// The next step begins with the loads from before the impact.
struct EndBounces {
  static constexpr const char* kName = "bounce";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    if (bounce.time >= Real(0)) atomicCount(&s.counters->bouncesLeft, 1);
    Manifold& m = s.manifold[s.contact[i].manifold];
    for (int k = 0; k < m.count; ++k) m.lambdaN[k] = bounce.before[k].x, m.lambda1[k] = bounce.before[k].y, m.lambda2[k] = bounce.before[k].z;
  }
};

/// Before velocities are known: who takes part.
template <class E>
void findBounces(E& e) {
  e.forEach(StartBounces{}, e.view().bodies);
  e.forEach(FindBounces{}, &Counters::bounceRows);
  e.rounds(ReachBounces{}, FindReach{}, &Counters::bounceRows, &Counters::bounceSpread, &Counters::bounceSpreads);
}
/// When they are.
template <class E>
void actBounces(E& e) {
  const int bodies = e.view().bodies;
  e.forEach(TakeBackBounces{}, bodies);
  e.forEach(CheckBounces{}, &Counters::bounceRows);
  e.rounds(ReachSolved{}, FindSolved{}, &Counters::bounceRows, &Counters::bounceBound, &Counters::bounceBounds);
  e.forEach(RestoreSolved{}, bodies);
  e.forEach(ProposeBounces{}, &Counters::bounceRows);
  e.rounds(ActBounces{}, ProposeBounces{}, &Counters::bounceRows, &Counters::bounceLeft, &Counters::bounceTurns);
  e.forEach(EndBounces{}, &Counters::bounceRows);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Restitution: impulses that are applied after the velocities of the step are known.
///
/// The rows of a step have no restitution: colliding bodies end it in contact, with the velocities of a
/// plastic impact. With e > 0 displacement and velocity must differ, so this pass changes velocities only. It
/// has three parts:
///
///   seeds     contacts with e > 0 that closed faster than impactSpeed() at x^t and carry a load at the end
///   reach     from them along contacts whose load the step has changed as in an impact, through dynamic
///             bodies
///   in order  The change of the loads of these contacts by the step is undone, which restores the velocities
///             before the impact. Then contacts act one after another, the earliest first, until none
///             closes. All contacts that share no body with an earlier one act in one round.
///
/// One contact acts on two free bodies. Impulses p >= 0 of its points end the approach, a plastic impact with
/// K p = c, and (1 + w / c) p are applied:
///
///   (w - b)^2 = b^2 + e^2 (c^2 - 2 b c + 2 a d) - 2 a d',   b = a dt / 2
///
/// c: closing speed; a: acceleration along the normal; d and d': gaps at the ends of the step. Without
/// acceleration w = e c. Discrete free flight conserves an energy, of which the bounce has e^2:
///
///   v' = v + a dt,  p' = p + v' dt,  v^2 / 2 - a p - a dt v / 2 = constant
///
/// Friction then reduces the tangential speeds at the points by at most mu (1 + w / c) p. Without
/// acceleration kinetic energy never grows. Momentum is conserved exactly.
///
/// If contacts do not explain the velocity change of a body (a joint took part), it keeps the velocity of the
/// step. So do the bodies that it reaches. Their seeds give back e^2 of P c / 2, the work that ended the
/// approach, in addition to that velocity and without friction. This work is at most the energy that the two
/// bodies have lost.
#include "stages/bounces/bounce_order.h"

namespace rubble::RUBBLE_CORE {

/// Number of contacts to process: all if any of them may bounce, else none.
struct CountBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int) const {
    s.counters->bounceRows = s.counters->bounces > 0 ? s.counters->manifolds : 0;
  }
};

struct StartBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->bounceRows > 0) s.bounceBody[i] = kUnmoved;
  }
};

RUBBLE_HD inline void reachBody(const SolverData& s, int body, int how) {
  if (isDynamic(s, body)) atomicRaise(&s.bounceBody[body], how);
}

/// Finds the seeds, and the change of load of every contact. Reads velocities at x^t.
struct FindBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const ContactRows& r = s.contact[i];
    const StepConstants& c = s.stepOf(r.a);
    Bounce& bounce = s.bounce[i];
    const Impact impact(s, r);
    const Displacement toA = targetDisplacement(s, r.a), toB = targetDisplacement(s, r.b);
    const BodyMotion startA = motionOf(s, r.a), startB = motionOf(s, r.b);
    const BodyMotion freeA{c.inverseDt * toA.dp, c.inverseDt * toA.dw},
        freeB{c.inverseDt * toB.dp, c.inverseDt * toB.dw};
    const Real fast = impactSpeed(c, r.length);
    const Displacement endA = endOf(s, r.a), endB = endOf(s, r.b);
    Real load = 0, change = 0, closing = 0, free = 0, gap = 0, end = 0;
    bool seed = false;
    for (int k = 0; k < kLanes; ++k) {
      bounce.impulse[k] = 0;
      if (!actsAt(r, k)) continue;
      bounce.before[k] = restingPart(bounce.before[k], r.load[k].lambdaN);
      const Real lambda = r.load[k].lambdaN, speed = impact.closing(k, startA, startB);
      bounce.impulse[k] = (lambda - bounce.before[k].x) * c.dt;
      load += lambda, change += absOf(bounce.impulse[k]);
      closing += lambda * speed, free += lambda * impact.closing(k, freeA, freeB);
      // including the part of a penetration that alpha leaves uncorrected
      const Real apart = r.place[k].c0 > Real(0) ? -r.place[k].c0 / max(Real(1) - c.alpha, Real(.01))
                                                 : -r.place[k].c0;
      const Vec3 moved = endA.dp + cross(endA.dw, r.place[k].rA) - endB.dp -
                         cross(endB.dw, r.place[k].rA + r.offset);
      gap += lambda * apart, end += lambda * (apart - dot(r.n, moved));
      seed |= r.restitution > Real(0) && lambda > Real(0) && speed > fast;
    }
    if (load > Real(0)) closing /= load, free /= load, gap /= load, end /= load;
    bounce.start = closing, bounce.change = free - closing, bounce.gap = gap, bounce.end = end;
    bounce.carries = load > Real(0) &&
                     change * (impact.a.inverseMass + impact.b.inverseMass) > kBounceReach * fast;
    bounce.state = seed ? kBounceSeed | kBounceTakesPart : 0;
    bounce.time = -1;
    if (!seed) return;
    reachBody(s, r.a, kInOrder), reachBody(s, r.b, kInOrder);
    atomicCount(&s.counters->bounceSpread, 1);
  }
  /// The part of the initial load of a point that it still carries.
  RUBBLE_HD static Vec3 restingPart(const Vec3& before, Real lambda) {
    return before.x > lambda ? (max(lambda, Real(0)) / before.x) * before : before;
  }
  RUBBLE_HD static Displacement endOf(const SolverData& s, int body) {
    return isDynamic(s, body) && s.ccdShareBits[body] != 0 ? s.ccdMotion[body] : s.dx[body];
  }
};

/// Has the impact reached a body of the contact?
RUBBLE_HD inline bool isReached(const SolverData& s, const ContactRows& r) {
  return (isDynamic(s, r.a) && s.bounceBody[r.a] != kUnmoved) ||
         (isDynamic(s, r.b) && s.bounceBody[r.b] != kUnmoved);
}
struct ReachBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const ContactRows& r = s.contact[i];
    if (!s.bounce[i].carries || !isReached(s, r)) return;
    s.bounce[i].state |= kBounceTakesPart;
    reachBody(s, r.a, kInOrder), reachBody(s, r.b, kInOrder);
  }
};
struct FindReach {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounce& b = s.bounce[i];
    if (b.carries && !(b.state & kBounceTakesPart) && isReached(s, s.contact[i]))
      atomicCount(&s.counters->bounceSpread, 1);
  }
};

/// Has the contact rolling or torsional friction?
RUBBLE_HD inline bool rollsAt(const SolverData& s, const ContactRows& r) {
  return s.rolls && (s.rolling[r.manifold].rolling > Real(0) || s.rolling[r.manifold].torsional > Real(0));
}

/// Restores the velocities before the impact.
struct TakeBackBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->bounceRows == 0 || s.bounceBody[i] == kUnmoved || !isDynamic(s, i)) return;
    const Mobility m = mobility(s, i);
    BodyMotion taken{{0, 0, 0}, {0, 0, 0}}, kept = taken;
    bool alone = true;
    for (int k = s.incidenceOffset[i]; k < s.incidenceOffset[i + 1]; ++k) {
      const std::uint32_t code = s.incidence[k].code;
      if (constraintType(code) != kContactType) {
        alone = false;
        continue;
      }
      const ContactRows& r = s.contact[constraintIndex(code)];
      const Bounce& bounce = s.bounce[constraintIndex(code)];
      alone &= !rollsAt(s, r);
      const bool onA = constraintSide(code) == 0, takesPart = bounce.state & kBounceTakesPart;
      Vec3 t1, t2;
      tangentBasis(r.n, t1, t2);
      for (int p = 0; p < kLanes; ++p) {
        if (!actsAt(r, p)) continue;
        const Vec3 lever = onA ? r.place[p].rA : r.place[p].rA + r.offset, before = bounce.before[p];
        const Vec3 load{r.load[p].lambdaN, r.load[p].lambda1, r.load[p].lambda2},
            left = takesPart ? before : load, gone = load - left;
        const auto impulse = [&](const Vec3& f) {
          return (onA ? -s.step->dt : s.step->dt) * (f.x * r.n + f.y * t1 + f.z * t2);
        };
        taken.v += impulse(gone), taken.w += cross(lever, impulse(gone));
        kept.v += impulse(left), kept.w += cross(lever, impulse(left));
      }
    }
    BodyMotion& solved = s.bounceMotion[i];
    solved = motionOf(s, i);
    BodyMotion now{solved.v - m.linear(taken.v), solved.w - m.angular(taken.w)};
    if (alone) {
      // only contacts act on it: free flight plus the kept impulses has no iteration error
      const Displacement to = targetDisplacement(s, i);
      now = {s.step->inverseDt * to.dp + m.linear(kept.v), s.step->inverseDt * to.dw + m.angular(kept.w)};
    }
    if (!isFinite(now.v) || !isFinite(now.w)) return;
    s.velocity[i] = now.v, s.angularVelocity[i] = now.w;
  }
};

/// Mean closing speed of a contact, weighted by the loads of its points [m/s].
RUBBLE_HD inline Real meanClosing(const Impact& impact, const BodyMotion& a, const BodyMotion& b) {
  Real load = 0, closing = 0;
  for (int k = 0; k < kLanes; ++k) {
    if (!actsAt(impact.r, k)) continue;
    load += impact.r.load[k].lambdaN, closing += impact.r.load[k].lambdaN * impact.closing(k, a, b);
  }
  return load > Real(0) ? closing / load : Real(0);
}

/// Finds contacts whose restored closing speed differs from that at x^t, because something else took part.
struct CheckBounces {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const Bounce& bounce = s.bounce[i];
    if (!(bounce.state & kBounceTakesPart)) return;
    const ContactRows& r = s.contact[i];
    const Impact impact(s, r);
    constexpr Real kUnexplained = Real(.2);
    const Real off = meanClosing(impact, motionOf(s, r.a), motionOf(s, r.b)) - bounce.start;
    const Real allowed = kUnexplained * absOf(bounce.start) + 2 * absOf(bounce.change) +
                         impactSpeed(s.stepOf(r.a), r.length) / 2;
    if (absOf(off) <= allowed) return;
    reachBody(s, r.a, kAsSolved), reachBody(s, r.b, kAsSolved);
    atomicCount(&s.counters->bounceBound, 1);
  }
};
struct ReachSolved {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const ContactRows& r = s.contact[i];
    if ((s.bounce[i].state & kBounceTakesPart) && isAsSolved(s, r))
      reachBody(s, r.a, kAsSolved), reachBody(s, r.b, kAsSolved);
  }
};
struct FindSolved {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const ContactRows& r = s.contact[i];
    if (!(s.bounce[i].state & kBounceTakesPart) || !isAsSolved(s, r)) return;
    const auto behind = [&](int body) { return isDynamic(s, body) && s.bounceBody[body] != kAsSolved; };
    if (behind(r.a) || behind(r.b)) atomicCount(&s.counters->bounceBound, 1);
  }
};
struct RestoreSolved {
  static constexpr const char* kStage = "bounce";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.counters->bounceRows == 0 || s.bounceBody[i] != kAsSolved || !isDynamic(s, i)) return;
    s.velocity[i] = s.bounceMotion[i].v, s.angularVelocity[i] = s.bounceMotion[i].w;
  }
};

}  // namespace rubble::RUBBLE_CORE

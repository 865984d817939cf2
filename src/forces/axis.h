#pragma once
/// A scalar coordinate c(x) of a joint (an angle, a travel or a length) and its up to four rows. They share
/// one Jacobian.
///
///   limit     c in [lo, hi]; lo = hi: locked. Hard, or with stiffness and damper
///   drive     toward a position and a speed, by stiffness and damper (either may be hard), with a largest
///             force
///   friction  against any motion, up to a bound
///   rotor     inertia I and viscous damping D of what turns with the coordinate, and an applied force T
///
/// Each of the first three rows has the force of an interval [l, h]; for drive and friction l = h:
///
///   F = s (k (c - h) + lambda) if that is above 0,  s (k (c - l) + lambda) if that is below 0,  else 0;
///   cut to [-bound, bound]
///
/// This is the force of the augmented Lagrangian of l <= c <= h. At most one of the two conditions holds,
/// since l <= h. A damper D and a stiffness K form one finite row: K_tot = K + D / dt, and the error is C - w
/// C(x^t) with w = (D / dt) / K_tot. [N, N m]
///
/// The rotor row is linear: I c'' + D c' - T by implicit Euler, without multiplier or bound.
///
///   F = (I / dt^2 + D / dt) (c - c(x^t)) - I / dt (c(x^t) - c(x^(t-1))) / dt - T
#include "solver/row.h"

namespace rubble::RUBBLE_CORE {

/// A stiffness [N/m, N m/rad] or damper [N s/m, N m s/rad] of at least this is hard; a bound of at least this
/// is none.
inline constexpr Real kHardValue = Real(1e18);
/// A limit of at least this is none [m, rad].
inline constexpr Real kNoLimit = Real(1e18);
/// An unloaded limit is inactive if the coordinate stays inside even at this many times its predicted change
/// [1] ...
inline constexpr Real kInactiveReach = Real(1.5);
/// ... unless it is within this distance of the limit, in rad or in characteristic lengths, where an impact
/// may drive it across [rad, 1]. Then it is watched: its stiffness is zero until it is crossed, so that free
/// motion stays free.
inline constexpr Real kWatchReach = Real(1.5);

/// Authored parameters.
struct AxisSpec {
  Real lo, hi;  ///< [m], [rad]
  Real limitStiffness, limitDamping;
  Real target, speed;  ///< target of the drive [m, rad], [m/s, rad/s]
  Real driveStiffness, driveDamping;
  Real driveBound;  ///< largest force of the drive [N, N m]
  Real friction;    ///< largest friction force [N, N m]
  Real armature;    ///< I [kg, kg m2]
  Real damping;     ///< D [N s/m, N m s/rad]
  Real force;       ///< T [N, N m]
};

/// One row of a coordinate: persistent state (lambda, k) and the data of a step.
struct AxisRow {
  Real lambda, k;
  Real lo, hi;      ///< interval after regularization
  Real compliance;  ///< 1 / K_tot; 0: hard
  Real bound;
  int active;  ///< 0, 1 or kWatched; an int, because states compared byte by byte must have no padding
  int keepsMultiplier;  ///< 0, 1
};

inline constexpr int kWatched = 2;

/// The rotor row: F = k (c - origin) + load.
struct RotorRow {
  Real k, origin, load;
  Real force;  ///< F after the last dual update [N, N m]
  int active;  ///< 0, 1
};

struct alignas(4 * sizeof(Real)) AxisRows {
  AxisRow limit, drive, friction;
  RotorRow rotor;
  Real start, length;  ///< k_start, and the length scale of the growth of k (1 for angles)
  Real beforeImpact;   ///< multiplier of the limit before an impact, for the warm start after it
  int impact;          ///< 1: the limit has an impact in this step
};

/// Force and Hessian stiffness of a row at c. Returns the violation of the interval that causes the force (0:
/// no force).
RUBBLE_HD inline Real axisForce(const AxisRow& row, Real c, Real& force, Real& hessian) {
  const Real s = row.keepsMultiplier ? Real(1) / (Real(1) + row.k * row.compliance) : Real(1);
  const Real up = s * (row.k * (c - row.hi) + row.lambda), low = s * (row.k * (c - row.lo) + row.lambda);
  force = up > Real(0) ? up : low < Real(0) ? low : Real(0);
  hessian = row.active == kWatched && force == Real(0) ? Real(0) : s * row.k;
  const Real error = force > Real(0) ? c - row.hi : force < Real(0) ? c - row.lo : Real(0);
  const Real size = absOf(force);
  if (size > row.bound) {
    const Real sign = force > Real(0) ? Real(1) : Real(-1);
    // secant of the cut force, but at least half of what stops the motion: with lambda at the bound the
    // secant alone is zero
    if (absOf(error) > Real(0))
      hessian = min(hessian, max(absOf(row.bound - sign * row.lambda), row.bound / 2) / absOf(error));
    force = sign * row.bound;
  }
  return error;
}

RUBBLE_HD inline Real rotorForce(const RotorRow& row, Real c) { return row.k * (c - row.origin) + row.load; }

/// Sums of forces and Hessian stiffnesses of the active rows.
RUBBLE_HD inline void axisForces(const AxisRows& rows, Real c, Real& force, Real& hessian) {
  force = hessian = Real(0);
  const auto add = [&](const AxisRow& row) {
    if (!row.active) return;
    Real f, k;
    axisForce(row, c, f, k);
    force += f;
    hessian += k;
  };
  add(rows.limit), add(rows.drive), add(rows.friction);
  if (rows.rotor.active) force += rotorForce(rows.rotor, c), hessian += rows.rotor.k;
}
RUBBLE_HD inline bool actsAtAll(const AxisRows& rows) {
  return rows.limit.active || rows.drive.active || rows.friction.active || rows.rotor.active;
}
/// Total force of the rows that hold or resist, after the last dual update.
RUBBLE_HD inline Real axisLoad(const AxisRows& rows) {
  return (rows.limit.active ? rows.limit.lambda : Real(0)) +
         (rows.drive.active ? rows.drive.lambda : Real(0)) +
         (rows.friction.active ? rows.friction.lambda : Real(0));
}

/// Dual update [S 13], [S 14] of one row.
RUBBLE_HD inline void updateAxisRow(const StepConstants& c, const AxisRows& rows, AxisRow& row, Real value) {
  if (!row.active) return;
  Real force, hessian;
  const Real error = axisForce(row, value, force, hessian);
  const bool inside = absOf(force) < row.bound && force != Real(0);
  if (row.keepsMultiplier) row.lambda = force;
  if (!inside || (row.keepsMultiplier && row.compliance > Real(0))) return;
  StiffnessRule rule = jointRule(c, rows.start, rows.length);
  if (!row.keepsMultiplier) {
    rule.policy = StiffnessPolicy::Ramp;
    rule.limit = min(rule.limit, Real(1) / row.compliance);
  }
  row.k = grownStiffness<Real>(rule, row.k, error, force);
}
RUBBLE_HD inline void updateAxis(const StepConstants& c, AxisRows& rows, Real value) {
  updateAxisRow(c, rows, rows.limit, value);
  updateAxisRow(c, rows, rows.drive, value);
  updateAxisRow(c, rows, rows.friction, value);
  rows.rotor.force = rows.rotor.active ? rotorForce(rows.rotor, value) : Real(0);
}

/// Input of beginAxis.
struct AxisSituation {
  Real value;    ///< c(x^t), within one revolution
  Real turn;     ///< full revolutions to add to it
  Real change;   ///< change of c in this step without any row, to first order
  Real speed;    ///< (c(x^t) - c(x^(t-1))) / dt, of axes with armature [m/s, rad/s]
  Real inertia;  ///< row inertia
  Real length;   ///< characteristic length [m]; 1 for angles
  Real reach;    ///< speed of a point per unit speed of c [1, m]
  Real bound;    ///< break threshold and ceiling [N, N m]
  Real size;     ///< L of the joint [m]
};

/// Initializes stiffness, compliance and multiplier of a row. `kept`: decay of the multiplier. `authored`:
/// initial multiplier K C of a new row of finite stiffness.
RUBBLE_HD inline void beginAxisRow(const StepConstants& c, AxisRows& rows, AxisRow& row, Real total,
                                   Real kept, Real authored, Real bound) {
  const bool hard = total >= kHardValue, ramp = !hard && !c.compliantRows;
  StiffnessRule rule = jointRule(c, rows.start, rows.length);
  row.compliance = hard ? Real(0) : Real(1) / total;
  row.keepsMultiplier = !ramp;
  if (ramp) {
    rule.policy = StiffnessPolicy::Ramp;
    rule.limit = min(rule.limit, total);
    rule.start = min(rule.start, rule.limit);
  }
  const bool isNew = !(row.k > Real(0));
  row.lambda = ramp ? Real(0) : isNew && !hard ? clamp(authored, -bound, bound) : kept * row.lambda;
  row.k = isNew ? newStiffness(rule, row.lambda) : warmStiffness(c, rule, row.k, row.lambda);
  row.bound = bound;
  row.active = true;
}

/// Initializes the rows of this step at x^t.
RUBBLE_HD inline void beginAxis(const StepConstants& c, const AxisSpec& spec, AxisRows& rows,
                                const AxisSituation& at) {
  rows.start = startStiffness(c, at.inertia);
  rows.length = at.length;
  const auto rest = [](AxisRow& row) { row.active = false, row.lambda = 0, row.k = 0; };

  AxisRow& limit = rows.limit;
  if (rows.impact) limit.lambda = rows.beforeImpact;
  rows.impact = false;
  if (spec.lo > -kNoLimit || spec.hi < kNoLimit) {
    const Real lo = spec.lo - at.turn, hi = spec.hi - at.turn, next = at.value + kInactiveReach * at.change;
    const bool locked = spec.lo == spec.hi;
    const auto inside = [&](Real v) { return v > lo && v < hi; };
    const bool dormant = !locked && limit.lambda == Real(0) && inside(at.value) && inside(next);
    const Real watched = kWatchReach * at.length;
    if (dormant && at.value - lo > watched && hi - at.value > watched) {
      rest(limit);
    } else {
      const bool hard = spec.limitStiffness >= kHardValue;
      const Real damping = spec.limitDamping * c.inverseDt,
                 total = hard ? spec.limitStiffness : spec.limitStiffness + damping;
      const Real share = hard ? c.alpha : damping / total;
      limit.hi = hi + share * (locked ? at.value - hi : max(at.value - hi, Real(0)));
      limit.lo = locked ? limit.hi : lo - share * max(lo - at.value, Real(0));
      const Real before = limit.lambda;
      const Real beyond = locked || at.value > hi ? at.value - hi : min(at.value - lo, Real(0));
      beginAxisRow(c, rows, limit, total, hard ? c.alpha * c.gamma : c.gamma,
                   spec.limitStiffness * beyondRoundOff(beyond, absOf(at.value) + at.length), at.bound);
      if (dormant) limit.active = kWatched;
      // As for contacts: the multiplier of an impact is many times the subsequent load. A limit without load
      // that is reached in this step is in an impact, also where a contact accelerates the joint within it.
      const bool hits = absOf(at.change) * c.inverseDt * at.reach > impactSpeed(c, at.size) &&
                        !inside(at.value + at.change);
      rows.impact = c.impactRule && hard && !locked && (dormant || hits);
      rows.beforeImpact = before;
    }
  } else {
    rest(limit);
  }

  if ((spec.driveStiffness > Real(0) || spec.driveDamping > Real(0)) && spec.driveBound > Real(0)) {
    AxisRow& drive = rows.drive;
    const Real target = spec.target - at.turn;
    Real total = kHardValue, kept = c.gamma, authored = 0;
    if (spec.driveStiffness >= kHardValue) {
      drive.hi = target + c.alpha * (at.value - target);
      kept *= c.alpha;
    } else if (spec.driveDamping >= kHardValue) {
      // a speed is not a position error: all of c(x^t) is retained
      drive.hi = at.value + c.dt * spec.speed;
    } else {
      const Real damping = spec.driveDamping * c.inverseDt;
      total = spec.driveStiffness + damping;
      drive.hi = target + damping / total * (at.value - target + c.dt * spec.speed);
      authored = spec.driveStiffness *
                 beyondRoundOff(at.value - target, absOf(at.value) + absOf(target) + at.length);
    }
    drive.lo = drive.hi;
    beginAxisRow(c, rows, drive, total, kept, authored, min(spec.driveBound, at.bound));
  } else {
    rest(rows.drive);
  }

  if (spec.friction > Real(0)) {
    rows.friction.lo = rows.friction.hi = at.value;
    beginAxisRow(c, rows, rows.friction, kHardValue, c.gamma, 0, min(spec.friction, at.bound));
  } else {
    rest(rows.friction);
  }

  const Real inertia = spec.armature * c.inverseDt, k = (inertia + spec.damping) * c.inverseDt;
  const bool turns = k > Real(0) || spec.force != Real(0);
  rows.rotor = {k, at.value, -(inertia * at.speed + spec.force), Real(0), turns};
}

/// Deactivates all rows of a part in this step.
RUBBLE_HD inline void restPart(AxisRows& rows) {
  for (AxisRow* row : {&rows.limit, &rows.drive, &rows.friction})
    row->active = false, row->lambda = 0, row->k = 0;
  rows.rotor = {};
  rows.impact = false;
}

}  // namespace rubble::RUBBLE_CORE

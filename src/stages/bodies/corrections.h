#pragma once
/// Penetration correction and friction. Correcting the penetrations below a body moves it in every step, and
/// its load lets it settle by the same amount. Friction must resist the settling but not the correction;
/// otherwise particles in a bin would be carried by its walls from below. This pass finds the motion of each
/// body that correction causes.
#include "stages/bodies/visit_incidences.h"

namespace rubble::RUBBLE_CORE {

/// Settling that friction sees, over the motion by correction [1]. Most of the correction rotates round
/// bodies and transfers no load.
inline constexpr Real kSettling = 12;
/// Largest settling that a point sees per step, over the displacement that takes it from no friction to its
/// cone [1]. More would only make it slide faster.
inline constexpr Real kMostSettling = Real(.3);

/// Contribution of one contact point to Support.
struct PointSupport {
  Real load = 0;    ///< normal force [N]
  Real weight = 0;  ///< vertical force on B, friction included; positive if it supports B [N]
  Real moment = 0;  ///< load times the corrected part of its penetration in this step [N m]
};
RUBBLE_HD inline PointSupport operator+(const PointSupport& a, const PointSupport& b) {
  return {a.load + b.load, a.weight + b.weight, a.moment + b.moment};
}

/// `corrects`: the inherited error is a penetration, not an impact.
RUBBLE_HD inline PointSupport pointSupport(const SolverData& s, const ContactRows& r, const Vec3& t1,
                                           const Vec3& t2, int k, bool corrects) {
  const PointLoad& l = r.load[k];
  const Vec3 onB = l.lambdaN * r.n + l.lambda1 * t1 + l.lambda2 * t2;
  return {l.lambdaN, dot(onB, s.stepOf(r.a).up),
          corrects ? l.lambdaN * max(r.place[k].c0, Real(0)) : Real(0)};
}
RUBBLE_HD inline Support supportOf(const ContactRows& r, const PointSupport& sum) {
  return {sum.load > Real(0) ? (sum.moment / sum.load) * r.n : Vec3{0, 0, 0}, sum.weight};
}

/// Settling of A against B in a step as friction sees it, opposite to their motion by correction [m].
RUBBLE_HD inline Vec3 relativeSettling(const SolverData& s, int a, int b) {
  return kSettling * (s.correction[b] - s.correction[a]);
}

/// Share of a settling that a point sees [1]. `settling2`: its squared tangential length [m2]; `bound`:
/// radius of the friction cone [N].
template <class L> RUBBLE_HD RUBBLE_NEAR L settlingShare(Real settling2, L bound, L kT) {
  const L force = kT * std::sqrt(settling2), most = kMostSettling * bound;
  return select(force > most, most / force, LaneAccess<L>::splat(1));
}

/// Motion of a body by correction in a step: that of the bodies below plus the correction of the contacts
/// with them. The mean is weighted by the load that each supports. It propagates up a pile by one level per
/// step.
struct FindCorrections {
  static constexpr const char* kStage = "velocity";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.params[i].kind != BodyKind::Dynamic || isAsleep(s, i)) return;
    Vec3 sum{0, 0, 0};
    Real borne = 0;
    visitIncidences(s, i, [&](const Incidence& incidence) {
      if (constraintType(incidence.code) != kContactType) return;
      const Vec3 below = incidence.other >= 0 ? s.correction[incidence.other] : Vec3{0, 0, 0};
      const Support& support = s.support[constraintIndex(incidence.code)];
      const Real sign = constraintSide(incidence.code) == 0 ? Real(-1) : Real(1),
                 weight = sign * support.weight;
      if (!(weight > Real(0))) return;
      sum += weight * (below + sign * support.correction);
      borne += weight;
    });
    // the part of the weight that joints support counts as motionless
    borne = max(borne, -s.params[i].mass * dot(s.stepOf(i).gravity, s.stepOf(i).up));
    const Vec3 correction = borne > Real(0) ? sum * (Real(1) / borne) : Vec3{0, 0, 0};
    s.nextCorrection[i] = isFinite(correction) ? correction : Vec3{0, 0, 0};
  }
};

}  // namespace rubble::RUBBLE_CORE

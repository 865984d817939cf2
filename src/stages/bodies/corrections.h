#pragma once
/// Position correction and friction. Correcting the penetrations below a body moves it in every step, and its
/// load lets it settle by as much. Friction is to resist the settling, not the correction: a column of grains
/// would else hang on to the walls of its bin from below. So the motion that correction causes is found for
/// each body.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// How many times what correction moves bodies by friction sees them settle [1]. Most of it turns round
/// bodies and loads nothing.
inline constexpr Real kSettling = 12;
/// Most settling that a point sees in a step, over what takes it from no friction to its cone [1]. More would
/// only make it slide faster.
inline constexpr Real kMostSettling = Real(.3);

/// What one point of a contact adds to Support.
struct PointSupport {
  Real load = 0;    ///< normal force [N]
  Real weight = 0;  ///< its force on B against gravity, with friction [N]
  Real moment = 0;  ///< load times what is corrected of its penetration in this step [N m]
};
RUBBLE_HD inline PointSupport operator+(const PointSupport& a, const PointSupport& b) {
  return {a.load + b.load, a.weight + b.weight, a.moment + b.moment};
}

/// `corrects`: its inherited error is a penetration, and not a bounce.
RUBBLE_HD inline PointSupport pointSupport(const SolverData& s, const ContactRows& r, const Vec3& t1,
                                           const Vec3& t2, int k, bool corrects) {
  const PointLoad& l = r.load[k];
  const Vec3 onB = l.lambdaN * r.n + l.lambda1 * t1 + l.lambda2 * t2;
  return {l.lambdaN, dot(onB, s.step.up), corrects ? l.lambdaN * max(r.place[k].c0, Real(0)) : Real(0)};
}
RUBBLE_HD inline Support supportOf(const ContactRows& r, const PointSupport& sum) {
  return {sum.load > Real(0) ? (sum.moment / sum.load) * r.n : Vec3{0, 0, 0}, sum.weight};
}

/// By how much friction sees A settle against B in a step: against what correction moves them by [m].
RUBBLE_HD inline Vec3 relativeSettling(const SolverData& s, int a, int b) {
  return kSettling * (s.correction[b] - s.correction[a]);
}

/// Share of a settling of this square along its tangents that a point sees whose cone is `bound` [N].
RUBBLE_HD inline Real settlingShare(Real settling2, Real bound, Real kT) {
  const Real force = kT * std::sqrt(settling2), most = kMostSettling * bound;
  return force > most ? most / force : Real(1);
}

/// How far correction moves a body in a step: as far as what bears it, and what is corrected between the two,
/// by the share of the weight that each bears. It rises one level of a pile per step.
struct FindCorrections {
  static constexpr const char* kStage = "velocity";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.params[i].kind != BodyKind::Dynamic || isAsleep(s, i)) return;
    Vec3 sum{0, 0, 0};
    Real borne = 0;
    const int end = s.incidenceOffset[i + 1];
    for (int k = s.incidenceOffset[i]; k < end && constraintType(s.incidence[k].code) == kContactType; ++k) {
      const Incidence& incidence = s.incidence[k];
      const Support& support = s.support[constraintIndex(incidence.code)];
      const Real sign = constraintSide(incidence.code) == 0 ? Real(-1) : Real(1),
                 weight = sign * support.weight;
      if (!(weight > Real(0))) continue;
      const Vec3 below = incidence.other >= 0 ? s.correction[incidence.other] : Vec3{0, 0, 0};
      sum += weight * (below + sign * support.correction);
      borne += weight;
    }
    // where joints bear a part of the weight, that part is not moved
    borne = max(borne, -s.params[i].mass * dot(s.step.gravity, s.step.up));
    const Vec3 correction = borne > Real(0) ? sum * (Real(1) / borne) : Vec3{0, 0, 0};
    s.nextCorrection[i] = isFinite(correction) ? correction : Vec3{0, 0, 0};
  }
};

}  // namespace rubble::RUBBLE_CORE

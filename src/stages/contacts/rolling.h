#pragma once
/// Rolling and torsional friction: one constraint per pair in addition to its contact rows, if any material
/// has such friction.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

/// One per active pair.
struct CountRolling {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int) const { s.counters->rollers = s.counters->activePairs; }
};

/// Rows of every touching pair at x^t; multipliers are warm-started.
struct BuildRolling {
  static constexpr const char* kStage = "rows";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    RollingRows r{{0, 0, 1}, {0, 0, 0}, 0, 0, 0, 0};
    const Manifold& m = s.manifold[i];
    const Pair p = s.pair[s.activePair[i]];
    const OrderedPair o = ordered(p);
    const int before = s.manifoldBefore[s.activePair[i]];
    if (s.plan.sleeping && !moves(s, o.a) && !moves(s, o.b)) {
      // kept unchanged, like the manifold
      if (before >= 0 && s.rolledBefore) r = s.oldRolling[before];
    } else if (s.hasRows[i] != 0) {
      const PairMaterial material = pairMaterial(s, p, o);
      const BodyParams &pa = s.params[o.a], &pb = s.params[o.b];
      const Real lighter = pa.kind != BodyKind::Dynamic   ? pb.mass
                           : pb.kind != BodyKind::Dynamic ? pa.mass
                                                          : min(pa.mass, pb.mass);
      const Real arm = pairLength(pa, pb) / 2;
      // a rolling body translates too, so the row's inertia is m arm^2
      const Real k = startStiffness(*s.step, lighter * arm * arm);
      r.n = m.normal;
      r.rolling = material.rolling, r.torsional = material.torsional;
      r.kRoll = material.rolling > Real(0) ? k : Real(0),
      r.kTwist = material.torsional > Real(0) ? k : Real(0);
      if (before >= 0 && s.rolledBefore && s.oldManifold[before].count > 0 &&
          dot(s.oldRolling[before].n, r.n) > kSameNormal)
        r.lambda = s.oldRolling[before].lambda * warmMultiplier(*s.step, Real(1), false);
    }
    s.rolling[i] = r;
  }
};

struct UpdateRollingDuals {
  static constexpr const char* kStage = "dual";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const ContactRows& m = s.contact[i];
    RollingRows& r = s.rolling[m.manifold];
    if (r.kRoll == Real(0) && r.kTwist == Real(0)) return;
    r.lambda = rollingMoment(r, s.dx[m.a].dw - s.dx[m.b].dw, sumOfNormals(m)).moment;
  }
};

/// Adds the rolling friction of a contact to the block of one of its bodies. Its moment does not depend on
/// the reference point. The Hessian counts `weight` times.
RUBBLE_HD inline void addRolling(const SolverData& s, std::uint32_t code, Block6& block, Real weight = 1) {
  const ContactRows& m = s.contact[constraintIndex(code)];
  accumulateRolling(s.rolling[m.manifold], m, constraintSide(code) == 0, s.dx[m.a], s.dx[m.b], block, weight);
}

}  // namespace rubble::RUBBLE_CORE

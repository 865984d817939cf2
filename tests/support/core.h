#pragma once
/// Random values and comparisons in the types of the core (a test that includes this is compiled once a
/// precision, in double).
#include <solver/pose_algebra.h>
#include <solver/settings.h>

#include "tests/support/expect.h"
#include "tests/support/random.h"

namespace rubble::RUBBLE_CORE {

static_assert(sizeof(Real) == sizeof(double), "tests of the core work in double precision");

inline Pose randomPose(test::Random& random, double size = 1) {
  return {random.vector(size), random.rotation()};
}
inline Vec6 randomVec6(test::Random& random, double size = 1) {
  return {random.vector(size), random.vector(size)};
}
inline Real component(const Vec6& a, int i) { return i < 3 ? a.lin[i] : a.ang[i - 3]; }
/// The unit vector of coordinate i, linear ones first.
inline Vec6 unitVec6(int i) {
  Vec6 e{{0, 0, 0}, {0, 0, 0}};
  (i < 3 ? e.lin : e.ang)[i % 3] = 1;
  return e;
}

/// Constants of a step of 1/60 s under gravity 10 with nothing special: alpha 0.95, gamma 0.99, K 1,
/// stiffness by the ramp.
inline StepConstants testConstants() {
  Params params;
  params.tuning.errorRetention = .95;
  params.tuning.driftCorrection = -1;
  params.tuning.warmStartDecay = .99;
  params.tuning.startStiffness = 1;
  params.tuning.tangentStiffness = 1;
  params.tuning.contactPolicy = params.tuning.jointPolicy = StiffnessPolicy::Ramp;
  params.tuning.compliantRows = true;
  return stepConstants(params, {0, 0, -10}, 0);
}

}  // namespace rubble::RUBBLE_CORE

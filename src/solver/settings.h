#pragma once
/// Computes the constants of a step from the user's parameters.
#include <algorithm>

#include "math/portable.h"
#include "solver/constants.h"

namespace rubble::RUBBLE_CORE {

inline StepPlan stepPlan(const Params& params) {
  const Tuning& t = params.tuning;
  return {params.iterations,
          params.sleeping,
          t.coarseCorrection,
          t.jointTrees,
          params.preset == Preset::Demo3d,
          t.coneHessian,
          static_cast<Real>(t.acceleration)};
}

/// Sets the constants that depend on gravity.
inline void setGravity(StepConstants& c, const Params& params, const Vec3d& gravity) {
  const double dt = params.dt / params.substeps, g = length(gravity);
  c.gravity = Vec3(gravity);
  c.gravitySize = static_cast<Real>(g);
  const double fall = g > 0 ? g : kEarthGravity;
  c.loadAcceleration = static_cast<Real>(params.tuning.loadAcceleration * fall);
  c.perFall = 1 / (fall * dt * dt);
  c.up = g > 0 ? Vec3(gravity * (-1 / g)) : Vec3{0, 0, 0};
}

/// (dt of the last step / dt)^2 [1].
inline Real stiffnessRescale(const Params& params, double previousDt) {
  const double ratio = previousDt / (params.dt / params.substeps);
  return previousDt > 0 ? static_cast<Real>(ratio * ratio) : Real(1);
}

/// `previousDt`: time step of the last step [s], 0 before the first.
inline StepConstants stepConstants(const Params& params, const Vec3d& gravity, double previousDt) {
  const Tuning& t = params.tuning;
  const double dt = params.dt / params.substeps;
  // (1 - alpha) / dt, the correction rate of errors, does not depend on the time step [1/s]
  constexpr double kCorrectionRate = 3;
  const double alpha = t.errorRetention >= 0 ? t.errorRetention : 1 - std::min(1.0, kCorrectionRate * dt);
  StepConstants c{};
  c.dt = static_cast<Real>(dt);
  c.inverseDt = static_cast<Real>(1 / dt);
  c.alpha = static_cast<Real>(alpha);
  c.gamma = static_cast<Real>(params.preset == Preset::Engine ? portable::pow(t.warmStartDecay, 60 * dt)
                                                              : t.warmStartDecay);
  c.startStiffness = static_cast<Real>(t.startStiffness);
  c.tangentStiffness = static_cast<Real>(t.tangentStiffness);
  c.contactRampRate = static_cast<Real>(t.contactRampRate);
  c.jointRampRate = static_cast<Real>(t.jointRampRate);
  c.literalBeta = t.literalBeta;
  c.maxStiffness = static_cast<Real>(t.maxStiffness);
  c.contactPolicy = t.contactPolicy;
  c.jointPolicy = t.jointPolicy;
  setGravity(c, params, gravity);
  c.inactiveRows = t.dormantRows;
  c.impactRule = t.impactRule;
  c.compliantRows = t.compliantRows;
  // not zero, because the surface velocity of conveyors is divided by it
  constexpr double kLeastDriftCorrection = 1e-6;
  c.driftCorrection = static_cast<Real>(std::max(
      kLeastDriftCorrection, t.driftCorrection >= 0 ? std::min(1.0, t.driftCorrection * dt) : 1 - alpha));
  c.contactMargin = static_cast<Real>(t.contactMargin);
  c.sleepSpeed = static_cast<Real>(t.sleepSpeed);
  c.sleepDelay = static_cast<Real>(t.sleepDelay);
  c.recycleTolerance = static_cast<Real>(t.recycleTolerance);
  c.stiffnessRescale = stiffnessRescale(params, previousDt);
  return c;
}

}  // namespace rubble::RUBBLE_CORE

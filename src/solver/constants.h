#pragma once
/// The constants of one step, computed from Params on the host.
#include <cmath>

#include <rubble/params.h>

#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Largest rotation per step at the velocity of a body [rad]: the short arc is ambiguous at pi (120 rad/s at
/// 60 Hz).
inline constexpr Real kMaxSpinPerStep = 2;
/// Ceiling of |lambda| of a contact over m L / dt^2 of the heaviest body of its island in the last step [1].
inline constexpr Real kContactShare = 100;
/// Ceiling of |lambda| of a contact that closes at speed v, over m v / dt of its heavier body, if that is
/// larger [1]. It exceeds what stops the body within the step. Iterates overshoot the load of an impact, so a
/// higher ceiling makes piles explode.
inline constexpr Real kMostImpacts = 10;
/// Acceleration that converts a load to a mass in weightless worlds [m/s2].
inline constexpr double kEarthGravity = 9.81;
/// Acceleration for the sleep threshold in weightless worlds, over L / dt^2 [1]: that of the Earth for 1 m at
/// 60 Hz.
inline constexpr double kWeightlessShare = 2.725e-3;
/// An impact closes faster than all of: this share of sqrt(g L), the speed of a fall over L / 22 ...
inline constexpr Real kImpactShare = Real(.3);
/// ... the speed that gravity adds in this many steps [1] ...
inline constexpr Real kImpactSteps = 2;
/// ... and this share of L per step [1], which error correction can cause in weightless worlds.
inline constexpr Real kImpactWay = Real(3e-4);
/// Ceiling of k over m_row / dt^2, unless a finite material stiffness is lower. A row with a higher K_mat
/// counts as hard [1].
inline constexpr Real kHardFromStiffness = Real(1e6);

/// Depth of a contact point over L beyond which its stiffness no longer follows the load, and the ceiling of
/// k over k_start there [1].
inline constexpr Real kDeepShare = Real(.1);
inline constexpr Real kDeepStiffness = 10;

/// A threshold that is never reached.
inline constexpr Real kUnreached = Real(1e18);
/// A threshold in the precision of the solver. Infinity becomes kUnreached.
inline Real thresholdOf(double a) { return Real(a < static_cast<double>(kUnreached) ? a : kUnreached); }

/// What a step does, as opposed to its numbers: a change needs another sequence of kernels.
struct StepPlan {
  int iterations = 0;
  bool sleeping = false, coarseCorrection = false, jointTrees = false, literalRotations = false;
  bool coneHessian = false;  ///< Hessian of friction (friction.h)
  Real acceleration = 0;     ///< rho of the accelerated sweeps over deformables [1]
};

/// Aligned so that a GPU reads it in quads: on an H200 a step of contacts takes 2 % less.
struct alignas(16) StepConstants {
  Real dt;                ///< [s]
  Real inverseDt;         ///< [1/s]
  Vec3 gravity;           ///< [m/s2]
  Vec3 up;                ///< against gravity, unit; zero where nothing weighs
  Real alpha;             ///< share of an inherited error that is not corrected in this step [1]
  Real gamma;             ///< warm-start decay [1]
  Real startStiffness;    ///< K [1]
  Real tangentStiffness;  ///< k_start of tangential rows over that of normal rows [1]
  Real contactRampRate, jointRampRate;  ///< B [1], or beta itself if literalBeta
  bool literalBeta;
  Real maxStiffness;  ///< k_max dt^2 / m_row [1]
  StiffnessPolicy contactPolicy, jointPolicy;
  Real gravitySize;       ///< g [m/s2]
  Real loadAcceleration;  ///< a: a load lambda stands for the mass |lambda| / a [m/s2]
  double perFall;  ///< 1 / (g dt^2) [1/m]: the unit length of spatial cells depends on gravity and dt only
  bool inactiveRows, impactRule, compliantRows;
  Real driftCorrection;   ///< share of a tangential drift that is corrected per step [1]
  Real contactMargin;     ///< d_min over L [1]
  Real recycleTolerance;  ///< [1], [rad]
  bool wakeAll;           ///< every body wakes in this step
  Real sleepSpeed;        ///< surface speed below which a body counts as still, over sqrt(a L) [1]
  Real sleepDelay;        ///< [s]
  Real stiffnessRescale;  ///< (dt of the last step / dt)^2 [1]
};

/// Closing speed above which a contact of length L [m] counts as an impact [m/s]. Its multipliers are then
/// not warm-started and restitution acts. Resting contacts close at g dt at most.
RUBBLE_HD inline Real impactSpeed(const StepConstants& c, Real length) {
  return max(kImpactShare * std::sqrt(c.gravitySize * length),
             max(kImpactSteps * c.dt * c.gravitySize, kImpactWay * c.inverseDt * length));
}

/// Is closing > impactSpeed(c, length)? Without a square root.
RUBBLE_HD inline bool isImpact(const StepConstants& c, Real closing, Real length) {
  return closing > kImpactSteps * c.dt * c.gravitySize &&
         closing * closing > kImpactShare * kImpactShare * c.gravitySize * length &&
         closing > kImpactWay * c.inverseDt * length;
}

/// Surface speed below which a body of bounding diameter L [m] counts as still [m/s].
RUBBLE_HD inline Real stillSpeed(const StepConstants& c, Real length) {
  const Real a = c.gravitySize > Real(0) ? c.gravitySize
                                         : Real(kWeightlessShare) * length * c.inverseDt * c.inverseDt;
  return c.sleepSpeed * std::sqrt(a * length);
}

}  // namespace rubble::RUBBLE_CORE

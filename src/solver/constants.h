#pragma once
/// The numbers of one step, worked out from Params once on the host.
#include <cmath>

#include <rubble/params.h>

#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Ceiling of a spin in one step [rad]: the short arc is ambiguous at pi (120 rad/s at 60 Hz).
inline constexpr Real kMaxSpinPerStep = 2;
/// Ceiling of |lambda| of a contact in m L / dt^2 of the heaviest body of the island that it belonged to in
/// the last step [1].
inline constexpr Real kContactShare = 100;
/// Ceiling of |lambda| of a contact that closes at speed v, in m v / dt of its heavier body, if that is more
/// [1]: what stops the body within the step, and some. Iterates overshoot the load of an impact, so a higher
/// one would let heaps explode.
inline constexpr Real kMostImpacts = 10;
/// Acceleration that a load stands for where nothing weighs [m/s2].
inline constexpr double kEarthGravity = 9.81;
/// Acceleration by which bodies are judged to be still there, in L / dt^2 [1]: that of the Earth for 1 m at
/// 60 Hz.
inline constexpr double kWeightlessShare = 2.725e-3;
/// An impact closes faster than all of these: a share of sqrt(g L), the speed of a fall over L / 22 ...
inline constexpr Real kImpactShare = Real(.3);
/// ... what gravity makes of rest in so many steps [1] ...
inline constexpr Real kImpactSteps = 2;
/// ... and so much of L in a step [1], which corrections of errors do where nothing weighs.
inline constexpr Real kImpactWay = Real(3e-4);
/// Ceiling of k over m_row / dt^2 when no finite material stiffness is lower; K_mat above it is treated as
/// hard [1].
inline constexpr Real kHardFromStiffness = Real(1e6);

/// Depth of a contact point over L from which its stiffness follows no load, and the ceiling of k over
/// k_start there [1].
inline constexpr Real kDeepShare = Real(.1);
inline constexpr Real kDeepStiffness = 10;

/// A threshold that nothing reaches, in the place of "never".
inline constexpr Real kUnreached = Real(1e18);

struct StepConstants {
  Real dt;         ///< [s]
  Real inverseDt;  ///< [1/s]
  Vec3 gravity;    ///< [m/s2]
  Vec3 up;         ///< against gravity, unit; zero where nothing weighs
  int iterations;
  Real alpha;                           ///< part of an inherited error that is left alone in this step [1]
  Real gamma;                           ///< warm-start decay [1]
  Real startStiffness;                  ///< K [1]
  Real tangentStiffness;                ///< k_start of tangential over normal rows [1]
  Real contactRampRate, jointRampRate;  ///< B [1], or beta itself if literalBeta
  bool literalBeta;
  Real maxStiffness;  ///< k_max dt^2 / m_row [1]
  StiffnessPolicy contactPolicy, jointPolicy;
  Real gravitySize;       ///< g [m/s2]
  Real loadAcceleration;  ///< a: a load stands for the mass |lambda| / a [m/s2]
  double perFall;  ///< 1 / (g dt^2) [1/m]: space is divided by a length of the world's gravity and time step
                   ///< alone
  bool coneHessian, dormantRows, impactRule, compliantRows, literalRotations, coarseCorrection, jointTrees;
  Real acceleration;      ///< rho of the sweeps over solids [1]
  Real driftCorrection;   ///< part of a tangential drift that is corrected in a step [1]
  Real contactMargin;     ///< d_min over L [1]
  Real recycleTolerance;  ///< [1], [rad]
  bool sleeping;
  Real sleepSpeed;        ///< surface speed below which a body is still, over sqrt(a L) [1]
  Real sleepDelay;        ///< [s]
  Real stiffnessRescale;  ///< (dt of the last step / dt)^2 [1]
};

/// Closing speed above which a contact of length L [m] counts as an impact: its multipliers are not
/// warm-started, restitution acts. Contacts at rest close by g dt at most. [m/s]
RUBBLE_HD inline Real impactSpeed(const StepConstants& c, Real length) {
  return max(kImpactShare * std::sqrt(c.gravitySize * length),
             max(kImpactSteps * c.dt * c.gravitySize, kImpactWay * c.inverseDt * length));
}

/// closing > impactSpeed(c, length)
RUBBLE_HD inline bool isImpact(const StepConstants& c, Real closing, Real length) {
  return closing > kImpactSteps * c.dt * c.gravitySize &&
         closing * closing > kImpactShare * kImpactShare * c.gravitySize * length &&
         closing > kImpactWay * c.inverseDt * length;
}

/// Surface speed below which a body of bounding diameter L [m] is still. [m/s]
RUBBLE_HD inline Real stillSpeed(const StepConstants& c, Real length) {
  const Real a = c.gravitySize > Real(0) ? c.gravitySize
                                         : Real(kWeightlessShare) * length * c.inverseDt * c.inverseDt;
  return c.sleepSpeed * std::sqrt(a * length);
}

}  // namespace rubble::RUBBLE_CORE

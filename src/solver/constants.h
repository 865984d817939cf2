#pragma once
/// The numbers of one step, worked out from Params once on the host.
#include <rubble/params.h>

#include "math/hd.h"

namespace rubble::RUBBLE_CORE {

/// Ceiling of a spin in one step [rad]: the short arc is ambiguous at pi (120 rad/s at 60 Hz).
inline constexpr Real kMaxSpinPerStep = 2;
/// Closing speed [m/s] above which a contact counts as an impact: its multipliers are not warm-started, restitution acts.
inline constexpr Real kImpactSpeed = 1;
/// Ceiling of |lambda| in m L / dt^2 of the heaviest body of the scene [1].
inline constexpr Real kMaxMultiplier = 100;
/// Ceiling of |lambda| dt over the mass of the heaviest body [m/s], if that is more: what stops a small body from that speed within a step.
/// Iterates overshoot the load of an impact, so a higher one would let heaps explode.
inline constexpr double kMostImpulse = 1e4;
/// Ceiling of k over m_row / dt^2 when no finite material stiffness is lower; K_mat above it is treated as hard [1].
inline constexpr Real kHardFromStiffness = Real(1e6);

/// Depth of a contact point over L from which its stiffness follows no load, and the ceiling of k over k_start there [1].
inline constexpr Real kDeepShare = Real(.1);
inline constexpr Real kDeepStiffness = 10;

/// A threshold that nothing reaches, in the place of "never".
inline constexpr Real kUnreached = Real(1e18);

struct StepConstants {
  Real dt;               ///< [s]
  Real inverseDt;        ///< [1/s]
  Vec3 gravity;          ///< [m/s2]
  Vec3 up;               ///< against gravity, unit; zero where nothing weighs
  int iterations;
  Real alpha;            ///< part of an inherited error that is left alone in this step [1]
  Real gamma;            ///< warm-start decay [1]
  Real startStiffness;   ///< K [1]
  Real tangentStiffness; ///< k_start of tangential over normal rows [1]
  Real contactRampRate, jointRampRate;  ///< B [1], or beta itself if literalBeta
  bool literalBeta;
  Real maxStiffness;     ///< k_max dt^2 / m_row [1]
  StiffnessPolicy contactPolicy, jointPolicy;
  Real loadAcceleration; ///< a: a load stands for the mass |lambda| / a [m/s2]
  Real maxMultiplier;    ///< lambda_max [N]
  bool coneHessian, dormantRows, impactRule, compliantRows, literalRotations, coarseCorrection, jointTrees;
  Real acceleration;     ///< rho of the sweeps over solids [1]
  Real driftCorrection;  ///< part of a tangential drift that is corrected in a step [1]
  Real contactMargin;    ///< d_min over L [1]
  Real recycleTolerance; ///< [1], [rad]
  bool sleeping;
  Real sleepSpeed;       ///< surface speed below which a body of L = 1 m is still; others by sqrt(L) [m/s]
  Real sleepDelay;       ///< [s]
  Real stiffnessRescale; ///< (dt of the last step / dt)^2 [1]
};

}  // namespace rubble::RUBBLE_CORE

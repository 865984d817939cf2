#pragma once
/// Parameters of a step. Users choose iterations, time step and preset. `Tuning` is for research on the
/// method.
#include <functional>
#include <string>
#include <vector>

namespace rubble {

/// Engine: the default parameter set. Paper: the parameters of the AVBD abstract (alpha 0.95, beta 10, gamma
/// 0.99, k_start by mass). Demo3d: the public demo of its authors.
enum class Preset { Engine, Paper, Demo3d };

/// Update rule of the penalty stiffness k of a hard row, between its floor k_start and its ceiling.
enum class StiffnessPolicy {
  Ramp,  ///< k += beta |C| after each iteration [S 14]
  /// k = max(k_start, |lambda| / (a dt^2)), recomputed at warm start and after each iteration
  FollowLoad,
};

/// Parameters of the method. Scenes do not set them: all scenes of a preset share one set.
/// docs/research/stiffness.md documents the study behind the values.
struct Tuning {
  double startStiffness = 3;     ///< K: k_start = K m_row / dt^2 [1]; at most 3
  double tangentStiffness = .2;  ///< k_start of tangential rows over k_start of normal rows [1]
  double maxStiffness = 1e6;     ///< k_max over m_row / dt^2 [1]
  StiffnessPolicy contactPolicy = StiffnessPolicy::FollowLoad;
  StiffnessPolicy jointPolicy = StiffnessPolicy::Ramp;
  /// a of FollowLoad over gravity [1]: the row is given the stiffness for a load of mass |lambda| / a.
  double loadAcceleration = 1;
  double contactRampRate = 10;  ///< B of Ramp for contacts: beta = B (m_row / dt^2) / L [1]
  double jointRampRate = 300;   ///< B of Ramp for joints [1]
  bool literalBeta = false;     ///< the ramp rates are beta itself [N/m2], as in the AVBD abstract
  double errorRetention = -1;   ///< alpha [1]; negative: 1 - min(1, 3 dt)
  /// Correction rate of the tangential drift of sticking contacts [1/s]. Negative: the rate of other errors.
  double driftCorrection = 1.2;
  double warmStartDecay = .99;   ///< gamma for a step of 1/60 s [1]; scaled as gamma^(60 dt)
  bool coarseCorrection = true;  ///< solve for rigid motions of aggregates of bodies
  bool jointTrees = true;        ///< direct solves of joint trees, strands and columns
  double acceleration = .8;      ///< rho of the Chebyshev acceleration of deformable solids [1]; 0: off
  bool coneHessian = true;       ///< cone-consistent Hessian of sliding friction; otherwise the unclamped one
  bool dormantRows = true;       ///< leave out rows that stay open at the inertial targets
  bool impactRule = true;        ///< no warm start of the multipliers of an impact
  /// Finite stiffness by compliant multipliers. Otherwise by the ramp of the paper.
  bool compliantRows = true;
  /// Smallest detection margin over the bounding diameter of the smaller body [1].
  double contactMargin = .01;
  /// Sleep threshold: surface speed over sqrt(g L), with L the bounding diameter [1].
  double sleepSpeed = .02;
  /// Sleep delay [s]: an island sleeps after all of its bodies were below sleepSpeed for this time.
  double sleepDelay = .5;
  /// Relative motion below which a manifold is recycled, over the bounding diameter [1] and as an angle
  /// [rad].
  double recycleTolerance = 2e-3;
  bool operator==(const Tuning&) const = default;
};

struct Params {
  double dt = 1.0 / 60;  ///< [s]
  int iterations = 10;
  int substeps = 1;  ///< each step is divided into this many full steps of dt / substeps
  Preset preset = Preset::Engine;
  /// Number of steps between sorts of the bodies in memory by position (World::sortBodies). 0: never.
  int sortInterval = 0;
  bool sleeping = false;  ///< skip islands at rest until something disturbs them
  Tuning tuning;
  bool operator==(const Params&) const = default;

  /// Default parameters of a preset.
  static Params of(Preset preset);
};

/// A parameter that can be set by name: name, unit, meaning, and access as a number. Booleans are 0 or 1,
/// enumerators are their index.
struct ParamField {
  const char* name;
  const char* unit;
  const char* doc;
  std::function<double(const Params&)> get;
  std::function<void(Params&, double)> set;
};
const std::vector<ParamField>& paramFields();
/// Sets a parameter by name. Throws Error for an unknown name or a value out of range.
void setParam(Params& params, const std::string& name, double value);
/// Throws Error if any parameter is out of its range.
void validate(const Params& params);

}  // namespace rubble

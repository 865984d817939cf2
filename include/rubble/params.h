#pragma once
/// How a world is stepped. Users choose iterations, time step and preset; `Tuning` is for those who study the
/// method.
#include <functional>
#include <string>
#include <vector>

namespace rubble {

/// engine: the default set. paper: the literal line of the seed (alpha .95, beta 10, gamma .99, k_start by
/// mass). demo3d: the authors' public demo.
enum class Preset { Engine, Paper, Demo3d };

/// How the penalty stiffness k of a hard row moves between its floor k_start and its ceiling.
enum class StiffnessPolicy {
  Ramp,        ///< k += beta |C| after each iteration [S 14]
  FollowLoad,  ///< k = max(k_start, |lambda| / (a dt^2)), set anew at warm start and after each iteration
};

/// The parameters of the method. No scene may touch them; they are the same for every scene of a preset.
/// docs/stiffness.md has the study that they come from.
struct Tuning {
  double startStiffness = 3;     ///< K: k_start = K m_row / dt^2 [1]; at most 3
  double tangentStiffness = .2;  ///< k_start of tangential rows over that of normal rows [1]
  double maxStiffness = 1e6;     ///< k_max in m_row / dt^2 [1]
  StiffnessPolicy contactPolicy = StiffnessPolicy::FollowLoad;
  StiffnessPolicy jointPolicy = StiffnessPolicy::Ramp;
  double loadAcceleration = 1;   ///< a of FollowLoad over gravity: a load counts as the weight of the mass
                                 ///< |lambda| / a [1]
  double contactRampRate = 10;   ///< B of Ramp for contacts: beta = B (m_row / dt^2) / L [1]
  double jointRampRate = 300;    ///< B of Ramp for joints [1]
  bool literalBeta = false;      ///< ramp rates are beta itself [N/m2], as in the seed
  double errorRetention = -1;    ///< alpha [1]; below 0: 1 - min(1, 3 dt)
  double driftCorrection = 1.2;  ///< rate at which tangential drift of sticking contacts is taken back [1/s];
                                 ///< below 0: that of other errors
  double warmStartDecay = .99;   ///< gamma of a 1/60 s step [1]; scaled as gamma^(60 dt)
  bool coarseCorrection = true;  ///< rigid motions of groups of bodies are solved for as well
  bool jointTrees = true;     ///< bodies that hang together by joints, and vertices of a rope, are solved for
                              ///< together as well
  double acceleration = .8;   ///< rho of the Chebyshev acceleration of deformable solids [1]; 0: none
  bool coneHessian = true;    ///< cone-consistent Hessian of sliding friction; else the unclamped one
  bool dormantRows = true;    ///< rows that stay open at the inertial targets are left out of the step
  bool impactRule = true;     ///< multipliers of an impact are not warm-started
  bool compliantRows = true;  ///< finite stiffness by compliant multipliers; else by the ramp of the paper
  double
      contactMargin = .01;  ///< smallest detection margin over the bounding diameter of the smaller body [1]
  double sleepSpeed = .02;  ///< a body is still below this speed of its surface over sqrt(g L), L its
                            ///< bounding diameter [1]
  double sleepDelay = .5;   ///< an island sleeps when all of its bodies have been still for so long [s]
  double recycleTolerance = 2e-3;  ///< relative motion below which a manifold is kept, over the bounding
                                   ///< diameter [1] and in [rad]
};

struct Params {
  double dt = 1.0 / 60;  ///< [s]
  int iterations = 10;
  int substeps = 1;  ///< full steps of dt / substeps each
  Preset preset = Preset::Engine;
  int sortInterval = 0;   ///< bodies are put in an order of space in memory after so many steps each time
                          ///< (World::sortBodies); 0: never
  bool sleeping = false;  ///< islands of bodies that have come to rest are left out of the steps until
                          ///< something disturbs them
  Tuning tuning;

  /// The parameters of a preset.
  static Params of(Preset preset);
};

/// One line for each parameter that a user may set by name: its name, unit, meaning, and access as a number
/// (booleans 0 or 1, enumerators by index).
struct ParamField {
  const char* name;
  const char* unit;
  const char* doc;
  std::function<double(const Params&)> get;
  std::function<void(Params&, double)> set;
};
const std::vector<ParamField>& paramFields();
/// Sets a parameter by name; throws Error for an unknown name or a value out of range.
void setParam(Params& params, const std::string& name, double value);
/// Throws Error if any parameter is out of its range.
void validate(const Params& params);

}  // namespace rubble

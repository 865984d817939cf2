#include <rubble/error.h>
#include <rubble/params.h>

#include "cook/checks.h"
#include "cook/names.h"

#include <cmath>

namespace rubble {

namespace {

/// Settings that the published presets share: none of the engine's own rules.
void literal(Tuning& t) {
  t.contactPolicy = t.jointPolicy = StiffnessPolicy::Ramp;
  t.literalBeta = true;
  t.driftCorrection = -1;
  t.acceleration = 0;
  t.coarseCorrection = t.jointTrees = t.coneHessian = t.dormantRows = t.impactRule = t.compliantRows = false;
}

}  // namespace

Params Params::of(Preset preset) {
  Params p;
  p.preset = preset;
  Tuning& t = p.tuning;
  switch (preset) {
    case Preset::Engine:
      break;
    case Preset::Paper:
      // The parameters of the AVBD abstract, which leaves k_start open. It scales with mass here, and is
      // smaller for tangential rows because their Hessian is unclamped.
      t.startStiffness = 1;
      t.tangentStiffness = .01;
      t.contactRampRate = t.jointRampRate = 10;
      t.errorRetention = .95;
      t.warmStartDecay = .99;
      literal(t);
      break;
    case Preset::Demo3d:
      t.startStiffness = 1;
      t.tangentStiffness = 1;
      t.contactRampRate = t.jointRampRate = 1e4;
      t.errorRetention = .99;
      t.warmStartDecay = .999;
      literal(t);
      break;
  }
  return p;
}

namespace {

struct RangedField {
  ParamField field;
  double min, max;
};

template <class T>
RangedField tuning(const char* name, const char* unit, const char* doc, T Tuning::*member, double min,
                   double max) {
  return {{name, unit, doc, [member](const Params& p) { return static_cast<double>(p.tuning.*member); },
           [member](Params& p, double v) {
             p.tuning.*member = static_cast<T>(static_cast<std::conditional_t<std::is_enum_v<T>, int, T>>(v));
           }},
          min,
          max};
}

template <class T>
RangedField direct(const char* name, const char* unit, const char* doc, T Params::*member, double min,
                   double max) {
  return {{name, unit, doc, [member](const Params& p) { return static_cast<double>(p.*member); },
           [member](Params& p, double v) { p.*member = static_cast<T>(v); }},
          min,
          max};
}

const std::vector<RangedField>& ranges() {
  constexpr double kBig = 1e30;
  static const std::vector<RangedField> fields = {
      direct("dt", "s", "time step", &Params::dt, 1e-6, 1),
      direct("iterations", "1", "iterations a step", &Params::iterations, 1, 100000),
      direct("substeps", "1", "full steps of dt / substeps each", &Params::substeps, 1, 1000),
      direct("sortInterval", "1",
             "bodies are put in an order of space in memory after so many steps each time; 0: never",
             &Params::sortInterval, 0, 1e9),
      direct("sleeping", "bool", "islands of bodies at rest are left out of the steps", &Params::sleeping, 0,
             1),
      tuning("sleepSpeed", "1", "surface speed over sqrt(g L) below which a body is still",
             &Tuning::sleepSpeed, 0, 1),
      tuning("sleepDelay", "s", "time after which an island of still bodies sleeps", &Tuning::sleepDelay, 0,
             kBig),
      tuning("startStiffness", "1", "K: k_start = K m_row / dt^2", &Tuning::startStiffness, 1e-6, 3),
      tuning("contactRampRate", "1",
             "B of contacts: beta = B (m_row / dt^2) / L; beta itself [N/m2] if literalBeta",
             &Tuning::contactRampRate, 0, kBig),
      tuning("jointRampRate", "1", "B of joints", &Tuning::jointRampRate, 0, kBig),
      tuning("literalBeta", "bool", "ramp rates are beta itself", &Tuning::literalBeta, 0, 1),
      tuning("errorRetention", "1",
             "alpha: part of an inherited error left alone in a step; below 0: 1 - min(1, 3 dt)",
             &Tuning::errorRetention, -1, 1),
      tuning("warmStartDecay", "1", "gamma of a step of 1/60 s", &Tuning::warmStartDecay, 0, 1 - 1e-9),
      tuning("maxStiffness", "1", "k_max over m_row / dt^2", &Tuning::maxStiffness, 1, kBig),
      tuning("tangentStiffness", "1", "stiffness of tangential rows over that of normal rows",
             &Tuning::tangentStiffness, 1e-6, 10),
      tuning("contactPolicy", "enum", "stiffness of contacts: 0 ramp, 1 follows the load",
             &Tuning::contactPolicy, 0, 1),
      tuning("jointPolicy", "enum", "stiffness of joints: 0 ramp, 1 follows the load", &Tuning::jointPolicy,
             0, 1),
      tuning("loadAcceleration", "1",
             "a over gravity: k = |lambda| / (a dt^2) where stiffness follows the load",
             &Tuning::loadAcceleration, 1e-6, kBig),
      tuning("coneHessian", "bool", "cone-consistent Hessian of friction", &Tuning::coneHessian, 0, 1),
      tuning("dormantRows", "bool", "rows that stay open are left out of a step", &Tuning::dormantRows, 0, 1),
      tuning("impactRule", "bool", "multipliers of an impact are not warm-started", &Tuning::impactRule, 0,
             1),
      tuning("compliantRows", "bool", "finite stiffness by compliant multipliers, else by the ramp",
             &Tuning::compliantRows, 0, 1),
      tuning("coarseCorrection", "bool", "rigid motions of groups of bodies are solved for as well",
             &Tuning::coarseCorrection, 0, 1),
      tuning("jointTrees", "bool",
             "bodies that hang together by joints are solved for together as well, and so are the vertices "
             "of ropes and rods, and bodies stacked as a column",
             &Tuning::jointTrees, 0, 1),
      tuning("acceleration", "1", "rho of the Chebyshev acceleration of deformable solids; 0: none",
             &Tuning::acceleration, 0, .99),
      tuning(
          "driftCorrection", "1/s",
          "rate at which tangential drift of sticking contacts is taken back; below 0: that of other errors",
          &Tuning::driftCorrection, -1, 1e3),
      tuning("contactMargin", "1", "smallest detection margin over the bounding diameter",
             &Tuning::contactMargin, 0, 1),
      tuning("recycleTolerance", "1",
             "relative motion (over the diameter; rad) below which a manifold is kept; 0: never",
             &Tuning::recycleTolerance, 0, .1),
  };
  return fields;
}

using checks::text;

void check(const RangedField& f, double value) {
  if (!(value >= f.min && value <= f.max))
    throw Error(std::string("params.") + f.field.name, "a value from " + text(f.min) + " to " + text(f.max),
                text(value));
}

}  // namespace

const std::vector<ParamField>& paramFields() {
  static const std::vector<ParamField> fields = [] {
    std::vector<ParamField> out;
    for (const RangedField& f : ranges()) out.push_back(f.field);
    return out;
  }();
  return fields;
}

void setParam(Params& params, const std::string& name, double value) {
  for (const RangedField& f : ranges()) {
    if (name != f.field.name) continue;
    check(f, value);
    f.field.set(params, value);
    return;
  }
  const std::size_t limit = std::min(name.size(), std::max<std::size_t>(3, name.size() / 3));
  std::string near;
  for (const RangedField& f : ranges())
    if (editDistance(name, f.field.name, limit) < limit)
      near += std::string(near.empty() ? "one of " : ", ") + f.field.name;
  throw Error("params", near.empty() ? "a parameter of 'rubble info params', such as iterations" : near,
              "\"" + name + "\"");
}

void validate(const Params& params) {
  for (const RangedField& f : ranges()) check(f, f.field.get(params));
}

}  // namespace rubble

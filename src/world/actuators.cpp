#include <rubble/actuators.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <rubble/events.h>
#include <rubble/world.h>

#include "cook/checks.h"
#include "world/worlds_impl.h"

namespace rubble {
namespace {

constexpr std::array<const char*, 6> kTypes{"force", "position", "speed", "muscle", "wrench", "adhesion"};
constexpr std::array<const char*, 5> kDynamics{"none", "integrator", "filter", "filter_exact", "muscle"};

bool actsOnAxis(ActuatorType type) { return type != ActuatorType::Wrench && type != ActuatorType::Adhesion; }

double half(double x) { return x * x / 2; }

/// Of a fiber without motion, over the peak force.
double isometric(const Muscle& m, double x) {
  const double low = (m.shortest + 1) / 2, high = (1 + m.longest) / 2;
  if (x <= m.shortest || x >= m.longest) return 0;
  if (x <= low) return half((x - m.shortest) / (low - m.shortest));
  if (x <= 1) return 1 - half((1 - x) / (1 - low));
  if (x <= high) return 1 - half((x - 1) / (high - 1));
  return half((m.longest - x) / (m.longest - high));
}

/// A factor and its slope.
struct Slope {
  double value, slope;
};
/// Of the active force by speed over the fastest one.
Slope bySpeed(const Muscle& m, double v) {
  const double most = m.lengthening - 1;
  if (v <= -1) return {0, 0};
  if (v <= 0) return {(v + 1) * (v + 1), 2 * (v + 1)};
  if (v >= most) return {m.lengthening, 0};
  return {m.lengthening - (most - v) * (most - v) / most, 2 * (most - v) / most};
}

/// 0 below 0, 1 above 1, with two continuous derivatives.
double smoothStep(double x) {
  if (x <= 0) return 0;
  return x >= 1 ? 1 : x * x * x * (3 * x * (2 * x - 5) + 10);
}

}  // namespace

const char* keyword(ActuatorType type) { return kTypes.at(static_cast<std::size_t>(type)); }
const char* keyword(ActuatorDynamics dynamics) { return kDynamics.at(static_cast<std::size_t>(dynamics)); }

double Muscle::activeForce(double length, double speed) const {
  return -peakForce * isometric(*this, (length - tendonLength) / optimalLength) *
         bySpeed(*this, speed / (optimalLength * fastest)).value;
}
double Muscle::passiveForce(double length) const {
  const double x = (length - tendonLength) / optimalLength, high = (1 + longest) / 2;
  if (x <= 1) return 0;
  return -peakForce * passive * (x <= high ? half((x - 1) / (high - 1)) : 0.5 + (x - high) / (high - 1));
}
double Muscle::activationRate(double control, double activation) const {
  const double change = std::clamp(control, 0., 1.) - activation,
               ease = 0.5 + 1.5 * std::clamp(activation, 0., 1.), up = rise * ease, down = fall / ease;
  const double share = smoothing > 0 ? smoothStep(change / smoothing + 0.5) : change > 0 ? 1 : 0;
  return change / (down + (up - down) * share);
}

void validate(const ActuatorDef& a, const std::string& path) {
  const auto fail = [&](const char* key, const char* expected, double got) {
    throw Error(path + "." + key, expected, checks::text(got));
  };
  const auto positive = [&](const char* key, double value) {
    if (!(value > 0) || !std::isfinite(value)) fail(key, "a number above 0", value);
  };
  const auto ordered = [&](const char* key, double min, double max) {
    if (!(min <= max)) fail(key, "a number of at least the smallest one", max);
  };
  const auto finite = [&](const char* key, double value) {
    if (!std::isfinite(value)) fail(key, "a finite number", value);
  };
  for (const auto& [key, value] : {std::pair{"gear", a.gear},
                                   {"offset", a.offset},
                                   {"control", a.control},
                                   {"activation", a.activation},
                                   {"included", a.included}})
    finite(key, value);
  for (const auto& [key, value] : {std::pair{"gain", a.gain},
                                   {"bias", a.bias},
                                   {"position", a.position},
                                   {"force", a.force},
                                   {"torque", a.torque}})
    for (int k = 0; k < 3; ++k) finite(key, value[k]);
  ordered("maxForce", a.minForce, a.maxForce);
  ordered("maxControl", a.minControl, a.maxControl);
  ordered("maxActivation", a.minActivation, a.maxActivation);
  if (a.dynamics == ActuatorDynamics::Filter || a.dynamics == ActuatorDynamics::FilterExact)
    positive("timeConstant", a.timeConstant);
  const Muscle& m = a.muscle;
  if (a.dynamics == ActuatorDynamics::Muscle)
    positive("muscle.rise", m.rise), positive("muscle.fall", m.fall);
  if (!(m.smoothing >= 0)) fail("muscle.smoothing", "a number of at least 0", m.smoothing);
  if (a.type != ActuatorType::Muscle) return;
  if (!(m.peakForce >= 0) || !std::isfinite(m.peakForce))
    fail("muscle.peakForce", "a number of at least 0 [N]", m.peakForce);
  positive("muscle.optimalLength", m.optimalLength), positive("muscle.fastest", m.fastest);
  finite("muscle.tendonLength", m.tendonLength);
  if (!(m.shortest < 1)) fail("muscle.shortest", "a number below 1", m.shortest);
  if (!(m.longest > 1)) fail("muscle.longest", "a number above 1", m.longest);
  if (!(m.lengthening > 1)) fail("muscle.lengthening", "a number above 1", m.lengthening);
  if (!(m.passive >= 0)) fail("muscle.passive", "a number of at least 0", m.passive);
}

struct Actuators::Impl {
  struct Own {
    std::size_t axis = 0;  ///< in `axes`
    BodyId body;
  };
  /// An axis that actuators act on, and what acts on it beside them.
  struct Axis {
    JointId joint;
    std::size_t axis;
    double position = 0, speed = 0;
    JointAxis base, now;
  };
  /// What actuators act on in one world.
  struct Site {
    std::vector<Own> own;
    std::vector<Axis> axes;
  };

  std::vector<ActuatorDef> definitions;
  bool ofBatch = false;
  int first = 0;  ///< world of a batch
  std::vector<Site> sites;
  std::shared_ptr<ActuatorState> state = std::make_shared<ActuatorState>();
  std::vector<double> forces;

  explicit Impl(std::vector<ActuatorDef> actuators);
  void add(const World& world);
  static std::size_t axisAt(Site& site, const World& world, JointId joint, std::size_t axis);
  /// Of an actuator of a site, among those of all.
  std::size_t placeOf(std::size_t site, std::size_t i) const { return site * definitions.size() + i; }
  /// As it is in one world.
  const ActuatorDef& definition(std::size_t site, std::size_t i) const {
    return (*state->definitions[site])[i];
  }
  /// Within its bounds.
  double control(std::size_t site, std::size_t i) const;
  void requireFinite(std::size_t site) const;
  /// Positions and speeds before the step.
  void measure(const World& world, std::size_t site);
  void act(World& world, std::size_t site);
  /// Activation after a step.
  static double next(const ActuatorDef& a, double now, double given, double dt);
  /// Both return what the actuator does.
  static double actOnAxis(const ActuatorDef& a, Axis& axis, double input);
  static double actOnBody(World& world, const ActuatorDef& a, BodyId body, double input);
};

Actuators::Impl::Impl(std::vector<ActuatorDef> actuators) : definitions(std::move(actuators)) {
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    validate(definitions[i], "actuators[" + std::to_string(i) + "]");
    state->firstControls.push_back(definitions[i].control);
    state->firstActivations.push_back(definitions[i].activation);
  }
  state->first = std::make_shared<const std::vector<ActuatorDef>>(definitions);
}

std::size_t Actuators::Impl::axisAt(Site& site, const World& world, JointId joint, std::size_t axis) {
  for (std::size_t i = 0; i < site.axes.size(); ++i)
    if (site.axes[i].joint == joint && site.axes[i].axis == axis) return i;
  const JointAxis& base = world.definition(joint).axes[axis];
  site.axes.push_back({joint, axis, 0, 0, base, base});
  return site.axes.size() - 1;
}

void Actuators::Impl::add(const World& world) {
  const std::vector<BodyId> bodies = world.bodies();
  const std::vector<JointId> joints = world.joints();
  const auto within = [](const std::string& path, int index, std::size_t count, const char* what) {
    if (index < 0 || index >= static_cast<int>(count))
      throw Error(path, "one of " + std::to_string(count) + what, std::to_string(index));
    return static_cast<std::size_t>(index);
  };
  Site& site = sites.emplace_back();
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    const ActuatorDef& actuator = definitions[i];
    const std::string path = "actuators[" + std::to_string(i) + "]";
    Own own;
    if (actsOnAxis(actuator.type)) {
      const JointId joint = joints[within(path + ".joint", actuator.joint, joints.size(), " joints")];
      own.axis = axisAt(site, world, joint,
                        within(path + ".axis", actuator.axis, world.state(joint).axes.size(), " axes"));
    } else {
      own.body = bodies[within(path + ".body", actuator.body, bodies.size(), " bodies")];
    }
    site.own.push_back(own);
  }
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  state->definitions.push_back(state->first);
  append(state->controls, state->firstControls), append(state->activations, state->firstActivations);
  forces.resize(state->controls.size());
}

Actuators::Actuators(std::vector<ActuatorDef> actuators, const World& world)
    : impl_(std::make_unique<Impl>(std::move(actuators))) {
  impl_->add(world);
  Worlds::Impl::of(world).addActuators(impl_->state, 0);
}

Actuators::Actuators(std::vector<ActuatorDef> actuators, const Worlds& worlds, int first, int count)
    : impl_(std::make_unique<Impl>(std::move(actuators))) {
  count = worldsFrom(first, count, worlds.count());
  impl_->ofBatch = true, impl_->first = first;
  for (int k = 0; k < count; ++k) impl_->add(worlds[first + k]);
  for (int k = 0; k < count; ++k)
    Worlds::Impl::of(worlds[first + k]).addActuators(impl_->state, static_cast<std::size_t>(k));
}

Actuators::~Actuators() = default;
Actuators::Actuators(Actuators&&) noexcept = default;
Actuators& Actuators::operator=(Actuators&&) noexcept = default;

const std::vector<ActuatorDef>& Actuators::definitions() const { return impl_->definitions; }
int Actuators::worlds() const { return static_cast<int>(impl_->sites.size()); }
std::span<double> Actuators::controls() { return impl_->state->controls; }
std::span<double> Actuators::activations() { return impl_->state->activations; }
std::span<const double> Actuators::forces() const { return impl_->forces; }

double Actuators::Impl::next(const ActuatorDef& a, double now, double given, double dt) {
  double change = 0;
  switch (a.dynamics) {
    case ActuatorDynamics::None:
      return now;
    case ActuatorDynamics::Integrator:
      change = given * dt;
      break;
    case ActuatorDynamics::Filter:
      change = (given - now) / a.timeConstant * dt;
      break;
    case ActuatorDynamics::FilterExact:
      change = -(given - now) * std::expm1(-dt / a.timeConstant);
      break;
    case ActuatorDynamics::Muscle:
      change = a.muscle.activationRate(given, now) * dt;
      break;
  }
  // beyond the range of numbers the change may be none
  return std::clamp(std::isnan(change) ? now : now + change, a.minActivation, a.maxActivation);
}

double Actuators::Impl::actOnAxis(const ActuatorDef& a, Axis& axis, double input) {
  const double length = a.gear * axis.position + a.offset, speed = a.gear * axis.speed;
  double force = 0, slope = 0;  // slope: by speed
  if (a.type == ActuatorType::Muscle) {
    force = input * a.muscle.activeForce(length, speed) + a.muscle.passiveForce(length);
    const double fastest = a.muscle.optimalLength * a.muscle.fastest;
    slope = -input * a.muscle.peakForce *
            isometric(a.muscle, (length - a.muscle.tendonLength) / a.muscle.optimalLength) *
            bySpeed(a.muscle, speed / fastest).slope / fastest;
  } else {
    const Vec3 state{1, length, speed};
    force = dot(a.gain, state) * input + dot(a.bias, state);
    slope = a.gain.z * input + a.bias.z;
  }
  if (force < a.minForce || force > a.maxForce) slope = 0;
  force = std::clamp(force, a.minForce, a.maxForce);
  switch (a.type) {
    case ActuatorType::Position:
      axis.now.targetPosition += force - a.included;
      break;
    case ActuatorType::Speed:
      axis.now.targetSpeed += force - a.included;
      break;
    default:
      // a force that resists motion is that of a damper about the present speed
      const double damping = std::max(-slope, 0.) * a.gear * a.gear;
      axis.now.damping += damping;
      axis.now.motorForce += a.gear * force + damping * axis.speed - a.included;
  }
  return force;
}

double Actuators::Impl::actOnBody(World& world, const ActuatorDef& a, BodyId body, double input) {
  const double force = std::clamp(a.gain.x * input + a.bias.x, a.minForce, a.maxForce);
  if (force == 0) return force;
  const auto isDynamic = [&](BodyId id) { return world.definition(id).motion == Motion::Dynamic; };
  if (a.type == ActuatorType::Wrench) {
    if (!isDynamic(body)) return force;
    const BodyState state = world.state(body);
    const auto turned = [&](const Vec3& v) { return rotate(state.orientation, v); };
    if (a.force != Vec3{})
      world.applyForceAt(body, force * turned(a.force), state.position + turned(a.position));
    if (a.torque != Vec3{}) world.applyTorque(body, force * turned(a.torque));
    return force;
  }
  std::vector<ContactPoint> points = world.contactsOf(body);
  std::erase_if(points, [](const ContactPoint& point) { return point.depth < 0 && point.force == Vec3{}; });
  for (const ContactPoint& point : points) {
    const Vec3 pull = force / static_cast<double>(points.size()) * point.normal;
    for (const auto& [id, sign] : {std::pair{point.a, 1.}, {point.b, -1.}})
      if (isDynamic(id)) world.applyForceAt(id, sign * pull, point.position);
  }
  return force;
}

double Actuators::Impl::control(std::size_t site, std::size_t i) const {
  const ActuatorDef& a = definition(site, i);
  return std::clamp(state->controls[placeOf(site, i)], a.minControl, a.maxControl);
}

void Actuators::Impl::requireFinite(std::size_t site) const {
  const auto require = [](const char* list, std::size_t at, double given) {
    if (!std::isfinite(given))
      throw Error(std::string(list) + "[" + std::to_string(at) + "]", "a finite number", checks::text(given));
  };
  for (std::size_t i = 0; i < definitions.size(); ++i) {
    const std::size_t at = placeOf(site, i);
    require("controls", at, control(site, i)), require("activations", at, state->activations[at]);
  }
}

void Actuators::Impl::measure(const World& world, std::size_t site) {
  for (Axis& axis : sites[site].axes) {
    const JointAxisState now = world.state(axis.joint).axes[axis.axis];
    axis.position = now.position, axis.speed = now.speed, axis.now = axis.base;
  }
}

void Actuators::Impl::act(World& world, std::size_t site) {
  const double dt = world.params().dt;
  auto& [own, axes] = sites[site];
  for (std::size_t i = 0; i < own.size(); ++i) {
    const ActuatorDef& a = definition(site, i);
    const std::size_t at = placeOf(site, i);
    const double given = control(site, i);
    double& activation = state->activations[at];
    const double after = next(a, activation, given, dt);
    const double input = a.dynamics == ActuatorDynamics::None ? given : a.early ? after : activation;
    forces[at] = actsOnAxis(a.type) ? actOnAxis(a, axes[own[i].axis], input)
                                    : actOnBody(world, a, own[i].body, input);
    activation = after;
  }
  for (std::size_t i = 0; i < axes.size();) {
    // axes of one joint are edited together
    const JointId joint = axes[i].joint;
    JointDef def = world.definition(joint);
    bool differs = false;
    for (; i < axes.size() && axes[i].joint == joint; ++i) {
      JointAxis& to = def.axes[axes[i].axis];
      for (double JointAxis::*const member : {&JointAxis::targetPosition, &JointAxis::targetSpeed,
                                              &JointAxis::motorForce, &JointAxis::damping}) {
        differs |= to.*member != axes[i].now.*member;
        to.*member = axes[i].now.*member;
      }
    }
    if (differs) world.setDefinition(joint, def);
  }
}

void Actuators::apply(World& world) {
  if (impl_->ofBatch) throw Error("actuators", "those of a world", "those of a batch");
  impl_->requireFinite(0);
  impl_->measure(world, 0);
  impl_->act(world, 0);
}

void Actuators::apply(Worlds& worlds, std::span<const char> active) {
  Impl& own = *impl_;
  if (!own.ofBatch) throw Error("actuators", "those of a batch", "those of a world");
  const int all = worlds.count();
  if (own.first + this->worlds() > all)
    throw Error("worlds", "those that the actuators were made for", std::to_string(all) + " worlds");
  if (!active.empty() && static_cast<int>(active.size()) != all)
    throw Error("active", "one element per world, " + std::to_string(all), std::to_string(active.size()));
  const int perBatch = worlds.impl_->perBatch;
  std::vector<std::vector<int>> chosen(worlds.impl_->batches.size());
  for (int w = own.first; w < own.first + this->worlds(); ++w) {
    if (!active.empty() && active[static_cast<std::size_t>(w)] == 0) continue;
    own.requireFinite(static_cast<std::size_t>(w - own.first));
    chosen[static_cast<std::size_t>(w / perBatch)].push_back(w);
  }
  worlds.impl_->forEachBatch([&](std::size_t batch) {
    // Edits of one world are sent before another one is read, so all are read first.
    for (const int w : chosen[batch]) own.measure(worlds[w], static_cast<std::size_t>(w - own.first));
    for (const int w : chosen[batch]) own.act(worlds[w], static_cast<std::size_t>(w - own.first));
  });
}

void World::Impl::addActuators(const std::shared_ptr<ActuatorState>& state, std::size_t world) {
  std::erase_if(actuators, [](const auto& each) { return each.first.expired(); });
  actuators.emplace_back(state, world);
}

std::vector<std::vector<double>> World::Impl::actuatorValues(std::vector<ActuatorList>* definitions) const {
  std::vector<std::vector<double>> out;
  for (const auto& [held, world] : actuators) {
    const std::shared_ptr<const ActuatorState> state = held.lock();
    if (!state) continue;
    definitions->push_back(state->definitions[world]);
    std::vector<double>& own = out.emplace_back();
    const auto count = static_cast<std::ptrdiff_t>(state->firstControls.size());
    for (const std::vector<double>* const list : {&state->controls, &state->activations}) {
      const auto begin = list->begin() + static_cast<std::ptrdiff_t>(world) * count;
      own.insert(own.end(), begin, begin + count);
    }
  }
  return out;
}

void World::Impl::setActuatorValues(const std::vector<std::vector<double>>& values,
                                    const std::vector<ActuatorList>& definitions) {
  std::size_t number = 0;
  for (const auto& [held, world] : actuators) {
    const std::shared_ptr<ActuatorState> state = held.lock();
    if (!state) continue;
    const std::size_t count = state->firstControls.size(), at = number++;
    const bool has = at < values.size() && values[at].size() == 2 * count;
    state->definitions[world] = at < definitions.size() && definitions[at]->size() == count ? definitions[at]
                                                                                            : state->first;
    for (std::size_t i = 0; i < count; ++i) {
      state->controls[world * count + i] = has ? values[at][i] : state->firstControls[i];
      state->activations[world * count + i] = has ? values[at][count + i] : state->firstActivations[i];
    }
  }
}

}  // namespace rubble

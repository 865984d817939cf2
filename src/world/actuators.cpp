#include <rubble/actuators.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <rubble/events.h>
#include <rubble/world.h>

#include "cook/checks.h"

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

  std::vector<ActuatorDef> definitions;
  std::vector<Own> own;
  std::vector<Axis> axes;
  std::vector<double> controls, activations, forces;

  std::size_t axisAt(const World& world, JointId joint, std::size_t axis);
  /// Activation after a step.
  double next(std::size_t i, double control, double dt) const;
  void actOnAxis(std::size_t i, double input);
  void actOnBody(World& world, std::size_t i, double input);
};

std::size_t Actuators::Impl::axisAt(const World& world, JointId joint, std::size_t axis) {
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (axes[i].joint == joint && axes[i].axis == axis) return i;
  const JointAxis& base = world.definition(joint).axes[axis];
  axes.push_back({joint, axis, 0, 0, base, base});
  return axes.size() - 1;
}

Actuators::Actuators(std::vector<ActuatorDef> actuators, const World& world)
    : impl_(std::make_unique<Impl>()) {
  const std::vector<BodyId> bodies = world.bodies();
  const std::vector<JointId> joints = world.joints();
  const auto within = [](const std::string& path, int index, std::size_t count, const char* what) {
    if (index < 0 || index >= static_cast<int>(count))
      throw Error(path, "one of " + std::to_string(count) + what, std::to_string(index));
    return static_cast<std::size_t>(index);
  };
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const ActuatorDef& actuator = actuators[i];
    const std::string path = "actuators[" + std::to_string(i) + "]";
    validate(actuator, path);
    Impl::Own own;
    if (actsOnAxis(actuator.type)) {
      const JointId joint = joints[within(path + ".joint", actuator.joint, joints.size(), " joints")];
      own.axis = impl_->axisAt(
          world, joint, within(path + ".axis", actuator.axis, world.state(joint).axes.size(), " axes"));
    } else {
      own.body = bodies[within(path + ".body", actuator.body, bodies.size(), " bodies")];
    }
    impl_->own.push_back(own);
    impl_->controls.push_back(actuator.control), impl_->activations.push_back(actuator.activation);
  }
  impl_->forces.resize(actuators.size());
  impl_->definitions = std::move(actuators);
}

Actuators::~Actuators() = default;
Actuators::Actuators(Actuators&&) noexcept = default;
Actuators& Actuators::operator=(Actuators&&) noexcept = default;

const std::vector<ActuatorDef>& Actuators::definitions() const { return impl_->definitions; }
std::span<double> Actuators::controls() { return impl_->controls; }
std::span<double> Actuators::activations() { return impl_->activations; }
std::span<const double> Actuators::forces() const { return impl_->forces; }

double Actuators::Impl::next(std::size_t i, double control, double dt) const {
  const ActuatorDef& a = definitions[i];
  const double now = activations[i];
  double change = 0;
  switch (a.dynamics) {
    case ActuatorDynamics::None:
      return now;
    case ActuatorDynamics::Integrator:
      change = control * dt;
      break;
    case ActuatorDynamics::Filter:
      change = (control - now) / a.timeConstant * dt;
      break;
    case ActuatorDynamics::FilterExact:
      change = -(control - now) * std::expm1(-dt / a.timeConstant);
      break;
    case ActuatorDynamics::Muscle:
      change = a.muscle.activationRate(control, now) * dt;
      break;
  }
  return std::clamp(now + change, a.minActivation, a.maxActivation);
}

void Actuators::Impl::actOnAxis(std::size_t i, double input) {
  const ActuatorDef& a = definitions[i];
  Axis& axis = axes[own[i].axis];
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
  forces[i] = force = std::clamp(force, a.minForce, a.maxForce);
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
}

void Actuators::Impl::actOnBody(World& world, std::size_t i, double input) {
  const ActuatorDef& a = definitions[i];
  const BodyId body = own[i].body;
  const double force = forces[i] = std::clamp(a.gain.x * input + a.bias.x, a.minForce, a.maxForce);
  if (force == 0) return;
  const auto isDynamic = [&](BodyId id) { return world.definition(id).motion == Motion::Dynamic; };
  if (a.type == ActuatorType::Wrench) {
    if (!isDynamic(body)) return;
    const BodyState state = world.state(body);
    const auto turned = [&](const Vec3& v) { return rotate(state.orientation, v); };
    if (a.force != Vec3{})
      world.applyForceAt(body, force * turned(a.force), state.position + turned(a.position));
    if (a.torque != Vec3{}) world.applyTorque(body, force * turned(a.torque));
    return;
  }
  std::vector<ContactPoint> points = world.contactsOf(body);
  std::erase_if(points, [](const ContactPoint& point) { return point.depth < 0 && point.force == Vec3{}; });
  for (const ContactPoint& point : points) {
    const Vec3 pull = force / static_cast<double>(points.size()) * point.normal;
    for (const auto& [id, sign] : {std::pair{point.a, 1.}, {point.b, -1.}})
      if (isDynamic(id)) world.applyForceAt(id, sign * pull, point.position);
  }
}

void Actuators::apply(World& world) {
  const double dt = world.params().dt;
  Impl& impl = *impl_;
  for (Impl::Axis& axis : impl.axes) {
    const JointAxisState state = world.state(axis.joint).axes[axis.axis];
    axis.position = state.position, axis.speed = state.speed, axis.now = axis.base;
  }
  for (std::size_t i = 0; i < impl.own.size(); ++i) {
    const ActuatorDef& a = impl.definitions[i];
    const double control = std::clamp(impl.controls[i], a.minControl, a.maxControl);
    if (!std::isfinite(control))
      throw Error("controls[" + std::to_string(i) + "]", "a finite number", checks::text(control));
    const double next = impl.next(i, control, dt);
    const double input = a.dynamics == ActuatorDynamics::None ? control
                         : a.early                            ? next
                                                              : impl.activations[i];
    if (actsOnAxis(a.type))
      impl.actOnAxis(i, input);
    else
      impl.actOnBody(world, i, input);
    impl.activations[i] = next;
  }
  for (std::size_t i = 0; i < impl.axes.size();) {
    // axes of one joint are edited together
    const JointId joint = impl.axes[i].joint;
    JointDef def = world.definition(joint);
    bool differs = false;
    for (; i < impl.axes.size() && impl.axes[i].joint == joint; ++i) {
      JointAxis& own = def.axes[impl.axes[i].axis];
      for (double JointAxis::*const member : {&JointAxis::targetPosition, &JointAxis::targetSpeed,
                                              &JointAxis::motorForce, &JointAxis::damping}) {
        differs |= own.*member != impl.axes[i].now.*member;
        own.*member = impl.axes[i].now.*member;
      }
    }
    if (differs) world.setDefinition(joint, def);
  }
}

}  // namespace rubble

#pragma once
/// Actuators of robots with controls: motors and drives of joint axes and tendons, muscles, rotors, adhesion.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

class World;
class Worlds;

/// What an actuator does with its input. `length` and `speed` are those of the actuator (ActuatorDef::gear).
enum class ActuatorType {
  Force,     ///< of the axis: (gain . (1, length, speed)) input + bias . (1, length, speed) [N], [N m]
  Position,  ///< moves the target position of the drive of the axis by gain.x input [m], [rad]
  Speed,     ///< moves its target speed, likewise [m/s], [rad/s]
  Muscle,    ///< pulls the axis: ActuatorDef::muscle
  Wrench,    ///< force and torque of gain.x input + bias.x on a body, in directions that turn with it
  Adhesion,  ///< pulls a body against all that it touches, with gain.x input in all [N]
};

/// How the input of an actuator follows its control u. The activation a of all but None is a state.
enum class ActuatorDynamics {
  None,         ///< the input is u
  Integrator,   ///< a' = u
  Filter,       ///< a' = (u - a) / time constant, by explicit steps
  FilterExact,  ///< the same, exact for a control that is constant in a step
  Muscle,       ///< calcium of a muscle, faster up than down
};

/// Keywords of scene files.
const char* keyword(ActuatorType type);
const char* keyword(ActuatorDynamics dynamics);

/// A muscle as MuJoCo models it (https://mujoco.readthedocs.io/en/stable/modeling.html#muscle-actuators).
/// Lengths of its curves are those of the fiber over the optimal length, speeds are in vmax optimal lengths
/// per second.
struct Muscle {
  double peakForce = 1;      ///< largest active force without motion [N]
  double optimalLength = 1;  ///< of the fiber [m], [rad]
  double tendonLength = 0;   ///< the actuator is longer than the fiber by this [m], [rad]
  double shortest = 0.5;     ///< length of the fiber without active force [1]
  double longest = 1.6;      ///< the same on the other side [1]
  double fastest = 1.5;      ///< speed of shortening without active force, optimal lengths per second [1/s]
  double passive = 1.3;      ///< passive force at the longest length, over the peak force [1]
  double lengthening = 1.2;  ///< largest active force while it is lengthened, over the peak force [1]
  double rise = 0.01;        ///< time constant of activation [s]
  double fall = 0.04;        ///< of deactivation [s]
  double smoothing = 0;      ///< range of u - a in which one becomes the other [1]

  /// Forces of the actuator, at most 0: it pulls. The active one is at activation 1.
  double activeForce(double length, double speed) const;
  double passiveForce(double length) const;
  /// da/dt for a control, both within 0 and 1 [1/s].
  double activationRate(double control, double activation) const;
};

struct ActuatorDef {
  std::string name;
  ActuatorType type = ActuatorType::Force;
  int joint = -1;  ///< index into Scene::joints
  int axis = 0;    ///< index into JointDef::axes
  /// Length of the actuator per unit of the coordinate of its axis. A force of the actuator acts `gear` times
  /// on the coordinate.
  double gear = 1;
  double offset = 0;         ///< its length where the coordinate is 0
  int body = kWorld;         ///< wrench, adhesion: index into Scene::bodies
  Vec3 position;             ///< wrench: point of the body that it acts at, in its frame [m]
  Vec3 force, torque;        ///< wrench: for a unit, in the frame of the body [N], [N m]
  Vec3 gain{1, 0, 0}, bias;  ///< constant, by length and by speed
  double minForce = -kHard;  ///< bounds of what it does: of a force [N], [N m]
  double maxForce = kHard;
  ActuatorDynamics dynamics = ActuatorDynamics::None;
  double timeConstant = 0;                               ///< of a filter [s]
  bool early = false;                                    ///< the activation of the end of a step acts in it
  double minControl = -kFree, maxControl = kFree;        ///< controls are clamped to these
  double minActivation = -kFree, maxActivation = kFree;  ///< and activations to these
  double control = 0, activation = 0;                    ///< at the beginning
  /// Of its effect, what the axis of the scene has already, as for the control at the beginning: of the motor
  /// force, or of the target.
  double included = 0;
  Muscle muscle;
};

/// Throws Error at `path` and the field that is not possible. Whether body and joint exist is not checked.
void validate(const ActuatorDef& actuator, const std::string& path);

/// Controls and activations of the actuators of a world, or of many worlds of one scene. Snapshots of these
/// worlds have them: World::restore() and Worlds::reset() set them to what they were, or to those at the
/// beginning if the snapshot was taken before the actuators were made.
class Actuators {
 public:
  /// Bodies and joints are those that the world has at present. Throws Error at "actuators[i]..." for one
  /// that is not there.
  Actuators(std::vector<ActuatorDef> actuators, const World& world);
  /// The same in each of the worlds from `first` on, `count` of them; -1: up to the last one. World i has the
  /// bits that it has alone. Throws Error for worlds that are not there.
  Actuators(std::vector<ActuatorDef> actuators, const Worlds& worlds, int first = 0, int count = -1);
  ~Actuators();
  Actuators(Actuators&&) noexcept;
  Actuators& operator=(Actuators&&) noexcept;

  const std::vector<ActuatorDef>& definitions() const;
  /// Worlds that they act in.
  int worlds() const;
  /// Shape: worlds x actuators, world after world. Numbers stay until they are changed.
  std::span<double> controls();
  /// The same; 0 for actuators without dynamics.
  std::span<double> activations();
  /// What each did in the last apply(): its force along its length, or by how much it moves a target; zeros
  /// before. Shape as controls().
  std::span<const double> forces() const;
  /// Sets motor forces, damping and targets of axes and applies forces to bodies for the next step of
  /// Params::dt, then advances the activations by that time. Call it before each step. Forces are those of
  /// the lengths and contacts before the step, and follow the speed in it to first order where they resist
  /// it. What others set of these axes in the meantime is replaced. Throws Error for controls and
  /// activations that are not finite, and for those of a batch.
  void apply(World& world);
  /// The same in the worlds whose element of `active`, one for each of the batch, is not 0; empty: in all.
  /// Throws Error for those of a single world.
  void apply(Worlds& worlds, std::span<const char> active = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble

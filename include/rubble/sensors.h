#pragma once
/// Sensors at frames of bodies and at axes of joints, for the readings of a robot.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

class World;
class Worlds;

/// What a sensor measures. A frame is that of SensorDef::position and orientation on its body.
enum class SensorType {
  Acceleration,        ///< of the frame in the last step, less gravity, axes of the frame [m/s2]: 3 numbers
  AngularRate,         ///< of the frame, its axes [rad/s]: 3 numbers
  Velocity,            ///< of the frame, its axes [m/s]: 3 numbers
  Position,            ///< of the frame in the reference frame [m]: 3 numbers
  Orientation,         ///< the same: a quaternion, 4 numbers, scalar first
  XAxis,               ///< of the frame in the reference frame: 3 numbers
  YAxis,               ///< the same
  ZAxis,               ///< the same
  LinearVelocity,      ///< of the frame relative to the reference frame, axes of that [m/s]: 3 numbers
  AngularVelocity,     ///< the same [rad/s]: 3 numbers
  LinearAcceleration,  ///< of the frame in the last step, less gravity, world axes [m/s2]: 3 numbers
  Force,               ///< of the joint on the body, axes of the frame [N]: 3 numbers
  Torque,              ///< the same, about the origin of the frame [N m]: 3 numbers
  Touch,               ///< sum of the normal forces of contacts in the volume [N]: 1 number
  Range,               ///< along z of the frame to the next body, -1 without one [m]: 1 number
  JointPosition,       ///< of an axis of the joint [m], [rad]: 1 number
  JointSpeed,          ///< the same [m/s], [rad/s]: 1 number
  DriveForce,          ///< the same: of its drive and its motor force [N], [N m]: 1 number
  Time,                ///< [s]: 1 number
};

/// Keyword of a sensor type in scene files: "angular_rate".
const char* keyword(SensorType type);
/// Throws Error if there is none.
SensorType sensorType(const std::string& keyword);
/// Numbers of a reading.
int readingSize(SensorType type);

struct SensorDef {
  std::string name;
  SensorType type = SensorType::Acceleration;
  int body = kWorld;          ///< index into Scene::bodies
  Vec3 position;              ///< of the frame, in that of the body [m]
  Quat orientation;           ///< frame -> body
  int reference = kWorld;     ///< body of the reference frame
  Vec3 referencePosition;     ///< in the frame of that body [m]
  Quat referenceOrientation;  ///< reference frame -> body
  int joint = -1;             ///< index into Scene::joints
  int axis = 0;               ///< index into JointDef::axes
  double scale = 1;           ///< joint axes: a reading is scale times the number plus offset
  double offset = 0;
  /// Touch: a sphere, box, capsule or cylinder in the frame. A contact counts if its point, or the line along
  /// its normal out of the body, meets it.
  Shape volume;
  double cutoff = 0;  ///< largest absolute value of each number; 0: none
};

/// Readings of the sensors of a world, or of many worlds of one scene.
class Sensors {
 public:
  /// Bodies and joints are those that the world has at present. Throws Error at "sensors[i]..." for one that
  /// is not there.
  Sensors(std::vector<SensorDef> sensors, const World& world);
  /// The same in each of the worlds from `first` on, `count` of them; -1: up to the last one. The readings of
  /// a world are those that it has alone. Throws Error for worlds that are not there.
  Sensors(std::vector<SensorDef> sensors, const Worlds& worlds, int first = 0, int count = -1);
  ~Sensors();
  Sensors(Sensors&&) noexcept;
  Sensors& operator=(Sensors&&) noexcept;

  const std::vector<SensorDef>& definitions() const;
  /// Worlds that they measure.
  int worlds() const;
  /// Numbers of a world.
  std::size_t width() const;
  /// Measures the world. Accelerations are those since the last call, so call it after each step.
  void update(World& world);
  /// Measures the worlds whose element of `active` is not 0 (one for each of `worlds`; empty: all). The
  /// others keep their readings. The host computes them. With the backend "cuda" it copies the poses and
  /// velocities of all worlds at once, and their whole state if a sensor reads joints or contacts. Rays are
  /// cast on the device.
  void update(Worlds& worlds, std::span<const char> active = {});
  /// Of all sensors, one after the other, as they were when update() was called; zeros before. Shape: worlds
  /// x width().
  std::span<const double> values() const;
  /// Of one sensor in one of the worlds.
  std::span<const double> values(std::size_t sensor, int world = 0) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble

#pragma once
/// Sample over the API: a vehicle whose wheels are rays. Each ray finds the ground; a spring carries the
/// chassis there, and friction along and across the wheel moves and steers it.
#include <vector>

#include <rubble/world.h>

namespace rubble::scenes {

struct WheelDef {
  Vec3 mount;                ///< top of the suspension, frame of the chassis [m]
  double travel = .3;        ///< from the mount to the center of the wheel, unloaded [m]
  double radius = .4;        ///< [m]
  double stiffness = 40000;  ///< of the spring [N/m]
  double damping = 4000;     ///< [N s/m]
  double friction = 1;       ///< of the tire [1]
  bool steers = false, drives = false;
};

/// What the driver does.
struct Controls {
  double steering = 0;  ///< angle of the steered wheels, left positive [rad]
  double force = 0;     ///< of all driven wheels together, forward [N]
  double brake = 0;     ///< largest force of all wheels together against the motion [N]
};

class RaycastVehicle {
 public:
  /// `chassis`: a dynamic body whose x axis is forward and whose z axis is up. `shown`: one kinematic sensor
  /// for each wheel, which is placed where the wheel is; or none.
  RaycastVehicle(BodyId chassis, std::vector<WheelDef> wheels, std::vector<BodyId> shown = {})
      : chassis_(chassis), wheels_(std::move(wheels)), shown_(std::move(shown)) {}

  /// Applies the forces of the wheels: call before each World::step(). Returns how many touch the ground.
  int drive(World& world, const Controls& controls) const;

 private:
  BodyId chassis_;
  std::vector<WheelDef> wheels_;
  std::vector<BodyId> shown_;
};

}  // namespace rubble::scenes

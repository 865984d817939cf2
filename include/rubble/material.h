#pragma once
/// Surfaces, and the words of authoring that bodies, joints and deformable objects share.
#include <limits>

namespace rubble {

/// "hard": a constraint of infinite stiffness.
inline constexpr double kHard = std::numeric_limits<double>::infinity();
/// "never": a threshold that is not reached.
inline constexpr double kUnbreakable = std::numeric_limits<double>::infinity();
/// In place of a body index of a joint: the fixed world.
inline constexpr int kWorld = -1;

/// Surface of a body. A pair takes the geometric mean of both frictions and the larger restitution.
struct Material {
  double staticFriction = .6;   ///< mu_s [1]
  double dynamicFriction = .6;  ///< mu_d [1], at most mu_s
  double restitution = 0;       ///< e [1], for closing speeds above 1 m/s
};

}  // namespace rubble

#pragma once
/// Surfaces, and the words of authoring that bodies, joints and deformable objects share.
#include <limits>

#include <rubble/math.h>

namespace rubble {

/// "hard": a constraint of infinite stiffness.
inline constexpr double kHard = std::numeric_limits<double>::infinity();
/// "never": a threshold that is not reached.
inline constexpr double kUnbreakable = std::numeric_limits<double>::infinity();
/// In place of a body index of a joint: the fixed world.
inline constexpr int kWorld = -1;

/// How the coefficients of two materials make that of their contact. Of two different rules the one that
/// stands later here is taken.
enum class Combine {
  Usual,  ///< friction: geometric mean; restitution: the larger
  Average,
  Minimum,
  Multiply,
  Maximum,
  GeometricMean,
};

/// Surface of a body or of a deformable object.
struct Material {
  double staticFriction = .6;   ///< mu_s [1]
  double dynamicFriction = .6;  ///< mu_d [1], at most mu_s
  double restitution = 0;       ///< e [1], for closing speeds above 1 m/s
  Combine frictionCombine = Combine::Usual;
  Combine restitutionCombine = Combine::Usual;
  // bodies only
  double rollingFriction = 0;    ///< lever: the moment that resists rolling is at most this times the normal
                                 ///< force [m]; a pair takes the larger
  double torsionalFriction = 0;  ///< lever of the moment that resists spinning about the normal [m]; a pair
                                 ///< takes the larger
  Vec3 surfaceVelocity{};  ///< of a belt: what lies on the surface is carried along at this velocity, body
                           ///< axes [m/s]
};

}  // namespace rubble

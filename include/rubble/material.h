#pragma once
/// Surface materials, and constants that definitions of bodies, joints and deformable objects share.
#include <limits>
#include <optional>
#include <string>

#include <rubble/math.h>

namespace rubble {

/// Infinite stiffness: a hard constraint.
inline constexpr double kHard = std::numeric_limits<double>::infinity();
/// A break threshold that is never reached.
inline constexpr double kUnbreakable = std::numeric_limits<double>::infinity();
/// In place of a body index of a joint: the static world.
inline constexpr int kWorld = -1;

/// Rule that combines the coefficients of two materials. If the two materials have different rules, the later
/// enumerator applies.
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
  /// e [1], of impacts that close faster than the largest of 0.3 sqrt(g L), 2 g dt and 3e-4 L/dt [m/s], with
  /// L the size of the smaller body.
  double restitution = 0;
  Combine frictionCombine = Combine::Usual;
  Combine restitutionCombine = Combine::Usual;
  // bodies only
  /// Lever of rolling resistance [m]: its torque is at most this times the normal force. A pair takes the
  /// larger one.
  double rollingFriction = 0;
  /// Lever of torsional friction about the normal [m]. A pair takes the larger one.
  double torsionalFriction = 0;
  /// Velocity of the surface, body axes [m/s]: a conveyor belt. Friction drives touching bodies to it.
  Vec3 surfaceVelocity{};
  /// One-way surface: the direction, in body axes, of the side that holds. Zero: all sides hold. Another body
  /// is held if all contact normals between the two are within 60 degrees of the direction when they begin to
  /// touch. It passes otherwise. Either is kept until the two have parted.
  Vec3 oneWay{};
  /// Names the material in pair rules (MaterialPair). Empty: pair rules never apply.
  std::string name{};

  friend bool operator==(const Material&, const Material&) = default;
};

/// Coefficients of contacts between two named materials. Each that is given replaces the mixture of those of
/// the two materials. If the mixture of one friction coefficient contradicts the other one, which is given,
/// it takes its value.
struct MaterialPair {
  std::string a, b;  ///< Material::name, in any order; may be equal
  std::optional<double> staticFriction{}, dynamicFriction{}, restitution{};  ///< [1]
  std::optional<double> rollingFriction{}, torsionalFriction{};              ///< bodies only [m]
};

}  // namespace rubble

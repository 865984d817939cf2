#pragma once
/// Authored numbers of bodies, materials and rules of two materials. Scene files and paths of values
/// (world/value_path.h) read and write them by these lists.
#include <rubble/scene.h>

#include "math/field.h"

namespace rubble {

inline constexpr FieldRules kAbove0{FieldRange::Positive}, kAtLeast0{FieldRange::NotNegative};

inline constexpr std::tuple kMassFields{
    field("mass", "kg", "in place of the density", &BodyDef::mass, kAbove0),
    field("density", "kg/m3", "gives the mass", &BodyDef::density, kAbove0)};
/// Where a body is. While a world runs these are its state.
inline constexpr std::tuple kBodyStateFields{
    field("position", "m", "of the shape frame, world", &BodyDef::position),
    field("orientation", "1", "body to world, a unit quaternion", &BodyDef::orientation),
    field("velocity", "m/s", "of the center of mass", &BodyDef::velocity),
    field("angular_velocity", "rad/s", "world axes", &BodyDef::angularVelocity)};
inline constexpr std::tuple kBodyFields{
    field("gravity_scale", "1", "factor on gravity", &BodyDef::gravityScale),
    field("inertia", "kg m2", "principal moments, in place of those of the shape", &BodyDef::inertia,
          kAbove0),
    field("linear_damping", "1/s", "rate at which the velocity decays", &BodyDef::linearDamping, kAtLeast0),
    field("angular_damping", "1/s", "of the angular velocity", &BodyDef::angularDamping, kAtLeast0)};

inline constexpr std::tuple kFrictionFields{
    field("static_friction", "1", "mu_s", &Material::staticFriction, kAtLeast0),
    field("dynamic_friction", "1", "mu_d, at most mu_s", &Material::dynamicFriction, kAtLeast0)};
inline constexpr std::tuple kRestitutionField{
    field("restitution", "1", "e, at most 1", &Material::restitution, kAtLeast0)};
/// Bodies only.
inline constexpr std::tuple kSurfaceFields{
    field("rolling_friction", "m", "lever of rolling resistance", &Material::rollingFriction, kAtLeast0),
    field("torsional_friction", "m", "lever of friction about the normal", &Material::torsionalFriction,
          kAtLeast0),
    field("surface_velocity", "m/s", "of a belt, body axes", &Material::surfaceVelocity),
    field("one_way", "1", "direction of the side that holds, body axes", &Material::oneWay)};

inline constexpr std::tuple kMaterialPairFields{
    field("static_friction", "1", "mu_s of the two", &MaterialPair::staticFriction, kAtLeast0),
    field("dynamic_friction", "1", "mu_d of the two", &MaterialPair::dynamicFriction, kAtLeast0),
    field("restitution", "1", "e of the two, at most 1", &MaterialPair::restitution, kAtLeast0),
    field("rolling_friction", "m", "lever of the two, of bodies", &MaterialPair::rollingFriction, kAtLeast0),
    field("torsional_friction", "m", "the same", &MaterialPair::torsionalFriction, kAtLeast0)};

}  // namespace rubble

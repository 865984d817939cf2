#pragma once
/// Fields of joint axes, and of joint definitions that several joint types have.
#include <rubble/scene.h>

#include "math/field.h"

namespace rubble {

inline constexpr FieldRules kMayBeHard{FieldRange::Positive, "hard"},
    kMayBreak{FieldRange::Positive, "never"}, kMayBeFree{FieldRange::Any, "free"},
    kDrives{FieldRange::NotNegative, "hard"}, kNotNegative{FieldRange::NotNegative};

inline constexpr std::tuple kAnchorFields{
    field("anchor_a", "m", "point on body A, in its frame", &JointDef::anchorA),
    field("anchor_b", "m", "point on body B, in its frame", &JointDef::anchorB)};
inline constexpr std::tuple kFrameFields{
    field("frame_a", "1", "axes of the joint on A, a unit quaternion", &JointDef::frameA),
    field("frame_b", "1", "axes of the joint on B", &JointDef::frameB)};
inline constexpr std::tuple kOrientationField{field("orientation_a_to_b", "1",
                                                    "wanted orientation of A seen from B, a unit quaternion",
                                                    &JointDef::orientationAtoB, {.name = "orientationAtoB"})};
/// Anchors, frames and orientation, which files may also give in the world.
inline constexpr auto kPlacementFields = std::tuple_cat(kAnchorFields, kFrameFields, kOrientationField);

inline constexpr std::tuple kStiffnessField{
    field("stiffness", "N/m", "of the anchors or of the length", &JointDef::stiffness, kMayBeHard)};
inline constexpr std::tuple kDampingFields{
    field("damping", "N s/m", "beside a stiffness", &JointDef::damping, kNotNegative),
    field("damping_ratio", "1", "in place of damping: of critical, for the two bodies alone",
          &JointDef::dampingRatio, kNotNegative)};
inline constexpr std::tuple kAngularStiffnessField{
    field("angular_stiffness", "N m/rad", "of the orientation", &JointDef::angularStiffness, kMayBeHard)};
inline constexpr std::tuple kAngularDampingFields{
    field("angular_damping", "N m s/rad", "beside an angular stiffness", &JointDef::angularDamping,
          kNotNegative),
    field("angular_damping_ratio", "1", "in place of angular damping", &JointDef::angularDampingRatio,
          kNotNegative)};
inline constexpr std::tuple kMaxForceField{
    field("max_force", "N", "the anchors are held with this force at most", &JointDef::maxForce, kMayBeHard)};
inline constexpr std::tuple kMaxTorqueField{field("max_torque", "N m",
                                                  "the orientation is held with this torque at most",
                                                  &JointDef::maxTorque, kMayBeHard)};
inline constexpr std::tuple kLengthField{
    field("length", "m", "below 0: as it is at the beginning", &JointDef::length)};
inline constexpr std::tuple kRatioField{
    field("ratio", "1", "between the motion of A and of B; rack: travel of B for a radian of A [m]",
          &JointDef::ratio)};
inline constexpr std::tuple kFrictionField{
    field("friction", "N m", "torque that resists any turn", &JointDef::friction, kNotNegative)};
inline constexpr std::tuple kBreakForceField{field(
    "break_force", "N", "the joint breaks when its force reaches this", &JointDef::breakForce, kMayBreak)};
inline constexpr std::tuple kBreakTorqueField{field("break_torque", "N m",
                                                    "the joint breaks when its torque reaches this",
                                                    &JointDef::breakTorque, kMayBreak)};
inline constexpr auto kBreakFields = std::tuple_cat(kBreakForceField, kBreakTorqueField);

/// The unit of a field of an axis is the first one for a length, the second one for an angle.
inline constexpr std::tuple kAxisFields{
    field("min", "m, rad", "lower limit", &JointAxis::min, kMayBeFree),
    field("max", "m, rad", "upper limit; equal ones lock the axis", &JointAxis::max, kMayBeFree),
    field("limit_stiffness", "N/m, N m/rad", "of the limits", &JointAxis::limitStiffness, kMayBeHard),
    field("limit_damping", "N s/m, N m s/rad", "of limits with a stiffness", &JointAxis::limitDamping,
          kNotNegative),
    field("target_position", "m, rad", "of the drive", &JointAxis::targetPosition),
    field("target_speed", "m/s, rad/s", "of the drive", &JointAxis::targetSpeed),
    field("drive_stiffness", "N/m, N m/rad", "towards the target position; 0: none",
          &JointAxis::driveStiffness, kDrives),
    field("drive_damping", "N s/m, N m s/rad", "towards the target speed; 0: none; hard: a motor",
          &JointAxis::driveDamping, kDrives),
    field("max_drive_force", "N, N m", "largest force of the drive", &JointAxis::maxDriveForce, kDrives),
    field("friction", "N, N m", "resists any motion, up to this", &JointAxis::friction, kNotNegative),
    field("armature", "kg, kg m2", "inertia of the motor, as it acts on the axis", &JointAxis::armature,
          kNotNegative),
    field("damping", "N s/m, N m s/rad", "viscous friction, without a bound", &JointAxis::damping,
          kNotNegative),
    field("motor_force", "N, N m", "of the motor, positive where it raises the coordinate",
          &JointAxis::motorForce)};

}  // namespace rubble

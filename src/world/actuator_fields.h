#pragma once
/// Authored numbers of actuators. Scene files and paths of values (world/value_path.h) read and write them by
/// these lists.
#include <rubble/actuators.h>

#include "math/field.h"

namespace rubble {

inline constexpr FieldRules kHardOrAny{FieldRange::Any, "hard"}, kFreeOrAny{FieldRange::Any, "free"};

inline constexpr std::tuple kActuatorFields{
    field("gear", "1", "length of the actuator per unit of the coordinate", &ActuatorDef::gear),
    field("offset", "m, rad", "its length where the coordinate is 0", &ActuatorDef::offset),
    field("position", "m", "wrench: point of the body", &ActuatorDef::position),
    field("force", "N", "wrench: of a unit, in the frame of the body", &ActuatorDef::force),
    field("torque", "N m", "wrench: the same", &ActuatorDef::torque),
    field("gain", "N, N m", "per input: constant, by length and by speed", &ActuatorDef::gain),
    field("bias", "N, N m", "without input: the same", &ActuatorDef::bias),
    field("min_force", "N, N m", "bound of what it does", &ActuatorDef::minForce, kHardOrAny),
    field("max_force", "N, N m", "the same", &ActuatorDef::maxForce, kHardOrAny),
    field("time_constant", "s", "of a filter", &ActuatorDef::timeConstant),
    field("early", "1", "the activation of the end of a step acts in it", &ActuatorDef::early),
    field("min_control", "1", "controls are clamped to it", &ActuatorDef::minControl, kFreeOrAny),
    field("max_control", "1", "the same", &ActuatorDef::maxControl, kFreeOrAny),
    field("min_activation", "1", "activations are clamped to it", &ActuatorDef::minActivation, kFreeOrAny),
    field("max_activation", "1", "the same", &ActuatorDef::maxActivation, kFreeOrAny),
    field("control", "1", "at the beginning", &ActuatorDef::control),
    field("activation", "1", "at the beginning", &ActuatorDef::activation),
    field("included", "N, N m, m, rad", "effect that the axis has already", &ActuatorDef::included)};
inline constexpr std::tuple kMuscleFields{
    field("peak_force", "N", "largest active force without motion", &Muscle::peakForce),
    field("optimal_length", "m, rad", "of the fiber", &Muscle::optimalLength),
    field("tendon_length", "m, rad", "length beside that of the fiber", &Muscle::tendonLength),
    field("shortest", "1", "fiber without active force, over the optimal length", &Muscle::shortest),
    field("longest", "1", "the same on the other side", &Muscle::longest),
    field("fastest", "1/s", "shortening without active force, optimal lengths per second", &Muscle::fastest),
    field("passive", "1", "passive force at the longest length, over the peak force", &Muscle::passive),
    field("lengthening", "1", "largest active force of lengthening, likewise", &Muscle::lengthening),
    field("rise", "s", "time constant of activation", &Muscle::rise),
    field("fall", "s", "of deactivation", &Muscle::fall),
    field("smoothing", "1", "range of u - a in which one becomes the other", &Muscle::smoothing)};

}  // namespace rubble

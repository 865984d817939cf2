#pragma once
/// Joints of bodies, and their multipliers.
#include "stages/executor.h"
#include "stages/joints/angular_rows.h"

namespace rubble::RUBBLE_CORE::joints {

template <Executor E> void prepare(E& e) { forEachJoint<BeginJoints>(e); }

/// Rows that depend on the rotation of one body relative to another, about where the bodies are now.
template <Executor E> void linearize(E& e) { forEachJoint<LinearizeAngularRows>(e); }

template <Executor E> void updateDuals(E& e) { forEachJoint<UpdateJointDuals>(e); }

/// Which joints break.
template <Executor E> void finish(E& e) { forEachJoint<FinishJoints>(e); }

}  // namespace rubble::RUBBLE_CORE::joints

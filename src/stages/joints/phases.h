#pragma once
/// Joints between bodies, and their multipliers.
#include "stages/executor.h"
#include "stages/joints/angular_rows.h"

namespace rubble::RUBBLE_CORE::joints {

/// Warm start at x^t.
template <Executor E> void prepare(E& e) { forEachJoint<BeginJoints>(e); }

/// Linearizes the angular rows at the present iterate.
template <Executor E> void linearize(E& e) { forEachJoint<LinearizeAngularRows>(e); }

/// Multipliers. No kernel between the sweep and this one changes what joints read.
template <Executor E> void updateDuals(E& e) { forEachJoint<UpdateJointDuals, When::Beside>(e); }

/// Breaks joints whose load exceeds their strength.
template <Executor E> void finish(E& e) { forEachJoint<FinishJoints>(e); }

}  // namespace rubble::RUBBLE_CORE::joints

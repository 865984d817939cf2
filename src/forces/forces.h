#pragma once
/// The list of joint types. A new joint needs its header and one entry here.
#include <type_traits>

#include "forces/ball.h"
#include "forces/distance.h"
#include "forces/fixed.h"
#include "forces/gear.h"
#include "forces/hinge.h"
#include "forces/pulley.h"
#include "forces/rack.h"
#include "forces/six_dof.h"
#include "forces/slider.h"
#include "forces/swing_twist.h"
#include "forces/universal.h"

namespace rubble::RUBBLE_CORE {

template <class... F> struct TypeList { static constexpr int kSize = sizeof...(F); };

using JointTypes = TypeList<BallJoint, FixedJoint, HingeJoint, SliderJoint, DistanceJoint, UniversalJoint,
                            SwingTwistJoint, SixDofJoint, GearJoint, RackJoint, PulleyJoint>;

/// Calls f.template operator()<F>() for each joint type, in order.
template <class Function, class... F> RUBBLE_HD void forEachType(TypeList<F...>, Function&& f) {
  (f.template operator()<F>(), ...);
}

/// Index of G in the list, or -1.
template <class G, class... F> constexpr int typeIndex(TypeList<F...>) {
  int index = 0, found = -1;
  ((found = std::is_same_v<F, G> ? index : found, ++index), ...);
  return found;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The list of joints. A new joint needs its header and one entry here (docs/extending.md).
#include "forces/ball.h"
#include "forces/distance.h"
#include "forces/extension.h"
#include "forces/fixed.h"
#include "forces/gear.h"
#include "forces/gimbal.h"
#include "forces/hinge.h"
#include "forces/pulley.h"
#include "forces/rack.h"
#include "forces/six_dof.h"
#include "forces/slider.h"
#include "forces/swing_twist.h"
#include "forces/tendon.h"
#include "forces/universal.h"
#include "math/type_list.h"

namespace rubble::RUBBLE_CORE {

/// What scenes call joints (forces/joint_build.h). Their joints are numbered in the order of first
/// appearance.
using JointKinds = TypeList<BallKind, DragKind, FixedKind, AngularSpringKind, HingeKind, SliderKind,
                            DistanceKind, RopeKind, SpringKind, UniversalKind, SwingTwistKind, SixDofKind,
                            GearKind, RackKind, PulleyKind, TendonKind, GimbalKind RUBBLE_EXTRA_JOINTS>;

template <class List> struct JointsOf;
template <class... K> struct JointsOf<TypeList<K...>> { using Type = Unique<typename K::Joint...>; };
/// Joints of the engine.
using JointTypes = JointsOf<JointKinds>::Type;

}  // namespace rubble::RUBBLE_CORE

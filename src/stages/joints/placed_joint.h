#pragma once
/// A joint at the present poses of its bodies, between steps.
#include "stages/joints/joints.h"

namespace rubble::RUBBLE_CORE {

/// Poses are in a frame with its origin at p_B, or at that of the world if B is the world.
template <class F> struct PlacedJoint {
  const JointSpec<F>& spec;
  const Joint<F>& joint;
  SidePose<F> a, b;
  typename F::Memory memory;  ///< at these poses

  RUBBLE_HD PlacedJoint(const SolverData& s, int slot)
      : spec(s.specsOf<F>()[slot]), joint(s.jointsOf<F>()[slot]), memory(joint.memory) {
    const Vec3d origin = jointOrigin(s, spec.b);
    const auto pose = [&](int body) {
      return body == kWorldBody ? Pose{Vec3(Vec3d{} - origin), Quat{}}
                                : Pose{Vec3(s.position[body] - origin), s.orientation[body]};
    };
    if constexpr (hasFrameBodies<F>()) {
      // the world as a frame body has the pose that the step uses
      const auto frameBody = [&](int body) {
        return body == kWorldBody ? Pose{{0, 0, 0}, Quat{}} : pose(body);
      };
      a = {pose(spec.a), frameBody(spec.frameBodyA)};
      b = {pose(spec.b), frameBody(spec.frameBodyB)};
    } else {
      a = pose(spec.a), b = pose(spec.b);
    }
    memory.remember(spec.data, a, b, origin);
  }

  /// Coordinate of an axis [m], [rad]; angles count whole revolutions.
  template <class P> RUBBLE_HD double position() const {
    Real c[1];
    P::constraint(spec.data, memory, a, b, c);
    double turned = 0;
    if constexpr (requires { P::turns(spec.data, memory); }) turned = P::turns(spec.data, memory);
    return static_cast<double>(c[0]) + turned;
  }
  /// dc/dx of the body on that side.
  template <class P> RUBBLE_HD Vec6 jacobian(int side) const {
    Vec6 j[1];
    P::jacobian(spec.data, memory, a, b, side, j);
    return j[0];
  }
  /// Speed of an axis [m/s], [rad/s].
  template <class P> RUBBLE_HD Real speed(const SolverData& s) const {
    Real speed = 0;
    for (int side = 0; side < kSides<F>; ++side)
      if (const int body = bodyOf(spec, side); body != kWorldBody)
        speed += dot(jacobian<P>(side), Vec6{s.velocity[body], s.angularVelocity[body]});
    return speed;
  }
  /// Force and torque of all rows in the last step on body B, about its anchor, world axes [N], [N m].
  RUBBLE_HD void load(Vec3d& force, Vec3d& torque) const {
    force = torque = {0, 0, 0};
    const auto add = [&](Real f, const Vec6& j) {
      force -= Vec3d(f * j.lin);
      torque -= Vec3d(f * j.ang);
    };
    forEachPart<F>([&]<int I, class P>() {
      const auto& rows = partOf<I>(joint.parts);
      Vec6 j[P::kRows];
      P::jacobian(spec.data, memory, a, b, 1, j);
      if constexpr (P::kAxis)
        add(axisLoad(rows) + rows.rotor.force, j[0]);
      else if (partOf<I>(spec.parts).mode != GroupMode::Off)
        for (int i = 0; i < P::kRows; ++i) add(rows.lambda[i], j[i]);
    });
    torque -= cross(Vec3d(leverOf(spec.data, b.q, 1)), force);
  }
};

/// Calls f.operator()<I, P>() for the axis of that number.
template <class F, class Function> RUBBLE_HD void withAxis(int axis, Function&& f) {
  int next = 0;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kAxis)
      if (next++ == axis) f.template operator()<I, P>();
  });
}
/// Calls f.operator()<F>() for the joint type of that index.
template <class Function> RUBBLE_HD void withJointType(int type, Function&& f) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (typeIndex<F>(JointTypes{}) == type) f.template operator()<F>();
  });
}

}  // namespace rubble::RUBBLE_CORE

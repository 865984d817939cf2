#pragma once
/// The stages of joints, for every type of the list.
#include "stages/bodies.h"

namespace rubble::RUBBLE_CORE {

template <class F>
RUBBLE_HD bool active(const View& s, const Joint<F>& joint) {
  return joint.alive && !joint.broken && (isDynamic(s, joint.a) || isDynamic(s, joint.b));
}

RUBBLE_HD inline JointBody jointBody(const View& s, int body) {
  if (body == kWorldBody || s.params[body].kind != BodyKind::Dynamic) return {0, {0, 0, 0}};
  return {s.params[body].mass, s.params[body].inertia};
}

/// Warm start at x^t. Runs before bodies are moved to their initial guess.
template <class F>
struct BeginJoints {
  static constexpr const char* kName = "joint rows";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Joint<F>& joint = s.jointsOf<F>()[i];
    if (!active(s, joint)) return;
    joint.offset = Vec3(jointOrigin(s, joint.a) - jointOrigin(s, joint.b));
    const auto still = [&](int body, const Vec3& offset) { return Pose{offset, body == kWorldBody ? Quat{} : s.orientation[body]}; };
    const auto radius = [&](int body) { return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic ? s.params[body].radius : Real(0); };
    const Real ra = radius(joint.a), rb = radius(joint.b);
    const Real length = 2 * (ra > Real(0) && rb > Real(0) ? min(ra, rb) : max(ra, rb));
    beginJoint(s.step, joint, still(joint.a, joint.offset), still(joint.b, {0, 0, 0}), jointBody(s, joint.a), jointBody(s, joint.b), length);
  }
};

template <class F>
struct UpdateJointDuals {
  static constexpr const char* kName = "joint dual";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Joint<F>& joint = s.jointsOf<F>()[i];
    if (active(s, joint)) updateJointDuals(joint, jointPose(s, joint.a, joint.offset), jointPose(s, joint.b, {0, 0, 0}));
  }
};

template <class F>
struct FinishJoints {
  static constexpr const char* kName = "joint end";
  RUBBLE_HD void operator()(const View& s, int i) const {
    Joint<F>& joint = s.jointsOf<F>()[i];
    if (active(s, joint) && endJoint(joint)) atomicCount(&s.counters->broken, 1);
  }
};

}  // namespace rubble::RUBBLE_CORE

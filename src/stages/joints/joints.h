#pragma once
/// The stages of joints, for every type of the list.
#include "stages/bodies/bodies.h"

namespace rubble::RUBBLE_CORE {

template <class F> RUBBLE_HD bool active(const SolverData& s, int i) {
  const JointSpec<F>& spec = s.specsOf<F>()[i];
  if (!spec.alive || s.jointsOf<F>()[i].broken) return false;
  for (int side = 0; side < kSides<F>; ++side)
    if (isDynamic(s, bodyOf(spec, side))) return true;
  return false;
}

RUBBLE_HD inline JointBody jointBody(const SolverData& s, int body) {
  if (body == kWorldBody) return {};
  const BodyParams& p = s.params[body];
  const bool dynamic = p.kind == BodyKind::Dynamic;
  Vec3 way = s.step->dt * s.velocity[body];
  if (dynamic) way += (s.step->dt * s.step->dt) * (p.gravityScale * s.stepOf(body).gravity);
  const Vec6 velocity{s.velocity[body], s.angularVelocity[body]};
  return {dynamic ? p.mass : Real(0), p.inertia, {way, s.step->dt * velocity.ang}, velocity};
}

/// Pose of a body at x^t, in the frame of a joint.
RUBBLE_HD inline Pose stillPose(const SolverData& s, int body, const Vec3& offset) {
  return {offset, body == kWorldBody ? Quat{} : s.orientation[body]};
}

/// Warm start at x^t. Runs before bodies move to their initial guess.
template <class F> struct BeginJoints {
  static constexpr const char* kStage = "joint rows";
  using StagedJoint = F;  ///< on a GPU it may work on copies of joints
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const JointSpec<F>& spec = s.specsOf<F>()[i];
    Joint<F>& joint = s.jointsOf<F>()[i];
    JointStart<F> x;
    if (!begin(s, i, spec, joint, x)) return;
    beginJoint(x, spec, joint);
    placeJoint(x, spec, joint);
  }
  /// What parts read. Returns false if the joint is inactive.
  RUBBLE_HD static bool begin(const SolverData& s, int i, const JointSpec<F>& spec, Joint<F>& joint,
                              JointStart<F>& x) {
    joint.active = active<F>(s, i);
    if (!joint.active) {
      joint.acting = 0;
      return false;
    }
    joint.sharedLevel = spec.a == kWorldBody || spec.b == kWorldBody ? kCoarseLevels
                                                                     : finestSharedLevel(s, spec.a, spec.b);
    const Vec3d origin = jointOrigin(s, spec.b);
    if constexpr (hasFrameBodies<F>()) {
      const auto offsetOf = [&](int body) {
        return body == kWorldBody ? Vec3{0, 0, 0} : Vec3(s.position[body] - origin);
      };
      joint.offsetFrameA = offsetOf(spec.frameBodyA), joint.offsetFrameB = offsetOf(spec.frameBodyB);
    }
    const auto radius = [&](int body) {
      return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic ? s.params[body].radius : Real(0);
    };
    const Real ra = radius(spec.a), rb = radius(spec.b);
    joint.length = 2 * (ra > Real(0) && rb > Real(0) ? min(ra, rb) : max(ra, rb));
    find(s, spec, joint, x);
    joint.memory.remember(spec.data, x.a, x.b, origin);
    return true;
  }
  /// What a joint starts from, after the frame bodies are placed.
  RUBBLE_HD static void find(const SolverData& s, const JointSpec<F>& spec, const Joint<F>& joint,
                             JointStart<F>& x) {
    x.offset = Vec3(jointOrigin(s, spec.a) - jointOrigin(s, spec.b));
    if constexpr (hasFrameBodies<F>()) {
      x.a = {stillPose(s, spec.a, x.offset), stillPose(s, spec.frameBodyA, joint.offsetFrameA)};
      x.b = {stillPose(s, spec.b, {0, 0, 0}), stillPose(s, spec.frameBodyB, joint.offsetFrameB)};
    } else {
      x.a = stillPose(s, spec.a, x.offset), x.b = stillPose(s, spec.b, {0, 0, 0});
    }
    x.together = s.plan.jointTrees && s.treeNodes > 0;
    for (int side = 0; side < kSides<F>; ++side) {
      const int body = bodyOf(spec, side);
      x.bodies[side] = jointBody(s, body);
      x.together &= !isDynamic(s, body) || s.nodeOfBody[body] >= 0;
    }
    x.constants = s.stepOf(spec.a, spec.b);
  }
};

/// A part of a joint.
struct PartIndex {
  int joint, part;
};
/// The k-th part of joints in groups of kGroupJoints: all first parts of a group, all second ones, and so on,
/// then those of the next group.
inline constexpr int kGroupJoints = 32;
RUBBLE_HD inline PartIndex partInGroups(int k, int joints, int parts) {
  const int first = k / (kGroupJoints * parts) * kGroupJoints, width = min(kGroupJoints, joints - first),
            place = k - first * parts;
  return {first + place % width, place / width};
}
/// Its inverse.
RUBBLE_HD inline int numberInGroups(const PartIndex& at, int joints, int parts) {
  const int first = at.joint / kGroupJoints * kGroupJoints, width = min(kGroupJoints, joints - first);
  return first * parts + at.part * width + at.joint - first;
}
/// The k-th part of all joints of a type. On a GPU the threads of a warp process the same part of different
/// joints, so that they do not diverge, and the next warps other parts of these joints, which are then in the
/// cache. On a CPU a thread processes the parts of one joint after one another.
template <class F> RUBBLE_HD PartIndex partAt(const SolverData& s, int k) {
#if RUBBLE_DEVICE_CODE
  return partInGroups(k, s.joints[typeIndex<F>(JointTypes{})], F::Parts::kCount);
#else
  (void)s;
  return {k / F::Parts::kCount, k % F::Parts::kCount};
#endif
}

/// Dual update of the anchor rows of a joint, from the errors that sweeps see.
template <class F> RUBBLE_HD void updateAnchors(const SolverData& s, Joint<F>& joint) {
  const PivotFrame& frame = loadVectorized(frameOf(joint));
  if (!(frame.acting & 1)) return;
  Real error[AnchorRows::kRows];
  updateVectorized(partOf<0>(joint.parts), [&](GroupRows<AnchorRows::kRows>& rows) {
    anchorErrors(frame, rows, poseSinceStart(s, frame.end[0].body), poseSinceStart(s, frame.end[1].body),
                 error);
    updateGroup<AnchorRows::kRows>(rows.state, error, rows.lambda, AnchorRows::kRows);
    return true;
  });
}

/// One thread per joint part.
template <class F> struct UpdateJointDuals {
  static constexpr const char* kStage = "joint dual";
  static constexpr int kPerJoint = F::Parts::kCount;
  using StagedJoint = F;  ///< as BeginJoints
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const PartIndex at = partAt<F>(s, k);
    (*this)(s, at, s.specsOf<F>()[at.joint], s.jointsOf<F>()[at.joint]);
  }
  /// `joint`: on a GPU a copy.
  RUBBLE_HD void operator()(const SolverData& s, const PartIndex& at, const JointSpec<F>& spec,
                            Joint<F>& joint) const {
    if constexpr (isPivot<F>())
      if (at.part == 0) return updateAnchors(s, joint);
    if (!joint.active) return;
    const SidePose<F> a = poseOfA(s, spec, joint), b = poseOfB(s, spec, joint);
    const StepConstants c = s.stepOf(spec.a, spec.b);
    forEachPart<F>([&]<int I, class P>() {
      if (I == at.part) updatePartDuals<F, I, P>(c, spec, joint, a, b);
    });
  }
};

template <class F> struct FinishJoints {
  static constexpr const char* kStage = "joint end";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (s.jointsOf<F>()[i].active && endJoint(s.specsOf<F>()[i], s.jointsOf<F>()[i]))
      atomicCount(&s.counters->broken, 1);
  }
};

}  // namespace rubble::RUBBLE_CORE

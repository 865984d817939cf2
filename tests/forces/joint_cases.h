#pragma once
/// Random joints of any type, for the tests that hold for all of them.
#include <algorithm>
#include <iterator>

#include <forces/forces.h>
#include <forces/joint_accumulation.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {

/// A joint between two poses.
template <class F> struct JointCase {
  typename F::Data data;
  SidePose<F> a, b;
  typename F::Memory memory{};
};

/// The pose of the body of a side.
template <class F> Pose& poseOf(JointCase<F>& x, int side) {
  if constexpr (hasFrameBodies<F>())
    if (side >= 2) return side == 2 ? x.a.frameBody : x.b.frameBody;
  return side == 0 ? x.a : x.b;
}

/// A frame on a body, rotated by up to 2 rad against `base`. Near half a revolution angles would wrap
/// around.
inline Quat frameNear(test::Random& random, const Quat& base, const Quat& body) {
  return conjugate(body) * base * random.rotationUpTo(2);
}

inline GimbalTilts<Real> randomTilts(test::Random& random) {
  return GimbalTilts<Real>::of(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7));
}
/// Are the axes of the angles of e far from one plane?
inline bool isRegular(const Quat& e, const GimbalTilts<Real>& tilts) {
  const CardanAngles q(shortArc(e), tilts);
  return dot(q.axis(0), cross(q.axis(1), q.axis(2))) > 0.4;
}

/// Anywhere, with large errors.
template <class F> JointCase<F> randomJointCase(test::Random& random) {
  JointCase<F> x{};
  auto& d = x.data;
  for (int side = 0; side < kSides<F>; ++side) poseOf(x, side) = randomPose(random);
  if constexpr (requires { d.anchorA; }) d.anchorA = random.vector(), d.anchorB = random.vector();
  if constexpr (requires { d.aToB; }) d.aToB = conjugate(random.rotationUpTo(2)) * conjugate(x.b.q) * x.a.q;
  if constexpr (requires { d.frameB; }) d.frameB = random.rotation();
  if constexpr (requires { d.baseA; }) {
    d.baseA = random.rotation();
    d.frameA = frameNear(random, x.a.frameBody.q * d.baseA, x.a.q);
  } else if constexpr (requires { d.frameA; }) {
    // not at the tip of the cone, which has no direction
    do d.frameA = frameNear(random, x.b.q * d.frameB, x.a.q);
    while (std::fabs(rotate(conjugate(x.b.q * d.frameB) * x.a.q * d.frameA, Vec3{1, 0, 0}).x) > .95);
  }
  if constexpr (requires { d.tilts; }) {
    d.meet = random.uniform(0, 1) < 0.3;
    if (d.meet == 0) d.offsetB = random.vector(), d.offsetA = random.vector();
    d.tilts = randomTilts(random);
    // not with two axes parallel, where a turn is about both
    while (!isRegular(conjugate(x.b.q * d.frameB) * x.a.q * d.frameA, d.tilts))
      d.frameA = frameNear(random, x.b.q * d.frameB, x.a.q);
  }
  if constexpr (requires { d.baseB; }) {
    d.baseB = random.rotation();
    d.frameB = frameNear(random, x.b.frameBody.q * d.baseB, x.b.q);
  }
  if constexpr (requires { d.driveTarget; }) {
    d.driveTarget = random.rotationUpTo(.4) * conjugate(x.b.q * d.frameB) * x.a.q * d.frameA;
    d.coneY = 1 + random.uniform(0, 1), d.coneZ = 1;
  }
  if constexpr (requires { d.pointA; }) d.pointA = random.vector(3);
  if constexpr (requires { d.pointB; }) d.pointB = random.vector(3);
  if constexpr (requires { d.direction; }) d.direction = random.direction();
  if constexpr (requires { d.term; }) {
    d.points = 5, d.terms = 3;
    for (int i = 0; i < d.points; ++i)
      d.point[i] = {random.vector(), i == 3 ? Real(0) : random.uniform(.3, 1.5), i * 7 % 4};
    for (int k = 0; k < d.terms; ++k) {
      auto& term = d.term[k];
      // a turn, a travel, and one of the three Cardan angles
      term.kind = k < 2 ? k : 2 + static_cast<int>(random.uniform(0, 3));
      term.body = k, term.frameBody = 3 - k;
      term.base = random.rotation(), term.begin = random.vector(), term.anchor = random.vector();
      const Quat base = poseOf(x, term.frameBody).q * term.base;
      term.tilts = randomTilts(random);
      do term.frame = frameNear(random, base, poseOf(x, term.body).q);
      while (k == 2 && !isRegular(conjugate(base) * poseOf(x, term.body).q * term.frame, term.tilts));
      for (Real& c : term.c) c = random.uniform(-.5, .5);
    }
  }
  if constexpr (requires { d.ratio; }) d.ratio = random.uniform(.5, 3);
  x.memory.remember(d, x.a, x.b, {});
  if constexpr (requires { x.memory.start; }) x.memory.start = random.rotationUpTo(.4) * x.memory.start;
  return x;
}

/// Moves A so that the anchors coincide.
template <class F> void closeAnchors(JointCase<F>& x) {
  if constexpr (requires { x.data.anchorA; })
    x.a.p = x.b.p + rotate(x.b.q, x.data.anchorB) - rotate(x.a.q, x.data.anchorA);
}

/// C of one part.
template <class P> struct Rows { Real c[P::kRows]; };
template <class P, class F> Rows<P> constraintOf(const JointCase<F>& x) {
  Rows<P> rows;
  P::constraint(x.data, x.memory, x.a, x.b, rows.c);
  return rows;
}

/// The case with one body moved along the retraction [S 9].
template <class F> JointCase<F> moved(JointCase<F> x, int side, const Vec6& dx) {
  Pose& pose = poseOf(x, side);
  pose = retract(pose, dx);
  return x;
}

/// The case rotated and translated, including the world side of the joint.
template <class F> JointCase<F> image(const JointCase<F>& x, const Quat& turn, const Vec3& shift) {
  JointCase<F> y = x;
  const auto of = [&](const Pose& p) { return Pose{rotate(turn, p.p) + shift, turn * p.q}; };
  for (int side = 0; side < kSides<F>; ++side) poseOf(y, side) = of(poseOf(y, side));
  auto& d = y.data;
  if constexpr (F::kGrounded)
    d.pointA = rotate(turn, d.pointA) + shift, d.pointB = rotate(turn, d.pointB) + shift;
  y.memory.remember(d, y.a, y.b, {});
  if constexpr (requires { y.memory.start; }) y.memory.start = x.memory.start;
  return y;
}

/// A joint with all its parts held, hard and unbreakable; axes locked at 0.
template <class F> JointSpec<F> specOf(const typename F::Data& data) {
  JointSpec<F> spec{};
  spec.data = data;
  spec.a = 0, spec.b = 1;
  if constexpr (hasFrameBodies<F>()) spec.frameBodyA = 2, spec.frameBodyB = 3;
  spec.alive = spec.isRigid = true;
  spec.breakForce = spec.breakTorque = kHardValue;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kAxis)
      partOf<I>(spec.parts) = {0, 0, kHardValue, 0, 0, 0, 0, 0, kHardValue, 0, 0, 0, 0};
    else
      partOf<I>(spec.parts) = {GroupMode::Hold, kHardValue, 0, kHardValue};
  });
  return spec;
}

/// Rows of a joint whose angular rows are linearized at one pair of poses, added to a block at another. x^t:
/// both bodies unrotated.
template <class F>
void accumulateFrom(const JointSpec<F>& spec, Joint<F> joint, const JointCase<F>& from, const SidePose<F>& a,
                    const SidePose<F>& b, int side, Block6& block) {
  joint.acting = actingRows(spec, joint);
  JointAngularRows<F> turns{};
  linearizeAngularRows(spec, joint, from.a, from.b, from.a.q, from.b.q, turns);
  if constexpr (isPivot<F>()) {
    joint.offset = {0, 0, 0};
    joint.end[0] = {spec.data.anchorA, spec.a}, joint.end[1] = {spec.data.anchorB, spec.b};
    AngularRowStream<true> ahead(joint.acting, &turns.from, turns.law);
    accumulatePivot(joint, partOf<0>(joint.parts), ahead, a, b, side, block);
  } else {
    accumulateJoint(spec, joint, &turns, a, b, a.q, b.q, side, block);
  }
}
/// The same with linearized angular rows.
template <class F>
void accumulateAt(const JointSpec<F>& spec, const Joint<F>& joint, const SidePose<F>& a, const SidePose<F>& b,
                  int side, Block6& block) {
  accumulateFrom(spec, joint, JointCase<F>{spec.data, a, b, joint.memory}, a, b, side, block);
}

/// Warm start of a joint between bodies at these poses.
template <class F>
void beginJointAt(const StepConstants& c, const JointSpec<F>& spec, Joint<F>& joint, const SidePose<F>& a,
                  const SidePose<F>& b, const JointBody (&bodies)[kSides<F>]) {
  JointStart<F> x{c, a.p - b.p, a, b, {}, false};
  std::copy(std::begin(bodies), std::end(bodies), x.bodies);
  beginJoint(x, spec, joint);
}

}  // namespace rubble::RUBBLE_CORE

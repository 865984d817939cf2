#pragma once
/// Random joints of any type, for the tests that hold for all of them.
#include <forces/forces.h>

#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {

/// A joint between two poses.
template <class F> struct JointCase {
  typename F::Data data;
  Pose a, b;
};

/// Anywhere, with large errors.
template <class F> JointCase<F> randomJointCase(test::Random& random) {
  JointCase<F> x{};
  x.data.anchorA = random.vector(), x.data.anchorB = random.vector();
  x.a = randomPose(random), x.b = randomPose(random);
  if constexpr (requires { x.data.aToB; }) {
    // not close to half a turn away, where the short arc changes sides
    const Quat deviation = random.rotationUpTo(2);
    x.data.aToB = conjugate(deviation) * conjugate(x.b.q) * x.a.q;
  }
  return x;
}

/// Moves A so that the anchors coincide.
template <class F> void closeAnchors(JointCase<F>& x) { x.a.p = x.b.p + rotate(x.b.q, x.data.anchorB) - rotate(x.a.q, x.data.anchorA); }

/// Without any error.
template <class F> JointCase<F> closedJointCase(test::Random& random) {
  JointCase<F> x = randomJointCase<F>(random);
  closeAnchors(x);
  if constexpr (requires { x.data.aToB; }) x.data.aToB = conjugate(x.b.q) * x.a.q;
  return x;
}

}  // namespace rubble::RUBBLE_CORE

/// SIMD kernels for bodies, slices, aggregates and joints give the bits of the scalar code.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// A net of 12 x 12 spheres on ball joints with its top row held. Some nodes are boxes that rotate fast,
/// have locked axes, are jointed to the world or are heavy. Loose spheres among them give some bodies
/// contacts, some joints and some both.
struct Net : CoreWorld {
  static constexpr int kSize = 12;
  Net() {
    for (int row = 0; row < kSize; ++row)
      for (int column = 0; column < kSize; ++column) {
        BodyDef body;
        body.shape = (row + column) % 5 == 0 ? Shape::box({.3, .4, .5}) : Shape::sphere(.4);
        body.density = row == 7 ? 5000 : 500;
        body.position = {static_cast<double>(column), 0, -static_cast<double>(row)};
        if (row == 0) body.motion = Motion::Static;
        if (row == 5 && column % 3 == 0) body.angularVelocity = {20, 90, 5};
        if (row == 9) body.velocity = {0, 6, 1};
        add(body);
      }
    for (int i = 0; i < 20; ++i) {
      BodyDef loose;
      loose.shape = Shape::sphere(.3);
      loose.position = {.55 * i, .2, 1 + .1 * i};
      add(loose);
    }
    finish();
    int slot = 0;
    for (int row = 1; row < kSize; ++row)
      for (int column = 0; column < kSize; ++column) {
        const int i = row * kSize + column;
        if (column > 0) addBall(slot++, i - 1, i, {.5, 0, 0}, {-.5, 0, 0});
        addBall(slot++, i - kSize, i, {0, 0, -.5}, {0, 0, .5});
        if (row == kSize - 1 && column % 4 == 1)
          addBall(slot++, i, kWorldBody, {0, 0, 0}, {static_cast<double>(column), .3, -kSize + 1});
      }
    view().extras[30].locks = view().extras[77].locks = 2 + 8;
    view().locked = 1;
  }
  void step(double& previousDt) {
    planTrees(executor().tables());
    beginStep(view(), settings(), previousDt);
    rubble::RUBBLE_CORE::step(executor());
    previousDt = settings().params.dt;
  }
};

TEST(Simd4Kernels, HaveTheBitsOfTheScalarCode) {
  Net four, one;
  one.executor().takeBackward();
  double before = 0, beforeOne = 0;
  int touching = 0;
  for (int n = 0; n < 60; ++n) {
    four.step(before), one.step(beforeOne);
    const SolverData &s = four.view(), &t = one.view();
    touching = max(touching, s.counters->contacts);
    const auto same = [](const auto& a, const auto& b, int count) {
      return std::memcmp(a, b, sizeof a[0] * static_cast<std::size_t>(count)) == 0;
    };
    ASSERT_TRUE(same(s.position, t.position, s.bodies) && same(s.orientation, t.orientation, s.bodies)) << n;
    ASSERT_TRUE(same(s.velocity, t.velocity, s.bodies) &&
                same(s.angularVelocity, t.angularVelocity, s.bodies))
        << n;
    for (int i = 0; i < s.joints[0]; ++i) {
      const auto &rows = partOf<0>(s.jointsOf<BallJoint>()[i].parts),
                 &alone = partOf<0>(t.jointsOf<BallJoint>()[i].parts);
      ASSERT_TRUE(same(rows.lambda, alone.lambda, 3) && same(rows.shift, alone.shift, 3) &&
                  same(&rows.state.k, &alone.state.k, 1))
          << n << " " << i;
    }
  }
  // all kinds of bodies are there, and move
  EXPECT_GT(touching, 0);
  EXPECT_GT(length(four.view().velocity[100]), Real(.05));
}

/// Rods in a row on joints of all types about a point and two others, with limits, drives and friction, which
/// swing and turn fast.
struct MixedChain : CoreWorld {
  static constexpr int kLinks = 42;
  MixedChain() {
    for (int i = 0; i < kLinks; ++i) {
      BodyDef body;
      body.shape = Shape::box({.4, .1, .15});
      body.position = {static_cast<double>(i), 0, 0};
      if (i == 0) body.motion = Motion::Static;
      body.angularVelocity = {.5 * (i % 5), 1. - .3 * (i % 7), .2 * (i % 3)};
      add(body);
    }
    finish();
    constexpr JointTypes kAll;
    constexpr int types[] = {typeIndex<BallJoint>(kAll),       typeIndex<FixedJoint>(kAll),
                             typeIndex<HingeJoint>(kAll),      typeIndex<UniversalJoint>(kAll),
                             typeIndex<SwingTwistJoint>(kAll), typeIndex<SliderJoint>(kAll),
                             typeIndex<DistanceJoint>(kAll)};
    int slots[JointTypes::kSize] = {};
    test::Random random(41);
    for (int i = 1; i < kLinks; ++i) {
      EngineJoint joint;
      joint.type = types[static_cast<std::size_t>(i) % std::size(types)];
      joint.a = i - 1, joint.b = i;
      joint.anchorA = {.5, 0, 0}, joint.anchorB = {-.5, 0, 0};
      const Quat frame = random.rotation();
      joint.frameA = joint.frameB = {static_cast<double>(frame.s), rubble::Vec3(frame.v)};
      JointAxis axis;
      axis.min = -.05, axis.max = .02 * (i % 3);
      axis.friction = i % 2, axis.driveStiffness = i % 4, axis.driveDamping = .1;
      joint.axes = {axis, axis};
      addJoint(slots[joint.type]++, joint);
    }
  }
};

/// The sum of a body's constraint blocks with either way to add one.
template <class Add> Block6 sumOfRows(const SolverData& s, int body, Add&& add) {
  Block6 sum;
  for (int k = s.incidenceOffset[body]; k < s.incidenceOffset[body + 1]; ++k)
    if (constraintType(s.incidence[k].code) != kContactType) add(s, s.incidence[k].code, sum);
  return sum;
}

TEST(JointSweep, OneCodeForAllTypesAboutAPointHasTheBitsOfThatOfEach) {
  MixedChain chain;
  double before = 0;
  int acting = 0;
  for (int n = 0; n < 20; ++n) {
    beginStep(chain.view(), chain.settings(), before);
    step(chain.executor());
    before = chain.settings().params.dt;
    const SolverData& s = chain.view();
    for (int i = 1; i < s.bodies; ++i) {
      const Block6 own = sumOfRows(
          s, i, [](const SolverData& v, std::uint32_t code, Block6& to) { addJoint(v, code, to); });
      const Block6 alike = sumOfRows(s, i, [](const SolverData& v, std::uint32_t code, Block6& to) {
        addJointUniform(v, code, to, [&](Block6& others) { addJoint(v, code, others); });
      });
      ASSERT_EQ(std::memcmp(&own, &alike, sizeof own), 0) << n << " " << i;
      ASSERT_GT(length(own.fl) + length(own.fa), 0) << n << " " << i;
    }
    for (int i = 0; i < s.joints[typeIndex<SwingTwistJoint>(JointTypes{})]; ++i)
      acting |= s.jointsOf<SwingTwistJoint>()[i].acting;
  }
  constexpr int kTwist = 4;
  EXPECT_EQ(acting >> angularBit(firstAngularLaw<SwingTwistJoint, kTwist>()) & 7, 7)
      << "limits, drives and friction are among them";
}

/// Rotating the levers of x^t gives the same anchors as rotating the whole joint frame.
TEST(JointSweep, ErrorsOfAnchorsByLeversAreThoseByOrientations) {
  MixedChain chain;
  double before = 0;
  for (int n = 0; n < 5; ++n) {
    beginStep(chain.view(), chain.settings(), before);
    step(chain.executor());
    before = chain.settings().params.dt;
  }
  // within a step: displacements and rotations are nonzero, orientations are those of x^t
  SolverData& s = chain.view();
  test::Random random(5);
  beginStep(s, chain.settings(), before);
  for (int i = 0; i < s.joints[typeIndex<HingeJoint>(JointTypes{})]; ++i) BeginJoints<HingeJoint>{}(s, i);
  for (int i = 0; i < s.bodies; ++i) s.dx[i].dp = random.vector(), s.dq[i] = random.rotation();
  for (int i = 0; i < s.joints[typeIndex<HingeJoint>(JointTypes{})]; ++i) {
    const JointSpec<HingeJoint>& spec = s.specsOf<HingeJoint>()[i];
    const Joint<HingeJoint>& joint = s.jointsOf<HingeJoint>()[i];
    const auto& rows = partOf<0>(joint.parts);
    Real levers[3], whole[3];
    anchorErrors(joint, rows, poseSinceStart(s, spec.a), poseSinceStart(s, spec.b), levers);
    partErrors<AnchorRows>(spec, joint, rows, poseOfA(s, spec, joint), poseOfB(s, spec, joint), whole);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(levers[k], whole[k], 1e-12) << i << " " << k;
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

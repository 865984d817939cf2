/// Bodies, chunks, groups and joints in the lanes of registers have the bits that they have one by one.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// A net of 12 x 12 spheres on ball joints, its top row held, of which some are boxes that turn fast, locked, on the world or heavy; loose
/// spheres lie in it, so that some bodies have contacts and joints, and some only one of these.
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
        if (row == kSize - 1 && column % 4 == 1) addBall(slot++, i, kWorldBody, {0, 0, 0}, {static_cast<double>(column), .3, -kSize + 1});
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

TEST(SideBySide, HasTheBitsOfOneByOne) {
  Net four, one;
  one.executor().takeOneByOne();
  double before = 0, beforeOne = 0;
  int touching = 0;
  for (int n = 0; n < 60; ++n) {
    four.step(before), one.step(beforeOne);
    const View &s = four.view(), &t = one.view();
    touching = max(touching, s.counters->contacts);
    const auto same = [](const auto* a, const auto* b, int count) { return std::memcmp(a, b, sizeof *a * static_cast<std::size_t>(count)) == 0; };
    ASSERT_TRUE(same(s.position, t.position, s.bodies) && same(s.orientation, t.orientation, s.bodies)) << n;
    ASSERT_TRUE(same(s.velocity, t.velocity, s.bodies) && same(s.spin, t.spin, s.bodies)) << n;
    for (int i = 0; i < s.joints[0]; ++i) {
      const auto &rows = partOf<0>(s.jointsOf<BallJoint>()[i].parts), &alone = partOf<0>(t.jointsOf<BallJoint>()[i].parts);
      ASSERT_TRUE(same(rows.lambda, alone.lambda, 3) && same(rows.shift, alone.shift, 3) && same(&rows.state.k, &alone.state.k, 1)) << n << " " << i;
    }
  }
  // all kinds of bodies are there, and move
  EXPECT_GT(touching, 0);
  EXPECT_GT(length(four.view().velocity[100]), Real(.1));
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

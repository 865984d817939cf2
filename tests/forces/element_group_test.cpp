/// Elements that a cluster of vertices crosses: force, moment and Hessian of its rigid motion.
#include <gtest/gtest.h>

#include "forces/group_accumulation.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

using test::Random;

/// At rest a spring has no force that turns with it, so its Hessian is the derivative of force and moment.
TEST(SpringOfCluster, HasTheDerivativeOfForceAndMomentAtRest) {
  Random random(1);
  const StepConstants c = testConstants();
  for (int round = 0; round < 10; ++round)
    for (const unsigned mask : {1u, 2u, 3u}) {
      const Vec3 x[2] = {random.vector(), random.vector()}, center = random.vector();
      Spring e{};
      e.stiffness = 1000, e.mass = .1, e.bound = 1e30, e.restLength = length(x[1] - x[0]);
      e.begin(c, x);
      const auto at = [&](const Vec6& move) {
        Vec3 y[2] = {x[0], x[1]};
        forEachInside(x, mask, center, [&](int k, const Vec3& s) { y[k] += move.lin + cross(move.ang, s); });
        Block6 block;
        accumulateGroup(c, e, y, mask, center + move.lin, 1, block);
        return Vec6{block.fl, block.fa};
      };
      Block6 block;
      accumulateGroup(c, e, x, mask, center, 1, block);
      const Sym6 hessian = pack(block);
      constexpr Real kStep = 1e-6;
      for (int i = 0; i < 6; ++i) {
        Vec6 step = unitVec6(i);
        step.lin *= kStep, step.ang *= kStep;
        const Vec6 plus = at(step), minus = at({-step.lin, -step.ang});
        for (int j = 0; j < 6; ++j)
          EXPECT_NEAR((component(minus, j) - component(plus, j)) / (2 * kStep), hessian(i, j), .05)
              << "mask " << mask << ": " << i << ", " << j;
      }
    }
}

/// Stretched along x, y or z beyond half its volume, a corner of a cube is equally stiff.
TEST(TetrahedronOfCluster, IsAsStiffWhicheverWayItIsStretched) {
  const StepConstants c = testConstants();
  const auto stiffness = [&](int axis) {
    Tetrahedron e{};
    e.m[0] = {1, 0, 0}, e.m[1] = {0, 1, 0}, e.m[2] = {0, 0, 1};
    e.mu = 10, e.lambda = 40;
    Vec3 x[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    x[axis + 1] = Real(2.5) * x[axis + 1];
    Block6 block;
    accumulateGroup(c, e, x, 1, {0, 0, 0}, 1, block);
    return block.ll.xx + block.ll.yy + block.ll.zz;
  };
  EXPECT_NEAR(stiffness(1), stiffness(0), 1e-9);
  EXPECT_NEAR(stiffness(2), stiffness(0), 1e-9);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

/// Aggregates of the coarse correction: center of mass and inertia.
#include <gtest/gtest.h>

#include <vector>

#include "stages/coarse/coarse.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// A few bodies far from the origin, all of one aggregate.
struct Bodies {
  static constexpr int kCount = 12;
  std::vector<Vec3d> position;
  std::vector<BodyTarget> target;
  std::vector<Displacement> moved;
  StepConstants step{};
  SolverData view;

  Bodies() {
    test::Random random(3);
    for (int i = 0; i < kCount; ++i) {
      position.push_back(Vec3d{1e4, -2e4, 5e3} + random.vector(2));
      moved.push_back({random.vector(.1), 0, random.vector(.1), 0});
      const Vec3 inertia = Vec3{1.5, 1.5, 1.5} + random.vector(.5);
      target.emplace_back();
      target.back().mass = massMatrix(random.uniform(.1, 10), inertia, random.rotation());
    }
    view.bodies = kCount;
    view.position = position.data(), view.target = target.data(), view.dx = moved.data();
    step.inverseDt = 60;
    view.step = &step;
  }

  Aggregate aggregate(bool joined) const {
    Aggregate aggregate{};
    aggregate.joined = joined;
    Block6 sum;
    for (int i = 0; i < kCount; ++i) addInertia(view, aggregate, position[0], i, sum);
    placeAggregate(aggregate, position[0], sum);
    return aggregate;
  }
};

TEST(AggregateInertia, IsAboutTheCenterOfMass) {
  const Bodies bodies;
  Vec3d moment{0, 0, 0};
  double mass = 0;
  for (std::size_t i = 0; i < Bodies::kCount; ++i) {
    const double own = bodies.target[i].mass.mass;
    mass += own;
    moment += own * (bodies.position[i] - bodies.position[0]);
  }
  EXPECT_LT(length(bodies.aggregate(false).center - bodies.position[0] - moment / mass), 1e-10);
}

TEST(AggregateInertia, IsTheSumOfThoseOfItsBodiesAboutThatCenter) {
  const Bodies bodies;
  for (const bool joined : {false, true}) {
    const Aggregate aggregate = bodies.aggregate(joined);
    Block6 expected;
    for (std::size_t i = 0; i < Bodies::kCount; ++i) {
      Block6 own;
      setInertialHessian(own, bodies.target[i].mass, 3600);
      addShifted(expected, own, shiftOf(bodies.view, aggregate, static_cast<int>(i)));
    }
    const Sym6 sum = pack(aggregate.inertia), wanted = pack(expected);
    double largest = 0;
    for (const double x : wanted.a) largest = std::max(largest, std::fabs(x));
    for (std::size_t k = 0; k < std::size(wanted.a); ++k)
      EXPECT_NEAR(sum.a[k], wanted.a[k], 1e-10 * largest) << k << (joined ? ", joined" : "");
    EXPECT_EQ(length(aggregate.inertia.fl) + length(aggregate.inertia.fa), 0);
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

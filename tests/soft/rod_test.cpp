/// Rods of oriented segments against the closed forms of beams and shafts.
#include <numbers>

#include <gtest/gtest.h>
#include <rubble/error.h>
#include <rubble/rod.h>

#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

RodDef beam(int pieces) {
  RodDef rod;
  for (int i = 0; i <= pieces; ++i) rod.points.push_back({double(i) / pieces, 0, 0});
  rod.radius = .02;
  rod.youngsModulus = 1e8;
  rod.density = 1000;
  rod.viscosity = 1e6;
  rod.start = kWorld;
  return rod;
}
double second(const RodDef& rod) { return std::numbers::pi * std::pow(rod.radius, 4) / 4; }

/// A force and a moment at the end of a rod until it rests; returns the state of the last piece.
BodyState loaded(const RodDef& rod, const Vec3& force, const Vec3& moment, int steps = 600) {
  Scene scene = emptyScene({0, 0, 0});
  const RodParts made = addRod(scene, rod);
  World world(scene, options(4));
  const BodyId last = world.bodies()[static_cast<std::size_t>(made.bodies - 1)];
  const double half = length(rod.points.back() - rod.points[rod.points.size() - 2]) / 2;
  for (int i = 0; i < steps; ++i) {
    const BodyState state = world.state(last);
    // at its end
    const Vec3 lever = rotate(state.orientation, Vec3{0, 0, half});
    world.applyForce(last, force);
    world.applyTorque(last, moment + cross(lever, force));
    world.step();
  }
  EXPECT_LT(length(world.state(last).velocity), 1e-4);
  return world.state(last);
}

TEST(RodParts, StretchesAsItsSectionSays) {
  const RodDef rod = beam(10);
  const double area = std::numbers::pi * rod.radius * rod.radius;
  const BodyState end = loaded(rod, {1000, 0, 0}, {});
  // to the middle of the last piece
  EXPECT_NEAR(end.position.x - .95, 1000 * .95 / (rod.youngsModulus * area),
              .01 * 1000 / (rod.youngsModulus * area));
}

TEST(RodParts, TwistsAsItsSectionSays) {
  RodDef rod = beam(10);
  rod.youngsModulus = 4e5, rod.viscosity = 4e3;
  const double shear = rod.youngsModulus / (2 * (1 + rod.poissonRatio)), torque = .02;
  const BodyState end = loaded(rod, {}, {torque, 0, 0});
  const Quat turn = end.orientation * conjugate(frameAlong({1, 0, 0}) *
                                                Quat{std::numbers::sqrt2 / 2, 0, std::numbers::sqrt2 / 2, 0});
  const double wanted = torque * .95 / (shear * 2 * second(rod));
  EXPECT_GT(wanted, .4);
  EXPECT_NEAR(2 * std::atan2(turn.v.x, turn.s), wanted, .01 * wanted);
}

TEST(RodParts, BendsAsABeam) {
  double before = 1;
  for (const int pieces : {10, 20}) {
    const RodDef rod = beam(pieces);
    const double area = std::numbers::pi * rod.radius * rod.radius,
                 shear = rod.youngsModulus / (2 * (1 + rod.poissonRatio));
    const double kappa = 6 * (1 + rod.poissonRatio) / (7 + 6 * rod.poissonRatio), force = 1;
    const BodyState end = loaded(rod, {0, 0, force}, {});
    const Vec3 tip = end.position + rotate(end.orientation, Vec3{0, 0, .5 / pieces});
    // Timoshenko: F L^3 / (3 E I) + F L / (kappa G A)
    const double wanted = force / (3 * rod.youngsModulus * second(rod)) + force / (kappa * shear * area);
    const double error = std::fabs(tip.z / wanted - 1);
    EXPECT_LT(error, pieces == 10 ? .01 : .005) << pieces;
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(RodParts, BendsToACircleUnderAMoment) {
  // one radian over its length
  RodDef rod = beam(10);
  rod.youngsModulus = 1e6, rod.viscosity = 1e6;
  const double moment = rod.youngsModulus * second(rod);
  const BodyState end = loaded(rod, {}, {0, -moment, 0}, 1200);
  const Vec3 tip = end.position + rotate(end.orientation, Vec3{0, 0, .05});
  EXPECT_NEAR(tip.x, std::sin(1.), .01);
  EXPECT_NEAR(tip.z, 1 - std::cos(1.), .01);
}

TEST(RodParts, KeepsTheShapeThatItWasMadeIn) {
  Scene scene = emptyScene({0, 0, 0});
  RodDef rod = beam(1);
  rod.points.clear();
  for (int i = 0; i <= 30; ++i) rod.points.push_back({.2 * std::cos(.4 * i), .2 * std::sin(.4 * i), .01 * i});
  addRod(scene, rod);
  World world(scene, options(4));
  run(world, 60);
  std::size_t i = 0;
  for (const BodyId id : world.bodies())
    EXPECT_LT(length(world.state(id).position - scene.bodies[i++].position), 1e-5);
}

TEST(RodParts, SaysWhatIsWrong) {
  Scene scene;
  const auto refused = [&](auto&& change) {
    RodDef rod = beam(2);
    change(rod);
    try {
      addRod(scene, rod);
    } catch (const Error& error) {
      return error.path();
    }
    return std::string();
  };
  EXPECT_EQ(refused([](RodDef& r) { r.points.resize(1); }), "rod.points");
  EXPECT_EQ(refused([](RodDef& r) { r.points[2] = r.points[1]; }), "rod.points[2]");
  EXPECT_EQ(refused([](RodDef& r) { r.radius = 0; }), "rod.radius");
  EXPECT_EQ(refused([](RodDef& r) { r.poissonRatio = .6; }), "rod.poissonRatio");
  EXPECT_EQ(refused([](RodDef& r) { r.end = 3; }), "rod.end");
  EXPECT_EQ(refused([](RodDef& r) { r.viscosity = -1; }), "rod.viscosity");
  EXPECT_TRUE(scene.bodies.empty());
}

}  // namespace
}  // namespace rubble

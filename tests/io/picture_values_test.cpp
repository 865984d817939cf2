/// Values that colors show.
#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "io/picture_values.h"

namespace rubble::io {
namespace {

constexpr double kWeight = 1000 * 9.81;  // of a cube of 1 m [N]

BodyDef cube(const Vec3& position) {
  BodyDef body;
  body.position = position;
  return body;
}

WorldOptions quiet(const std::string& backend = "cpu") {
  WorldOptions options;
  options.backend = backend, options.threads = 1, options.timings = false;
  return options;
}

Scene onGround(std::vector<BodyDef> bodies) {
  Scene scene;
  scene.bodies = std::move(bodies);
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  scene.bodies.push_back(ground);
  return scene;
}

World settled(const Scene& scene, int steps = 60) {
  World world(scene, quiet());
  for (int i = 0; i < steps; ++i) world.step();
  return world;
}

World twoTowers() {
  return settled(onGround({cube({0, 0, .5}), cube({0, 0, 1.5}), cube({0, 0, 2.5}), cube({4, 0, .5}),
                           cube({4, 0, 1.5}), cube({9, 0, 50})}));
}

TEST(Values, IslandsAreConnectedByContactsAndNotByTheGround) {
  const World world = twoTowers();
  const std::vector<double> island = bodyValues(world, ColorBy::Island);
  ASSERT_EQ(island.size(), 7u);
  EXPECT_EQ(island[0], island[1]);
  EXPECT_EQ(island[0], island[2]);
  EXPECT_EQ(island[3], island[4]);
  EXPECT_NE(island[0], island[3]);
  EXPECT_EQ(island[5], -1) << "it falls freely";
  EXPECT_EQ(island[6], -1) << "the ground joins nothing";
}

TEST(Values, IslandsAreConnectedByJoints) {
  Scene scene;
  scene.bodies = {cube({0, 0, 0}), cube({3, 0, 0}), cube({6, 0, 0})};
  scene.joints = {jointAt(scene, JointType::Ball, 0, 1, {1.5, 0, 0})};
  const std::vector<double> island = bodyValues(settled(scene, 2), ColorBy::Island);
  EXPECT_EQ(island[0], island[1]);
  EXPECT_EQ(island[2], -1);
}

TEST(Values, NeighborsHaveDifferentColors) {
  const World world = twoTowers();
  const std::vector<double> color = bodyValues(world, ColorBy::Color);
  EXPECT_NE(color[0], color[1]);
  EXPECT_NE(color[1], color[2]);
  EXPECT_GE(color[0], 0);
  EXPECT_EQ(color[6], -1) << "the ground is not solved for";
}

TEST(Values, MultipliersCarryTheWeightAbove) {
  const std::vector<double> force = bodyValues(twoTowers(), ColorBy::Multiplier);
  // The lowest of three cubes stands on four points with the weight of three.
  EXPECT_NEAR(force[0], 3 * kWeight / 4, .1 * kWeight);
  EXPECT_NEAR(force[2], kWeight / 4, .1 * kWeight);
  EXPECT_EQ(force[5], 0);
}

TEST(Values, StiffnessFollowsTheLoad) {
  const std::vector<double> k = bodyValues(twoTowers(), ColorBy::Stiffness);
  EXPECT_GE(k[0], k[2]);
  EXPECT_GT(k[2], 1e5);
  EXPECT_EQ(k[5], 0);
}

TEST(Values, ErrorsAreDepthsAndGaps) {
  // Two cubes without gravity that begin 2 cm in one another, and two that a joint with a gap of 10 cm holds.
  Scene scene;
  scene.gravity = {};
  scene.bodies = {cube({0, 0, 0}), cube({.98, 0, 0}), cube({10, 0, 0}), cube({13, 0, 0}), cube({30, 0, 0})};
  JointDef joint;
  joint.bodyA = 2, joint.bodyB = 3;
  joint.anchorA = {1.5, 0, 0}, joint.anchorB = {-1.4, 0, 0};
  scene.joints = {joint};
  World world(scene, quiet());
  world.step();
  double depth = 0;
  for (const ContactPoint& c : world.contacts()) depth = std::max(depth, c.depth);
  const std::vector<double> error = bodyValues(world, ColorBy::Error);
  EXPECT_GT(depth, 1e-3);
  EXPECT_EQ(error[0], depth);
  EXPECT_EQ(error[1], depth);
  EXPECT_EQ(error[2], world.state(world.joints()[0]).gap);
  EXPECT_GT(error[2], .01);
  EXPECT_EQ(error[4], 0);
}

TEST(Values, MaterialsAreAlikeWhereAllTheirMembersAre) {
  Scene scene = onGround(
      {cube({0, 0, .5}), cube({3, 0, .5}), cube({6, 0, .5}), cube({9, 0, .5}), cube({12, 0, .5})});
  scene.bodies[1].material.staticFriction = .9;
  scene.bodies[2].name = "another";
  scene.bodies[3].material.oneWay = {0, 0, 1};
  scene.bodies[4].material.name = "stone";
  const std::vector<double> material = bodyValues(settled(scene, 0), ColorBy::Material);
  EXPECT_EQ(material[0], material[2]);
  EXPECT_EQ(std::set<double>(material.begin(), material.begin() + 5).size(), 4u);
}

TEST(Values, StrainIsTheChangeOfLength) {
  // A sheet of 2 m that begins 10 % longer along x: edges along x are, those along y are not, diagonals lie
  // between.
  Scene scene;
  scene.gravity = {};
  ClothDef cloth = clothSheet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
  cloth.start = cloth.vertices;
  for (Vec3& p : cloth.start) p.x *= 1.1;
  CableDef rod = straightCable({5, 0, 0}, {6, 0, 0}, 4);
  scene.deformables = {cloth, rod};
  const World world(scene, quiet());
  const auto strain = vertexValues(world, ColorBy::Strain);
  ASSERT_EQ(strain.size(), 2u);
  for (const float s : strain[0]) EXPECT_NEAR(s, .1f, 1e-5f);
  for (const float s : strain[1]) EXPECT_NEAR(s, 0, 1e-5f);
  EXPECT_TRUE(std::isnan(largestValue({}, ColorBy::Strain)) || largestValue({}, ColorBy::Strain) == 0);
}

TEST(Values, PicturesHaveThem) {
  const World world = twoTowers();
  const std::vector<PictureBody> bodies = pictureBodies(world, ColorBy::Multiplier);
  EXPECT_EQ(shownValue(bodies[0], ColorBy::Multiplier), bodyValues(world, ColorBy::Multiplier)[0]);
  EXPECT_GT(largestValue(bodies, ColorBy::Multiplier), kWeight / 2);
  EXPECT_EQ(largestValue(bodies, ColorBy::Speed), length(world.state(world.bodies()[5]).velocity));
}

TEST(Values, UnknownOnesAreNamed) {
  EXPECT_EQ(colorByNamed("strain"), ColorBy::Strain);
  try {
    colorByNamed("taste");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("stiffness"), std::string::npos);
  }
}

TEST(Values, EveryBackendHasThem) {
  const Scene scene = onGround({cube({0, 0, .5}), cube({0, 0, 1.5})});
  for (const std::string backend : {"cpu", "reference", "lockstep"}) {
    World world(scene, quiet(backend));
    for (int i = 0; i < 5; ++i) world.step();
    EXPECT_GT(bodyValues(world, ColorBy::Multiplier)[0], 0) << backend;
    EXPECT_GT(bodyValues(world, ColorBy::Stiffness)[1], 0) << backend;
    EXPECT_NE(bodyValues(world, ColorBy::Color)[0], bodyValues(world, ColorBy::Color)[1]) << backend;
  }
}

}  // namespace
}  // namespace rubble::io

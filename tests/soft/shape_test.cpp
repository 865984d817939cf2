/// Vertices and granular particles on rigid shapes of every kind.
#include <gtest/gtest.h>
#include <rubble/error.h>

#include "tests/soft/soft_scenes.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using namespace test;

ParticlesDef particles(const std::vector<Vec3>& at, double radius = .05) {
  ParticlesDef def;
  def.vertices = at;
  def.radius = radius;
  return def;
}

TEST(VertexShapes, ParticlesLieOnEveryGround) {
  for (const std::string& kind : groundKinds()) {
    std::vector<Vec3> at;
    for (int i = 0; i < 30; ++i) at.push_back({.131 * i - 2, .077 * i - 1, .1 + .003 * i});
    Scene scene = sceneWith(particles(at));
    scene.bodies.push_back(groundOf(kind));
    World world(scene, options(4));
    run(world, 90);
    for (const Vec3& x : world.positions(world.deformableAt(0))) EXPECT_NEAR(x.z, .05, 5e-4) << kind;
  }
}

/// Solids that hold a sheet which falls on them: the height of their top.
struct Stand {
  std::string name;
  Shape shape;
  double top;
};
std::vector<Stand> stands() {
  constexpr int kCount = 21;
  std::vector<double> distances;
  for (int k = 0; k < kCount; ++k)
    for (int j = 0; j < kCount; ++j)
      for (int i = 0; i < kCount; ++i)
        distances.push_back(.05 * length(Vec3{i - 10., j - 10., k - 10.}) - .4);
  std::vector<Stand> out = {
      {"ball", Shape::sphere(.4), .4},
      {"field", Shape::distanceField({kCount, kCount, kCount}, {-.5, -.5, -.5}, .05, distances), .4}};
  for (const Standing& s : standingShapes())
    if (s.top > 0) out.push_back({s.name, s.shape, s.top});
  return out;
}

TEST(VertexShapes, HoldASheetThatFallsOnThem) {
  for (const Stand& stand : stands()) {
    ClothDef cloth = clothSheet({-.6, -.6, stand.top + .1}, {1.2, 0, 0}, {0, 1.2, 0}, 24, 24);
    cloth.thickness = .01, cloth.youngsModulus = 1e6;
    Scene scene = sceneWith(cloth);
    BodyDef def = body(stand.shape, {0, 0, 0});
    def.motion = Motion::Static;
    scene.bodies.push_back(def);
    World world(scene, options(6));
    run(world, 90);
    const std::vector<Vec3> x = world.positions(world.deformableAt(0));
    // the middle is over the top (what hangs down around a flat top bends it up), the corners hang beside it
    EXPECT_GT(x[12 + 12 * 25].z, stand.top + .004) << stand.name;
    EXPECT_LT(x[12 + 12 * 25].z, stand.top + .04) << stand.name;
    for (const std::size_t corner : {0u, 24u, 600u, 624u})
      EXPECT_LT(x[corner].z, stand.top - .1) << stand.name;
    const std::vector<VertexContact> contacts = world.vertexContacts();
    EXPECT_GT(contacts.size(), 10u) << stand.name;
    for (const VertexContact& c : contacts) EXPECT_LT(c.depth, 4e-3) << stand.name;
  }
}

TEST(VertexShapes, ParticlesStayInABowlOfTriangles) {
  // a paraboloid z = r^2, whose cells are 0.1 m wide
  constexpr int kCount = 21;
  std::vector<double> heights;
  for (int j = 0; j < kCount; ++j)
    for (int i = 0; i < kCount; ++i) heights.push_back(.01 * ((i - 10) * (i - 10) + (j - 10) * (j - 10)));
  std::vector<Vec3> at;
  for (int k = 0; k < 3; ++k)
    for (int j = -3; j <= 3; ++j)
      for (int i = -3; i <= 3; ++i) at.push_back({.11 * i + .01 * k, .11 * j, .6 + .11 * k});
  Scene scene = sceneWith(particles(at));
  BodyDef bowl = body(Shape::heightField(kCount, kCount, {.1, .1, 0}, heights), {-1, -1, 0});
  bowl.motion = Motion::Static;
  scene.bodies.push_back(bowl);
  World world(scene, options(4));
  run(world, 240);
  for (const Vec3& x : world.positions(world.deformableAt(0))) {
    // triangles lie up to 0.1^2 / 4 over the paraboloid, and touch a ball beside its lowest point
    EXPECT_GT(x.z, x.x * x.x + x.y * x.y + .045);
    EXPECT_LT(x.z, .75);
  }
}

TEST(VertexShapes, AttachmentsHoldToTheAuthorsFrameOfABody) {
  // its center of mass and principal axes lie elsewhere than its frame
  Scene scene = sceneWith(particles({{1.2, .3, 1.1}}));
  const Shape odd = Shape::compound(
      {{Shape::box({.5, .1, .1}), {.5, 0, 0}, {}}, {Shape::box({.1, .3, .1}), {1, .3, .1}, {}}});
  BodyDef def = body(odd, {0, 0, 1});
  def.motion = Motion::Static;
  def.orientation = fromAxisAngle(Vec3{0, 0, 1}, .3);
  scene.bodies.push_back(def);
  AttachmentDef held;
  held.vertices = {0}, held.body = 0;
  held.anchor = Vec3{1, .2, .4};
  scene.attachments.push_back(held);
  World world(scene, options(10));
  run(world, 120);
  const Vec3 expected = def.position + rotate(def.orientation, *held.anchor);
  EXPECT_LT(length(world.positions(world.deformableAt(0))[0] - expected), 1e-3);
  EXPECT_LT(world.state(world.attachments()[0]).gap, 1e-3);
}

TEST(VertexShapes, ConveyorsCarryParticles) {
  Scene scene = sceneWith(particles({{0, 0, .05}}));
  scene.bodies.push_back(ground());
  scene.bodies[0].material.surfaceVelocity = {.5, 0, 0};
  World world(scene, options(4));
  run(world, 120);
  const double before = world.positions(world.deformableAt(0))[0].x;
  run(world, 60);
  EXPECT_NEAR(world.velocities(world.deformableAt(0))[0].x, .5, 1e-3);
  EXPECT_NEAR(world.positions(world.deformableAt(0))[0].x - before, .5 * 60 * world.params().dt, 2e-3);
}

TEST(VertexShapes, FrictionFollowsTheRuleOfTheMaterials) {
  // the smaller coefficient 0.2 instead of the mean 0.4: on a slope of 0.3 particles slide with g (sin - mu
  // cos)
  constexpr double kSlope = .3;
  for (const bool minimum : {false, true}) {
    ParticlesDef def = particles({{0, 0, .05}});
    def.material.staticFriction = def.material.dynamicFriction = .2;
    if (minimum) def.material.frictionCombine = Combine::Minimum;
    Scene scene = sceneWith(def, {10 * std::sin(kSlope), 0, -10 * std::cos(kSlope)});
    scene.bodies.push_back(ground(.8));
    World world(scene, options(4));
    run(world, 60);
    const double t = 60 * world.params().dt, mu = minimum ? .2 : .4;
    const double expected = std::max(0., 10 * (std::sin(kSlope) - mu * std::cos(kSlope)) * t);
    EXPECT_NEAR(world.velocities(world.deformableAt(0))[0].x, expected, .01);
  }
}

TEST(VertexShapes, RollingFrictionOfVerticesIsRefused) {
  ParticlesDef def = particles({{0, 0, .05}});
  def.material.rollingFriction = .01;
  EXPECT_THROW(validate(Deformable{def}, "deformables[0]"), Error);
}

}  // namespace
}  // namespace rubble

/// Living bodies change, and keep what physics lets them keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "no_exceptions.h"
#include "tests/support/scenes.h"
#include "tests/support/shapes.h"

namespace rubble {
namespace {

using test::hashes;
using test::options;

/// A body alone, without gravity.
BodyId alone(World& world, const Shape& shape) {
  BodyDef def = test::body(shape, {1, 2, 3});
  def.orientation = normalize(Quat{1, {.3, -.2, .5}});
  return world.addBody(def);
}

TEST(BodyChange, ToItsOwnDefinitionKeepsEveryBit) {
  for (const char* backend : {"cpu", "reference"}) {
    World world(test::heap(2), options(4, backend));
    test::run(world, 40);
    world.applyForce(world.bodyAt(5), {3, 0, 40});
    const Snapshot start = world.snapshot();
    const auto untouched = hashes(world, 12);
    world.restore(start);
    const auto redefined = hashes(world, 12, [&] {
      for (const BodyId id : world.bodies()) world.setDefinition(id, world.definition(id));
    });
    EXPECT_EQ(redefined, untouched) << backend;
  }
}

TEST(BodyChange, OfMassShowsInTheLoadBelow) {
  World world(test::tower(3), options());
  test::run(world, 60);
  world.setMass(world.bodyAt(3), 4);
  EXPECT_EQ(world.massOf(world.bodyAt(3)).mass, 4);
  test::run(world, 60);
  EXPECT_NEAR(world.contactLoad(world.bodyAt(0)).force.z, -60, .6);
  EXPECT_NEAR(world.state(world.bodyAt(3)).position.z, 2.5, 2e-3);
}

TEST(BodyChange, OfMotionHoldsAndLetsFall) {
  World world(test::tower(3), options());
  test::run(world, 30);
  const BodyId middle = world.bodyAt(2), top = world.bodyAt(3);
  world.setMotion(middle, Motion::Static);
  world.removeBody(world.bodyAt(1));
  test::run(world, 60);
  EXPECT_NEAR(world.state(middle).position.z, 1.5, 1e-3);
  EXPECT_NEAR(world.state(top).position.z, 2.5, 2e-3);
  world.setMotion(middle, Motion::Dynamic);
  test::run(world, 120);
  EXPECT_NEAR(world.state(middle).position.z, .5, 2e-3);
  EXPECT_NEAR(world.state(top).position.z, 1.5, 2e-3);
}

TEST(BodyChange, ToStaticStopsAndToKinematicGoesOn) {
  World world(test::emptyScene({}), options());
  const BodyId id = alone(world, Shape::box({.5, .2, .3}));
  world.setVelocity(id, {1, 2, 3}, {.1, .2, .3});
  world.setMotion(id, Motion::Kinematic);
  test::run(world, 60);
  EXPECT_NEAR(world.state(id).position.y, 4, 1e-4);
  world.setMotion(id, Motion::Static);
  EXPECT_EQ(world.state(id).velocity, Vec3{});
  EXPECT_EQ(world.state(id).angularVelocity, Vec3{});
}

TEST(BodyChange, OfTheShapeMovesItOnAsOneRigidBody) {
  // the center of mass of the second shape is elsewhere: its velocity is that of the point of the body there
  const Shape offset = Shape::compound(
      {{Shape::box({.2, .2, .2}), {1, 0, 0}, {}}, {Shape::sphere(.1), {}, {}}});
  World world(test::emptyScene({}), options());
  const BodyId id = alone(world, Shape::box({.5, .2, .3}));
  world.setVelocity(id, {1, 0, 0}, {0, 0, 2});
  const BodyState before = world.state(id);
  world.setShape(id, offset);
  const BodyState after = world.state(id);
  const Vec3 shift = rotate(before.orientation, world.massOf(id).center);
  EXPECT_GT(length(shift), .5);
  EXPECT_LT(length(after.position - before.position), 1e-6);
  EXPECT_LT(length(after.velocity - before.velocity - cross(before.angularVelocity, shift)), 1e-6);
  EXPECT_LT(length(after.angularVelocity - before.angularVelocity), 1e-6);
}

TEST(BodyChange, OfTheShapeLeavesJointsAtTheirAnchors) {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.joints.push_back(test::ball(0, {0, 0, .5}, kWorld, {0, 0, .5}));
  World world(scene, options());
  test::run(world, 30);
  world.setShape(world.bodyAt(0), Shape::compound({{Shape::box({.2, .2, .2}), {0, 0, -.6}, {}}}));
  test::run(world, 60);
  EXPECT_LT(world.state(world.joints()[0]).gap, 1e-3);
  EXPECT_NEAR(world.state(world.bodyAt(0)).position.z, 0, 2e-3);
  EXPECT_NEAR(world.state(world.joints()[0]).force.z, -10, .2);
}

TEST(BodyChange, OfTheGroundFromPlaneToBoxAndBackCarriesOn) {
  World world(test::tower(2), options());
  test::run(world, 30);
  for (const Shape& shape : {Shape::box({3, 3, .01}), Shape::plane()}) {
    world.setShape(world.bodyAt(0), shape);
    test::run(world, 60);
    EXPECT_NEAR(world.state(world.bodyAt(2)).position.z, 1.5 + (shape.type == ShapeType::Box ? .01 : 0),
                5e-3);
  }
}

TEST(BodyChange, OfFilterOrSensorLetsABodyFallThrough) {
  for (const bool sensor : {false, true}) {
    World world(test::tower(1), options());
    test::run(world, 30);
    const BodyId id = world.bodyAt(1);
    CollisionFilter none;
    none.mask = 0;
    sensor ? world.setSensor(id, true) : world.setFilter(id, none);
    test::run(world, 30);
    EXPECT_LT(world.state(id).position.z, -.3);
  }
}

TEST(BodyChange, OfFrictionLetsABlockSlide) {
  Scene scene = test::tower(1);
  scene.gravity = {3, 0, -10};
  World world(scene, options());
  test::run(world, 60);
  EXPECT_LT(std::fabs(world.state(world.bodyAt(1)).velocity.x), 1e-3);
  Material ice;
  ice.staticFriction = ice.dynamicFriction = 0;
  world.setMaterial(world.bodyAt(1), ice);
  test::run(world, 60);
  EXPECT_NEAR(world.state(world.bodyAt(1)).velocity.x, 3, .01);
}

TEST(BodyChange, OfDampingGravityAndLocksFollowsTheirLaws) {
  World world(test::emptyScene(), options());
  const BodyId id = alone(world, Shape::box({.5, .2, .3}));
  world.setGravityScale(id, 0);
  world.setDamping(id, 2, 3);
  world.setVelocity(id, {1, 0, 0}, {});
  test::run(world, 60);
  EXPECT_NEAR(world.state(id).velocity.x, std::exp(-2), 1e-3);
  EXPECT_EQ(world.state(id).velocity.z, 0);
  world.setGravityScale(id, 1);
  world.setLocks(id, {false, false, true}, {true, true, true});
  world.setVelocity(id, {1, 0, 0}, {0, 1, 0});
  const double height = world.state(id).position.z;
  test::run(world, 30);
  EXPECT_EQ(world.state(id).position.z, height);
  EXPECT_EQ(world.state(id).angularVelocity, Vec3{});
}

TEST(BodyChange, RefusesWhatItCannotBeAndChangesNothing) {
  World world(test::tower(2), options());
  test::run(world, 10);
  const std::uint64_t hash = world.hash();
  const BodyId id = world.bodyAt(1);
  EXPECT_THROW(world.setMass(id, -1), Error);
  EXPECT_THROW(world.setShape(id, Shape::plane()), Error);
  EXPECT_THROW(world.setMotion(world.bodyAt(0), Motion::Dynamic), Error);
  BodyDef renamed = world.definition(id);
  renamed.name = "another";
  EXPECT_THROW(world.setDefinition(id, renamed), Error);
  EXPECT_EQ(world.hash(), hash);
  EXPECT_FALSE(world.definition(id).mass.value_or(0) < 0);
}

TEST(Impulse, AtAPointGivesItsMomentumAndAngularMomentum) {
  for (const test::Standing& each : test::standingShapes()) {
    World world(test::emptyScene({}), options(4, "reference"));
    const BodyId id = alone(world, each.shape);
    const Vec3 impulse{3, -1, 2}, arm{.2, .4, -.1}, twist{.5, .2, -.3};
    const MassProperties mass = world.massOf(id);
    const BodyState at = world.state(id);
    world.applyImpulseAt(id, impulse, at.position + rotate(at.orientation, mass.center) + arm);
    world.applyAngularImpulse(id, twist);
    const BodyState after = world.state(id);
    const Quat axes = at.orientation * mass.axes;
    const Vec3 momentum = after.velocity * mass.mass,
               spin = rotate(axes, mul(mass.inertia, rotateInverse(axes, after.angularVelocity)));
    EXPECT_LT(length(momentum - impulse), 1e-6) << each.name;
    EXPECT_LT(length(spin - cross(arm, impulse) - twist), 1e-6) << each.name;
  }
}

TEST(UserData, ComesBackInEventsAndHits) {
  Scene scene = test::tower(1);
  scene.bodies[0].userData = 7;
  scene.bodies[1].userData = ~std::uint64_t{0};
  scene.bodies.push_back(test::unitCube({5, 0, 5}));
  scene.joints.push_back(test::ball(2, {0, 0, .5}, kWorld, {5, 0, 5.5}));
  scene.joints[0].breakForce = 1;
  scene.joints[0].userData = 99;
  WorldOptions withEvents = options();
  withEvents.events = true;
  World world(scene, withEvents);
  std::uint64_t joint = 0;
  for (int i = 0; i < 3; ++i) {
    world.step();
    for (const JointEvent& event : world.events().joints) joint = event.userData;
  }
  EXPECT_EQ(joint, 99u);
  ASSERT_FALSE(world.events().contacts.empty());
  EXPECT_EQ(world.events().contacts[0].userDataA, 7u);
  EXPECT_EQ(world.events().contacts[0].userDataB, ~std::uint64_t{0});
  EXPECT_EQ(world.castRay({{0, 0, 9}, {0, 0, -1}, 100, {}}).userData, ~std::uint64_t{0});
  world.setUserData(world.bodyAt(1), 5);
  EXPECT_EQ(world.castRay({{0, 0, 9}, {0, 0, -1}, 100, {}}).userData, 5u);
  world.removeBody(world.bodyAt(1));
  world.step();
  ASSERT_EQ(world.events().contacts.size(), 1u);
  EXPECT_EQ(world.events().contacts[0].phase, Phase::End);
}

TEST(Hits, NameThePartOfACompoundAndItsMaterial) {
  std::vector<ShapePartDef> parts;
  for (int k = 0; k < 7; ++k) {
    parts.push_back({Shape::sphere(.3), {double((3 * k) % 7), 0, .1 * k}, {}});
    if (k % 2) parts.back().material.emplace().restitution = .1 * k;
  }
  World world(test::emptyScene({}), options());
  const BodyId id = world.addBody(test::body(Shape::compound(parts), {0, 1, 0}));
  for (int k = 0; k < 7; ++k) {
    const Vec3 above = parts[std::size_t(k)].position + Vec3{0, 1, 4};
    EXPECT_EQ(world.castRay({above, {0, 0, -1}, 100, {}}).part, k);
    EXPECT_EQ(
        world.castShapes(std::vector<CastQuery>{{Shape::sphere(.1), above, {}, {0, 0, -9}, {}}})[0].part, k);
    const Vec3 near = above - Vec3{0, 0, 3.6};
    EXPECT_EQ(world.closestPoints(std::vector<ClosestQuery>{{near, 100, {}}})[0].part, k);
    EXPECT_EQ(world.materialOf(id, k).restitution, k % 2 ? .1 * k : 0);
  }
  EXPECT_THROW(world.materialOf(id, 7), Error);
}

TEST(Hits, NameTheTriangleOfAMeshAndOfAHeightField) {
  constexpr int kCells = 9;
  std::vector<Vec3> points;
  std::vector<double> heights;
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x) {
      points.push_back({double(x), double(y), .1 * ((x * 7 + y * 5) % 4)});
      heights.push_back(points.back().z);
    }
  std::vector<std::array<int, 3>> triangles;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const int corner = cell / kCells * (kCells + 1) + cell % kCells;
    triangles.push_back({corner, corner + 1, corner + kCells + 2});
    triangles.push_back({corner, corner + kCells + 2, corner + kCells + 1});
  }
  BodyDef def = test::body(Shape::heightField(kCells + 1, kCells + 1, {1, 1, 0}, heights), {});
  def.motion = Motion::Static;
  World world(test::emptyScene(), options());
  const BodyId ground = world.addBody(def);
  const auto triangleBelow = [&](std::size_t t) {
    Vec3 middle;
    for (const int v : triangles[t]) middle += points[std::size_t(v)] / 3;
    return world.castRay({middle + Vec3{0, 0, 5}, {0, 0, -1}, 100, {}}).triangle;
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) EXPECT_EQ(triangleBelow(t), int(t));
  // in an order of their own
  std::ranges::sort(triangles, {}, [](const auto& t) { return (t[0] * 31 + t[1] * 17) % 101; });
  world.setShape(ground, Shape::mesh(points, triangles));
  for (std::size_t t = 0; t < triangles.size(); ++t) EXPECT_EQ(triangleBelow(t), int(t));
}

TEST(JointsOf, AndContactsOfABodyAreItsOwn) {
  World world(test::heap(2), options());
  test::run(world, 60);
  std::size_t contacts = 0, joints = 0;
  for (const BodyId id : world.bodies()) {
    for (const ContactPoint& p : world.contactsOf(id)) EXPECT_TRUE(p.a == id || p.b == id);
    for (const JointId joint : world.jointsOf(id))
      EXPECT_TRUE(world.bodiesOf(joint)[0] == id || world.bodiesOf(joint)[1] == id);
    contacts += world.contactsOf(id).size(), joints += world.jointsOf(id).size();
  }
  EXPECT_EQ(contacts, 2 * world.contacts().size());
  EXPECT_EQ(joints, 2 * world.joints().size());
}

/// A world with everything that a snapshot has to hold.
Scene sceneOfAll() {
  Scene scene = test::heap(2);
  scene.bodies[3].name = "named";
  scene.bodies[4].userData = 1234567890123456789u;
  scene.bodies[5].material.rollingFriction = .01;
  const Shape hull = Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  for (int k = 0; k < 2; ++k) scene.bodies.push_back(test::body(hull, {5. + 2 * k, 0, 1}));
  scene.bodies.push_back(
      test::body(Shape::compound({{hull, {}, {}}, {Shape::sphere(.2), {1, 0, 0}, {}}}), {9, 0, 2}));
  const int last = static_cast<int>(scene.bodies.size()) - 1;
  JointDef hinge = jointAt(scene, JointType::Hinge, last, kWorld, {9, 0, 2});
  hinge.axes[0].armature = 0.1, hinge.axes[0].damping = 0.2, hinge.axes[0].motorForce = 3;
  JointDef tendon;
  tendon.type = jointType("tendon"), tendon.bodyA = last - 1, tendon.bodyB = last - 2;
  tendon.own = TendonFields{{0, 0, 0, 0, 1, 1, 0, 0, 0, 0}, {}, {0, 0, .5, 0, 0, 0, 0, 0, .1, 1, 0, 0, 1}};
  tendon.axes[0].max = 1.5;
  scene.joints = {hinge, jointAt(scene, JointType::SwingTwist, 3, 4, {0, 0, 3}), tendon};
  scene.deformables.emplace_back(clothSheet({-4, 0, 1}, {1, 0, 0}, {0, 1, 0}, 3, 3));
  scene.deformables.emplace_back(tetBox({-4, 4, .5}, {1, 1, 1}, {2, 2, 2}));
  AttachmentDef tie;
  tie.object = 0, tie.vertices = {0};
  scene.attachments.push_back(tie);
  scene.exclusions.emplace_back(1, 2);
  return scene;
}

TEST(SnapshotBytes, ContinueBitForBitInAnotherWorld) {
  for (const char* backend : {"cpu", "reference"}) {
    WorldOptions own = options(4, backend);
    own.events = own.params.sleeping = true;
    World world(sceneOfAll(), own);
    test::run(world, 30);
    world.removeBody(world.bodyAt(7));
    const std::vector<std::byte> bytes = world.snapshot().bytes();
    const auto onward = hashes(world, 20);
    World other(test::tower(1), options(9, backend));
    other.restore(Snapshot::fromBytes(bytes));
    EXPECT_EQ(other.params(), own.params);
    EXPECT_EQ(hashes(other, 20), onward) << backend;
    EXPECT_EQ(other.definition(other.findBody("named")).name, "named");
    EXPECT_EQ(other.userData(other.bodyAt(4)), 1234567890123456789u);
    const auto turn = [](World& w) { w.setMotorForce(w.joints()[0], 0, -2); };
    turn(other), turn(world);
    EXPECT_EQ(other.definition(other.joints()[0]).axes[0].armature, 0.1);
    // ids go on as well
    EXPECT_EQ(other.addBody(test::unitCube({0, 0, 20})), world.addBody(test::unitCube({0, 0, 20})));
    EXPECT_EQ(hashes(other, 3), hashes(world, 3));
  }
}

std::string refusalOf(const std::vector<std::byte>& bytes) {
  try {
    Snapshot::fromBytes(bytes);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(SnapshotBytes, OfAnotherVersionOrDamagedAreRefused) {
  World world(test::heap(1), options());
  test::run(world, 10);
  const std::vector<std::byte> bytes = world.snapshot().bytes();
  EXPECT_EQ(refusalOf(bytes), "");
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t version = text.find(RUBBLE_VERSION_TEXT);
  ASSERT_NE(version, std::string::npos);
  std::vector<std::byte> other = bytes;
  other[version] = std::byte('9');
  EXPECT_NE(refusalOf(other).find("got one of Rubble 9"), std::string::npos) << refusalOf(other);
  // no flipped byte and no shortened file is taken, wherever the damage is
  for (std::size_t at = 0; at < bytes.size(); at += 1 + bytes.size() / 97) {
    other = bytes;
    other[at] ^= std::byte{16};
    EXPECT_NE(refusalOf(other), "") << at;
    EXPECT_NE(refusalOf({bytes.begin(), bytes.begin() + std::ptrdiff_t(at)}), "") << at;
  }
}

TEST(DebugDraw, EnclosesTheVolumeOfEachShape) {
  for (const test::Standing& each : test::standingShapes()) {
    World world(test::emptyScene({}), options());
    const BodyId id = alone(world, each.shape);
    DebugDrawOptions fine;
    fine.segments = 64;
    double volume = 0;
    for (const DebugDraw::Triangle& t : debugDraw(world, fine).triangles)
      volume += dot(t.corner[0] - Vec3{1, 2, 3},
                    cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0])) /
                6;
    // parts of the compound overlap
    const double wanted = world.massOf(id).mass / 1000;
    EXPECT_NEAR(volume, wanted, (each.name == "compound" ? .2 : .01) * wanted) << each.name;
  }
}

TEST(DebugDraw, ShowsContactsJointsNamesAndBounds) {
  World world(sceneOfAll(), options());
  test::run(world, 40);
  DebugDrawOptions lines;
  lines.surfaces = false;
  lines.contacts = lines.joints = lines.bounds = lines.names = true;
  const DebugDraw drawn = debugDraw(world, lines);
  EXPECT_TRUE(drawn.triangles.empty());
  std::size_t ends = 0;
  for (const JointId id : world.joints()) {
    const auto [a, b] = world.bodiesOf(id);
    ends += (a.index >= 0) + (b.index >= 0);
  }
  EXPECT_EQ(drawn.lines.size(),
            world.contacts().size() + world.joints().size() + ends + 12 * world.bodies().size());
  ASSERT_EQ(drawn.texts.size(), 1u);
  EXPECT_EQ(drawn.texts[0].text, "named");
}

TEST(WithoutExceptions, ErrorsAreResults) {
  EXPECT_EQ(test::withoutExceptions(),
            "bodies[0].mass: expected a number above 0 and of at most 1e+18 in size, got -1; 3 bodies; body: "
            "expected an id "
            "that is alive, got id 9 of generation 0, which is not alive");
}

}  // namespace
}  // namespace rubble

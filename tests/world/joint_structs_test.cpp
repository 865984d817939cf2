/// Joint definitions by type: each has what its type reads, and makes the joint that a JointDef makes.
#include <gtest/gtest.h>

#include <utility>

#include "tests/support/scenes.h"
#include "world/joint_build.h"

namespace rubble {
namespace {

/// What a definition has beside the fields of its type: name, two bodies, collide and userData.
constexpr int kOthers = 5;

/// Any value, and none that is usual.
struct Filler {
  template <class T> operator T() const {
    if constexpr (requires(T t) { t.x; }) return T{0.25, 0.5, 0.75};
    if constexpr (requires(T t) { t.s; }) return T{0, 1, 0, 0};
    if constexpr (std::is_arithmetic_v<T>) return T(3);
    if constexpr (std::is_same_v<T, std::string>) return "filled";
    if constexpr (std::is_same_v<T, std::vector<double>>) return {1, 2, 3};
    if constexpr (std::is_same_v<T, JointAxis>) return {.min = -3};
    T filled{};
    if constexpr (requires(T t) { t.front().min; }) filled.fill({.min = -3});
    return filled;
  }
};

template <class J, std::size_t... I> constexpr bool takes(std::index_sequence<I...>) {
  return requires { J{(void(I), Filler{})...}; };
}
template <class J, std::size_t... I> J filledOf(std::index_sequence<I...>) {
  return {(void(I), Filler{})...};
}
/// Number of members.
template <class J, std::size_t N = 1> constexpr std::size_t memberCount() {
  if constexpr (takes<J>(std::make_index_sequence<N + 1>{})) return memberCount<J, N + 1>();
  return N;
}

template <class T> bool same(const T& a, const T& b) { return a == b; }

template <class J> void expectTheFieldsOf(const char* name) {
  SCOPED_TRACE(name);
  const JointKind& kind = kindOf(jointType(name));
  JointDef usual;
  usual.type = kind.type;
  const JointDef plain = J{}, filled = filledOf<J>(std::make_index_sequence<memberCount<J>()>{});
  EXPECT_EQ(plain.type, kind.type);
  EXPECT_EQ(filled.type, kind.type);
  EXPECT_EQ(filled.name, "filled");
  EXPECT_EQ(filled.bodyA, 3);
  EXPECT_EQ(filled.bodyB, 3);
  EXPECT_EQ(filled.frameBodyA, kind.hasFrameBodies ? 3 : kWorld);
  EXPECT_EQ(filled.frameBodyB, kind.hasFrameBodies ? 3 : kWorld);
  EXPECT_TRUE(filled.collide);
  EXPECT_EQ(filled.userData, 3u);
  EXPECT_EQ(memberCount<J>(),
            kind.fields.size() + (kind.axes > 0 ? 1 : 0) + (kind.hasFrameBodies ? 2 : 0) + kOthers);
  const auto expect = [&](const JointField& field, bool isOwn) {
    field.visit(plain, usual, [&](const auto& a, const auto& b) { EXPECT_TRUE(same(a, b)) << field.key; });
    field.visit(filled, usual,
                [&](const auto& a, const auto& b) { EXPECT_EQ(!same(a, b), isOwn) << field.key; });
  };
  for (const JointField& field : sharedJointFields()) expect(field, kind.has(field.key));
  for (const JointField& field : kind.ownFields) expect(field, true);
  for (std::size_t i = 0; i < filled.axes.size(); ++i) {
    EXPECT_EQ(filled.axes[i].min, i < static_cast<std::size_t>(kind.axes) ? -3 : -kFree);
    EXPECT_EQ(plain.axes[i].min, -kFree);
  }
}

TEST(JointStructs, HaveTheFieldsThatTheirTypesReadWithTheDefaultsOfJointDef) {
  std::size_t types = 0;
  const auto check = [&]<class J>(const char* name) { expectTheFieldsOf<J>(name), ++types; };
  check.operator()<BallJoint>("ball");
  check.operator()<DragJoint>("drag");
  check.operator()<FixedJoint>("fixed");
  check.operator()<AngularSpringJoint>("angular_spring");
  check.operator()<HingeJoint>("hinge");
  check.operator()<SliderJoint>("slider");
  check.operator()<DistanceJoint>("distance");
  check.operator()<RopeJoint>("rope");
  check.operator()<SpringJoint>("spring");
  check.operator()<UniversalJoint>("universal");
  check.operator()<SwingTwistJoint>("swing_twist");
  check.operator()<SixDofJoint>("six_dof");
  check.operator()<GearJoint>("gear");
  check.operator()<RackJoint>("rack");
  check.operator()<PulleyJoint>("pulley");
  check.operator()<TendonJoint>("tendon");
  check.operator()<GimbalJoint>("gimbal");
  EXPECT_EQ(types, jointKinds().size());
}

Scene twoCubes() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::unitCube({0, 0, 0}));
  scene.bodies.push_back(test::unitCube({1.5, 0, 0}));
  return scene;
}
std::uint64_t hashAfter(World& world) {
  for (int step = 0; step < 30; ++step) world.step();
  return world.hash();
}

TEST(JointStructs, MakeTheWorldThatJointDefMakes) {
  const Vec3 point{0.75, 0, 0};
  const Quat axis = frameAlong({0, 1, 0});
  Scene plain = twoCubes();
  JointDef hinge = jointAt(plain, JointType::Hinge, 1, 0, point, axis);
  hinge.axes[0].max = 0.5, hinge.axes[0].friction = 2, hinge.breakForce = 500;
  plain.joints = {hinge, test::ball(0, {-0.5, 0, 0}, kWorld, {-0.5, 0, 0})};

  Scene named = twoCubes();
  named.joints = {
      jointAt(named,
              HingeJoint{.bodyA = 1, .bodyB = 0, .breakForce = 500, .axis = {.max = 0.5, .friction = 2}},
              point, axis),
      BallJoint{.bodyA = 0, .anchorA = {-0.5, 0, 0}, .anchorB = {-0.5, 0, 0}}};
  World one(plain), other(named), grown(twoCubes());
  const BodyId a = grown.bodyAt(0), b = grown.bodyAt(1);
  grown.addJoint(
      jointAt(grown, HingeJoint{.breakForce = 500, .axis = {.max = 0.5, .friction = 2}}, b, a, point, axis),
      b, a);
  grown.addJoint(BallJoint{.anchorA = {-0.5, 0, 0}, .anchorB = {-0.5, 0, 0}}, a, {});
  const std::uint64_t wanted = hashAfter(one);
  EXPECT_EQ(hashAfter(other), wanted);
  EXPECT_EQ(hashAfter(grown), wanted);
  World free(twoCubes());
  EXPECT_NE(hashAfter(free), wanted);
}

TEST(JointStructs, CarryTheFieldsOfTheirOwn) {
  const JointDef tendon = TendonJoint{.path = {0, 0, 0, 0, 1, 1, 0, 0, 0, 0}, .axis = {.motorForce = -3}};
  EXPECT_EQ(std::any_cast<TendonFields>(tendon.own).path.size(), 10u);
  EXPECT_EQ(tendon.axes[0].motorForce, -3);
  const JointDef gimbal = GimbalJoint{.tiltB = 0.25};
  EXPECT_EQ(std::any_cast<GimbalFields>(gimbal.own).tiltB, 0.25);
}

TEST(JointAt, InAWorldRefusesABodyThatIsNotThere) {
  World world(twoCubes());
  const BodyId gone = world.bodyAt(1);
  world.removeBody(gone);
  EXPECT_THROW(jointAt(world, BallJoint{}, world.bodyAt(0), gone, {}), Error);
}

}  // namespace
}  // namespace rubble

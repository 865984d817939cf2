#include <bit>
#include <filesystem>
#include <tuple>

#include <gtest/gtest.h>

#include "cook/soft_fields.h"
#include "io/scene_json.h"
#include "io/shape_json.h"
#include "scenes/registry.h"

namespace rubble::io {
namespace {

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
void expectSame(double a, double b) { EXPECT_EQ(bits(a), bits(b)); }
void expectSame(const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) expectSame(a[i], b[i]);
}
void expectSame(const Quat& a, const Quat& b) {
  expectSame(a.s, b.s);
  expectSame(a.v, b.v);
}

void expectSame(const BodyDef& a, const BodyDef& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.motion, b.motion);
  EXPECT_EQ(a.shape.type, b.shape.type);
  EXPECT_EQ(shapeJson(a.shape), shapeJson(b.shape));
  EXPECT_EQ(a.material, b.material);
  const bool isBox = a.shape.type == ShapeType::Box,
             isRound = a.shape.type == ShapeType::Sphere || a.shape.type == ShapeType::Capsule;
  if (isBox) expectSame(a.shape.halfExtents, b.shape.halfExtents);
  if (isRound) expectSame(a.shape.radius, b.shape.radius);
  if (a.shape.type == ShapeType::Capsule) expectSame(a.shape.halfLength, b.shape.halfLength);
  expectSame(a.material.staticFriction, b.material.staticFriction);
  expectSame(a.material.dynamicFriction, b.material.dynamicFriction);
  expectSame(a.material.restitution, b.material.restitution);
  ASSERT_EQ(a.mass.has_value(), b.mass.has_value());
  if (a.mass) {
    expectSame(*a.mass, *b.mass);
  } else {
    expectSame(a.density, b.density);
  }
  expectSame(a.position, b.position);
  expectSame(a.orientation, b.orientation);
  expectSame(a.velocity, b.velocity);
  expectSame(a.angularVelocity, b.angularVelocity);
  expectSame(a.gravityScale, b.gravityScale);
}

void expectSame(const JointDef& a, const JointDef& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.bodyA, b.bodyA);
  EXPECT_EQ(a.bodyB, b.bodyB);
  EXPECT_EQ(a.frameBodyA, b.frameBodyA);
  EXPECT_EQ(a.frameBodyB, b.frameBodyB);
  expectSame(a.anchorA, b.anchorA);
  expectSame(a.anchorB, b.anchorB);
  if (a.type == JointType::Fixed) expectSame(a.orientationAtoB, b.orientationAtoB);
  expectSame(a.stiffness, b.stiffness);
  expectSame(a.angularStiffness, b.angularStiffness);
  expectSame(a.breakForce, b.breakForce);
  expectSame(a.breakTorque, b.breakTorque);
  EXPECT_EQ(a.collide, b.collide);
  expectSame(a.frameA, b.frameA);
  expectSame(a.frameB, b.frameB);
  expectSame(a.driveOrientation, b.driveOrientation);
  EXPECT_EQ(a.own.has_value(), b.own.has_value());
  if (const auto* own = std::any_cast<TendonFields>(&a.own)) {
    const auto& other = std::any_cast<const TendonFields&>(b.own);
    EXPECT_EQ(own->path, other.path);
    EXPECT_EQ(own->terms, other.terms);
    EXPECT_EQ(own->wraps, other.wraps);
    EXPECT_EQ(own->tilts, other.tilts);
  }
  if (const auto* own = std::any_cast<GimbalFields>(&a.own)) {
    const auto& other = std::any_cast<const GimbalFields&>(b.own);
    expectSame(own->offsetB, other.offsetB);
    expectSame(own->offsetA, other.offsetA);
    expectSame(own->tiltB, other.tiltB);
    expectSame(own->tiltA, other.tiltA);
  }
  expectSame(a.pulleyA, b.pulleyA);
  expectSame(a.pulleyB, b.pulleyB);
  for (const auto member :
       {&JointDef::damping, &JointDef::dampingRatio, &JointDef::angularDamping,
        &JointDef::angularDampingRatio, &JointDef::maxForce, &JointDef::maxTorque, &JointDef::length,
        &JointDef::ratio, &JointDef::swingY, &JointDef::swingZ, &JointDef::friction,
        &JointDef::driveStiffness, &JointDef::driveDamping, &JointDef::maxDriveTorque})
    expectSame(a.*member, b.*member);
  for (std::size_t i = 0; i < a.axes.size(); ++i)
    for (const auto member :
         {&JointAxis::min, &JointAxis::max, &JointAxis::limitStiffness, &JointAxis::limitDamping,
          &JointAxis::targetPosition, &JointAxis::targetSpeed, &JointAxis::driveStiffness,
          &JointAxis::driveDamping, &JointAxis::maxDriveForce, &JointAxis::friction, &JointAxis::armature,
          &JointAxis::damping, &JointAxis::motorForce})
      expectSame(a.axes[i].*member, b.axes[i].*member);
}

void expectSame(const NetDef::Edge& a, const NetDef::Edge& b) {
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  expectSame(a.stiffness, b.stiffness);
  expectSame(a.damping, b.damping);
  expectSame(a.restLength, b.restLength);
}
template <class T> void expectSame(const T& a, const T& b) { EXPECT_EQ(a, b); }
template <class T> void expectSame(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expectSame(a[i], b[i]);
}

/// Compares each field with the one of the same key of another object.
template <class D> struct SameFields {
  const D& other;
  template <class T> void operator()(const char* key, const char*, const char*, const T& value) const {
    const auto compare = [&](const char* name, const char*, const char*, const auto& theirs) {
      if constexpr (std::is_same_v<decltype(theirs), const T&>)
        if (std::string(key) == name) expectSame(value, theirs);
    };
    if constexpr (std::is_same_v<D, AttachmentDef>)
      attachmentFields(other, compare);
    else
      commonFields(other, compare), ownFields(other, compare);
  }
};

void expectSame(const Deformable& a, const Deformable& b) {
  ASSERT_EQ(a.index(), b.index());
  std::visit(
      [&]<class D>(const D& def) {
        const SameFields<D> same{std::get<D>(b)};
        commonFields(def, same), ownFields(def, same);
      },
      a);
}

void expectRoundTrip(const SceneFile& file) {
  const std::string text = toJson(file);
  std::vector<Fault> faults;
  const SceneFile back = parseScene(text, faults);
  ASSERT_TRUE(faults.empty()) << faults.front().text();
  EXPECT_EQ(back.scene.name, file.scene.name);
  EXPECT_EQ(back.scene.description, file.scene.description);
  expectSame(back.scene.gravity, file.scene.gravity);
  EXPECT_EQ(back.steps, file.steps);
  EXPECT_EQ(back.iterations, file.iterations);
  EXPECT_EQ(back.substeps, file.substeps);
  EXPECT_EQ(back.smashStep, file.smashStep);
  expectSame(back.dt, file.dt);
  ASSERT_EQ(back.scene.bodies.size(), file.scene.bodies.size());
  for (std::size_t i = 0; i < file.scene.bodies.size(); ++i)
    expectSame(back.scene.bodies[i], file.scene.bodies[i]);
  ASSERT_EQ(back.scene.joints.size(), file.scene.joints.size());
  for (std::size_t i = 0; i < file.scene.joints.size(); ++i)
    expectSame(back.scene.joints[i], file.scene.joints[i]);
  ASSERT_EQ(back.scene.deformables.size(), file.scene.deformables.size());
  for (std::size_t i = 0; i < file.scene.deformables.size(); ++i)
    expectSame(back.scene.deformables[i], file.scene.deformables[i]);
  ASSERT_EQ(back.scene.attachments.size(), file.scene.attachments.size());
  for (std::size_t i = 0; i < file.scene.attachments.size(); ++i) {
    const AttachmentDef &a = back.scene.attachments[i], &b = file.scene.attachments[i];
    EXPECT_EQ(a.object, b.object);
    EXPECT_EQ(a.otherObject, b.otherObject);
    EXPECT_EQ(a.body, b.body);
    attachmentFields(a, SameFields<AttachmentDef>{b});
  }
  ASSERT_EQ(back.scene.events.size(), file.scene.events.size());
  for (std::size_t i = 0; i < file.scene.events.size(); ++i) {
    const Event &a = back.scene.events[i], &b = file.scene.events[i];
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.remove, b.remove);
    EXPECT_EQ(a.removeJoints, b.removeJoints);
    ASSERT_EQ(a.add.size(), b.add.size());
    for (std::size_t k = 0; k < a.add.size(); ++k) expectSame(a.add[k], b.add[k]);
    ASSERT_EQ(a.setVelocity.size(), b.setVelocity.size());
    for (std::size_t k = 0; k < a.setVelocity.size(); ++k) {
      EXPECT_EQ(a.setVelocity[k].body, b.setVelocity[k].body);
      expectSame(a.setVelocity[k].velocity, b.setVelocity[k].velocity);
      expectSame(a.setVelocity[k].angularVelocity, b.setVelocity[k].angularVelocity);
    }
  }
  ASSERT_EQ(back.claims.size(), file.claims.size());
  for (std::size_t i = 0; i < file.claims.size(); ++i) {
    EXPECT_EQ(back.claims[i].metric, file.claims[i].metric);
    expectSame(back.claims[i].min, file.claims[i].min);
    expectSame(back.claims[i].max, file.claims[i].max);
    EXPECT_EQ(back.claims[i].why, file.claims[i].why);
  }
  EXPECT_EQ(toJson(back), text);
}

TEST(SceneRoundTrip, EverythingIsExact) {
  SceneFile file;
  Scene& scene = file.scene;
  scene.name = "every \"key\"\n\xc3\xa9";
  scene.description = "Not often seen.";
  scene.gravity = {-0.0, 1. / 3, -9.80665};
  BodyDef ground;
  ground.motion = Motion::Static;
  ground.shape = Shape::plane();
  scene.bodies.push_back(ground);
  BodyDef box;
  box.name = "box";
  box.shape = Shape::box({1. / 3, .1, 1e-9});
  box.material = {.7, .3, .25};
  box.mass = 1e10 / 3;
  box.position = {1e-300, -1. / 7, 12345678.9};
  box.orientation = normalize(Quat{.3, -.4, .5, .6});
  box.velocity = {0, -0.0, 1};
  box.angularVelocity = {.1, .2, .3};
  box.gravityScale = .5;
  scene.bodies.push_back(box);
  BodyDef capsule;
  capsule.shape = Shape::capsule(.1, 1. / 3);
  capsule.density = 1.1;
  capsule.motion = Motion::Kinematic;
  capsule.name = "twice";
  scene.bodies.push_back(capsule);
  JointDef ball;
  ball.bodyA = 1;
  ball.anchorB = {1, 2, 1. / 3};
  ball.stiffness = 1e5;
  ball.breakForce = 12.5;
  ball.collide = true;
  JointDef fixed;
  fixed.name = "weld";
  fixed.type = JointType::Fixed;
  fixed.bodyA = 1;
  fixed.bodyB = 2;
  fixed.orientationAtoB = normalize(Quat{.1, .2, .3, .4});
  fixed.angularStiffness = 3;
  fixed.breakTorque = 4;
  JointDef six;
  six.type = JointType::SixDof;
  six.bodyA = 1;
  six.frameA = normalize(Quat{.4, -.2, .3, .1});
  six.axes[0].min = six.axes[0].max = 0;
  six.axes[2].max = 1. / 3;
  six.axes[2].limitStiffness = 1e4;
  six.axes[4].driveDamping = kHard;
  six.axes[4].targetSpeed = -2;
  six.axes[5].maxDriveForce = 7;
  JointDef pulley;
  pulley.type = JointType::Pulley;
  pulley.bodyA = 1, pulley.bodyB = 2;
  pulley.pulleyA = {1, 2, 1. / 3};
  pulley.ratio = 2;
  pulley.length = 4;
  JointDef shoulder;
  shoulder.type = JointType::SwingTwist;
  shoulder.bodyA = 1;
  shoulder.swingY = .5;
  shoulder.driveOrientation = normalize(Quat{1, .2, 0, 0});
  shoulder.friction = 3;
  shoulder.axes[1].min = -.3;
  JointDef gear;
  gear.type = JointType::Gear;
  gear.bodyA = 1, gear.bodyB = 2;
  gear.frameBodyB = 0;
  gear.frameA = normalize(Quat{.4, -.2, .3, .1});
  gear.ratio = -2.5;
  JointDef tendon;
  tendon.type = jointType("tendon");
  tendon.bodyA = 1, tendon.bodyB = 2, tendon.frameBodyA = 0;
  tendon.own = TendonFields{{0, .1, 1. / 3, 0, 1, 2, 0, 0, 2, 0},
                            {0, 1, 2, 0, 0, 1, 0, .2, 0, 1, .5, 0, -.1},
                            {0, 2, .1, .2, 1. / 3, 0, 1, 0, .05, 1, 0, 0, .3},
                            {.1, -.2}};
  tendon.axes[0].armature = .1, tendon.axes[0].damping = .2, tendon.axes[0].motorForce = -3;
  JointDef hip;
  hip.type = jointType("gimbal");
  hip.bodyA = 1, hip.bodyB = 2;
  hip.own = GimbalFields{{.1, 0, 1. / 3}, {0, -.2, 0}, .4, -.3};
  scene.joints = {ball, fixed, six, pulley, shoulder, gear, tendon, hip};
  BodyDef ball2;
  ball2.name = "ball";
  ball2.shape = Shape::sphere(.1);
  Event event;
  event.step = 7;
  event.add = {ball2};
  event.remove = {"bo*"};
  event.removeJoints = {"weld"};
  event.setVelocity = {{"ball", {1, 2, 3}, {.1, 0, 0}}};
  scene.events = {event};
  file.claims = {{"ball.x_m", 0, 1. / 3, "because"},
                 {"max_speed_m_s", -std::numeric_limits<double>::infinity(), 3, ""}};
  file.camera = FileCamera{{1, 2, 3}, {4, 5, 1. / 3}};
  file.steps = 12;
  file.iterations = 3;
  file.substeps = 2;
  file.smashStep = 7;
  file.dt = 1. / 240;
  expectRoundTrip(file);
}

TEST(SceneRoundTrip, DeformableObjectsAreExact) {
  SceneFile file;
  file.scene.name = "soft";
  BodyDef body;
  body.name = "hook";
  file.scene.bodies = {body};
  TetSolidDef soft = tetBox({.1, -0., 1. / 3}, {1, 1, 1}, {2, 1, 1});
  soft.name = "jelly", soft.viscosity = 1. / 7, soft.poissonRatio = .3, soft.fixed = {0, 2},
  soft.contactRadius = .01;
  soft.yieldStress = 1e4 / 3, soft.hardening = 100. / 7;
  soft.material.staticFriction = soft.material.dynamicFriction = .3,
  soft.material.frictionCombine = Combine::Minimum;
  ClothDef cloth = clothSheet({0, 0, 2}, {1, 0, 0}, {0, 1, 0}, 2, 2);
  cloth.start = cloth.vertices, cloth.start[3].z = 2.1;
  cloth.bendingStiffness = 1e-3, cloth.restFolded = true, cloth.bendingDamping = .1, cloth.tearStretch = 1.5;
  CableDef rod = straightCable({0, 0, 3}, {1, 0, 3}, 4);
  rod.breakForce = 12, rod.velocity = {0, -1, .1}, rod.collide = false;
  NetDef net;
  net.vertices = {{0, 0, 4}, {1, 0, 4}, {1, 1, 4}};
  net.masses = {.1, .2, .3};
  net.edges = {{0, 1, 100}, {1, 2, 200, 3}, {2, 0, 300, 0, .9}};
  net.triangles = {{0, 1, 2}};
  ParticlesDef particles;
  particles.vertices = {{0, 0, 5}};
  particles.gravityScale = .5, particles.collideVertices = true;
  file.scene.deformables = {soft, cloth, rod, net, particles};
  AttachmentDef held;
  held.name = "held", held.object = 1, held.vertices = {0, 1}, held.weights = {.25, .75}, held.body = 0,
  held.anchor = Vec3{0, 0, 1. / 3};
  held.stiffness = 1e4;
  AttachmentDef seam;
  seam.object = 2, seam.vertices = {0}, seam.otherObject = 3, seam.otherVertices = {1}, seam.breakForce = 5;
  file.scene.attachments = {held, seam};
  expectRoundTrip(file);
}

TEST(SceneRoundTrip, ShapesOfOneGeometryKeepWhatDiffers) {
  SceneFile file;
  BodyDef body;
  body.shape = Shape::hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .1);
  for (int k = 0; k < 6; ++k) {
    body.shape.userData = k % 2 ? 0 : 0xfedcba9876543210u;
    body.shape.rounding = k < 4 ? .1 : .2;
    file.scene.bodies.push_back(body);
  }
  expectRoundTrip(file);
  std::vector<Fault> faults;
  const SceneFile back = parseScene(toJson(file), faults);
  EXPECT_EQ(back.scene.bodies[0].shape.geometry, back.scene.bodies[2].shape.geometry) << "shared by name";
}

TEST(SceneRoundTrip, TheRegistryIsExact) {
  for (const scenes::Spec& spec : scenes::registry()) {
    SCOPED_TRACE(spec.name);
    const scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, spec.testArguments));
    SceneFile file;
    file.scene = job.scene;
    file.smashStep = job.smashStep;
    expectRoundTrip(file);
  }
}

TEST(SceneRoundTrip, ExampleFilesAreGood) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RUBBLE_SOURCE_DIR) + "/scenes/files")) {
    const SceneFile file = readScene(entry.path().string());
    EXPECT_FALSE(file.scene.name.empty()) << entry.path();
    EXPECT_FALSE(file.claims.empty()) << entry.path();
    expectRoundTrip(file);
    ++count;
  }
  EXPECT_GE(count, 3);
}

TEST(SceneJson, KeepsNamesOfMaterialsTheirRulesAndSides) {
  // names that collide with those that the writer makes, equal names of different materials, and none
  const std::vector<std::string> names{"ice", "material1", "", "ice", "material3", "a \"b\""};
  SceneFile file;
  for (std::size_t i = 0; i < 2 * names.size(); ++i) {
    BodyDef body;
    body.material.name = names[i % names.size()];
    body.material.staticFriction = body.material.dynamicFriction = 0.1 * double(i) + 0.1;
    if (i % 3 == 0) body.material.oneWay = {0, 1. / 3, double(i)};
    file.scene.bodies.push_back(body);
  }
  for (int given = 0; given < 32; ++given) {
    MaterialPair pair{"ice", "other" + std::to_string(given)};
    std::optional<double>* const fields[] = {&pair.staticFriction, &pair.dynamicFriction, &pair.restitution,
                                             &pair.rollingFriction, &pair.torsionalFriction};
    for (int k = 0; k < 5; ++k)
      if (given >> k & 1) *fields[k] = 1. / (3 + k);
    file.scene.materialPairs.push_back(pair);
  }
  std::vector<Fault> faults;
  const SceneFile read = parseScene(toJson(file), faults);
  ASSERT_TRUE(faults.empty()) << faults.front().message;
  ASSERT_EQ(read.scene.bodies.size(), file.scene.bodies.size());
  for (std::size_t i = 0; i < file.scene.bodies.size(); ++i)
    EXPECT_EQ(read.scene.bodies[i].material, file.scene.bodies[i].material) << i;
  ASSERT_EQ(read.scene.materialPairs.size(), file.scene.materialPairs.size());
  for (std::size_t i = 0; i < file.scene.materialPairs.size(); ++i) {
    const MaterialPair &a = read.scene.materialPairs[i], &b = file.scene.materialPairs[i];
    EXPECT_EQ(std::tie(a.a, a.b, a.staticFriction, a.dynamicFriction, a.restitution, a.rollingFriction,
                       a.torsionalFriction),
              std::tie(b.a, b.b, b.staticFriction, b.dynamicFriction, b.restitution, b.rollingFriction,
                       b.torsionalFriction));
  }
}

TEST(SceneJson, GivesMaterialsTheirKeysAsNames) {
  std::vector<Fault> faults;
  const SceneFile read = parseScene(R"({
    "materials": {"ice": {"friction": 0.1}, "plain": {"name": ""}, "snow": {"name": "ice"}},
    "material_pairs": [{"a": "ice", "b": "ice", "friction": 0.05}],
    "bodies": [{"shape": {"type": "sphere", "radius": 1}, "material": "ice"},
               {"shape": {"type": "sphere", "radius": 1}, "material": "plain"},
               {"shape": {"type": "sphere", "radius": 1}, "material": "snow"}]})",
                                    faults);
  ASSERT_TRUE(faults.empty());
  EXPECT_EQ(read.scene.bodies[0].material.name, "ice");
  EXPECT_EQ(read.scene.bodies[1].material.name, "");
  EXPECT_EQ(read.scene.bodies[2].material.name, "ice");
  EXPECT_EQ(read.scene.materialPairs[0].dynamicFriction, 0.05);
  parseScene(R"({"bodies": [], "material_pairs": [{"a": "ice"}, {"a": "x", "b": "y", "friction": -1}, )"
             R"({"a": "x", "b": 3}]})",
             faults);
  EXPECT_EQ(faults.size(), 3u);
}

}  // namespace
}  // namespace rubble::io

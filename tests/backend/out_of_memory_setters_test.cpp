/// Setters of single fields, batched edits, scripted events and further queries whose allocations fail.
#include <rubble/debug_draw.h>

#include "tests/backend/failing_edits.h"
#include "tests/backend/host_rows.h"

namespace rubble {
namespace {

using test::bodyOf;
using test::FailingCall;
using test::HostRows;
using test::Outcome;

JointDef jointBetween(const char* name, JointType type, int a, int b) {
  JointDef def = test::ball(a, {.5, 0, 0}, b, {-.5, 0, 0});
  def.name = name, def.type = type;
  return def;
}

/// Cubes in a row with joints of many types, rules of materials, a kinematic body and a cable.
Scene sceneOfSetters() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 6; ++i) scene.bodies.push_back(test::unitCube({1.5 * i, 0, .5}));
  scene.bodies[1].material.name = "wood", scene.bodies[2].material.name = "stone";
  scene.bodies.push_back(test::body(Shape::box({.5, .5, .5}), {0, 5, 1}));
  scene.bodies.back().motion = Motion::Kinematic;
  scene.materialPairs.push_back({"wood", "stone", .4, .3});
  scene.joints = {jointBetween("hinge", JointType::Hinge, 1, 2),
                  jointBetween("distance", JointType::Distance, 2, 3),
                  jointBetween("shoulder", JointType::SwingTwist, 3, 4),
                  jointBetween("drag", JointType::Drag, 5, kWorld)};
  scene.joints[0].axes[0].driveStiffness = 10, scene.joints[0].axes[0].driveDamping = 1;
  scene.joints[2].driveStiffness = 10;
  scene.joints[3].stiffness = 100, scene.joints[3].anchorB = {6, 0, 1};
  CableDef cable = straightCable({6, 3, 2}, {7, 3, 2}, 4);
  cable.name = "cable";
  scene.deformables.emplace_back(cable);
  return scene;
}

JointId jointOf(const World& world, const char* name) { return world.findJoint(name); }
DeformableId cableOf(const World& world) { return world.findDeformable("cable"); }
std::array<BodyId, 2> pairOf(const World& world) { return {bodyOf(world, 1), bodyOf(world, 2)}; }

std::vector<FailingCall> setters() {
  return {
      {"setParams",
       [](World& w) {
         Params params = w.params();
         params.iterations = 5;
         w.setParams(params);
       }},
      {"setMaterialPair",
       [](World& w) {
         w.setMaterialPair({"wood", "ice", .1, .1});
       }},
      {"replaceMaterialPair",
       [](World& w) {
         w.setMaterialPair({"stone", "wood", .9, .8, {}, .1});
       }},
      {"removeMaterialPair", [](World& w) { w.removeMaterialPair("wood", "stone"); }},
      {"setDefinitionOfABody",
       [](World& w) {
         static const BodyDef def = [&] {
           BodyDef out = w.definition(bodyOf(w, 3));
           out.shape = test::oddBody().shape, out.material.name = "felt", out.material.torsionalFriction = .1;
           return out;
         }();
         w.setDefinition(bodyOf(w, 3), def);
       }},
      {"setMaterial",
       [](World& w) {
         Material material;
         material.name = "ice", material.dynamicFriction = .05;
         w.setMaterial(bodyOf(w, 1), material);
       }},
      {"setMotion", [](World& w) { w.setMotion(bodyOf(w, 4), Motion::Static); }},
      {"setMass", [](World& w) { w.setMass(bodyOf(w, 4), 7); }},
      {"setFilter",
       [](World& w) {
         w.setFilter(bodyOf(w, 4), {1, 2, 0});
       }},
      {"setDamping", [](World& w) { w.setDamping(bodyOf(w, 4), .1, .2); }},
      {"setGravityScale", [](World& w) { w.setGravityScale(bodyOf(w, 4), .5); }},
      {"setLocks",
       [](World& w) {
         w.setLocks(bodyOf(w, 4), {true, false, false}, {false, true, false});
       }},
      {"setSensor", [](World& w) { w.setSensor(bodyOf(w, 4), true); }},
      {"setUserData",
       [](World& w) {
         w.setUserData(bodyOf(w, 4), 4), w.setUserData(jointOf(w, "hinge"), 5), w.setUserData(cableOf(w), 6);
       }},
      {"setVelocity",
       [](World& w) {
         w.setVelocity(bodyOf(w, 4), {1, 0, 0}, {0, 1, 0});
       }},
      {"setTarget",
       [](World& w) {
         w.setTarget(bodyOf(w, 7), {0, 5, 1.1}, {});
       }},
      {"setStates",
       [](World& w) {
         const std::array ids{bodyOf(w, 1), bodyOf(w, 7), bodyOf(w, 3)};
         const std::array<BodyState, 3> to{BodyState{{0, 0, .6}, {}, {1, 0, 0}, {}},
                                           BodyState{{0, 5, 2}, {}, {}, {}},
                                           BodyState{{3, 0, .7}, {}, {}, {0, 0, 1}}};
         w.setStates(ids, to);
       }},
      {"applyForces",
       [](World& w) {
         const std::array<Vec3, 2> forces{Vec3{1, 0, 0}, Vec3{0, 1, 0}};
         w.applyForces(pairOf(w), forces, forces);
       }},
      {"applyImpulses",
       [](World& w) {
         const std::array<Vec3, 2> impulses{Vec3{1, 0, 0}, Vec3{0, 1, 0}};
         w.applyImpulses(pairOf(w), impulses);
       }},
      {"applyImpulseAt",
       [](World& w) {
         w.applyImpulseAt(bodyOf(w, 4), {0, 0, 5}, {4.7, 0, .5});
       }},
      {"applyTorqueAndAngularImpulse",
       [](World& w) {
         w.applyTorque(bodyOf(w, 4), {0, 0, 5}), w.applyAngularImpulse(bodyOf(w, 4), {0, 0, 1});
       }},
      {"applyVertexForce",
       [](World& w) {
         w.applyVertexForce(cableOf(w), 1, {0, 0, 1});
       }},
      {"scatterVelocities",
       [](World& w) {
         static const HostRows rows({1, 3, 4}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
         w.scatter(StateArray::Velocity, rows.rows(), rows.values());
       }},
      {"scatterForces",
       [](World& w) {
         static const HostRows rows({2}, {3, 2, 1}, 3);
         w.scatter(StateArray::Force, rows.rows(), rows.values());
       }},
      {"scatterTargets",
       [](World& w) {
         static const HostRows rows({0}, {.2}, 1);
         w.scatter(JointArray::TargetPosition, rows.rows(), rows.values());
       }},
      {"scatterForcesOfJoints",
       [](World& w) {
         static const HostRows rows({0}, {2}, 1);
         w.scatter(JointArray::AppliedForce, rows.rows(), rows.values());
       }},
      {"setTargetPosition", [](World& w) { w.setTargetPosition(jointOf(w, "hinge"), 0, .3); }},
      {"setTargetSpeed", [](World& w) { w.setTargetSpeed(jointOf(w, "hinge"), 0, .3); }},
      {"setMotorForce", [](World& w) { w.setMotorForce(jointOf(w, "hinge"), 0, .3); }},
      {"setLimits", [](World& w) { w.setLimits(jointOf(w, "hinge"), 0, -.3, .3); }},
      {"setLength", [](World& w) { w.setLength(jointOf(w, "distance"), .6); }},
      {"setDriveOrientation",
       [](World& w) {
         w.setDriveOrientation(jointOf(w, "shoulder"), normalize(Quat{1, {.1, 0, 0}}));
       }},
      {"setDragTarget",
       [](World& w) {
         w.setDragTarget(jointOf(w, "drag"), {6, 0, 2});
       }},
      {"setDefinitionOfADeformable",
       [](World& w) {
         static const Deformable def = [&] {
           CableDef out = std::get<CableDef>(w.definition(cableOf(w)));
           out.radius *= 1.1, out.material.name = "hemp";
           return out;
         }();
         w.setDefinition(cableOf(w), def);
       }},
  };
}

std::vector<FailingCall> queries() {
  return {
      {"castRaysAll",
       [](World& w) {
         static const std::vector<RayQuery> rays(3, RayQuery{{0, 0, 9}, {0, 0, -1}, 100, {}});
         w.castRaysAll(rays);
       }},
      {"castShapesAll",
       [](World& w) {
         static const std::vector<CastQuery> casts{{test::oddBody().shape, {0, 0, 9}, {}, {0, 0, -9}, {}}};
         w.castShapesAll(casts);
       }},
      {"overlapsAll",
       [](World& w) {
         static const std::vector<OverlapQuery> shapes{{Shape::sphere(2), {}, {}, {}}};
         w.overlapsAll(shapes);
       }},
      {"one ray",
       [](World& w) {
         w.castRay({{0, 0, 9}, {0, 0, -1}, 100, {}}), w.castRayAll({{0, 0, 9}, {0, 0, -1}, 100, {}});
       }},
      {"jointArray", [](World& w) { w.array(JointArray::Position); }},
      {"sensorArray", [](World& w) { w.array(SensorArray::ContactForce); }},
      {"vertexArray", [](World& w) { w.array(VertexArray::Position); }},
      {"contactForces",
       [](World& w) {
         static const std::vector<std::array<BodyId, 2>> pairs{pairOf(w)};
         w.contactForces(pairs);
       }},
      {"lists",
       [](World& w) { w.bodies(), w.joints(), w.axes(), w.deformables(), w.attachments(), w.shapes(); }},
      {"listsOfABody", [](World& w) { w.jointsOf(bodyOf(w, 1)), w.contactsOf(bodyOf(w, 1)); }},
      {"contactLoad", [](World& w) { w.contactLoad(bodyOf(w, 1)); }},
      {"vertices", [](World& w) { w.positions(cableOf(w)), w.velocities(cableOf(w)), w.masses(cableOf(w)); }},
      {"solverStatesOfADeformable", [](World& w) { w.solverStates(cableOf(w)); }},
      {"tableHashes", [](World& w) { w.tableHashes(); }},
      {"bytes", [](World& w) { w.snapshot().bytes(); }},
      {"fromBytes",
       [](World& w) {
         static const std::vector<std::byte> bytes = w.snapshot().bytes();
         Snapshot::fromBytes(bytes);
       }},
  };
}

TEST(OutOfMemory, LeavesTheWorldOfASetterAsItWas) {
  expectUndisturbed(setters(), false, test::Started(sceneOfSetters()));
}
TEST(OutOfMemory, LeavesTheWorldOfASetterAsItWasWhenItLasts) {
  expectUndisturbed(setters(), true, test::Started(sceneOfSetters()));
}
TEST(OutOfMemory, LeavesTheWorldThatIsAskedAsItWas) {
  expectUndisturbed(queries(), false, test::Started(sceneOfSetters()));
  expectUndisturbed(queries(), true, test::Started(sceneOfSetters()));
}

TEST(OutOfMemory, LeavesTheRulesOfMaterialsThatARestoredWorldHad) {
  Scene scene = sceneOfSetters();
  World ruled(scene, test::optionsOfAll());
  ruled.setMaterialPair({"wood", "ice", .9, .9, {}, .2});
  const Snapshot snapshot = ruled.snapshot();
  scene.materialPairs.clear();
  World unruled(scene, test::optionsOfAll());
  test::run(ruled, 4), test::run(unruled, 4);
  test::forEachAllocation("restore", [&](long k) {
    World world(scene, test::optionsOfAll());
    const Outcome outcome = test::outcomeWithout(k, false, "restore", [&] { world.restore(snapshot); });
    if (outcome == Outcome::OutOfMemory) {
      EXPECT_TRUE(world.materialPairs().empty());
      test::run(world, 4);
      EXPECT_EQ(world.hash(), unruled.hash()) << k;
      world.restore(snapshot);
    }
    test::run(world, 4);
    EXPECT_EQ(world.hash(), ruled.hash()) << k;
    return outcome != Outcome::Whole && !testing::Test::HasFailure();
  });
}

TEST(OutOfMemory, InAScriptedEventLosesNoPartOfIt) {
  Scene scene = sceneOfSetters();
  Event event;
  event.step = 1;
  event.removeJoints = {"drag"};
  scene.bodies[5].name = "gone1", scene.bodies[6].name = "gone2", scene.bodies[3].name = "pushed";
  event.remove = {"gone*"};
  event.add = {test::marble("one"), test::marble("two")};
  event.add[1].position = {-5, 0, 1};
  event.setVelocity = {{"pushed", {1, 0, 0}, {}}};
  event.setJoint.resize(1);
  event.setJoint[0].joint = "hinge", event.setJoint[0].targetSpeed = 1, event.setJoint[0].motorForce = 2;
  scene.events = {event};
  World reference(scene, test::optionsOfAll());
  test::run(reference, 4);
  test::forEachAllocation("runEvents", [&](long k) {
    World world(scene, test::optionsOfAll());
    world.step();
    const Outcome outcome = test::outcomeWithout(k, false, "runEvents", [&] { world.runEvents(); });
    if (k % 2) world.restore(Snapshot::fromBytes(world.snapshot().bytes()));
    test::run(world, 3);
    EXPECT_EQ(world.hash(), reference.hash()) << k;
    return outcome != Outcome::Whole && !testing::Test::HasFailure();
  });
}

TEST(OutOfMemory, InAStepLosesNoReportOfAJointThatBroke) {
  const Scene scene = test::sceneOfAll();
  test::forEachAllocation("step", [&](long k) {
    World world(scene, test::optionsOfAll());
    std::size_t reported = 0;
    bool failed = false;
    for (int step = 0; step < 6; ++step) {
      StepReport report;
      const auto take = [&] { report = world.step(); };
      // the joint breaks in the first step
      if (step == 0 || (failed && step == 1))
        failed |= test::outcomeWithout(k, false, "step", take) != Outcome::Whole;
      else
        take();
      reported += report.broken.size();
    }
    EXPECT_TRUE(world.state(world.joints()[1]).broken);
    EXPECT_EQ(reported, 1u) << k;
    return failed && !testing::Test::HasFailure();
  });
}

}  // namespace
}  // namespace rubble

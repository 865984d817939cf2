/// Every allocation of every call of a World fails once, alone and with all after it. The call then throws,
/// and the world is as it was.
#include "tests/backend/failing_edits.h"

namespace rubble {
namespace {

using namespace test;

std::vector<FailingCall> edits() {
  return {
      {"addBody",
       [](World& w) {
         static const BodyDef def = marble("marble");
         w.addBody(def);
       }},
      {"addBodyOfAnotherShape",
       [](World& w) {
         static const BodyDef def = oddBody();
         w.addBody(def);
       }},
      {"addBodies",
       [](World& w) {
         static const std::vector<BodyDef> more{marble("one"), oddBody(), test::ground(), marble("two")};
         w.addBodies(more);
       }},
      {"removeBody", [](World& w) { w.removeBody(bodyOf(w, 3)); }},
      {"removeBodies",
       [](World& w) {
         const std::array ids{bodyOf(w, 2), bodyOf(w, 0), bodyOf(w, 1), bodyOf(w, 4)};
         w.removeBodies(ids);
       }},
      {"setShape",
       [](World& w) {
         static const Shape shape = oddBody().shape;
         w.setShape(bodyOf(w, 6), shape);
       }},
      {"addShape",
       [](World& w) {
         static const Shape shape = oddBody().shape;
         w.addShape(shape);
       }},
      {"removeShape", [](World& w) { w.removeShape(w.shapes().back()); }},
      {"setCollide", [](World& w) { w.setCollide(bodyOf(w, 1), bodyOf(w, 6), false); }},
      {"setCollideAgain", [](World& w) { w.setCollide(bodyOf(w, 3), bodyOf(w, 4), true); }},
      {"setState",
       [](World& w) {
         w.setState(bodyOf(w, 5), {{0, 0, 9}, {}, {1, 0, 0}, {}});
       }},
      {"setStateOfAStaticBody",
       [](World& w) {
         w.setState(bodyOf(w, 0), {{0, 0, -.1}, {}, {}, {}});
       }},
      {"applyForces",
       [](World& w) {
         w.applyForce(bodyOf(w, 5), {1, 2, 3});
         w.applyForceAt(bodyOf(w, 5), {1, 2, 3}, {0, 0, 1});
       }},
      {"applyImpulse",
       [](World& w) {
         w.applyImpulse(bodyOf(w, 5), {1, 2, 3});
       }},
      {"wake", [](World& w) { w.wake(bodyOf(w, 5)); }},
      {"addJoint",
       [](World& w) {
         JointDef joint = test::ball(0, {.5, 0, 0}, 0, {-.5, 0, 0});
         joint.type = JointType::Hinge;
         joint.name = "hinge";
         joint.collide = false;
         w.addJoint(joint, bodyOf(w, 4), bodyOf(w, 5));
       }},
      {"removeJoint", [](World& w) { w.removeJoint(firstJoint(w)); }},
      {"setDefinition",
       [](World& w) {
         JointDef joint = w.definition(firstJoint(w));
         joint.collide = true;
         joint.anchorA.x += .01;
         w.setDefinition(firstJoint(w), joint);
       }},
      {"addDragJoint",
       [](World& w) {
         w.addDragJoint(bodyOf(w, 5), {0, 4, 1}, 100);
       }},
      {"addDeformable",
       [](World& w) {
         static const Deformable cable = cableNamed("cable");
         w.addDeformable(cable);
       }},
      {"removeDeformable", [](World& w) { w.removeDeformable(w.findDeformable("cloth")); }},
      {"addAttachment",
       [](World& w) {
         static const AttachmentDef a = attachmentOf(3);
         w.addAttachment(a, w.findDeformable("cloth"), bodyOf(w, 4));
       }},
      {"removeAttachment", [](World& w) { w.removeAttachment(w.attachments().front()); }},
      {"setVertices",
       [](World& w) {
         const DeformableId cloth = w.findDeformable("cloth");
         static const std::vector<Vec3> to(static_cast<std::size_t>(w.vertexCount(cloth)), Vec3{5, 0, 2});
         w.setVertices(cloth, to, to);
       }},
      {"setGravity",
       [](World& w) {
         w.setGravity({0, 1, -9});
       }},
      {"reserve", [](World& w) { w.reserve("activePairs", 1000); }},
  };
}

std::vector<FailingCall> reads() {
  return {
      {"hash", [](World& w) { w.hash(); }},
      {"snapshot", [](World& w) { w.snapshot(); }},
      {"quality", [](World& w) { w.quality(); }},
      {"contacts", [](World& w) { w.contacts(); }},
      {"vertexContacts", [](World& w) { w.vertexContacts(); }},
      {"solverStates", [](World& w) { w.solverStates(); }},
      {"state", [](World& w) { w.state(firstJoint(w)); }},
      {"surface", [](World& w) { w.surface(w.findDeformable("cloth")); }},
      {"array", [](World& w) { w.array(StateArray::Position); }},
      {"poses", [](World& w) { w.beginPoses(), w.takePoses(); }},
      {"castRays",
       [](World& w) {
         static const std::vector<RayQuery> rays(3, RayQuery{{0, 0, 9}, {0, 0, -1}, 100, {}});
         w.castRays(rays);
       }},
      {"castShapes",
       [](World& w) {
         static const std::vector<CastQuery> casts{{oddBody().shape, {0, 0, 9}, {}, {0, 0, -9}, {}}};
         w.castShapes(casts);
       }},
      {"overlaps",
       [](World& w) {
         static const std::vector<OverlapQuery> shapes{{Shape::sphere(2), {}, {}, {}}};
         w.overlaps(shapes);
       }},
      {"closestPoints",
       [](World& w) {
         static const std::vector<ClosestQuery> points{{{0, 0, 3}, 5, {}}};
         w.closestPoints(points);
       }},
  };
}

TEST(OutOfMemory, LeavesTheWorldOfAnEditAsItWas) { expectUndisturbed(edits(), false); }
TEST(OutOfMemory, LeavesTheWorldOfAnEditAsItWasWhenItLasts) { expectUndisturbed(edits(), true); }
TEST(OutOfMemory, LeavesTheWorldThatIsReadAsItWas) { expectUndisturbed(reads(), false); }

TEST(OutOfMemory, LeavesNoWorldWhereItIsMade) {
  const Scene scene = sceneOfAll();
  for (const bool lasting : {false, true})
    forEachAllocation("World", [&](long k) {
      const test::FailingMemory failing(k, lasting);
      try {
        const World world(scene, optionsOfAll());
        EXPECT_FALSE(failing.hasFailed());
      } catch (const OutOfMemory& error) {
        EXPECT_EQ(error.path(), "World");
      } catch (const std::bad_alloc&) {
        EXPECT_TRUE(lasting);
      }
      return failing.hasFailed();
    });
}

TEST(OutOfMemory, InAStepKeepsThePosesOrTakesTheStep) {
  const Scene scene = sceneOfAll();
  for (const bool sorts : {false, true}) {
    // the first step grows all tables, and in a later one a joint breaks
    for (int steps = 0; steps < 3; ++steps) {
      const auto make = [&] {
        World world(scene, optionsOfAll());
        test::run(world, steps);
        if (sorts) world.sortBodies();
        return world;
      };
      World reference = make();
      reference.step();
      forEachAllocation("step", [&](long k) {
        World world = make();
        std::vector<Vec3> places;
        for (const BodyId id : world.bodies()) places.push_back(world.state(id).position);
        const Outcome outcome = outcomeWithout(k, false, "step", [&] { world.step(); });
        if (world.stepCount() == steps) {
          std::size_t i = 0;
          for (const BodyId id : world.bodies()) EXPECT_EQ(world.state(id).position, places[i++]) << k;
          world.step();
          EXPECT_EQ(world.stepCount(), steps + 1);
        } else {
          EXPECT_EQ(world.hash(), reference.hash()) << k;
        }
        for (int more = 0; more < 3; ++more) world.step();
        EXPECT_TRUE(std::isfinite(world.quality().maxSpeed));
        EXPECT_TRUE(world.state(world.joints()[1]).broken);
        return outcome != Outcome::Whole && !testing::Test::HasFailure();
      });
    }
  }
}

TEST(OutOfMemory, LeavesTheWorldThatIsRestoredAsItWas) {
  const Started started;
  World other = started.world();
  for (int i = 0; i < 20; ++i) other.addBody(oddBody());
  other.addDeformable(straightCable({6, 0, 2}, {7, 0, 2}, 4));
  test::run(other, 2);
  const Snapshot snapshot = other.snapshot();
  World reference = started.world();
  const std::uint64_t before = reference.hash();
  test::run(reference, 2);
  test::run(other, 2);
  for (const bool lasting : {false, true})
    forEachAllocation("restore", [&](long k) {
      World world = started.world();
      const Outcome outcome = outcomeWithout(k, lasting, "restore", [&] { world.restore(snapshot); });
      if (outcome == Outcome::OutOfMemory) {
        EXPECT_EQ(world.hash(), before) << k;
        test::run(world, 2);
        EXPECT_EQ(world.hash(), reference.hash()) << k;
        world.restore(snapshot);
      }
      test::run(world, 2);
      EXPECT_EQ(world.hash(), other.hash()) << k;
      return outcome != Outcome::Whole && !testing::Test::HasFailure();
    });
}

}  // namespace
}  // namespace rubble

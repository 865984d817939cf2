/// Every allocation of every call of a World fails once, alone and with all after it. The call then throws,
/// and the world is as it was.
#include <gtest/gtest.h>

#include <functional>

#include "io/scene_json.h"
#include "tests/backend/counted_memory.h"
#include "tests/support/files.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// A bit of everything, with a joint that breaks in the first steps.
Scene sceneOfAll() {
  Scene scene = test::emptyScene();
  scene.bodies.push_back(test::ground());
  for (int i = 0; i < 5; ++i) scene.bodies.push_back(test::unitCube({0, 1.2 * i, .5}));
  scene.bodies[1].name = "first";
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scene.bodies.push_back(test::body(Shape::hull(corners), {3, 0, .2}));
  scene.bodies.back().material.rollingFriction = .1;
  scene.bodies.push_back(test::body(Shape::sphere(.3), {4, 0, 2}));
  scene.joints.push_back(test::ball(1, {0, .6, 0}, 2, {0, -.6, 0}));
  scene.joints.back().collide = false;
  scene.joints.back().name = "link";
  scene.joints.push_back(test::ball(kWorld, {4, 0, 2.5}, 7, {0, 0, .5}));
  scene.joints.back().breakForce = 1;
  scene.exclusions.emplace_back(3, 4);
  ClothDef cloth = clothSheet({5, 0, 1}, {1, 0, 0}, {0, 1, 0}, 2, 2);
  cloth.name = "cloth";
  scene.deformables.emplace_back(cloth);
  AttachmentDef attachment;
  attachment.vertices = {0};
  attachment.body = 3;
  scene.attachments.push_back(attachment);
  return scene;
}

WorldOptions optionsOfAll() {
  WorldOptions options = test::options(2);
  options.events = true;
  options.params.sleeping = true;
  return options;
}

/// A call. What it is given is made once, while memory does not fail.
struct Call {
  const char* name;
  std::function<void(World&)> take;
};

BodyDef marble(const char* name) {
  BodyDef def = test::body(Shape::cone(.2, .3), {-3, 0, 1});
  def.name = name;
  def.material.torsionalFriction = .2;
  return def;
}
BodyDef oddBody() {
  std::vector<ShapePartDef> parts(2);
  parts[0].shape = Shape::sphere(.2);
  parts[1].shape = Shape::box({.2, .1, .1});
  parts[1].position = {.3, 0, 0};
  parts[1].material.emplace();
  return test::body(Shape::compound(parts), {-2, 0, 3});
}
Deformable cableNamed(const char* name) {
  CableDef cable = straightCable({6, 0, 2}, {7, 0, 2}, 4);
  cable.name = name;
  return cable;
}
AttachmentDef attachmentOf(int vertex) {
  AttachmentDef out;
  out.vertices = {vertex};
  return out;
}
JointId firstJoint(const World& world) { return world.findJoint("link"); }
BodyId body(const World& world, int k) { return world.bodyAt(k); }

std::vector<Call> edits() {
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
      {"removeBody", [](World& w) { w.removeBody(body(w, 3)); }},
      {"removeBodies",
       [](World& w) {
         const std::array ids{body(w, 2), body(w, 0), body(w, 1), body(w, 4)};
         w.removeBodies(ids);
       }},
      {"setShape",
       [](World& w) {
         static const Shape shape = oddBody().shape;
         w.setShape(body(w, 6), shape);
       }},
      {"addShape",
       [](World& w) {
         static const Shape shape = oddBody().shape;
         w.addShape(shape);
       }},
      {"removeShape", [](World& w) { w.removeShape(w.shapes().back()); }},
      {"setCollide", [](World& w) { w.setCollide(body(w, 1), body(w, 6), false); }},
      {"setCollideAgain", [](World& w) { w.setCollide(body(w, 3), body(w, 4), true); }},
      {"setState",
       [](World& w) {
         w.setState(body(w, 5), {{0, 0, 9}, {}, {1, 0, 0}, {}});
       }},
      {"setStateOfAStaticBody",
       [](World& w) {
         w.setState(body(w, 0), {{0, 0, -.1}, {}, {}, {}});
       }},
      {"applyForces",
       [](World& w) {
         w.applyForce(body(w, 5), {1, 2, 3});
         w.applyForceAt(body(w, 5), {1, 2, 3}, {0, 0, 1});
       }},
      {"applyImpulse",
       [](World& w) {
         w.applyImpulse(body(w, 5), {1, 2, 3});
       }},
      {"wake", [](World& w) { w.wake(body(w, 5)); }},
      {"addJoint",
       [](World& w) {
         JointDef joint = test::ball(0, {.5, 0, 0}, 0, {-.5, 0, 0});
         joint.type = JointType::Hinge;
         joint.name = "hinge";
         joint.collide = false;
         w.addJoint(joint, body(w, 4), body(w, 5));
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
         w.addDragJoint(body(w, 5), {0, 4, 1}, 100);
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
         w.addAttachment(a, w.findDeformable("cloth"), body(w, 4));
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

std::vector<Call> reads() {
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

constexpr long kMostAllocations = 10000;

/// Calls try_(k) for every allocation that can fail, until one call of it needs fewer.
template <class Try> void forEachAllocation(const char* name, Try&& try_) {
  long k = 0;
  while (k < kMostAllocations && try_(k)) ++k;
  ASSERT_LT(k, kMostAllocations) << name;
}

enum class Outcome {
  Whole,       ///< it needed no more allocations than that
  WithoutIt,   ///< one failed, and it found another way
  OutOfMemory  ///< it threw
};

/// The call without the k-th allocation.
Outcome outcomeWithout(long k, bool lasting, const Call& call, World& world) {
  const test::FailingMemory failing(k, lasting);
  try {
    call.take(world);
    return failing.hasFailed() ? Outcome::WithoutIt : Outcome::Whole;
  } catch (const OutOfMemory&) {
    EXPECT_TRUE(failing.hasFailed()) << call.name << " " << k;
  } catch (const std::bad_alloc&) {
    EXPECT_TRUE(lasting) << call.name << " " << k << ": there was memory for an Error";
  }
  return Outcome::OutOfMemory;
}

/// Worlds of the scene after some steps, with or without a snapshot that shares their definitions.
class Started {
 public:
  Started() : scene_(sceneOfAll()) {}
  World world() const {
    World world(scene_, optionsOfAll());
    world.addShape(held_);
    test::run(world, 2);
    return world;
  }

 private:
  Scene scene_;
  Shape held_ = Shape::hull({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
};

void expectUndisturbed(const std::vector<Call>& calls, bool lasting) {
  const Started started;
  for (const Call& call : calls) {
    World reference = started.world();
    const std::uint64_t before = reference.hash();
    call.take(reference);
    const std::uint64_t after = reference.hash();
    test::run(reference, 3);
    forEachAllocation(call.name, [&](long k) {
      World world = started.world();
      const Snapshot sharing = k % 2 ? world.snapshot() : Snapshot{};
      const Outcome outcome = outcomeWithout(k, lasting, call, world);
      if (outcome == Outcome::OutOfMemory) {
        EXPECT_EQ(world.hash(), before) << call.name << " " << k;
        call.take(world);
      }
      EXPECT_EQ(world.hash(), after) << call.name << " " << k;
      test::run(world, 3);
      EXPECT_EQ(world.hash(), reference.hash()) << call.name << " " << k;
      return outcome != Outcome::Whole && !testing::Test::HasFailure();
    });
  }
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
      const Call step{"step", [](World& w) { w.step(); }};
      forEachAllocation("step", [&](long k) {
        World world = make();
        std::vector<Vec3> places;
        for (const BodyId id : world.bodies()) places.push_back(world.state(id).position);
        const Outcome outcome = outcomeWithout(k, false, step, world);
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
  const Call restore{"restore", [&](World& w) { w.restore(snapshot); }};
  for (const bool lasting : {false, true})
    forEachAllocation("restore", [&](long k) {
      World world = started.world();
      const Outcome outcome = outcomeWithout(k, lasting, restore, world);
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

TEST(OutOfMemory, LeavesTheFileThatIsWrittenAsItWas) {
  // the library for JSON allocates in destructors, so the text is made before
  const std::string text(100000, 'x');
  const test::TemporaryFolder folder;
  const std::string file = (folder.path / "a file with a long name.json").string();
  std::ofstream(file) << "before";
  forEachAllocation("writeText", [&](long k) {
    bool failed = false;
    try {
      const test::FailingMemory failing(k, false);
      try {
        io::writeText(file, text);
      } catch (...) {
        failed = failing.hasFailed();
        throw;
      }
      failed = failing.hasFailed();
    } catch (const std::bad_alloc&) {
      EXPECT_EQ(test::contentOf(file), "before") << k;
    } catch (const Error&) {
      EXPECT_EQ(test::contentOf(file), "before") << k;
    }
    return failed && !testing::Test::HasFailure();
  });
  EXPECT_EQ(test::contentOf(file), text);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

}  // namespace
}  // namespace rubble

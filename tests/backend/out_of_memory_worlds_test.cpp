/// Every allocation of every call of Worlds fails once. The call then throws, and all worlds are as they
/// were.
#include "tests/backend/failing_worlds.h"
#include "tests/backend/host_rows.h"

namespace rubble {
namespace {

using test::cubeOf;
using test::expectUndisturbedWorlds;
using test::hashesOf;
using test::HostRows;
using test::kCopies;
using test::kWorlds;
using test::nextOf;
using test::optionsOfWorlds;
using test::Outcome;
using test::startedWorlds;
using test::WorldsCall;

/// Another world than those of startedWorlds(), which a reset gives all of them.
Snapshot otherSnapshot(Worlds& worlds) {
  World& last = worlds[worlds.count() - 1];
  last.addBodies(std::vector<BodyDef>{test::marble("other"), test::oddBody()});
  last.addDeformable(test::cableNamed("other"));
  last.setMaterialPair({"wood", "stone", .3, .2});
  worlds.step();
  return last.snapshot();
}

std::vector<WorldsCall> editsOfWorlds() {
  return {
      {"add",
       [](Worlds& w) {
         static const Scene scene = test::sceneOfAll();
         w.add(scene);
       }},
      {"addCopies",
       [](Worlds& w) {
         static const Scene scene = cubeOf(.7, "wood");
         w.addCopies(scene, 2);
       }},
      {"setParams",
       [](Worlds& w) {
         Params params = w.params();
         params.iterations = 3;
         w.setParams(params);
       }},
      {"scatterVelocities",
       [](Worlds& w) {
         static const HostRows rows({1, 98}, {1, 0, 0, 0, 1, 0}, 3);
         w.scatter(StateArray::Velocity, rows.rows(), rows.values());
       }},
      {"scatterForces",
       [](Worlds& w) {
         static const HostRows rows({1, 98}, {1, 0, 0, 0, 1, 0}, 3);
         w.scatter(StateArray::Force, rows.rows(), rows.values());
       }},
      {"scatterTargets",
       [](Worlds& w) {
         static const HostRows rows({0, 32}, {.1, .2}, 1);
         w.scatter(JointArray::TargetPosition, rows.rows(), rows.values());
       }},
      {"scatterForcesOfJoints",
       [](Worlds& w) {
         static const HostRows rows({0, 32}, {1, 2}, 1);
         w.scatter(JointArray::AppliedForce, rows.rows(), rows.values());
       }},
      {"addBody",
       [](Worlds& w) {
         static const BodyDef def = test::oddBody();
         w[3].addBody(def);
       }},
      {"addBodies",
       [](Worlds& w) {
         static const std::vector<BodyDef> more{test::marble("one"), test::oddBody(), test::ground()};
         w[kCopies].addBodies(more);
       }},
      {"removeBody", [](Worlds& w) { w[kCopies].removeBody(w[kCopies].bodyAt(6)); }},
      {"removeBodies",
       [](Worlds& w) {
         World& own = w[kCopies];
         const std::array ids{own.bodyAt(2), own.bodyAt(0), own.bodyAt(6)};
         own.removeBodies(ids);
       }},
      {"setShape",
       [](Worlds& w) {
         static const Shape shape = test::oddBody().shape;
         w[kCopies].setShape(w[kCopies].bodyAt(6), shape);
       }},
      {"setMaterial",
       [](Worlds& w) {
         Material ice;
         ice.name = "ice", ice.rollingFriction = .1;
         w[5].setMaterial(w[5].bodyAt(1), ice);
       }},
      {"setMaterialPair",
       [](Worlds& w) {
         w[5].setMaterialPair({"wood", "ice", .1, .1});
       }},
      {"setGravity",
       [](Worlds& w) {
         w[5].setGravity({0, 1, -9});
       }},
      {"setCollide", [](Worlds& w) { w[5].setCollide(w[5].bodyAt(0), w[5].bodyAt(2), false); }},
      {"setCollideAgain",
       [](Worlds& w) { w[kCopies].setCollide(w[kCopies].bodyAt(3), w[kCopies].bodyAt(4), true); }},
      {"addJoint",
       [](Worlds& w) {
         JointDef joint = test::ball(0, {.5, 0, 0}, 0, {-.5, 0, 0});
         joint.name = "ball", joint.collide = false;
         w[kCopies].addJoint(joint, w[kCopies].bodyAt(4), w[kCopies].bodyAt(5));
       }},
      {"removeJoint", [](Worlds& w) { w[kCopies].removeJoint(test::firstJoint(w[kCopies])); }},
      {"setTargetPosition", [](Worlds& w) { w[2].setTargetPosition(w[2].joints()[0], 0, .1); }},
      {"setState",
       [](Worlds& w) {
         w[5].setState(w[5].bodyAt(1), {{0, 0, 9}, {}, {1, 0, 0}, {}});
       }},
      {"applyForce",
       [](Worlds& w) {
         w[5].applyForce(w[5].bodyAt(1), {1, 2, 3});
       }},
      {"addDeformable",
       [](Worlds& w) {
         static const Deformable cable = test::cableNamed("cable");
         w[3].addDeformable(cable);
       }},
      {"removeDeformable",
       [](Worlds& w) { w[kCopies].removeDeformable(w[kCopies].findDeformable("cloth")); }},
      {"setVertices",
       [](Worlds& w) {
         World& own = w[kCopies];
         const DeformableId cloth = own.findDeformable("cloth");
         static const std::vector<Vec3> to(static_cast<std::size_t>(own.vertexCount(cloth)), Vec3{5, 0, 2});
         own.setVertices(cloth, to, to);
       }},
  };
}

std::vector<WorldsCall> readsOfWorlds() {
  return {
      {"array", [](Worlds& w) { w.array(StateArray::Position); }},
      {"jointArray", [](Worlds& w) { w.array(JointArray::Position); }},
      {"sensorArray", [](Worlds& w) { w.array(SensorArray::Touch); }},
      {"vertexArray", [](Worlds& w) { w.array(VertexArray::Position); }},
      {"rows", [](Worlds& w) { w.rowsOf(kCopies), w.firstAxis(kCopies), w.firstVertex(kCopies); }},
      {"contactForces",
       [](Worlds& w) {
         static const std::vector<std::array<int, 2>> pairs{{0, 1}, {96, 97}};
         w.contactForces(pairs);
       }},
      {"castRays",
       [](Worlds& w) {
         static const std::vector<Worlds::WorldRay> rays{{0, {{0, 0, 9}, {0, 0, -1}, 100, {}}},
                                                         {kCopies, {{5, 0, 9}, {0, 0, -1}, 100, {}}}};
         w.castRays(rays);
       }},
      {"snapshot", [](Worlds& w) { w[kCopies].snapshot(); }},
      {"quality", [](Worlds& w) { w[kCopies].quality(); }},
      {"hash", [](Worlds& w) { w[kCopies].hash(); }},
  };
}

TEST(WorldsOutOfMemory, KeepTheirStateInAnEdit) { expectUndisturbedWorlds(editsOfWorlds(), false); }
TEST(WorldsOutOfMemory, KeepTheirStateInAnEditWhenItLasts) { expectUndisturbedWorlds(editsOfWorlds(), true); }
TEST(WorldsOutOfMemory, KeepTheirStateWhenTheyAreRead) { expectUndisturbedWorlds(readsOfWorlds(), false); }

TEST(WorldsOutOfMemory, AreNotThereWhereTheyAreMade) {
  test::forEachAllocation("Worlds", [&](long k) {
    const Outcome outcome = test::outcomeWithout(k, false, "Worlds", [] { Worlds{optionsOfWorlds()}; });
    return outcome != Outcome::Whole && !testing::Test::HasFailure();
  });
}

/// Worlds that fail to be restored at an allocation are as they were, and can be restored afterwards.
void expectRestorable(const char* name, const std::function<void(Worlds&, const Snapshot&)>& restore,
                      const std::function<Snapshot(Worlds&)>& take) {
  Worlds whole = startedWorlds();
  restore(whole, take(whole));
  whole.step(3);
  const std::vector<std::uint64_t> restored = hashesOf(whole);
  test::forEachAllocation(name, [&](long n) {
    const long k = nextOf(n);
    Worlds worlds = startedWorlds();
    const Snapshot own = take(worlds);
    const std::vector<std::uint64_t> present = hashesOf(worlds);
    const Outcome outcome = test::outcomeWithout(k, n % 2, name, [&] { restore(worlds, own); });
    if (outcome == Outcome::OutOfMemory) {
      EXPECT_EQ(hashesOf(worlds), present) << name << " " << k;
      restore(worlds, own);
    }
    worlds.step(3);
    EXPECT_EQ(hashesOf(worlds), restored) << name << " " << k;
    return outcome != Outcome::Whole && !testing::Test::HasFailure();
  });
}

TEST(WorldsOutOfMemory, KeepTheirStateInAResetToTheirOwn) {
  expectRestorable(
      "reset",
      [](Worlds& worlds, const Snapshot& snapshot) {
        const std::array some{4, 0, 32};
        worlds.reset(some, {&snapshot, 1});
      },
      [](Worlds& worlds) {
        const Snapshot snapshot = worlds[1].snapshot();
        worlds.step(3);
        return snapshot;
      });
}

TEST(WorldsOutOfMemory, KeepTheirStateInAResetToOtherElements) {
  expectRestorable(
      "reset",
      [](Worlds& worlds, const Snapshot& snapshot) {
        const std::array some{4, 0, 32};
        worlds.reset(some, {&snapshot, 1});
      },
      otherSnapshot);
}

TEST(WorldsOutOfMemory, KeepTheirStateInAResetToFewerElements) {
  expectRestorable(
      "reset",
      [](Worlds& worlds, const Snapshot& snapshot) {
        const std::array some{kCopies, 7};
        worlds.reset(some, {&snapshot, 1});
      },
      [](Worlds& worlds) { return worlds[1].snapshot(); });
}

TEST(WorldsOutOfMemory, KeepTheStateOfOneThatIsRestored) {
  expectRestorable(
      "restore", [](Worlds& worlds, const Snapshot& snapshot) { worlds[2].restore(snapshot); },
      otherSnapshot);
}

/// Steps that fail keep the poses of each world, or have taken the step.
void expectStepped(const std::vector<char>& active) {
  // a joint breaks in the first step
  const auto make = [] { return startedWorlds(optionsOfWorlds(), 0); };
  Worlds reference = make();
  const std::vector<std::uint64_t> begun = hashesOf(reference);
  reference.step(1, active);
  const std::vector<std::uint64_t> stepped = hashesOf(reference);
  test::forEachAllocation("step", [&](long k) {
    Worlds worlds = make();
    std::vector<std::vector<Vec3>> places;
    const auto placesOf = [](const World& world) {
      std::vector<Vec3> out;
      for (const BodyId id : world.bodies()) out.push_back(world.state(id).position);
      return out;
    };
    for (int w = 0; w < kWorlds; ++w) places.push_back(placesOf(worlds[w]));
    std::size_t reported = 0;
    const Outcome outcome = test::outcomeWithout(k, false, "step",
                                                 [&] { reported += worlds.step(1, active).broken.size(); });
    for (int w = 0; w < kWorlds; ++w) {
      const auto at = static_cast<std::size_t>(w);
      const bool isPaused = !active.empty() && !active[at];
      if (outcome == Outcome::Whole) {
        EXPECT_EQ(worlds[w].hash(), isPaused ? begun[at] : stepped[at]) << k << " " << w;
      } else if (isPaused || worlds[w].stepCount() == 0) {
        EXPECT_EQ(placesOf(worlds[w]), places[at]) << k << " " << w;
        EXPECT_EQ(worlds[w].stepCount(), 0);
      } else {
        EXPECT_EQ(worlds[w].hash(), stepped[at]) << k << " " << w;
      }
    }
    for (int more = 0; more < 3; ++more) reported += worlds.step().broken.size();
    EXPECT_TRUE(worlds[kCopies].state(worlds[kCopies].joints()[1]).broken);
    EXPECT_EQ(reported, 1u) << k;
    return outcome != Outcome::Whole && !testing::Test::HasFailure();
  });
}

TEST(WorldsOutOfMemory, InAStepKeepTheirPosesOrTakeTheStep) { expectStepped({}); }
TEST(WorldsOutOfMemory, InAStepKeepWorldsThatArePaused) {
  std::vector<char> active(kWorlds, 1);
  active[1] = active[kCopies - 1] = 0;
  expectStepped(active);
}

TEST(WorldsOutOfMemory, OfASceneThatIsInvalidHaveNoPartOfIt) {
  Worlds worlds = startedWorlds();
  const std::vector<std::uint64_t> before = hashesOf(worlds);
  Scene twice = test::sceneOfAll();
  twice.bodies[2].name = twice.bodies[1].name;
  EXPECT_THROW(worlds.addCopies(twice, 2), Error);
  EXPECT_EQ(hashesOf(worlds), before);
  EXPECT_EQ(worlds.add(cubeOf(1)), kWorlds);
  worlds.step();
}

}  // namespace
}  // namespace rubble

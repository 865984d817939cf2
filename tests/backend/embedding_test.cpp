/// Worlds inside of other programs: forks, threads, the log (docs/embedding.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

#include <rubble/worlds.h>

#include "platform/threads.h"
#include "tests/support/scenes.h"

namespace rubble {
namespace {

constexpr int kFewSteps = 5;

std::uint64_t hashAfter(World& world, int steps) {
  test::run(world, steps);
  return world.hash();
}

/// Does f() in a child process return true there?
template <class F> bool holdsInChild(F&& f) {
  const pid_t child = fork();
  if (child == 0) {
    bool holds = false;
    try {
      holds = f();
    } catch (...) {
    }
    _exit(holds ? 0 : 1);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Fork, LeavesTheChildAWorldOfOneThread) {
  World world(test::heap(3), test::options(4, "cpu", 1));
  test::run(world, kFewSteps);
  const Snapshot snapshot = world.snapshot();
  const std::uint64_t expected = hashAfter(world, kFewSteps);
  world.restore(snapshot);
  EXPECT_TRUE(holdsInChild([&] {
    World own(test::heap(3), test::options(4, "cpu", 1));
    return hashAfter(world, kFewSteps) == expected && hashAfter(own, 2 * kFewSteps) == expected;
  }));
  EXPECT_EQ(hashAfter(world, kFewSteps), expected);
}

TEST(World, IsSteppedFromAnyThread) {
  World world(test::heap(3), test::options(4, "cpu", 2)),
      reference(test::heap(3), test::options(4, "cpu", 2));
  for (int k = 0; k < 8; ++k) {
    std::thread([&] { world.step(); }).join();
    reference.step();
  }
  EXPECT_EQ(world.hash(), reference.hash());
}

TEST(World, IsIndependentOfOthersThatStepBesideIt) {
  constexpr int kWorlds = 4;
  World reference(test::heap(3), test::options(4, "cpu", 1));
  const std::uint64_t expected = hashAfter(reference, 2 * kFewSteps);
  std::vector<std::uint64_t> hashes(kWorlds);
  std::vector<std::thread> threads;
  for (int k = 0; k < kWorlds; ++k)
    threads.emplace_back([&, k] {
      World world(test::heap(3), test::options(4, "cpu", k % 2 + 1));
      hashes[static_cast<std::size_t>(k)] = hashAfter(world, 2 * kFewSteps);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hashes, std::vector<std::uint64_t>(kWorlds, expected));
}

/// Runs tasks on threads of its own, in a new order each time.
struct HostTasks {
  std::atomic<int> loops = 0, tasks = 0;

  TaskSystem system(int parts) {
    return {parts, [this](int count, TaskSystem::Task task, void* context) {
              const int turn = loops++;
              std::vector<std::thread> threads;
              for (int k = 0; k < count; ++k)
                threads.emplace_back([=, this] {
                  task(context, (k + turn) % count);
                  ++tasks;
                });
              for (std::thread& thread : threads) thread.join();
            }};
  }
};

/// Bodies, joints, cloth and particles, with rules of materials.
Scene everything() {
  Scene scene = test::heap(3);
  scene.deformables.emplace_back(clothSheet({0, 0, 4}, {2, 0, 0}, {0, 2, 0}, 6, 6));
  ParticlesDef grains;
  grains.radius = 0.06;
  for (int i = 0; i < 40; ++i) grains.vertices.push_back({0.15 * (i % 7), 0.15 * (i / 7), 5 + 0.01 * i});
  scene.deformables.push_back(grains);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scene.bodies[i].material.name = i % 2 ? "odd" : "even";
  scene.materialPairs.push_back({"odd", "even", 0.2, 0.1, 0.3, 0.01});
  return scene;
}

/// Counts the bytes that are out, and gives no more than `most`.
struct HostBytes {
  std::atomic<std::size_t> now = 0, most = ~std::size_t{0};

  MemorySystem system() {
    return {[this](std::size_t bytes) -> void* {
              if (now + bytes > most) return nullptr;
              now += bytes;
              return std::malloc(bytes);
            },
            [this](void* block, std::size_t bytes) {
              now -= bytes;
              std::free(block);
            }};
  }
};

TEST(MemorySystem, OfTheHostHoldsTheTablesAndGetsAllOfItBack) {
  for (const char* backend : {"cpu", "reference"}) {
    World reference(everything(), test::options(4, backend));
    test::run(reference, kFewSteps);
    HostBytes host;
    WorldOptions options = test::options(4, backend, 2);
    options.memory = host.system();
    {
      World world(everything(), options);
      EXPECT_EQ(hashAfter(world, kFewSteps), reference.hash()) << backend;
      EXPECT_GE(host.now, world.memoryBytes()) << backend;
      world.reserve("activePairs", 100000);
      EXPECT_GE(host.now, world.memoryBytes()) << backend;
      world.restore(world.snapshot());
      world.castRay({{0, 0, 9}, {0, 0, -1}, 20, {}});
    }
    EXPECT_EQ(host.now, 0u) << backend;
  }
}

TEST(MemorySystem, OfTheHostHoldsTheTablesOfManyWorlds) {
  HostBytes host;
  WorldOptions options = test::options(4, "cpu", 2);
  options.memory = host.system();
  {
    Worlds worlds(options);
    worlds.addCopies(everything(), 3);
    worlds.step(2);
    EXPECT_GE(host.now, worlds.memoryBytes());
  }
  EXPECT_EQ(host.now, 0u);
}

TEST(MemorySystem, ThatEndsIsOutOfMemory) {
  HostBytes host;
  WorldOptions options = test::options(4);
  options.memory = host.system();
  {
    World world(everything(), options);
    test::run(world, kFewSteps);
    const std::uint64_t hash = world.hash();
    host.most = host.now.load();
    EXPECT_THROW(world.reserve("activePairs", 1000000), OutOfMemory);
    EXPECT_THROW(World(everything(), options), OutOfMemory);
    EXPECT_EQ(world.hash(), hash);
  }
  EXPECT_EQ(host.now, 0u) << "that of the world which could not be made, too";
  options.backend = "lockstep";
  EXPECT_THROW(World(everything(), options), Error);
}

TEST(TaskSystem, OfTheHostRunsAllLoopsWithTheSameBits) {
  const WorldOptions own = test::options(4);
  const auto advance = [](World& world) {
    test::run(world, 6);
    world.sortBodies();
    test::run(world, 6);
  };
  World reference(everything(), own);
  advance(reference);
  std::vector<RayQuery> rays;
  for (int i = 0; i < 40; ++i) rays.push_back({{0.05 * i, 1, 9}, {0, 0, -1}, 20, {}});
  const std::vector<RayHit> expected = reference.castRays(rays);
  for (const int parts : {1, 2, 5}) {
    HostTasks host;
    WorldOptions options = own;
    options.tasks = host.system(parts);
    World world(everything(), options);
    advance(world);
    EXPECT_EQ(host.loops > 0, parts > 1) << parts;
    EXPECT_EQ(world.hash(), reference.hash()) << parts;
    const std::vector<RayHit> hits = world.castRays(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(hits[i].body, expected[i].body) << parts;
      EXPECT_EQ(hits[i].distance, expected[i].distance) << parts;
    }
  }
  // worlds at once, each on tasks of its own
  HostTasks shared;
  std::vector<std::thread> threads;
  std::vector<std::uint64_t> hashes(3);
  for (std::size_t k = 0; k < hashes.size(); ++k)
    threads.emplace_back([&, k] {
      WorldOptions options = own;
      options.tasks = shared.system(2);
      World world(everything(), options);
      advance(world);
      hashes[k] = world.hash();
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, reference.hash());
}

TEST(TaskSystem, SeesNoTaskThrowAndTheCallerSeesTheFirst) {
  HostTasks host;
  Threads threads(0, host.system(3));
  std::atomic<int> done = 0;
  const auto loop = [&] {
    forEachTask(std::size_t{12}, [&](std::size_t k) {
      ++done;
      if (k % 4 == 2) throw std::runtime_error(std::to_string(k));
    });
  };
  try {
    threads.run(loop);
    ADD_FAILURE() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "2");
  }
  EXPECT_EQ(done, 12);
  EXPECT_EQ(host.tasks, 12);
}

TEST(TaskSystem, RunsTheQueriesOfManyWorlds) {
  HostTasks host;
  WorldOptions options = test::options(4);
  options.tasks = host.system(3);
  Worlds worlds(options);
  worlds.add(test::tower(1));
  worlds.step();
  const int before = host.loops;
  EXPECT_EQ(worlds[0].castRays(std::vector<RayQuery>(5000, {{0, 0, 9}, {0, 0, -1}, 20, {}})).size(), 5000u);
  EXPECT_GT(host.loops, before);
}

TEST(TaskSystem, IsRefusedWhereItWouldNotBeUsed) {
  HostTasks host;
  WorldOptions options = test::options(4, "lockstep");
  options.tasks = host.system(2);
  EXPECT_THROW(World(test::tower(1), options), Error);
  options.backend = "cpu", options.tasks.parts = 0;
  EXPECT_THROW(World(test::tower(1), options), Error);
}

/// A heap and a joint that breaks.
Scene breakingScene() {
  Scene scene = test::heap(2);
  scene.joints.push_back(test::ball(kWorld, {9, 0, 9}, 1, {0, 0, 0}));
  scene.joints.back().breakForce = 1;
  return scene;
}

TEST(Log, HasWhatTheReportHasAndNothingElseIsWritten) {
  std::vector<std::string> lines;
  int warnings = 0;
  WorldOptions options = test::options(4);
  options.log = [&](LogLevel level, std::string_view line) {
    lines.emplace_back(line);
    warnings += level == LogLevel::Warning;
  };
  const Scene scene = breakingScene();
  testing::internal::CaptureStdout(), testing::internal::CaptureStderr();
  World world(scene, options);
  std::size_t notable = 0;
  for (int k = 0; k < 2 * kFewSteps; ++k) {
    const StepReport report = world.step();
    notable += report.grown.size() + (report.brokenJoints > 0);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(notable, 1u);
  EXPECT_EQ(lines.size() - static_cast<std::size_t>(warnings), notable);
  EXPECT_NE(std::ranges::find_if(lines, [](const auto& l) { return l.ends_with("1 joints broke"); }),
            lines.end());
  // a log that throws does not disturb the world
  options.log = [](LogLevel, std::string_view) { throw std::runtime_error("full"); };
  World other(scene, options);
  EXPECT_THROW(test::run(other, 2 * kFewSteps), std::runtime_error);
  while (other.stepCount() < world.stepCount()) {
    try {
      other.step();
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_EQ(other.hash(), world.hash());
}

TEST(Log, IsCalledOnTheThreadThatCalledTheWorld) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 2; ++k)
    threads.emplace_back([] {
      int lines = 0, elsewhere = 0;
      WorldOptions options = test::options(4, "cpu", 3);
      options.log = [&, own = std::this_thread::get_id()](LogLevel, std::string_view) {
        ++lines, elsewhere += std::this_thread::get_id() != own;
      };
      World world(breakingScene(), options);
      test::run(world, 2 * kFewSteps);
      EXPECT_GT(lines, 0);
      EXPECT_EQ(elsewhere, 0);
    });
  for (std::thread& thread : threads) thread.join();
}

TEST(Log, OfABatchHasTheReportOfAllItsWorldsAndWarnsOnceForAll) {
  std::vector<std::string> infos, warnings;
  WorldOptions options = test::options(4);
  options.log = [&](LogLevel level, std::string_view line) {
    (level == LogLevel::Warning ? warnings : infos).emplace_back(line);
  };
  constexpr int kWorlds = 3;
  Worlds worlds(options);
  worlds.addCopies(breakingScene(), kWorlds);
  std::size_t notable = 0;
  for (int k = 0; k < 2 * kFewSteps; ++k) {
    for (int w = 1; w < kWorlds; ++w) worlds[w].applyForce(worlds[w].bodyAt(0), {1, 0, 0});
    const WorldsReport report = worlds.step();
    notable += report.grown.size() + (report.brokenJoints > 0);
  }
  EXPECT_EQ(infos.size(), notable);
  EXPECT_NE(std::ranges::find(infos, "a step of 3 worlds: 3 joints broke"), infos.end());
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("dynamic bodies only"), std::string::npos);
}

TEST(Log, WarnsOncePerWorldOfCallsWithoutEffect) {
  std::vector<std::string> warnings;
  WorldOptions options = test::options(4);
  options.log = [&](LogLevel level, std::string_view line) {
    if (level == LogLevel::Warning) warnings.emplace_back(line);
  };
  Scene scene = test::tower(1);  // the ground is the first body
  World world(scene, options);
  world.applyForce(world.bodyAt(1), {1, 0, 0});
  world.applyImpulse(world.bodyAt(1), {1, 0, 0});
  world.step();
  EXPECT_EQ(warnings, std::vector<std::string>());
  for (int k = 0; k < 3; ++k) {
    world.applyForce(world.bodyAt(0), {1, 0, 0});
    world.applyImpulse(world.bodyAt(0), {1, 0, 0});
    EXPECT_TRUE(world.events().contacts.empty());
    world.step();
  }
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("static"), std::string::npos);
  EXPECT_NE(warnings[1].find("WorldOptions::events"), std::string::npos);

  options.events = true;
  World heard(scene, options);
  heard.step();
  EXPECT_FALSE(heard.events().contacts.empty());
  heard.step();
  EXPECT_EQ(warnings.size(), 2u);
}

}  // namespace
}  // namespace rubble

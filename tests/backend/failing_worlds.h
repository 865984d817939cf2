#pragma once
/// Batches of worlds, and calls of them whose allocations fail.
#include <functional>

#include <rubble/worlds.h>

#include "tests/backend/failing_edits.h"

namespace rubble::test {

/// More than one batch of a processor, the last one with different worlds.
inline constexpr int kCopies = 33, kWorlds = kCopies + 1;

inline Scene cubeOf(double height, const char* material = "") {
  Scene scene = emptyScene();
  scene.bodies.push_back(ground());
  scene.bodies.push_back(unitCube({0, 0, height}));
  scene.bodies.push_back(unitCube({2, 0, .5}));
  scene.bodies[1].material.name = material;
  scene.joints.push_back(ball(1, {.5, 0, 0}, 2, {-.5, 0, 0}));
  scene.joints.back().type = JointType::Hinge;
  scene.joints.back().axes[0].driveStiffness = 10;
  return scene;
}

inline WorldOptions optionsOfWorlds() {
  WorldOptions own = options(2);
  own.events = true;
  return own;
}

/// Copies of a small world, and one with a bit of everything.
inline Worlds startedWorlds(const WorldOptions& options = optionsOfWorlds(), int steps = 2) {
  Worlds worlds(options);
  worlds.addCopies(cubeOf(.6), kCopies);
  worlds.add(sceneOfAll());
  worlds.step(steps);
  return worlds;
}

inline std::vector<std::uint64_t> hashesOf(const Worlds& worlds) {
  std::vector<std::uint64_t> out;
  for (int w = 0; w < worlds.count(); ++w) out.push_back(worlds[w].hash());
  return out;
}

/// A call of all worlds. What it is given is made once, while memory does not fail.
struct WorldsCall {
  const char* name;
  std::function<void(Worlds&)> take;
};

/// Tries a few allocations of each call from the first one on, and every fourth of the later ones: worlds
/// take long to make.
inline long nextOf(long k) { return k < 60 ? k : 60 + 4 * (k - 60); }

template <class Failing = FailingMemory>
void expectUndisturbedWorlds(const std::vector<WorldsCall>& calls, bool lasting,
                             const WorldOptions& options = optionsOfWorlds()) {
  for (const WorldsCall& call : calls) {
    Worlds reference = startedWorlds(options);
    const std::vector<std::uint64_t> before = hashesOf(reference);
    call.take(reference);
    const std::vector<std::uint64_t> after = hashesOf(reference);
    reference.step(3);
    const std::vector<std::uint64_t> later = hashesOf(reference);
    forEachAllocation(call.name, [&](long n) {
      const long k = nextOf(n);
      Worlds worlds = startedWorlds(options);
      const Outcome outcome = outcomeWithout<Failing>(k, lasting, call.name, [&] { call.take(worlds); });
      if (outcome == Outcome::OutOfMemory) {
        EXPECT_EQ(hashesOf(worlds), before) << call.name << " " << k;
        if (k % 3 == 0) worlds.step(0);
        call.take(worlds);
      }
      EXPECT_EQ(hashesOf(worlds), after) << call.name << " " << k;
      worlds.step(3);
      EXPECT_EQ(hashesOf(worlds), later) << call.name << " " << k;
      return outcome != Outcome::Whole && !testing::Test::HasFailure();
    });
  }
}

}  // namespace rubble::test

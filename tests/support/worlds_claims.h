#pragma once
/// Claims of worlds in a batch, for random small worlds of nearly anything, on any backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include <rubble/worlds.h>

#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace rubble::test {

/// A shape of about that size.
inline Shape randomShape(Random& random, double size) {
  switch (random.below(6)) {
    case 0:
      return Shape::sphere(size);
    case 1:
      return Shape::capsule(0.4 * size, 0.6 * size);
    case 2:
      return Shape::hull(
          {{size, 0, 0}, {-size, 0, 0}, {0, size, 0}, {0, -size, 0}, {0, 0, size}, {0, 0, -size}});
    case 3:
      return Shape::compound({{Shape::box({size, 0.3 * size, 0.3 * size}), {}, {}},
                              {Shape::sphere(0.4 * size), {0, 0, 0.5 * size}, {}}});
    default:
      return Shape::box({size, 0.7 * size, 0.5 * size});
  }
}

/// A chain that hangs from the world: hinges with limits, a drive, and a gear-like pulley of springs at
/// times.
inline void addChain(Scene& scene, Random& random, int links) {
  int last = kWorld;
  const Vec3 top{random.uniform(-1, 1), random.uniform(-1, 1), 2.5};
  for (int i = 0; i < links; ++i) {
    BodyDef link = body(Shape::capsule(0.05, 0.1), top - Vec3{0, 0, 0.3 * i + 0.15});
    link.velocity = random.vector(1);
    scene.bodies.push_back(link);
    const int own = static_cast<int>(scene.bodies.size()) - 1;
    const JointType type = random.below(2) == 0 ? JointType::Hinge : JointType::Ball;
    JointDef joint = jointAt(scene, type, own, last, top - Vec3{0, 0, 0.3 * i});
    if (type == JointType::Hinge) {
      joint.axes[0].min = -0.4, joint.axes[0].max = 0.5;
      if (random.below(2) == 0) joint.axes[0].targetSpeed = 2, joint.axes[0].driveDamping = 3;
    }
    if (random.below(4) == 0) joint.collide = true;
    scene.joints.push_back(joint);
    last = own;
  }
}

inline void addDeformables(Scene& scene, Random& random) {
  if (random.below(2) == 0) {
    TetSolidDef jelly = tetBox({random.uniform(-1, 0), 0, 0.6}, {0.5, 0.5, 0.4}, {2, 2, 2});
    jelly.youngsModulus = 2e4;
    if (random.below(2) == 0) jelly.yieldStress = 500;
    scene.deformables.push_back(jelly);
  }
  if (random.below(2) == 0) {
    ClothDef cloth = clothSheet({-0.6, -0.6, 1.4}, {1.2, 0, 0}, {0, 1.2, 0}, 5, 5);
    scene.deformables.push_back(cloth);
  }
  if (random.below(2) == 0) scene.deformables.push_back(straightCable({-0.5, 0.2, 1.8}, {0.5, 0.2, 1.8}, 6));
  if (random.below(2) == 0) {
    ParticlesDef grains;
    for (int i = 0; i < 6; ++i) grains.vertices.push_back(Vec3{0, 0, 1} + random.vector(0.5));
    scene.deformables.push_back(grains);
  }
  if (!scene.deformables.empty() && random.below(2) == 0) {
    AttachmentDef a;
    a.object = 0;
    a.vertices = {0};
    scene.attachments.push_back(a);
  }
}

/// A small world of nearly anything about the origin. `most`: bodies that are free at first.
inline Scene randomWorld(std::uint64_t seed, int most = 10, bool deformables = true) {
  Random random(seed);
  Scene scene = emptyScene(10 * normalize(Vec3{random.uniform(-0.2, 0.2), 0, -1}) * random.uniform(0.5, 1));
  const int floors = random.below(3);
  if (floors == 0) {
    scene.bodies.push_back(ground());
  } else if (floors == 1) {
    BodyDef slab = body(Shape::box({4, 4, 0.5}), {0, 0, -0.5});
    slab.motion = Motion::Static;
    scene.bodies.push_back(slab);
  } else {
    BodyDef mesh = body(
        Shape::mesh({{-4, -4, 0}, {4, -4, 0.2}, {4, 4, 0}, {-4, 4, 0.1}}, {{0, 1, 2}, {0, 2, 3}}), {});
    mesh.motion = random.below(2) == 0 ? Motion::Static : Motion::Kinematic;
    if (mesh.motion == Motion::Kinematic) mesh.velocity = {0.2, 0, 0};
    scene.bodies.push_back(mesh);
  }
  for (int i = random.below(most); i >= 0; --i) {
    BodyDef def = body(randomShape(random, random.uniform(0.15, 0.4)), Vec3{0, 0, 1.2} + random.vector(1));
    def.orientation = random.rotation();
    def.velocity = random.vector(random.below(5) == 0 ? 30 : 2);
    if (random.below(4) == 0) def.material.restitution = 0.6;
    if (random.below(6) == 0) def.material.rollingFriction = 0.02;
    if (random.below(8) == 0) def.material.surfaceVelocity = {0.3, 0, 0};
    if (random.below(8) == 0) def.sensor = true;
    if (random.below(8) == 0) def.filter.group = -3;
    if (random.below(8) == 0) def.lockRotation[0] = true;
    scene.bodies.push_back(def);
  }
  if (random.below(2) == 0) addChain(scene, random, 1 + random.below(4));
  if (deformables && random.below(2) == 0) addDeformables(scene, random);
  return scene;
}

/// Those of the worlds, with sleep and events.
inline WorldOptions worldsOptions(const std::string& backend = "cpu", int threads = 1) {
  WorldOptions options = test::options(4, backend, threads);
  options.params.sleeping = true;
  options.events = true;
  return options;
}

/// Everything that World tells of its state, as numbers.
inline std::vector<double> stateOf(const World& world) {
  std::vector<double> out;
  const auto add = [&](const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (const BodyId id : world.bodies()) {
    const BodyState s = world.state(id);
    add(s.position), add(s.orientation.v), add(s.velocity), add(s.angularVelocity);
    out.push_back(s.orientation.s), out.push_back(world.asleep(id));
  }
  for (const JointId id : world.joints()) {
    const JointState s = world.state(id);
    add(s.force), add(s.torque);
    for (const JointAxisState& axis : s.axes)
      out.insert(out.end(), {axis.position, axis.speed, axis.limitForce, axis.driveForce});
  }
  for (const DeformableId id : world.deformables())
    for (const std::vector<Vec3>& list : {world.positions(id), world.velocities(id)})
      for (const Vec3& v : list) add(v);
  for (const ContactPoint& c : world.contacts())
    out.push_back(c.a.index), out.push_back(c.b.index), add(c.position), add(c.force);
  for (const VertexContact& c : world.vertexContacts())
    out.push_back(c.vertex), out.push_back(c.body.index), add(c.force);
  for (const SolverState& s : world.solverStates()) out.push_back(s.color);
  out.push_back(static_cast<double>(world.events().contacts.size()));
  out.push_back(static_cast<double>(world.events().sleeps.size()));
  out.push_back(world.time());
  return out;
}

/// The hash of a world in a batch of its own, after each step.
inline std::vector<std::uint64_t> hashesAlone(const Scene& scene, const WorldOptions& options, int steps) {
  Worlds alone(options);
  alone.add(scene);
  std::vector<std::uint64_t> out;
  for (int k = 0; k < steps; ++k) alone.step(), out.push_back(alone[0].hash());
  return out;
}

/// Random worlds, of which number k is always the same.
struct RandomWorlds {
  std::uint64_t seed = 0;
  int most = 10;
  bool deformables = true;
  Scene scene(int k) const { return randomWorld(seed + static_cast<std::uint64_t>(k), most, deformables); }
};

/// Each world of a batch of `count` has the bits that it has in a batch of its own. Looks at every
/// `stride`-th.
inline void expectBitsAlone(const RandomWorlds& random, int count, const WorldOptions& options, int steps,
                            int stride = 1) {
  Worlds worlds(options);
  for (int w = 0; w < count; ++w) ASSERT_EQ(worlds.add(random.scene(w)), w);
  worlds.step(steps);
  for (int w = 0; w < count; w += stride) {
    Worlds alone(options);
    alone.add(random.scene(w));
    alone.step(steps);
    ASSERT_EQ(stateOf(worlds[w]), stateOf(alone[0])) << "world " << w;
    ASSERT_EQ(worlds[w].hash(), alone[0].hash()) << "world " << w;
  }
}

/// A step with a mask keeps the bits of the worlds that it leaves out, and takes the steps of all others.
inline void expectMasks(const RandomWorlds& content, const WorldOptions& options, int count, int rounds) {
  Worlds worlds(options);
  for (int w = 0; w < count; ++w) worlds.add(content.scene(w));
  Random random(5);
  const auto size = static_cast<std::size_t>(count);
  std::vector<int> taken(size, 0);
  for (int k = 0; k < rounds; ++k) {
    std::vector<char> active(size);
    std::vector<std::uint64_t> before;
    for (int w = 0; w < count; ++w) {
      active[static_cast<std::size_t>(w)] = random.below(3) != 0;
      if (const std::vector<BodyId> bodies = worlds[w].bodies(); random.below(4) == 0)
        worlds[w].applyForce(bodies.back(), {0, 0, 0.5});
      before.push_back(worlds[w].hash());
    }
    worlds.step(1, active);
    for (std::size_t w = 0; w < size; ++w) {
      taken[w] += active[w] != 0;
      if (!active[w]) {
        ASSERT_EQ(worlds[static_cast<int>(w)].hash(), before[w]) << "world " << w << ", round " << k;
      }
    }
  }
  // the same forces and masks without the others
  for (int alone = 0; alone < count; ++alone) {
    Worlds one(options);
    one.add(content.scene(alone));
    Random again(5);
    for (int k = 0; k < rounds; ++k)
      for (int w = 0; w < count; ++w) {
        const bool active = again.below(3) != 0, pushed = again.below(4) == 0;
        if (w != alone) continue;
        if (pushed) one[0].applyForce(one[0].bodies().back(), {0, 0, 0.5});
        if (active) one.step();
      }
    EXPECT_EQ(worlds[alone].stepCount(), taken[static_cast<std::size_t>(alone)]);
    EXPECT_EQ(worlds[alone].hash(), one[0].hash()) << "world " << alone;
  }
}

/// Resets of random worlds, each to the start of a random world, change no other world.
inline void expectResets(const RandomWorlds& content, const WorldOptions& options, int count, int rounds,
                         int resets) {
  Worlds worlds(options);
  std::vector<Snapshot> starts;
  std::vector<std::vector<std::uint64_t>> alone;
  for (int w = 0; w < count; ++w) {
    worlds.add(content.scene(w));
    alone.push_back(hashesAlone(content.scene(w), options, rounds + 2));
  }
  worlds.step();
  for (int w = 0; w < count; ++w) starts.push_back(worlds[w].snapshot());
  std::vector<std::size_t> age(static_cast<std::size_t>(count), 0), from(age.size());
  std::iota(from.begin(), from.end(), 0);
  Random random(6);
  for (int k = 0; k < rounds; ++k) {
    std::map<int, int> changes;
    while (static_cast<int>(changes.size()) < resets) changes[random.below(count)] = random.below(count);
    std::vector<int> list;
    std::vector<Snapshot> snapshots;
    for (const auto& [at, start] : changes) {
      list.push_back(at), snapshots.push_back(starts[static_cast<std::size_t>(start)]);
      age[static_cast<std::size_t>(at)] = 0,
      from[static_cast<std::size_t>(at)] = static_cast<std::size_t>(start);
    }
    worlds.reset(list, snapshots);
    worlds.step();
    for (std::size_t w = 0; w < age.size(); ++w)
      ASSERT_EQ(worlds[static_cast<int>(w)].hash(), alone[from[w]][++age[w]])
          << "world " << w << ", round " << k;
  }
}

/// World 1 of three, with edits and queries of its own, does what it does alone.
inline void expectEditsAlone(const RandomWorlds& content, const WorldOptions& options) {
  Worlds worlds(options), one(options);
  for (int w = 0; w < 3; ++w) worlds.add(content.scene(w));
  one.add(content.scene(1));
  World& alone = one[0];
  const auto edit = [&](World& world, int k) {
    const BodyDef box = body(Shape::box({0.2, 0.2, 0.2}), {0.1 * k, 0, 3. + k});
    const BodyId added = world.addBody(box);
    world.applyImpulse(added, {0, 1, 0});
    if (k == 1 && content.deformables)
      world.addDeformable(clothSheet({-0.6, -0.6, 2.4}, {1.2, 0, 0}, {0, 1.2, 0}, 4, 4));
    if (k == 2) world.removeBody(world.bodies()[1]), world.setGravity({1, 0, -5});
  };
  for (int k = 0; k < 4; ++k) {
    edit(worlds[1], k), edit(alone, k);
    worlds.step(10), one.step(10);
    ASSERT_EQ(stateOf(worlds[1]), stateOf(alone)) << "after edit " << k;
  }
  std::vector<RayQuery> rays;
  Random random(1);
  for (int k = 0; k < 50; ++k) rays.push_back({random.vector(3), random.direction(), 10., {}});
  const auto inBatch = worlds[1].castRays(rays), own = alone.castRays(rays);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    EXPECT_EQ(inBatch[k].hit, own[k].hit);
    EXPECT_EQ(inBatch[k].body, own[k].body);
    EXPECT_EQ(inBatch[k].position, own[k].position);
  }
}

}  // namespace rubble::test

/// Strands: ropes and rods whose vertices are solved together.
#include <gtest/gtest.h>

#include <numbers>

#include "scenes/registry.h"
#include "tests/soft/soft_scenes.h"

namespace rubble {
namespace {

using namespace test;

double lengthOf(const World& world, DeformableId id) {
  const std::vector<Vec3> x = world.positions(id);
  double sum = 0;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) sum += length(x[k + 1] - x[k]);
  return sum;
}

CableDef rope(int segments, double stiffness = 1e8) {
  CableDef d = straightCable({0, 0, 0}, {0, 0, -1}, segments);
  d.radius = .01, d.youngsModulus = stiffness, d.density = 300;
  return d;
}

TEST(Strand, HoldsALoadTenThousandTimesAsHeavyAsAVertexAtOnce) {
  constexpr double kLoad = 10;
  for (const int segments : {10, 50, 100}) {
    CableDef d = rope(segments);
    d.fixed = {0};
    Scene scene = sceneWith(d);
    BodyDef load = body(Shape::sphere(.05), {0, 0, -1.06});
    load.mass = kLoad;
    scene.bodies.push_back(load);
    AttachmentDef hook;
    hook.vertices = {segments}, hook.body = 0;
    scene.attachments.push_back(hook);
    World world(scene, options(4));
    const double atRest = 10 * kLoad / (d.youngsModulus * std::numbers::pi * d.radius * d.radius);
    double longest = 0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      longest = std::max(longest, lengthOf(world, world.deformableAt(0)) - 1);
    }
    // a load that is let go stretches what holds it twice as far, if nothing takes up energy
    EXPECT_LT(longest, 2.2 * atRest) << segments;
    EXPECT_NEAR(lengthOf(world, world.deformableAt(0)) - 1, atRest, .03 * atRest) << segments;
  }
}

TEST(Strand, BendsAtFewIterationsAsAtMany) {
  CableDef d = straightCable({0, 0, 0}, {1, 0, 0}, 40);
  d.radius = .02, d.youngsModulus = 1e8, d.density = 500;
  d.fixed = {0, 1};
  World few(sceneWith(d), options(4)), many(sceneWith(d), options(200));
  double worst = 0, deepest = 0;
  for (int i = 0; i < 120; ++i) {
    few.step(), many.step();
    const double a = few.positions(few.deformableAt(0)).back().z,
                 b = many.positions(many.deformableAt(0)).back().z;
    worst = std::max(worst, std::fabs(a - b)), deepest = std::max(deepest, -b);
  }
  EXPECT_LT(worst, .01 * deepest);
}

TEST(Strand, KeepsItsMomentumAndGainsNoEnergyWhenItIsThrownAnyhow) {
  CableDef d = rope(30, 1e7);
  World world(sceneWith(d, {0, 0, 0}), options(4));
  const DeformableId id = world.deformableAt(0);
  Random random(5);
  std::vector<Vec3> velocities;
  for (std::size_t i = 0; i < d.vertices.size(); ++i) velocities.push_back(random.vector(3));
  world.setVertices(id, d.vertices, velocities);
  const Momentum before = momentumOf(world, id);
  const double energy = world.quality().kineticEnergy;
  for (int i = 0; i < 120; ++i) {
    world.step();
    EXPECT_LT(world.quality().kineticEnergy, energy);
  }
  EXPECT_LT(length(momentumOf(world, id).linear - before.linear), 1e-3 * before.mass);
  EXPECT_LT(lengthOf(world, id), 1.05);
}

/// Rope of 1 m that is authored with a stretch, its first end fixed.
Scene stretchedRope(double strain) {
  CableDef d = straightCable({0, 0, 0}, {1, 0, 0}, 20);
  d.radius = .005, d.youngsModulus = 1e8, d.density = 1000;
  for (const Vec3& x : d.vertices) d.start.push_back((1 + strain) * x);
  d.fixed = {0};
  return sceneWith(d, {0, 0, 0});
}

TEST(Strand, PullsWithAllOfItsAuthoredStretchInTheFirstStep) {
  for (const double strain : {1e-3, 1e-2, .1})
    for (const int iterations : {1, 4, 10}) {
      Scene scene = stretchedRope(strain);
      AttachmentDef hook;
      hook.vertices = {20}, hook.body = kWorld, hook.anchor = {1 + strain, 0, 0};
      scene.attachments.push_back(hook);
      World world(scene, options(iterations));
      world.step();
      const double tension = 1e8 * std::numbers::pi * .005 * .005 * strain;
      EXPECT_NEAR(length(world.state(world.attachments()[0]).force), tension, .02 * tension)
          << strain << ", " << iterations;
    }
}

TEST(Strand, PluckedSoundsAtTheFrequencyOfItsTension) {
  const scenes::Spec& spec = scenes::find("plucked-string");
  for (const double strain : {.003, .01, .03}) {
    WorldOptions how = options(4);
    how.params.substeps = 16;
    const scenes::RunResult
        r = scenes::Runner(scenes::prepare(spec, scenes::resolve(spec, {{"strain", strain}})), how).run(120);
    EXPECT_NEAR(r.metrics.at("period_ratio"), 1, .02) << strain;
  }
}

TEST(Strand, IsFoundWhateverTheNumbersOfItsVertices) {
  constexpr int kCount = 12;
  const auto net = [](const std::vector<int>& number) {
    NetDef d;
    d.vertices.resize(kCount);
    for (int i = 0; i < kCount; ++i)
      d.vertices[static_cast<std::size_t>(number[static_cast<std::size_t>(i)])] = {.1 * i, 0, 0};
    for (int i = 0; i + 1 < kCount; ++i) {
      NetDef::Edge e;
      e.a = number[static_cast<std::size_t>(i + 1)], e.b = number[static_cast<std::size_t>(i)],
      e.stiffness = 1e5;
      d.edges.push_back(e);
    }
    d.masses = {.01};
    d.fixed = {number[0], number[7]};
    return d;
  };
  std::vector<int> straight, mixed;
  for (int i = 0; i < kCount; ++i) straight.push_back(i), mixed.push_back((5 * i + 3) % kCount);
  World a(sceneWith(net(straight)), options(3)), b(sceneWith(net(mixed)), options(3));
  run(a, 60), run(b, 60);
  const std::vector<Vec3> x = a.positions(a.deformableAt(0)), y = b.positions(b.deformableAt(0));
  for (std::size_t i = 0; i < kCount; ++i)
    EXPECT_LT(length(x[i] - y[static_cast<std::size_t>(mixed[i])]), 1e-4) << i;
  EXPECT_LT(length(x[7] - Vec3{.7, 0, 0}), 1e-12) << "fixed";
  EXPECT_LT(x[11].z, -.3) << "hangs down";
}

TEST(Strand, HoldsOnABarUpToTheRatioOfLoadsThatFrictionAllows) {
  // e^(mu pi) = 2.566 for mu = 0.3; the rope hangs with a hundredth of the light load
  for (const int segments : {20, 60}) {
    const auto fallAfter = [&](double ratio, int steps) {
      const scenes::Spec& spec = scenes::find("capstan");
      World world(spec.build(scenes::resolve(spec, {{"load_ratio", ratio}, {"segments", segments}})),
                  options(10));
      run(world, steps);
      return -.55 - world.state(world.findBody("heavy")).position.z;
    };
    EXPECT_LT(fallAfter(2.44, 240), .1) << segments;
    EXPECT_GT(fallAfter(2.7, 240), .4) << segments;
  }
}

}  // namespace
}  // namespace rubble

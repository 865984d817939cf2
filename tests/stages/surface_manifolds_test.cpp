/// Loads of contacts with triangle surfaces from step to step: each goes to the manifold of its own facing.
#include <gtest/gtest.h>

#include <vector>

#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

constexpr Real kRadius = .2;

/// A floor z = 0 and a wall x = 0 of one mesh, and smooth balls before it.
struct Corner : CoreWorld {
  explicit Corner(const std::vector<Vec3>& balls) {
    settings().gravity = {0, 0, 0};
    BodyDef mesh;
    mesh.motion = Motion::Static;
    mesh.shape = Shape::mesh({{0, -9, 0}, {9, -9, 0}, {9, 9, 0}, {0, 9, 0}, {0, -9, 9}, {0, 9, 9}},
                             {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 4}});
    const MassProperties frame = cook(mesh.shape).unit;
    mesh.position = frame.center, mesh.orientation = frame.axes;
    add(mesh);
    for (const Vec3& position : balls) {
      BodyDef ball;
      ball.shape = Shape::sphere(kRadius);
      ball.material.staticFriction = ball.material.dynamicFriction = 0;
      ball.position = position;
      add(ball);
    }
    finish();
  }
  /// Steps under constant forces on the balls. seen(view): when the contacts of the step have been found.
  template <class Seen> void run(int steps, const std::vector<Vec3>& forces, Seen&& seen) {
    bool due = false;
    executor().observe([&](std::string_view stage, std::string_view) {
      if (due && stage == "rows") due = false, seen(view());
    });
    for (int n = 0; n < steps; ++n) {
      for (std::size_t i = 0; i < forces.size(); ++i) view().force[i + 1] = forces[i];
      due = true;
      begin();
      step(executor());
    }
    executor().observe({});
  }
};

/// Load of all contacts whose normal is along a direction.
Real loadAlong(const SolverData& s, const Vec3& normal) {
  Real load = 0;
  for (int i = 0; i < s.counters->activePairs; ++i)
    if (std::fabs(dot(s.manifold[i].normal, normal)) > .99)
      for (int k = 0; k < s.manifold[i].count; ++k) load += s.manifold[i].lambdaN[k];
  return load;
}

TEST(SurfaceManifolds, KeepTheLoadsOfTwoFacings) {
  Corner world({{kRadius, 0, kRadius}});
  const std::vector<Vec3> forces = {{-7, 0, -30}};
  int looks = 0;
  world.run(40, forces, [&](const SolverData& s) {
    if (++looks < 30) return;
    EXPECT_NEAR(loadAlong(s, {1, 0, 0}), 7, .01) << looks;
    EXPECT_NEAR(loadAlong(s, {0, 0, 1}), 30, .01) << looks;
  });
  EXPECT_EQ(looks, 40);
}

/// One ball slides on the floor toward the wall, at which another one is pressed: their contacts are apart.
TEST(SurfaceManifolds, StartWithoutTheLoadsOfOtherPairs) {
  Corner world({{.3, 0, kRadius}, {kRadius, 3, 2}});
  int found = 0;
  const std::vector<Vec3> forces = {{-20, 0, -30}, {-50, 0, 0}};
  world.run(60, forces, [&](const SolverData& s) {
    for (int i = 0; i < s.counters->activePairs; ++i) {
      const Pair p = s.pair[s.activePair[i]];
      const Manifold& m = s.manifold[i];
      if (std::max(p.owner, p.other) != 1 || m.count == 0 || std::fabs(m.normal.x) < .99) continue;
      if (found++ > 0) continue;
      EXPECT_EQ(m.lambdaN[0], 0);
    }
  });
  EXPECT_GT(found, 0) << "it comes to the wall";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

/// The order in which trees of joints are eliminated (tables/tree_plan.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "stages/step.h"
#include "tests/support/core_world.h"

namespace rubble::RUBBLE_CORE {
namespace {

using Links = std::vector<std::pair<int, int>>;

/// Cubes with ball joints between them; kWorldBody: a joint to the world.
struct Linked : CoreWorld {
  Linked(int bodies, const Links& links) {
    for (int i = 0; i < bodies; ++i) {
      BodyDef body;
      body.shape = Shape::box({.1, .1, .1});
      body.position = {static_cast<double>(i), 0, 0};
      add(body);
    }
    finish();
    int slot = 0;
    for (const auto& [a, b] : links) addBall(slot++, a, b);
    planTrees(executor().tables());
  }
};
Links chainOf(int bodies) {
  Links links{{0, kWorldBody}};
  for (int i = 1; i < bodies; ++i) links.emplace_back(i, i - 1);
  return links;
}

/// Number of bodies in trees.
int nodesOf(const SolverData& s) {
  return static_cast<int>(
      std::ranges::count_if(firstOf(s.nodeOfBody, s.bodies), [](int n) { return n >= 0; }));
}
int levelsOf(const SolverData& s) {
  int levels = 0;
  for (int n = 0; n < s.treeNodes; ++n)
    if (s.treeNode[n].body >= 0) levels = std::max(levels, s.nodeLevel[n] + 1);
  return levels;
}

/// Every coupling goes to a later level, every joint is a coupling, what is passed on arrives, and the nodes
/// of a tree are consecutive, sorted by level and in one of the lists.
void expectSound(const SolverData& s, const Links& links) {
  std::vector<int> listed = copyOf(s.levelNode, s.levelBegin[kTreeLevels]), live;
  for (int r = 0; r < s.treeLevels; ++r)
    for (int k = s.levelBegin[r]; k < s.levelBegin[r + 1]; ++k) EXPECT_EQ(s.nodeLevel[s.levelNode[k]], r);
  for (int t = 0; t < s.smallTrees; ++t)
    for (int n = s.smallTree[t].begin; n < s.smallTree[t].end; ++n) {
      EXPECT_EQ(s.treeNode[n].tree, s.smallTree[t].begin);
      listed.push_back(n);
    }
  std::sort(listed.begin(), listed.end());
  for (int n = 0; n < s.treeNodes; ++n) {
    const TreeNode& node = s.treeNode[n];
    if (node.body < 0) continue;
    live.push_back(n);
    EXPECT_EQ(s.nodeOfBody[node.body], n);
    EXPECT_LE(node.tree, n);
    if (node.tree < n) {
      EXPECT_EQ(s.treeNode[n - 1].tree, node.tree);
      EXPECT_LE(s.nodeLevel[n - 1], s.nodeLevel[n]);
    }
    for (int side = 0; side < 2; ++side) {
      const int to = node.parent[side];
      if (to < 0) continue;
      EXPECT_EQ(s.treeNode[to].tree, node.tree);
      EXPECT_GT(s.nodeLevel[to], s.nodeLevel[n]);
      const TreeNode& other = s.treeNode[to];
      const int* const first = s.treeChild + other.childBegin;
      const int* const last = s.treeChild + other.childEnd;
      EXPECT_EQ(std::count(first, last, 2 * n + side), 1);
    }
  }
  EXPECT_EQ(listed, live);
  EXPECT_EQ(static_cast<int>(live.size()), nodesOf(s));
  for (const auto& [a, b] : links) {
    if (b == kWorldBody || s.nodeOfBody[a] < 0) continue;
    const int na = s.nodeOfBody[a], nb = s.nodeOfBody[b];
    ASSERT_GE(nb, 0);
    const TreeNode& first = s.treeNode[std::min(na, nb)];
    EXPECT_TRUE(first.parent[0] == std::max(na, nb) || first.parent[1] == std::max(na, nb)) << a << " " << b;
  }
}

/// What a plan says of a body, in terms of bodies.
struct Planned {
  int level = -1, parent[2] = {-1, -1}, exact = 0, limited = 0, large = 0;
  std::vector<int> children;
  bool operator==(const Planned&) const = default;
};
std::vector<Planned> plannedBodies(const SolverData& s, int bodies) {
  std::vector<Planned> out(static_cast<std::size_t>(bodies));
  for (int i = 0; i < bodies; ++i) {
    if (s.nodeOfBody[i] < 0) continue;
    const TreeNode& node = s.treeNode[s.nodeOfBody[i]];
    Planned& to = out[static_cast<std::size_t>(i)];
    to.level = s.nodeLevel[s.nodeOfBody[i]];
    for (int k = 0; k < 2; ++k) to.parent[k] = node.parent[k] < 0 ? -1 : s.treeNode[node.parent[k]].body;
    to.exact = node.exact, to.limited = node.limited, to.large = node.large;
    for (int k = node.childBegin; k < node.childEnd; ++k)
      to.children.push_back(2 * s.treeNode[s.treeChild[k] / 2].body + s.treeChild[k] % 2);
  }
  return out;
}

TEST(JointTrees, ThousandLinksTakeTenLevels) {
  const Links links = chainOf(1000);
  Linked world(1000, links);
  const SolverData& s = world.view();
  EXPECT_EQ(nodesOf(s), 1000);
  EXPECT_LE(levelsOf(s), 11);
  EXPECT_EQ(s.treeNode[0].large, 1);
  EXPECT_EQ(s.treeNode[0].exact, 1);
  expectSound(s, links);
}

TEST(JointTrees, BranchesAreEliminatedWhole) {
  // the parent of each body is the one with half its index
  Links links;
  for (int i = 1; i < 200; ++i) links.emplace_back(i, i / 2);
  Linked world(200, links);
  EXPECT_EQ(nodesOf(world.view()), 200);
  EXPECT_EQ(world.view().treeNode[0].exact, 1);
  expectSound(world.view(), links);
}

TEST(JointTrees, ARingIsEliminatedButNotExact) {
  Links links;
  for (int i = 0; i < 12; ++i) links.emplace_back(i, (i + 1) % 12);
  Linked world(12, links);
  EXPECT_EQ(nodesOf(world.view()), 12);
  EXPECT_EQ(world.view().treeNode[0].exact, 0);
  expectSound(world.view(), links);
}

TEST(JointTrees, ALoopThroughTheWorldIsNotExact) {
  Links links = chainOf(5);
  links.emplace_back(4, kWorldBody);
  Linked world(5, links);
  EXPECT_EQ(nodesOf(world.view()), 5);
  EXPECT_EQ(world.view().treeNode[0].exact, 0);
}

TEST(JointTrees, TwoJointsBetweenTwoBodiesAreNotExact) {
  Links links = chainOf(3);
  links.emplace_back(1, 2);
  Linked world(3, links);
  EXPECT_EQ(nodesOf(world.view()), 3);
  EXPECT_EQ(world.view().treeNode[0].exact, 0);
}

TEST(JointTrees, NetsAreLeftToTheSweeps) {
  constexpr int kEdge = 6;
  Links links;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) {
      if (x > 0) links.emplace_back(y * kEdge + x, y * kEdge + x - 1);
      if (y > 0) links.emplace_back(y * kEdge + x, (y - 1) * kEdge + x);
    }
  Linked world(kEdge * kEdge, links);
  EXPECT_EQ(nodesOf(world.view()), 0);
}

TEST(JointTrees, ALoneBodyIsOneIfAJointHoldsIt) {
  Linked world(4, {{2, kWorldBody}});
  ASSERT_EQ(nodesOf(world.view()), 1);
  EXPECT_EQ(world.view().treeNode[0].body, 2);
  EXPECT_EQ(world.view().treeNode[0].exact, 1);
}

/// Moves the small trees of a world to the lists of large ones.
void listByLevel(SolverData& s) {
  std::vector<std::vector<int>> levels(kTreeLevels);
  for (int n = 0; n < s.treeNodes; ++n) {
    if (s.treeNode[n].body < 0) continue;
    s.treeNode[n].large = 1;
    levels[static_cast<std::size_t>(s.nodeLevel[n])].push_back(n);
  }
  s.smallTrees = 0, s.treeLevels = levelsOf(s);
  int* to = s.levelNode;
  for (std::size_t r = 0; r < levels.size(); ++r) {
    s.levelBegin[r] = static_cast<int>(to - s.levelNode);
    to = std::copy(levels[r].begin(), levels[r].end(), to);
  }
  s.levelBegin[kTreeLevels] = static_cast<int>(to - s.levelNode);
}

/// Two chains whose bodies alternate in the order of elimination.
Links twoChains(int bodies) {
  Links links = chainOf(bodies / 2);
  links.emplace_back(bodies / 2, kWorldBody);
  for (int i = bodies / 2 + 1; i < bodies; ++i) links.emplace_back(i, i - 1);
  return links;
}

TEST(JointTrees, SmallOnesStepAsLevelByLevel) {
  constexpr int kBodies = 20, kSteps = 10;
  Linked atOnce(kBodies, twoChains(kBodies)), byLevel(kBodies, twoChains(kBodies));
  EXPECT_EQ(atOnce.view().treeLevels, 0);
  listByLevel(byLevel.view());
  const Vec3d start = atOnce.view().position[kBodies - 1];
  for (Linked* world : {&atOnce, &byLevel})
    for (int k = 0; k < kSteps; ++k) {
      world->begin();
      step(world->executor());
    }
  for (int i = 0; i < kBodies; ++i) EXPECT_EQ(atOnce.view().position[i], byLevel.view().position[i]) << i;
  EXPECT_GT(length(atOnce.view().position[kBodies - 1] - start), .05);
}

/// Random joints added and removed, also between more than kSmallTree bodies: each plan is the one that a
/// new world makes.
TEST(JointTrees, EditsPlanAsFromTheBeginning) {
  test::Random random(7);
  constexpr int kBodies = 200, kSlots = 240, kEdits = 300;
  Linked world(kBodies, {});
  Links links(kSlots, {-1, -1});
  for (int edit = 0; edit < kEdits; ++edit) {
    const int slot = random.below(kSlots), a = random.below(kBodies);
    const bool grounded = random.below(10) == 0, removed = links[static_cast<std::size_t>(slot)].first >= 0;
    // mostly neighbors, so that chains, branches and loops form
    const int b = grounded ? kWorldBody : (a + 1 + random.below(3)) % kBodies;
    links[static_cast<std::size_t>(slot)] = removed ? std::pair{-1, -1} : std::pair{a, b};
    if (removed)
      apply(world.executor().tables(), SetJoint{slot, {}});
    else
      world.addBall(slot, a, b);
    if (edit % 3 != 0) continue;
    planTrees(world.executor().tables());
    Linked fresh(kBodies, {});
    Links present;
    for (int k = 0; k < kSlots; ++k)
      if (const auto [i, j] = links[static_cast<std::size_t>(k)]; i >= 0)
        fresh.addBall(k, i, j), present.emplace_back(i, j);
    planTrees(fresh.executor().tables());
    expectSound(world.view(), present);
    ASSERT_EQ(plannedBodies(world.view(), kBodies), plannedBodies(fresh.view(), kBodies)) << edit;
  }
}

TEST(JointTrees, SmallOnesAreClosedOneByOneAsAllTogether) {
  constexpr int kBodies = 20;
  Linked world(kBodies, twoChains(kBodies));
  const SolverData& s = world.view();
  world.begin();
  step(world.executor());
  // every third joint is open by a hundredth, beyond the step
  for (int i = 0; i < kBodies; i += 3) s.position[i].y += .01;
  const std::vector<Vec3d> opened = copyOf(s.position, kBodies);
  std::ranges::fill(firstOf(s.treeNeedsProjection, s.treeNodes), 0);
  const auto largestGap = [&] {
    Real largest = 0;
    for (int k = 0; k < kBodies; ++k) {
      FindTreesToProject<BallJoint>{}(s, k);
      largest = std::max(largest, length(s.treeRowsOf<BallJoint>()[k].gap));
    }
    return largest;
  };
  const auto moveAll = [&] {
    for (int n = 0; n < s.treeNodes; ++n) LimitProjection{}(s, n);
    for (int n = 0; n < s.treeNodes; ++n) ApplyProjection{}(s, n);
  };
  EXPECT_NEAR(largestGap(), .01, 1e-3);
  for (int n = 0; n < s.treeNodes; ++n) ASSERT_EQ(s.treeNeedsProjection[s.treeNode[n].tree], 1);
  for (int n = 0; n < s.treeNodes; ++n) AssembleLinks{}(s, n);
  for (int n = 0; n < s.treeNodes; ++n) EliminateLink{}(s, n);
  for (int n = s.treeNodes - 1; n >= 0; --n) SubstituteLink{}(s, n);
  moveAll();
  const std::vector<Vec3d> wanted = copyOf(s.position, kBodies);
  std::ranges::copy(opened, &s.position[0]);
  for (int tree = 0; tree < s.smallTrees; ++tree) ProjectTree{}(s, tree);
  moveAll();
  for (int i = 0; i < kBodies; ++i) EXPECT_EQ(s.position[i], wanted[static_cast<std::size_t>(i)]) << i;
  EXPECT_LT(largestGap(), 1e-5);
}

TEST(JointTrees, OneThatHasHardlyTurnedRestsInTheSolvesThatFollow) {
  Linked world(3, chainOf(3));
  const SolverData& s = world.view();
  const int tree = s.treeNode[0].tree;
  const auto restsAfter = [&](Real turn, TreeSolve how, int touched, Real atRest = kTreeAtRest) {
    s.treeContacts[tree] = touched;
    s.treeMaxRotation[tree] = floatBits(turn);
    for (int n = 0; n < s.treeNodes; ++n) BeginTrees{how, TreesOf::Any, atRest}(s, n);
    EXPECT_EQ(s.treeMaxRotation[tree], 0);
    return s.treeConverged[tree] != 0;
  };
  EXPECT_TRUE(restsAfter(Real(.01), TreeSolve::Again, 1)) << "no limits";
  for (int n = 0; n < s.treeNodes; ++n) s.treeNode[n].limited = true;
  EXPECT_TRUE(restsAfter(Real(.001), TreeSolve::Again, kHasContacts));
  EXPECT_FALSE(restsAfter(Real(.01), TreeSolve::Again, 1)) << "limits may have been passed";
  EXPECT_TRUE(restsAfter(Real(.01), TreeSolve::Again, kTouchesNothing)) << "solved exactly";
  EXPECT_FALSE(restsAfter(Real(.005), TreeSolve::Again, kHasContacts));
  EXPECT_TRUE(restsAfter(Real(.005), TreeSolve::Again, kHasContacts, kTreeSettled)) << "solved twice";
  EXPECT_FALSE(restsAfter(Real(0), TreeSolve::Own, kHasContacts));
  EXPECT_FALSE(restsAfter(Real(0), TreeSolve::Exact, 0));
}

TEST(JointLength, IsTheDiameterOfTheSmallerBody) {
  CoreWorld world;
  const auto addCube = [&](double half, double x) {
    BodyDef body;
    body.shape = Shape::box({half, half, half});
    body.position = {x, 0, 0};
    return world.add(body);
  };
  const int small = addCube(.1, 0), large = addCube(.5, 1);
  world.finish();
  world.addBall(0, small, large), world.addBall(1, large, kWorldBody);
  planTrees(world.executor().tables());
  world.begin();
  step(world.executor());
  const SolverData& s = world.view();
  EXPECT_NEAR(s.jointsOf<BallJoint>()[0].length, 2 * std::sqrt(3.) * .1, 1e-12);
  EXPECT_NEAR(s.jointsOf<BallJoint>()[1].length, 2 * std::sqrt(3.) * .5, 1e-12);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

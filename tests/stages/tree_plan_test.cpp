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

int roundOf(const SolverData& s, int node) {
  int r = 0;
  while (node >= s.treeBegin[r + 1]) ++r;
  return r;
}

/// Every coupling leads to a later level and is a joint, and every fill-in block has a destination. Each
/// tree lists its nodes by level.
void expectSound(const SolverData& s, const Links& links) {
  EXPECT_EQ(s.treeOffset[s.trees], treeNodes(s));
  std::vector<int> listed(s.treeMember, s.treeMember + treeNodes(s));
  for (int t = 0; t < s.trees; ++t) {
    const int begin = s.treeOffset[t], end = s.treeOffset[t + 1];
    EXPECT_LT(begin, end);
    EXPECT_TRUE(std::is_sorted(s.treeMember + begin, s.treeMember + end));
    for (int k = begin; k < end; ++k)
      EXPECT_EQ(s.treeNode[s.treeMember[k]].tree, s.treeNode[s.treeMember[begin]].tree);
  }
  std::sort(listed.begin(), listed.end());
  for (int n = 0; n < treeNodes(s); ++n) EXPECT_EQ(listed[static_cast<std::size_t>(n)], n);
  for (int n = 0; n < treeNodes(s); ++n) {
    const TreeNode& node = s.treeNode[n];
    EXPECT_EQ(s.nodeOfBody[node.body], n);
    for (int side = 0; side < 2; ++side) {
      const int to = node.parent[side];
      if (to < 0) continue;
      EXPECT_GT(roundOf(s, to), roundOf(s, n));
      const TreeNode& other = s.treeNode[to];
      const int* const first = s.treeChild + other.childBegin;
      const int* const last = s.treeChild + other.childEnd;
      EXPECT_EQ(std::count(first, last, 2 * n + side), 1);
    }
  }
  for (const auto& [a, b] : links) {
    if (b == kWorldBody || s.nodeOfBody[a] < 0) continue;
    const int na = s.nodeOfBody[a], nb = s.nodeOfBody[b];
    ASSERT_GE(nb, 0);
    const TreeNode& first = s.treeNode[std::min(na, nb)];
    EXPECT_TRUE(first.parent[0] == std::max(na, nb) || first.parent[1] == std::max(na, nb)) << a << " " << b;
  }
}

TEST(JointTrees, AThousandLinksHaveTenLevels) {
  const Links links = chainOf(1000);
  Linked world(1000, links);
  const SolverData& s = world.view();
  EXPECT_EQ(treeNodes(s), 1000);
  EXPECT_LE(s.treeLevels, 11);
  EXPECT_FALSE(s.smallTrees);
  EXPECT_EQ(s.treeNode[0].exact, 1);
  expectSound(s, links);
}

TEST(JointTrees, BranchesAreEliminatedWhole) {
  // the parent of each body is the one with half its index
  Links links;
  for (int i = 1; i < 200; ++i) links.emplace_back(i, i / 2);
  Linked world(200, links);
  EXPECT_EQ(treeNodes(world.view()), 200);
  EXPECT_EQ(world.view().treeNode[0].exact, 1);
  expectSound(world.view(), links);
}

TEST(JointTrees, ARingIsEliminatedButNotExact) {
  Links links;
  for (int i = 0; i < 12; ++i) links.emplace_back(i, (i + 1) % 12);
  Linked world(12, links);
  EXPECT_EQ(treeNodes(world.view()), 12);
  EXPECT_EQ(world.view().treeNode[0].exact, 0);
  expectSound(world.view(), links);
}

TEST(JointTrees, ALoopThroughTheWorldIsNotExact) {
  Links links = chainOf(5);
  links.emplace_back(4, kWorldBody);
  Linked world(5, links);
  EXPECT_EQ(treeNodes(world.view()), 5);
  EXPECT_EQ(world.view().treeNode[0].exact, 0);
}

TEST(JointTrees, TwoJointsBetweenTwoBodiesAreNotExact) {
  Links links = chainOf(3);
  links.emplace_back(1, 2);
  Linked world(3, links);
  EXPECT_EQ(treeNodes(world.view()), 3);
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
  EXPECT_EQ(treeNodes(world.view()), 0);
}

TEST(JointTrees, ALoneBodyIsOneIfAJointHoldsIt) {
  Linked world(4, {{2, kWorldBody}});
  ASSERT_EQ(treeNodes(world.view()), 1);
  EXPECT_EQ(world.view().treeNode[0].body, 2);
  EXPECT_EQ(world.view().treeNode[0].exact, 1);
}

/// Blocks of a chain with dominant diagonals.
void fillBlocks(const SolverData& s) {
  for (int n = 0; n < treeNodes(s); ++n) {
    TreeWork& w = s.treeWork[n];
    for (int i = 0; i < 6; ++i) {
      w.x.v[i] = 1 + .1 * n + i;
      for (int j = 0; j < 6; ++j) {
        w.h.m[i][j] = i == j ? 20 + n : .5;
        for (int t = 0; t < 2; ++t) w.e[t].m[i][j] = s.treeNode[n].parent[t] >= 0 ? .2 * (i + 1) - .1 * j : 0;
      }
    }
  }
}

TEST(JointTrees, ASmallTreeIsSolvedAtOnceAsByLevels) {
  Linked world(20, chainOf(20));
  const SolverData& s = world.view();
  ASSERT_TRUE(s.smallTrees);
  ASSERT_EQ(s.trees, 1);
  std::fill_n(s.treeConverged, treeNodes(s), 0);
  std::vector<Long6> wanted;
  fillBlocks(s);
  for (int r = 0; r < s.treeLevels; ++r)
    for (int n = s.treeBegin[r]; n < s.treeBegin[r + 1]; ++n) EliminateNode{0}(s, n);
  for (int r = s.treeLevels - 1; r >= 0; --r)
    for (int n = s.treeBegin[r]; n < s.treeBegin[r + 1]; ++n) SubstituteNode{0}(s, n);
  for (int n = 0; n < treeNodes(s); ++n) wanted.push_back(s.treeWork[n].x);
  fillBlocks(s);
  SolveTree{}(s, 0);
  for (int n = 0; n < treeNodes(s); ++n)
    for (int i = 0; i < 6; ++i)
      EXPECT_EQ(s.treeWork[n].x.v[i], wanted[static_cast<std::size_t>(n)].v[i]) << n;
}

/// Two chains whose bodies alternate in the order of elimination.
Links twoChains(int bodies) {
  Links links = chainOf(bodies / 2);
  links.emplace_back(bodies / 2, kWorldBody);
  for (int i = bodies / 2 + 1; i < bodies; ++i) links.emplace_back(i, i - 1);
  return links;
}

TEST(JointTrees, SmallOnesStepAsByLevels) {
  constexpr int kBodies = 20, kSteps = 10;
  Linked atOnce(kBodies, twoChains(kBodies)), inRounds(kBodies, twoChains(kBodies));
  ASSERT_EQ(atOnce.view().trees, 2);
  ASSERT_TRUE(atOnce.view().smallTrees);
  inRounds.view().smallTrees = 0;
  const Vec3d start = atOnce.view().position[kBodies - 1];
  for (Linked* world : {&atOnce, &inRounds})
    for (int k = 0; k < kSteps; ++k) {
      world->begin();
      step(world->executor());
    }
  for (int i = 0; i < kBodies; ++i) EXPECT_EQ(atOnce.view().position[i], inRounds.view().position[i]) << i;
  EXPECT_GT(length(atOnce.view().position[kBodies - 1] - start), .05);
}

TEST(JointTrees, SmallOnesAreClosedOneByOneAsAllTogether) {
  constexpr int kBodies = 20;
  Linked world(kBodies, twoChains(kBodies));
  const SolverData& s = world.view();
  ASSERT_EQ(s.trees, 2);
  world.begin();
  step(world.executor());
  // every third joint is open by a hundredth, beyond the step
  for (int i = 0; i < kBodies; i += 3) s.position[i].y += .01;
  const std::vector<Vec3d> opened(s.position, s.position + kBodies);
  std::fill_n(s.treeNeedsProjection, treeNodes(s), 0);
  const auto largestGap = [&] {
    Real largest = 0;
    for (int k = 0; k < kBodies; ++k) {
      FindTreesToProject<BallJoint>{}(s, k);
      largest = std::max(largest, length(s.treeRowsOf<BallJoint>()[k].gap));
    }
    return largest;
  };
  const auto moveAll = [&] {
    for (int n = 0; n < treeNodes(s); ++n) LimitProjection{}(s, n);
    for (int n = 0; n < treeNodes(s); ++n) ApplyProjection{}(s, n);
  };
  EXPECT_NEAR(largestGap(), .01, 1e-3);
  for (int n = 0; n < treeNodes(s); ++n) ASSERT_EQ(s.treeNeedsProjection[s.treeNode[n].tree], 1);
  for (int n = 0; n < treeNodes(s); ++n) AssembleLinks{}(s, n);
  for (int n = 0; n < treeNodes(s); ++n) EliminateLink{0}(s, n);
  for (int n = treeNodes(s) - 1; n >= 0; --n) SubstituteLink{0}(s, n);
  moveAll();
  const std::vector<Vec3d> wanted(s.position, s.position + kBodies);
  std::copy(opened.begin(), opened.end(), s.position);
  for (int tree = 0; tree < s.trees; ++tree) ProjectTree{}(s, tree);
  moveAll();
  for (int i = 0; i < kBodies; ++i) EXPECT_EQ(s.position[i], wanted[static_cast<std::size_t>(i)]) << i;
  EXPECT_LT(largestGap(), 1e-5);
}

TEST(JointTrees, OneThatHasHardlyTurnedRestsInTheSolvesThatFollow) {
  Linked world(3, chainOf(3));
  const SolverData& s = world.view();
  const int tree = s.treeNode[0].tree;
  const auto restsAfter = [&](Real turn, TreeSolve how, int touched) {
    s.treeContacts[tree] = touched;
    s.treeMaxRotation[tree] = floatBits(turn);
    for (int n = 0; n < treeNodes(s); ++n) BeginTrees{how, TreesOf::Any}(s, n);
    EXPECT_EQ(s.treeMaxRotation[tree], 0);
    return s.treeConverged[tree] != 0;
  };
  EXPECT_TRUE(restsAfter(Real(.01), TreeSolve::Again, 1)) << "no limits";
  for (int n = 0; n < treeNodes(s); ++n) s.treeNode[n].limited = true;
  EXPECT_TRUE(restsAfter(Real(.001), TreeSolve::Again, kHasContacts));
  EXPECT_FALSE(restsAfter(Real(.01), TreeSolve::Again, 1)) << "limits may have been passed";
  EXPECT_TRUE(restsAfter(Real(.01), TreeSolve::Again, kTouchesNothing)) << "solved exactly";
  EXPECT_FALSE(restsAfter(Real(0), TreeSolve::Own, kHasContacts));
  EXPECT_FALSE(restsAfter(Real(0), TreeSolve::Exact, 0));
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

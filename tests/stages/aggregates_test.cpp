/// Aggregates of the coarse correction: which nodes are roots, and how many slices an aggregate has.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "stages/coarse/aggregates.h"
#include "tests/support/core.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// Two bodies, one deformable object and one particle, at all levels.
struct Nodes {
  static constexpr int kBodies = 2, kSoftNodes = 2, kCount = kCoarseLevels * (kBodies + kSoftNodes);
  std::vector<int> count = std::vector<int>(kCount, 1), root = std::vector<int>(kCount),
                   of = std::vector<int>(kCount), index = std::vector<int>(kCount),
                   slices = std::vector<int>(kCount);
  SolverData view{};

  Nodes() {
    view.bodies = kBodies, view.softNodes = kSoftNodes, view.objects = 1;
    view.nodeCount = count.data(), view.isRoot = root.data(), view.aggregateOf = of.data();
    view.aggregateIndex = index.data(), view.aggregateSlices = slices.data();
  }
};

TEST(Aggregates, HaveTwoNodesOrAWholeDeformableObject) {
  Nodes nodes;
  constexpr int kObject = (kCoarseLevels - 1) * (Nodes::kBodies + Nodes::kSoftNodes) + Nodes::kBodies;
  for (int t = 0; t < Nodes::kCount; ++t) {
    FindRoots{}(nodes.view, t);
    EXPECT_EQ(nodes.root[static_cast<std::size_t>(t)], t == kObject) << t;
  }
  for (int& count : nodes.count) count = 2;
  for (int t = 0; t < Nodes::kCount; ++t) {
    FindRoots{}(nodes.view, t);
    EXPECT_TRUE(nodes.root[static_cast<std::size_t>(t)]) << t;
  }
}

TEST(Aggregates, HaveNoMoreSlicesThanTheirNodesFill) {
  Nodes nodes;
  nodes.root[0] = 1;
  for (const int count : {2, kSliceNodes - 1, kSliceNodes, kSliceNodes + 1, 2 * kSliceNodes}) {
    nodes.count[0] = count;
    nodes.of[0] = 0;
    NumberAggregates{}(nodes.view, 0);
    EXPECT_LT((nodes.slices[0] - 1) * kSliceNodes, count) << count;
    EXPECT_GE(nodes.slices[0] * kSliceNodes, count);
  }
}

// Two points have no size, and gravity may be so large that the square of a time step is nothing beside it.
TEST(Aggregates, CellsWithoutBoundAreShared) {
  BodyParams params[2] = {};
  Vec3d position[2] = {{0, 0, 0}, {1000, 2000, 3000}};
  StepConstants step{};
  SolverData view{};
  view.bodies = 2, view.params = params, view.position = position, view.step = &step;
  step.perFall = 360;
  EXPECT_EQ(finestSharedLevel(view, 0, 1), 0);
  params[0].radius = Real(0.01);
  EXPECT_EQ(finestSharedLevel(view, 0, 1), kCoarseLevels);
  for (const double perFall : {0., std::numeric_limits<double>::infinity()}) {
    step.perFall = perFall;
    EXPECT_EQ(finestSharedLevel(view, 0, 1), 0) << perFall;
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

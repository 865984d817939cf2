/// Parallel union-find.
#include <gtest/gtest.h>

#include <numeric>
#include <thread>
#include <vector>

#include "stages/coarse/forest.h"

namespace rubble::RUBBLE_CORE {
namespace {

struct Edge {
  int a, b;
};

std::vector<int> rootsOf(int nodes, const std::vector<Edge>& edges, int threads) {
  std::vector<int> root(static_cast<std::size_t>(nodes));
  std::iota(root.begin(), root.end(), 0);
  std::vector<std::thread> all;
  for (int t = 0; t < threads; ++t)
    all.emplace_back([&, t] {
      for (std::size_t i = static_cast<std::size_t>(t); i < edges.size();
           i += static_cast<std::size_t>(threads))
        unite(root.data(), edges[i].a, edges[i].b);
    });
  for (std::thread& one : all) one.join();
  std::vector<int> out;
  for (int i = 0; i < nodes; ++i) out.push_back(findRoot(root.data(), i));
  return out;
}

/// Built with -fsanitize=thread it also says that no thread reads a parent while another one writes it.
TEST(Forest, OfUnionsByManyThreadsHasTheRootsOfOne) {
  constexpr int kNodes = 2000, kEdges = 1800;
  std::vector<Edge> edges;
  unsigned state = 1;
  const auto next = [&] { return static_cast<int>((state = state * 1664525u + 1013904223u) >> 8) % kNodes; };
  for (int i = 0; i < kEdges; ++i) {
    const int a = next();
    edges.push_back({a, next()});
  }
  const std::vector<int> expected = rootsOf(kNodes, edges, 1);
  for (int run = 0; run < 10; ++run) EXPECT_EQ(rootsOf(kNodes, edges, 4), expected);
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE

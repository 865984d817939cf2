/// Nested clusters of the vertices of an object, by halving boxes.
#include <algorithm>

#include "forces/soft_model.h"

namespace rubble {

namespace {

struct Builder {
  SoftModel& model;

  /// Pieces of the members [begin, end) of at most `most` vertices, by cutting the longest side of their box in the middle of them.
  void cut(int begin, int end, int most, std::vector<std::pair<int, int>>& pieces) {
    if (end - begin <= most) {
      pieces.emplace_back(begin, end);
      return;
    }
    const auto at = [&](int v) -> const Vec3& { return model.vertices[std::size_t(v)].position; };
    Vec3 low = at(model.clusterOrder[std::size_t(begin)]), high = low;
    for (int k = begin; k < end; ++k)
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], at(model.clusterOrder[std::size_t(k)])[i]);
        high[i] = std::max(high[i], at(model.clusterOrder[std::size_t(k)])[i]);
      }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int middle = (begin + end) / 2;
    std::nth_element(model.clusterOrder.begin() + begin, model.clusterOrder.begin() + middle, model.clusterOrder.begin() + end, [&](int a, int b) {
      return at(a)[axis] != at(b)[axis] ? at(a)[axis] < at(b)[axis] : a < b;
    });
    cut(begin, middle, most, pieces);
    cut(middle, end, most, pieces);
  }

  void add(int level, int begin, int end, int parent) {
    const int own = int(model.clusters.size());
    model.clusters.push_back({level, begin, end, parent});
    if (level == 0) return;
    std::vector<std::pair<int, int>> pieces;
    cut(begin, end, SoftModel::kFinestCluster << (3 * (level - 1)), pieces);
    for (const auto& [a, b] : pieces) add(level - 1, a, b, own);
  }
};

}  // namespace

void makeClusters(SoftModel& model) {
  if (hasNoElements(model)) return;
  for (std::size_t v = 0; v < model.vertices.size(); ++v)
    if (model.vertices[v].mass > 0) model.clusterOrder.push_back(int(v));
  const int moving = int(model.clusterOrder.size());
  if (moving < 2) return;
  int level = 0;
  while (level < SoftModel::kClusterLevels - 1 && moving > SoftModel::kFinestCluster << (3 * level)) ++level;
  // the whole object is a cluster, whatever its size
  Builder{model}.add(level, 0, moving, -1);
}

}  // namespace rubble

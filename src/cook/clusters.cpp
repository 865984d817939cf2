/// Nested clusters of the vertices of an object, by recursive bisection of their bounding box.
#include "cook/halving.h"
#include "forces/soft_model.h"

namespace rubble {

namespace {

struct ClusterBuilder {
  SoftModel& model;

  void add(int level, int begin, int end, int parent) {
    const int own = int(model.clusters.size());
    model.clusters.push_back({level, begin, end, parent});
    if (level == 0) return;
    std::vector<std::pair<int, int>> pieces;
    const auto at = [&](int v) -> const Vec3& { return model.vertices[std::size_t(v)].position; };
    cutInHalves(model.clusterOrder, begin, end, SoftModel::kFinestCluster << (3 * (level - 1)), at,
                [&](int a, int b) { pieces.emplace_back(a, b); });
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
  // the coarsest cluster is the whole object, whatever its size
  ClusterBuilder{model}.add(level, 0, moving, -1);
}

}  // namespace rubble

/// Builds joint trees from authored joints: which bodies are eliminated at which level.
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "stages/joints/joints.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The graph of joints between dynamic bodies, and its elimination.
class Plan {
 public:
  explicit Plan(const SolverData& s)
      : s_(s), component_(at(s.bodies)), near_(at(s.bodies)), round_(at(s.bodies), -1) {
    std::iota(component_.begin(), component_.end(), 0);
    joined_.assign(at(s.bodies), 0), limited_.assign(at(s.bodies), 0), held_.assign(at(s.bodies), 0),
        grounded_.assign(at(s.bodies), 0), whole_.assign(at(s.bodies), 1);
    readJoints();
    eliminate();
  }
  void write(HostTables& tables);

 private:
  static constexpr std::size_t kMostNear = 2;

  bool dynamic(int body) const { return body != kWorldBody && s_.params[body].kind == BodyKind::Dynamic; }
  int root(int i) {
    while (component_[at(i)] != i) i = component_[at(i)] = component_[at(component_[at(i)])];
    return i;
  }
  void readJoints();
  void eliminate();
  void take(int body);
  static void listTrees(SolverData& s);

  const SolverData& s_;
  std::vector<int> component_;          ///< union-find over joints
  std::vector<std::vector<int>> near_;  ///< remaining neighbors; after elimination of a body: its parents
  std::vector<int> round_;              ///< level of elimination, -1: not eliminated
  std::vector<char> joined_;            ///< has a joint
  /// Per component: joints between two of its bodies, and joints to bodies that do not move.
  std::vector<int> held_, grounded_;
  std::vector<char> whole_;    ///< per component: all of its bodies are eliminated
  std::vector<int> order_;     ///< bodies by level
  std::vector<int> begin_;     ///< first body of each level
  std::vector<char> limited_;  ///< per component: a joint has limits
};

/// Returns whether the joint has limits that are neither free nor locked.
template <class F> bool hasLimits(const JointSpec<F>& spec) {
  bool found = false;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kAxis) {
      const AxisSpec& axis = partOf<I>(spec.parts);
      found |= axis.lo != axis.hi && (axis.lo > -kNoLimit || axis.hi < kNoLimit);
    }
  });
  return found;
}

void Plan::readJoints() {
  const auto link = [&](int a, int b) {
    std::vector<int>& list = near_[at(a)];
    if (std::find(list.begin(), list.end(), b) == list.end()) list.push_back(b);
  };
  std::vector<std::pair<int, int>> holding;
  forEachType(JointTypes{}, [&]<class F>() {
    for (int i = 0; i < s_.joints[typeIndex<F>(JointTypes{})]; ++i) {
      const JointSpec<F>& spec = s_.specsOf<F>()[i];
      const bool a = dynamic(spec.a), b = dynamic(spec.b);
      if (!spec.alive) continue;
      const bool limits = hasLimits<F>(spec);
      if (spec.isRigid && (a || b)) holding.emplace_back(a ? spec.a : spec.b, a && b);
      for (int side = 0; side < kSides<F>; ++side) {
        const int body = bodyOf(spec, side);
        if (!dynamic(body)) continue;
        joined_[at(body)] = 1;
        limited_[at(body)] |= limits;
        for (int k = 0; k < side; ++k) {
          const int other = bodyOf(spec, k);
          if (!dynamic(other) || other == body) continue;
          component_[at(std::max(root(other), root(body)))] = std::min(root(other), root(body));
          link(other, body), link(body, other);
        }
      }
    }
  });
  for (int i = 0; i < s_.bodies; ++i)
    if (limited_[at(i)]) limited_[at(root(i))] = 1;
  for (const auto& [body, both] : holding) ++(both ? held_ : grounded_)[at(root(body))];
}

/// Eliminates a body: its neighbors become neighbors of one another.
void Plan::take(int body) {
  const std::vector<int>& own = near_[at(body)];
  for (const int other : own) {
    std::vector<int>& list = near_[at(other)];
    list.erase(std::find(list.begin(), list.end(), body));
    for (const int third : own)
      if (third != other && std::find(list.begin(), list.end(), third) == list.end()) list.push_back(third);
  }
}

/// Eliminates, at each level, an independent set of bodies with at most two neighbors.
void Plan::eliminate() {
  std::vector<int> left;
  for (int i = 0; i < s_.bodies; ++i)
    if (joined_[at(i)] && dynamic(i)) left.push_back(i);
  std::vector<int> blocked(at(s_.bodies), -1);
  for (int r = 0; r < kTreeLevels && !left.empty(); ++r) {
    const std::size_t first = order_.size();
    for (const int i : left) {
      if (near_[at(i)].size() > kMostNear || blocked[at(i)] == r) continue;
      for (const int other : near_[at(i)]) blocked[at(other)] = r;
      round_[at(i)] = r;
      order_.push_back(i);
    }
    if (order_.size() == first) break;
    begin_.push_back(static_cast<int>(first));
    for (std::size_t k = first; k < order_.size(); ++k) take(order_[k]);
    std::erase_if(left, [&](int i) { return round_[at(i)] >= 0; });
  }
  for (const int i : left) whole_[at(root(i))] = 0;
}

void Plan::write(HostTables& tables) {
  SolverData& s = tables.view();
  std::vector<int> bodiesOf(at(s.bodies), 0);
  for (int i = 0; i < s.bodies; ++i)
    if (joined_[at(i)] && dynamic(i)) ++bodiesOf[at(root(i))];
  // a body without tree neighbors is solved by its own block as well, unless a joint connects it to a static
  // body
  const auto useful = [&](int i) {
    const std::size_t c = at(root(i));
    return whole_[c] && (bodiesOf[c] > 1 || grounded_[c] == 1);
  };
  const auto exact = [&](int i) {
    const std::size_t c = at(root(i));
    return whole_[c] && held_[c] <= bodiesOf[c] - 1 && grounded_[c] <= 1;
  };

  std::fill_n(s.nodeOfBody, s.bodies, -1);
  std::vector<int> kept;
  s.treeLimits = 0;
  s.treeLevels = static_cast<int>(begin_.size());
  begin_.push_back(static_cast<int>(order_.size()));
  for (int r = 0; r < kTreeLevels; ++r) {
    s.treeBegin[r] = static_cast<int>(kept.size());
    if (r >= s.treeLevels) continue;
    for (int k = begin_[at(r)]; k < begin_[at(r + 1)]; ++k)
      if (useful(order_[at(k)])) kept.push_back(order_[at(k)]);
  }
  s.treeBegin[kTreeLevels] = static_cast<int>(kept.size());
  for (std::size_t n = 0; n < kept.size(); ++n) s.nodeOfBody[kept[n]] = static_cast<int>(n);

  std::vector<std::vector<int>> sources(kept.size());
  for (std::size_t n = 0; n < kept.size(); ++n) {
    const std::vector<int>& parent = near_[at(kept[n])];
    for (std::size_t side = 0; side < parent.size(); ++side)
      if (const int to = s.nodeOfBody[parent[side]]; to >= 0)
        sources[at(to)].push_back(static_cast<int>(2 * n + side));
  }
  tables.reserve(Per::TreeNode, static_cast<int>(kept.size()));
  std::size_t total = 0;
  for (const std::vector<int>& list : sources) total += list.size();
  tables.reserve(Per::TreeChild, static_cast<int>(total));
  s.treeChildren = 0;
  for (std::size_t n = 0; n < kept.size(); ++n) {
    const int body = kept[n];
    TreeNode node{body,        s.nodeOfBody[root(body)], {-1, -1}, s.treeChildren, 0,
                  exact(body), limited_[at(root(body))]};
    s.treeLimits |= node.limited;
    const std::vector<int>& parent = near_[at(body)];
    for (std::size_t side = 0; side < parent.size(); ++side) node.parent[side] = s.nodeOfBody[parent[side]];
    for (const int child : sources[n]) s.treeChild[s.treeChildren++] = child;
    node.childEnd = s.treeChildren;
    s.treeNode[n] = node;
  }
  listTrees(s);
}

/// Lists the nodes of each tree.
void Plan::listTrees(SolverData& s) {
  const int nodes = treeNodes(s);
  std::vector<std::vector<int>> lists(at(nodes));
  for (int n = 0; n < nodes; ++n) lists[at(s.treeNode[n].tree)].push_back(n);
  std::erase_if(lists, [](const std::vector<int>& list) { return list.empty(); });
  s.trees = static_cast<int>(lists.size());
  s.smallTrees = std::all_of(lists.begin(), lists.end(),
                             [](const std::vector<int>& list) { return list.size() <= at(kSmallTree); });
  int* to = s.treeMember;
  for (std::size_t k = 0; k < lists.size(); ++k) {
    s.treeOffset[k] = static_cast<int>(to - s.treeMember);
    to = std::copy(lists[k].begin(), lists[k].end(), to);
  }
  std::fill(s.treeOffset + s.trees, s.treeOffset + nodes + 1, nodes);
}

}  // namespace

bool planTrees(HostTables& tables) {
  if (!tables.treesStale) return false;
  Plan(tables.view()).write(tables);
  tables.treesStale = false;
  return true;
}

}  // namespace rubble::RUBBLE_CORE

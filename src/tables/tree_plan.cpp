#include "tables/tree_plan.h"

#include <algorithm>
#include <utility>

#include "stages/joints/joints.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool isDynamicBody(const SolverData& s, int body) {
  return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic;
}

JointLinks linksOf(const SolverData& s, JointRef joint) {
  JointLinks links;
  forEachType(JointTypes{}, [&]<class F>() {
    if (typeIndex<F>(JointTypes{}) == joint.type) links = linksOf<F>(s.specsOf<F>()[joint.slot]);
  });
  return links;
}

/// The order in which the bodies of a component are eliminated. Bodies are indices in the component.
class Elimination {
 public:
  /// `indexOf`: index in the component of each of its bodies.
  Elimination(const SolverData& s, const JointedBodies& component, const std::vector<int>& indexOf)
      : neighbors_(component.bodies.size()), levelOf_(component.bodies.size(), -1) {
    for (const JointRef joint : component.joints) link(s, linksOf(s, joint), indexOf);
    eliminate();
  }

  /// false: some body keeps too many neighbors, and all are left to other solvers.
  bool complete() const { return complete_; }
  /// The bodies by level.
  const std::vector<int>& order() const { return order_; }
  int levelOf(int body) const { return levelOf_[at(body)]; }
  /// The bodies that a body is coupled to when it is eliminated.
  const std::vector<int>& parentsOf(int body) const { return neighbors_[at(body)]; }
  /// Returns whether its joints close no loop, not even through the world.
  bool exact() const { return rigid_ < static_cast<int>(levelOf_.size()) && grounded_ <= 1; }
  bool limited() const { return limited_; }
  /// A body without neighbors is solved by its own block as well, unless a joint connects it to a body that
  /// does not move.
  bool useful() const { return levelOf_.size() > 1 || grounded_ == 1; }

 private:
  static constexpr std::size_t kMostNeighbors = 2;

  void link(const SolverData& s, const JointLinks& links, const std::vector<int>& indexOf) {
    const auto add = [&](int a, int b) {
      std::vector<int>& list = neighbors_[at(a)];
      if (std::find(list.begin(), list.end(), b) == list.end()) list.push_back(b);
    };
    limited_ |= links.limited;
    const bool movesA = isDynamicBody(s, links.body[0]), movesB = isDynamicBody(s, links.body[1]);
    if (links.isRigid && (movesA || movesB)) ++(movesA && movesB ? rigid_ : grounded_);
    for (int side = 0; side < JointGraph::kMostSides; ++side)
      for (int k = 0; k < side; ++k) {
        const int body = links.body[side], other = links.body[k];
        if (!isDynamicBody(s, body) || !isDynamicBody(s, other) || other == body) continue;
        add(indexOf[at(other)], indexOf[at(body)]), add(indexOf[at(body)], indexOf[at(other)]);
      }
  }

  /// Eliminates a body: its neighbors become neighbors of one another.
  void take(int body) {
    const std::vector<int>& own = neighbors_[at(body)];
    for (const int other : own) {
      std::vector<int>& list = neighbors_[at(other)];
      list.erase(std::find(list.begin(), list.end(), body));
      for (const int third : own)
        if (third != other && std::find(list.begin(), list.end(), third) == list.end()) list.push_back(third);
    }
  }

  /// Eliminates, at each level, an independent set of bodies with at most two neighbors.
  void eliminate() {
    std::vector<int> left(levelOf_.size()), blocked(levelOf_.size(), -1);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
    for (int level = 0; level < kTreeLevels && !left.empty(); ++level) {
      const std::size_t first = order_.size();
      for (const int i : left) {
        if (neighbors_[at(i)].size() > kMostNeighbors || blocked[at(i)] == level) continue;
        for (const int other : neighbors_[at(i)]) blocked[at(other)] = level;
        levelOf_[at(i)] = level;
        order_.push_back(i);
      }
      if (order_.size() == first) break;
      for (std::size_t k = first; k < order_.size(); ++k) take(order_[k]);
      std::erase_if(left, [&](int i) { return levelOf_[at(i)] >= 0; });
    }
    complete_ = left.empty();
  }

  std::vector<std::vector<int>> neighbors_;  ///< those left; of an eliminated body: its parents
  std::vector<int> levelOf_;
  std::vector<int> order_;
  int rigid_ = 0, grounded_ = 0;  ///< rigid joints of two of its bodies, and with a body that does not move
  bool limited_ = false, complete_ = false;
};

constexpr TreeNode emptyNode(int n) { return {-1, n, {-1, -1}, 0, 0, 0, 0, 0}; }

}  // namespace

void TreePlan::link(JointRef joint, const JointLinks& links) {
  for (int side = 0; side < JointGraph::kMostSides; ++side)
    if (links.body[side] != kWorldBody) joints_.add(joint, side, links.body[side]);
}

void TreePlan::touch(int body) noexcept {
  if (all_) return;
  try {
    touched_.push_back(body);
  } catch (const std::bad_alloc&) {
    touchAll();
  }
}

void TreePlan::relink(JointRef joint, const JointLinks& before, const JointLinks& after) noexcept {
  // the lists are read anew with everything else
  if (before == after || all_) return;
  try {
    for (int side = 0; side < JointGraph::kMostSides; ++side) joints_.remove(joint, side);
    link(joint, after);
  } catch (const std::bad_alloc&) {
    touchAll();
  }
  for (const JointLinks& links : {before, after})
    for (const int body : links.body)
      if (body != kWorldBody) touch(body);
}

void TreePlan::readJoints(const SolverData& s) {
  joints_.clear();
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    for (int i = 0; i < s.joints[kType]; ++i) link({kType, i}, linksOf<F>(s.specsOf<F>()[i]));
  });
}

/// Dissolves the tree of a body, and adds its bodies to those that were touched.
void TreePlan::release(SolverData& s, int body, std::vector<int>& touched, TreeChanges& changes) {
  const int node = s.nodeOfBody[body];
  if (node < 0) return;
  int begin = s.treeNode[node].tree;
  const Tree tree = trees_.at(begin);
  trees_.erase(begin);
  limited_ -= s.treeNode[node].limited;
  for (int n = begin; n < tree.end; ++n) {
    touched.push_back(s.treeNode[n].body);
    s.nodeOfBody[s.treeNode[n].body] = -1;
    changes.bodies.push_back(s.treeNode[n].body);
    s.treeNode[n] = emptyNode(n);
    changes.nodes.push_back(n);
  }
  if (tree.small >= 0) {
    s.smallTree[tree.small] = {0, 0};
    changes.smallTrees.push_back(tree.small);
    freeSmall_.push_back(tree.small);
  }
  changes.levels |= tree.small < 0;
  // joins free nodes on both sides
  int end = tree.end;
  if (const auto after = free_.find(end); after != free_.end()) end = after->second, free_.erase(after);
  if (auto before = free_.lower_bound(begin); before != free_.begin() && (--before)->second == begin)
    begin = before->first;
  free_[begin] = end;
}

/// Returns the first of that many consecutive free nodes.
int TreePlan::allocate(HostTables& tables, int nodes, TreeChanges& changes) {
  for (auto range = free_.begin(); range != free_.end(); ++range) {
    const auto [begin, end] = *range;
    if (end - begin < nodes) continue;
    free_.erase(range);
    if (begin + nodes < end) free_[begin + nodes] = end;
    return begin;
  }
  const int begin = nodesEnd_;
  nodesEnd_ += nodes;
  SolverData& s = tables.view();
  if (const int slots = slotsFor(nodesEnd_); slots > s.treeNodes) {
    tables.reserve(Per::TreeNode, slots);
    tables.reserve(Per::TreeChild, 2 * tables.capacity(Per::TreeNode));
    for (int n = s.treeNodes; n < slots; ++n) s.treeNode[n] = emptyNode(n), changes.nodes.push_back(n);
    s.treeNodes = slots;
  }
  return begin;
}

int TreePlan::listSmall(HostTables& tables, int begin, int end, TreeChanges& changes) {
  int place = smallEnd_;
  if (!freeSmall_.empty())
    place = freeSmall_.back(), freeSmall_.pop_back();
  else
    ++smallEnd_;
  SolverData& s = tables.view();
  if (const int slots = slotsFor(smallEnd_); slots > s.smallTrees) {
    tables.reserve(Per::SmallTree, slots);
    for (int k = s.smallTrees; k < slots; ++k) s.smallTree[k] = {0, 0}, changes.smallTrees.push_back(k);
    s.smallTrees = slots;
  }
  s.smallTree[place] = {begin, end};
  changes.smallTrees.push_back(place);
  return place;
}

/// Lists the nodes of all large trees by level.
void TreePlan::listLevels(HostTables& tables) {
  SolverData& s = tables.view();
  std::vector<std::vector<int>> levels;
  for (const auto& [begin, tree] : trees_) {
    if (tree.small >= 0) continue;
    for (int n = begin; n < tree.end; ++n) {
      const std::size_t level = at(s.nodeLevel[n]);
      if (level >= levels.size()) levels.resize(level + 1);
      levels[level].push_back(n);
    }
  }
  int count = 0;
  s.treeLevels = static_cast<int>(levels.size());
  for (int r = 0; r <= kTreeLevels; ++r) {
    s.levelBegin[r] = count;
    if (r >= s.treeLevels) continue;
    std::copy(levels[at(r)].begin(), levels[at(r)].end(), s.levelNode + count);
    count += static_cast<int>(levels[at(r)].size());
  }
}

/// Writes the tree of a component, if it is one.
void TreePlan::plan(HostTables& tables, JointedBodies& c, TreeChanges& changes) {
  std::sort(c.bodies.begin(), c.bodies.end());
  std::sort(c.joints.begin(), c.joints.end());
  c.joints.erase(std::unique(c.joints.begin(), c.joints.end()), c.joints.end());
  for (std::size_t k = 0; k < c.bodies.size(); ++k) indexOf_[at(c.bodies[k])] = static_cast<int>(k);
  const Elimination order(tables.view(), c, indexOf_);
  if (!order.complete() || !order.useful()) return;

  const int count = static_cast<int>(c.bodies.size()), begin = allocate(tables, count, changes),
            end = begin + count;
  const bool small = count <= kSmallTree;
  trees_[begin] = {end, small ? listSmall(tables, begin, end, changes) : -1};
  changes.levels |= !small;
  limited_ += order.limited();
  SolverData& s = tables.view();
  std::vector<int> nodeOf(at(count));
  std::vector<std::vector<int>> children(at(count));
  for (int k = 0; k < count; ++k) nodeOf[at(order.order()[at(k)])] = begin + k;
  for (int n = begin; n < end; ++n) {
    const int body = order.order()[at(n - begin)];
    TreeNode node = emptyNode(n);
    node.body = c.bodies[at(body)], node.tree = begin;
    node.exact = order.exact(), node.limited = order.limited(), node.large = !small;
    const std::vector<int>& parents = order.parentsOf(body);
    for (std::size_t side = 0; side < parents.size(); ++side) {
      node.parent[side] = nodeOf[at(parents[side])];
      children[at(node.parent[side] - begin)].push_back(2 * n + static_cast<int>(side));
    }
    s.treeNode[n] = node;
    s.nodeLevel[n] = order.levelOf(body);
    s.nodeOfBody[node.body] = n;
    changes.nodes.push_back(n), changes.bodies.push_back(node.body);
  }
  for (int n = begin, next = 2 * begin; n < end; ++n) {
    s.treeNode[n].childBegin = next;
    for (const int child : children[at(n - begin)]) s.treeChild[next++] = child;
    s.treeNode[n].childEnd = next;
  }
}

bool TreePlan::update(HostTables& tables, TreeChanges& changes) {
  if (!all_ && touched_.empty()) return false;
  SolverData& s = tables.view();
  std::vector<int> touched = std::exchange(touched_, {});
  // until the end: a plan that runs out of memory is made anew
  if (std::exchange(all_, true)) {
    readJoints(s);
    indexOf_.clear();
    trees_.clear(), free_.clear(), freeSmall_.clear();
    nodesEnd_ = smallEnd_ = limited_ = s.treeNodes = s.smallTrees = 0;
    std::ranges::fill(firstOf(s.nodeOfBody, s.bodies), -1);
    touched.clear();
    for (int i = 0; i < s.bodies; ++i)
      if (joints_.hasJoints(i)) touched.push_back(i);
    changes.levels = changes.all = true;
  }
  std::vector<int> planned;
  // a touched tree touches all of its bodies
  for (std::size_t k = 0; k < touched.size(); ++k) release(s, touched[k], touched, changes);

  indexOf_.resize(at(s.bodies), -1);
  for (std::size_t t = 0; t < touched.size(); ++t) {
    if (!isDynamicBody(s, touched[t]) || indexOf_[at(touched[t])] >= 0 || !joints_.hasJoints(touched[t]))
      continue;
    JointedBodies c;
    const auto enter = [&](int body) {
      if (!isDynamicBody(s, body) || indexOf_[at(body)] >= 0) return;
      release(s, body, touched, changes);
      indexOf_[at(body)] = 0;
      c.bodies.push_back(body);
    };
    enter(touched[t]);
    for (std::size_t k = 0; k < c.bodies.size(); ++k)
      joints_.forEachJoint(c.bodies[k], [&](JointRef joint) {
        c.joints.push_back(joint);
        for (const int body : linksOf(s, joint).body) enter(body);
      });
    planned.insert(planned.end(), c.bodies.begin(), c.bodies.end());
    plan(tables, c, changes);
  }
  for (const int body : planned) indexOf_[at(body)] = -1;
  if (changes.levels) listLevels(tables);
  s.treeLimits = limited_ > 0;
  all_ = false;
  return true;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Joint trees in the tables: which bodies one direct solve covers, and the order of their elimination
/// (stages/trees/trees.h). An edit of a joint plans the trees of its bodies anew and leaves all others.
#include <map>
#include <vector>

#include "state/solver_data.h"
#include "tables/joint_graph.h"

namespace rubble::RUBBLE_CORE {

struct HostTables;

/// What the trees depend on of a joint.
struct JointLinks {
  int body[JointGraph::kMostSides] = {kWorldBody, kWorldBody, kWorldBody, kWorldBody};
  bool isRigid = false;  ///< rigidly connects its bodies
  bool limited = false;  ///< has limits that are neither free nor locked
  bool operator==(const JointLinks&) const = default;
};
template <class F> JointLinks linksOf(const JointSpec<F>& spec) {
  JointLinks links;
  if (!spec.alive) return links;
  for (int side = 0; side < kSides<F>; ++side) links.body[side] = bodyOf(spec, side);
  links.isRigid = spec.isRigid;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kAxis) {
      const AxisSpec& axis = partOf<I>(spec.parts);
      links.limited |= axis.lo != axis.hi && (axis.lo > -kNoLimit || axis.hi < kNoLimit);
    }
  });
  return links;
}

/// Elements of the derived arrays that a plan has written.
struct TreeChanges {
  std::vector<int> bodies, nodes, smallTrees;
  bool levels = false;  ///< levelNode as a whole
  bool all = false;     ///< every element of all of them
};

/// Dynamic bodies connected by joints, and these joints.
struct JointedBodies {
  std::vector<int> bodies;
  std::vector<JointRef> joints;
};

/// What only the planner needs to know of the trees in the tables.
class TreePlan {
 public:
  // Edits need no memory: where there is none, everything is planned anew.
  /// A body or the joints of a body have changed.
  void touch(int body) noexcept;
  /// All bodies and joints may have changed.
  void touchAll() noexcept { all_ = true; }
  /// A joint has changed.
  void relink(JointRef joint, const JointLinks& before, const JointLinks& after) noexcept;

  /// Plans what was touched, and adds to the changes. Returns whether anything was. After std::bad_alloc the
  /// next call plans everything.
  bool update(HostTables& tables, TreeChanges& changes);

 private:
  struct Tree {
    int end;
    int small;  ///< its element of smallTree; -1: solved level by level
  };

  void link(JointRef joint, const JointLinks& links);
  void readJoints(const SolverData& s);
  void release(SolverData& s, int body, std::vector<int>& touched, TreeChanges& changes);
  void plan(HostTables& tables, JointedBodies& component, TreeChanges& changes);
  int allocate(HostTables& tables, int nodes, TreeChanges& changes);
  int listSmall(HostTables& tables, int begin, int end, TreeChanges& changes);
  void listLevels(HostTables& tables);

  JointGraph joints_;
  std::vector<int> touched_;
  bool all_ = true;
  std::map<int, Tree> trees_;  ///< by first node
  std::map<int, int> free_;    ///< free nodes: begin, end
  std::vector<int> freeSmall_;
  std::vector<int> indexOf_;  ///< index of a body in its component while that is planned, else -1
  int nodesEnd_ = 0, smallEnd_ = 0, limited_ = 0;
};

}  // namespace rubble::RUBBLE_CORE

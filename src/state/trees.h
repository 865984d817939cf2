#pragma once
/// Joint trees: the bodies that one direct solve covers, and their elimination order (stages/trees/trees.h).
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Most elimination levels. A chain of N bodies takes log2 N. Bodies beyond the last level stay with the
/// block solver.
inline constexpr int kTreeLevels = 64;

/// A tree of up to this many bodies is solved as a whole, a larger one level by level.
inline constexpr int kSmallTree = 64;

/// A body in elimination order. The nodes of a tree are consecutive and sorted by level.
struct TreeNode {
  int body;                  ///< -1: an empty slot
  int tree;                  ///< first node of its tree
  int parent[2];             ///< nodes that it is coupled to when it is eliminated; -1: none
  int childBegin, childEnd;  ///< range in treeChild: nodes eliminated earlier that update this one
  int exact;    ///< 1: its joints close no loop, not even through the world, and its whole tree is eliminated
  int limited;  ///< 1: a joint of its tree has limits
  int large;    ///< 1: its tree is solved level by level
};

/// The nodes of a tree that one block solves as a whole. An empty slot has none.
struct SmallTree {
  int begin, end;
};

/// What touches a tree in a step: nothing, contacts of its bodies, or vertices attached to them.
inline constexpr int kTouchesNothing = 0, kHasContacts = 1, kHoldsVertices = 2;

/// Block row of the tree's Hessian for one node.
struct TreeBlock {
  Dense6 h;     ///< lower triangle of the diagonal block, then its LDL^T factors
  Dense6 e[2];  ///< off-diagonal blocks (this, parent)
  Long6 x;      ///< force, then H^-1 f, then the Newton step of the body
};
/// TreeBlock with the eliminated couplings.
struct TreeWork : TreeBlock {
  Dense6 w[2];  ///< H^-1 e
};

/// The same system for translations alone, isotropic (stages/trees/joint_projection.h).
struct ProjectionLink {
  double h;     ///< diagonal [kg]
  double e[2];  ///< off-diagonals (this, parent)
  double w[2];  ///< e / h
  Vec3d x;      ///< right-hand side, then the displacement of the body [m]
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Trees of joints: which bodies are solved together, and in which order (stages/trees/trees.h).
#include "solver/dense6.h"

namespace rubble::RUBBLE_CORE {

/// Rounds of elimination at most: a chain of N bodies takes log2 N. Bodies that would come later are left to
/// the other blocks.
inline constexpr int kTreeLevels = 64;

/// A world whose trees are no larger has each of them solved at once, and not round by round.
inline constexpr int kSmallTree = 64;

/// A body in the order of elimination.
struct TreeNode {
  int body;
  int tree;                  ///< a number below that of nodes
  int parent[2];             ///< nodes that it is coupled to when it is eliminated, -1: none
  int childBegin, childEnd;  ///< nodes eliminated before that pass something on to it
  int exact;    ///< 1: its joints close no loop, with the world neither, and all of its tree is eliminated
  int limited;  ///< 1: a joint of its tree has limits
};

/// What touches a tree in a step: contacts of its bodies, or vertices that are attached to them.
inline constexpr int kTouchesNothing = 0, kHasContacts = 1, kHoldsVertices = 2;

/// Its block.
struct TreeBlock {
  Dense6 h;     ///< lower triangle of the Hessian, then its factors
  Dense6 e[2];  ///< block (this, parent) of the Hessian
  Long6 x;      ///< force, then H^-1 f, then the step of the body
};
/// And what becomes of it.
struct TreeWork : TreeBlock {
  Dense6 w[2];  ///< H^-1 e
};

/// The same for its translation alone, in all axes alike (stages/trees/joint_projection.h).
struct ProjectionLink {
  double h;     ///< diagonal [kg]
  double e[2];  ///< beside it (this, parent)
  double w[2];  ///< e / h
  Vec3d x;      ///< right side, then the motion of the body [m]
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The mass matrix of a tree of links in the pose of the file: M of the kinetic energy v^T M v / 2, v the
/// rates of all degrees of freedom, with armatures on its diagonal.
#include <map>
#include <utility>
#include <vector>

#include "convert/model.h"

namespace rubble::convert {

/// Rate of a length by those of degrees of freedom: pairs of a (link, index in its dofs) and its factor.
using Moments = std::vector<std::pair<std::pair<int, int>, double>>;

class MassMatrix {
 public:
  /// Of the tree that a link belongs to: all links above and below those that are not fixed to the world.
  MassMatrix(const Model& model, int link);

  /// M of a hinge or slide [kg], [kg m2].
  double diagonal(const std::pair<int, int>& dof) const;
  /// a = M^-1 J^T, rates by a unit impulse along J: of all degrees of freedom, those of free links included.
  /// Empty if M is singular or has more than kMost rows.
  std::vector<double> response(const Moments& moments) const;
  /// 1 / (J M^-1 J^T), the mass that a force along J accelerates; 0 where there is no response.
  double effective(const Moments& moments) const;

  static constexpr std::size_t kMost = 1000;

 private:
  /// A motion: angular velocity, and the velocity of the origin of the world.
  struct Twist {
    Vec3 w, v;
    int link;
    double armature;
  };
  void addTwists(const Model& model, int link, const Pose& pose);
  void factor();

  std::vector<Twist> twists_;
  std::map<std::pair<int, int>, std::size_t> rows_;  ///< first row of each dof
  std::vector<double> matrix_, factor_;              ///< n x n; lower triangle of L with M = L L^T
};

}  // namespace rubble::convert

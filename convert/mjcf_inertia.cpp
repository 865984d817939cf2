/// Masses that forces along coordinates accelerate, and what is given by them.
#include <cmath>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

const MassMatrix& MjcfReader::massMatrix(int at) {
  int top = at;
  for (int i = at; i > 0; i = model_.links[static_cast<std::size_t>(i)].parent)
    if (link(i).moves()) top = i;
  const auto found = massMatrices_.find(top);
  return found != massMatrices_.end() ? found->second
                                      : massMatrices_.emplace(top, MassMatrix(model_, top)).first->second;
}

double MjcfReader::massSeen(const Moments& moments) {
  double inverse = 0;  // trees do not share degrees of freedom
  std::map<const MassMatrix*, Moments> trees;
  for (const auto& moment : moments) trees[&massMatrix(moment.first.first)].push_back(moment);
  for (const auto& [matrix, own] : trees) {
    const double mass = matrix->effective(own);
    if (mass > 0) inverse += 1 / mass;
  }
  return inverse > 0 ? 1 / inverse : 0;
}

double MjcfReader::responseTo(const Moments& moments) {
  double square = 0;
  std::map<const MassMatrix*, Moments> trees;
  for (const auto& moment : moments) trees[&massMatrix(moment.first.first)].push_back(moment);
  for (const auto& [matrix, own] : trees)
    for (const double rate : matrix->response(own)) square += rate * rate;
  return std::sqrt(square);
}

void MjcfReader::finishSpringDampers() {
  for (const auto& [at, given] : springDampers_) {
    Dof& own = dof(at);
    const double inertia = massSeen({{at, 1}});
    if (!(inertia > 0))
      report_.note(Effect::Lost, own.place, "joint.springdamper",
                   "of a tree of more than " + std::to_string(MassMatrix::kMost) +
                       " degrees of freedom, or one without mass");
    if (compiler_.springs) {
      const double rest = own.drive.stiffnessTarget;
      own.drive.stiffness = inertia / (given[0] * given[0] * given[1] * given[1]);
      own.drive.stiffnessTarget = own.drive.stiffness * rest;
    }
    if (compiler_.dampers) own.damping = 2 * inertia / given[0];
  }
  for (const auto& [at, soft] : softLimits_) {
    const double mass = massSeen({{at, 1}});
    if (!(mass > 0)) continue;
    dof(at).limitStiffness = soft.stiffness * mass, dof(at).limitDamping = soft.damping(mass);
  }
}

}  // namespace rubble::convert

/// Inertias that coordinates see, and what is given by them.
#include <vector>

#include "convert/mjcf_reader.h"

namespace rubble::convert {

double MjcfReader::inertiaSeen(const std::pair<int, int>& at) const {
  const std::size_t count = model_.links.size(), own = static_cast<std::size_t>(at.first);
  const Link& link = model_.links[own];
  const Dof& dof = link.dofs[static_cast<std::size_t>(at.second)];
  // all that hangs on the link, in its frame
  std::vector<bool> below(count);
  std::vector<Pose> pose(count);
  SolidSums sums;
  for (std::size_t i = own; i < count; ++i) {
    const auto parent = static_cast<std::size_t>(model_.links[i].parent);
    below[i] = i == own || (i > own && model_.links[i].parent >= 0 && below[parent]);
    if (!below[i]) continue;
    if (i != own) pose[i] = pose[parent] * model_.links[i].pose;
    sums += placed(model_.links[i].mass, pose[i].p, pose[i].q, 1);
  }
  if (dof.type == DofType::Slide) return sums.volume + dof.armature;
  const SolidSums about = placed(sums, -dof.anchor, {}, 1);
  const std::array<double, 6>& s = about.second;
  const Vec3& a = dof.axis;
  const double along = s[0] * a.x * a.x + s[1] * a.y * a.y + s[2] * a.z * a.z +
                       2 * (s[3] * a.x * a.y + s[4] * a.x * a.z + s[5] * a.y * a.z);
  return s[0] + s[1] + s[2] - along + dof.armature;
}

void MjcfReader::finishSpringDampers() {
  for (const auto& [at, given] : springDampers_) {
    Dof& own = dof(at);
    const double inertia = inertiaSeen(at);
    if (compiler_.springs) {
      const double rest = own.drive.stiffnessTarget;
      own.drive.stiffness = inertia / (given[0] * given[0] * given[1] * given[1]);
      own.drive.stiffnessTarget = own.drive.stiffness * rest;
    }
    if (compiler_.dampers) own.damping = 2 * inertia / given[0];
  }
}

}  // namespace rubble::convert

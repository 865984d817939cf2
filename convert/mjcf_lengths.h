#pragma once
/// Poses of links and lengths of tendons away from the pose of the file.
#include "convert/mjcf_reader.h"
#include "forces/tendon_wrap.h"

namespace rubble::convert {

template <class Change> Pose MjcfReader::poseWith(int at, Change&& change) const {
  Pose out;
  for (; at >= 0; at = model_.links[static_cast<std::size_t>(at)].parent) {
    const Link& link = model_.links[static_cast<std::size_t>(at)];
    Pose motion;
    for (std::size_t k = 0; k < link.dofs.size(); ++k) {
      const Dof& dof = link.dofs[k];
      const double by = dof.type == DofType::Ball ? 0 : change(std::pair{at, static_cast<int>(k)});
      if (by == 0) continue;
      const Quat turn = dof.type == DofType::Hinge ? fromAxisAngle(dof.axis, by) : Quat{};
      motion = motion * (dof.type == DofType::Slide ? Pose{by * dof.axis, {}}
                                                    : Pose{dof.anchor - rotate(turn, dof.anchor), turn});
    }
    out = link.pose * motion * out;
  }
  return out;
}

template <class PoseOf, class At>
double MjcfReader::lengthOf(const Tendon& tendon, PoseOf&& poseOf, At&& coordinateOf) const {
  double sum = 0;
  const auto at = [&](std::size_t i) { return poseOf(tendon.path[i].link) * tendon.path[i].at; };
  for (std::size_t i = 0; i + 1 < tendon.path.size(); ++i)
    sum += tendon.path[i].weight * length(at(i + 1) - at(i));
  for (const Tendon::Wrap& wrap : tendon.wraps) {
    const Pose body = poseOf(wrap.link);
    const Vec3 center = body * wrap.center, guide = rotate(body.q, wrap.guide.value_or(Vec3{})),
               from = at(wrap.point) - center, to = at(wrap.point + 1) - center;
    const auto arc = host::wrapAround(from, to, rotate(body.q, wrap.axis), wrap.radius,
                                      wrap.guide ? &guide : nullptr);
    if (arc.touches)
      sum += tendon.path[wrap.point].weight *
             (length(arc.begin - from) + arc.length + length(to - arc.end) - length(to - from));
  }
  for (const Tendon::Term& term : tendon.terms) sum += term.coefficient * coordinateOf(term.dof);
  return sum;
}

}  // namespace rubble::convert

#include "convert/mass_matrix.h"

#include <algorithm>
#include <cmath>

namespace rubble::convert {
namespace {

Vec3 unit(int k) { return {k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.}; }

Vec3 times(const std::array<double, 6>& s, const Vec3& w) {
  // inertia tensor from second moments: tr(S) - S
  const double trace = s[0] + s[1] + s[2];
  return trace * w - Vec3{s[0] * w.x + s[3] * w.y + s[4] * w.z, s[3] * w.x + s[1] * w.y + s[5] * w.z,
                          s[4] * w.x + s[5] * w.y + s[2] * w.z};
}

}  // namespace

void MassMatrix::addTwists(const Model& model, int at, const Pose& pose) {
  const Link& link = model.links[static_cast<std::size_t>(at)];
  const auto turn = [&](const Vec3& axis, const Vec3& through, double armature) {
    twists_.push_back({axis, cross(through, axis), at, armature});
  };
  if (link.free) {
    for (int k = 0; k < 3; ++k) twists_.push_back({{}, unit(k), at, 0});
    for (int k = 0; k < 3; ++k) turn(rotate(pose.q, unit(k)), pose.p, 0);
  }
  for (std::size_t k = 0; k < link.dofs.size(); ++k) {
    const Dof& dof = link.dofs[k];
    rows_[{at, static_cast<int>(k)}] = twists_.size();
    if (dof.type == DofType::Slide)
      twists_.push_back({{}, rotate(pose.q, dof.axis), at, dof.armature});
    else if (dof.type == DofType::Hinge)
      turn(rotate(pose.q, dof.axis), pose * dof.anchor, dof.armature);
    else
      for (int i = 0; i < 3; ++i) turn(rotate(pose.q, unit(i)), pose * dof.anchor, dof.armature);
  }
}

MassMatrix::MassMatrix(const Model& model, int link) {
  const std::size_t count = model.links.size();
  std::vector<Pose> pose(count);
  std::vector<int> top(count, -1);  // of each link: the first of its tree that moves
  for (std::size_t i = 0; i < count; ++i) {
    const Link& each = model.links[i];
    const bool atTop = each.parent < 0;
    pose[i] = (atTop ? Pose{} : pose[static_cast<std::size_t>(each.parent)]) * each.pose;
    top[i] = atTop ? -1 : top[static_cast<std::size_t>(each.parent)];
    if (top[i] < 0 && each.moves()) top[i] = static_cast<int>(i);
  }
  const int own = top[static_cast<std::size_t>(link)];
  if (own < 0) return;
  std::vector<SolidSums> below(count);  // of each link and all that hangs on it, in the world
  for (std::size_t i = count; i-- > 0;) {
    if (top[i] != own) continue;
    below[i] += placed(model.links[i].mass, pose[i].p, pose[i].q, 1);
    if (static_cast<int>(i) != own) below[static_cast<std::size_t>(model.links[i].parent)] += below[i];
  }
  for (std::size_t i = 0; i < count; ++i)
    if (top[i] == own) addTwists(model, static_cast<int>(i), pose[i]);

  const std::size_t n = twists_.size();
  if (n > kMost) return;
  matrix_.assign(n * n, 0);
  for (std::size_t j = 0; j < n; ++j) {
    // momentum of what hangs on the link of j, and its rate along the motions of the links above
    const Twist& moving = twists_[j];
    const SolidSums& s = below[static_cast<std::size_t>(moving.link)];
    const Vec3 linear = s.volume * moving.v + cross(moving.w, s.first),
               angular = cross(s.first, moving.v) + times(s.second, moving.w);
    int at = moving.link;
    for (std::size_t i = j + 1; i-- > 0;) {
      while (at > twists_[i].link) at = model.links[static_cast<std::size_t>(at)].parent;
      if (at != twists_[i].link) continue;
      matrix_[i * n + j] = matrix_[j * n + i] = dot(twists_[i].v, linear) + dot(twists_[i].w, angular);
    }
    matrix_[j * n + j] += moving.armature;
  }
  factor();
}

void MassMatrix::factor() {
  const std::size_t n = twists_.size();
  std::vector<double> l(n * n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix_[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      if (i == j && !(sum > 1e-14 * matrix_[i * n + i])) return;
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
  factor_ = std::move(l);
}

double MassMatrix::diagonal(const std::pair<int, int>& dof) const {
  const auto row = rows_.find(dof);
  return row == rows_.end() || matrix_.empty() ? 0 : matrix_[row->second * (twists_.size() + 1)];
}

std::vector<double> MassMatrix::response(const Moments& moments) const {
  const std::size_t n = twists_.size();
  if (factor_.empty()) return {};
  std::vector<double> x(n, 0);
  for (const auto& [dof, factor] : moments)
    if (const auto row = rows_.find(dof); row != rows_.end()) x[row->second] += factor;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= factor_[i * n + k] * x[k];
    x[i] /= factor_[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= factor_[k * n + i] * x[k];
    x[i] /= factor_[i * n + i];
  }
  return x;
}

double MassMatrix::effective(const Moments& moments) const {
  const std::vector<double> x = response(moments);
  double sum = 0;
  for (const auto& [dof, factor] : moments)
    if (const auto row = rows_.find(dof); !x.empty() && row != rows_.end()) sum += factor * x[row->second];
  return sum > 0 ? 1 / sum : 0;
}

}  // namespace rubble::convert

/// Tendons, and couplings of coordinates that no gear or rack can be. A joint of type tendon has four sides:
/// two bodies, and two frame bodies, each of which may be the world.
#include <algorithm>
#include <cmath>

#include "convert/assemble.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

constexpr const char* kStill = "its bodies do not move relative to one another";

class TendonBuilder {
 public:
  TendonBuilder(const Model& model, const Layout& layout, const Scene& scene)
      : model_(model), layout_(layout), scene_(scene) {}

  void addPoint(const Tendon::Point& point) {
    const Vec3 at = poseInBody(layout_, point.link) * point.at;
    path_.push_back({bodyIndex(layout_, point.link), at, point.weight});
  }
  void addWrap(const Tendon::Wrap& wrap) {
    const Pose pose = poseInBody(layout_, wrap.link);
    Tendon::Wrap own = wrap;
    own.link = bodyIndex(layout_, wrap.link);
    own.center = pose * wrap.center, own.axis = rotate(pose.q, wrap.axis);
    if (own.guide) own.guide = rotate(pose.q, *wrap.guide);
    wraps_.push_back(own);
  }
  /// f(q) = sum c_i q^i, q measured from the beginning.
  void addTerm(const std::pair<int, int>& at, const std::array<double, 4>& c) {
    const Link& link = model_.links[static_cast<std::size_t>(at.first)];
    const Dof& dof = link.dofs[static_cast<std::size_t>(at.second)];
    if (link.dofs.size() > 1)
      if (const auto own = layout_.axisOf.find(at); own != layout_.axisOf.end())
        return addAxis(own->second, c);
    terms_.push_back({dof.type == DofType::Slide ? kTravel : kTurn,
                      bodyIndex(layout_, at.first),
                      bodyIndex(layout_, link.parent),
                      dof.axis,
                      dof.anchor,
                      c,
                      {}});
  }
  void addMotion(const Tendon::Motion& motion) {
    const Pose inBody = poseInBody(layout_, motion.link);
    const Quat body = rotationOf(motion.link) * conjugate(inBody.q);
    const Vec3 axis = rotateInverse(body, rotate(rotationOf(motion.axisLink), motion.axis));
    terms_.push_back({motion.turns ? kTurn : kTravel,
                      bodyIndex(layout_, motion.link),
                      bodyIndex(layout_, motion.frame),
                      axis,
                      inBody * motion.anchor,
                      {motion.coefficient, 0, 0, 0},
                      {}});
  }

  /// Why it cannot be a joint; empty if it can.
  std::string build(JointDef& out) {
    if (path_.size() > kMostPoints) return "a path of more than 12 points";
    if (wraps_.size() > kMostWraps) return "a path around more than four geoms";
    if (terms_.size() > kMostTerms) return "a sum of more than three joints";
    for (const Point& point : path_) sideOf(point.body);
    for (const Tendon::Wrap& wrap : wraps_) sideOf(wrap.link);
    for (const Term& term : terms_) {
      sideOf(term.body), sideOf(term.frame);
      if (term.body == term.frame) return kStill;
    }
    if (sides_.size() > 4 || bodies_ > 4 || bodies_ == 0) return "its bodies are not one to four";
    // A is a body; the world is a frame body
    std::stable_partition(sides_.begin(), sides_.end(), [](int body) { return body != kWorld; });
    sides_.resize(4, kWorld);
    if (sides_[1] == kWorld && bodies_ == 1) std::fill(sides_.begin() + 1, sides_.end(), kWorld);
    out.type = jointType("tendon");
    out.bodyA = sides_[0], out.bodyB = sides_[1];
    out.frameBodyA = sides_[2], out.frameBodyB = sides_[3];
    out.collide = true;
    TendonFields fields;
    for (const Point& p : path_)
      fields.path.insert(fields.path.end(), {number(p.body), p.at.x, p.at.y, p.at.z, p.weight});
    for (const Tendon::Wrap& wrap : wraps_) {
      const Vec3 guide = wrap.guide.value_or(Vec3{});
      fields.wraps.insert(fields.wraps.end(),
                          {static_cast<double>(wrap.point), number(wrap.link), wrap.center.x, wrap.center.y,
                           wrap.center.z, wrap.axis.x, wrap.axis.y, wrap.axis.z, wrap.radius,
                           wrap.guide ? 1. : 0., guide.x, guide.y, guide.z});
    }
    for (const Term& term : terms_)
      fields.terms.insert(fields.terms.end(), {term.kind, number(term.body), number(term.frame), term.axis.x,
                                               term.axis.y, term.axis.z, term.anchor.x, term.anchor.y,
                                               term.anchor.z, term.c[0], term.c[1], term.c[2], term.c[3]});
    if (std::any_of(terms_.begin(), terms_.end(), [](const Term& t) {
          return t.tilts != std::array{0., 0.};
        }))
      for (const Term& term : terms_) fields.tilts.insert(fields.tilts.end(), {term.tilts[0], term.tilts[1]});
    out.own = fields;
    return "";
  }

 private:
  static constexpr std::size_t kMostPoints = 12, kMostTerms = 3, kMostWraps = 4;
  struct Point {
    int body;
    Vec3 at;
    double weight;
  };
  static constexpr double kTurn = 0, kTravel = 1, kCardan = 2;
  struct Term {
    double kind;  ///< of TendonFields::terms
    int body, frame;
    Vec3 axis, anchor;  ///< in the frame of the body
    std::array<double, 4> c;
    std::array<double, 2> tilts{};  ///< of the gimbal that it is an angle of [rad]
  };

  /// The same of an axis of a joint that has several.
  void addAxis(const AxisReading& axis, std::array<double, 4> c) {
    const JointDef& joint = scene_.joints[static_cast<std::size_t>(axis.joint)];
    c[0] *= axis.sign, c[2] *= axis.sign;
    if (axis.axis < 3) {
      const auto orientation = [&](int body) {
        return body == kWorld ? Quat{} : scene_.bodies[static_cast<std::size_t>(body)].orientation;
      };
      Vec3 unit;
      unit[axis.axis] = 1;
      const Vec3 inWorld = rotate(orientation(joint.bodyB) * joint.frameB, unit);
      terms_.push_back({kTravel,
                        joint.bodyA,
                        joint.bodyB,
                        rotateInverse(orientation(joint.bodyA), inWorld),
                        joint.anchorA,
                        c,
                        {}});
    } else {
      const auto* const own = std::any_cast<GimbalFields>(&joint.own);
      const GimbalFields fields = own ? *own : GimbalFields{};
      terms_.push_back({kCardan + axis.axis - 3,
                        joint.bodyA,
                        joint.bodyB,
                        rotationVector(joint.frameA),
                        rotationVector(joint.frameB),
                        c,
                        {fields.tiltB, fields.tiltA}});
    }
  }

  Quat rotationOf(int link) const {
    return link < 0 ? Quat{} : layout_.inWorld[static_cast<std::size_t>(link)].q;
  }

  void sideOf(int body) {
    if (std::find(sides_.begin(), sides_.end(), body) != sides_.end()) return;
    sides_.push_back(body);
    bodies_ += body != kWorld;
  }
  double number(int body) const {
    return static_cast<double>(std::find(sides_.begin(), sides_.end(), body) - sides_.begin());
  }

  const Model& model_;
  const Layout& layout_;
  const Scene& scene_;
  std::vector<Point> path_;
  std::vector<Term> terms_;
  std::vector<Tendon::Wrap> wraps_;
  std::vector<int> sides_;
  int bodies_ = 0;
};

const Dof& dofAt(const Model& model, const std::pair<int, int>& at) {
  return model.links[static_cast<std::size_t>(at.first)].dofs[static_cast<std::size_t>(at.second)];
}

using Chain = std::pair<Tendon::Term, Tendon::Term>;

/// First and last terms of chains: each next joint is that of a child, of the same type and coefficient,
/// about or along a parallel axis. The sum of a chain is the turn or travel of its last link in the parent of
/// the first.
std::vector<Chain> chainsOf(const Model& model, const Layout& layout, std::vector<Tendon::Term> terms) {
  std::sort(terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.dof < b.dof; });
  const auto axisOf = [&](const Tendon::Term& term) {
    return rotate(layout.inWorld[static_cast<std::size_t>(term.dof.first)].q, dofAt(model, term.dof).axis);
  };
  const auto isSingle = [&](const Tendon::Term& term) {
    return model.links[static_cast<std::size_t>(term.dof.first)].dofs.size() == 1;
  };
  std::vector<Chain> chains;
  for (const Tendon::Term& term : terms) {
    const int parent = rootOf(layout, model.links[static_cast<std::size_t>(term.dof.first)].parent);
    const auto chain = std::find_if(chains.begin(), chains.end(), [&](const Chain& each) {
      const Tendon::Term& last = each.second;
      constexpr double kParallel = 1 - 1e-9;
      return last.dof.first == parent && last.coefficient == term.coefficient && isSingle(last) &&
             isSingle(term) && dofAt(model, last.dof).type == dofAt(model, term.dof).type &&
             dot(axisOf(last), axisOf(term)) > kParallel;
    });
    if (chain == chains.end())
      chains.emplace_back(term, term);
    else
      chain->second = term;
  }
  return chains;
}

Tendon::Motion chainMotion(const Model& model, const Tendon::Term& first, const Tendon::Term& last) {
  const Dof& dof = dofAt(model, last.dof);
  Tendon::Motion motion;
  motion.link = motion.axisLink = last.dof.first;
  motion.frame = model.links[static_cast<std::size_t>(first.dof.first)].parent;
  motion.turns = dof.type == DofType::Hinge;
  motion.axis = dof.axis, motion.anchor = dof.anchor, motion.coefficient = last.coefficient;
  return motion;
}

/// A motion at the beginning [m], [rad].
double startOf(const Layout& layout, const Tendon::Motion& motion) {
  if (motion.start) return *motion.start;
  const auto pose = [&](int link) {
    return link < 0 ? Pose{} : layout.inWorld[static_cast<std::size_t>(link)];
  };
  const Vec3 axis = rotate(pose(motion.axisLink).q, motion.axis);
  if (!motion.turns) return dot(axis, pose(motion.link) * motion.anchor - pose(motion.frame) * motion.origin);
  return dot(axis, rotationVector(pose(motion.link).q * conjugate(pose(motion.frame).q)));
}

}  // namespace

bool isReadable(const Model& model, const Layout& layout, const Scene& scene,
                const std::pair<int, int>& dof) {
  if (model.links[static_cast<std::size_t>(dof.first)].dofs.size() == 1) return true;
  const auto own = layout.axisOf.find(dof);
  if (own == layout.axisOf.end()) return false;
  // a tendon measures travel between points of the bodies
  const JointDef& joint = scene.joints[static_cast<std::size_t>(own->second.joint)];
  const auto* const gimbal = std::any_cast<GimbalFields>(&joint.own);
  return own->second.axis >= 3 || !gimbal || (gimbal->offsetB == Vec3{} && gimbal->offsetA == Vec3{});
}

std::optional<JointDef> tendonOf(const Model& model, const Layout& layout, const Scene& scene,
                                 const Tendon& tendon, double& zero, Report& report) {
  TendonBuilder builder(model, layout, scene);
  const auto lose = [&](const std::string& why) {
    report.note(why == kStill ? Effect::None : Effect::Lost, tendon.place, "tendon" + inQuotes(tendon.name),
                why);
    return std::nullopt;
  };
  for (const Tendon::Point& point : tendon.path) builder.addPoint(point);
  for (const Tendon::Wrap& wrap : tendon.wraps) builder.addWrap(wrap);
  double start = 0;  // of the sum, where the joint has 0
  for (const Tendon::Term& term : tendon.terms) {
    const Dof& dof = dofAt(model, term.dof);
    if (!isReadable(model, layout, scene, term.dof))
      report.note(Effect::Approximate, tendon.place, "tendon" + inQuotes(tendon.name), kSeveralJoints);
    start += term.coefficient * (dof.reference + dof.start);
  }
  for (const auto& [first, last] : chainsOf(model, layout, tendon.terms)) {
    if (first.dof == last.dof)
      builder.addTerm(first.dof, {first.coefficient, 0, 0, 0});
    else
      builder.addMotion(chainMotion(model, first, last));
  }
  for (const Tendon::Motion& motion : tendon.motions) {
    builder.addMotion(motion);
    start += motion.coefficient * startOf(layout, motion);
  }
  JointDef joint;
  if (const std::string why = builder.build(joint); !why.empty()) return lose(why);
  joint.axes[0] = axisOf(tendon, 1, start);
  zero = start;
  return joint;
}

std::optional<JointDef> cam(const Model& model, const Layout& layout, const Scene& scene,
                            const Coupling& coupling, Report& report) {
  // with q = s + p, s at the beginning: the polynomial in p
  const double s = dofAt(model, coupling.dofB).start;
  std::array<double, 5> shifted{};
  double power[5] = {1, s, s * s, s * s * s, s * s * s * s};
  constexpr double kChoose[5][5] = {
      {1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
  for (std::size_t n = 0; n < 5; ++n)
    for (std::size_t k = 0; k <= n; ++k) shifted[k] += coupling.terms[n] * kChoose[n][k] * power[n - k];
  TendonBuilder builder(model, layout, scene);
  builder.addTerm(coupling.dofA, {1, 0, 0, 0});
  builder.addTerm(coupling.dofB, {-shifted[1], -shifted[2], -shifted[3], -shifted[4]});
  JointDef joint;
  if (const std::string why = builder.build(joint); !why.empty()) {
    report.note(Effect::Lost, coupling.place, "coupling" + inQuotes(coupling.name), why);
    return std::nullopt;
  }
  joint.axes[0].min = joint.axes[0].max = shifted[0] - dofAt(model, coupling.dofA).start;
  return joint;
}

}  // namespace rubble::convert

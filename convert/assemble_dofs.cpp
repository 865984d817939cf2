/// One joint of all degrees of freedom of a link. Slides and hinges of one body become a six_dof joint: with
/// R = R_z(q1) R_x(q2) the swing about z is q1 and the twist about x is q2, so two orthogonal hinges are
/// exact. Two others, or three with the second one orthogonal to both, are a gimbal with
/// R = R_z(q1) R_y(q2 + c) R_x(q3): c is the angle by which the first and the third are not orthogonal.
#include <algorithm>
#include <cmath>
#include <map>

#include "convert/assemble.h"
#include "convert/rotations.h"

namespace rubble::convert {
namespace {

/// Cosine below which directions are orthogonal, and distance below which axes meet [1, m].
constexpr double kAligned = 1e-6;

JointAxis locked() {
  JointAxis axis;
  axis.min = axis.max = 0;
  return axis;
}

/// A ball joint with springs or inertia of its own about each axis: a six_dof joint without travel.
JointDef sprungBallOf(const Dof& dof, Report& report) {
  JointDef joint;
  joint.type = JointType::SixDof;
  const Vec3 stiffness = dof.spring ? dof.spring->stiffness : Vec3{};
  for (int k = 0; k < 3; ++k) {
    joint.axes[static_cast<std::size_t>(k)] = locked();
    JointAxis& axis = joint.axes[static_cast<std::size_t>(k) + 3];
    axis.driveStiffness = stiffness[k] + dof.drive.stiffness, axis.driveDamping = dof.drive.damping;
    axis.maxDriveForce = dof.drive.maxForce, axis.friction = dof.friction;
    axis.damping = dof.damping, axis.armature = dof.armature;
  }
  if (dof.range)
    report.note(Effect::Lost, dof.place, "joint.range",
                "of a ball joint with springs of a cable or armature");
  if (dof.armature > 0 || dof.drive.stiffness > 0)
    report.note(Effect::Approximate, dof.place, dof.armature > 0 ? "joint.armature" : "joint.stiffness",
                "of a ball joint it acts on swing and twist, which are its turns while they are small");
  return joint;
}

JointDef ballOf(const Dof& dof, Report& report) {
  if (dof.spring || dof.armature > 0) return sprungBallOf(dof, report);
  JointDef joint;
  joint.friction = dof.friction;
  const DofDrive& drive = dof.drive;
  const double damping = drive.damping + dof.damping;
  if (!dof.range && !(drive.stiffness > 0) && !(damping > 0)) {
    joint.type = JointType::Ball;
    return joint;
  }
  joint.type = JointType::SwingTwist;
  joint.driveStiffness = drive.stiffness, joint.driveDamping = damping;
  joint.maxDriveTorque = drive.maxForce;
  if (dof.range) {
    constexpr double kNarrowest = 1e-3;
    const double most = std::max((*dof.range)[1], kNarrowest);
    joint.swingY = joint.swingZ = most;
    joint.axes[1].min = -most, joint.axes[1].max = most;
    report.note(Effect::Approximate, dof.place, "joint.range",
                "the limit of the angle of a ball joint becomes limits of its swing and of its twist");
  }
  return joint;
}

/// Most that the middle axis of a gimbal may turn [rad].
constexpr double kMostOfGimbal = 1.48;

/// Builds the six_dof joint or gimbal of several degrees of freedom.
class SixDof {
 public:
  SixDof(const Link& link, Report& report) : link_(link), report_(report) {
    for (const Dof& dof : link.dofs) (dof.type == DofType::Slide ? slides_ : turns_).push_back(&dof);
    const bool slidesFirst = isOrdered(DofType::Slide, true), turnsFirst = isOrdered(DofType::Slide, false);
    // Axes of travel are those of B. Slides that come after the hinges move with the child: then B is the
    // child.
    swapped = !slidesFirst && turnsFirst;
    if (!slidesFirst && !turnsFirst)
      note(Effect::Approximate, "slides between hinges act as if they came first");
    if (swapped) std::reverse(turns_.begin(), turns_.end());
    sign_ = swapped ? -1 : 1;
  }

  JointDef build() {
    joint_.type = JointType::SixDof;
    joint_.axes.fill(locked());
    const bool ball = std::any_of(turns_.begin(), turns_.end(),
                                  [](auto* d) { return d->type == DofType::Ball; });
    if (ball)
      addBall();
    else
      addHinges();
    addSlides();
    anchor = commonAnchor();
    frameA = quatOfAxes(x_, y_, z_), frameB = quatOfAxes(cross(y_, outer_), y_, outer_);
    return joint_;
  }

  std::vector<TreeJoint::Axis> axes() const {
    std::vector<TreeJoint::Axis> out;
    for (const Dof& dof : link_.dofs) {
      const auto found = axes_.find(&dof);
      out.push_back(found == axes_.end() ? TreeJoint::Axis{} : found->second);
    }
    return out;
  }

  bool swapped = false;
  Vec3 anchor;          ///< in the frame of the link [m]
  Quat frameA, frameB;  ///< of the joint on A and B -> link, in the pose of the file

 private:
  bool isOrdered(DofType first, bool isFirst) const {
    bool other = false;
    for (const Dof& dof : link_.dofs) {
      const bool match = (dof.type == first) == isFirst;
      if (match && other) return false;
      other = other || !match;
    }
    return true;
  }
  void note(Effect effect, const std::string& why) {
    report_.note(effect, link_.dofs.front().place, "joints of body" + inQuotes(link_.name), why);
  }

  /// z from a wish, orthogonal to x; false if it is parallel.
  bool chooseZ(const Vec3& wish) {
    const Vec3 across = wish - dot(wish, x_) * x_;
    if (length(across) < kAligned) return false;
    outer_ = z_ = normalize(across), y_ = cross(z_, x_);
    return true;
  }
  void chooseAnyZ() {
    for (const Dof* slide : slides_)
      if (std::fabs(dot(slide->axis, x_)) < 1 - kAligned && chooseZ(slide->axis)) return;
    if (!chooseZ({0, 0, 1})) chooseZ({1, 0, 0});
  }

  void setAxis(int axis, const Dof& dof, double sign, double shift = 0) {
    joint_.axes[static_cast<std::size_t>(axis)] = convert::axisOf(dof, sign, dof.reference - sign * shift);
    axes_[&dof] = {axis, sign, shift};
  }

  void addBall() {
    x_ = {1, 0, 0}, y_ = {0, 1, 0}, outer_ = z_ = {0, 0, 1};
    for (std::size_t i = 3; i < 6; ++i) joint_.axes[i] = {};
    const Dof& dof = *turns_.front();
    if (turns_.size() > 1) note(Effect::Lost, "hinges beside a ball joint add no freedom and are left out");
    if (dof.range || dof.drive.stiffness > 0 || dof.damping > 0 || dof.friction > 0)
      report_.note(Effect::Lost, dof.place, "joint" + inQuotes(dof.name),
                   "limit, spring, damping and friction of a ball joint beside slides");
  }

  void addHinges() {
    if (turns_.size() > 3) {
      note(Effect::Lost, "a body turns about at most three axes; the others are left out");
      turns_.resize(3);
    }
    const std::size_t count = turns_.size();
    if (count == 0) {
      x_ = slides_.front()->axis;
      chooseAnyZ();
      return;
    }
    x_ = turns_.back()->axis;
    setAxis(3, *turns_.back(), sign_);
    if (count == 1) {
      chooseAnyZ();
      return;
    }
    const Dof& outer = *turns_.front();
    if (!chooseZ(outer.axis)) {
      note(Effect::Lost, "two hinges about one axis are one");
      chooseAnyZ();
      return;
    }
    setAxis(5, outer, sign_);
    const double skew = -std::asin(std::clamp(dot(outer.axis, x_), -1., 1.));
    const bool isSkew = std::fabs(skew) > kAligned;
    if (count == 2) {
      if (isSkew) makeGimbal(skew);
      joint_.axes[4].min = joint_.axes[4].max = isSkew ? skew : 0;
      return;
    }
    const Dof& middle = *turns_[1];
    const double along = dot(middle.axis, y_);
    setAxis(4, middle, along < 0 ? -sign_ : sign_, skew);
    const JointAxis& axis = joint_.axes[4];
    const bool isOrthogonal = std::fabs(along) > 1 - kAligned && std::fabs(skew) < kMostOfGimbal,
               isBounded = axis.min >= -kMostOfGimbal && axis.max <= kMostOfGimbal;
    // only a turn that nothing acts on needs no angles
    const bool isPlain = std::all_of(turns_.begin(), turns_.end(), [](const Dof* dof) {
      return !dof->range && !(dof->drive.stiffness > 0) && !(dof->drive.damping > 0) &&
             !(dof->friction > 0) && !(dof->damping > 0) && !(dof->armature > 0) && dof->motorForce == 0;
    });
    if (isOrthogonal && !(isPlain && !isSkew)) {
      makeGimbal(skew);
      if (!isBounded) note(Effect::Approximate, "the second of three hinges turns by less than 90 degrees");
      return;
    }
    setAxis(4, middle, along < 0 ? -sign_ : sign_);
    if (isOrthogonal || isPlain) return;
    note(Effect::Approximate,
         "axes of three hinges are made orthogonal, and limits, drives and friction act on "
         "swing and twist");
  }

  void makeGimbal(double skew) {
    joint_.type = jointType("gimbal");
    outer_ = turns_.front()->axis;
    if (std::fabs(skew) > kMostOfGimbal)
      note(Effect::Approximate, "two hinges about nearly the same axis are almost one");
  }

  void addSlides() {
    const Vec3 axes[3] = {cross(y_, outer_), y_, outer_};
    bool used[3] = {};
    for (const Dof* slide : slides_) {
      int best = -1;
      for (int k = 0; k < 3; ++k)
        if (!used[k] &&
            (best < 0 || std::fabs(dot(slide->axis, axes[k])) > std::fabs(dot(slide->axis, axes[best]))))
          best = k;
      if (best < 0 || std::fabs(dot(slide->axis, axes[best])) < kAligned) {
        report_.note(Effect::Lost, slide->place, "joint" + inQuotes(slide->name),
                     "a further slide along the same axis");
        continue;
      }
      used[best] = true;
      const double along = dot(slide->axis, axes[best]);
      if (std::fabs(along) < 1 - kAligned)
        report_.note(Effect::Approximate, slide->place, "joint.axis",
                     "a slide that is not along or across the other axes of its body is turned to the "
                     "nearest of them");
      setAxis(best, *slide, along < 0 ? -sign_ : sign_);
    }
  }

  /// A point that all axes of rotation go through.
  Vec3 commonAnchor() {
    if (turns_.empty()) return {};
    const auto fits = [&](const Vec3& point) {
      return std::all_of(turns_.begin(), turns_.end(), [&](const Dof* dof) {
        const Vec3 offset = point - dof->anchor;
        const Vec3 off = dof->type == DofType::Ball ? offset : cross(offset, dof->axis);
        return length(off) < kAligned;
      });
    };
    for (const Dof* dof : turns_)
      if (fits(dof->anchor)) return dof->anchor;
    // where the axes of the first and the last one are nearest to one another
    const Dof &first = *turns_.front(), &last = *turns_.back();
    const Vec3 normal = cross(first.axis, last.axis), across = cross(first.axis, normal);
    if (const double along = dot(last.axis, across); std::fabs(along) > kAligned)
      if (const Vec3 point = last.anchor + dot(first.anchor - last.anchor, across) / along * last.axis;
          fits(point))
        return point;
    note(Effect::Approximate,
         "axes of hinges that do not meet in a point are moved to the anchor of the last one");
    return link_.dofs.back().anchor;
  }

  const Link& link_;
  Report& report_;
  std::vector<const Dof*> slides_, turns_;
  double sign_ = 1;
  std::map<const Dof*, TreeJoint::Axis> axes_;
  JointDef joint_;
  Vec3 x_, y_, z_;  ///< of the joint on A, in the frame of the link
  Vec3 outer_;      ///< z of the joint on B, likewise
};

}  // namespace

JointAxis axisOf(const Coordinate& from, double sign, double zero) {
  JointAxis axis;
  if (from.range) {
    axis.min = (*from.range)[0] - zero, axis.max = (*from.range)[1] - zero;
    if (sign < 0) {
      const double most = -axis.min;
      axis.min = -axis.max, axis.max = most;
    }
  }
  axis.limitStiffness = from.limitStiffness, axis.limitDamping = from.limitDamping;
  const DofDrive& drive = from.drive;
  axis.driveStiffness = drive.stiffness, axis.driveDamping = drive.damping;
  if (drive.stiffness > 0) axis.targetPosition = sign * (drive.stiffnessTarget / drive.stiffness - zero);
  if (drive.damping > 0) axis.targetSpeed = sign * drive.dampingSpeed / drive.damping;
  axis.maxDriveForce = drive.maxForce;
  axis.friction = from.friction;
  axis.armature = from.armature, axis.damping = from.damping, axis.motorForce = sign * from.motorForce;
  return axis;
}

TreeJoint jointOf(const Link& link, const Pose& inParentBody, Report& report) {
  const Dof& first = link.dofs.front();
  JointDef joint;
  Vec3 anchor = first.anchor;
  Quat frame;
  std::optional<Quat> frameB;  // where it is not that of A at the beginning
  bool swapped = false;
  std::vector<TreeJoint::Axis> axes{{0}};
  if (link.dofs.size() > 1) {
    SixDof builder(link, report);
    joint = builder.build();
    anchor = builder.anchor, swapped = builder.swapped;
    frame = swapped ? builder.frameB : builder.frameA;
    frameB = normalize(inParentBody.q * (swapped ? builder.frameA : builder.frameB));
    axes = builder.axes();
  } else if (first.type == DofType::Ball) {
    joint = ballOf(first, report);
    axes.front().axis = -1;
    if (first.spring) {
      // axes of the springs are halfway between the two links at rest; the twist is about that of the parent
      const Quat turn = normalize(link.pose.q * first.spring->rest);
      frame = conjugate(normalize(Quat{1 + std::fabs(turn.s), turn.s < 0 ? -turn.v : turn.v}));
      frameB = normalize(inParentBody.q * first.spring->rest * frame);
      swapped = true;
    }
  } else {
    joint.type = first.type == DofType::Hinge ? JointType::Hinge : JointType::Slider;
    joint.axes[0] = axisOf(first, 1, first.reference);
    frame = frameAlong(first.axis);
    joint.orientationAtoB = inParentBody.q;
  }
  joint.anchorA = anchor, joint.frameA = frame;
  joint.anchorB = inParentBody * anchor, joint.frameB = frameB.value_or(normalize(inParentBody.q * frame));
  if (swapped) std::swap(joint.anchorA, joint.anchorB), std::swap(joint.frameA, joint.frameB);
  return {std::move(joint), !swapped, std::move(axes)};
}

}  // namespace rubble::convert

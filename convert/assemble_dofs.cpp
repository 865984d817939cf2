/// One joint of all degrees of freedom of a link. Slides and hinges of one body become a six_dof joint: with
/// R = R_z(q1) R_x(q2) the swing about z is q1 and the twist about x is q2, so two orthogonal hinges that
/// meet are exact. Two others, and three, are a gimbal (forces/gimbal.h). That of two has its middle angle
/// locked.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

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
  Vec3 anchorA, anchorB;  ///< in the frame of the link, in the pose of the file [m]
  Quat frameA, frameB;    ///< of the joint on A and B -> link, likewise

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

  /// Equal frames on A and B with this x axis, and z along the first slide that is not along it.
  void chooseFrame(const Vec3& x) {
    std::vector<Vec3> wishes;
    for (const Dof* slide : slides_) wishes.push_back(slide->axis);
    wishes.insert(wishes.end(), {{0, 0, 1}, {1, 0, 0}});
    const Vec3 wish = *std::find_if(wishes.begin(), wishes.end(),
                                    [&](const Vec3& each) { return length(cross(each, x)) > kAligned; });
    const Vec3 z = normalize(wish - dot(wish, x) * x);
    frameA = frameB = quatOfAxes(x, cross(z, x), z);
  }

  void setAxis(int axis, const Dof& dof, double sign, double shift = 0) {
    joint_.axes[static_cast<std::size_t>(axis)] = convert::axisOf(dof, sign, dof.reference - sign * shift);
    axes_[&dof] = {axis, sign, shift};
  }

  void addBall() {
    for (std::size_t i = 3; i < 6; ++i) joint_.axes[i] = {};
    const Dof& dof = *turns_.front();
    anchorA = anchorB = dof.anchor;
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
    if (turns_.empty()) return chooseFrame(slides_.front()->axis);
    dropRepeated();
    const Dof &outer = *turns_.front(), &inner = *turns_.back();
    setAxis(3, inner, sign_);
    if (turns_.size() == 1) {
      anchorA = anchorB = inner.anchor;
      return chooseFrame(inner.axis);
    }
    setAxis(5, outer, sign_);
    if (turns_.size() == 2)
      addTwo(outer, inner);
    else
      addThree(outer, *turns_[1], inner);
  }
  /// Of hinges about one axis leaves one.
  void dropRepeated() {
    const auto isOne = [&](std::size_t i, std::size_t j, double least) {
      return j < turns_.size() && length(cross(turns_[i]->axis, turns_[j]->axis)) < least;
    };
    const double nearly = turns_.size() == 3 ? std::cos(kMostOfGimbal) : kAligned;
    const std::size_t count = turns_.size();
    if (isOne(0, 2, kAligned) || isOne(1, 2, nearly)) turns_.erase(turns_.begin() + 1);
    if (isOne(0, 1, nearly)) turns_.erase(turns_.begin());
    if (turns_.size() < count) note(Effect::Lost, "hinges of a body about one axis are one");
  }

  /// `middle`: axis of q_1, so that this angle is within 90 degrees in the pose of the file. Returns it.
  double setFrames(const Vec3& outer, const Vec3& middle, const Vec3& inner) {
    const Vec3 onB = normalize(middle - dot(middle, outer) * outer), x = cross(onB, outer),
               onA = normalize(middle - dot(middle, inner) * inner);
    frameB = quatOfAxes(x, onB, outer), frameA = quatOfAxes(inner, onA, cross(inner, onA));
    return std::atan2(-dot(inner, cross(x, middle)), dot(inner, x));
  }

  void addTwo(const Dof& outer, const Dof& inner) {
    const double angle = setFrames(outer.axis, normalize(cross(outer.axis, inner.axis)), inner.axis);
    const bool isSkew = std::fabs(angle) > kAligned;
    if (isSkew) joint_.axes[4].min = joint_.axes[4].max = angle;
    if (std::fabs(angle) > kMostOfGimbal)
      note(Effect::Approximate, "two hinges about nearly the same axis are almost one");
    GimbalFields fields;
    const bool meet = haveCommonAnchor();
    if (!meet) {
      std::tie(anchorB, anchorA) = nearest(outer, inner);
      fields.offsetB = rotateInverse(frameB, anchorA - anchorB);
    }
    if (isSkew || !meet) makeGimbal(fields);
  }

  void addThree(const Dof& outer, const Dof& middle, const Dof& inner) {
    const double volume = dot(middle.axis, cross(outer.axis, inner.axis)), direction = volume < 0 ? -1 : 1;
    const Vec3 axis = direction * middle.axis;
    const double angle = setFrames(outer.axis, axis, inner.axis);
    setAxis(4, middle, direction * sign_, angle);
    GimbalFields fields;
    const auto tilt = [&](const Vec3& other) {
      const double along = dot(axis, other);
      return std::fabs(along) > kAligned ? std::asin(along) : 0;
    };
    fields.tiltB = tilt(outer.axis), fields.tiltA = tilt(inner.axis);
    const bool meet = haveCommonAnchor();
    if (!meet) {
      const auto [first, second] = nearest(outer, middle);
      anchorB = first, anchorA = nearest(middle, inner).second;
      fields.offsetB = rotateInverse(frameB, second - anchorB);
      fields.offsetA = rotateInverse(frameB, rotateInverse(fromAxisAngle(axis, angle), anchorA - second));
    }
    makeGimbal(fields);
    const JointAxis& own = joint_.axes[4];
    const bool isBounded = own.min >= -kMostOfGimbal && own.max <= kMostOfGimbal;
    // angles that nothing acts on may be any
    const bool isPlain = meet && std::all_of(turns_.begin(), turns_.end(), [](const Dof* dof) {
                           return !dof->range && !(dof->drive.stiffness > 0) && !(dof->drive.damping > 0) &&
                                  !(dof->friction > 0) && !(dof->damping > 0) && !(dof->armature > 0) &&
                                  dof->motorForce == 0;
                         });
    if (!isBounded && !isPlain)
      note(Effect::Approximate, "the second of three hinges turns by less than 90 degrees");
  }

  void makeGimbal(const GimbalFields& fields) {
    joint_.type = jointType("gimbal");
    joint_.own = fields;
  }

  void addSlides() {
    const Vec3 axes[3] = {rotate(frameB, {1, 0, 0}), rotate(frameB, {0, 1, 0}), rotate(frameB, {0, 0, 1})};
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

  /// Sets both anchors to a point that all axes of rotation go through, if there is one.
  bool haveCommonAnchor() {
    std::vector<Vec3> points;
    for (const Dof* dof : turns_) points.push_back(dof->anchor);
    points.push_back(nearest(*turns_.front(), *turns_.back()).second);
    const auto found = std::find_if(points.begin(), points.end(), [&](const Vec3& point) {
      return std::all_of(turns_.begin(), turns_.end(), [&](const Dof* dof) {
        return length(cross(point - dof->anchor, dof->axis)) < kAligned;
      });
    });
    if (found == points.end()) return false;
    anchorA = anchorB = *found;
    return true;
  }
  /// Points of both axes where they are nearest to one another.
  static std::pair<Vec3, Vec3> nearest(const Dof& a, const Dof& b) {
    const Vec3 between = b.anchor - a.anchor, normal = cross(a.axis, b.axis);
    const double size = dot(normal, normal);
    return {a.anchor + dot(cross(between, b.axis), normal) / size * a.axis,
            b.anchor + dot(cross(between, a.axis), normal) / size * b.axis};
  }

  const Link& link_;
  Report& report_;
  std::vector<const Dof*> slides_, turns_;
  double sign_ = 1;
  std::map<const Dof*, TreeJoint::Axis> axes_;
  JointDef joint_;
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
  Vec3 anchor = first.anchor, parentAnchor = anchor;
  Quat frame;
  std::optional<Quat> frameB;  // where it is not that of A at the beginning
  bool swapped = false;
  std::vector<TreeJoint::Axis> axes{{0}};
  if (link.dofs.size() > 1) {
    SixDof builder(link, report);
    joint = builder.build();
    swapped = builder.swapped;
    anchor = swapped ? builder.anchorB : builder.anchorA;
    parentAnchor = swapped ? builder.anchorA : builder.anchorB;
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
  joint.anchorB = inParentBody * parentAnchor,
  joint.frameB = frameB.value_or(normalize(inParentBody.q * frame));
  if (swapped) std::swap(joint.anchorA, joint.anchorB), std::swap(joint.frameA, joint.frameB);
  return {std::move(joint), !swapped, std::move(axes)};
}

}  // namespace rubble::convert

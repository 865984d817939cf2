/// Edits and measures of joints in host memory.
#include <algorithm>

#include "stages/joints/joints.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Calls f.operator()<F>() for the joint type of that index.
template <class Function> void withJointType(int type, Function&& f) {
  forEachType(JointTypes{}, [&]<class F>() {
    if (typeIndex<F>(JointTypes{}) == type) f.template operator()<F>();
  });
}

/// Replaces infinity by kHardValue.
Real finite(double a) {
  return static_cast<Real>(std::clamp(a, -static_cast<double>(kHardValue), static_cast<double>(kHardValue)));
}

GroupSpec specOf(const EngineGroup& in) {
  return {in.mode, finite(in.stiffness), finite(in.damping), finite(in.bound)};
}
AxisSpec specOf(const JointAxis& in) {
  AxisSpec out;
  out.lo = finite(in.min), out.hi = finite(in.max);
  out.limitStiffness = finite(in.limitStiffness), out.limitDamping = finite(in.limitDamping);
  out.target = finite(in.targetPosition), out.speed = finite(in.targetSpeed);
  out.driveStiffness = finite(in.driveStiffness), out.driveDamping = finite(in.driveDamping);
  out.driveBound = finite(in.maxDriveForce);
  out.friction = finite(in.friction);
  out.armature = finite(in.armature), out.damping = finite(in.damping), out.force = finite(in.motorForce);
  return out;
}

template <class F> void editJointOf(HostTables& tables, int slot, const EngineJoint& in) {
  JointSpec<F>& spec = tables.view().specsOf<F>()[slot];
  const JointLinks before = linksOf<F>(spec);
  spec = {};
  spec.data = F::Data::of(in);
  spec.a = slotOf(tables, in.a), spec.b = slotOf(tables, in.b);
  if constexpr (hasFrameBodies<F>())
    spec.frameBodyA = slotOf(tables, in.frameBodyA), spec.frameBodyB = slotOf(tables, in.frameBodyB);
  spec.alive = in.alive, spec.isRigid = in.isRigid;
  spec.breakForce = finite(in.breakForce), spec.breakTorque = finite(in.breakTorque);
  std::size_t group = 0, axis = 0;
  forEachPart<F>([&]<int I, class P>() {
    if constexpr (P::kAxis)
      partOf<I>(spec.parts) = specOf(axis < in.axes.size() ? in.axes[axis++] : JointAxis{});
    else
      partOf<I>(spec.parts) = specOf(group < in.groups.size() ? in.groups[group++] : EngineGroup{});
  });
  tables.trees.relink({typeIndex<F>(JointTypes{}), slot}, before, linksOf<F>(spec));
}

Pose worldPose(const SolverData& s, int body, const Vec3d& origin) {
  if (body == kWorldBody) return {Vec3(Vec3d{} - origin), Quat{}};
  return {Vec3(s.position[body] - origin), s.orientation[body]};
}

/// Distance of c outside of the limits.
double excess(const AxisSpec& spec, double c) {
  return std::max({0.0, c - static_cast<double>(spec.hi), static_cast<double>(spec.lo) - c});
}

template <class F> void measureJoint(const SolverData& s, int slot, JointState& state) {
  const JointSpec<F>& spec = s.specsOf<F>()[slot];
  const Joint<F>& joint = s.jointsOf<F>()[slot];
  const Vec3d origin = jointOrigin(s, spec.b);
  SidePose<F> a, b;
  if constexpr (hasFrameBodies<F>()) {
    // the world as a frame body has the pose that the step uses
    const auto frameBody = [&](int body) {
      return body == kWorldBody ? Pose{{0, 0, 0}, Quat{}} : worldPose(s, body, origin);
    };
    a = {worldPose(s, spec.a, origin), frameBody(spec.frameBodyA)};
    b = {worldPose(s, spec.b, origin), frameBody(spec.frameBodyB)};
  } else {
    a = worldPose(s, spec.a, origin), b = worldPose(s, spec.b, origin);
  }
  const auto velocity = [&](int body) {
    return body == kWorldBody ? Vec6{{0, 0, 0}, {0, 0, 0}} : Vec6{s.velocity[body], s.angularVelocity[body]};
  };
  typename F::Memory memory = joint.memory;
  memory.remember(spec.data, a, b, origin);
  double linear2 = 0, angular2 = 0;
  rubble::Vec3 force, moment;
  forEachPart<F>([&]<int I, class P>() {
    const auto& rows = partOf<I>(joint.parts);
    double& error2 = P::kUnit == RowUnit::Linear ? linear2 : angular2;
    Real error[P::kRows];
    Vec6 jb[P::kRows];
    P::constraint(spec.data, memory, a, b, error);
    P::jacobian(spec.data, memory, a, b, 1, jb);
    const auto addLoad = [&](Real f, const Vec6& j) {
      force -= rubble::Vec3(f * j.lin);
      moment -= rubble::Vec3(f * j.ang);
    };
    if constexpr (P::kAxis) {
      const AxisSpec& own = partOf<I>(spec.parts);
      JointAxisState axis;
      double turned = 0;
      if constexpr (requires { P::turns(spec.data, memory); }) turned = P::turns(spec.data, memory);
      axis.position = static_cast<double>(error[0]) + turned;
      Real speed = 0;
      for (int side = 0; side < kSides<F>; ++side) {
        Vec6 j[P::kRows];
        P::jacobian(spec.data, memory, a, b, side, j);
        speed += dot(j[0], velocity(bodyOf(spec, side)));
      }
      axis.speed = static_cast<double>(speed);
      const auto of = [](const AxisRow& row) { return row.active ? -static_cast<double>(row.lambda) : 0.0; };
      axis.limitForce = of(rows.limit), axis.driveForce = of(rows.drive),
      axis.frictionForce = of(rows.friction);
      axis.motorForce = -static_cast<double>(rows.rotor.force);
      addLoad(axisLoad(rows) + rows.rotor.force, jb[0]);
      const double out = excess(own, axis.position);
      error2 += out * out;
      state.axes.push_back(axis);
    } else {
      const GroupSpec& own = partOf<I>(spec.parts);
      for (int i = 0; i < P::kRows && own.mode != GroupMode::Off; ++i) {
        if (own.mode == GroupMode::Hold) error2 += static_cast<double>(error[i] * error[i]);
        addLoad(rows.lambda[i], jb[i]);
      }
    }
  });
  state.broken = joint.broken;
  state.gap = std::sqrt(linear2);
  state.angle = std::sqrt(angular2);
  state.force = force;
  state.torque = moment - cross(rubble::Vec3(leverOf(spec.data, b.q, 1)), force);
}

}  // namespace

void setJointCount(HostTables& tables, int type, int ids) {
  const int slots = slotsFor(ids), before = tables.view().joints[type];
  tables.reserve(perJoint(type), slots);
  // reserve slots are empty, also after fewer joints were loaded
  const int begin = ids < tables.jointIds[type] ? ids : std::min(before, slots);
  withJointType(type, [&]<class F>() {
    JointSpec<F>* const spec = tables.view().specsOf<F>();
    std::fill(spec + begin, spec + slots, JointSpec<F>{});
  });
  tables.jointIds[type] = ids;
  tables.view().joints[type] = slots;
}

void editJoint(HostTables& tables, int slot, const EngineJoint& joint) {
  RUBBLE_ASSERT(slot >= 0 && slot < tables.view().joints[static_cast<int>(joint.type)]);
  withJointType(joint.type, [&]<class F>() { editJointOf<F>(tables, slot, joint); });
}

void setJoint(HostTables& tables, int slot, const EngineJoint& joint) {
  editJoint(tables, slot, joint);
  withJointType(joint.type, [&]<class F>() { tables.view().jointsOf<F>()[slot] = {}; });
}

JointState HostReader::jointState(int type, int slot) const {
  JointState state;
  withJointType(type, [&]<class F>() { measureJoint<F>(data(), slotOfJoint(type, slot), state); });
  return state;
}

std::vector<std::pair<int, int>> HostReader::brokenJoints() const {
  const SolverData& s = data();
  std::vector<std::pair<int, int>> out;
  forEachType(JointTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(JointTypes{});
    for (int i = 0; i < jointSlots(kType); ++i) {
      const int slot = slotOfJoint(kType, i);
      if (s.specsOf<F>()[slot].alive && s.jointsOf<F>()[slot].broken) out.emplace_back(kType, i);
    }
  });
  return out;
}

}  // namespace rubble::RUBBLE_CORE

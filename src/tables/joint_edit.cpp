/// Edits and measures of joints in host memory.
#include <algorithm>

#include "stages/joints/placed_joint.h"
#include "tables/host_reader.h"

namespace rubble::RUBBLE_CORE {

namespace {

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

/// Distance of c outside of the limits.
double excess(const AxisSpec& spec, double c) {
  return std::max({0.0, c - static_cast<double>(spec.hi), static_cast<double>(spec.lo) - c});
}

template <class F> void measureJoint(const SolverData& s, int slot, JointState& state) {
  const PlacedJoint<F> placed(s, slot);
  const JointSpec<F>& spec = placed.spec;
  double linear2 = 0, angular2 = 0;
  forEachPart<F>([&]<int I, class P>() {
    const auto& rows = partOf<I>(placed.joint.parts);
    double& error2 = P::kUnit == RowUnit::Linear ? linear2 : angular2;
    if constexpr (P::kAxis) {
      const AxisSpec& own = partOf<I>(spec.parts);
      JointAxisState axis;
      axis.position = placed.template position<P>();
      axis.speed = static_cast<double>(placed.template speed<P>(s));
      const auto of = [](const AxisRow& row) { return row.active ? -static_cast<double>(row.lambda) : 0.0; };
      axis.limitForce = of(rows.limit), axis.driveForce = of(rows.drive),
      axis.frictionForce = of(rows.friction);
      axis.motorForce = -static_cast<double>(rows.rotor.force);
      const double out = excess(own, axis.position);
      error2 += out * out;
      state.axes.push_back(axis);
    } else if (partOf<I>(spec.parts).mode == GroupMode::Hold) {
      Real error[P::kRows];
      P::constraint(spec.data, placed.memory, placed.a, placed.b, error);
      for (const Real e : error) error2 += static_cast<double>(e * e);
    }
  });
  state.broken = placed.joint.broken;
  state.gap = std::sqrt(linear2);
  state.angle = std::sqrt(angular2);
  Vec3d force, torque;
  placed.load(force, torque);
  state.force = force, state.torque = torque;
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

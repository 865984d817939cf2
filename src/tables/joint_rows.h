#pragma once
/// Joints and sensors as arrays (rubble/arrays.h), on host and device.
#include "stages/contacts/contacts.h"
#include "stages/joints/placed_joint.h"
#include "tables/records.h"
#include "tables/state_rows.h"

namespace rubble::RUBBLE_CORE {

/// An axis of a joint, or a joint (axis 0). Bodies are ids.
struct AxisRef {
  int type, slot, axis;
};
/// A body that an axis acts on, by a side of its joint. Sorted by body, then by axis.
struct AxisSide {
  int body, axis, side;
};

/// Element k of an array: the number of axis k.
struct ReadAxis {
  JointArray which;
  const AxisRef* axes;
  Real* to;

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const AxisRef at = axes[k];
    Real value = 0;
    withJointType(at.type, [&]<class F>() {
      withAxis<F>(at.axis, [&]<int I, class P>() { value = read<F, I, P>(s, at.slot); });
    });
    to[k] = value;
  }

 private:
  template <class F, int I, class P> RUBBLE_HD Real read(const SolverData& s, int slot) const {
    const AxisSpec& spec = partOf<I>(s.specsOf<F>()[slot].parts);
    const AxisRows& rows = partOf<I>(s.jointsOf<F>()[slot].parts);
    const auto force = [](const AxisRow& row) { return row.active ? -row.lambda : Real(0); };
    switch (which) {
      case JointArray::Position:
        return static_cast<Real>(PlacedJoint<F>(s, slot).template position<P>());
      case JointArray::Speed:
        return PlacedJoint<F>(s, slot).template speed<P>(s);
      case JointArray::DriveForce:
        return force(rows.drive);
      case JointArray::LimitForce:
        return force(rows.limit);
      case JointArray::FrictionForce:
        return force(rows.friction);
      case JointArray::LowerLimit:
        return spec.lo <= -kNoLimit ? -kInfinity : spec.lo;
      case JointArray::UpperLimit:
        return spec.hi >= kNoLimit ? kInfinity : spec.hi;
      case JointArray::TargetPosition:
        return spec.target;
      case JointArray::TargetSpeed:
        return spec.speed;
      case JointArray::AppliedForce:
        break;
    }
    return 0;
  }
  static constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
};

/// Value k of a scatter to joints, and its row.
struct AxisValues : ScatterRows {
  int count;  ///< axes
  AxisValues(int axes, const ArrayView& rowView, const ArrayView& valueView)
      : ScatterRows(StateArray::Force, rowView, valueView), count(axes) {}
  /// -1: no axis.
  RUBBLE_HD int row(int k) const {
    const int row = *reinterpret_cast<const int*>(rows + k * rowStride);
    return row >= 0 && row < count ? row : -1;
  }
  RUBBLE_HD Real value(int k) const { return static_cast<Real>(number(k, 0)); }
};

/// Wakes the bodies of an axis.
template <class F> RUBBLE_HD void wakeJoint(const SolverData& s, int slot) {
  const JointSpec<F>& spec = s.specsOf<F>()[slot];
  for (int side = 0; side < kSides<F>; ++side)
    if (const int body = bodyOf(spec, side); body != kWorldBody) wakeBody(s, body);
}

/// Writes value k to the target of its axis.
struct WriteTarget {
  JointArray which;
  const AxisRef* axes;
  AxisValues values;

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int row = values.row(k);
    if (row < 0) return;
    const AxisRef at = axes[row];
    withJointType(at.type, [&]<class F>() {
      withAxis<F>(at.axis, [&]<int I, class P>() {
        AxisSpec& spec = partOf<I>(s.specsOf<F>()[at.slot].parts);
        (which == JointArray::TargetPosition ? spec.target : spec.speed) = values.value(k);
        wakeJoint<F>(s, at.slot);
      });
    });
  }
};

/// Notes value k as the force of its axis.
struct NoteForce {
  AxisValues values;
  Real* forces;  ///< by axis
  RUBBLE_HD void operator()(const SolverData&, int k) const {
    if (const int row = values.row(k); row >= 0) forces[row] = values.value(k);
  }
};
/// Adds the forces of all axes to a body. Entry k does so if it is the first of its body, in the order of the
/// axes.
struct ApplyAxisForces {
  const AxisRef* axes;
  const AxisSide* sides;
  int count;  ///< sides
  const Real* forces;

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int id = sides[k].body;
    if (k > 0 && sides[k - 1].body == id) return;
    const int body = s.placeOf[id];
    for (; k < count && sides[k].body == id; ++k) {
      const Real force = forces[sides[k].axis];
      if (force == Real(0)) continue;
      const AxisRef at = axes[sides[k].axis];
      withJointType(at.type, [&]<class F>() {
        withAxis<F>(at.axis, [&]<int I, class P>() {
          const Vec6 j = PlacedJoint<F>(s, at.slot).template jacobian<P>(sides[k].side);
          s.force[body] += force * j.lin, s.torque[body] += force * j.ang;
        });
      });
      wakeBody(s, body);
    }
  }
};

/// Contact forces as whole numbers, whose sums do not depend on the order.
struct ForceSums {
  std::int64_t x, y, z, normal;
};
inline constexpr double kForceUnit = 1. / (std::int64_t{1} << 32);  ///< [N]: the sums hold 2e9 N

/// Adds the forces of an old pair to both bodies.
struct SumContactForces {
  ForceSums* sums;  ///< by place in the tables
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (s.oldPair[k].other < 0) return;
    Vec3 onB;
    Real normal;
    const OrderedPair o = ordered(s.oldPair[k]);
    if (!contactForce(s, k, onB, normal)) return;
    const auto whole = [](Real a) { return static_cast<std::int64_t>(static_cast<double>(a) / kForceUnit); };
    const ForceSums f{whole(onB.x), whole(onB.y), whole(onB.z), whole(normal)};
    add(sums[o.a], f, -1), add(sums[o.b], f, 1);
  }
  /// Force of an old pair on its second body, and the sum of its normal forces. Returns false if there is
  /// none.
  RUBBLE_HD static bool contactForce(const SolverData& s, int pair, Vec3& onB, Real& normal) {
    const int manifold = manifoldOfOld(s, pair);
    if (manifold < 0) return false;
    const Manifold& m = s.oldManifold[manifold];
    const OrderedPair o = ordered(s.oldPair[pair]);
    // a sleeping pair has no rows, but keeps its multipliers
    if (m.count == 0 || (m.row < 0 && !isAsleep(s, o.a) && !isAsleep(s, o.b))) return false;
    const Vec3 n = m.row < 0 ? m.normal : s.contact[m.row].n;
    Vec3 t1, t2;
    tangentBasis(n, t1, t2);
    onB = {0, 0, 0}, normal = 0;
    for (int k = 0; k < m.count; ++k) {
      const Real fn = m.row < 0 ? m.lambdaN[k] : s.contact[m.row].load[k].lambdaN;
      const Real f1 = m.row < 0 ? m.lambda1[k] : s.contact[m.row].load[k].lambda1;
      const Real f2 = m.row < 0 ? m.lambda2[k] : s.contact[m.row].load[k].lambda2;
      onB += fn * n + f1 * t1 + f2 * t2;
      normal += fn;
    }
    return true;
  }

 private:
  RUBBLE_HD static void add(ForceSums& to, const ForceSums& f, int sign) {
    atomicSum(&to.x, sign * f.x), atomicSum(&to.y, sign * f.y), atomicSum(&to.z, sign * f.z);
    atomicSum(&to.normal, f.normal);
  }
};

/// Row k: the contact force on the second body of pair k of ids.
struct ReadPairForce {
  const int* pairs;  ///< [pairs][2]
  Real* to;          ///< [pairs][3]

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int a = s.placeOf[pairs[2 * k]], b = s.placeOf[pairs[2 * k + 1]];
    Vec3 sum{0, 0, 0};
    for (const int owner : {a, b})
      for (int p = s.oldPairOffset[owner]; p < s.oldPairOffset[owner + 1]; ++p) {
        if (s.oldPair[p].other != a + b - owner) continue;
        Vec3 onB;
        Real normal;
        if (SumContactForces::contactForce(s, p, onB, normal))
          sum += ordered(s.oldPair[p]).b == b ? onB : -onB;
      }
    to[3 * k] = sum.x, to[3 * k + 1] = sum.y, to[3 * k + 2] = sum.z;
  }
};

/// Row k of a sensor array: body of id k, or joint k.
struct ReadSensor {
  SensorArray which;
  const ForceSums* sums;
  const AxisRef* joints;
  Real* to;  ///< [rows][numbers]

  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    if (which == SensorArray::JointForce || which == SensorArray::JointTorque) return readJoint(s, k);
    const int body = s.placeOf[k];
    const auto of = [](std::int64_t sum) { return static_cast<Real>(static_cast<double>(sum) * kForceUnit); };
    if (which == SensorArray::Touch) {
      to[k] = of(sums[body].normal);
    } else if (which == SensorArray::ContactForce) {
      store(k, {of(sums[body].x), of(sums[body].y), of(sums[body].z)});
    } else if (which == SensorArray::AngularRate) {
      store(k, rotateInverse(s.orientation[body], s.angularVelocity[body]));
    } else {
      const StepConstants& c = s.stepOf(body);
      const Vec3 a = c.inverseDt * (s.velocity[body] - s.previousVelocity[body]) - c.gravity;
      store(k, rotateInverse(s.orientation[body], a));
    }
  }

 private:
  RUBBLE_HD void store(int k, const Vec3& v) const {
    to[3 * k] = v.x, to[3 * k + 1] = v.y, to[3 * k + 2] = v.z;
  }
  RUBBLE_HD void readJoint(const SolverData& s, int k) const {
    const AxisRef at = joints[k];
    Vec3d force, torque;
    withJointType(at.type, [&]<class F>() { PlacedJoint<F>(s, at.slot).load(force, torque); });
    store(k, Vec3(which == SensorArray::JointForce ? force : torque));
  }
};

inline int numbersOf(SensorArray which) { return which == SensorArray::Touch ? 1 : 3; }
inline bool isOfJoints(SensorArray which) {
  return which == SensorArray::JointForce || which == SensorArray::JointTorque;
}
inline bool countsContacts(SensorArray which) {
  return which == SensorArray::ContactForce || which == SensorArray::Touch;
}

/// The rows of joint arrays as tables have them.
struct AxisTables {
  std::vector<AxisRef> axes, joints;
  std::vector<AxisSide> sides;
  explicit AxisTables(const JointRows& rows = {});
};

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Joint and sensor arrays of tables in host memory.
#include "tables/host_tables.h"
#include "tables/joint_rows.h"

namespace rubble::RUBBLE_CORE {

class HostJointRows {
 public:
  void set(const JointRows& rows) {
    AxisTables tables(rows);
    forces_.reserve(tables.axes.size());  // so that scatter() needs no memory
    tables_ = std::move(tables);
  }

  ArrayView view(const HostTables& tables, JointArray which) {
    std::vector<Real>& to = axes_[static_cast<int>(which)];
    to.resize(tables_.axes.size());
    forEach(ReadAxis{which, tables_.axes.data(), to.data()}, tables, to.size());
    return packedArray(to.data(), std::ssize(to));
  }
  ArrayView view(const HostTables& tables, SensorArray which) {
    const SolverData& s = tables.view();
    const std::size_t rows = isOfJoints(which) ? tables_.joints.size()
                                               : static_cast<std::size_t>(tables.bodyIds);
    if (countsContacts(which)) {
      sums_.assign(static_cast<std::size_t>(s.bodies), {});
      forEach(SumContactForces{sums_.data()}, tables, static_cast<std::size_t>(s.oldPairOffset[s.bodies]));
    }
    std::vector<Real>& to = sensors_[static_cast<int>(which)];
    to.resize(rows * static_cast<std::size_t>(numbersOf(which)));
    forEach(ReadSensor{which, sums_.data(), tables_.joints.data(), to.data()}, tables, rows);
    return packedArray(to.data(), static_cast<std::int64_t>(rows), numbersOf(which));
  }
  ArrayView contactForces(const HostTables& tables, std::span<const std::array<int, 2>> pairs) {
    pairForces_.resize(3 * pairs.size());
    forEach(ReadPairForce{pairs.empty() ? nullptr : pairs[0].data(), pairForces_.data()}, tables,
            pairs.size());
    return packedArray(pairForces_.data(), std::ssize(pairs), 3);
  }
  void scatter(const HostTables& tables, JointArray which, const ArrayView& rows, const ArrayView& values) {
    const AxisValues given(static_cast<int>(tables_.axes.size()), rows, values);
    const auto count = static_cast<std::size_t>(rows.shape[0]);
    if (which != JointArray::AppliedForce)
      return forEach(WriteTarget{which, tables_.axes.data(), given}, tables, count);
    forces_.assign(tables_.axes.size(), Real(0));
    forEach(NoteForce{given, forces_.data()}, tables, count);
    forEach(ApplyAxisForces{tables_.axes.data(), tables_.sides.data(), static_cast<int>(tables_.sides.size()),
                            forces_.data()},
            tables, tables_.sides.size());
  }

 private:
  template <class Kernel> static void forEach(const Kernel& kernel, const HostTables& tables, std::size_t n) {
    for (std::size_t k = 0; k < n; ++k) kernel(tables.view(), static_cast<int>(k));
  }

  AxisTables tables_;
  std::vector<Real> axes_[static_cast<int>(JointArray::AppliedForce) + 1],
      sensors_[static_cast<int>(SensorArray::JointTorque) + 1], forces_, pairForces_;
  std::vector<ForceSums> sums_;
};

}  // namespace rubble::RUBBLE_CORE

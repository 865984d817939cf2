#pragma once
/// Arrays of joints, one set per joint type.
#include "forces/joint_accumulation.h"
#include "forces/joint_tree.h"
#include "state/array.h"

namespace rubble::RUBBLE_CORE {

/// Arrays of one joint type.
template <class F> struct JointTable {
  Array<JointSpec<F>> spec = nullptr;
  Array<Joint<F>> joint = nullptr;
  Array<TreeRows<F>> treeRows = nullptr;
  Array<JointAngularRows<F>> angularRows = nullptr;  ///< null for types without angular rows
};
template <class List> struct JointTables;
template <class... F> struct JointTables<TypeList<F...>> : JointTable<F>... {};

}  // namespace rubble::RUBBLE_CORE

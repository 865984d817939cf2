#pragma once
/// The arrays of joints, a set for each type.
#include "forces/joint_accumulation.h"
#include "forces/joint_tree.h"

namespace rubble::RUBBLE_CORE {

/// The arrays of one joint type.
template <class F> struct JointTable {
  JointSpec<F>* spec = nullptr;
  Joint<F>* joint = nullptr;
  TreeRows<F>* treeRows = nullptr;
  JointAngularRows<F>* angularRows = nullptr;  ///< none for types that have no parts that turn
};
template <class List> struct JointTables;
template <class... F> struct JointTables<TypeList<F...>> : JointTable<F>... {};

}  // namespace rubble::RUBBLE_CORE

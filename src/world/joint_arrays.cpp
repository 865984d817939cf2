/// Arrays of joints and sensors of a world.
#include "cook/checks.h"
#include "world/world_impl.h"

namespace rubble {

void World::Impl::sendJointRows() {
  flush();
  if (!jointRowsChanged) return;
  JointRows rows;
  for (const JointId id : registry.joints.ids()) {
    const JointRecord& joint = registry.joints[id];
    EngineAxis row{joint.engine.type,
                   joint.engineSlot,
                   0,
                   {joint.a.index, joint.b.index, joint.frameBodyA.index, joint.frameBodyB.index}};
    rows.joints.push_back(row);
    const int count = axisCount(joint.def.type);
    for (int axis = 0; axis < count; ++axis) {
      // axes of six-dof joints may be turned in the engine (EngineJoint::turned)
      row.axis = count < 3 ? axis : axis / 3 * 3 + (axis - joint.engine.turned + 3) % 3;
      rows.axes.push_back(row);
    }
  }
  engine->setJointRows(rows);
  jointRowsChanged = false;
}

std::vector<World::Axis> World::axes() const {
  return withMemory("axes", [&] {
    std::vector<Axis> out;
    for (const JointId id : impl_->registry.joints.ids())
      for (int axis = 0; axis < axisCount(impl_->registry.joints[id].def.type); ++axis)
        out.push_back({id, axis});
    return out;
  });
}

ArrayView World::array(JointArray which) const {
  checks::enumeration(which, JointArray::AppliedForce, "array");
  if (which == JointArray::AppliedForce) throw Error("array", "an array that can be read", "another");
  return withMemory("array", [&] {
    impl_->sendJointRows();
    ArrayView view = impl_->engine->array(which);
    view.epoch = impl_->epoch;
    return view;
  });
}

ArrayView World::array(SensorArray which) const {
  checks::enumeration(which, SensorArray::JointTorque, "array");
  return withMemory("array", [&] {
    impl_->sendJointRows();
    ArrayView view = impl_->engine->array(which);
    view.epoch = impl_->epoch;
    return view;
  });
}

ArrayView World::contactForces(std::span<const std::array<BodyId, 2>> pairs) const {
  return withMemory("contactForces", [&] {
    std::vector<std::array<int, 2>> ids;
    for (const auto& [a, b] : pairs) {
      impl_->requireAlive(a), impl_->requireAlive(b);
      ids.push_back({a.index, b.index});
    }
    impl_->flush();
    return impl_->engine->contactForces(ids);
  });
}

void World::scatter(JointArray which, const ArrayView& rows, const ArrayView& values) {
  withMemory("scatter", [&] { checkScatter(which, rows, values); });
  if (rows.shape[0] == 0) return;
  if (values.device && !impl_->engine->poseCopies())
    throw Error("values", "host memory", "memory of a device");
  withMemory("scatter", [&] {
    impl_->sendJointRows();
    impl_->engine->scatter(which, rows, values);
  });
  impl_->pass(inputs::ScatterJoints{which, rows, values});
}

}  // namespace rubble

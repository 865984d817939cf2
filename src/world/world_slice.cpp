/// The engine of one world of a batch, and rows of joints.
#include <cstring>

#include "world/batch.h"

namespace rubble {

void Batch::setJointRows(int world, const JointRows& rows) {
  JointRows& own = own_.members[static_cast<std::size_t>(world)].rows;
  if (own == rows) return;
  JointRows copy = rows;
  own = std::move(copy), rowsChanged_ = true;
}

void Batch::sendJointRows() {
  flush();
  if (!rowsChanged_) return;
  JointRows all;
  firstAxis_ = firstJoint_ = {0};
  for (const Member& member : own_.members) {
    const auto add = [&](const std::vector<EngineAxis>& from, std::vector<EngineAxis>& to) {
      for (EngineAxis axis : from) {
        const std::vector<int>& slots = member.joints[static_cast<std::size_t>(axis.type)];
        // a world that was reset may not have given its new rows yet
        if (axis.slot >= static_cast<int>(slots.size())) continue;
        axis.slot = slots[static_cast<std::size_t>(axis.slot)];
        for (int& body : axis.bodies)
          if (body >= 0)
            body = body < static_cast<int>(member.bodies.size())
                       ? member.bodies[static_cast<std::size_t>(body)]
                       : -1;
        to.push_back(axis);
      }
    };
    add(member.rows.axes, all.axes), add(member.rows.joints, all.joints);
    firstAxis_.push_back(static_cast<int>(all.axes.size()));
    firstJoint_.push_back(static_cast<int>(all.joints.size()));
  }
  engine_->setJointRows(all);
  rowsChanged_ = false;
}

void WorldSlice::step(StepReport& report) {
  batch_->flush();
  std::vector<char> paused(static_cast<std::size_t>(batch_->count()), 1);
  paused[static_cast<std::size_t>(world_)] = 0;
  batch_->worlds().stepWorlds(report, paused);
}

void WorldSlice::sortBodies() { throw Error("world", "one that is not part of a batch", "one of many"); }

const EngineQueries& WorldSlice::ofWorld(const EngineQueries& asked) {
  batch_->flush();
  for (EngineQuery& q : asked.queries) q.world = world_;
  return asked;
}

void WorldSlice::restore(const EngineSnapshot& snapshot) {
  const WorldSnapshot* const own = &batch_->own(snapshot);
  batch_->prepareToRestore({&world_, 1}, {&own, 1})->commit();
}

ArrayView WorldSlice::bodyRows(ArrayView view) const {
  const std::vector<int>& bodies = batch_->rowsOf(world_);
  view.shape[0] = static_cast<std::int64_t>(bodies.size());
  if (bodies.empty()) return view;
  if (bodies.back() - bodies.front() + 1 != static_cast<int>(bodies.size()))
    throw Error("array", "a world whose bodies were added before those of later worlds", "another");
  view.data = static_cast<const std::byte*>(view.data) + bodies.front() * view.strides[0];
  return view;
}

ArrayView WorldSlice::array(StateArray which) {
  batch_->flush();
  return bodyRows(batch_->engine().array(which));
}

ArrayView WorldSlice::array(JointArray which) {
  batch_->sendJointRows();
  ArrayView view = batch_->engine().array(which);
  view.data = static_cast<const std::byte*>(view.data) + batch_->firstAxis(world_) * view.strides[0];
  view.shape[0] = batch_->firstAxis(world_ + 1) - batch_->firstAxis(world_);
  return view;
}

ArrayView WorldSlice::array(SensorArray which) {
  batch_->sendJointRows();
  ArrayView view = batch_->engine().array(which);
  if (which != SensorArray::JointForce && which != SensorArray::JointTorque) return bodyRows(view);
  view.data = static_cast<const std::byte*>(view.data) + batch_->firstJoint(world_) * view.strides[0];
  view.shape[0] = batch_->firstJoint(world_ + 1) - batch_->firstJoint(world_);
  return view;
}

ArrayView WorldSlice::array(VertexArray which) {
  batch_->flush();
  ArrayView view = batch_->engine().array(which);
  view.data = static_cast<const std::byte*>(view.data) + batch_->firstVertex(world_) * view.strides[0];
  view.shape[0] = batch_->vertices(world_);
  return view;
}

/// `ids`: row in the tables of each row of this world.
void WorldSlice::scatter(const std::vector<int>& ids, auto which, const ArrayView& rows,
                         const ArrayView& values) {
  std::vector<int> there;
  for (std::int64_t k = 0; k < rows.shape[0]; ++k) {
    int id;
    std::memcpy(&id, static_cast<const std::byte*>(rows.data) + k * rows.strides[0], sizeof id);
    there.push_back(id >= 0 && id < static_cast<int>(ids.size()) ? ids[static_cast<std::size_t>(id)] : -1);
  }
  ArrayView inTables = rows;
  inTables.data = there.data(), inTables.strides[0] = sizeof(int);
  batch_->engine().scatter(which, inTables, values);
}

void WorldSlice::scatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  batch_->flush();
  scatter(batch_->rowsOf(world_), which, rows, values);
}

ArrayView WorldSlice::contactForces(std::span<const std::array<int, 2>> pairs) {
  batch_->flush();
  std::vector<std::array<int, 2>> there;
  for (const auto& [a, b] : pairs) there.push_back({row(a), row(b)});
  return batch_->engine().contactForces(there);
}

void WorldSlice::scatter(JointArray which, const ArrayView& rows, const ArrayView& values) {
  batch_->sendJointRows();
  std::vector<int> ids;
  for (int row = batch_->firstAxis(world_); row < batch_->firstAxis(world_ + 1); ++row) ids.push_back(row);
  scatter(ids, which, rows, values);
}

}  // namespace rubble

#include <rubble/c/world.h>

#include "c_api/dlpack.h"
#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

extern "C" {

rb_status rb_world_array(const rb_world* world, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldOf(world).array(stateArrayOf(which))); });
}

rb_status rb_world_joint_array(const rb_world* world, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldOf(world).array(jointArrayOf(which))); });
}

rb_status rb_world_sensor_array(const rb_world* world, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldOf(world).array(sensorArrayOf(which))); });
}

rb_status rb_world_vertex_array(const rb_world* world, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldOf(world).array(vertexArrayOf(which))); });
}

rb_status rb_world_first_vertex(const rb_world* world, rb_deformable_id object, int32_t* row) {
  return guarded([&] { need(row, "row") = worldOf(world).firstVertex(idOf(object)); });
}

rb_status rb_world_contact_forces(const rb_world* world, const rb_body_id* pairs, int64_t count,
                                  rb_array* array) {
  return guarded([&] {
    const std::vector<BodyId> ids = idsOf(pairs, 2 * count);
    std::vector<std::array<BodyId, 2>> of;
    for (std::size_t k = 0; k < ids.size(); k += 2) of.push_back({ids[k], ids[k + 1]});
    need(array, "array") = toC(worldOf(world).contactForces(of));
  });
}

rb_status rb_world_axes(rb_world* world, const rb_joint_id** joints, const int32_t** axes, int64_t* count) {
  return guarded([&] {
    World& own = worldOf(world);
    world->axisJoints.clear(), world->axes.clear();
    for (const World::Axis& axis : own.axes())
      world->axisJoints.push_back(idOf(axis.joint)), world->axes.push_back(axis.axis);
    give(world->axisJoints, joints, count), give(world->axes, axes, count);
  });
}

rb_status rb_world_scatter_joints(rb_world* world, int32_t which, const rb_array* rows,
                                  const rb_array* values) {
  return guarded([&] {
    worldOf(world).scatter(jointArrayOf(which), fromC(need(rows, "rows")), fromC(need(values, "values")));
  });
}

int64_t rb_world_epoch(const rb_world* world) { return world ? world->world->epoch() : -1; }

rb_status rb_world_device(const rb_world* world, int32_t* device, uint64_t* stream) {
  return guarded([&] {
    const DeviceStream own = worldOf(world).deviceStream();
    need(device, "device") = own.device, need(stream, "stream") = own.stream;
  });
}

rb_status rb_world_dlpack(rb_world* world, int32_t which, void** tensor) {
  constexpr std::uint64_t kLegacyStream = 1;
  return guarded([&] {
    const ArrayView array = worldOf(world).array(stateArrayOf(which));
    need(tensor, "tensor") = dlpack::tensorOn(world->world, array, kLegacyStream);
  });
}

rb_status rb_world_dlpack_of(rb_world* world, const rb_array* array, uint64_t stream, void** tensor) {
  return guarded([&] {
    need(world, "world");
    need(tensor, "tensor") = dlpack::tensorOn(world->world, fromC(need(array, "array")), stream);
  });
}

rb_status rb_world_sort_bodies(rb_world* world) {
  return guarded([&] { worldOf(world).sortBodies(); });
}

rb_status rb_world_scatter(rb_world* world, int32_t which, const rb_array* rows, const rb_array* values) {
  return guarded([&] {
    worldOf(world).scatter(stateArrayOf(which), fromC(need(rows, "rows")), fromC(need(values, "values")));
  });
}

rb_status rb_world_begin_poses(rb_world* world) {
  return guarded([&] { worldOf(world).beginPoses(); });
}

int32_t rb_world_poses_ready(const rb_world* world) { return world && world->world->posesReady(); }

rb_status rb_world_take_poses(rb_world* world, rb_pose_frame* frame) {
  return guarded([&] {
    const PoseFrame taken = worldOf(world).takePoses();
    need(frame, "frame") = {taken.step, taken.time, toC(taken.position), toC(taken.orientation)};
  });
}
}

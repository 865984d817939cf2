#include <rubble/c/world.h>

#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

int Surroundings::add(BodyId id) {
  if (id.index < 0) return kWorld;
  const auto found = std::find(ids_.begin(), ids_.end(), id);
  if (found != ids_.end()) return static_cast<int>(found - ids_.begin());
  BodyDef body = world_.definition(id);
  const BodyState state = world_.state(id);
  body.position = state.position, body.orientation = state.orientation;
  scene_.bodies.push_back(std::move(body));
  ids_.push_back(id);
  return static_cast<int>(ids_.size()) - 1;
}

extern "C" {

rb_status rb_world_add_joint(rb_world* world, const char* json, rb_body_id a, rb_body_id b,
                             rb_body_id frame_a, rb_body_id frame_b, rb_joint_id* joint) {
  return guarded([&] {
    Surroundings around(worldOf(world));
    const std::array<int, 4> bodies{around.add(idOf(a)), around.add(idOf(b)), around.add(idOf(frame_a)),
                                    around.add(idOf(frame_b))};
    const JointDef def = io::parseJoint(textOr(json, ""), around.scene(), bodies);
    const JointId added = worldOf(world).addJoint(def, idOf(a), idOf(b), idOf(frame_a), idOf(frame_b));
    if (joint) *joint = idOf(added);
  });
}

rb_status rb_world_add_coupling(rb_world* world, const char* json, rb_joint_id a, rb_joint_id b,
                                rb_joint_id* joint) {
  return guarded([&] {
    Surroundings around(worldOf(world));
    for (const JointId id : {idOf(a), idOf(b)}) {
      JointDef def = worldOf(world).definition(id);
      const auto bodies = worldOf(world).bodiesOf(id);
      def.bodyA = around.add(bodies[0]), def.bodyB = around.add(bodies[1]);
      def.frameBodyA = def.frameBodyB = kWorld;
      around.scene().joints.push_back(std::move(def));
    }
    const JointDef def = io::parseCoupling(textOr(json, ""), around.scene());
    const JointId added = worldOf(world).addJoint(def, around.id(def.bodyA), around.id(def.bodyB),
                                                  around.id(def.frameBodyA), around.id(def.frameBodyB));
    if (joint) *joint = idOf(added);
  });
}

rb_status rb_world_remove_joint(rb_world* world, rb_joint_id joint) {
  return guarded([&] { worldOf(world).removeJoint(idOf(joint)); });
}

int32_t rb_world_joint_alive(const rb_world* world, rb_joint_id joint) {
  return world && world->world->alive(idOf(joint));
}

rb_status rb_world_joints(rb_world* world, const rb_joint_id** joints, int64_t* count) {
  return guarded([&] { giveIds(need(world, "world").joints, worldOf(world).joints(), joints, count); });
}

rb_status rb_world_find_joint(const rb_world* world, const char* name, rb_joint_id* joint) {
  return guarded([&] { need(joint, "joint") = idOf(worldOf(world).findJoint(textOr(name, ""))); });
}

rb_status rb_world_joint_definition(const rb_world* world, rb_joint_id joint, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldOf(world).definition(idOf(joint)))); });
}

rb_status rb_world_joint_name(const rb_world* world, rb_joint_id joint, const char** name) {
  return guarded([&] { need(name, "name") = worldOf(world).definition(idOf(joint)).name.c_str(); });
}

rb_status rb_world_joint_bodies(const rb_world* world, rb_joint_id joint, rb_body_id bodies[4]) {
  return guarded([&] {
    need(bodies, "bodies");
    for (const BodyId id : worldOf(world).bodiesOf(idOf(joint))) *bodies++ = idOf(id);
    for (const BodyId id : worldOf(world).frameBodiesOf(idOf(joint))) *bodies++ = idOf(id);
  });
}

rb_status rb_world_joint_state(const rb_world* world, rb_joint_id joint, rb_joint_state* state) {
  return guarded([&] { need(state, "state") = toC(worldOf(world).state(idOf(joint))); });
}

rb_status rb_world_joint_user_data(const rb_world* world, rb_joint_id joint, uint64_t* user_data) {
  return guarded([&] { need(user_data, "user_data") = worldOf(world).userData(idOf(joint)); });
}

rb_status rb_world_set_joint_user_data(rb_world* world, rb_joint_id joint, uint64_t user_data) {
  return guarded([&] { worldOf(world).setUserData(idOf(joint), user_data); });
}

rb_status rb_world_set_joint(rb_world* world, rb_joint_id joint, const char* json) {
  return guarded([&] {
    JointDef def = worldOf(world).definition(idOf(joint));
    io::parseJointValues(textOr(json, ""), def);
    worldOf(world).setDefinition(idOf(joint), def);
  });
}

rb_status rb_world_set_target_position(rb_world* world, rb_joint_id joint, int32_t axis, double position) {
  return guarded([&] { worldOf(world).setTargetPosition(idOf(joint), axis, position); });
}

rb_status rb_world_set_target_speed(rb_world* world, rb_joint_id joint, int32_t axis, double speed) {
  return guarded([&] { worldOf(world).setTargetSpeed(idOf(joint), axis, speed); });
}

rb_status rb_world_set_motor_force(rb_world* world, rb_joint_id joint, int32_t axis, double force) {
  return guarded([&] { worldOf(world).setMotorForce(idOf(joint), axis, force); });
}

rb_status rb_world_set_limits(rb_world* world, rb_joint_id joint, int32_t axis, double min, double max) {
  return guarded([&] { worldOf(world).setLimits(idOf(joint), axis, min, max); });
}

rb_status rb_world_set_length(rb_world* world, rb_joint_id joint, double length) {
  return guarded([&] { worldOf(world).setLength(idOf(joint), length); });
}

rb_status rb_world_set_drive_orientation(rb_world* world, rb_joint_id joint, const double orientation[4]) {
  return guarded([&] { worldOf(world).setDriveOrientation(idOf(joint), quat(orientation)); });
}

rb_status rb_world_add_drag_joint(rb_world* world, rb_body_id body, const double point[3], double max_force,
                                  double frequency, rb_joint_id* joint) {
  return guarded([&] {
    const JointId added = worldOf(world).addDragJoint(idOf(body), vec(point), max_force, frequency);
    if (joint) *joint = idOf(added);
  });
}

rb_status rb_world_set_drag_target(rb_world* world, rb_joint_id joint, const double target[3]) {
  return guarded([&] { worldOf(world).setDragTarget(idOf(joint), vec(target)); });
}
}

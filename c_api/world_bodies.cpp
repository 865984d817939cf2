#include <rubble/c/world.h>

#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

namespace {

void givePoints(std::vector<rb_contact_point>& kept, const std::vector<ContactPoint>& points,
                const rb_contact_point** list, int64_t* count) {
  kept.clear();
  for (const ContactPoint& point : points) kept.push_back(toC(point));
  give(kept, list, count);
}

}  // namespace

extern "C" {

rb_status rb_world_add_body(rb_world* world, const char* json, rb_body_id* body) {
  return guarded([&] {
    const BodyId added = worldOf(world).addBody(io::parseBody(textOr(json, "")));
    if (body) *body = idOf(added);
  });
}

rb_status rb_world_add_bodies(rb_world* world, const char* json, const rb_body_id** bodies, int64_t* count) {
  return guarded([&] {
    giveIds(need(world, "world").added, worldOf(world).addBodies(io::parseBodies(textOr(json, ""))), bodies,
            count);
  });
}

rb_status rb_world_remove_bodies(rb_world* world, const rb_body_id* bodies, int64_t count) {
  return guarded([&] { worldOf(world).removeBodies(idsOf(bodies, count)); });
}

rb_status rb_world_set_collide(rb_world* world, rb_body_id a, rb_body_id b, int32_t collide) {
  return guarded([&] { worldOf(world).setCollide(idOf(a), idOf(b), collide != 0); });
}

int32_t rb_world_body_alive(const rb_world* world, rb_body_id body) {
  return world && world->world->alive(idOf(body));
}

rb_status rb_world_bodies(rb_world* world, const rb_body_id** bodies, int64_t* count) {
  return guarded([&] { giveIds(need(world, "world").bodies, worldOf(world).bodies(), bodies, count); });
}

rb_status rb_world_find_body(const rb_world* world, const char* name, rb_body_id* body) {
  return guarded([&] { need(body, "body") = idOf(worldOf(world).findBody(textOr(name, ""))); });
}

rb_status rb_world_body_at(const rb_world* world, int32_t index, rb_body_id* body) {
  return guarded([&] { need(body, "body") = idOf(worldOf(world).bodyAt(index)); });
}

rb_status rb_world_body_definition(const rb_world* world, rb_body_id body, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldOf(world).definition(idOf(body)))); });
}

rb_status rb_world_set_body(rb_world* world, rb_body_id body, const char* json) {
  return guarded([&] {
    BodyDef def = worldOf(world).definition(idOf(body));
    io::parseBodyValues(textOr(json, ""), def);
    worldOf(world).setDefinition(idOf(body), def);
  });
}

rb_status rb_world_body_name(const rb_world* world, rb_body_id body, const char** name) {
  return guarded([&] { need(name, "name") = worldOf(world).definition(idOf(body)).name.c_str(); });
}

rb_status rb_world_body_mass(const rb_world* world, rb_body_id body, rb_mass* mass) {
  return guarded([&] { need(mass, "mass") = toC(worldOf(world).massOf(idOf(body))); });
}

rb_status rb_world_body_state(const rb_world* world, rb_body_id body, rb_body_state* state) {
  return guarded([&] { need(state, "state") = toC(worldOf(world).state(idOf(body))); });
}

rb_status rb_world_set_body_state(rb_world* world, rb_body_id body, const rb_body_state* state) {
  return guarded([&] { worldOf(world).setState(idOf(body), fromC(need(state, "state"))); });
}

rb_status rb_world_body_states(const rb_world* world, const rb_body_id* bodies, int64_t count,
                               rb_body_state* states) {
  return guarded([&] {
    if (count > 0) need(states, "states");
    for (const BodyId id : idsOf(bodies, count)) *states++ = toC(worldOf(world).state(id));
  });
}

rb_status rb_world_set_body_states(rb_world* world, const rb_body_id* bodies, int64_t count,
                                   const rb_body_state* states) {
  return guarded([&] {
    worldOf(world).setStates(idsOf(bodies, count),
                             mapped(states, count, [](const rb_body_state& state) { return fromC(state); }));
  });
}

rb_status rb_world_set_velocity(rb_world* world, rb_body_id body, const double velocity[3],
                                const double angular_velocity[3]) {
  return guarded([&] { worldOf(world).setVelocity(idOf(body), vec(velocity), vec(angular_velocity)); });
}

rb_status rb_world_body_user_data(const rb_world* world, rb_body_id body, uint64_t* user_data) {
  return guarded([&] { need(user_data, "user_data") = worldOf(world).userData(idOf(body)); });
}

rb_status rb_world_set_body_user_data(rb_world* world, rb_body_id body, uint64_t user_data) {
  return guarded([&] { worldOf(world).setUserData(idOf(body), user_data); });
}

rb_status rb_world_joints_of(rb_world* world, rb_body_id body, const rb_joint_id** joints, int64_t* count) {
  return guarded(
      [&] { giveIds(need(world, "world").jointsOf, worldOf(world).jointsOf(idOf(body)), joints, count); });
}

rb_status rb_world_material_of(const rb_world* world, rb_body_id body, int32_t part, const char** json) {
  return guarded(
      [&] { need(json, "json") = keepText(io::toJson(worldOf(world).materialOf(idOf(body), part))); });
}

rb_status rb_world_set_target(rb_world* world, rb_body_id body, const double position[3],
                              const double orientation[4]) {
  return guarded([&] { worldOf(world).setTarget(idOf(body), vec(position), quat(orientation)); });
}

rb_status rb_world_apply_force(rb_world* world, rb_body_id body, const double force[3]) {
  return guarded([&] { worldOf(world).applyForce(idOf(body), vec(force)); });
}

rb_status rb_world_apply_force_at(rb_world* world, rb_body_id body, const double force[3],
                                  const double point[3]) {
  return guarded([&] { worldOf(world).applyForceAt(idOf(body), vec(force), vec(point)); });
}

rb_status rb_world_apply_torque(rb_world* world, rb_body_id body, const double torque[3]) {
  return guarded([&] { worldOf(world).applyTorque(idOf(body), vec(torque)); });
}

rb_status rb_world_apply_impulse(rb_world* world, rb_body_id body, const double impulse[3]) {
  return guarded([&] { worldOf(world).applyImpulse(idOf(body), vec(impulse)); });
}

rb_status rb_world_apply_impulse_at(rb_world* world, rb_body_id body, const double impulse[3],
                                    const double point[3]) {
  return guarded([&] { worldOf(world).applyImpulseAt(idOf(body), vec(impulse), vec(point)); });
}

rb_status rb_world_apply_angular_impulse(rb_world* world, rb_body_id body, const double impulse[3]) {
  return guarded([&] { worldOf(world).applyAngularImpulse(idOf(body), vec(impulse)); });
}

rb_status rb_world_apply_forces(rb_world* world, const rb_body_id* bodies, int64_t count,
                                const double* forces, const double* torques) {
  return guarded([&] {
    const std::vector<Vec3> moments = torques ? vectorsOf(torques, count) : std::vector<Vec3>{};
    worldOf(world).applyForces(idsOf(bodies, count), vectorsOf(forces, count), moments);
  });
}

rb_status rb_world_apply_impulses(rb_world* world, const rb_body_id* bodies, int64_t count,
                                  const double* impulses) {
  return guarded([&] { worldOf(world).applyImpulses(idsOf(bodies, count), vectorsOf(impulses, count)); });
}

rb_status rb_world_contacts(rb_world* world, const rb_contact_point** contacts, int64_t* count) {
  return guarded(
      [&] { givePoints(need(world, "world").contacts, worldOf(world).contacts(), contacts, count); });
}

rb_status rb_world_contacts_of(rb_world* world, rb_body_id body, const rb_contact_point** contacts,
                               int64_t* count) {
  return guarded([&] {
    givePoints(need(world, "world").contactsOf, worldOf(world).contactsOf(idOf(body)), contacts, count);
  });
}

rb_status rb_world_contact_load(const rb_world* world, rb_body_id body, rb_contact_load* load) {
  return guarded([&] {
    const ContactLoad found = worldOf(world).contactLoad(idOf(body));
    rb_contact_load& out = need(load, "load");
    store(found.force, out.force), store(found.torque, out.torque);
    out.residual = found.residual, out.points = found.points;
  });
}

rb_status rb_world_solver_states(rb_world* world, const rb_solver_state** states, int64_t* count) {
  return guarded([&] {
    need(world, "world").solverStates.clear();
    for (const SolverState& s : worldOf(world).solverStates())
      world->solverStates.push_back({s.color, s.stiffness, s.multiplier});
    give(world->solverStates, states, count);
  });
}

rb_status rb_world_events(rb_world* world, rb_events* events) {
  return guarded([&] {
    const Events& found = worldOf(world).events();
    world->contactEvents.clear(), world->eventPoints.clear();
    world->jointEvents.clear(), world->sleepEvents.clear();
    for (const ContactEvent& event : found.contacts) {
      rb_contact_event out{};
      out.phase = static_cast<int32_t>(event.phase), out.sensor = event.sensor;
      out.a = idOf(event.a), out.b = idOf(event.b);
      out.user_data_a = event.userDataA, out.user_data_b = event.userDataB;
      out.shape_user_data_a = event.shapeUserDataA, out.shape_user_data_b = event.shapeUserDataB;
      store(event.impulse, out.impulse);
      out.first_point = static_cast<int64_t>(world->eventPoints.size());
      out.point_count = static_cast<int64_t>(event.points.size());
      for (const ContactPoint& point : event.points) world->eventPoints.push_back(toC(point));
      world->contactEvents.push_back(out);
    }
    for (const JointEvent& event : found.joints) {
      rb_joint_event out{};
      out.joint = idOf(event.joint), out.a = idOf(event.a), out.b = idOf(event.b);
      out.user_data = event.userData;
      store(event.force, out.force), store(event.torque, out.torque);
      world->jointEvents.push_back(out);
    }
    for (const SleepEvent& event : found.sleeps)
      world->sleepEvents.push_back({idOf(event.body), event.asleep, event.userData});
    rb_events& out = need(events, "events");
    give(world->contactEvents, &out.contacts, &out.contact_count);
    give(world->eventPoints, &out.points, &out.point_count);
    give(world->jointEvents, &out.joints, &out.joint_count);
    give(world->sleepEvents, &out.sleeps, &out.sleep_count);
  });
}

rb_status rb_world_asleep(const rb_world* world, rb_body_id body, int32_t* asleep) {
  return guarded([&] { need(asleep, "asleep") = worldOf(world).asleep(idOf(body)); });
}

rb_status rb_world_wake(rb_world* world, rb_body_id body) {
  return guarded([&] { worldOf(world).wake(idOf(body)); });
}
}

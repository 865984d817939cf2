#include <rubble/c/world.h>

#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

namespace {

void addTo(std::vector<double>& out, const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); }

}  // namespace

extern "C" {

rb_status rb_world_add_deformable(rb_world* world, const char* json, rb_deformable_id* object) {
  return guarded([&] {
    const DeformableId added = worldOf(world).addDeformable(io::parseDeformable(textOr(json, "")));
    if (object) *object = idOf(added);
  });
}

rb_status rb_world_remove_deformable(rb_world* world, rb_deformable_id object) {
  return guarded([&] { worldOf(world).removeDeformable(idOf(object)); });
}

int32_t rb_world_deformable_alive(const rb_world* world, rb_deformable_id object) {
  return world && world->world->alive(idOf(object));
}

rb_status rb_world_deformables(rb_world* world, const rb_deformable_id** objects, int64_t* count) {
  return guarded(
      [&] { giveIds(need(world, "world").deformables, worldOf(world).deformables(), objects, count); });
}

rb_status rb_world_find_deformable(const rb_world* world, const char* name, rb_deformable_id* object) {
  return guarded([&] { need(object, "object") = idOf(worldOf(world).findDeformable(textOr(name, ""))); });
}

rb_status rb_world_deformable_at(const rb_world* world, int32_t index, rb_deformable_id* object) {
  return guarded([&] { need(object, "object") = idOf(worldOf(world).deformableAt(index)); });
}

rb_status rb_world_deformable_definition(const rb_world* world, rb_deformable_id object, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldOf(world).definition(idOf(object)))); });
}

rb_status rb_world_set_deformable(rb_world* world, rb_deformable_id object, const char* json) {
  return guarded([&] {
    Deformable def = worldOf(world).definition(idOf(object));
    io::parseDeformableValues(textOr(json, ""), def);
    worldOf(world).setDefinition(idOf(object), def);
  });
}

rb_status rb_world_deformable_name(const rb_world* world, rb_deformable_id object, const char** name) {
  return guarded([&] { need(name, "name") = common(worldOf(world).definition(idOf(object))).name.c_str(); });
}

rb_status rb_world_deformable_user_data(const rb_world* world, rb_deformable_id object, uint64_t* user_data) {
  return guarded([&] { need(user_data, "user_data") = worldOf(world).userData(idOf(object)); });
}

rb_status rb_world_set_deformable_user_data(rb_world* world, rb_deformable_id object, uint64_t user_data) {
  return guarded([&] { worldOf(world).setUserData(idOf(object), user_data); });
}

rb_status rb_world_vertex_count(const rb_world* world, rb_deformable_id object, int64_t* count) {
  return guarded([&] { need(count, "count") = worldOf(world).vertexCount(idOf(object)); });
}

rb_status rb_world_vertex_positions(const rb_world* world, rb_deformable_id object, double* positions,
                                    int64_t count) {
  return guarded([&] { storeAll(worldOf(world).positions(idOf(object)), positions, count); });
}

rb_status rb_world_vertex_velocities(const rb_world* world, rb_deformable_id object, double* velocities,
                                     int64_t count) {
  return guarded([&] { storeAll(worldOf(world).velocities(idOf(object)), velocities, count); });
}

rb_status rb_world_vertex_masses(const rb_world* world, rb_deformable_id object, double* masses,
                                 int64_t count) {
  return guarded([&] {
    const std::vector<double> found = worldOf(world).masses(idOf(object));
    if (static_cast<int64_t>(found.size()) > count)
      throw Error("count", "room for " + std::to_string(found.size()) + " numbers", std::to_string(count));
    std::copy(found.begin(), found.end(), masses);
  });
}

rb_status rb_world_set_vertices(rb_world* world, rb_deformable_id object, const double* positions,
                                const double* velocities, int64_t count) {
  return guarded([&] {
    worldOf(world).setVertices(idOf(object), vectorsOf(positions, count), vectorsOf(velocities, count));
  });
}

rb_status rb_world_apply_vertex_force(rb_world* world, rb_deformable_id object, int32_t vertex,
                                      const double force[3]) {
  return guarded([&] { worldOf(world).applyVertexForce(idOf(object), vertex, vec(force)); });
}

rb_status rb_world_surface(rb_world* world, rb_deformable_id object, rb_surface* surface) {
  return guarded([&] {
    const World::Surface found = worldOf(world).surface(idOf(object));
    world->surfaceVertices.clear(), world->surfaceTriangles.clear(), world->surfaceSegments.clear();
    for (const Vec3& vertex : found.vertices) addTo(world->surfaceVertices, vertex);
    for (const auto& t : found.triangles)
      world->surfaceTriangles.insert(world->surfaceTriangles.end(), t.begin(), t.end());
    for (const auto& s : found.segments)
      world->surfaceSegments.insert(world->surfaceSegments.end(), s.begin(), s.end());
    rb_surface& out = need(surface, "surface");
    out = {world->surfaceVertices.data(),
           static_cast<int64_t>(found.vertices.size()),
           world->surfaceTriangles.data(),
           static_cast<int64_t>(found.triangles.size()),
           world->surfaceSegments.data(),
           static_cast<int64_t>(found.segments.size()),
           found.radius,
           found.spheres};
  });
}

rb_status rb_world_add_attachment(rb_world* world, const char* json, rb_deformable_id object, rb_body_id body,
                                  rb_deformable_id other, rb_attachment_id* attachment) {
  return guarded([&] {
    const AttachmentDef def = io::parseAttachment(textOr(json, ""));
    const AttachmentId added = worldOf(world).addAttachment(def, idOf(object), idOf(body), idOf(other));
    if (attachment) *attachment = idOf(added);
  });
}

rb_status rb_world_remove_attachment(rb_world* world, rb_attachment_id attachment) {
  return guarded([&] { worldOf(world).removeAttachment(idOf(attachment)); });
}

int32_t rb_world_attachment_alive(const rb_world* world, rb_attachment_id attachment) {
  return world && world->world->alive(idOf(attachment));
}

rb_status rb_world_attachments(rb_world* world, const rb_attachment_id** attachments, int64_t* count) {
  return guarded(
      [&] { giveIds(need(world, "world").attachments, worldOf(world).attachments(), attachments, count); });
}

rb_status rb_world_attachment_state(const rb_world* world, rb_attachment_id attachment,
                                    rb_joint_state* state) {
  return guarded([&] { need(state, "state") = toC(worldOf(world).state(idOf(attachment))); });
}

rb_status rb_world_attachment_ends(const rb_world* world, rb_attachment_id attachment,
                                   rb_attachment_ends* ends) {
  return guarded([&] {
    const World::AttachmentEnds found = worldOf(world).endsOf(idOf(attachment));
    rb_attachment_ends& out = need(ends, "ends");
    out.object = idOf(found.object), out.other_object = idOf(found.otherObject);
    out.body = idOf(found.body);
    store(found.anchor, out.anchor);
  });
}

rb_status rb_world_vertex_contacts(rb_world* world, const rb_vertex_contact** contacts, int64_t* count) {
  return guarded([&] {
    need(world, "world").vertexContacts.clear();
    for (const VertexContact& c : worldOf(world).vertexContacts()) {
      rb_vertex_contact out{};
      out.object = idOf(c.object), out.vertex = c.vertex, out.body = idOf(c.body);
      out.other_object = idOf(c.otherObject), out.other_vertex = c.otherVertex, out.depth = c.depth;
      store(c.normal, out.normal), store(c.force, out.force);
      world->vertexContacts.push_back(out);
    }
    give(world->vertexContacts, contacts, count);
  });
}

rb_status rb_world_vertex_solver_states(rb_world* world, rb_deformable_id object,
                                        const rb_solver_state** states, int64_t* count) {
  return guarded([&] {
    need(world, "world").vertexSolverStates.clear();
    for (const SolverState& s : worldOf(world).solverStates(idOf(object)))
      world->vertexSolverStates.push_back({s.color, s.stiffness, s.multiplier});
    give(world->vertexSolverStates, states, count);
  });
}
}

#include <rubble/c/world.h>

#include "c_api/handles.h"
#include "io/definition_json.h"
#include "io/shape_json.h"

using namespace rubble;
using namespace rubble::c;

extern "C" {

rb_status rb_world_add_shape(rb_world* world, const rb_shape* shape, rb_shape_id* id) {
  return guarded([&] {
    const Shape& added = need(shape, "shape").shape;
    need(id, "id") = idOf(worldOf(world).addShape(added));
  });
}

rb_status rb_world_remove_shape(rb_world* world, rb_shape_id id) {
  return guarded([&] { worldOf(world).removeShape(idOf(id)); });
}

int32_t rb_world_shape_alive(const rb_world* world, rb_shape_id id) {
  return world && world->world->alive(idOf(id));
}

rb_status rb_world_shapes(rb_world* world, const rb_shape_id** shapes, int64_t* count) {
  return guarded([&] { giveIds(need(world, "world").shapes, worldOf(world).shapes(), shapes, count); });
}

rb_status rb_world_shape_of(const rb_world* world, rb_body_id body, rb_shape_id* id) {
  return guarded([&] { need(id, "id") = idOf(worldOf(world).shapeOf(idOf(body))); });
}

rb_status rb_world_shape_definition(const rb_world* world, rb_shape_id id, const char** json) {
  return guarded(
      [&] { need(json, "json") = keepText(io::shapeJson(worldOf(world).definition(idOf(id))).dump()); });
}

rb_status rb_world_shape_uses(const rb_world* world, rb_shape_id id, int64_t* uses) {
  return guarded([&] { need(uses, "uses") = worldOf(world).useCount(idOf(id)); });
}

rb_status rb_world_shape_user_data(const rb_world* world, rb_body_id body, int32_t part,
                                   uint64_t* user_data) {
  return guarded([&] { need(user_data, "user_data") = worldOf(world).shapeUserData(idOf(body), part); });
}

rb_status rb_world_add_body_of(rb_world* world, rb_shape_id shape, const char* json, rb_body_id* body) {
  return guarded([&] {
    BodyDef def;
    def.shape = worldOf(world).definition(idOf(shape));
    io::parseBodyValues(textOr(json, "{}"), def);
    const BodyId added = worldOf(world).addBody(def);
    if (body) *body = idOf(added);
  });
}

rb_status rb_world_set_shape(rb_world* world, rb_body_id body, rb_shape_id shape) {
  return guarded([&] { worldOf(world).setShape(idOf(body), worldOf(world).definition(idOf(shape))); });
}
}

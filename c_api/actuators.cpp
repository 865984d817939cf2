#include <rubble/actuators.h>
#include <rubble/c/world.h>
#include <rubble/c/worlds.h>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

/// Of a world, or of worlds of a batch.
struct rb_actuators {
  std::shared_ptr<World> world;
  std::shared_ptr<Worlds> worlds;
  Actuators actuators;
};

extern "C" {

rb_status rb_actuators_create(const rb_scene* scene, rb_world* world, rb_actuators** actuators) {
  return guarded([&] {
    Actuators made(need(scene, "scene").file.actuators, worldOf(world));
    need(actuators, "actuators") = new rb_actuators{world->world, nullptr, std::move(made)};
  });
}

rb_status rb_actuators_create_in(const rb_scene* scene, rb_worlds* worlds, int32_t first, int32_t count,
                                 rb_actuators** actuators) {
  return guarded([&] {
    const std::shared_ptr<Worlds>& batch = need(worlds, "worlds").worlds;
    Actuators made(need(scene, "scene").file.actuators, *batch, first, count);
    need(actuators, "actuators") = new rb_actuators{nullptr, batch, std::move(made)};
  });
}

void rb_actuators_destroy(rb_actuators* actuators) { delete actuators; }

rb_status rb_actuators_list(const rb_actuators* actuators, const char** json) {
  return guarded([&] {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const ActuatorDef& each : need(actuators, "actuators").actuators.definitions())
      list.push_back(
          {{"name", each.name}, {"type", keyword(each.type)}, {"dynamics", keyword(each.dynamics)}});
    need(json, "json") = keepText(list.dump());
  });
}

rb_status rb_actuators_arrays(rb_actuators* actuators, double** controls, double** activations,
                              const double** forces) {
  return guarded([&] {
    Actuators& own = need(actuators, "actuators").actuators;
    if (controls) *controls = own.controls().data();
    if (activations) *activations = own.activations().data();
    if (forces) *forces = own.forces().data();
  });
}

rb_status rb_actuators_apply_in(rb_actuators* actuators, const uint8_t* active) {
  return guarded([&] {
    auto& [world, worlds, own] = need(actuators, "actuators");
    if (world) return own.apply(*world);
    std::vector<char> mask;
    if (active) mask.assign(active, active + worlds->count());
    own.apply(*worlds, mask);
  });
}

rb_status rb_actuators_apply(rb_actuators* actuators) { return rb_actuators_apply_in(actuators, nullptr); }
}

#include <rubble/actuators.h>
#include <rubble/c/world.h>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

struct rb_actuators {
  std::shared_ptr<World> world;
  Actuators actuators;
};

extern "C" {

rb_status rb_actuators_create(const rb_scene* scene, rb_world* world, rb_actuators** actuators) {
  return guarded([&] {
    Actuators made(need(scene, "scene").file.actuators, worldOf(world));
    need(actuators, "actuators") = new rb_actuators{world->world, std::move(made)};
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

rb_status rb_actuators_apply(rb_actuators* actuators) {
  return guarded([&] { need(actuators, "actuators").actuators.apply(*actuators->world); });
}
}

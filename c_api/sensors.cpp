#include <rubble/c/world.h>
#include <rubble/sensors.h>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

struct rb_sensors {
  std::shared_ptr<World> world;
  Sensors sensors;
};

extern "C" {

rb_status rb_sensors_create(const rb_scene* scene, rb_world* world, rb_sensors** sensors) {
  return guarded([&] {
    Sensors made(need(scene, "scene").file.sensors, worldOf(world));
    need(sensors, "sensors") = new rb_sensors{world->world, std::move(made)};
  });
}

void rb_sensors_destroy(rb_sensors* sensors) { delete sensors; }

rb_status rb_sensors_list(const rb_sensors* sensors, const char** json) {
  return guarded([&] {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    int first = 0;
    for (const SensorDef& sensor : need(sensors, "sensors").sensors.definitions()) {
      const int count = readingSize(sensor.type);
      list.push_back(
          {{"name", sensor.name}, {"type", keyword(sensor.type)}, {"first", first}, {"count", count}});
      first += count;
    }
    need(json, "json") = keepText(list.dump());
  });
}

rb_status rb_sensors_update(rb_sensors* sensors, const double** values, int64_t* count) {
  return guarded([&] {
    Sensors& own = need(sensors, "sensors").sensors;
    own.update(*sensors->world);
    if (values) *values = own.values().data();
    if (count) *count = static_cast<int64_t>(own.values().size());
  });
}
}

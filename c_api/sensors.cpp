#include <rubble/c/world.h>
#include <rubble/c/worlds.h>
#include <rubble/sensors.h>

#include <nlohmann/json.hpp>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

/// Of a world, or of worlds of a batch.
struct rb_sensors {
  std::shared_ptr<World> world;
  std::shared_ptr<Worlds> worlds;
  Sensors sensors;
};

extern "C" {

rb_status rb_sensors_create(const rb_scene* scene, rb_world* world, rb_sensors** sensors) {
  return guarded([&] {
    Sensors made(need(scene, "scene").file.sensors, worldOf(world));
    need(sensors, "sensors") = new rb_sensors{world->world, nullptr, std::move(made)};
  });
}

rb_status rb_sensors_create_in(const rb_scene* scene, rb_worlds* worlds, int32_t first, int32_t count,
                               rb_sensors** sensors) {
  return guarded([&] {
    const std::shared_ptr<Worlds>& batch = need(worlds, "worlds").worlds;
    Sensors made(need(scene, "scene").file.sensors, *batch, first, count);
    need(sensors, "sensors") = new rb_sensors{nullptr, batch, std::move(made)};
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

rb_status rb_sensors_update_in(rb_sensors* sensors, const uint8_t* active, const double** values,
                               int64_t* count) {
  return guarded([&] {
    auto& [world, worlds, own] = need(sensors, "sensors");
    if (world) {
      own.update(*world);
    } else {
      std::vector<char> mask;
      if (active) mask.assign(active, active + worlds->count());
      own.update(*worlds, mask);
    }
    if (values) *values = own.values().data();
    if (count) *count = static_cast<int64_t>(own.values().size());
  });
}

rb_status rb_sensors_update(rb_sensors* sensors, const double** values, int64_t* count) {
  return rb_sensors_update_in(sensors, nullptr, values, count);
}
}

#include <rubble/c/sensors.h>

#include "c_api/handles.h"
#include "io/json_text.h"

using namespace rubble;
using namespace rubble::c;
using Ordered = nlohmann::ordered_json;

extern "C" {

rb_status rb_sensors_create(const rb_scene* scene, const rb_world* world, rb_sensors** sensors) {
  return guarded([&] {
    need(sensors, "sensors") = new rb_sensors{Sensors(need(scene, "scene").file.sensors, worldOf(world))};
  });
}

void rb_sensors_destroy(rb_sensors* sensors) { delete sensors; }

rb_status rb_sensors_update(rb_sensors* sensors, rb_world* world) {
  return guarded([&] { need(sensors, "sensors").sensors.update(worldOf(world)); });
}

rb_status rb_sensors_values(const rb_sensors* sensors, const double** values, int64_t* count) {
  return guarded([&] {
    const std::span<const double> all = need(sensors, "sensors").sensors.values();
    need(values, "values") = all.data();
    need(count, "count") = static_cast<int64_t>(all.size());
  });
}

rb_status rb_sensors_list(const rb_sensors* sensors, const char** json) {
  return guarded([&] {
    Ordered list = Ordered::array();
    for (const SensorDef& each : need(sensors, "sensors").sensors.definitions())
      list.push_back({{"name", each.name}, {"type", keyword(each.type)}, {"size", readingSize(each.type)}});
    need(json, "json") = keepText(list.dump());
  });
}
}

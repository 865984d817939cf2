#pragma once
/// Readings of the sensors of a scene (docs/scene_format.md).
#include <rubble/c/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The sensors of a scene in a world that was made of it. Fails at "sensors[i]..." for a body or joint that
/// the world does not have at present.
RB_API rb_status rb_sensors_create(const rb_scene* scene, const rb_world* world, rb_sensors** sensors);
RB_API void rb_sensors_destroy(rb_sensors* sensors);
/// Measures the world. Accelerations are those since the last call, so call it after each step.
RB_API rb_status rb_sensors_update(rb_sensors* sensors, rb_world* world);
/// Readings of all sensors, one after the other; zeros before the first update. Valid until the sensors are
/// destroyed; rb_sensors_update() changes them in place.
RB_API rb_status rb_sensors_values(const rb_sensors* sensors, const double** values, int64_t* count);
/// "name", "type" and "size" (numbers of a reading) of each sensor, in their order, as a JSON list.
RB_API rb_status rb_sensors_list(const rb_sensors* sensors, const char** json);

#ifdef __cplusplus
}
#endif

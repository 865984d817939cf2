#pragma once
/// Many separate worlds in one engine: the functions of rubble::Worlds. The batch is used by one thread at a
/// time, together with the handles of its worlds.
#include <rubble/c/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/// An empty batch. `options` as for rb_world_create().
RB_API rb_status rb_worlds_create(const char* options, rb_worlds** worlds);
/// Handles of single worlds stay valid until they are destroyed.
RB_API void rb_worlds_destroy(rb_worlds* worlds);
/// Adds `count` worlds of a scene; `first`: number of the first one.
RB_API rb_status rb_worlds_add(rb_worlds* worlds, const rb_scene* scene, int32_t count, int32_t* first);
RB_API int32_t rb_worlds_count(const rb_worlds* worlds);
/// One of the worlds as an rb_world, to be destroyed by rb_world_destroy(). Its step leaves all others as
/// they are. Its snapshots can be restored to every world of the batch.
RB_API rb_status rb_worlds_world(const rb_worlds* worlds, int32_t number, rb_world** world);
/// Advances the worlds whose element of `active` (one per world, or null: all) is not 0 by `steps` steps.
/// `report` may be null.
RB_API rb_status rb_worlds_step(rb_worlds* worlds, int32_t steps, const uint8_t* active,
                                rb_step_report* report);
/// Restores `count` distinct worlds, from one snapshot or from as many.
RB_API rb_status rb_worlds_reset(rb_worlds* worlds, const int32_t* numbers, int64_t count,
                                 const rb_snapshot* const* snapshots, int64_t snapshot_count);
/// All parameters as a JSON object.
RB_API rb_status rb_worlds_params(const rb_worlds* worlds, const char** json);
RB_API rb_status rb_worlds_set_params(rb_worlds* worlds, const char* json);
/// A read-only state array (rb_state_array) of the bodies of all worlds. Valid until the next call for the
/// same array; steps and that call may change it.
RB_API rb_status rb_worlds_array(const rb_worlds* worlds, int32_t which, rb_array* array);
/// As rb_world_device(), and as rb_world_dlpack_of() of the arrays of this batch.
RB_API rb_status rb_worlds_device(const rb_worlds* worlds, int32_t* device, uint64_t* stream);
RB_API rb_status rb_worlds_dlpack_of(rb_worlds* worlds, const rb_array* array, uint64_t stream,
                                     void** tensor);
/// The rows of the bodies of a world in these arrays.
RB_API rb_status rb_worlds_rows(rb_worlds* worlds, int32_t number, const int32_t** rows, int64_t* count);
/// As rb_world_scatter(), with rows of rb_worlds_array().
RB_API rb_status rb_worlds_scatter(rb_worlds* worlds, int32_t which, const rb_array* rows,
                                   const rb_array* values);
/// As rb_world_joint_array() and rb_world_sensor_array(), world after world.
RB_API rb_status rb_worlds_joint_array(const rb_worlds* worlds, int32_t which, rb_array* array);
RB_API rb_status rb_worlds_sensor_array(const rb_worlds* worlds, int32_t which, rb_array* array);
/// As rb_world_vertex_array(), world after world; with the row of the first vertex of a world.
RB_API rb_status rb_worlds_vertex_array(const rb_worlds* worlds, int32_t which, rb_array* array);
RB_API rb_status rb_worlds_first_vertex(const rb_worlds* worlds, int32_t number, int32_t* row);
/// Row of the first axis of a world in the joint arrays.
RB_API rb_status rb_worlds_first_axis(const rb_worlds* worlds, int32_t number, int32_t* row);
RB_API rb_status rb_worlds_scatter_joints(rb_worlds* worlds, int32_t which, const rb_array* rows,
                                          const rb_array* values);
/// Contact forces on the second body of each of `count` pairs of rows (two numbers each), world axes [N]: 3
/// numbers per pair. Valid until the next call.
RB_API rb_status rb_worlds_contact_forces(const rb_worlds* worlds, const int32_t* rows, int64_t count,
                                          rb_array* array);
/// First hits of `count` rays, ray k in world numbers[k]. Hits name bodies of that world.
RB_API rb_status rb_worlds_cast_rays(rb_worlds* worlds, const int32_t* numbers, const rb_ray* rays,
                                     int64_t count, rb_hit* hits);
/// As rb_world_cast_ray_arrays(). `numbers`: the world of each ray, (n, 1), "<i4", in the memory of the rays.
/// On a device the distance of a ray in no world is NaN. Null: each world has as many rays, world after
/// world. The body to skip is that of the same index in each world.
RB_API rb_status rb_worlds_cast_ray_arrays(rb_worlds* worlds, const rb_array* numbers,
                                           const rb_ray_arrays* rays, rb_ray_hit_arrays* hits);
/// As rb_actuators_create(), in `count` worlds of that scene from world `first` on; -1: up to the last one.
/// The arrays of rb_actuators_arrays() have a row for each of these worlds.
RB_API rb_status rb_actuators_create_in(const rb_scene* scene, rb_worlds* worlds, int32_t first,
                                        int32_t count, rb_actuators** actuators);
/// As rb_actuators_apply(), in the worlds whose element of `active` (one for each of the batch, or null: all)
/// is not 0.
RB_API rb_status rb_actuators_apply_in(rb_actuators* actuators, const uint8_t* active);
/// As rb_sensors_create(), in `count` worlds of that scene from world `first` on; -1: up to the last one. The
/// numbers of rb_sensors_update() are those of all sensors of the first world, then those of the next one.
RB_API rb_status rb_sensors_create_in(const rb_scene* scene, rb_worlds* worlds, int32_t first, int32_t count,
                                      rb_sensors** sensors);
/// As rb_sensors_update(), in the worlds whose element of `active` (one for each of the batch, or null: all)
/// is not 0. The others keep their readings.
RB_API rb_status rb_sensors_update_in(rb_sensors* sensors, const uint8_t* active, const double** values,
                                      int64_t* count);
/// Sets an authored value in `count` distinct worlds. `key`: a list, a name and keys of scene files:
/// "gravity", "bodies.cart.material.friction", "joints.hip.axes.0.drive_stiffness",
/// "deformables.rope.density", "attachments.tip.stiffness", "actuators.motor.gain", "materials.ice.friction",
/// "material_pairs.ice.steel.friction". A name with a dot is in brackets and quotes: "bodies[\"a.b\"].mass";
/// a number in brackets is a place among those alive: "bodies[3].mass". World numbers[k] receives
/// values[k * width] to values[k * width + width - 1]. All worlds are checked first: an error changes
/// nothing.
RB_API rb_status rb_worlds_set_values(rb_worlds* worlds, const char* key, const int32_t* numbers,
                                      int64_t count, const double* values, int32_t width);
/// The present values, world after world. Valid until the next call.
RB_API rb_status rb_worlds_values(rb_worlds* worlds, const char* key, const int32_t* numbers, int64_t count,
                                  const double** values, int64_t* value_count);
/// Gives each of these worlds a seed made of `seed` and its number, and begins with episode 0 of its random
/// numbers. `numbers` null: all worlds, and those that are added later.
RB_API rb_status rb_worlds_set_seed(rb_worlds* worlds, uint64_t seed, const int32_t* numbers, int64_t count);
/// Where the random numbers of a world stand: its seed, its resets since the seed was set, and the numbers
/// drawn since the last of these.
RB_API rb_status rb_worlds_random_state(const rb_worlds* worlds, int32_t number, uint64_t* seed,
                                        int64_t* episode, int64_t* drawn);
RB_API rb_status rb_worlds_set_random_state(rb_worlds* worlds, int32_t number, uint64_t seed, int64_t episode,
                                            int64_t drawn);
/// Writes the next `each` random numbers of `count` distinct worlds, uniform from `low` to below `high`,
/// world after world.
RB_API rb_status rb_worlds_uniform(rb_worlds* worlds, const int32_t* numbers, int64_t count, int32_t each,
                                   double low, double high, double* values);
/// Memory of the tables of the engine [bytes].
RB_API int64_t rb_worlds_memory_bytes(const rb_worlds* worlds);

#ifdef __cplusplus
}
#endif

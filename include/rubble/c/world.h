#pragma once
/// A running simulation: the functions of rubble::World. A world is used by one thread at a time. Lists that
/// a call returns belong to the world and are valid until the next call of the same function. Every call with
/// an id that is not alive fails with RB_INVALID.
#include <rubble/c/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A world of a scene. `options`: JSON object, or null: "backend", "threads", "preset", "timings", "events",
/// "instruction_set", and parameters by name ("dt", "iterations", "substeps", "sleeping").
RB_API rb_status rb_world_create(const rb_scene* scene, const char* options, rb_world** world);
RB_API void rb_world_destroy(rb_world* world);
/// Advances the world by "dt". `report` may be null.
RB_API rb_status rb_world_step(rb_world* world, rb_step_report* report);
/// Applies the scripted events of the scene that are due, so that changes before the next step find them
/// done.
RB_API rb_status rb_world_run_events(rb_world* world);
/// The complete report of the last step, as a JSON object.
RB_API rb_status rb_world_report(rb_world* world, const char** json);
/// All parameters as a JSON object.
RB_API rb_status rb_world_params(const rb_world* world, const char** json);
/// Replaces the parameters that the JSON object names.
RB_API rb_status rb_world_set_params(rb_world* world, const char* json);
/// [m/s2]
RB_API rb_status rb_world_gravity(const rb_world* world, double gravity[3]);
RB_API rb_status rb_world_set_gravity(rb_world* world, const double gravity[3]);
/// Adds a rule for two named materials, or replaces theirs: {"a": name, "b": name, "friction": 0.1}, with the
/// keys of "material_pairs" in scene files.
RB_API rb_status rb_world_set_material_pair(rb_world* world, const char* json);
RB_API rb_status rb_world_remove_material_pair(rb_world* world, const char* a, const char* b);
/// All rules as a JSON list.
RB_API rb_status rb_world_material_pairs(const rb_world* world, const char** json);
RB_API int64_t rb_world_step_count(const rb_world* world);
/// Simulated time [s].
RB_API double rb_world_time(const rb_world* world);

RB_API rb_status rb_world_add_body(rb_world* world, const char* json, rb_body_id* body);
/// Adds a JSON list of bodies. The whole list is checked first.
RB_API rb_status rb_world_add_bodies(rb_world* world, const char* json, const rb_body_id** bodies,
                                     int64_t* count);
/// Removes bodies and their joints.
RB_API rb_status rb_world_remove_bodies(rb_world* world, const rb_body_id* bodies, int64_t count);
/// Enables (1) or disables (0) collision between two bodies.
RB_API rb_status rb_world_set_collide(rb_world* world, rb_body_id a, rb_body_id b, int32_t collide);
RB_API int32_t rb_world_body_alive(const rb_world* world, rb_body_id body);
/// Bodies that are alive, by index.
RB_API rb_status rb_world_bodies(rb_world* world, const rb_body_id** bodies, int64_t* count);
RB_API rb_status rb_world_find_body(const rb_world* world, const char* name, rb_body_id* body);
/// Body of the scene by its index there.
RB_API rb_status rb_world_body_at(const rb_world* world, int32_t index, rb_body_id* body);
RB_API rb_status rb_world_body_definition(const rb_world* world, rb_body_id body, const char** json);
/// Replaces the fields of the definition that the JSON object names, from the next step on. Pose and
/// velocities are kept, and so are contacts unless the shape changes. "mass" and "density" replace each
/// other.
RB_API rb_status rb_world_set_body(rb_world* world, rb_body_id body, const char* json);
RB_API rb_status rb_world_body_name(const rb_world* world, rb_body_id body, const char** name);
RB_API rb_status rb_world_body_mass(const rb_world* world, rb_body_id body, rb_mass* mass);
RB_API rb_status rb_world_body_state(const rb_world* world, rb_body_id body, rb_body_state* state);
RB_API rb_status rb_world_set_body_state(rb_world* world, rb_body_id body, const rb_body_state* state);
RB_API rb_status rb_world_body_states(const rb_world* world, const rb_body_id* bodies, int64_t count,
                                      rb_body_state* states);
RB_API rb_status rb_world_set_body_states(rb_world* world, const rb_body_id* bodies, int64_t count,
                                          const rb_body_state* states);
/// Of the center of mass [m/s] and about it, world axes [rad/s].
RB_API rb_status rb_world_set_velocity(rb_world* world, rb_body_id body, const double velocity[3],
                                       const double angular_velocity[3]);
/// 64 bits of the caller: "user_data" of the definition.
RB_API rb_status rb_world_body_user_data(const rb_world* world, rb_body_id body, uint64_t* user_data);
RB_API rb_status rb_world_set_body_user_data(rb_world* world, rb_body_id body, uint64_t user_data);
/// Joints of a body, and those it is the frame body of.
RB_API rb_status rb_world_joints_of(rb_world* world, rb_body_id body, const rb_joint_id** joints,
                                    int64_t* count);
/// Kinematic bodies: sets the pose to reach in the next step.
RB_API rb_status rb_world_set_target(rb_world* world, rb_body_id body, const double position[3],
                                     const double orientation[4]);
/// At the center of mass, for the next step [N].
RB_API rb_status rb_world_apply_force(rb_world* world, rb_body_id body, const double force[3]);
/// At a world point [m], for the next step [N].
RB_API rb_status rb_world_apply_force_at(rb_world* world, rb_body_id body, const double force[3],
                                         const double point[3]);
/// For the next step [N m].
RB_API rb_status rb_world_apply_torque(rb_world* world, rb_body_id body, const double torque[3]);
/// At the center of mass [N s].
RB_API rb_status rb_world_apply_impulse(rb_world* world, rb_body_id body, const double impulse[3]);
/// At a world point [m], [N s].
RB_API rb_status rb_world_apply_impulse_at(rb_world* world, rb_body_id body, const double impulse[3],
                                           const double point[3]);
/// World axes [N m s].
RB_API rb_status rb_world_apply_angular_impulse(rb_world* world, rb_body_id body, const double impulse[3]);
/// Forces [N] and torques [N m] (may be null) of many bodies, 3 numbers each.
RB_API rb_status rb_world_apply_forces(rb_world* world, const rb_body_id* bodies, int64_t count,
                                       const double* forces, const double* torques);
/// Impulses [N s] of many bodies, 3 numbers each.
RB_API rb_status rb_world_apply_impulses(rb_world* world, const rb_body_id* bodies, int64_t count,
                                         const double* impulses);

/// Shapes: bodies with equal shapes share one, which is freed with its last use. A use is a body, or a call
/// of rb_world_add_shape(). It cooks a new shape.
RB_API rb_status rb_world_add_shape(rb_world* world, const rb_shape* shape, rb_shape_id* id);
/// Takes back one call of rb_world_add_shape().
RB_API rb_status rb_world_remove_shape(rb_world* world, rb_shape_id id);
RB_API int32_t rb_world_shape_alive(const rb_world* world, rb_shape_id id);
RB_API rb_status rb_world_shapes(rb_world* world, const rb_shape_id** shapes, int64_t* count);
RB_API rb_status rb_world_shape_of(const rb_world* world, rb_body_id body, rb_shape_id* id);
RB_API rb_status rb_world_shape_definition(const rb_world* world, rb_shape_id id, const char** json);
/// Bodies and calls of rb_world_add_shape().
RB_API rb_status rb_world_shape_uses(const rb_world* world, rb_shape_id id, int64_t* uses);
/// "user_data" of a part of a compound (from 0), or of the whole shape (0).
RB_API rb_status rb_world_shape_user_data(const rb_world* world, rb_body_id body, int32_t part,
                                          uint64_t* user_data);
/// Material of a part of a compound (from 0), or of the whole body (0), as a JSON object.
RB_API rb_status rb_world_material_of(const rb_world* world, rb_body_id body, int32_t part,
                                      const char** json);
/// Adds a body of that shape. The JSON object has the keys of a body but "shape".
RB_API rb_status rb_world_add_body_of(rb_world* world, rb_shape_id shape, const char* json, rb_body_id* body);
RB_API rb_status rb_world_set_shape(rb_world* world, rb_body_id body, rb_shape_id shape);

/// A read-only view of a state array (rb_state_array), with all edits applied. It is valid while
/// rb_world_epoch() is unchanged. Device memory can be read on the legacy default stream from the first call
/// on: what the engine writes comes after the work so far of that stream, and before its later work.
RB_API rb_status rb_world_array(const rb_world* world, int32_t which, rb_array* array);
/// An rb_joint_array, rb_sensor_array or rb_vertex_array. Valid until the next call for the same array.
RB_API rb_status rb_world_joint_array(const rb_world* world, int32_t which, rb_array* array);
RB_API rb_status rb_world_sensor_array(const rb_world* world, int32_t which, rb_array* array);
RB_API rb_status rb_world_vertex_array(const rb_world* world, int32_t which, rb_array* array);
/// Row of the first vertex of an object in the vertex arrays.
RB_API rb_status rb_world_first_vertex(const rb_world* world, rb_deformable_id object, int32_t* row);
/// Contact forces of the last step between the bodies of `count` pairs (two ids each), on the second one,
/// world axes [N]: 3 numbers per pair. Valid until the next call.
RB_API rb_status rb_world_contact_forces(const rb_world* world, const rb_body_id* pairs, int64_t count,
                                         rb_array* array);
/// Joint and axis of each row of the joint arrays. Either list may be null.
RB_API rb_status rb_world_axes(rb_world* world, const rb_joint_id** joints, const int32_t** axes,
                               int64_t* count);
/// Writes values (n, 1) to rows of a joint array that can be written.
RB_API rb_status rb_world_scatter_joints(rb_world* world, int32_t which, const rb_array* rows,
                                         const rb_array* values);
RB_API int64_t rb_world_epoch(const rb_world* world);
/// CUDA device that holds the arrays, and the stream on which the engine works, as rb_array::stream. -1 and
/// 0: arrays are in host memory.
RB_API rb_status rb_world_device(const rb_world* world, int32_t* device, uint64_t* stream);
/// A state array as a DLManagedTensor (DLPack 0.8). It keeps the world alive until its deleter is called. It
/// is read on the legacy default stream.
RB_API rb_status rb_world_dlpack(rb_world* world, int32_t which, void** tensor);
/// The same of any array of this world, for a reader on `stream` (as rb_array::stream). Later work of the
/// stream waits for the engine. Until the deleter is called, what the engine writes waits for the work of the
/// stream, which must exist until then. 0: the caller orders its work itself.
RB_API rb_status rb_world_dlpack_of(rb_world* world, const rb_array* array, uint64_t stream, void** tensor);
/// Calls the deleter of a DLManagedTensor that nobody took over.
RB_API void rb_dlpack_delete(void* tensor);
/// Sorts the bodies in memory along a space-filling curve, with the next step.
RB_API rb_status rb_world_sort_bodies(rb_world* world);
/// Writes row k of `values` to row rows[k] of an array; forces and torques accumulate. `rows`: shape (n, 1),
/// "<i4". `values`: shape (n, 3 or 4), "<f4" or "<f8". Both in host memory, or both in device memory.
RB_API rb_status rb_world_scatter(rb_world* world, int32_t which, const rb_array* rows,
                                  const rb_array* values);
/// Starts an asynchronous copy of the poses to the host. At most two may be pending.
RB_API rb_status rb_world_begin_poses(rb_world* world);
/// 1: the oldest pending copy is complete.
RB_API int32_t rb_world_poses_ready(const rb_world* world);
/// Waits for the oldest pending copy. It is valid until the second rb_world_begin_poses() after its own.
RB_API rb_status rb_world_take_poses(rb_world* world, rb_pose_frame* frame);

/// Adds a joint between `a` and `b` (index -1: the world). The JSON object has the keys of scene files
/// without bodies: "type", "anchor", "axis", "axes" and others. "anchor", "axis" and "frame" are in the world
/// at the present poses. `frame_a`, `frame_b`: frame bodies of gears and racks.
RB_API rb_status rb_world_add_joint(rb_world* world, const char* json, rb_body_id a, rb_body_id b,
                                    rb_body_id frame_a, rb_body_id frame_b, rb_joint_id* joint);
/// Adds a gear between two hinges, or a rack between a hinge and a slider.
RB_API rb_status rb_world_add_coupling(rb_world* world, const char* json, rb_joint_id a, rb_joint_id b,
                                       rb_joint_id* joint);
RB_API rb_status rb_world_remove_joint(rb_world* world, rb_joint_id joint);
RB_API int32_t rb_world_joint_alive(const rb_world* world, rb_joint_id joint);
RB_API rb_status rb_world_joints(rb_world* world, const rb_joint_id** joints, int64_t* count);
RB_API rb_status rb_world_find_joint(const rb_world* world, const char* name, rb_joint_id* joint);
RB_API rb_status rb_world_joint_definition(const rb_world* world, rb_joint_id joint, const char** json);
RB_API rb_status rb_world_joint_name(const rb_world* world, rb_joint_id joint, const char** name);
/// A, B and their frame bodies.
RB_API rb_status rb_world_joint_bodies(const rb_world* world, rb_joint_id joint, rb_body_id bodies[4]);
RB_API rb_status rb_world_joint_state(const rb_world* world, rb_joint_id joint, rb_joint_state* state);
/// 64 bits of the caller: "user_data" of the definition.
RB_API rb_status rb_world_joint_user_data(const rb_world* world, rb_joint_id joint, uint64_t* user_data);
RB_API rb_status rb_world_set_joint_user_data(rb_world* world, rb_joint_id joint, uint64_t user_data);
/// Replaces the values that the JSON object names: limits, drives, lengths, stiffnesses, frames.
RB_API rb_status rb_world_set_joint(rb_world* world, rb_joint_id joint, const char* json);
/// [m] or [rad]
RB_API rb_status rb_world_set_target_position(rb_world* world, rb_joint_id joint, int32_t axis,
                                              double position);
/// [m/s] or [rad/s]
RB_API rb_status rb_world_set_target_speed(rb_world* world, rb_joint_id joint, int32_t axis, double speed);
/// Motor of an axis: "motor_force" [N] or [N m].
RB_API rb_status rb_world_set_motor_force(rb_world* world, rb_joint_id joint, int32_t axis, double force);
/// Limits of an axis; infinite: none.
RB_API rb_status rb_world_set_limits(rb_world* world, rb_joint_id joint, int32_t axis, double min,
                                     double max);
/// Distance, rope, spring, pulley [m].
RB_API rb_status rb_world_set_length(rb_world* world, rb_joint_id joint, double length);
/// Swing-twist.
RB_API rb_status rb_world_set_drive_orientation(rb_world* world, rb_joint_id joint,
                                                const double orientation[4]);
/// Drags a body by a world point [m] with a mouse joint. `frequency` [1/s], `max_force` [N].
RB_API rb_status rb_world_add_drag_joint(rb_world* world, rb_body_id body, const double point[3],
                                         double max_force, double frequency, rb_joint_id* joint);
/// World [m].
RB_API rb_status rb_world_set_drag_target(rb_world* world, rb_joint_id joint, const double target[3]);

RB_API rb_status rb_world_add_deformable(rb_world* world, const char* json, rb_deformable_id* object);
/// Removes an object and its attachments.
RB_API rb_status rb_world_remove_deformable(rb_world* world, rb_deformable_id object);
RB_API int32_t rb_world_deformable_alive(const rb_world* world, rb_deformable_id object);
RB_API rb_status rb_world_deformables(rb_world* world, const rb_deformable_id** objects, int64_t* count);
RB_API rb_status rb_world_find_deformable(const rb_world* world, const char* name, rb_deformable_id* object);
RB_API rb_status rb_world_deformable_at(const rb_world* world, int32_t index, rb_deformable_id* object);
RB_API rb_status rb_world_deformable_definition(const rb_world* world, rb_deformable_id object,
                                                const char** json);
/// Replaces the fields of the definition that the JSON object names, from the next step on. Vertices and
/// elements keep their state.
RB_API rb_status rb_world_set_deformable(rb_world* world, rb_deformable_id object, const char* json);
RB_API rb_status rb_world_deformable_name(const rb_world* world, rb_deformable_id object, const char** name);
/// 64 bits of the caller: "user_data" of the definition.
RB_API rb_status rb_world_deformable_user_data(const rb_world* world, rb_deformable_id object,
                                               uint64_t* user_data);
RB_API rb_status rb_world_set_deformable_user_data(rb_world* world, rb_deformable_id object,
                                                   uint64_t user_data);
RB_API rb_status rb_world_vertex_count(const rb_world* world, rb_deformable_id object, int64_t* count);
/// `positions` has 3 numbers per vertex [m]; `count`: number of vertices that it has room for.
RB_API rb_status rb_world_vertex_positions(const rb_world* world, rb_deformable_id object, double* positions,
                                           int64_t count);
/// [m/s]
RB_API rb_status rb_world_vertex_velocities(const rb_world* world, rb_deformable_id object,
                                            double* velocities, int64_t count);
/// [kg]; 0: fixed
RB_API rb_status rb_world_vertex_masses(const rb_world* world, rb_deformable_id object, double* masses,
                                        int64_t count);
/// Sets positions [m] and velocities [m/s] of all vertices, 3 numbers each.
RB_API rb_status rb_world_set_vertices(rb_world* world, rb_deformable_id object, const double* positions,
                                       const double* velocities, int64_t count);
/// For the next step [N].
RB_API rb_status rb_world_apply_vertex_force(rb_world* world, rb_deformable_id object, int32_t vertex,
                                             const double force[3]);
RB_API rb_status rb_world_surface(rb_world* world, rb_deformable_id object, rb_surface* surface);
/// Adds an attachment between `object` and `body` (index -1: the world) or `other` (index -1: none).
RB_API rb_status rb_world_add_attachment(rb_world* world, const char* json, rb_deformable_id object,
                                         rb_body_id body, rb_deformable_id other,
                                         rb_attachment_id* attachment);
RB_API rb_status rb_world_remove_attachment(rb_world* world, rb_attachment_id attachment);
RB_API int32_t rb_world_attachment_alive(const rb_world* world, rb_attachment_id attachment);
RB_API rb_status rb_world_attachments(rb_world* world, const rb_attachment_id** attachments, int64_t* count);
RB_API rb_status rb_world_attachment_state(const rb_world* world, rb_attachment_id attachment,
                                           rb_joint_state* state);
RB_API rb_status rb_world_attachment_ends(const rb_world* world, rb_attachment_id attachment,
                                          rb_attachment_ends* ends);
RB_API rb_status rb_world_vertex_contacts(rb_world* world, const rb_vertex_contact** contacts,
                                          int64_t* count);

RB_API rb_status rb_world_quality(const rb_world* world, rb_quality* quality);
RB_API rb_status rb_world_contacts(rb_world* world, const rb_contact_point** contacts, int64_t* count);
/// Contact points of one body.
RB_API rb_status rb_world_contacts_of(rb_world* world, rb_body_id body, const rb_contact_point** contacts,
                                      int64_t* count);
RB_API rb_status rb_world_contact_load(const rb_world* world, rb_body_id body, rb_contact_load* load);
/// Solver states of all bodies, in the order of rb_world_bodies().
RB_API rb_status rb_world_solver_states(rb_world* world, const rb_solver_state** states, int64_t* count);
/// Solver states of the vertices of an object.
RB_API rb_status rb_world_vertex_solver_states(rb_world* world, rb_deformable_id object,
                                               const rb_solver_state** states, int64_t* count);
/// Events of the last step. Empty unless the option "events" is set.
RB_API rb_status rb_world_events(rb_world* world, rb_events* events);
RB_API rb_status rb_world_asleep(const rb_world* world, rb_body_id body, int32_t* asleep);
RB_API rb_status rb_world_wake(rb_world* world, rb_body_id body);

/// First hits.
RB_API rb_status rb_world_cast_rays(rb_world* world, const rb_ray* rays, int64_t count, rb_hit* hits);
RB_API rb_status rb_world_cast_shapes(rb_world* world, const rb_cast* casts, int64_t count, rb_hit* hits);
/// First hits of rays that are arrays. Valid until the next call. On a device nothing comes to the host: rays
/// are read in the order of their streams, and hits are written in that of rb_world_device(). On a device
/// distances are NaN for rays that are not finite or have no direction; the host reports these.
RB_API rb_status rb_world_cast_ray_arrays(rb_world* world, const rb_ray_arrays* rays,
                                          rb_ray_hit_arrays* hits);
/// Bodies of query k: bodies[offsets[k]] to bodies[offsets[k + 1] - 1].
RB_API rb_status rb_world_overlaps(rb_world* world, const rb_overlap* shapes, int64_t count,
                                   const int64_t** offsets, const rb_body_id** bodies);
RB_API rb_status rb_world_closest_points(rb_world* world, const rb_closest* points, int64_t count,
                                         rb_hit* hits);
/// All hits: of query k those from hits[offsets[k]] to hits[offsets[k + 1] - 1], the first of each part of
/// each body, and of each deformable object if the filter has them, by distance.
RB_API rb_status rb_world_cast_rays_all(rb_world* world, const rb_ray* rays, int64_t count,
                                        const int64_t** offsets, const rb_hit** hits);
RB_API rb_status rb_world_cast_shapes_all(rb_world* world, const rb_cast* casts, int64_t count,
                                          const int64_t** offsets, const rb_hit** hits);
RB_API rb_status rb_world_overlaps_all(rb_world* world, const rb_overlap* shapes, int64_t count,
                                       const int64_t** offsets, const rb_hit** hits);

/// Memory of the tables of the engine [bytes].
RB_API int64_t rb_world_memory_bytes(const rb_world* world);
/// Reserves table memory for `count` elements of a kind ("pairs", "manifolds" and others).
RB_API rb_status rb_world_reserve(rb_world* world, const char* kind, int32_t count);
/// Hash of the persistent state.
RB_API rb_status rb_world_hash(const rb_world* world, uint64_t* hash);
/// Hashes of the single tables of that state, as a JSON object of whole numbers by name.
RB_API rb_status rb_world_table_hashes(const rb_world* world, const char** json);
RB_API rb_status rb_world_snapshot(const rb_world* world, rb_snapshot** snapshot);
RB_API rb_status rb_world_restore(rb_world* world, const rb_snapshot* snapshot);
/// The snapshot as bytes, for a file. They are valid until the next call for this snapshot.
RB_API rb_status rb_snapshot_bytes(rb_snapshot* snapshot, const uint8_t** bytes, int64_t* count);
/// Fails unless the bytes are whole and of this version. Load files from trusted sources only.
RB_API rb_status rb_snapshot_from_bytes(const uint8_t* bytes, int64_t count, rb_snapshot** snapshot);
RB_API void rb_snapshot_destroy(rb_snapshot* snapshot);
/// Backend "lockstep" only: the first difference found, or "".
RB_API rb_status rb_world_first_difference(const rb_world* world, const char** difference);

/// The sensors of a scene ("sensors" of scene files, and those of imported models), for a world of that
/// scene. They keep the world alive.
RB_API rb_status rb_sensors_create(const rb_scene* scene, rb_world* world, rb_sensors** sensors);
RB_API void rb_sensors_destroy(rb_sensors* sensors);
/// "name", "type", "first" number and "count" of numbers of each sensor, as a JSON list.
RB_API rb_status rb_sensors_list(const rb_sensors* sensors, const char** json);
/// Measures. Accelerations are those since the last call, so call it after each step. The numbers of all
/// sensors are valid until the next call; `values` and `count` may be null.
RB_API rb_status rb_sensors_update(rb_sensors* sensors, const double** values, int64_t* count);

/// The actuators of a scene ("actuators" of scene files, and those of imported models), for a new world of
/// that scene. They keep the world alive.
RB_API rb_status rb_actuators_create(const rb_scene* scene, rb_world* world, rb_actuators** actuators);
RB_API void rb_actuators_destroy(rb_actuators* actuators);
/// "name", "type" and "dynamics" of each actuator, as a JSON list.
RB_API rb_status rb_actuators_list(const rb_actuators* actuators, const char** json);
/// A number for each actuator, valid while they exist: controls and activations, which may be written, and
/// what each did in the last rb_actuators_apply(). Any may be null. Snapshots of the world have the first
/// two.
RB_API rb_status rb_actuators_arrays(rb_actuators* actuators, double** controls, double** activations,
                                     const double** forces);
/// Acts on the world for its next step, and advances the activations by its time. Call it before each step.
RB_API rb_status rb_actuators_apply(rb_actuators* actuators);

/// The world as colored lines, triangles and texts. `options`: JSON object, or null: "surfaces" (true unless
/// given), "edges", "contacts", "joints", "bounds", "names" (false unless given), "force_scale" [m/N],
/// "plane_size" [m], "segments".
RB_API rb_status rb_world_debug_draw(rb_world* world, const char* options, rb_debug_draw* drawing);

#ifdef __cplusplus
}
#endif

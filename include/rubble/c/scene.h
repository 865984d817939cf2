#pragma once
/// Scenes, shapes, the scene registry and general information.
#include <rubble/c/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/// RB_API_VERSION of the library.
RB_API int32_t rb_api_version(void);
/// The last error of this thread.
RB_API const rb_error* rb_last_error(void);
/// Build, backends, force types, deformable kinds and parameters, as a JSON object. Returned texts are valid
/// until the next call of this thread that returns one.
RB_API rb_status rb_info(const char** json);

/// An empty scene with gravity (0, 0, -9.81). Mesh files that it names lie in `folder` ("": the working
/// folder).
RB_API rb_status rb_scene_create(const char* folder, rb_scene** scene);
/// A scene from JSON text (docs/scene_format.md).
RB_API rb_status rb_scene_parse(const char* json, const char* folder, rb_scene** scene);
/// A scene from a JSON file.
RB_API rb_status rb_scene_read(const char* file, rb_scene** scene);
/// Imports a model: MJCF, URDF, USD, or glTF with physics. `options`: JSON with any of "strict" (refuse what
/// is not exact), "key" (keyframe of MJCF), "srdf", "packages" (object of folders by name), "folders" (list)
/// and "floating_base"; or NULL. `report`: JSON of what became of each element; NULL if it is not wanted.
RB_API rb_status rb_scene_import(const char* file, const char* options, rb_scene** scene,
                                 const char** report);
/// A scene of the registry. `arguments`: JSON object with numbers, or null.
RB_API rb_status rb_scene_build(const char* name, const char* arguments, rb_scene** scene);
RB_API void rb_scene_destroy(rb_scene* scene);
/// Sets a key that is no list: "name", "gravity", "materials", "shapes", "camera", "steps" and others.
RB_API rb_status rb_scene_set(rb_scene* scene, const char* key, const char* json);
/// Adds an element to a list: "bodies", "joints", "deformables", "attachments", "exclusions", "events",
/// "sensors", "looks", "cameras", "material_pairs" or "verdict". What it names must have been added before.
/// `index` (may be null): its place in the list.
RB_API rb_status rb_scene_add(rb_scene* scene, const char* list, const char* json, int64_t* index);
/// Adds a rod of rigid segments. Outputs: first body and number of bodies, first joint and number of joints.
RB_API rb_status rb_scene_add_rod(rb_scene* scene, const char* json, int32_t parts[4]);
/// Number of elements of a list.
RB_API rb_status rb_scene_count(const rb_scene* scene, const char* list, int64_t* count);
/// The scene as JSON text that reads back bit for bit.
RB_API rb_status rb_scene_text(const rb_scene* scene, const char** json);
/// Writes the scene to a file.
RB_API rb_status rb_scene_write(const rb_scene* scene, const char* file);

/// A shape from JSON, for queries and mass properties.
RB_API rb_status rb_shape_create(const char* json, rb_shape** shape);
RB_API void rb_shape_destroy(rb_shape* shape);
/// Mass properties at a density [kg/m3].
RB_API rb_status rb_shape_mass(const rb_shape* shape, double density, rb_mass* mass);

/// Deformable objects as JSON definitions.
/// A box of cells with six tetrahedra each.
RB_API rb_status rb_tet_box(const double corner[3], const double size[3], const int32_t cells[3],
                            const char** json);
/// A ball of tetrahedra with `cells` cells per edge of the cube it is mapped from.
RB_API rb_status rb_tet_ball(const double center[3], double radius, int32_t cells, const char** json);
/// Tetrahedra of width `cell` [m] inside a closed surface.
RB_API rb_status rb_tet_solid(const double* vertices, int64_t vertex_count, const int32_t* triangles,
                              int64_t triangle_count, double cell, const char** json);
/// Cloth of cells with two triangles each: corner + s u + t v.
RB_API rb_status rb_cloth_sheet(const double corner[3], const double u[3], const double v[3], int32_t cells_u,
                                int32_t cells_v, const char** json);
/// A straight cable.
RB_API rb_status rb_straight_cable(const double from[3], const double to[3], int32_t segments,
                                   const char** json);
/// A cable along points, in segments of about that length [m].
RB_API rb_status rb_cable_along(const double* points, int64_t point_count, double segment, int32_t closed,
                                const char** json);

/// The scene registry as a JSON list: name, description, arguments, steps, iterations and tags of each scene.
RB_API rb_status rb_registry(const char** json);
/// A run of a registry scene with its events, probes and verdict. `arguments` and `options`: JSON objects, or
/// null. Iterations and substeps are those of the verdict unless `options` has them.
RB_API rb_status rb_run_create(const char* name, const char* arguments, const char* options, rb_run** run);
/// A run of a scene with its events. It measures the quality at the end and judges no verdict.
RB_API rb_status rb_run_scene(const rb_scene* scene, const char* options, rb_run** run);
RB_API void rb_run_destroy(rb_run* run);
/// The world of a run. It belongs to the run.
RB_API rb_world* rb_run_world(rb_run* run);
/// Number of steps of a full run.
RB_API int32_t rb_run_steps(const rb_run* run);
/// Applies the events of this step, takes the step and measures. `report` may be null.
RB_API rb_status rb_run_step(rb_run* run, rb_step_report* report);
/// No longer needed: snapshots hold the events that are not due yet.
RB_API rb_status rb_run_rewound(rb_run* run);
/// Ends the measurements: JSON object with "metrics", "holds" and "claims".
RB_API rb_status rb_run_finish(rb_run* run, const char** json);

#ifdef __cplusplus
}
#endif

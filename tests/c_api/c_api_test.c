/* The C API as C99 sees it: handles, status codes, errors with their parts, arrays and lists. */
#include <math.h>
#include <rubble/c/rubble.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

#define CHECK(condition)                                               \
  do {                                                                 \
    if (!(condition)) {                                                \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);  \
      fprintf(stderr, "  last error: %s\n", rb_last_error()->message); \
      ++failures;                                                      \
    }                                                                  \
  } while (0)

static const char* kBox =
    "{\"name\": \"crate\", \"shape\": {\"type\": \"box\", \"size\": [1, 1, 1]}, \"mass\": 2, "
    "\"position\": [0, 0, 2]}";

static rb_scene* sceneOfACrate(void) {
  rb_scene* scene = NULL;
  CHECK(rb_scene_create("", &scene) == RB_OK);
  CHECK(rb_scene_add(scene, "bodies", "{\"name\": \"ground\", \"shape\": {\"type\": \"plane\"}}", NULL) ==
        RB_OK);
  CHECK(rb_scene_add(scene, "bodies", kBox, NULL) == RB_OK);
  return scene;
}

static void anInvalidBodyIsNamedAndLeavesTheSceneAsItWas(void) {
  rb_scene* scene = sceneOfACrate();
  int64_t count = 0;
  const char* bad = "{\"name\": \"bad\", \"shape\": {\"type\": \"sphere\", \"radius\": 1}, \"mass\": -1}";
  CHECK(rb_scene_add(scene, "bodies", bad, NULL) == RB_INVALID);
  CHECK(strcmp(rb_last_error()->path, "bodies[2].mass") == 0);
  CHECK(strcmp(rb_last_error()->expected, "a mass above 0 [kg]") == 0);
  CHECK(strcmp(rb_last_error()->found, "-1") == 0);
  CHECK(rb_scene_count(scene, "bodies", &count) == RB_OK && count == 2);
  CHECK(rb_scene_add(scene, "bodies", kBox, NULL) == RB_INVALID); /* the name is taken */
  CHECK(strcmp(rb_last_error()->path, "bodies[2].name") == 0);
  CHECK(rb_scene_add(scene, "bodys", kBox, NULL) == RB_INVALID);
  rb_scene_destroy(scene);
}

static void aWorldOfManyStaysWhereItIsLeftOut(void) {
  rb_scene* scene = sceneOfACrate();
  rb_worlds* worlds = NULL;
  rb_world *first = NULL, *last = NULL;
  rb_snapshot* start = NULL;
  const uint8_t active[3] = {1, 1, 0};
  const int32_t all[3] = {0, 1, 2};
  uint64_t a = 0, b = 0;
  int32_t number = -1;
  CHECK(rb_worlds_create("{\"threads\": 1}", &worlds) == RB_OK);
  CHECK(rb_worlds_add(worlds, scene, 3, &number) == RB_OK && number == 0 && rb_worlds_count(worlds) == 3);
  CHECK(rb_worlds_world(worlds, 0, &first) == RB_OK && rb_worlds_world(worlds, 2, &last) == RB_OK);
  CHECK(rb_worlds_world(worlds, 3, &last) == RB_INVALID);
  CHECK(rb_world_snapshot(first, &start) == RB_OK);
  CHECK(rb_worlds_step(worlds, 5, active, NULL) == RB_OK);
  CHECK(rb_world_step_count(first) == 5 && rb_world_step_count(last) == 0);
  CHECK(rb_worlds_reset(worlds, all, 3, (const rb_snapshot* const*)&start, 1) == RB_OK);
  CHECK(rb_world_hash(first, &a) == RB_OK && rb_world_hash(last, &b) == RB_OK && a == b);
  rb_worlds_destroy(worlds);
  CHECK(rb_world_step(first, NULL) == RB_OK); /* a world outlives its batch */
  rb_snapshot_destroy(start);
  rb_world_destroy(first);
  rb_world_destroy(last);
  rb_scene_destroy(scene);
}

static void noCallDiesOfANullPointer(void) {
  rb_world* world = NULL;
  CHECK(rb_world_create(NULL, NULL, &world) == RB_INVALID);
  CHECK(rb_world_step(NULL, NULL) == RB_INVALID);
  CHECK(rb_scene_parse(NULL, NULL, NULL) == RB_INVALID);
  CHECK(rb_world_bodies(NULL, NULL, NULL) == RB_INVALID);
  CHECK(rb_world_time(NULL) == 0);
  rb_world_destroy(NULL);
  rb_scene_destroy(NULL);
}

static void aCrateFallsAndRests(void) {
  rb_scene* scene = sceneOfACrate();
  rb_world* world = NULL;
  rb_body_id crate;
  rb_body_state state;
  rb_step_report report;
  rb_array positions;
  const rb_body_id* bodies = NULL;
  int64_t count = 0;
  CHECK(rb_world_create(scene, "{\"threads\": 1, \"iterations\": 4}", &world) == RB_OK);
  rb_scene_destroy(scene);
  CHECK(rb_world_find_body(world, "crate", &crate) == RB_OK);
  for (int step = 0; step < 120; ++step) CHECK(rb_world_step(world, &report) == RB_OK);
  CHECK(report.step == 119 && report.bodies == 2 && report.manifolds == 1);
  CHECK(rb_world_body_state(world, crate, &state) == RB_OK);
  CHECK(fabs(state.position[2] - 0.5) < 0.01);
  CHECK(rb_world_array(world, RB_POSITION, &positions) == RB_OK);
  CHECK(positions.shape[0] >= 2 && positions.shape[1] == 3 && strcmp(positions.typestr, "<f8") == 0);
  const char* row = (const char*)positions.data + crate.index * positions.strides[0];
  CHECK(fabs(*(const double*)(row + 2 * positions.strides[1]) - state.position[2]) < 1e-12);
  CHECK(rb_world_bodies(world, &bodies, &count) == RB_OK && count == 2);
  CHECK(rb_world_remove_bodies(world, &crate, 1) == RB_OK);
  CHECK(!rb_world_body_alive(world, crate));
  CHECK(rb_world_body_state(world, crate, &state) == RB_INVALID);
  rb_world_destroy(world);
}

static void anArrayIsATensorThatKeepsItsWorld(void) {
  rb_scene* scene = sceneOfACrate();
  rb_world* world = NULL;
  rb_worlds* worlds = NULL;
  rb_array velocities;
  int32_t device = 0;
  uint64_t stream = 1;
  void* tensor = NULL;
  CHECK(rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  CHECK(rb_world_device(world, &device, &stream) == RB_OK && device == -1 && stream == 0);
  CHECK(rb_world_array(world, RB_VELOCITY, &velocities) == RB_OK);
  CHECK(rb_world_dlpack_of(world, &velocities, 0, &tensor) == RB_OK);
  rb_world_destroy(world);
  CHECK(*(void**)tensor == velocities.data); /* the first member */
  CHECK(*(const float*)velocities.data == 0);
  rb_dlpack_delete(tensor);
  CHECK(rb_world_dlpack_of(NULL, &velocities, 0, &tensor) == RB_INVALID);

  CHECK(rb_worlds_create("{\"threads\": 1}", &worlds) == RB_OK);
  CHECK(rb_worlds_device(worlds, &device, &stream) == RB_OK && device == -1);
  CHECK(rb_worlds_add(worlds, scene, 2, NULL) == RB_OK);
  CHECK(rb_worlds_device(worlds, &device, &stream) == RB_OK && device == -1);
  CHECK(rb_worlds_array(worlds, RB_VELOCITY, &velocities) == RB_OK && velocities.shape[0] == 4);
  CHECK(rb_worlds_dlpack_of(worlds, &velocities, 0, &tensor) == RB_OK);
  rb_worlds_destroy(worlds);
  CHECK(*(void**)tensor == velocities.data && *(const float*)velocities.data == 0);
  rb_dlpack_delete(tensor);
  rb_scene_destroy(scene);
}

static void aSnapshotContinuesBitForBit(void) {
  rb_scene* scene = sceneOfACrate();
  rb_world* world = NULL;
  rb_snapshot* snapshot = NULL;
  uint64_t first = 0, second = 1;
  CHECK(rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  for (int step = 0; step < 20; ++step) rb_world_step(world, NULL);
  CHECK(rb_world_snapshot(world, &snapshot) == RB_OK);
  for (int step = 0; step < 20; ++step) rb_world_step(world, NULL);
  CHECK(rb_world_hash(world, &first) == RB_OK);
  CHECK(rb_world_restore(world, snapshot) == RB_OK);
  for (int step = 0; step < 20; ++step) rb_world_step(world, NULL);
  CHECK(rb_world_hash(world, &second) == RB_OK && first == second);
  rb_snapshot_destroy(snapshot);
  rb_world_destroy(world);
  rb_scene_destroy(scene);
}

static void aHingeAddedToAWorldStandsAtThePresentPoses(void) {
  rb_scene* scene = sceneOfACrate();
  rb_world* world = NULL;
  rb_body_id crate, none = {-1, 0};
  rb_joint_id joint;
  rb_joint_state state;
  const char* hinge = "{\"type\": \"hinge\", \"name\": \"pin\", \"anchor\": [1, 0, 2], \"axis\": [0, 1, 0]}";
  CHECK(rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  CHECK(rb_world_find_body(world, "crate", &crate) == RB_OK);
  CHECK(rb_world_add_joint(world, hinge, crate, none, none, none, &joint) == RB_OK);
  for (int step = 0; step < 30; ++step) rb_world_step(world, NULL);
  CHECK(rb_world_joint_state(world, joint, &state) == RB_OK);
  CHECK(state.axis_count == 1 && state.gap < 1e-3 && fabs(state.axes[0].position) > 0.1);
  CHECK(rb_world_set_joint(world, joint, "{\"axes\": [{\"min\": -0.5, \"max\": 0.5}]}") == RB_OK);
  CHECK(rb_world_set_joint(world, joint, "{\"axes\": [{\"mix\": 1}]}") == RB_INVALID);
  CHECK(strcmp(rb_last_error()->path, "joint.axes[0].mix") == 0);
  rb_world_destroy(world);
  rb_scene_destroy(scene);
}

static void aSheetIsHitByQueriesThatAskForDeformables(void) {
  rb_scene* scene = NULL;
  rb_world* world = NULL;
  rb_shape* ball = NULL;
  const char* sheet = NULL;
  const double corner[3] = {-1, -1, 1}, u[3] = {2, 0, 0}, v[3] = {0, 2, 0};
  rb_deformable_id object;
  rb_hit hit;
  const rb_hit* hits;
  const int64_t* offsets;
  rb_ray ray = {{0.1, 0.2, 3}, {0, 0, -1}, 10, RB_FILTER_ALL};
  rb_closest point = {{0.1, 0.2, 3}, 10, RB_FILTER_ALL};
  CHECK(rb_scene_create("", &scene) == RB_OK && rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  CHECK(rb_cloth_sheet(corner, u, v, 2, 2, &sheet) == RB_OK);
  CHECK(rb_world_add_deformable(world, sheet, &object) == RB_OK);
  CHECK(rb_shape_create("{\"type\": \"sphere\", \"radius\": 0.5}", &ball) == RB_OK);
  rb_cast cast = {ball, {0.1, 0.2, 3}, {1, 0, 0, 0}, {0, 0, -4}, RB_FILTER_ALL};
  CHECK(rb_world_cast_rays(world, &ray, 1, &hit) == RB_OK && hit.hit == 0);
  ray.filter.deformables = cast.filter.deformables = point.filter.deformables = 1;
  CHECK(rb_world_cast_rays(world, &ray, 1, &hit) == RB_OK && hit.hit == 1);
  CHECK(hit.body.index == -1 && hit.object.index == object.index && hit.triangle >= 0);
  CHECK(fabs(hit.distance - 2) < 1e-6 && fabs(hit.normal[2] - 1) < 1e-6);
  CHECK(rb_world_cast_shapes(world, &cast, 1, &hit) == RB_OK && fabs(hit.distance - 1.5 / 4) < 1e-3);
  CHECK(rb_world_closest_points(world, &point, 1, &hit) == RB_OK && hit.object.index == object.index);
  CHECK(rb_world_cast_rays_all(world, &ray, 1, &offsets, &hits) == RB_OK && offsets[1] == 1);
  ray.filter.ignore_object = object;
  CHECK(rb_world_cast_rays(world, &ray, 1, &hit) == RB_OK && hit.hit == 0);
  rb_shape_destroy(ball);
  rb_world_destroy(world);
  rb_scene_destroy(scene);
}

static void aShapeLivesAsLongAsItIsUsed(void) {
  rb_scene* scene = NULL;
  rb_world* world = NULL;
  rb_shape* cone = NULL;
  rb_shape_id id, own;
  rb_body_id body;
  int64_t uses = 0, count = 0;
  uint64_t mark = 0;
  const rb_shape_id* shapes;
  const char* json = NULL;
  const char* const text = "{\"type\": \"cone\", \"radius\": 0.5, \"length\": 1, \"user_data\": 9}";
  CHECK(rb_scene_create("", &scene) == RB_OK && rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  CHECK(rb_shape_create(text, &cone) == RB_OK);
  CHECK(rb_world_add_shape(world, cone, &id) == RB_OK);
  CHECK(rb_world_add_body_of(world, id, "{\"mass\": 2, \"position\": [0, 0, 5]}", &body) == RB_OK);
  CHECK(rb_world_shape_of(world, body, &own) == RB_OK && own.index == id.index);
  CHECK(rb_world_shape_uses(world, id, &uses) == RB_OK && uses == 2);
  CHECK(rb_world_shape_user_data(world, body, 0, &mark) == RB_OK && mark == 9);
  CHECK(rb_world_shape_definition(world, id, &json) == RB_OK && strstr(json, "\"cone\"") != NULL);
  CHECK(rb_world_remove_shape(world, id) == RB_OK && rb_world_shape_alive(world, id) == 1);
  CHECK(rb_world_remove_shape(world, id) == RB_INVALID);
  CHECK(rb_world_remove_bodies(world, &body, 1) == RB_OK && rb_world_shape_alive(world, id) == 0);
  CHECK(rb_world_shapes(world, &shapes, &count) == RB_OK && count == 0);
  CHECK(rb_world_set_shape(world, body, id) == RB_INVALID);
  rb_shape_destroy(cone);
  rb_world_destroy(world);
  rb_scene_destroy(scene);
}

static void aBodyTellsItsMaterialItsJointsAndItsContacts(void) {
  rb_scene* scene = NULL;
  rb_world* world = NULL;
  rb_sensors* sensors = NULL;
  rb_body_id crate, ground;
  rb_debug_draw drawing;
  rb_array forces;
  const rb_joint_id* joints;
  const rb_contact_point* contacts;
  const double* readings;
  const char* json = NULL;
  const double push[3] = {0, 0, 2}, side[3] = {0.5, 0, 0.5}, still[3] = {0, 0, 0};
  int64_t joint_count = 0, contact_count = 0, reading_count = 0;
  uint64_t mark = 0;
  rb_body_state state;
  CHECK(rb_scene_parse("{\"bodies\": [{\"name\": \"ground\", \"shape\": {\"type\": \"plane\"}},"
                       "{\"name\": \"crate\", \"mass\": 2, "
                       "\"shape\": {\"type\": \"box\", \"size\": [1, 1, 1]},"
                       "\"position\": [0, 0, 0.5], \"material\": {\"friction\": 0.25}}],"
                       "\"joints\": [{\"type\": \"slider\", \"name\": \"rail\", \"body_a\": \"crate\","
                       "\"body_b\": \"world\", \"anchor\": [0, 0, 0.5], \"axis\": [0, 0, 1]}],"
                       "\"sensors\": [{\"name\": \"height\", \"type\": \"position\", \"body\": \"crate\"}]}",
                       "", &scene) == RB_OK);
  CHECK(rb_world_create(scene, "{\"threads\": 1}", &world) == RB_OK);
  CHECK(rb_world_find_body(world, "crate", &crate) == RB_OK);
  CHECK(rb_world_find_body(world, "ground", &ground) == RB_OK);
  for (int step = 0; step < 30; ++step) CHECK(rb_world_step(world, NULL) == RB_OK);
  CHECK(rb_world_material_of(world, crate, 0, &json) == RB_OK && strstr(json, "\"friction\":0.25") != NULL);
  CHECK(rb_world_material_of(world, crate, 1, &json) == RB_INVALID);
  CHECK(rb_world_joints_of(world, crate, &joints, &joint_count) == RB_OK && joint_count == 1);
  CHECK(rb_world_contacts_of(world, crate, &contacts, &contact_count) == RB_OK && contact_count == 4);
  const rb_body_id pair[2] = {ground, crate};
  CHECK(rb_world_contact_forces(world, pair, 1, &forces) == RB_OK && forces.shape[0] == 1);
  CHECK(fabs(((const float*)forces.data)[2] - 2 * 9.81) < 0.2);
  CHECK(rb_world_set_body_user_data(world, crate, 77) == RB_OK);
  CHECK(rb_world_body_user_data(world, crate, &mark) == RB_OK && mark == 77);
  CHECK(rb_world_set_motor_force(world, joints[0], 0, 5) == RB_OK);
  CHECK(rb_world_set_motor_force(world, joints[0], 1, 5) == RB_INVALID);
  CHECK(rb_sensors_create(scene, world, &sensors) == RB_OK);
  CHECK(rb_sensors_list(sensors, &json) == RB_OK && strstr(json, "\"height\"") != NULL);
  CHECK(rb_sensors_update(sensors, &readings, &reading_count) == RB_OK && reading_count == 3);
  CHECK(fabs(readings[2] - 0.5) < 0.01);
  CHECK(rb_world_debug_draw(world, "{\"names\": true}", &drawing) == RB_OK);
  CHECK(drawing.triangle_count >= 12 && drawing.text_count == 2);
  CHECK(strcmp(drawing.texts[1].text, "crate") == 0);
  CHECK(rb_world_debug_draw(world, "{\"nams\": true}", &drawing) == RB_INVALID);
  CHECK(rb_world_remove_joint(world, joints[0]) == RB_OK);
  CHECK(rb_world_set_velocity(world, crate, push, still) == RB_OK);
  CHECK(rb_world_body_state(world, crate, &state) == RB_OK && fabs(state.velocity[2] - 2) < 1e-6);
  CHECK(rb_world_apply_impulse_at(world, crate, push, side) == RB_OK);
  CHECK(rb_world_apply_angular_impulse(world, crate, push) == RB_OK);
  CHECK(rb_world_body_state(world, crate, &state) == RB_OK && fabs(state.velocity[2] - 3) < 1e-6);
  CHECK(fabs(state.angular_velocity[2] - 6) < 1e-5 && fabs(state.angular_velocity[1] + 3) < 1e-5);
  CHECK(rb_world_run_events(world) == RB_OK);
  CHECK(rb_world_table_hashes(world, &json) == RB_OK && strstr(json, "\"position\"") != NULL);
  rb_sensors_destroy(sensors);
  rb_world_destroy(world);
  rb_scene_destroy(scene);
}

static void verticesOfManyWorldsAreRowsOfOneArray(void) {
  rb_scene* scene = NULL;
  rb_worlds* worlds = NULL;
  rb_world* world = NULL;
  rb_deformable_id object;
  rb_array array;
  const char* cable = NULL;
  const double from[3] = {0, 0, 1}, to[3] = {1, 0, 1};
  int32_t first = 0;
  CHECK(rb_scene_create("", &scene) == RB_OK && rb_straight_cable(from, to, 4, &cable) == RB_OK);
  CHECK(rb_scene_add(scene, "deformables", cable, NULL) == RB_OK);
  CHECK(rb_worlds_create("{\"threads\": 1}", &worlds) == RB_OK);
  CHECK(rb_worlds_add(worlds, scene, 3, NULL) == RB_OK && rb_worlds_step(worlds, 2, NULL, NULL) == RB_OK);
  CHECK(rb_worlds_vertex_array(worlds, RB_VERTEX_POSITION, &array) == RB_OK && array.shape[0] == 15);
  CHECK(rb_worlds_vertex_array(worlds, 2, &array) == RB_INVALID);
  CHECK(rb_worlds_first_vertex(worlds, 2, &first) == RB_OK && first == 10);
  CHECK(rb_worlds_world(worlds, 1, &world) == RB_OK && rb_world_deformable_at(world, 0, &object) == RB_OK);
  CHECK(rb_world_first_vertex(world, object, &first) == RB_OK && first == 0);
  CHECK(rb_world_vertex_array(world, RB_VERTEX_VELOCITY, &array) == RB_OK && array.shape[0] == 5);
  rb_world_destroy(world);
  rb_worlds_destroy(worlds);
  rb_scene_destroy(scene);
}

static void aRegistrySceneIsJudged(void) {
  rb_run* run = NULL;
  const char* result = NULL;
  CHECK(rb_run_create("pendulum", NULL, "{\"threads\": 1}", &run) == RB_OK);
  const int32_t steps = rb_run_steps(run);
  for (int32_t step = 0; step < steps; ++step) CHECK(rb_run_step(run, NULL) == RB_OK);
  CHECK(rb_run_finish(run, &result) == RB_OK);
  CHECK(strstr(result, "\"holds\":true") != NULL);
  rb_run_destroy(run);
}

static void sensorsOfASceneMeasureManyWorlds(void) {
  const char* const kSensor = "{\"type\": \"position\", \"body\": \"crate\"}";
  const char* const kBody = "{\"name\": \"crate\", \"shape\": {\"type\": \"sphere\", \"radius\": 1}}";
  const double place[3] = {1, 2, 3}, *values = NULL;
  const uint8_t active[2] = {0, 1};
  const int32_t second = 1;
  int64_t count = 0;
  rb_scene* scene = NULL;
  rb_worlds* worlds = NULL;
  rb_sensors* sensors = NULL;
  CHECK(rb_scene_create("", &scene) == RB_OK);
  CHECK(rb_scene_add(scene, "bodies", kBody, NULL) == RB_OK);
  CHECK(rb_scene_add(scene, "sensors", kSensor, NULL) == RB_OK);
  CHECK(rb_worlds_create("{\"threads\": 1}", &worlds) == RB_OK);
  CHECK(rb_worlds_add(worlds, scene, 2, NULL) == RB_OK);
  CHECK(rb_sensors_create_in(scene, worlds, 0, 3, &sensors) == RB_INVALID);
  CHECK(rb_sensors_create_in(scene, worlds, 0, -1, &sensors) == RB_OK);
  CHECK(rb_worlds_set_values(worlds, "bodies.crate.position", &second, 1, place, 3) == RB_OK);
  CHECK(rb_sensors_update_in(sensors, active, &values, &count) == RB_OK && count == 6);
  CHECK(values[0] == 0 && values[3] == 1 && values[5] == 3);
  rb_sensors_destroy(sensors);
  rb_worlds_destroy(worlds);
  rb_scene_destroy(scene);
}

static void arraysOfJointsAndSensorsHaveRowsOfAllWorlds(void) {
  rb_scene* scene = NULL;
  rb_worlds* worlds = NULL;
  rb_array array, rows, values;
  rb_ray ray;
  rb_hit hit;
  const int32_t row = 1, second = 1;
  const double force = 5, mass = 3, *found = NULL;
  double drawn[2], again = 0;
  const int32_t third = 2;
  int64_t count = 0, episode = 0, at = 0;
  uint64_t seed = 0;
  int32_t first = 0;
  CHECK(rb_scene_build("cart-pole", "{\"lean\": 0.1}", &scene) == RB_OK);
  CHECK(rb_worlds_create("{\"threads\": 1}", &worlds) == RB_OK);
  CHECK(rb_worlds_add(worlds, scene, 3, NULL) == RB_OK);
  CHECK(rb_worlds_first_axis(worlds, 2, &first) == RB_OK && first == 4);
  CHECK(rb_worlds_joint_array(worlds, RB_JOINT_UPPER_LIMIT, &array) == RB_OK);
  CHECK(array.shape[0] == 6 && array.shape[1] == 1 && fabs(*(const float*)array.data - 2.4) < 1e-6);
  CHECK(rb_worlds_joint_array(worlds, RB_JOINT_APPLIED_FORCE, &array) == RB_INVALID);
  CHECK(rb_worlds_sensor_array(worlds, RB_SENSOR_JOINT_FORCE, &array) == RB_OK && array.shape[0] == 6);
  memset(&rows, 0, sizeof rows), memset(&values, 0, sizeof values);
  rows.data = &row, rows.shape[0] = rows.shape[1] = 1, rows.typestr = "<i4";
  rows.strides[0] = rows.strides[1] = sizeof row;
  values = rows;
  values.data = &force, values.typestr = "<f8", values.strides[0] = values.strides[1] = sizeof force;
  CHECK(rb_worlds_scatter_joints(worlds, RB_JOINT_APPLIED_FORCE, &rows, &values) == RB_OK);
  CHECK(rb_worlds_set_values(worlds, "bodies.pole.mass", &second, 1, &mass, 1) == RB_OK);
  CHECK(rb_worlds_set_values(worlds, "bodies.pole.weight", &second, 1, &mass, 1) == RB_INVALID);
  CHECK(rb_worlds_values(worlds, "bodies.pole.mass", &second, 1, &found, &count) == RB_OK);
  CHECK(count == 1 && found[0] == mass);
  CHECK(rb_worlds_set_seed(worlds, 4, NULL, 0) == RB_OK);
  CHECK(rb_worlds_uniform(worlds, &second, 1, 2, 0, 1, drawn) == RB_OK);
  CHECK(rb_worlds_random_state(worlds, 1, &seed, &episode, &at) == RB_OK && episode == 0 && at == 2);
  CHECK(rb_worlds_set_random_state(worlds, 2, seed, 0, 1) == RB_OK);
  CHECK(rb_worlds_uniform(worlds, &third, 1, 1, 0, 1, &again) == RB_OK && again == drawn[1]);
  ray = (rb_ray){{0, 0, -5}, {0, 0, 1}, 50, RB_FILTER_ALL};
  CHECK(rb_worlds_cast_rays(worlds, &second, &ray, 1, &hit) == RB_OK && hit.hit == 1);
  rb_worlds_destroy(worlds);
  rb_scene_destroy(scene);
}

int main(void) {
  CHECK(rb_api_version() == RB_API_VERSION);
  anInvalidBodyIsNamedAndLeavesTheSceneAsItWas();
  aWorldOfManyStaysWhereItIsLeftOut();
  arraysOfJointsAndSensorsHaveRowsOfAllWorlds();
  sensorsOfASceneMeasureManyWorlds();
  noCallDiesOfANullPointer();
  aCrateFallsAndRests();
  anArrayIsATensorThatKeepsItsWorld();
  aSnapshotContinuesBitForBit();
  aHingeAddedToAWorldStandsAtThePresentPoses();
  aSheetIsHitByQueriesThatAskForDeformables();
  aShapeLivesAsLongAsItIsUsed();
  aBodyTellsItsMaterialItsJointsAndItsContacts();
  verticesOfManyWorldsAreRowsOfOneArray();
  aRegistrySceneIsJudged();
  printf("%d failures\n", failures);
  return failures != 0;
}

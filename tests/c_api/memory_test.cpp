/// Every allocation of calls of the C library fails once, alone and with all after it. The call then returns
/// a status, with an error that can be read, and the world is as it was.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include <rubble/c/rubble.h>

#include "tests/backend/counted_memory.h"

namespace rubble {
namespace {

constexpr const char* kScene =
    R"({"bodies": [{"name": "ground", "shape": {"type": "plane"}},
                   {"name": "crate", "shape": {"type": "box", "size": [1, 1, 1]}, "position": [0, 0, 0.5]},
                   {"name": "ball", "shape": {"type": "sphere", "radius": 0.5}, "position": [0, 0, 1.6]}],
        "joints": [{"name": "link", "type": "ball", "body_a": "crate",
                    "body_b": "ball", "anchor": [0, 0, 1]}],
        "deformables": [{"type": "cable", "name": "rope", "vertices": [[3, 0, 1], [4, 0, 1], [5, 0, 1]],
                         "radius": 0.02}]})";
constexpr const char* kOptions = R"({"threads": 1, "events": true})";
constexpr const char* kMarble =
    R"({"name": "marble", "shape": {"type": "cone", "radius": 0.2, "height": 0.3}, "position": [-3, 0, 1]})";

/// What the calls are given.
class Session {
 public:
  Session() {
    expectOk(rb_scene_parse(kScene, "", &scene));
    expectOk(rb_world_create(scene, kOptions, &world));
    for (int step = 0; step < 2; ++step) expectOk(rb_world_step(world, nullptr));
    expectOk(rb_world_find_body(world, "ball", &ball));
    expectOk(rb_world_find_joint(world, "link", &link));
    expectOk(rb_world_find_deformable(world, "rope", &rope));
    expectOk(rb_world_snapshot(world, &snapshot));
    expectOk(rb_shape_create(R"({"type": "capsule", "radius": 0.2, "length": 0.5})", &capsule));
    expectOk(rb_world_add_shape(world, capsule, &capsuleId));
    expectOk(rb_worlds_create(kOptions, &batch));
    expectOk(rb_worlds_add(batch, scene, 2, nullptr));
    expectOk(rb_worlds_step(batch, 1, nullptr, nullptr));
    rb_world* first = nullptr;
    expectOk(rb_worlds_world(batch, 0, &first));
    expectOk(rb_world_snapshot(first, &batchSnapshot));
  }
  ~Session() {
    rb_scene_destroy(otherScene), rb_world_destroy(otherWorld), rb_worlds_destroy(worlds);
    rb_snapshot_destroy(snapshot), rb_snapshot_destroy(otherSnapshot), rb_shape_destroy(shape);
    rb_snapshot_destroy(batchSnapshot), rb_worlds_destroy(batch), rb_shape_destroy(capsule);
    rb_world_destroy(world), rb_scene_destroy(scene);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::uint64_t hash() const {
    std::uint64_t hash = 0;
    expectOk(rb_world_hash(world, &hash));
    for (int k = 0; k < rb_worlds_count(batch); ++k) {
      rb_world* of = nullptr;
      std::uint64_t own = 0;
      expectOk(rb_worlds_world(batch, k, &of));
      expectOk(rb_world_hash(of, &own));
      hash = hash * 31 + own;
    }
    return hash;
  }

  rb_scene *scene = nullptr, *otherScene = nullptr;
  rb_world *world = nullptr, *otherWorld = nullptr;
  rb_worlds *worlds = nullptr, *batch = nullptr;
  rb_snapshot *snapshot = nullptr, *otherSnapshot = nullptr, *batchSnapshot = nullptr;
  rb_shape *shape = nullptr, *capsule = nullptr;
  rb_shape_id capsuleId{};
  rb_body_id ball{};
  rb_joint_id link{};
  rb_deformable_id rope{};

 private:
  static void expectOk(rb_status status) { ASSERT_EQ(status, RB_OK) << rb_last_error()->message; }
};

struct Call {
  const char* name;
  std::function<rb_status(Session&)> take;
  bool steps = false;  ///< it may have stepped when it fails
};

rb_query_filter everything() {
  rb_query_filter filter{};
  filter.layers = filter.mask = 0xffffffffu, filter.ignore.index = -1, filter.ignore_object.index = -1;
  filter.deformables = 1;
  return filter;
}

/// A row of three numbers, for row 1 of a state array.
struct OneRow {
  int row = 1;
  double numbers[3] = {1, 2, 3};
  rb_array rows() const { return view(&row, "<i4", sizeof row, 1); }
  rb_array values() const { return view(numbers, "<f8", sizeof(double), 3); }
  static rb_array view(const void* data, const char* type, std::int64_t size, std::int64_t columns) {
    rb_array out{};
    out.data = data, out.typestr = type;
    out.shape[0] = 1, out.shape[1] = columns;
    out.strides[0] = size * columns, out.strides[1] = size;
    return out;
  }
};

/// Calls of a world beyond the first ones.
const std::string kMarbles = "[" + std::string(kMarble) + "]";

std::vector<Call> moreCalls() {
  return {
      {"scene_set", [](Session& s) { return rb_scene_set(s.scene, "gravity", "[0, 0, -5]"); }},
      {"world_set_gravity",
       [](Session& s) {
         const double gravity[3] = {0, 1, -9};
         return rb_world_set_gravity(s.world, gravity);
       }},
      {"world_set_material_pair",
       [](Session& s) {
         return rb_world_set_material_pair(s.world, R"({"a": "wood", "b": "ice", "dynamic_friction": 0.1})");
       }},
      {"world_run_events", [](Session& s) { return rb_world_run_events(s.world); }},
      {"world_add_bodies",
       [](Session& s) {
         const rb_body_id* bodies;
         std::int64_t count;
         return rb_world_add_bodies(s.world, kMarbles.c_str(), &bodies, &count);
       }},
      {"world_set_shape", [](Session& s) { return rb_world_set_shape(s.world, s.ball, s.capsuleId); }},
      {"world_set_body_states",
       [](Session& s) {
         const rb_body_state state{{0, 0, 3}, {1, 0, 0, 0}, {}, {}};
         return rb_world_set_body_states(s.world, &s.ball, 1, &state);
       }},
      {"world_apply_forces",
       [](Session& s) {
         const double force[3] = {1, 2, 3};
         return rb_world_apply_forces(s.world, &s.ball, 1, force, force);
       }},
      {"world_apply_impulses",
       [](Session& s) {
         const double impulse[3] = {1, 2, 3};
         return rb_world_apply_impulses(s.world, &s.ball, 1, impulse);
       }},
      {"world_scatter",
       [](Session& s) {
         const OneRow one;
         const rb_array rows = one.rows(), values = one.values();
         return rb_world_scatter(s.world, RB_VELOCITY, &rows, &values);
       }},
      {"world_wake", [](Session& s) { return rb_world_wake(s.world, s.ball); }},
      {"world_remove_joint", [](Session& s) { return rb_world_remove_joint(s.world, s.link); }},
      {"world_add_drag_joint",
       [](Session& s) {
         const double point[3] = {0, 0, 2};
         rb_joint_id joint;
         return rb_world_add_drag_joint(s.world, s.ball, point, 100, 5, &joint);
       }},
      {"world_add_deformable",
       [](Session& s) {
         rb_deformable_id object;
         return rb_world_add_deformable(
             s.world, R"({"type": "cable", "vertices": [[3, 1, 1], [4, 1, 1]], "radius": 0.02})", &object);
       }},
      {"world_add_attachment",
       [](Session& s) {
         rb_attachment_id attachment;
         return rb_world_add_attachment(s.world, R"({"vertices": [0]})", s.rope, s.ball, {-1, 0},
                                        &attachment);
       }},
      {"world_set_vertices",
       [](Session& s) {
         const double positions[9] = {3, 0, 2, 4, 0, 2, 5, 0, 2}, velocities[9] = {};
         return rb_world_set_vertices(s.world, s.rope, positions, velocities, 3);
       }},
      {"world_arrays",
       [](Session& s) {
         rb_array array;
         const rb_status first = rb_world_array(s.world, RB_POSITION, &array);
         return first == RB_OK ? rb_world_joint_array(s.world, 0, &array) : first;
       }},
      {"world_sensor_array",
       [](Session& s) {
         rb_array array;
         return rb_world_sensor_array(s.world, 0, &array);
       }},
      {"world_joints",
       [](Session& s) {
         const rb_joint_id* joints;
         std::int64_t count;
         const rb_status first = rb_world_joints(s.world, &joints, &count);
         return first == RB_OK ? rb_world_joints_of(s.world, s.ball, &joints, &count) : first;
       }},
      {"world_axes",
       [](Session& s) {
         const rb_joint_id* joints;
         const std::int32_t* axes;
         std::int64_t count;
         return rb_world_axes(s.world, &joints, &axes, &count);
       }},
      {"world_joint_state",
       [](Session& s) {
         rb_joint_state state;
         return rb_world_joint_state(s.world, s.link, &state);
       }},
      {"world_shapes",
       [](Session& s) {
         const rb_shape_id* shapes;
         std::int64_t count;
         return rb_world_shapes(s.world, &shapes, &count);
       }},
      {"world_surface",
       [](Session& s) {
         rb_surface surface;
         return rb_world_surface(s.world, s.rope, &surface);
       }},
      {"world_vertex_contacts",
       [](Session& s) {
         const rb_vertex_contact* contacts;
         std::int64_t count;
         return rb_world_vertex_contacts(s.world, &contacts, &count);
       }},
      {"world_contact_load",
       [](Session& s) {
         rb_contact_load load;
         return rb_world_contact_load(s.world, s.ball, &load);
       }},
      {"world_solver_states",
       [](Session& s) {
         const rb_solver_state* states;
         std::int64_t count;
         const rb_status first = rb_world_solver_states(s.world, &states, &count);
         return first == RB_OK ? rb_world_vertex_solver_states(s.world, s.rope, &states, &count) : first;
       }},
      {"world_closest_points",
       [](Session& s) {
         const rb_closest point{{0, 0, 3}, 5, everything()};
         rb_hit hit;
         return rb_world_closest_points(s.world, &point, 1, &hit);
       }},
      {"world_cast_rays_all",
       [](Session& s) {
         const rb_ray ray{{0, 0, 9}, {0, 0, -1}, 20, everything()};
         const std::int64_t* offsets;
         const rb_hit* hits;
         return rb_world_cast_rays_all(s.world, &ray, 1, &offsets, &hits);
       }},
      {"world_cast_shapes",
       [](Session& s) {
         const rb_cast cast{s.capsule, {0, 0, 9}, {1, 0, 0, 0}, {0, 0, -9}, everything()};
         rb_hit hit;
         return rb_world_cast_shapes(s.world, &cast, 1, &hit);
       }},
      {"world_overlaps_all",
       [](Session& s) {
         const rb_overlap shape{s.capsule, {0, 0, 1}, {1, 0, 0, 0}, everything()};
         const std::int64_t* offsets;
         const rb_hit* hits;
         return rb_world_overlaps_all(s.world, &shape, 1, &offsets, &hits);
       }},
      {"snapshot_bytes",
       [](Session& s) {
         const std::uint8_t* bytes;
         std::int64_t count;
         const rb_status written = rb_snapshot_bytes(s.snapshot, &bytes, &count);
         return written == RB_OK ? rb_snapshot_from_bytes(bytes, count, &s.otherSnapshot) : written;
       }},
      {"worlds_add", [](Session& s) { return rb_worlds_add(s.batch, s.scene, 2, nullptr); }},
      {"worlds_step", [](Session& s) { return rb_worlds_step(s.batch, 1, nullptr, nullptr); }, true},
      {"worlds_reset",
       [](Session& s) {
         const std::int32_t both[2] = {1, 0};
         return rb_worlds_reset(s.batch, both, 2, &s.batchSnapshot, 1);
       }},
      {"worlds_set_params", [](Session& s) { return rb_worlds_set_params(s.batch, R"({"iterations": 5})"); }},
      {"worlds_array",
       [](Session& s) {
         rb_array array;
         return rb_worlds_array(s.batch, RB_POSITION, &array);
       }},
      {"worlds_rows",
       [](Session& s) {
         const std::int32_t* rows;
         std::int64_t count;
         return rb_worlds_rows(s.batch, 1, &rows, &count);
       }},
      {"worlds_scatter",
       [](Session& s) {
         const OneRow one;
         const rb_array rows = one.rows(), values = one.values();
         return rb_worlds_scatter(s.batch, RB_VELOCITY, &rows, &values);
       }},
      {"worlds_cast_rays",
       [](Session& s) {
         const rb_ray ray{{0, 0, 9}, {0, 0, -1}, 20, everything()};
         const std::int32_t number = 1;
         rb_hit hit;
         return rb_worlds_cast_rays(s.batch, &number, &ray, 1, &hit);
       }},
  };
}

std::vector<Call> calls() {
  return {
      {"scene_parse", [](Session& s) { return rb_scene_parse(kScene, "", &s.otherScene); }},
      {"scene_add", [](Session& s) { return rb_scene_add(s.scene, "bodies", kMarble, nullptr); }},
      {"shape_create",
       [](Session& s) {
         return rb_shape_create(R"({"type": "hull", "vertices": [[0,0,0], [1,0,0], [0,1,0], [0,0,1]]})",
                                &s.shape);
       }},
      {"world_create", [](Session& s) { return rb_world_create(s.scene, kOptions, &s.otherWorld); }},
      {"world_step", [](Session& s) { return rb_world_step(s.world, nullptr); }, true},
      {"world_add_body",
       [](Session& s) {
         rb_body_id body;
         return rb_world_add_body(s.world, kMarble, &body);
       }},
      {"world_remove_bodies", [](Session& s) { return rb_world_remove_bodies(s.world, &s.ball, 1); }},
      {"world_set_params", [](Session& s) { return rb_world_set_params(s.world, R"({"iterations": 5})"); }},
      {"world_apply_force",
       [](Session& s) {
         const double force[3] = {1, 2, 3};
         return rb_world_apply_force(s.world, s.ball, force);
       }},
      {"world_add_joint",
       [](Session& s) {
         rb_joint_id joint;
         const rb_body_id none{-1, 0};
         return rb_world_add_joint(s.world, R"({"type": "hinge", "anchor": [1, 0, 2], "axis": [0, 1, 0]})",
                                   s.ball, none, none, none, &joint);
       }},
      {"world_remove_deformable", [](Session& s) { return rb_world_remove_deformable(s.world, s.rope); }},
      {"world_bodies",
       [](Session& s) {
         const rb_body_id* bodies;
         std::int64_t count;
         return rb_world_bodies(s.world, &bodies, &count);
       }},
      {"world_contacts",
       [](Session& s) {
         const rb_contact_point* contacts;
         std::int64_t count;
         return rb_world_contacts(s.world, &contacts, &count);
       }},
      {"world_contacts_of",
       [](Session& s) {
         const rb_contact_point* contacts;
         std::int64_t count;
         return rb_world_contacts_of(s.world, s.ball, &contacts, &count);
       }},
      {"world_vertex_array",
       [](Session& s) {
         rb_array array;
         return rb_world_vertex_array(s.world, RB_VERTEX_POSITION, &array);
       }},
      {"world_debug_draw",
       [](Session& s) {
         rb_debug_draw drawing;
         return rb_world_debug_draw(s.world, R"({"contacts": true})", &drawing);
       }},
      {"world_events",
       [](Session& s) {
         rb_events events;
         return rb_world_events(s.world, &events);
       }},
      {"world_cast_rays",
       [](Session& s) {
         rb_ray ray{};
         ray.origin[2] = 9, ray.direction[2] = -1, ray.max_distance = 20;
         ray.filter.layers = ray.filter.mask = 0xffffffffu, ray.filter.ignore.index = -1;
         rb_hit hit;
         return rb_world_cast_rays(s.world, &ray, 1, &hit);
       }},
      {"world_snapshot", [](Session& s) { return rb_world_snapshot(s.world, &s.otherSnapshot); }},
      {"world_restore", [](Session& s) { return rb_world_restore(s.world, s.snapshot); }},
      {"worlds_create", [](Session& s) { return rb_worlds_create(kOptions, &s.worlds); }},
      {"worlds_of_a_scene",
       [](Session& s) {
         const rb_status made = s.worlds ? RB_OK : rb_worlds_create(kOptions, &s.worlds);
         return made == RB_OK ? rb_worlds_add(s.worlds, s.scene, 3, nullptr) : made;
       }},
      {"invalid", [](Session& s) { return rb_scene_add(s.scene, "bodies", R"({"mass": -1})", nullptr); }},
  };
}

void expectStatuses(const std::vector<Call>& calls, bool lasting) {
  constexpr long kMostAllocations = 10000;
  for (const Call& call : calls) {
    rb_status whole = RB_OK;
    {
      Session session;
      whole = call.take(session);
    }
    for (long k = 0;; ++k) {
      ASSERT_LT(k, kMostAllocations) << call.name;
      Session session;
      const std::uint64_t before = session.hash();
      rb_status status = RB_OK;
      bool failed = false;
      rb_world_step(nullptr, nullptr);  // the last error is another one
      {
        const test::FailingMemory failing(k, lasting);
        status = call.take(session);
        failed = failing.hasFailed();
      }
      if (!failed) {
        EXPECT_EQ(status, whole) << call.name << " " << k;
        break;
      }
      if (status == whole) continue;  // it found another way
      ASSERT_EQ(status, RB_OUT_OF_MEMORY) << call.name << " " << k;
      EXPECT_EQ(rb_last_error()->status, status) << call.name << " " << k;
      EXPECT_NE(std::string(rb_last_error()->message), "") << call.name << " " << k;
      if (!call.steps) {
        EXPECT_EQ(session.hash(), before) << call.name << " " << k;
      }
      ASSERT_EQ(call.take(session), whole) << call.name << " " << k << ": " << rb_last_error()->message;
    }
  }
}

TEST(OutOfMemory, IsAStatusOfTheCLibrary) { expectStatuses(calls(), false); }
TEST(OutOfMemory, IsAStatusOfTheCLibraryWhenItLasts) { expectStatuses(calls(), true); }
TEST(OutOfMemory, IsAStatusOfFurtherCallsOfTheCLibrary) { expectStatuses(moreCalls(), false); }
TEST(OutOfMemory, IsAStatusOfFurtherCallsOfTheCLibraryWhenItLasts) { expectStatuses(moreCalls(), true); }

}  // namespace
}  // namespace rubble

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
    expectOk(rb_world_find_deformable(world, "rope", &rope));
    expectOk(rb_world_snapshot(world, &snapshot));
  }
  ~Session() {
    rb_scene_destroy(otherScene), rb_world_destroy(otherWorld), rb_worlds_destroy(worlds);
    rb_snapshot_destroy(snapshot), rb_snapshot_destroy(otherSnapshot), rb_shape_destroy(shape);
    rb_world_destroy(world), rb_scene_destroy(scene);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::uint64_t hash() const {
    std::uint64_t hash = 0;
    expectOk(rb_world_hash(world, &hash));
    return hash;
  }

  rb_scene *scene = nullptr, *otherScene = nullptr;
  rb_world *world = nullptr, *otherWorld = nullptr;
  rb_worlds* worlds = nullptr;
  rb_snapshot *snapshot = nullptr, *otherSnapshot = nullptr;
  rb_shape* shape = nullptr;
  rb_body_id ball{};
  rb_deformable_id rope{};

 private:
  static void expectOk(rb_status status) { ASSERT_EQ(status, RB_OK) << rb_last_error()->message; }
};

struct Call {
  const char* name;
  std::function<rb_status(Session&)> take;
  bool steps = false;  ///< it may have stepped when it fails
};

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

void expectStatuses(bool lasting) {
  constexpr long kMostAllocations = 10000;
  for (const Call& call : calls()) {
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

TEST(OutOfMemory, IsAStatusOfTheCLibrary) { expectStatuses(false); }
TEST(OutOfMemory, IsAStatusOfTheCLibraryWhenItLasts) { expectStatuses(true); }

}  // namespace
}  // namespace rubble

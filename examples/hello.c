/* A crate falls on the ground. Build: cc hello.c -lrubble_c */
#include <rubble/c/rubble.h>
#include <stdio.h>
#include <stdlib.h>

static void check(rb_status status) {
  if (status == RB_OK) return;
  fprintf(stderr, "%s\n", rb_last_error()->message);
  exit(1);
}

int main(void) {
  rb_scene* scene = NULL;
  rb_world* world = NULL;
  rb_body_id crate;
  rb_body_state state;

  check(rb_scene_create("", &scene));
  check(rb_scene_add(scene, "bodies", "{\"shape\": {\"type\": \"plane\"}}", NULL));
  check(rb_scene_add(scene, "bodies",
                     "{\"name\": \"crate\", \"shape\": {\"type\": \"box\", \"size\": [1, 1, 1]},"
                     " \"position\": [0, 0, 3]}",
                     NULL));
  check(rb_world_create(scene, "{\"iterations\": 4}", &world));
  check(rb_world_find_body(world, "crate", &crate));
  for (int step = 0; step < 120; ++step) check(rb_world_step(world, NULL));
  check(rb_world_body_state(world, crate, &state));
  printf("the crate rests at %.2f m\n", state.position[2]);

  rb_world_destroy(world);
  rb_scene_destroy(scene);
  return 0;
}

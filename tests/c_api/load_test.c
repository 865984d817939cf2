/* The shared library is loaded, used and unloaded twice.
   Argument: the library. */
#include <dlfcn.h>
#include <rubble/c/rubble.h>
#include <stdio.h>

static int fail(const char* what) {
  printf("failed: %s\n", what);
  return 1;
}

/* dlsym gives data pointers, which ISO C does not convert to functions. */
#define FUNCTION(name) *(void**)&name = dlsym(library, "rb_" #name)

int main(int count, char** arguments) {
  if (count != 2) return fail("expected one argument");
  double heights[2] = {0, 1};
  for (int round = 0; round < 2; ++round) {
    void* library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return fail(dlerror());
    rb_status (*scene_parse)(const char*, const char*, rb_scene**);
    rb_status (*world_create)(const rb_scene*, const char*, rb_world**);
    rb_status (*world_step)(rb_world*, rb_step_report*);
    rb_status (*world_find_body)(const rb_world*, const char*, rb_body_id*);
    rb_status (*world_body_state)(const rb_world*, rb_body_id, rb_body_state*);
    void (*world_destroy)(rb_world*);
    void (*scene_destroy)(rb_scene*);
    const rb_error* (*last_error)(void);
    FUNCTION(scene_parse), FUNCTION(world_create), FUNCTION(world_step), FUNCTION(world_find_body);
    FUNCTION(world_body_state), FUNCTION(world_destroy), FUNCTION(scene_destroy), FUNCTION(last_error);
    rb_scene* scene;
    rb_world* world;
    rb_body_id body;
    rb_body_state state;
    const char* text = "{\"bodies\": [{\"name\": \"ball\", \"shape\": {\"type\": \"sphere\", \"radius\": 0.5}}]}";
    if (scene_parse(text, "", &scene)) return fail(last_error()->message);
    if (world_create(scene, "{}", &world)) return fail(last_error()->message);
    for (int step = 0; step < 10; ++step)
      if (world_step(world, NULL)) return fail(last_error()->message);
    if (world_find_body(world, "none", &body) != RB_INVALID) return fail("a body of no name");
    if (world_find_body(world, "ball", &body)) return fail(last_error()->message);
    if (world_body_state(world, body, &state)) return fail(last_error()->message);
    heights[round] = state.position[2];
    world_destroy(world), scene_destroy(scene);
    if (dlclose(library) != 0) return fail(dlerror());
  }
  printf("at %g m both times\n", heights[0]);
  return heights[0] == heights[1] && heights[0] < 0 ? 0 : fail("the ball did not fall");
}

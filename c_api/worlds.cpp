#include <rubble/c/worlds.h>

#include <algorithm>

#include <rubble/worlds.h>

#include "c_api/dlpack.h"
#include "c_api/handles.h"
#include "io/definition_json.h"

using namespace rubble;
using namespace rubble::c;

namespace {

Worlds& worldsOf(const rb_worlds* handle) { return *need(handle, "worlds").worlds; }

std::vector<int> numbersOf(const int32_t* numbers, int64_t count) {
  return mapped(numbers, count, [](int32_t number) { return int{number}; });
}

}  // namespace

extern "C" {

rb_status rb_worlds_create(const char* options, rb_worlds** worlds) {
  return guarded([&] {
    auto made = std::make_shared<Worlds>(io::parseOptions(textOr(options, "{}")));
    need(worlds, "worlds") = new rb_worlds{std::move(made)};
  });
}

void rb_worlds_destroy(rb_worlds* worlds) { delete worlds; }

rb_status rb_worlds_add(rb_worlds* worlds, const rb_scene* scene, int32_t count, int32_t* first) {
  return guarded([&] {
    if (count < 0) throw Error("count", "a number of at least 0", std::to_string(count));
    const int number = worldsOf(worlds).addCopies(need(scene, "scene").file.scene, count);
    if (first) *first = number;
  });
}

int32_t rb_worlds_count(const rb_worlds* worlds) { return worlds ? worlds->worlds->count() : 0; }

rb_status rb_worlds_world(const rb_worlds* worlds, int32_t number, rb_world** world) {
  return guarded([&] {
    World& one = worldsOf(worlds)[number];
    auto handle = std::make_unique<rb_world>();
    handle->world = std::shared_ptr<World>(worlds->worlds, &one);
    need(world, "world") = handle.release();
  });
}

rb_status rb_worlds_step(rb_worlds* worlds, int32_t steps, const uint8_t* active, rb_step_report* report) {
  return guarded([&] {
    Worlds& all = worldsOf(worlds);
    std::vector<char> mask;
    if (active) mask.assign(active, active + all.count());
    const StepReport last = all.step(steps, mask);
    if (report) *report = toC(last);
  });
}

rb_status rb_worlds_reset(rb_worlds* worlds, const int32_t* numbers, int64_t count,
                          const rb_snapshot* const* snapshots, int64_t snapshot_count) {
  return guarded([&] {
    const std::vector<int> list = numbersOf(numbers, count);
    const std::vector<Snapshot> states = mapped(
        snapshots, snapshot_count, [](const rb_snapshot* s) { return need(s, "snapshot").snapshot; });
    worldsOf(worlds).reset(list, states);
  });
}

rb_status rb_worlds_params(const rb_worlds* worlds, const char** json) {
  return guarded([&] { need(json, "json") = keepText(io::toJson(worldsOf(worlds).params())); });
}

rb_status rb_worlds_set_params(rb_worlds* worlds, const char* json) {
  return guarded([&] {
    Params params = worldsOf(worlds).params();
    io::parseParams(textOr(json, ""), params);
    worldsOf(worlds).setParams(params);
  });
}

rb_status rb_worlds_array(const rb_worlds* worlds, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldsOf(worlds).array(stateArrayOf(which))); });
}

rb_status rb_worlds_device(const rb_worlds* worlds, int32_t* device, uint64_t* stream) {
  return guarded([&] {
    const DeviceStream own = worldsOf(worlds).deviceStream();
    need(device, "device") = own.device, need(stream, "stream") = own.stream;
  });
}

rb_status rb_worlds_dlpack_of(rb_worlds* worlds, const rb_array* array, uint64_t stream, void** tensor) {
  return guarded([&] {
    need(worlds, "worlds");
    need(tensor, "tensor") = dlpack::tensorOn(worlds->worlds, fromC(need(array, "array")), stream);
  });
}

rb_status rb_worlds_rows(rb_worlds* worlds, int32_t number, const int32_t** rows, int64_t* count) {
  return guarded([&] {
    const std::vector<int> list = worldsOf(worlds).rowsOf(number);
    worlds->rows.assign(list.begin(), list.end());
    give(worlds->rows, rows, count);
  });
}

rb_status rb_worlds_scatter(rb_worlds* worlds, int32_t which, const rb_array* rows, const rb_array* values) {
  return guarded([&] {
    worldsOf(worlds).scatter(stateArrayOf(which), fromC(need(rows, "rows")), fromC(need(values, "values")));
  });
}

rb_status rb_worlds_joint_array(const rb_worlds* worlds, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldsOf(worlds).array(jointArrayOf(which))); });
}

rb_status rb_worlds_sensor_array(const rb_worlds* worlds, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldsOf(worlds).array(sensorArrayOf(which))); });
}

rb_status rb_worlds_vertex_array(const rb_worlds* worlds, int32_t which, rb_array* array) {
  return guarded([&] { need(array, "array") = toC(worldsOf(worlds).array(vertexArrayOf(which))); });
}

rb_status rb_worlds_first_vertex(const rb_worlds* worlds, int32_t number, int32_t* row) {
  return guarded([&] { need(row, "row") = worldsOf(worlds).firstVertex(number); });
}

rb_status rb_worlds_first_axis(const rb_worlds* worlds, int32_t number, int32_t* row) {
  return guarded([&] { need(row, "row") = worldsOf(worlds).firstAxis(number); });
}

rb_status rb_worlds_scatter_joints(rb_worlds* worlds, int32_t which, const rb_array* rows,
                                   const rb_array* values) {
  return guarded([&] {
    worldsOf(worlds).scatter(jointArrayOf(which), fromC(need(rows, "rows")), fromC(need(values, "values")));
  });
}

rb_status rb_worlds_contact_forces(const rb_worlds* worlds, const int32_t* rows, int64_t count,
                                   rb_array* array) {
  return guarded([&] {
    const std::vector<int> numbers = mapped(rows, 2 * count, [](int32_t row) { return int{row}; });
    std::vector<std::array<int, 2>> pairs;
    for (std::size_t k = 0; k + 1 < numbers.size(); k += 2) pairs.push_back({numbers[k], numbers[k + 1]});
    need(array, "array") = toC(worldsOf(worlds).contactForces(pairs));
  });
}

rb_status rb_worlds_cast_rays(rb_worlds* worlds, const int32_t* numbers, const rb_ray* rays, int64_t count,
                              rb_hit* hits) {
  return guarded([&] {
    const std::vector<int> of = numbersOf(numbers, count);
    std::size_t next = 0;
    const auto asked = mapped(rays, count, [&](const rb_ray& ray) {
      return Worlds::WorldRay{of[next++], queryOf(ray)};
    });
    if (count > 0) need(hits, "hits");
    for (const RayHit& hit : worldsOf(worlds).castRays(asked)) *hits++ = toC(hit);
  });
}

rb_status rb_worlds_cast_ray_arrays(rb_worlds* worlds, const rb_array* numbers, const rb_ray_arrays* rays,
                                    rb_ray_hit_arrays* hits) {
  return guarded([&] {
    const ArrayView of = numbers ? fromC(*numbers) : ArrayView{};
    need(hits, "hits") = toC(worldsOf(worlds).castRayArrays(raysOf(need(rays, "rays")), of));
  });
}

rb_status rb_worlds_set_values(rb_worlds* worlds, const char* key, const int32_t* numbers, int64_t count,
                               const double* values, int32_t width) {
  return guarded([&] {
    if (width < 1) throw Error("width", "a number of at least 1", std::to_string(width));
    const std::vector<int> of = numbersOf(numbers, count);
    const std::span<const double> given = of.empty() ? std::span<const double>{}
                                                     : std::span(&need(values, "values"),
                                                                 of.size() * static_cast<std::size_t>(width));
    worldsOf(worlds).setValues(textOr(key, ""), of, given);
  });
}

rb_status rb_worlds_values(rb_worlds* worlds, const char* key, const int32_t* numbers, int64_t count,
                           const double** values, int64_t* value_count) {
  return guarded([&] {
    worlds->values = worldsOf(worlds).values(textOr(key, ""), numbersOf(numbers, count));
    give(worlds->values, values, value_count);
  });
}

rb_status rb_worlds_set_seed(rb_worlds* worlds, uint64_t seed, const int32_t* numbers, int64_t count) {
  return guarded([&] {
    if (!numbers) return worldsOf(worlds).setSeed(seed);
    worldsOf(worlds).setSeed(seed, numbersOf(numbers, count));
  });
}

rb_status rb_worlds_random_state(const rb_worlds* worlds, int32_t number, uint64_t* seed, int64_t* episode,
                                 int64_t* drawn) {
  return guarded([&] {
    const RandomState state = worldsOf(worlds).randomState(number);
    if (seed) *seed = state.seed;
    if (episode) *episode = state.episode;
    if (drawn) *drawn = state.drawn;
  });
}

rb_status rb_worlds_set_random_state(rb_worlds* worlds, int32_t number, uint64_t seed, int64_t episode,
                                     int64_t drawn) {
  return guarded([&] { worldsOf(worlds).setRandomState(number, {seed, episode, drawn}); });
}

rb_status rb_worlds_uniform(rb_worlds* worlds, const int32_t* numbers, int64_t count, int32_t each,
                            double low, double high, double* values) {
  return guarded([&] {
    const std::vector<double> drawn = worldsOf(worlds).uniform(numbersOf(numbers, count), each, low, high);
    if (!drawn.empty()) std::ranges::copy(drawn, &need(values, "values"));
  });
}

int64_t rb_worlds_memory_bytes(const rb_worlds* worlds) {
  return worlds ? static_cast<int64_t>(worlds->worlds->memoryBytes()) : 0;
}
}

#include <rubble/c/world.h>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

namespace {

/// Keeps all hits of queries in the world.
template <class Hit>
void keep(rb_world* world, const std::vector<std::vector<Hit>>& found, const int64_t** offsets,
          const rb_hit** hits) {
  world->hits.clear(), world->hitOffsets.assign(1, 0);
  for (const std::vector<Hit>& list : found) {
    for (const Hit& hit : list) world->hits.push_back(toC(hit));
    world->hitOffsets.push_back(static_cast<int64_t>(world->hits.size()));
  }
  need(offsets, "offsets") = world->hitOffsets.data();
  need(hits, "hits") = world->hits.data();
}

CastQuery castOf(const rb_cast& cast) {
  return {need(cast.shape, "shape").shape, vec(cast.position), quat(cast.orientation), vec(cast.displacement),
          filterOf(cast.filter)};
}
OverlapQuery overlapOf(const rb_overlap& query) {
  return {need(query.shape, "shape").shape, vec(query.position), quat(query.orientation),
          filterOf(query.filter)};
}
ClosestQuery closestOf(const rb_closest& query) {
  return {vec(query.point), query.max_distance, filterOf(query.filter)};
}

}  // namespace

extern "C" {

rb_status rb_world_cast_rays(rb_world* world, const rb_ray* rays, int64_t count, rb_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(rays, count, queryOf);
    if (count > 0) need(hits, "hits");
    for (const RayHit& hit : worldOf(world).castRays(queries)) *hits++ = toC(hit);
  });
}

rb_status rb_world_cast_ray_arrays(rb_world* world, const rb_ray_arrays* rays, rb_ray_hit_arrays* hits) {
  return guarded([&] { need(hits, "hits") = toC(worldOf(world).castRayArrays(raysOf(need(rays, "rays")))); });
}

rb_status rb_world_cast_shapes(rb_world* world, const rb_cast* casts, int64_t count, rb_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(casts, count, castOf);
    if (count > 0) need(hits, "hits");
    for (const CastHit& hit : worldOf(world).castShapes(queries)) *hits++ = toC(hit);
  });
}

rb_status rb_world_overlaps(rb_world* world, const rb_overlap* shapes, int64_t count, const int64_t** offsets,
                            const rb_body_id** bodies) {
  return guarded([&] {
    const auto queries = mapped(shapes, count, overlapOf);
    need(world, "world").overlapping.clear();
    world->offsets.assign(1, 0);
    for (const std::vector<BodyId>& found : worldOf(world).overlaps(queries)) {
      for (const BodyId id : found) world->overlapping.push_back(idOf(id));
      world->offsets.push_back(static_cast<int64_t>(world->overlapping.size()));
    }
    need(offsets, "offsets") = world->offsets.data();
    need(bodies, "bodies") = world->overlapping.data();
  });
}

rb_status rb_world_closest_points(rb_world* world, const rb_closest* points, int64_t count, rb_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(points, count, closestOf);
    if (count > 0) need(hits, "hits");
    for (const ClosestHit& hit : worldOf(world).closestPoints(queries)) *hits++ = toC(hit);
  });
}

rb_status rb_world_cast_rays_all(rb_world* world, const rb_ray* rays, int64_t count, const int64_t** offsets,
                                 const rb_hit** hits) {
  return guarded(
      [&] { keep(world, worldOf(world).castRaysAll(mapped(rays, count, queryOf)), offsets, hits); });
}

rb_status rb_world_cast_shapes_all(rb_world* world, const rb_cast* casts, int64_t count,
                                   const int64_t** offsets, const rb_hit** hits) {
  return guarded(
      [&] { keep(world, worldOf(world).castShapesAll(mapped(casts, count, castOf)), offsets, hits); });
}

rb_status rb_world_overlaps_all(rb_world* world, const rb_overlap* shapes, int64_t count,
                                const int64_t** offsets, const rb_hit** hits) {
  return guarded(
      [&] { keep(world, worldOf(world).overlapsAll(mapped(shapes, count, overlapOf)), offsets, hits); });
}
}

#include <rubble/c/world.h>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

extern "C" {

rb_status rb_world_cast_rays(rb_world* world, const rb_ray* rays, int64_t count, rb_ray_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(rays, count, queryOf);
    if (count > 0) need(hits, "hits");
    for (const RayHit& hit : worldOf(world).castRays(queries)) *hits++ = toC(hit);
  });
}

rb_status rb_world_cast_shapes(rb_world* world, const rb_cast* casts, int64_t count, rb_cast_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(casts, count, [](const rb_cast& cast) {
      return CastQuery{need(cast.shape, "shape").shape, vec(cast.position), quat(cast.orientation),
                       vec(cast.displacement), filterOf(cast.filter)};
    });
    if (count > 0) need(hits, "hits");
    for (const CastHit& hit : worldOf(world).castShapes(queries)) {
      rb_cast_hit& out = *hits++;
      out.hit = hit.hit, out.body = idOf(hit.body), out.fraction = hit.fraction;
      store(hit.position, out.position), store(hit.normal, out.normal);
    }
  });
}

rb_status rb_world_overlaps(rb_world* world, const rb_overlap* shapes, int64_t count, const int64_t** offsets,
                            const rb_body_id** bodies) {
  return guarded([&] {
    const auto queries = mapped(shapes, count, [](const rb_overlap& query) {
      return OverlapQuery{need(query.shape, "shape").shape, vec(query.position), quat(query.orientation),
                          filterOf(query.filter)};
    });
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

rb_status rb_world_closest_points(rb_world* world, const rb_closest* points, int64_t count,
                                  rb_closest_hit* hits) {
  return guarded([&] {
    const auto queries = mapped(points, count, [](const rb_closest& query) {
      return ClosestQuery{vec(query.point), query.max_distance, filterOf(query.filter)};
    });
    if (count > 0) need(hits, "hits");
    for (const ClosestHit& hit : worldOf(world).closestPoints(queries)) {
      rb_closest_hit& out = *hits++;
      out.hit = hit.hit, out.body = idOf(hit.body), out.distance = hit.distance;
      store(hit.position, out.position);
    }
  });
}
}

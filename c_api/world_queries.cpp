#include <rubble/c/world.h>

#include "c_api/handles.h"

using namespace rubble;
using namespace rubble::c;

namespace {

double distanceOf(const RayHit& hit) { return hit.distance; }
double distanceOf(const CastHit& hit) { return hit.fraction; }
double distanceOf(const OverlapHit&) { return 0; }

/// Keeps all hits of queries in the world.
template <class Hit>
void keep(rb_world* world, const std::vector<std::vector<Hit>>& found, const int64_t** offsets,
          const rb_hit** hits) {
  world->hits.clear(), world->hitOffsets.assign(1, 0);
  for (const std::vector<Hit>& list : found) {
    for (const Hit& hit : list) {
      rb_hit& out = world->hits.emplace_back();
      out.body = idOf(hit.body), out.object = idOf(hit.object);
      out.part = hit.part, out.triangle = hit.triangle, out.user_data = hit.userData;
      out.distance = distanceOf(hit);
      if constexpr (requires { hit.position; })
        store(hit.position, out.position), store(hit.normal, out.normal);
    }
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
template <class Query> std::vector<Query> withDeformables(std::vector<Query> queries, int32_t deformables) {
  for (Query& query : queries) query.filter.deformables = deformables != 0;
  return queries;
}

}  // namespace

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
    const auto queries = mapped(casts, count, castOf);
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

rb_status rb_world_cast_rays_all(rb_world* world, const rb_ray* rays, int64_t count, int32_t deformables,
                                 const int64_t** offsets, const rb_hit** hits) {
  return guarded([&] {
    const auto queries = withDeformables(mapped(rays, count, queryOf), deformables);
    keep(world, worldOf(world).castRaysAll(queries), offsets, hits);
  });
}

rb_status rb_world_cast_shapes_all(rb_world* world, const rb_cast* casts, int64_t count, int32_t deformables,
                                   const int64_t** offsets, const rb_hit** hits) {
  return guarded([&] {
    const auto queries = withDeformables(mapped(casts, count, castOf), deformables);
    keep(world, worldOf(world).castShapesAll(queries), offsets, hits);
  });
}

rb_status rb_world_overlaps_all(rb_world* world, const rb_overlap* shapes, int64_t count, int32_t deformables,
                                const int64_t** offsets, const rb_hit** hits) {
  return guarded([&] {
    const auto queries = withDeformables(mapped(shapes, count, overlapOf), deformables);
    keep(world, worldOf(world).overlapsAll(queries), offsets, hits);
  });
}
}

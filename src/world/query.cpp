/// Queries: validation, translation of ids to slots, and back.
#include <algorithm>
#include <atomic>
#include <cmath>

#include <rubble/world.h>

#include "cook/checks.h"
#include "cook/cook.h"
#include "platform/threads.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

std::string at(const char* list, std::size_t i, const char* field) {
  return std::string(list) + "[" + std::to_string(i) + "]." + field;
}

/// A body to ignore that is not alive, or that another one has followed in its slot, is none.
EngineQuery filtered(const QueryFilter& filter, const Registry& registry) {
  EngineQuery q;
  q.layers = filter.layers, q.mask = filter.mask;
  q.sensors = filter.sensors;
  q.ignore = registry.bodies.alive(filter.ignore) ? filter.ignore.index : -1;
  return q;
}

/// Authored index of a triangle in the tables.
int authoredTriangle(const Registry& registry, const Shape& shape, int triangle) {
  if (triangle < 0 || shape.type != ShapeType::Mesh) return triangle;
  const CookedEntry* const entry = findCooked(registry.shapes, shape);
  return entry->cooked->triangleOrder[static_cast<std::size_t>(triangle)];
}

/// The part of a hit that all kinds have.
template <class Hit> Hit hitOf(const Registry& registry, const EngineHit& found) {
  Hit hit;
  if (found.body < 0) return hit;
  hit.hit = true;
  hit.body = *registry.bodies.at(found.body);
  hit.position = found.position;
  hit.part = found.part;
  hit.userData = registry.bodies[hit.body].def.userData;
  return hit;
}

/// f(i) for all i < n, in parallel if that pays.
template <class F> void forEachIndex(std::size_t n, F&& f) {
  constexpr std::size_t kGrain = 2048;
  forEachRange(n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

/// Cooked query shapes. Geometry shared with bodies of the world or other queries of the batch is cooked
/// once.
class QueryShapeList {
 public:
  explicit QueryShapeList(const Registry& registry) : registry_(registry) {}

  template <class Query> EngineQuery query(const Query& query, const char* list, std::size_t i) {
    const ShapeType type = query.shape.type;
    if (type == ShapeType::Plane || type == ShapeType::Mesh || type == ShapeType::HeightField ||
        type == ShapeType::DistanceField)
      throw Error(at(list, i, "shape"), "a convex solid or a compound",
                  type == ShapeType::Plane ? "a plane" : "another shape");
    BodyDef probe;
    probe.shape = query.shape;
    probe.position = query.position, probe.orientation = query.orientation;
    validate(probe, Path(list)[i]);
    EngineQuery q = filtered(query.filter, registry_);
    q.shape = place(query.shape, at(list, i, "shape"));
    const MassProperties& unit = cooked_[static_cast<std::size_t>(q.shape)]->unit;
    const BodyState state = ShapeFrame{unit.center, unit.axes}.toEngine(
        {query.position, normalize(query.orientation), {}, {}});
    q.position = state.position, q.orientation = state.orientation;
    return q;
  }

  std::span<const std::shared_ptr<const CookedShape>> cooked() const { return cooked_; }

 private:
  /// Place of the cooked shape in the list.
  int place(const Shape& shape, const Path& path) {
    std::shared_ptr<const CookedShape> cooked;
    if (shape.geometry) {
      if (const CookedEntry* own = findCooked(entries_, shape)) return own->indexBase;
      if (const CookedEntry* entry = findCooked(registry_.shapes, shape)) cooked = entry->cooked;
    }
    if (!cooked) cooked = std::make_shared<const CookedShape>(cook(shape, path));
    const int place = static_cast<int>(cooked_.size());
    cooked_.push_back(cooked);
    if (shape.geometry) entries_.push_back({shape, cooked, place});
    return place;
  }

  const Registry& registry_;
  std::vector<std::shared_ptr<const CookedShape>> cooked_;
  std::vector<CookedEntry> entries_;  ///< shapes with geometry, and their places
};

}  // namespace

void checkRay(const RayQuery& ray, std::size_t i) {
  checks::finite(ray.origin, at("rays", i, "origin"));
  checks::finite(ray.direction, at("rays", i, "direction"));
  if (!(length(ray.direction) > 0))
    throw Error(at("rays", i, "direction"), "a direction", "a vector of length 0");
  checks::positive(ray.maxDistance, at("rays", i, "maxDistance"));
}

EngineQuery queryOf(const RayQuery& ray, const Registry& registry) {
  EngineQuery q = filtered(ray.filter, registry);
  q.position = ray.origin;
  q.move = ray.direction * (ray.maxDistance / length(ray.direction));
  return q;
}

RayHit hitOf(const EngineHit& found, const RayQuery& ray, const Registry& registry) {
  RayHit hit = hitOf<RayHit>(registry, found);
  if (!hit.hit) return hit;
  hit.distance = found.fraction * ray.maxDistance, hit.normal = found.normal;
  hit.triangle = authoredTriangle(registry, registry.bodies[hit.body].def.shape, found.triangle);
  return hit;
}

std::vector<RayHit> World::castRays(std::span<const RayQuery> rays) {
  return withMemory("castRays", [&] {
    std::vector<RayHit> hits(rays.size());
    castRays(rays, hits);
    return hits;
  });
}

void World::castRays(std::span<const RayQuery> rays, std::span<RayHit> hits) {
  withMemory("castRays", [&] {
    if (hits.size() != rays.size())
      throw Error("hits", "one hit per ray, " + std::to_string(rays.size()), std::to_string(hits.size()));
    const auto isValid = [](const RayQuery& ray) {
      return checks::isFinite(ray.origin) && checks::isFinite(ray.direction) && length(ray.direction) > 0 &&
             ray.maxDistance > 0 && checks::isFinite(Vec3{ray.maxDistance, 0, 0});
    };
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(rays.size());
    std::atomic<bool> valid = true;
    forEachIndex(rays.size(), [&](std::size_t i) {
      const RayQuery& ray = rays[i];
      if (!isValid(ray)) valid = false;
      queries[i] = queryOf(ray, impl_->registry);
    });
    if (!valid)
      for (std::size_t i = 0; i < rays.size(); ++i) checkRay(rays[i], i);
    const std::span<const EngineHit> found = impl_->engine->hits({QueryKind::Ray, queries, {}});
    forEachIndex(rays.size(), [&](std::size_t i) { hits[i] = hitOf(found[i], rays[i], impl_->registry); });
  });
}

RayHit World::castRay(const RayQuery& ray) {
  RayHit hit;
  castRays({&ray, 1}, {&hit, 1});
  return hit;
}

std::vector<CastHit> World::castShapes(std::span<const CastQuery> casts) {
  return withMemory("castShapes", [&] {
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(casts.size());
    QueryShapeList shapes(impl_->registry);
    for (std::size_t i = 0; i < casts.size(); ++i) {
      queries[i] = shapes.query(casts[i], "casts", i);
      checks::finite(casts[i].displacement, at("casts", i, "displacement"));
      queries[i].move = casts[i].displacement;
    }
    std::vector<CastHit> out;
    for (const EngineHit& hit : impl_->engine->hits({QueryKind::Cast, queries, shapes.cooked()})) {
      out.push_back(hitOf<CastHit>(impl_->registry, hit));
      if (hit.body >= 0) out.back().fraction = hit.fraction, out.back().normal = hit.normal;
    }
    return out;
  });
}

std::vector<std::vector<BodyId>> World::overlaps(std::span<const OverlapQuery> shapes) {
  return withMemory("overlaps", [&] {
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(shapes.size());
    QueryShapeList list(impl_->registry);
    for (std::size_t i = 0; i < shapes.size(); ++i) queries[i] = list.query(shapes[i], "shapes", i);
    const EngineOverlaps found = impl_->engine->overlaps({QueryKind::Overlap, queries, list.cooked()});
    std::vector<std::vector<BodyId>> out(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i)
      for (int k = found.offsets[i]; k < found.offsets[i + 1]; ++k)
        out[i].push_back(*impl_->registry.bodies.at(found.bodies[static_cast<std::size_t>(k)]));
    return out;
  });
}

std::vector<ClosestHit> World::closestPoints(std::span<const ClosestQuery> points) {
  return withMemory("closestPoints", [&] {
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      checks::finite(points[i].point, at("points", i, "point"));
      checks::positive(points[i].maxDistance, at("points", i, "maxDistance"));
      queries[i] = filtered(points[i].filter, impl_->registry);
      queries[i].position = points[i].point;
      queries[i].reach = points[i].maxDistance;
    }
    std::vector<ClosestHit> out;
    for (const EngineHit& hit : impl_->engine->hits({QueryKind::Closest, queries, {}})) {
      out.push_back(hitOf<ClosestHit>(impl_->registry, hit));
      if (hit.body >= 0) out.back().distance = hit.fraction;
    }
    return out;
  });
}

}  // namespace rubble

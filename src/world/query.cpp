/// Queries: validation, translation of ids to slots, and back.
#include <algorithm>
#include <atomic>
#include <cmath>

#include <tbb/parallel_for.h>

#include <rubble/world.h>

#include "cook/checks.h"
#include "cook/cook.h"
#include "world/world_impl.h"

namespace rubble {

namespace {

std::string at(const char* list, std::size_t i, const char* field) {
  return std::string(list) + "[" + std::to_string(i) + "]." + field;
}

/// A body to ignore that is not alive, or that another one has followed in its slot, is none.
EngineQuery filtered(EngineQuery::Kind kind, const QueryFilter& filter, const Registry& registry) {
  EngineQuery q;
  q.kind = kind;
  q.layers = filter.layers, q.mask = filter.mask;
  q.sensors = filter.sensors;
  q.ignore = registry.bodies.alive(filter.ignore) ? filter.ignore.index : -1;
  return q;
}

/// Throws the Error of an invalid ray.
void checkRay(const RayQuery& ray, std::size_t i) {
  checks::finite(ray.origin, at("rays", i, "origin"));
  checks::finite(ray.direction, at("rays", i, "direction"));
  if (!(length(ray.direction) > 0))
    throw Error(at("rays", i, "direction"), "a direction", "a vector of length 0");
  checks::positive(ray.maxDistance, at("rays", i, "maxDistance"));
}

/// f(i) for all i < n, in parallel if that pays.
template <class F> void forEachIndex(std::size_t n, F&& f) {
  constexpr std::size_t kGrain = 2048;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) f(i);
  });
}

/// Cooked query shapes. Geometry shared with bodies of the world or other queries of the batch is cooked
/// once.
class QueryShapes {
 public:
  explicit QueryShapes(const Registry& registry) : registry_(registry) {}

  template <class Query>
  EngineQuery query(EngineQuery::Kind kind, const Query& query, const char* list, std::size_t i) {
    const ShapeType type = query.shape.type;
    if (type == ShapeType::Plane || type == ShapeType::Mesh || type == ShapeType::HeightField ||
        type == ShapeType::DistanceField)
      throw Error(at(list, i, "shape"), "a convex solid or a compound",
                  type == ShapeType::Plane ? "a plane" : "another shape");
    BodyDef probe;
    probe.shape = query.shape;
    probe.position = query.position, probe.orientation = query.orientation;
    validate(probe, Path(list)[i]);
    EngineQuery q = filtered(kind, query.filter, registry_);
    q.shape = cooked(query.shape, at(list, i, "shape"));
    const BodyState state = ShapeFrame{q.shape->unit.center, q.shape->unit.axes}.toEngine(
        {query.position, normalize(query.orientation), {}, {}});
    q.position = state.position, q.orientation = state.orientation;
    return q;
  }

 private:
  std::shared_ptr<const CookedShape> cooked(const Shape& shape, const Path& path) {
    if (!shape.geometry) return std::make_shared<const CookedShape>(cook(shape, path));
    for (const std::span<const CookedEntry> entries :
         {std::span(registry_.shapes), std::span<const CookedEntry>(own_)})
      if (const CookedEntry* entry = findCooked(entries, shape)) return entry->cooked;
    own_.push_back({shape, std::make_shared<const CookedShape>(cook(shape, path)), 0});
    return own_.back().cooked;
  }

  const Registry& registry_;
  std::vector<CookedEntry> own_;
};

}  // namespace

std::vector<RayHit> World::castRays(std::span<const RayQuery> rays) {
  return withMemory("castRays", [&] {
    const auto isValid = [](const RayQuery& ray) {
      return checks::isFinite(ray.origin) && checks::isFinite(ray.direction) && length(ray.direction) > 0 &&
             ray.maxDistance > 0 && checks::isFinite(Vec3{ray.maxDistance, 0, 0});
    };
    std::vector<EngineQuery> queries(rays.size());
    std::atomic<bool> valid = true;
    forEachIndex(rays.size(), [&](std::size_t i) {
      const RayQuery& ray = rays[i];
      if (!isValid(ray)) valid = false;
      queries[i] = filtered(EngineQuery::Ray, ray.filter, impl_->registry);
      queries[i].position = ray.origin;
      queries[i].move = ray.direction * (ray.maxDistance / length(ray.direction));
    });
    if (!valid)
      for (std::size_t i = 0; i < rays.size(); ++i) checkRay(rays[i], i);
    impl_->flush();
    const std::vector<EngineHit> hits = impl_->engine->query(queries);
    std::vector<RayHit> out(rays.size());
    forEachIndex(rays.size(), [&](std::size_t i) {
      const EngineHit& hit = hits[i];
      if (hit.body >= 0)
        out[i] = {true, *impl_->registry.bodies.at(hit.body), hit.fraction * rays[i].maxDistance,
                  hit.position, hit.normal};
    });
    return out;
  });
}

std::vector<CastHit> World::castShapes(std::span<const CastQuery> casts) {
  return withMemory("castShapes", [&] {
    std::vector<EngineQuery> queries;
    QueryShapes shapesOf(impl_->registry);
    for (std::size_t i = 0; i < casts.size(); ++i) {
      queries.push_back(shapesOf.query(EngineQuery::Cast, casts[i], "casts", i));
      checks::finite(casts[i].displacement, at("casts", i, "displacement"));
      queries.back().move = casts[i].displacement;
    }
    impl_->flush();
    std::vector<CastHit> out;
    for (const EngineHit& hit : impl_->engine->query(queries)) {
      if (hit.body < 0)
        out.push_back({});
      else
        out.push_back({true, *impl_->registry.bodies.at(hit.body), hit.fraction, hit.position, hit.normal});
    }
    return out;
  });
}

std::vector<std::vector<BodyId>> World::overlaps(std::span<const OverlapQuery> shapes) {
  return withMemory("overlaps", [&] {
    std::vector<EngineQuery> queries;
    QueryShapes shapesOf(impl_->registry);
    for (std::size_t i = 0; i < shapes.size(); ++i)
      queries.push_back(shapesOf.query(EngineQuery::Overlap, shapes[i], "shapes", i));
    impl_->flush();
    std::vector<std::vector<BodyId>> out;
    for (const std::vector<int>& slots : impl_->engine->overlaps(queries)) {
      out.emplace_back();
      for (const int slot : slots) out.back().push_back(*impl_->registry.bodies.at(slot));
    }
    return out;
  });
}

std::vector<ClosestHit> World::closestPoints(std::span<const ClosestQuery> points) {
  return withMemory("closestPoints", [&] {
    std::vector<EngineQuery> queries;
    for (std::size_t i = 0; i < points.size(); ++i) {
      checks::finite(points[i].point, at("points", i, "point"));
      checks::positive(points[i].maxDistance, at("points", i, "maxDistance"));
      EngineQuery q = filtered(EngineQuery::Closest, points[i].filter, impl_->registry);
      q.position = points[i].point;
      q.reach = points[i].maxDistance;
      queries.push_back(q);
    }
    impl_->flush();
    std::vector<ClosestHit> out;
    for (const EngineHit& hit : impl_->engine->query(queries)) {
      if (hit.body < 0)
        out.push_back({});
      else
        out.push_back({true, *impl_->registry.bodies.at(hit.body), hit.fraction, hit.position});
    }
    return out;
  });
}

}  // namespace rubble

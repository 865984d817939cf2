/// Queries: validation, translation of ids to slots, and back.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

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
  q.deformables = filter.deformables && (filter.mask & CollisionFilter{}.layers) != 0 && filter.layers != 0;
  q.ignore = registry.bodies.alive(filter.ignore) ? filter.ignore.index : -1;
  return q;
}

/// Authored index of a triangle in the tables.
int authoredTriangle(const Registry& registry, BodyId body, int triangle) {
  const ShapeRecord& record = registry.shapes[registry.bodies[body].shape];
  if (triangle < 0 || record.shape.type != ShapeType::Mesh) return triangle;
  return record.cooked->triangleOrder[static_cast<std::size_t>(triangle)];
}

/// The part of a hit that all kinds have.
template <class Hit> Hit hitOf(const Registry& registry, const EngineHit& found) {
  Hit hit;
  if (found.body < 0) return hit;
  if constexpr (requires { hit.hit; }) hit.hit = true, hit.position = found.position;
  hit.body = *registry.bodies.at(found.body);
  hit.part = found.part;
  const BodyDef& def = registry.bodies[hit.body].def;
  hit.userData = def.userData, hit.shapeUserData = partUserData(def.shape, hit.part);
  return hit;
}

/// f(i) for all i < n, in parallel if that pays.
template <class F> void forEachIndex(const TaskSystem& tasks, std::size_t n, F&& f) {
  constexpr std::size_t kGrain = 2048;
  withTasks(tasks, [&] {
    forEachRange(n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) f(i);
    });
  });
}

/// The part of a hit on a deformable object that all kinds have.
template <class Hit> Hit objectHitOf(const Registry& registry, const EngineHit& found) {
  Hit hit;
  hit.object = *registry.softs.at(found.body);
  hit.triangle = found.triangle;
  hit.userData = common(registry.softs[hit.object].def).userData;
  if constexpr (requires { hit.hit; }) hit.hit = true, hit.position = found.position;
  return hit;
}

void setFraction(RayHit& hit, const EngineHit& found, const RayQuery& ray) {
  hit.distance = found.fraction * ray.maxDistance, hit.normal = found.normal;
}
void setFraction(CastHit& hit, const EngineHit& found, const CastQuery&) {
  hit.fraction = found.fraction, hit.normal = found.normal;
}
void setFraction(OverlapHit&, const EngineHit&, const OverlapQuery&) {}
void setFraction(ClosestHit& hit, const EngineHit& found, const ClosestQuery&) {
  hit.distance = found.fraction;
}

/// Geometry of few triangles, in the most precise core that is built.
#if defined(RUBBLE_HAS_REFERENCE)
namespace precise = f64;
#else
namespace precise = f32;
#endif

/// Hits of the queries on deformable objects; empty if none asks for them.
template <class World, class Query>
std::vector<std::vector<EngineHit>> objectHits(World& world, const EngineQueries& asked,
                                               std::span<const Query> queries) {
  if (std::ranges::none_of(asked.queries, [](const EngineQuery& q) { return q.deformables != 0; })) return {};
  auto lists = precise::softHits(asked, world.softTargets());
  for (std::size_t i = 0; i < lists.size(); ++i)
    if (const DeformableId skipped = queries[i].filter.ignoreObject; world.registry.softs.alive(skipped))
      std::erase_if(lists[i], [&](const EngineHit& hit) { return hit.body == skipped.index; });
  return lists;
}

/// Replaces first hits by those on deformable objects that come before.
template <class World, class Hit, class Query>
void mergeFirst(World& world, const EngineQueries& asked, std::span<const EngineHit> bodies,
                std::span<const Query> queries, std::span<Hit> hits) {
  const auto lists = objectHits(world, asked, queries);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    if (lists[i].empty()) continue;
    const EngineHit& found = lists[i].front();
    if (bodies[i].body >= 0 && bodies[i].fraction <= found.fraction) continue;
    hits[i] = objectHitOf<Hit>(world.registry, found);
    setFraction(hits[i], found, queries[i]);
  }
}

/// All hits, of bodies and objects. `bodyHit(hit, i)`: a hit of query i on a body.
template <class Hit, class World, class Query, class BodyHit>
std::vector<std::vector<Hit>> mergeAll(World& world, const EngineQueries& asked,
                                       std::span<const Query> queries, BodyHit&& bodyHit) {
  const auto lists = objectHits(world, asked, queries);
  const EngineAllHits found = world.engine->allHits(asked);
  std::vector<std::vector<Hit>> out(queries.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto objects = lists.empty() ? std::span<const EngineHit>() : std::span(lists[i]);
    auto object = objects.begin();
    const auto addObjects = [&](double below) {
      for (; object != objects.end() && object->fraction < below; ++object) {
        out[i].push_back(objectHitOf<Hit>(world.registry, *object));
        setFraction(out[i].back(), *object, queries[i]);
      }
    };
    for (int k = found.offsets[i]; k < found.offsets[i + 1]; ++k) {
      const EngineHit& hit = found.hits[static_cast<std::size_t>(k)];
      addObjects(hit.fraction);
      out[i].push_back(bodyHit(hit, i));
    }
    addObjects(std::numeric_limits<double>::infinity());
  }
  return out;
}

/// Cooked query shapes. Geometry shared with bodies of the world or other queries of the batch is cooked
/// once.
class QueryShapeList {
 public:
  QueryShapeList(const Registry& registry, CookedShapes& shapes) : registry_(registry), shapes_(shapes) {}

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
    const int next = static_cast<int>(cooked_.size());
    if (!shape.geometry) {
      cooked_.push_back(std::make_shared<const CookedShape>(cook(shape, path)));
      return next;
    }
    auto cooked = shapes_.get(shape, path);
    const auto [place, isNew] = places_.try_emplace(cooked.get(), next);
    if (isNew) cooked_.push_back(std::move(cooked));
    return place->second;
  }

  const Registry& registry_;
  CookedShapes& shapes_;
  std::vector<std::shared_ptr<const CookedShape>> cooked_;
  std::unordered_map<const CookedShape*, int> places_;  ///< in the list
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
  hit.triangle = authoredTriangle(registry, hit.body, found.triangle);
  return hit;
}

namespace {

/// Checks and translates rays.
template <class World>
void translate(World& world, std::span<const RayQuery> rays, std::span<EngineQuery> queries) {
  const auto isValid = [](const RayQuery& ray) {
    return checks::isFinite(ray.origin) && checks::isFinite(ray.direction) && length(ray.direction) > 0 &&
           ray.maxDistance > 0 && checks::isFinite(Vec3{ray.maxDistance, 0, 0});
  };
  std::atomic<bool> valid = true;
  forEachIndex(world.tasks, rays.size(), [&](std::size_t i) {
    if (!isValid(rays[i])) valid = false;
    queries[i] = queryOf(rays[i], world.registry);
  });
  if (!valid)
    for (std::size_t i = 0; i < rays.size(); ++i) checkRay(rays[i], i);
}
void translate(std::span<const CastQuery> casts, QueryShapeList& shapes, std::span<EngineQuery> queries) {
  for (std::size_t i = 0; i < casts.size(); ++i) {
    queries[i] = shapes.query(casts[i], "casts", i);
    checks::finite(casts[i].displacement, at("casts", i, "displacement"));
    queries[i].move = casts[i].displacement;
  }
}
CastHit castHitOf(const Registry& registry, const EngineHit& found) {
  CastHit hit = hitOf<CastHit>(registry, found);
  if (!hit.hit) return hit;
  hit.fraction = found.fraction, hit.normal = found.normal;
  hit.triangle = authoredTriangle(registry, hit.body, found.triangle);
  return hit;
}

}  // namespace

void World::Impl::addObjectHits(std::span<EngineQuery> queries, std::span<const EngineHit> bodies,
                                std::span<const RayQuery> rays, std::span<RayHit> hits) {
  mergeFirst(*this, {QueryKind::Ray, queries, {}}, bodies, rays, hits);
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
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(rays.size());
    translate(*impl_, rays, queries);
    const std::span<const EngineHit> found = impl_->engine->hits({QueryKind::Ray, queries, {}});
    forEachIndex(impl_->tasks, rays.size(),
                 [&](std::size_t i) { hits[i] = hitOf(found[i], rays[i], impl_->registry); });
    impl_->addObjectHits(queries, found, rays, hits);
  });
}

RayHit World::castRay(const RayQuery& ray) {
  RayHit hit;
  castRays({&ray, 1}, {&hit, 1});
  return hit;
}

std::vector<RayHit> World::castRayAll(const RayQuery& ray) {
  return std::move(castRaysAll({&ray, 1}).front());
}
CastHit World::castShape(const CastQuery& cast) { return castShapes({&cast, 1}).front(); }
std::vector<BodyId> World::overlap(const OverlapQuery& shape) {
  return std::move(overlaps({&shape, 1}).front());
}
ClosestHit World::closestPoint(const ClosestQuery& point) { return closestPoints({&point, 1}).front(); }

std::vector<CastHit> World::castShapes(std::span<const CastQuery> casts) {
  return withMemory("castShapes", [&] {
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(casts.size());
    QueryShapeList shapes(impl_->registry, *impl_->cooked);
    translate(casts, shapes, queries);
    const EngineQueries asked{QueryKind::Cast, queries, shapes.cooked()};
    const std::span<const EngineHit> found = impl_->engine->hits(asked);
    std::vector<CastHit> out;
    for (const EngineHit& hit : found) out.push_back(castHitOf(impl_->registry, hit));
    mergeFirst(*impl_, asked, found, casts, std::span(out));
    return out;
  });
}

std::vector<std::vector<BodyId>> World::overlaps(std::span<const OverlapQuery> shapes) {
  return withMemory("overlaps", [&] {
    impl_->flush();
    const std::span<EngineQuery> queries = impl_->engine->queryRoom(shapes.size());
    QueryShapeList list(impl_->registry, *impl_->cooked);
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
    const EngineQueries asked{QueryKind::Closest, queries, {}};
    const std::span<const EngineHit> found = impl_->engine->hits(asked);
    std::vector<ClosestHit> out;
    for (const EngineHit& hit : found) {
      out.push_back(hitOf<ClosestHit>(impl_->registry, hit));
      if (hit.body >= 0) out.back().distance = hit.fraction;
    }
    mergeFirst(*impl_, asked, found, points, std::span(out));
    return out;
  });
}

std::vector<std::vector<RayHit>> World::castRaysAll(std::span<const RayQuery> rays) {
  return withMemory("castRaysAll", [&] {
    impl_->flush();
    std::vector<EngineQuery> queries(rays.size());
    translate(*impl_, rays, queries);
    return mergeAll<RayHit>(
        *impl_, {QueryKind::Ray, queries, {}}, rays,
        [&](const EngineHit& hit, std::size_t i) { return hitOf(hit, rays[i], impl_->registry); });
  });
}

std::vector<std::vector<CastHit>> World::castShapesAll(std::span<const CastQuery> casts) {
  return withMemory("castShapesAll", [&] {
    impl_->flush();
    std::vector<EngineQuery> queries(casts.size());
    QueryShapeList shapes(impl_->registry, *impl_->cooked);
    translate(casts, shapes, queries);
    return mergeAll<CastHit>(
        *impl_, {QueryKind::Cast, queries, shapes.cooked()}, casts,
        [&](const EngineHit& hit, std::size_t) { return castHitOf(impl_->registry, hit); });
  });
}

std::vector<std::vector<OverlapHit>> World::overlapsAll(std::span<const OverlapQuery> shapes) {
  return withMemory("overlapsAll", [&] {
    impl_->flush();
    std::vector<EngineQuery> queries(shapes.size());
    QueryShapeList list(impl_->registry, *impl_->cooked);
    for (std::size_t i = 0; i < shapes.size(); ++i) queries[i] = list.query(shapes[i], "shapes", i);
    return mergeAll<OverlapHit>(
        *impl_, {QueryKind::Overlap, queries, list.cooked()}, shapes,
        [&](const EngineHit& hit, std::size_t) { return hitOf<OverlapHit>(impl_->registry, hit); });
  });
}

}  // namespace rubble

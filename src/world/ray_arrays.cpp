/// Rays that are arrays: checks, and rays in host memory.
#include <algorithm>
#include <string_view>

#include "cook/checks.h"
#include "world/worlds_impl.h"

namespace rubble {

namespace {

std::string sizeText(const ArrayView& view) {
  return "(" + std::to_string(view.shape[0]) + ", " + std::to_string(view.shape[1]) + ")";
}

/// Throws Error unless these are n rows of `numbers` numbers. `where`: the array whose memory they must
/// share.
void checkRayRows(const ArrayView& view, const char* path, std::int64_t n, std::int64_t numbers,
                  const ArrayView& where) {
  const std::string name(path);
  if (view.shape[0] != n || view.shape[1] != numbers)
    throw Error(name + ".shape", "(" + std::to_string(n) + ", " + std::to_string(numbers) + ")",
                sizeText(view));
  const std::string_view type = view.typestr;
  if (numbers == 1 ? type != "<i4" : type != "<f4" && type != "<f8")
    throw Error(name + ".typestr", numbers == 1 ? "<i4" : "<f4 or <f8", view.typestr);
  if (n == 0) return;
  if (!view.data) throw Error(path, "memory", "none");
  if (view.device != where.device)
    throw Error(path, where.device ? "memory of the device" : "host memory", "the other one");
}

/// Throws Error unless an engine can take them. `arrays`: null unless it has a device.
void checkRayArrays(const RayArrays& rays, const ArrayView& worlds, const DeviceArrays* arrays) {
  // a warp for each ray, numbered in 32 bits
  constexpr std::int64_t kMost = 1 << 26;
  const std::int64_t n = rays.origins.shape[0];
  if (n < 0 || n > kMost)
    throw Error("origins", "at most " + std::to_string(kMost) + " rays", sizeText(rays.origins));
  checkRayRows(rays.origins, "origins", n, 3, rays.origins);
  checkRayRows(rays.directions, "directions", n, 3, rays.origins);
  if (worlds.shape[0] > 0) checkRayRows(worlds, "worlds", n, 1, rays.origins);
  if (rays.origins.device && !arrays) throw Error("origins", "host memory", "memory of a device");
  checks::positive(rays.maxDistance, "maxDistance");
  if (rays.filter.deformables)
    throw Error("filter.deformables", "false, since arrays name bodies alone", "true");
}

/// The part of a query that all rays have in common, but for the body to skip.
EngineQuery queryFor(const QueryFilter& filter) {
  EngineQuery q;
  q.layers = filter.layers, q.mask = filter.mask, q.sensors = filter.sensors;
  return q;
}

RayQuery rayAt(const RayArrays& rays, const NumberRows& origins, const NumberRows& directions,
               std::int64_t k) {
  return {origins.vector(k), directions.vector(k), rays.maxDistance, rays.filter};
}

RayHitWriter rayHitWriter(HostRayHits& hits, std::size_t n) {
  hits.distances.resize(n), hits.bodies.resize(n), hits.normals.resize(3 * n);
  return {hits.distances.data(), hits.bodies.data(), hits.normals.data()};
}

RayHitArrays rayHitsOf(std::span<const RayHit> found, double maxDistance, HostRayHits& hits) {
  const RayHitWriter to = rayHitWriter(hits, found.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    to(static_cast<std::int64_t>(k), found[k].hit, found[k].hit ? found[k].distance : maxDistance,
       found[k].body.index, found[k].normal);
  return hitArrays(to, std::ssize(found));
}

}  // namespace

RayHitArrays World::castRayArrays(const RayArrays& rays) {
  return withMemory("castRayArrays", [&] {
    checkRayArrays(rays, {}, impl_->engine->deviceArrays());
    const std::int64_t n = rays.origins.shape[0];
    if (rays.origins.device) {
      impl_->flush();
      EngineRays asked{rays.origins, rays.directions, rays.maxDistance, queryFor(rays.filter)};
      asked.raysPerWorld = std::max<std::int64_t>(1, n);
      const BodyId ignored = rays.filter.ignore;
      if (impl_->registry.bodies.alive(ignored)) asked.common.ignore = ignored.index;
      return impl_->engine->castRays(asked);
    }
    const NumberRows origins(rays.origins), directions(rays.directions);
    std::vector<RayQuery> queries;
    for (std::int64_t k = 0; k < n; ++k) queries.push_back(rayAt(rays, origins, directions, k));
    return rayHitsOf(castRays(queries), rays.maxDistance, impl_->rayHits);
  });
}

RayHitArrays Worlds::castRayArrays(const RayArrays& rays, const ArrayView& worlds) {
  return withMemory("castRayArrays", [&] {
    DeviceArrays* const arrays = impl_->batches.empty() ? nullptr
                                                        : impl_->batches[0]->engine().deviceArrays();
    checkRayArrays(rays, worlds, arrays);
    const std::int64_t n = rays.origins.shape[0], count = impl_->count();
    const bool isEven = worlds.shape[0] == 0;
    if (isEven && (count == 0 ? n > 0 : n % count != 0))
      throw Error("origins.shape", "as many rays for each of " + std::to_string(count) + " worlds",
                  sizeText(rays.origins));
    const std::int64_t raysPerWorld = isEven && count > 0 ? std::max<std::int64_t>(1, n / count) : 1;
    if (rays.origins.device) {
      impl_->flush(0);
      EngineRays asked{rays.origins, rays.directions, rays.maxDistance, queryFor(rays.filter)};
      asked.common.ignore = rays.filter.ignore.index;
      asked.worlds = worlds, asked.raysPerWorld = raysPerWorld;
      asked.worldCount = static_cast<int>(count);
      return impl_->batches[0]->engine().castRays(asked);
    }
    const NumberRows origins(rays.origins), directions(rays.directions);
    const auto worldOf = [&](std::int64_t k) {
      if (isEven) return static_cast<int>(k / raysPerWorld);
      return *reinterpret_cast<const int*>(static_cast<const char*>(worlds.data) + k * worlds.strides[0]);
    };
    std::vector<WorldRay> asked;
    for (std::int64_t k = 0; k < n; ++k) {
      WorldRay ray{worldOf(k), rayAt(rays, origins, directions, k)};
      impl_->requireWorld(ray.world);
      ray.ray.filter
          .ignore = impl_->at(ray.world).registry.bodies.at(rays.filter.ignore.index).value_or(BodyId{});
      asked.push_back(ray);
    }
    return rayHitsOf(castRays(asked), rays.maxDistance, impl_->rayHits);
  });
}

}  // namespace rubble

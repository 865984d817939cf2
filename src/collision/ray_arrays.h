#pragma once
/// Rays and their hits in arrays, on a host or a device. Independent of the solver precision.
#include <limits>

#include <rubble/query.h>

#include "collision/query_record.h"
#include "math/hd.h"

namespace rubble {

/// Rows of numbers "<f4" or "<f8".
struct NumberRows {
  const char* data;
  std::int64_t rowStride, numberStride;  ///< [bytes]
  bool isDouble;

  explicit NumberRows(const ArrayView& view)
      : data(static_cast<const char*>(view.data)),
        rowStride(view.strides[0]),
        numberStride(view.strides[1]),
        isDouble(view.typestr[2] == '8') {}

  RUBBLE_HD double at(std::int64_t row, int column) const {
    const char* const number = data + row * rowStride + column * numberStride;
    return isDouble ? *reinterpret_cast<const double*>(number)
                    : static_cast<double>(*reinterpret_cast<const float*>(number));
  }
  RUBBLE_HD Vec3 vector(std::int64_t row) const { return {at(row, 0), at(row, 1), at(row, 2)}; }
};

/// Rays as World::castRayArrays and Worlds::castRayArrays give them to an engine on a device.
struct EngineRays {
  ArrayView origins, directions;
  double maxDistance;  ///< [m]
  EngineQuery common;  ///< what all rays have in common: the filter
  /// World of each ray, from 0 on. Without rows: `raysPerWorld` in each, world after world.
  ArrayView worlds = {};
  std::int64_t raysPerWorld = 1;
  int firstWorld = 0;  ///< of the engine: world 0 of the rays
  int worldCount = 1;
};

/// The query of ray k. Its `reach` is the largest distance; NaN: a ray that cannot be cast and finds nothing.
struct RayReader {
  NumberRows origins, directions;
  const char* worlds;  ///< null: `raysPerWorld` of each
  std::int64_t worldStride, raysPerWorld;
  int firstWorld, worldCount;
  double maxDistance;
  EngineQuery common;

  explicit RayReader(const EngineRays& rays)
      : origins(rays.origins),
        directions(rays.directions),
        worlds(rays.worlds.shape[0] > 0 ? static_cast<const char*>(rays.worlds.data) : nullptr),
        worldStride(rays.worlds.strides[0]),
        raysPerWorld(rays.raysPerWorld),
        firstWorld(rays.firstWorld),
        worldCount(rays.worldCount),
        maxDistance(rays.maxDistance),
        common(rays.common) {}

  RUBBLE_HD EngineQuery operator()(int k) const {
    EngineQuery q = common;
    const std::int64_t world = worlds ? *reinterpret_cast<const int*>(worlds + k * worldStride)
                                      : k / raysPerWorld;
    const Vec3 origin = origins.vector(k), direction = directions.vector(k);
    const double size = length(direction);
    const bool isIn = world >= 0 && world < worldCount;
    q.world = firstWorld + (isIn ? static_cast<int>(world) : 0);
    // also false for what is not a number
    if (isIn && size > 0 && isFinite(size) && isFinite(origin.x) && isFinite(origin.y) &&
        isFinite(origin.z)) {
      q.position = origin, q.move = direction * (maxDistance / size), q.reach = maxDistance;
    } else {
      q.layers = q.mask = 0, q.reach = std::numeric_limits<double>::quiet_NaN();
    }
    return q;
  }

 private:
  RUBBLE_HD static bool isFinite(double a) { return a - a == 0; }
};

/// Writes the hit of ray k: see RayHitArrays.
struct RayHitWriter {
  float* distances;
  int* bodies;
  float* normals;

  RUBBLE_HD void operator()(std::int64_t k, bool hit, double distance, int body, const Vec3& normal) const {
    distances[k] = static_cast<float>(distance);
    bodies[k] = hit ? body : -1;
    normals[3 * k] = hit ? static_cast<float>(normal.x) : 0;
    normals[3 * k + 1] = hit ? static_cast<float>(normal.y) : 0;
    normals[3 * k + 2] = hit ? static_cast<float>(normal.z) : 0;
  }
};

/// Views of n hits in packed memory.
inline RayHitArrays hitArrays(const RayHitWriter& to, std::int64_t n) {
  return {packedArray(to.distances, n), packedArray(to.bodies, n), packedArray(to.normals, n, 3)};
}

}  // namespace rubble

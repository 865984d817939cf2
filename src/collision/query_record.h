#pragma once
/// Queries and hits as World, the tables and the kernels exchange them. Independent of the solver precision.
#include <cstdint>

#include <rubble/math.h>

namespace rubble {

enum class QueryKind : int { Ray, Cast, Overlap, Closest };

struct EngineQuery {
  Vec3 position;  ///< center of the shape; of a ray and of a closest-point query: the point [m]
  Quat orientation;
  Vec3 move;         ///< [m]
  double reach = 0;  ///< closest point: largest distance [m]
  int shape = -1;    ///< of a cast and of an overlap: its place among the shapes of the batch
  std::uint32_t layers = 0, mask = 0;
  int sensors = 0;
  int deformables = 0;  ///< 1: deformable objects are found too
  int ignore = -1;      ///< id of the body to skip, or -1
  int world = 0;        ///< of a batch: whose bodies are found. Ids are numbers in it
};

struct EngineHit {
  int body;         ///< id; -1: none
  double fraction;  ///< fraction of `move`; closest point: distance [m]
  Vec3 position, normal;
  int part = 0;       ///< of a compound
  int triangle = -1;  ///< of a ray on a surface: its place among the cooked triangles
};

}  // namespace rubble

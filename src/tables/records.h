#pragma once
/// Records of bodies, joints, queries, contacts and hits that World and the tables exchange. Independent of
/// the solver precision.
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <rubble/world.h>

#include "collision/cooked_shape.h"
#include "collision/query_record.h"
#include "forces/joint_record.h"
#include "forces/soft_model.h"

namespace rubble {

/// A body with its state, in the engine frame: origin at the center of mass, axes along the principal axes.
/// `kind`: 0 removed, 1 static, 2 kinematic, 3 dynamic.
struct EngineBody {
  int kind = 0;
  CookedData shape;   ///< `data` is an offset into the tables of the engine
  double radius = 0;  ///< of the bounding sphere about the origin [m]
  Material material;
  /// Index into the materials of setSurfaces. -1: the friction and restitution below, with Combine::Usual.
  int surface = -1;
  MassProperties mass;
  double gravityScale = 1;
  double linearDamping = 0, angularDamping = 0;
  int locks = 0;  ///< bits 0-2: locked translation along x, y, z; bits 3-5: locked rotation
  CollisionFilter filter;
  bool sensor = false;
  BodyState state;
};

struct EngineContact {
  int a, b;
  Vec3 position, normal, force;
  double depth;
};

/// Contact of a vertex with a body, or with another vertex (body -1).
struct EngineVertexContact {
  int vertex, body, otherVertex;
  Vec3 normal;  ///< toward the vertex, or toward the other vertex
  Vec3 force;   ///< on the vertex; for two vertices on the other one [N]
  double depth;
};

/// Two touching bodies, a < b.
struct EngineTouch {
  int a, b;
  bool sensor;
};

/// Queries of one kind, and the shapes that they refer to: convex solids and compounds.
struct EngineQueries {
  QueryKind kind;
  std::span<const EngineQuery> queries;
  std::span<const std::shared_ptr<const CookedShape>> shapes;
};
/// Ids of the bodies that query i overlaps: those in [offsets[i], offsets[i + 1]), ascending.
struct EngineOverlaps {
  std::span<const int> offsets, bodies;
};

struct EngineSettings {
  Params params;
  Vec3 gravity;
  bool wakeAll = false;  ///< wakes all bodies in the next step
};

}  // namespace rubble

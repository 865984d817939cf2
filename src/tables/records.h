#pragma once
/// Records of bodies, joints, queries, contacts and hits that World and the tables exchange. Independent of
/// the solver precision.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
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
  double staticFriction = Material().staticFriction, dynamicFriction = Material().dynamicFriction;
  double restitution = 0;
  /// Index into the materials of SetSurfaces. -1: the coefficients above, with Combine::Usual.
  int surface = -1;
  double mass = 0;  ///< [kg]
  Vec3 inertia;     ///< principal moments [kg m2]
  double gravityScale = 1;
  double linearDamping = 0, angularDamping = 0;
  int locks = 0;  ///< bits 0-2: locked translation along x, y, z; bits 3-5: locked rotation
  CollisionFilter filter;
  bool sensor = false;
  BodyState state;
};

/// Coefficients of contacts between materials of two kinds. A kind is 1 + the first material of its name.
struct EngineMaterialRule {
  int world = 0, low = 0, high = 0;
  int given = 0;  ///< bit k: coefficient k replaces the mixture
  /// Static and dynamic friction, restitution, rolling and torsional friction [1], [m].
  std::array<double, 5> coefficients{};

  friend bool operator==(const EngineMaterialRule&, const EngineMaterialRule&) = default;
};
/// Kind of the materials of a name, 0 if there is none or the name is empty.
inline int materialKind(std::span<const Material> materials, const std::string& name) {
  if (!name.empty())
    for (std::size_t k = 0; k < materials.size(); ++k)
      if (materials[k].name == name) return static_cast<int>(k) + 1;
  return 0;
}

struct EngineContact {
  int a, b;
  Vec3 position, normal, force;
  double depth;
  int partA, partB;  ///< of compounds
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
  std::span<EngineQuery> queries;  ///< a world of a batch adds its number
  std::span<const std::shared_ptr<const CookedShape>> shapes;
};
/// Ids of the bodies that query i overlaps: those in [offsets[i], offsets[i + 1]), ascending.
struct EngineOverlaps {
  std::span<const int> offsets, bodies;
};

/// Hits of query i are those in [offsets[i], offsets[i + 1]), ascending in fraction, body and part.
struct EngineAllHits {
  std::span<const int> offsets;
  std::span<const EngineHit> hits;
};

/// A triangle, segment or vertex of a deformable object, for queries.
struct EngineSoftPiece {
  int object;         ///< slot of its id
  int index;          ///< in the object
  int v[3];           ///< positions; -1: fewer corners
  double radius = 0;  ///< of a segment or vertex [m]
};
struct EngineSoftTargets {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<EngineSoftPiece> pieces;
};

/// What a world of a batch has of its own.
struct WorldSettings {
  Vec3 gravity;
  bool wakeAll = false;   ///< wakes all bodies in its next step
  double previousDt = 0;  ///< of its last step, 0 before the first [s]
};

/// The indices of a shape, in the numbers of a world and in the tables.
struct WorldShape {
  int base, baseInTables, size;
};

/// The elements of a world of a batch, in the order of their numbers in it.
struct WorldLayout {
  std::vector<int> bodies;  ///< ids in the tables
  SoftRange first;          ///< of its deformable objects in the tables
  SoftRange count;          ///< their vertices, elements, edges and faces
  int firstAttachment = 0, attachments = 0;
  std::vector<std::vector<int>> joints;  ///< slots by type
  std::vector<WorldShape> shapes;        ///< ascending in `base`
  std::vector<int> surfaces;             ///< indices of its materials in the tables
};

/// An axis of a joint, or a joint (axis 0).
struct EngineAxis {
  int type, slot, axis;
  std::array<int, 4> bodies;  ///< ids of A, B and their frame bodies, or kWorld
  bool operator==(const EngineAxis&) const = default;
};
/// Rows of joint arrays.
struct JointRows {
  std::vector<EngineAxis> axes, joints;
  bool operator==(const JointRows&) const = default;
};

struct EngineSettings {
  Params params;
  Vec3 gravity;
  bool wakeAll = false;  ///< wakes all bodies in the next step
};

}  // namespace rubble

#pragma once
/// Spatial queries: ray casts, shape casts, overlaps and closest points. Each call takes a batch and returns
/// results in its order. Body poses are those after the last step.
#include <cstdint>
#include <vector>

#include <rubble/arrays.h>
#include <rubble/ids.h>
#include <rubble/scene.h>

namespace rubble {

/// Selects bodies. A body is tested if `mask` contains one of its layers and its own mask contains one of
/// `layers`.
struct QueryFilter {
  std::uint32_t layers = 0xffffffffu;
  std::uint32_t mask = 0xffffffffu;
  bool sensors = false;  ///< also test sensors
  BodyId ignore;         ///< body to skip; none if it is not alive
  /// Also test deformable objects, as bodies of layer 1 that collide with all layers: the triangles of their
  /// surfaces, from both sides, segments of cables and nets, and particles.
  bool deformables = false;
  DeformableId ignoreObject = {};  ///< object to skip; none if it is not alive
};

struct RayQuery {
  Vec3 origin;               ///< [m]
  Vec3 direction{0, 0, -1};  ///< any non-zero length
  double maxDistance = 1e6;  ///< [m]
  QueryFilter filter;
};
/// First hit of a ray. A ray that starts inside a body hits it at distance 0, with the normal opposite to its
/// direction. One-sided meshes and height fields are hit from the front only.
struct RayHit {
  bool hit = false;
  BodyId body;          ///< BodyId{}: a deformable object
  double distance = 0;  ///< [m]
  Vec3 position;        ///< [m]
  Vec3 normal;          ///< outward from the body; of a sheet: against the ray
  int part = 0;         ///< of a compound: index into its parts
  /// Of a mesh: index into its triangles. Of a height field of countX samples per row: the triangles
  /// 2 (x + y (countX - 1)), which has the corner (x + 1, y), and the next one, which has (x, y + 1), belong
  /// to the cell (x, y). Otherwise -1.
  /// Of a deformable object: index into the triangles or segments of its definition, or its vertex.
  int triangle = -1;
  std::uint64_t userData = 0;       ///< BodyDef::userData, DeformableDef::userData
  std::uint64_t shapeUserData = 0;  ///< Shape::userData of the body, or of the part of a compound
  DeformableId object = {};         ///< DeformableId{}: a body
};

/// Rays as arrays, all in host memory or all in that of the device of the world.
struct RayArrays {
  ArrayView origins;         ///< [m]: (n, 3), "<f4" or "<f8"
  ArrayView directions;      ///< any non-zero length: the same
  double maxDistance = 1e6;  ///< [m]
  /// Of all rays. Deformable objects are not tested. In many worlds the body to skip is that of the same
  /// index in each.
  QueryFilter filter = {};
};
/// First hits of these rays as RayHit, in the memory that the rays are in. Valid until the next call for rays
/// that are arrays.
struct RayHitArrays {
  /// [m]: (n, 1), "<f4". RayArrays::maxDistance without a hit. On a device NaN for a ray that is not finite,
  /// has no direction, or names no world; the host throws Error for these.
  ArrayView distances;
  ArrayView bodies;   ///< BodyId::index: (n, 1), "<i4"; -1: no hit
  ArrayView normals;  ///< outward from the body: (n, 3), "<f4"; zeros: no hit
};

/// Sweep of a convex shape or compound along a line, without rotation.
struct CastQuery {
  Shape shape;
  Vec3 position;  ///< [m]
  Quat orientation;
  Vec3 displacement;  ///< [m]
  QueryFilter filter;
};
/// First place where the swept shape comes within 1e-4 of its size of a body.
struct CastHit {
  bool hit = false;
  BodyId body;
  double fraction = 0;  ///< fraction of the displacement; 0: they touch at the start
  Vec3 position;        ///< on the body [m]; the position of the shape if they overlap at the start
  /// Outward from the body, toward the shape. Zero if they overlap deeply at the start.
  Vec3 normal;
  int part = 0;                     ///< of a compound: index into its parts
  std::uint64_t userData = 0;       ///< BodyDef::userData, DeformableDef::userData
  std::uint64_t shapeUserData = 0;  ///< Shape::userData of the body, or of the part of a compound
  DeformableId object = {};         ///< DeformableId{}: a body
  /// As RayHit::triangle. Of bodies in the results of World::castShapesAll() only.
  int triangle = -1;
};

/// Overlap test. Meshes and height fields overlap where their surface does.
struct OverlapQuery {
  Shape shape;    ///< convex or compound
  Vec3 position;  ///< [m]
  Quat orientation;
  QueryFilter filter;
};

struct OverlapHit {
  BodyId body;                 ///< BodyId{}: a deformable object
  DeformableId object = {};    ///< DeformableId{}: a body
  int part = 0;                ///< of a compound: index into its parts
  int triangle = -1;           ///< of a deformable object, as RayHit::triangle: one of those that overlap
  std::uint64_t userData = 0;  ///< BodyDef::userData, DeformableDef::userData
  std::uint64_t shapeUserData = 0;  ///< Shape::userData of the body, or of the part of a compound
};

struct ClosestQuery {
  Vec3 point;                ///< [m]
  double maxDistance = 1e3;  ///< [m]
  QueryFilter filter;
};
/// Closest point of a body. For a point inside of a body it is that point.
struct ClosestHit {
  bool hit = false;
  BodyId body;
  double distance = 0;              ///< [m]
  Vec3 position;                    ///< [m]
  int part = 0;                     ///< of a compound: index into its parts
  std::uint64_t userData = 0;       ///< BodyDef::userData, DeformableDef::userData
  std::uint64_t shapeUserData = 0;  ///< Shape::userData of the body, or of the part of a compound
  DeformableId object = {};         ///< DeformableId{}: a body
  int triangle = -1;                ///< of a deformable object, as RayHit::triangle
};

}  // namespace rubble

#pragma once
/// Questions about where bodies are. Each takes a batch and answers in the order of the batch; bodies are
/// where the last step has put them.
#include <cstdint>
#include <vector>

#include <rubble/ids.h>
#include <rubble/scene.h>

namespace rubble {

/// A body is looked at if it has a layer that `mask` names and its own mask names one of `layers`.
struct QueryFilter {
  std::uint32_t layers = 0xffffffffu;
  std::uint32_t mask = 0xffffffffu;
  bool sensors = false;  ///< sensors are looked at as well
  BodyId ignore;         ///< this one is not
};

struct RayQuery {
  Vec3 origin;               ///< [m]
  Vec3 direction{0, 0, -1};  ///< of any length above 0
  double maxDistance = 1e6;  ///< [m]
  QueryFilter filter;
};
/// The first surface that a ray meets. A ray that begins inside a body meets it at distance 0 with the normal
/// against its direction. One-sided meshes and height fields are met from their front only.
struct RayHit {
  bool hit = false;
  BodyId body;
  double distance = 0;  ///< [m]
  Vec3 position;        ///< [m]
  Vec3 normal;          ///< out of the body
};

/// A convex shape or a compound that is moved along a line without turning.
struct CastQuery {
  Shape shape;
  Vec3 position;  ///< [m]
  Quat orientation;
  Vec3 displacement;  ///< [m]
  QueryFilter filter;
};
/// Where the shape first comes within 1e-4 of its size of a body.
struct CastHit {
  bool hit = false;
  BodyId body;
  double fraction = 0;  ///< of the displacement; 0 if they touch at the start
  Vec3 position;        ///< on the body [m]; that of the shape if they overlap at the start
  Vec3 normal;          ///< out of the body, towards the shape; zero if they overlap deeply at the start
};

/// Meshes and height fields are overlapped where their surface is.
struct OverlapQuery {
  Shape shape;    ///< convex, or a compound
  Vec3 position;  ///< [m]
  Quat orientation;
  QueryFilter filter;
};

struct ClosestQuery {
  Vec3 point;                ///< [m]
  double maxDistance = 1e3;  ///< [m]
  QueryFilter filter;
};
/// The nearest point of a body. Inside a body it is the point itself.
struct ClosestHit {
  bool hit = false;
  BodyId body;
  double distance = 0;  ///< [m]
  Vec3 position;        ///< [m]
};

}  // namespace rubble

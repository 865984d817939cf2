#pragma once
/// What is kept of vertices: the points of soft bodies, cloth and rods, and granular particles.
#include "forces/soft_forces.h"

namespace rubble::RUBBLE_CORE {

enum class VertexKind : int { Removed, Fixed, Dynamic };

/// Authored once; read-only in a step.
struct VertexParams {
  VertexKind kind;
  Real mass;          ///< [kg]; 0 unless dynamic
  Real radius;        ///< of the sphere that collides [m]
  Real length;        ///< L: mean length of its edges, or its diameter [m]
  Real muStatic, muDynamic;
  Real restitution;
  int frictionCombine, restitutionCombine;  ///< rubble::Combine
  Real gravityScale;
  int first;          ///< first vertex of its object: the origin that the object's elements are seen from
  int cluster;        ///< the one that is its whole object, or -1: it has no elements
  Real reach;         ///< mean L of its object [m]
  int collides;       ///< kCollides... of below
};
/// With bodies; with other vertices that do, as spheres.
inline constexpr int kCollidesWithBodies = 1, kCollidesWithGrains = 2;

/// A vertex in its place in the grid of granular particles.
struct GrainEntry {
  Vec3 centre, half;  ///< swept box [m]
  int x, y, z;        ///< cell
  int vertex;
};

/// A vertex and what it may touch: a body, or a granular particle of higher index (kVertexNode + index).
struct PointPair {
  int vertex, other;
};

/// An element, attachment or contact that acts on a vertex: type (4 bits), index (26 bits), corner (2 bits).
RUBBLE_HD constexpr std::uint32_t pointCode(int type, int index, int corner) {
  return static_cast<std::uint32_t>(type) << 28 | static_cast<std::uint32_t>(index) << 2 | static_cast<std::uint32_t>(corner);
}
RUBBLE_HD constexpr int pointType(std::uint32_t code) { return static_cast<int>(code >> 28); }
RUBBLE_HD constexpr int pointIndex(std::uint32_t code) { return static_cast<int>((code & 0x0fffffffu) >> 2); }
RUBBLE_HD constexpr int pointCorner(std::uint32_t code) { return static_cast<int>(code & 3u); }
/// Types behind those of ElementTypes.
inline constexpr int kAttachmentCode = ElementTypes::kSize;

/// Row blocks of bodies (state/bodies.h) behind those of joints.
inline constexpr int kBodyAttachmentType = JointTypes::kSize + 1, kBodyPointContactType = JointTypes::kSize + 2;

/// In Entry::other and among neighbours: vertex v is written kVertexNode + v.
inline constexpr int kVertexNode = 1 << 30;

/// A cluster of vertices of one object, which the coarse correction moves as one (stages/clusters.h).
struct Cluster {
  int begin, end;            ///< in clusterMember
  int chunkBegin, chunkEnd;  ///< clusters of the finest level that it is made of
  int refBegin, refEnd;      ///< in clusterRef
  int parent;                ///< of the next level, or -1
};
inline constexpr int kClusterLevels = 6;

/// An element that leaves a cluster.
struct ClusterRef {
  int type, index;
  unsigned inside;           ///< bit k: corner k is inside
  int clusters;              ///< how many clusters of this level share it, 2 at least
};

/// What a cluster does in a step.
struct ClusterMotion {
  Vec3 centre;               ///< at the initial guess, seen from the first vertex of the object [m]
  Real mass;                 ///< [kg]
  Vec3 velocity;             ///< mean of its vertices at x^t [m/s]
  Vec6 step;                 ///< motion found by the last solve [m, rad]
  Block6 sum;                ///< finest level: of its vertices
};

/// Pairs that a vertex may own before they are searched a second time.
inline constexpr int kPointPairSlots = 12;

}  // namespace rubble::RUBBLE_CORE

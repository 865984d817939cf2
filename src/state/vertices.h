#pragma once
/// What is kept of vertices: the points of soft bodies, cloth and rods, and granular particles.
#include "forces/soft_forces.h"

namespace rubble::RUBBLE_CORE {

enum class VertexKind : int { Removed, Fixed, Dynamic };

/// Authored once; read-only in a step.
struct VertexParams {
  VertexKind kind;
  Real mass;    ///< [kg]; 0 unless dynamic
  Real radius;  ///< of the sphere that collides [m]
  Real length;  ///< L: mean length of its edges, or its diameter [m]
  Real muStatic, muDynamic;
  Real restitution;
  int frictionCombine, restitutionCombine;  ///< rubble::Combine
  Real gravityScale;
  int first;           ///< first vertex of its object: the origin that the object's elements are seen from
  int cluster;         ///< the one that is its whole object, or -1: it has no elements
  int softNode;        ///< that it belongs to, or -1: none
  Real reach;          ///< mean L of its object [m]
  int collides;        ///< kCollides... of below
  Real surfaceRadius;  ///< half the thickness that its surface has to other surfaces [m]
};
/// With bodies; with other vertices that do, as spheres; with the surfaces of other objects that do, with the
/// surface of its own.
inline constexpr int kCollidesWithBodies = 1, kCollidesWithParticles = 2, kCollidesWithSurfaces = 4,
                     kCollidesWithSelf = 8;
/// Its surface is closed, counter-clockwise seen from outside.
inline constexpr int kHasInside = 16;

/// A triangle or an edge of the surface of an object. Those of a kind lie in one grid.
enum class FeatureKind : int { Triangle, BareEdge, Edge };  // bare: of no triangle
inline constexpr int kFeatureKinds = 3;
struct SurfaceFeature {
  FeatureKind kind;
  int v[3];                 ///< corners, -1: none
  int edge[3];              ///< of a triangle: features that join corners k and k + 1
  int opposite[2];          ///< of an edge: third corners of its triangles, -1: none
  std::uint32_t source[2];  ///< elements (pointCode) that it vanishes with, or kNoSource
};
inline constexpr std::uint32_t kNoSource = ~0u;

/// Kinds of boxes in grids (stages/soft/box_grid.h): features, then granular particles.
inline constexpr int kParticleKind = kFeatureKinds, kBoxKinds = kFeatureKinds + 1, kBoxLevels = 16;
/// A feature or granular particle in its place in a grid.
struct alignas(8 * sizeof(Real)) BoxEntry {
  Vec3 centre, half;  ///< swept box [m]
  int item;           ///< feature or vertex
  int place;          ///< kind + kBoxKinds * level
};

/// A vertex or edge (as PointPair::vertex) and a feature that it may meet on their ways.
struct NearFeature {
  int owner, feature;
  int meets;  ///< in the last round that looked
};

/// How the way of a vertex is changed where surfaces would cross (stages/soft/crossings.h).
struct VertexRepair {
  int shift[3];  ///< sum of changes, in units of VertexRepair unit: whole numbers add up to the same in any
                 ///< order
  int hits;      ///< meetings that it takes part in
  int before;    ///< in the round before
  int hold;      ///< 1: it goes half the way in the next round
  int held;      ///< how often it did
  int changed;   ///< 1: its way is another than in the round before
  int isActive;  ///< 1: parts of it may meet others
  int stays;     ///< of the first vertex of an object, 1: the whole object stays where it is
  int owners,
      activePairs;  ///< likewise: its vertices and edges that may meet something, and the pairs that they own
  Real unit;        ///< of shift [m]
  Vec3 detour;      ///< what has changed in all [m]
};

/// What may touch: `vertex` is a vertex or, from `vertices` on, an edge (vertices + feature) or, behind
/// those, some corners of a body (stages/soft/body_corners.h); `other` a body, a granular particle of higher
/// index (kVertexNode + index), a vertex of a surface (kCornerNode + index), an edge or triangle
/// (kFeatureNode + feature), or -1: nothing.
struct PointPair {
  int vertex, other;
};

/// An element, attachment or contact that acts on a vertex: type (4 bits), index (26 bits), corner (2 bits).
RUBBLE_HD constexpr std::uint32_t pointCode(int type, int index, int corner) {
  return static_cast<std::uint32_t>(type) << 28 | static_cast<std::uint32_t>(index) << 2 |
         static_cast<std::uint32_t>(corner);
}
RUBBLE_HD constexpr int pointType(std::uint32_t code) { return static_cast<int>(code >> 28); }
RUBBLE_HD constexpr int pointIndex(std::uint32_t code) { return static_cast<int>((code & 0x0fffffffu) >> 2); }
RUBBLE_HD constexpr int pointCorner(std::uint32_t code) { return static_cast<int>(code & 3u); }
/// Types behind those of ElementTypes.
inline constexpr int kAttachmentCode = ElementTypes::kSize;

/// Row blocks of bodies (state/bodies.h) behind those of joints.
inline constexpr int kBodyAttachmentType = JointTypes::kSize + 1,
                     kBodyPointContactType = JointTypes::kSize + 2;

/// In Incidence::other and among neighbours: vertex v is written kVertexNode + v.
inline constexpr int kVertexNode = 1 << 30;
/// In PointPair::other only.
inline constexpr int kCornerNode = kVertexNode + (1 << 28), kFeatureNode = kVertexNode + (1 << 29);

/// A cluster of vertices of one object, which the coarse correction moves as one (stages/soft/clusters.h).
struct Cluster {
  int begin, end;            ///< in clusterMember
  int sliceBegin, sliceEnd;  ///< clusters of the finest level that it is made of
  int refBegin, refEnd;      ///< in clusterRef
  int parent;                ///< of the next level, or -1
};
inline constexpr int kClusterLevels = 6;

/// An element that leaves a cluster.
struct ClusterRef {
  int type, index;
  unsigned inside;  ///< bit k: corner k is inside
  int clusters;     ///< how many clusters of this level share it, 2 at least
};

/// What a cluster does in a step. Aligned, and blocks in quads, so that it is read in few pieces.
/// Sums of m times something over vertices, for the spin of their object. s: place at the end of the step,
/// seen from a point; d: displacement in the step; v: velocity at x^t. [kg m2], [kg m], [kg m2], [kg m2/s]
struct SpinSums {
  Sym3 inertia;              ///< (s.s) 1 - s s^T
  Vec3 place, moved;         ///< s, d
  Vec3 lost, before, after;  ///< d x v, s x v, s x d
};

struct alignas(4 * sizeof(Real)) ClusterMotion {
  Block6 sum;     ///< finest level: of its vertices, without `inner`
  Real mass;      ///< [kg]
  Block6 inner;   ///< finest level: of contacts of its object with itself
  int folded;     ///< 1: there are any
  Vec3 centre;    ///< at the initial guess, seen from the first vertex of the object [m]
  Vec3 velocity;  ///< mean of its vertices at x^t [m/s]
  Vec6 step;      ///< motion found by the last solve [m, rad]
  Block3 push;    ///< finest level: of its vertices, as their group sees them
  SpinSums spin;  ///< finest level: of its vertices, about `centre`
};

/// What groups of bodies move as if it were a body (stages/coarse/soft_nodes.h): a deformable object without
/// fixed vertices, or a granular particle.
struct SoftNode {
  int first;    ///< first vertex of the object, or the particle
  int cluster;  ///< that is the whole object, or -1: a particle
  Real radius;  ///< half of its size [m]
};

/// A rope or rod: vertices of which springs join each to the next alone (stages/soft/strands.h).
struct Strand {
  int begin, end;  ///< in strandVertex
};
struct StrandVertex {
  int v, line;
  int spring;  ///< to the next one; -1: it is the last
  int bend;    ///< of which it is the middle, or -1
};
/// Scalar rows of a matrix that a vertex of a line has, and how far behind the diagonal they reach.
inline constexpr int kStrandBand = 6;
struct StrandWork {
  double row[3][kStrandBand + 1];  ///< H, then its factors L D L^T: the diagonal and what stands behind it
  double x[3];                     ///< force [N], then the step [m]
};

/// The last two iterates of a vertex, by turns [m].
struct PastVertex {
  Vec3 moved[2];
};

/// Owners of pairs that a body has for its corners, where there are surfaces.
inline constexpr int kCornerSlots = 8;

/// Pairs that a vertex or edge may own before they are searched a second time.
inline constexpr int kPointPairSlots = 12;

}  // namespace rubble::RUBBLE_CORE

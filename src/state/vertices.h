#pragma once
/// Vertices: the points of deformable solids, cloth, cables and rods, and granular particles. Also their
/// surfaces, clusters and strands.
#include "forces/soft_forces.h"

namespace rubble::RUBBLE_CORE {

enum class VertexKind : int { Removed, Fixed, Dynamic };

/// Authored once; read-only in a step.
struct VertexParams {
  VertexKind kind;
  Real mass;    ///< [kg]; 0 unless dynamic
  Real radius;  ///< radius of its collision sphere [m]
  Real length;  ///< L: mean length of its edges, or its diameter for a particle [m]
  Real muStatic, muDynamic;
  Real restitution;
  std::uint32_t frictionCombine : 8;  ///< rubble::Combine
  std::uint32_t materialKind : 24;    ///< SurfaceData::kind
  int restitutionCombine;             ///< rubble::Combine
  Real gravityScale;
  int first;           ///< first vertex of its object, the local origin of the object's elements
  int cluster;         ///< cluster that contains its whole object; -1: the object has no elements
  int softNode;        ///< its soft node; -1: none
  Real reach;          ///< mean L of its object [m]
  int collides;        ///< flags kCollides... of forces/soft_forces.h
  Real surfaceRadius;  ///< half the thickness of its surface against other surfaces [m]
};
/// A triangle or edge of the surface of an object. Features of one kind share a grid.
enum class FeatureKind : int { Triangle, BareEdge, Edge };  // BareEdge: of no triangle
inline constexpr int kFeatureKinds = 3;
struct SurfaceFeature {
  FeatureKind kind;
  int v[3];                 ///< corners, -1: none
  int edge[3];              ///< of a triangle: the edge features of corners k and k + 1
  int opposite[2];          ///< of an edge: third corners of its triangles; -1: none
  std::uint32_t source[2];  ///< elements (pointCode) whose removal removes the feature, or kNoSource
};
inline constexpr std::uint32_t kNoSource = ~0u;

/// Kinds of boxes in grids (stages/soft/box_grid.h): features, then granular particles.
inline constexpr int kParticleKind = kFeatureKinds, kBoxKinds = kFeatureKinds + 1, kBoxLevels = 16;
/// A feature or granular particle as stored in its grid bucket.
struct alignas(8 * sizeof(Real)) BoxEntry {
  Vec3 center, half;  ///< swept AABB [m]
  int item;           ///< feature or vertex
  int place;          ///< kind + kBoxKinds * (level + kBoxLevels * world)
};

/// A vertex or edge (as PointPair::vertex) and a feature that its swept motion may meet.
struct NearFeature {
  int owner, feature;
  int meets;  ///< 1: they meet in the last round that tested them
};

/// Deflection of the motion of a vertex where surfaces would cross (stages/soft/crossings.h).
struct VertexRepair {
  int shift[3];  ///< sum of changes in units of VertexRepair::unit; integers, so that the sum does not depend
                 ///< on the order
  int hits;      ///< predicted impacts that involve the vertex
  int before;    ///< the same in the last round
  int hold;      ///< 1: its motion is halved in the next round
  int held;      ///< number of halvings so far
  int changed;   ///< 1: its motion differs from that of the last round
  int isActive;  ///< 1: its features may meet others
  int stays;     ///< at the first vertex of an object: 1: the whole object stays at x^t
  int owners,
      activePairs;  ///< at the first vertex of an object: vertices and edges that may meet something, and the
                    ///< pairs that they own
  Real unit;        ///< of shift [m]
  Vec3 detour;      ///< total change of the motion [m]
};

/// A candidate pair. `vertex` is one of
///   a vertex
///   an edge: vertices + feature
///   a corner slot of a body: behind the edges (stages/soft/body_corners.h)
/// `other` is one of
///   a body
///   a granular particle of higher index: kVertexNode + index
///   a vertex of a surface: kCornerNode + index
///   an edge or triangle: kFeatureNode + feature
///   nothing: -1
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
/// Type codes after those of ElementTypes.
inline constexpr int kAttachmentCode = ElementTypes::kSize;

/// Constraint types of bodies (state/bodies.h) after those of joints.
inline constexpr int kBodyAttachmentType = JointTypes::kSize + 1,
                     kBodyPointContactType = JointTypes::kSize + 2;

/// Vertex v is written kVertexNode + v in Incidence::other and in lists of neighbors.
inline constexpr int kVertexNode = 1 << 30;
/// In PointPair::other only.
inline constexpr int kCornerNode = kVertexNode + (1 << 28), kFeatureNode = kVertexNode + (1 << 29);

/// A cluster of vertices of one object that the coarse correction moves rigidly (stages/soft/clusters.h).
struct Cluster {
  int begin, end;            ///< range in clusterMember
  int sliceBegin, sliceEnd;  ///< range of the finest-level clusters that it contains
  int refBegin, refEnd;      ///< range in clusterRef
  int parent;                ///< cluster of the next coarser level, or -1
};
inline constexpr int kClusterLevels = 6;

/// An element that crosses the boundary of a cluster.
struct ClusterRef {
  int type, index;
  unsigned inside;  ///< bit k: corner k is in the cluster
  int clusters;     ///< number of clusters of this level that share the element, at least 2
};

/// Mass-weighted sums over vertices, for the angular momentum of their object. s: position at the end of the
/// step, relative to a reference point; d: displacement in the step; v: velocity at x^t. Units [kg m2], [kg
/// m], [kg m2/s].
struct SpinSums {
  Sym3 inertia;              ///< (s.s) 1 - s s^T
  Vec3 place, moved;         ///< s, d
  Vec3 lost, before, after;  ///< d x v, s x v, s x d
};

/// Sums and solution of a cluster in one step. Aligned for vectorized loads.
struct alignas(4 * sizeof(Real)) ClusterMotion {
  Block6 sum;     ///< finest level: sum over its vertices, without `inner`
  Real mass;      ///< [kg]
  Block6 inner;   ///< finest level: self-contacts of its object
  int folded;     ///< 1: `inner` is not zero
  Vec3 center;    ///< center at the initial guess, relative to the first vertex of the object [m]
  Vec3 velocity;  ///< mean velocity of its vertices at x^t [m/s]
  Vec6 step;      ///< solution of the last coarse solve [m, rad]
  Block3 push;    ///< finest level: sum over its vertices, as seen by their aggregate
  SpinSums spin;  ///< finest level: sum over its vertices, about `center`
};

/// A node of the aggregates that is not a body (stages/coarse/soft_nodes.h): a deformable object without
/// fixed vertices, or a granular particle.
struct SoftNode {
  int first;    ///< first vertex of the object, or the particle
  int cluster;  ///< cluster that contains the whole object; -1: a particle
  Real radius;  ///< half its size [m]
};

/// A cable or rod: a chain of vertices that springs join to their successors only (stages/soft/strands.h).
struct Strand {
  int begin, end;  ///< range in strandVertex
};
struct StrandVertex {
  int v, strand;
  int spring;  ///< spring to the next vertex; -1: the last vertex
  int bend;    ///< bending element with this vertex in the middle, or -1
};
/// Half bandwidth of the Hessian of a strand, in scalar rows.
inline constexpr int kStrandBand = 6;
struct StrandWork {
  double row[3][kStrandBand + 1];  ///< H, then its LDL^T factors: diagonal and band
  double x[3];                     ///< force [N], then the Newton step [m]
};

/// The last two iterates of a vertex, written alternately [m].
struct VertexIterates {
  Vec3 moved[2];
};

/// Corner slots per body: owners of pairs between body corners and surfaces.
inline constexpr int kCornerSlots = 8;

/// Partners that are stored of an owner of point pairs, and finds of which duplicates are removed before. Of
/// more there is only a number, and the second pass searches again.
inline constexpr int kPointPairSlots = 12, kPointPairFinds = 32;

}  // namespace rubble::RUBBLE_CORE

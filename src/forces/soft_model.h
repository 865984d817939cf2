#pragma once
/// A cooked deformable object, in double precision. Vertex indices are local to the object.
#include <array>
#include <memory>
#include <tuple>
#include <vector>

#include <rubble/deformables.h>

#include "forces/soft_forces.h"

namespace rubble {

/// A list of models for each element type.
template <class List> struct ElementModels;
template <class... F> struct ElementModels<TypeList<F...>> {
  using Lists = std::tuple<std::vector<typename F::Model>...>;
};

/// Host only, independent of the precision.
struct SoftModel {
  struct Vertex {
    Vec3 position, velocity;
    double mass = 0;        ///< 0: fixed [kg]
    double radius = 0;      ///< [m]
    double length = 0;      ///< L [m]
    bool onSurface = true;  ///< false: inside a solid
    Vec3 rest;              ///< rest position relative to the first vertex [m]
  };

  std::vector<Vertex> vertices;
  Material material;
  double gravityScale = 1;
  int collides = 0;                                          ///< flags kCollides...
  ElementModels<RUBBLE_CORE::ElementTypes>::Lists elements;  ///< by type
  std::vector<std::array<int, 3>> surface;  ///< triangles of the drawn surface, oriented outward
  /// Features of the collision surface against other surfaces; empty unless it collides with them.
  struct Source {
    int type = -1;  ///< type of the element whose removal removes the feature, as index into ElementTypes;
                    ///< -1: none
    int index = 0;
  };
  struct SurfaceEdge {
    std::array<int, 2> v;
    bool bare;  ///< of no triangle
    Source source[2];
    int opposite[2] = {-1, -1};  ///< third corners of its triangles
  };
  struct SurfaceFace {
    std::array<int, 3> v, edge;  ///< edge k joins corners k and k + 1
    Source source;
  };
  std::vector<SurfaceEdge> edges;
  std::vector<SurfaceFace> faces;
  double meanEdge = 0;       ///< mean length of the edges at rest [m]
  double surfaceRadius = 0;  ///< half of the distance between surfaces in contact [m]
  /// Nested clusters for the coarse correction; parents come before children.
  struct Cluster {
    int level, begin, end;  ///< range in clusterOrder
    int parent;             ///< parent cluster, or -1
  };
  static constexpr int kClusterLevels = 6, kFinestCluster = 8;
  std::vector<int> clusterOrder;
  std::vector<Cluster> clusters;
  double size = 0;  ///< diagonal of the bounding box of the vertices [m]
  double mass = 0;  ///< total mass of the vertices [kg]

  /// The elements of one type, by its model.
  template <class M> std::vector<M>& list() { return std::get<std::vector<M>>(elements); }
  template <class M> const std::vector<M>& list() const { return std::get<std::vector<M>>(elements); }
};

/// Is the object a node of aggregates, i.e. has it clusters and no fixed vertices?
inline bool isSoftNode(const SoftModel& m) {
  return !m.clusters.empty() && m.clusterOrder.size() == m.vertices.size();
}

/// Cooks a deformable object. Throws Error like validate() of deformables.h.
std::shared_ptr<const SoftModel> cookDeformable(const Deformable& def, const Path& path);

/// An attachment between vertices in engine numbering.
struct EngineAttachment {
  int v[4] = {-1, -1, -1, -1};
  double weight[4] = {0, 0, 0, 0};
  int body = kWorld;
  bool isVertexVertex = false;
  Vec3 worldPoint, anchor;
  double bound = kUnbreakable, compliance = 0;
  double length = 1, mass = 0;
  int previous = -1;  ///< its index at the last call; -1: new
};

/// Location of an object in the tables: first vertex, and first element of each type in the order of
/// ElementTypes.
struct SoftRange {
  static constexpr int kElementTypes = RUBBLE_CORE::ElementTypes::kSize;
  int vertex = -1;
  int element[kElementTypes] = {};
  int edge = 0, face = 0;  ///< first edge and face of its surface
};
/// Number of elements of each type, in the order of ElementTypes.
inline std::array<int, SoftRange::kElementTypes> elementCounts(const SoftModel& m) {
  return std::apply([](const auto&... list) { return std::array{static_cast<int>(list.size())...}; },
                    m.elements);
}

/// Does the object consist of granular particles?
inline bool hasNoElements(const SoftModel& m) {
  for (const int n : elementCounts(m))
    if (n > 0) return false;
  return true;
}

/// Computes the clusters of a model with given vertices and elements.
void makeClusters(SoftModel& model);

struct EngineSoftObject {
  std::shared_ptr<const SoftModel> model;
  SoftRange at;
  SoftRange previous;  ///< location at the last call; vertex -1: new
  int surface = -1;    ///< index into the materials of SetSurfaces, -1: a material without a name
  /// Its model at the last call, if it has another one now, with as many vertices. Null: the same.
  std::shared_ptr<const SoftModel> before = nullptr;
  bool hasPartner = true;  ///< is there another object in its world whose surface could meet its own?
};

}  // namespace rubble

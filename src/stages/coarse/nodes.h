#pragma once
/// Nodes of aggregates: bodies, then (numbered from SolverData::bodies on) soft nodes, which are whole
/// deformable objects and granular particles.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

/// Is the node moved by forces?
RUBBLE_HD inline bool mayJoin(const SolverData& s, int node) {
  return node >= s.bodies || s.params[node].kind == BodyKind::Dynamic;
}

RUBBLE_HD inline int worldOfNode(const SolverData& s, int node) {
  return node < s.bodies ? s.worldOf(node) : s.worldOfPoint(s.softNode[node - s.bodies].first);
}

/// The node of a vertex, -1 if it has none; such a vertex counts as fixed.
RUBBLE_HD inline int nodeOfVertex(const SolverData& s, int v) {
  const int softNode = s.vertexParams[v].softNode;
  return softNode >= 0 ? s.bodies + softNode : -1;
}

/// Center of mass of the object relative to its first vertex, at x^t or at the initial guess (clusters.h)
/// [m].
RUBBLE_HD inline Vec3 centerOf(const SolverData& s, const SoftNode& softNode) {
  return softNode.cluster >= 0 ? s.clusterMotion[softNode.cluster].center : Vec3{0, 0, 0};
}

/// Mass [kg].
RUBBLE_HD inline Real massOf(const SolverData& s, const SoftNode& softNode) {
  return softNode.cluster >= 0 ? s.clusterMotion[softNode.cluster].mass : s.vertexParams[softNode.first].mass;
}
/// Radius of the bounding sphere [m].
RUBBLE_HD inline Real radiusOf(const SolverData& s, int node) {
  return node < s.bodies ? s.params[node].radius : s.softNode[node - s.bodies].radius;
}
/// Center at x^t [m].
RUBBLE_HD inline Vec3d placeOf(const SolverData& s, int node) {
  if (node < s.bodies) return s.position[node];
  const SoftNode softNode = s.softNode[node - s.bodies];
  return s.vertexPosition[softNode.first] + Vec3d(centerOf(s, softNode));
}

}  // namespace rubble::RUBBLE_CORE

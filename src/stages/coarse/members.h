#pragma once
/// What groups are made of: bodies and, numbered from View::bodies on, lumps, which are whole deformable objects and granular particles.
#include "state/view.h"

namespace rubble::RUBBLE_CORE {

/// A member that moves by its forces.
RUBBLE_HD inline bool mayJoin(const View& s, int member) { return member >= s.bodies || s.params[member].kind == BodyKind::Dynamic; }

/// The member that a vertex moves with, -1: none, as if it were fixed.
RUBBLE_HD inline int memberOfVertex(const View& s, int v) {
  const int lump = s.vertexParams[v].lump;
  return lump >= 0 ? s.bodies + lump : -1;
}

/// Centre of mass of the object from its first vertex: at x^t, or at the initial guess (clusters.h).
RUBBLE_HD inline Vec3 centreOf(const View& s, const Lump& lump) {
  return lump.cluster >= 0 ? s.clusterMotion[lump.cluster].centre : Vec3{0, 0, 0};
}

/// [kg]
RUBBLE_HD inline Real massOf(const View& s, const Lump& lump) {
  return lump.cluster >= 0 ? s.clusterMotion[lump.cluster].mass : s.vertexParams[lump.first].mass;
}
/// Of its bounding sphere. [m]
RUBBLE_HD inline Real radiusOf(const View& s, int member) {
  return member < s.bodies ? s.params[member].radius : s.lump[member - s.bodies].radius;
}
/// Centre at x^t. [m]
RUBBLE_HD inline Vec3d placeOf(const View& s, int member) {
  if (member < s.bodies) return s.position[member];
  const Lump lump = s.lump[member - s.bodies];
  return s.vertexPosition[lump.first] + Vec3d(centreOf(s, lump));
}

}  // namespace rubble::RUBBLE_CORE

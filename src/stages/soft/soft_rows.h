#pragma once
/// Attachments and contacts of vertices, as seen from a body and from a vertex.
#include "stages/contacts/contacts.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline bool isDynamicVertex(const SolverData& s, int v) {
  return s.vertexParams[v].kind == VertexKind::Dynamic && !isPausedPoint(s, v);
}

/// sum c_i (x_i - x_i^t) over the vertices of an attachment or contact [m].
template <class Block> RUBBLE_HD Vec3 movedSum(const SolverData& s, const Block& b) {
  // issues all loads at once; another vertex than those of the block may be moving
  Vec3 moved[kPointCorners];
  RUBBLE_UNROLL
  for (int k = 0; k < kPointCorners; ++k) moved[k] = s.vertexMoved[b.v[k] >= 0 ? b.v[k] : b.v[0]];
  Vec3 sum{0, 0, 0};
  for (int k = 0; k < kPointCorners && b.v[k] >= 0; ++k) sum += b.weight[k] * moved[k];
  return sum;
}

RUBBLE_HD inline BodyMove bodyMove(const SolverData& s, const Attachment& a) {
  if (a.body == kWorldBody) return {{0, 0, 0}, Quat{}};
  return {s.dx[a.body].dp, s.dq[a.body]};
}

RUBBLE_HD inline Vec3 pointDisplacement(const SolverData& s, const PointContact& p) {
  const Vec3 moved = movedSum(s, p);
  return p.body >= 0 ? p.displacement(s.dx[p.body], moved) : moved;
}

RUBBLE_HD inline bool active(const SolverData&, const Attachment& a) { return a.alive && !a.broken; }

/// Adds an attachment or contact of vertices to the block of its body.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline void addSoftRows(const SolverData& s, std::uint32_t code, Block6& block) {
  if (constraintType(code) == kBodyAttachmentType) {
    const Attachment& a = s.attachment[constraintIndex(code)];
    a.accumulateBody(bodyMove(s, a), movedSum(s, a), block);
  } else if (constraintType(code) == kBodyPointContactType) {
    const auto& p = loadVectorized(s.pointContact[constraintIndex(code)]);
    p.accumulateBody(*s.step, s.plan.coneHessian, pointDisplacement(s, p), block);
  }
}

}  // namespace rubble::RUBBLE_CORE

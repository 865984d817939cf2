#pragma once
/// Vertices in the incidence lists of bodies, and the neighbors of a vertex. Bodies and vertices are nodes of
/// one graph.
#include "stages/bodies/incidence.h"
#include "stages/soft/vertex_contacts.h"

namespace rubble::RUBBLE_CORE {

/// Attachments and vertex contacts as constraints of a body. A constraint gives its body one active
/// incidence. If it has several vertices, further incidences, of types of their own, only list the neighbors.
struct AttachmentBlocks {
  static constexpr int kType = kBodyAttachmentType, kNeighborType = JointTypes::kSize + 3;
  using Block = Attachment;
  RUBBLE_HD static Block* blocks(const SolverData& s) { return s.attachment; }
  RUBBLE_HD static bool isActive(const SolverData& s, const Block& b) {
    return active(s, b) && b.isVertexVertex == 0 && isDynamic(s, b.body);
  }
};
struct PointContactBlocks {
  static constexpr int kType = kBodyPointContactType, kNeighborType = JointTypes::kSize + 4;
  using Block = PointContact;
  RUBBLE_HD static Block* blocks(const SolverData& s) { return s.pointContact; }
  RUBBLE_HD static bool isActive(const SolverData& s, const Block& b) {
    return b.active && b.body >= 0 && isDynamic(s, b.body);
  }
};

template <class Blocks> struct CountSoftIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (!Blocks::isActive(s, block)) return;
    int corners = 0;
    while (corners < kPointCorners && block.v[corners] >= 0) ++corners;
    atomicCount(&s.incidenceCount[block.body], corners);
  }
};

template <class Blocks> struct FillSoftIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (!Blocks::isActive(s, block)) return;
    for (int k = 0; k < kPointCorners && block.v[k] >= 0; ++k) {
      const int slot = s.incidenceOffset[block.body] + atomicCount(&s.incidenceCount[block.body], -1) - 1;
      const int other = isDynamicVertex(s, block.v[k]) ? kVertexNode + block.v[k] : -1;
      const std::uint32_t code = k == 0 ? constraintCode(Blocks::kType, i, 0)
                                        : constraintCode(Blocks::kNeighborType, 2 * i + k / 2, k & 1);
      s.incidence[slot] = {code, other, k == 0 && s.plan.coarseCorrection ? block.depth : 0};
    }
  }
};

/// Contacts of each vertex.
struct CountPointIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const PointContact& p = s.pointContact[i];
    if (!p.active) return;
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k)
      if (isDynamicVertex(s, p.v[k])) atomicCount(&s.pointIncidenceCount[p.v[k]], 1);
  }
};
struct FillPointIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    const PointContact& p = s.pointContact[i];
    if (!p.active) return;
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k) {
      const int v = p.v[k];
      if (!isDynamicVertex(s, v)) continue;
      s.pointIncidence[s.pointIncidenceOffset[v] + atomicCount(&s.pointIncidenceCount[v], -1) -
                       1] = pointCode(0, i, k);
    }
  }
};
struct SortPointIncidences {
  static constexpr const char* kStage = "incidence";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    for (int k = s.pointIncidenceOffset[v] + 1; k < s.pointIncidenceOffset[v + 1]; ++k) {
      const std::uint32_t code = s.pointIncidence[k];
      int j = k;
      for (; j > s.pointIncidenceOffset[v] && s.pointIncidence[j - 1] > code; --j)
        s.pointIncidence[j] = s.pointIncidence[j - 1];
      s.pointIncidence[j] = code;
    }
  }
};

/// visit(node) for every node that must not share the color of vertex v.
template <class Visit> RUBBLE_HD void visitNeighbors(const SolverData& s, int v, Visit&& visit) {
  for (int k = s.neighborOffset[v]; k < s.neighborOffset[v + 1]; ++k) visit(kVertexNode + s.neighbor[k]);
  visitAttachments(s, v, [&](const Attachment& a) {
    if (AttachmentBlocks::isActive(s, a)) visit(a.body);
  });
  for (int k = s.pointIncidenceOffset[v]; k < s.pointIncidenceOffset[v + 1]; ++k) {
    const PointContact& p = s.pointContact[pointIndex(s.pointIncidence[k])];
    if (PointContactBlocks::isActive(s, p)) visit(p.body);
    for (int c = 0; c < kPointCorners && p.v[c] >= 0; ++c)
      if (p.v[c] != v && isDynamicVertex(s, p.v[c])) visit(kVertexNode + p.v[c]);
  }
}

}  // namespace rubble::RUBBLE_CORE

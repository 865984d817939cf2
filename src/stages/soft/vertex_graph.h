#pragma once
/// Vertices in the incidence lists of bodies, and their neighbours: bodies and vertices are nodes of one graph.
#include "stages/bodies/incidence.h"
#include "stages/soft/vertex_contacts.h"

namespace rubble::RUBBLE_CORE {

/// Attachments and contacts as row blocks of a body. A block gives its body one entry that acts and, if it has several vertices, entries
/// that only tell of neighbours.
inline constexpr int kBodyNeighborType = JointTypes::kSize + 3;

struct AttachmentBlocks {
  static constexpr int kType = kBodyAttachmentType;
  using Block = Attachment;
  RUBBLE_HD static Block* blocks(const View& s) { return s.attachment; }
  RUBBLE_HD static bool acts(const View& s, const Block& b) { return active(s, b) && b.seam == 0 && isDynamic(s, b.body); }
};
struct PointContactBlocks {
  static constexpr int kType = kBodyPointContactType;
  using Block = PointContact;
  RUBBLE_HD static Block* blocks(const View& s) { return s.pointContact; }
  RUBBLE_HD static bool acts(const View& s, const Block& b) { return b.active && b.body >= 0 && isDynamic(s, b.body); }
};

template <class Blocks>
struct CountSoftEntries {
  static constexpr const char* kName = "incidence";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (!Blocks::acts(s, block)) return;
    int corners = 0;
    while (corners < kPointCorners && block.v[corners] >= 0) ++corners;
    atomicCount(&s.entryCount[block.body], corners);
  }
};

template <class Blocks>
struct FillSoftEntries {
  static constexpr const char* kName = "incidence";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const auto& block = Blocks::blocks(s)[i];
    if (!Blocks::acts(s, block)) return;
    for (int k = 0; k < kPointCorners && block.v[k] >= 0; ++k) {
      const int slot = s.entryOffset[block.body] + atomicCount(&s.entryCount[block.body], -1) - 1;
      const int other = isDynamicVertex(s, block.v[k]) ? kVertexNode + block.v[k] : -1;
      const std::uint32_t code = k == 0 ? entryCode(Blocks::kType, i, 0) : entryCode(kBodyNeighborType, 2 * i + k / 2, k & 1);
      s.entry[slot] = {code, other, k == 0 && s.step.coarseCorrection ? block.depth : 0};
    }
  }
};

/// Contacts of each vertex.
struct CountPointEntries {
  static constexpr const char* kName = "incidence";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const PointContact& p = s.pointContact[i];
    if (!p.active) return;
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k)
      if (isDynamicVertex(s, p.v[k])) atomicCount(&s.pointEntryCount[p.v[k]], 1);
  }
};
struct FillPointEntries {
  static constexpr const char* kName = "incidence";
  RUBBLE_HD void operator()(const View& s, int i) const {
    const PointContact& p = s.pointContact[i];
    if (!p.active) return;
    for (int k = 0; k < kPointCorners && p.v[k] >= 0; ++k) {
      const int v = p.v[k];
      if (!isDynamicVertex(s, v)) continue;
      s.pointEntry[s.pointEntryOffset[v] + atomicCount(&s.pointEntryCount[v], -1) - 1] = pointCode(0, i, k);
    }
  }
};
struct SortPointEntries {
  static constexpr const char* kName = "incidence";
  RUBBLE_HD void operator()(const View& s, int v) const {
    for (int k = s.pointEntryOffset[v] + 1; k < s.pointEntryOffset[v + 1]; ++k) {
      const std::uint32_t code = s.pointEntry[k];
      int j = k;
      for (; j > s.pointEntryOffset[v] && s.pointEntry[j - 1] > code; --j) s.pointEntry[j] = s.pointEntry[j - 1];
      s.pointEntry[j] = code;
    }
  }
};

/// visit(node) for everything that must not have the colour of vertex v.
template <class Visit>
RUBBLE_HD void visitNeighbors(const View& s, int v, Visit&& visit) {
  for (int k = s.neighborOffset[v]; k < s.neighborOffset[v + 1]; ++k) visit(kVertexNode + s.neighbor[k]);
  visitAttachments(s, v, [&](const Attachment& a) {
    if (AttachmentBlocks::acts(s, a)) visit(a.body);
  });
  for (int k = s.pointEntryOffset[v]; k < s.pointEntryOffset[v + 1]; ++k) {
    const PointContact& p = s.pointContact[pointIndex(s.pointEntry[k])];
    if (PointContactBlocks::acts(s, p)) visit(p.body);
    for (int c = 0; c < kPointCorners && p.v[c] >= 0; ++c)
      if (p.v[c] != v && isDynamicVertex(s, p.v[c])) visit(kVertexNode + p.v[c]);
  }
}

}  // namespace rubble::RUBBLE_CORE

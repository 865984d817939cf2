#pragma once
/// Deformable objects do not sleep. They keep bodies awake that are attached to them or near them.
#include "stages/soft/vertex_contacts.h"

namespace rubble::RUBBLE_CORE {

/// The body near a moving vertex, and the body of an attachment; -1 if there is none.
struct NearVertex {
  RUBBLE_HD static int body(const SolverData& s, int i) {
    const PointPair p = s.pointPair[i];
    if (p.vertex >= s.vertices + s.edges) {
      int v[3];
      bool moves = false;
      for (int k = p.other < 0 ? 0 : partCorners(s, p.other, v); k > 0; --k)
        moves |= isDynamicVertex(s, v[k - 1]);
      return moves ? bodyOfOwner(s, p.vertex) : -1;
    }
    return p.other >= 0 && p.other < kVertexNode && isDynamicVertex(s, p.vertex) ? p.other : -1;
  }
};
struct HeldByVertices {
  RUBBLE_HD static int body(const SolverData& s, int i) {
    const Attachment& a = s.attachment[i];
    return active(s, a) && a.isVertexVertex == 0 ? a.body : -1;
  }
};

template <class Source> struct WakeBySoft {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (const int body = Source::body(s, i); body >= 0 && s.asleep[body] != 0)
      atomicRaise(&s.islandFlag[s.asleep[body] - 1], 1);
  }
};
template <class Source> struct KeepAwakeBySoft {
  static constexpr const char* kStage = "sleep";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (const int body = Source::body(s, i); body >= 0 && isDynamic(s, body))
      atomicRaise(&s.islandFlag[findRoot(s.island, body)], 1);
  }
};

}  // namespace rubble::RUBBLE_CORE

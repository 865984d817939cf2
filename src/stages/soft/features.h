#pragma once
/// Triangles and edges of the surfaces of deformable objects, in a multi-level grid. It is filled twice per
/// step: first with the predicted boxes, then with those of the motions that the iterations have found
/// (crossings.h).
#include "collision/features.h"
#include "stages/soft/box_grid.h"
#include "stages/soft/vertices.h"

namespace rubble::RUBBLE_CORE {

/// Can features at the vertex meet others?
RUBBLE_HD inline bool meetsFeatures(const SolverData& s, int v) {
  return (s.vertexParams[v].collides & (kCollidesWithSurfaces | kCollidesWithSelf)) != 0;
}

/// Predicted motion of a vertex along its velocity, and the reach within which rows are wanted.
struct ExpectedWay {
  RUBBLE_HD static Vec3 way(const SolverData& s, int v) { return s.step->dt * s.vertexVelocity[v]; }
  RUBBLE_HD static Real reach(const SolverData& s, int v) {
    return s.vertexParams[v].surfaceRadius + s.step->contactMargin * s.vertexParams[v].length;
  }
  /// Does another feature or a corner of a body look for the feature?
  RUBBLE_HD static bool isSought(const SolverData& s, const SurfaceFeature& f) {
    const bool byBodies = f.kind != FeatureKind::Edge &&
                          (s.vertexParams[f.v[0]].collides & kCollidesWithBodies) != 0;
    return byBodies || meetsFeatures(s, f.v[0]);
  }
};

/// Largest detour of a vertex that avoids a crossing: this many radii of its surface, plus this share of its
/// motion [1].
inline constexpr Real kDetourRadii = 2, kDetourShare = Real(.5);
/// The motion that the iterations have found. It is zero if the vertex does not move with it
/// (FinishVertices).
RUBBLE_HD inline Vec3 foundWay(const SolverData& s, int v) {
  return hasLength(s.vertexMoved[v]) ? s.vertexMoved[v] : Vec3{0, 0, 0};
}
RUBBLE_HD inline Real longestDetour(const SolverData& s, int v) {
  return kDetourRadii * s.vertexParams[v].surfaceRadius + kDetourShare * length(foundWay(s, v));
}

/// Motion of a vertex as found by the iterations.
struct FoundWay {
  RUBBLE_HD static Vec3 way(const SolverData& s, int v) { return foundWay(s, v); }
  RUBBLE_HD static Real reach(const SolverData& s, int v) {
    // the value with which the grid was filled
    return s.vertexParams[v].surfaceRadius + s.vertexRepair[v].unit * kDetourUnits;
  }
  RUBBLE_HD static bool isSought(const SolverData& s, const SurfaceFeature& f) {
    return meetsFeatures(s, f.v[0]);
  }
  /// The longest detour in units of VertexRepair. The resolution is ample, and a sum has room for a thousand
  /// detours.
  static constexpr int kDetourUnits = 1 << 20;
};

/// `v` has `corners` vertices.
template <class SweptMotion> RUBBLE_HD SweptBox sweptBox(const SolverData& s, const int* v, int corners) {
  Vec3 low{0, 0, 0}, high{0, 0, 0};
  for (int k = 0; k < corners; ++k) {
    const Vec3 x(s.vertexPosition[v[k]]), to = x + SweptMotion::way(s, v[k]);
    const Real roundOff = Real(2.4e-7) * (std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z)),
               grow = SweptMotion::reach(s, v[k]) + roundOff;
    for (int i = 0; i < 3; ++i) {
      const Real a = min(x[i], to[i]) - grow, b = max(x[i], to[i]) + grow;
      low[i] = k == 0 ? a : min(low[i], a);
      high[i] = k == 0 ? b : max(high[i], b);
    }
  }
  return {Real(.5) * (low + high), Real(.5) * (high - low)};
}

RUBBLE_HD inline int cornersOf(const SurfaceFeature& f) { return f.kind == FeatureKind::Triangle ? 3 : 2; }

/// Does the feature exist? A torn triangle does not, nor does an edge without its triangles or spring.
RUBBLE_HD inline bool isThere(const SolverData& s, const SurfaceFeature& f) {
  if (f.source[0] == kNoSource) return true;
  for (const std::uint32_t source : f.source) {
    if (source == kNoSource) continue;
    const int type = pointType(source), index = pointIndex(source);
    if (type == typeIndex<Membrane>(ElementTypes{}) && s.elementsOf<Membrane>()[index].alive) return true;
    if (type == typeIndex<Spring>(ElementTypes{}) && s.elementsOf<Spring>()[index].alive) return true;
  }
  return false;
}

template <class SweptMotion> RUBBLE_HD bool isInGrid(const SolverData& s, const SurfaceFeature& f) {
  return SweptMotion::isSought(s, f) && isThere(s, f) && !isPausedPoint(s, f.v[0]);
}

template <class SweptMotion> RUBBLE_HD BoxEntry placeFeature(const SolverData& s, int i, int& bucket) {
  const SurfaceFeature& f = s.feature[i];
  return featureGrid(s).place(s.worldOfPoint(f.v[0]), static_cast<int>(f.kind),
                              sweptBox<SweptMotion>(s, f.v, cornersOf(f)), i, bucket);
}

template <class SweptMotion> struct CountFeatures {
  static constexpr const char* kStage = "surfaces";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isInGrid<SweptMotion>(s, s.feature[i])) return;
    int bucket;
    noteBox(s, placeFeature<SweptMotion>(s, i, bucket));
    atomicCount(&s.featureCount[bucket], 1);
  }
};

/// In no fixed order.
template <class SweptMotion> struct FillFeatures {
  static constexpr const char* kStage = "surfaces";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isInGrid<SweptMotion>(s, s.feature[i])) return;
    int bucket;
    const BoxEntry e = placeFeature<SweptMotion>(s, i, bucket);
    s.featureEntry[s.featureOffset[bucket] + atomicCount(&s.featureCount[bucket], -1) - 1] = e;
  }
};

/// Resets the levels before the second filling.
struct ForgetFeatureLevels {
  static constexpr const char* kStage = "surfaces";
  RUBBLE_HD void operator()(const SolverData& s, int kind) const {
    s.counters->boxLevels[kind] = 0;
    for (auto& half : s.counters->boxHalf[kind]) half[0] = half[1] = half[2] = 0;
  }
};

/// found(feature) for the features of a kind in a world whose boxes touch the given one; share of worker
/// `lane` of `lanes`.
template <class Found>
RUBBLE_HD void seekFeatures(const SolverData& s, int world, FeatureKind kind, const SweptBox& box,
                            Found&& found, int lane = 0, int lanes = 1) {
  seekBoxes(s, featureGrid(s), world, static_cast<int>(kind), box, found, lane, lanes);
}

/// Does an attachment connect the two vertices?
RUBBLE_HD inline bool areJoined(const SolverData& s, int a, int b) {
  bool joined = false;
  visitAttachments(s, a, [&](const Attachment& attachment) {
    if (!active(s, attachment)) return;
    for (int c = 0; c < kPointCorners && attachment.v[c] >= 0; ++c) joined |= attachment.v[c] == b;
  });
  return joined;
}

/// May a vertex or an edge (vertices a) collide with a feature? Features that share a vertex do not, nor do
/// surfaces that an attachment connects there.
RUBBLE_HD inline bool mayMeet(const SolverData& s, const int* a, int corners, const SurfaceFeature& f) {
  const int others = cornersOf(f);
  bool moves = false;
  for (int i = 0; i < corners; ++i) {
    moves |= isDynamicVertex(s, a[i]);
    for (int j = 0; j < others; ++j)
      if (a[i] == f.v[j]) return false;
  }
  const VertexParams &p = s.vertexParams[a[0]], &q = s.vertexParams[f.v[0]];
  if (((p.first == q.first ? kCollidesWithSelf : kCollidesWithSurfaces) & p.collides & q.collides) == 0)
    return false;
  for (int j = 0; j < others; ++j) moves |= isDynamicVertex(s, f.v[j]);
  if (!moves) return false;
  for (int i = 0; s.attachments > 0 && i < corners; ++i)
    for (int j = 0; j < others; ++j)
      if (areJoined(s, a[i], f.v[j]) || areJoined(s, f.v[j], a[i])) return false;
  return true;
}

/// Vertices of the owner of a pair: one, or the two of an edge.
RUBBLE_HD inline int ownerCorners(const SolverData& s, int owner, int (&v)[2]) {
  if (owner < s.vertices) {
    v[0] = owner;
    return 1;
  }
  v[0] = s.feature[owner - s.vertices].v[0], v[1] = s.feature[owner - s.vertices].v[1];
  return 2;
}

/// Can the owner, a vertex or an edge, meet features?
RUBBLE_HD inline bool seeksFeatures(const SolverData& s, int owner) {
  if (owner >= s.vertices) return isInGrid<FoundWay>(s, s.feature[owner - s.vertices]);
  return meetsFeatures(s, owner) && !isPausedPoint(s, owner) &&
         s.vertexParams[owner].kind != VertexKind::Removed;
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// Triangles and edges of the surfaces of deformable objects: a grid with levels that is filled twice a step, first with the boxes in which
/// they are expected, then with those in which the iterations have put them (crossings.h).
#include "collision/features.h"
#include "stages/vertices.h"

namespace rubble::RUBBLE_CORE {

RUBBLE_HD inline bool isOnSurface(const View& s, int v) {
  return (s.vertexParams[v].collides & (kCollidesWithSurfaces | kCollidesWithSelf)) != 0;
}

/// A box that holds a vertex, an edge or a triangle during the step.
struct SweptBox {
  Vec3 centre, half;  ///< [m]
};

/// Where vertices are expected before the iterations: along their velocities; and how far from there rows are wanted.
struct ExpectedWay {
  RUBBLE_HD static Vec3 way(const View& s, int v) { return s.step.dt * s.vertexVelocity[v]; }
  RUBBLE_HD static Real reach(const View& s, int v) { return s.vertexParams[v].surfaceRadius + s.step.contactMargin * s.vertexParams[v].length; }
};

/// How far a vertex may be led off its way where surfaces would cross: this many radii of its surface and this share of its way [1].
inline constexpr Real kDetourRadii = 2, kDetourShare = Real(.5);
/// The way that the iterations have found; none if it is not finite, for then the vertex stays where it is (FinishVertices).
RUBBLE_HD inline Vec3 foundWay(const View& s, int v) { return isFinite(s.vertexMoved[v]) ? s.vertexMoved[v] : Vec3{0, 0, 0}; }
RUBBLE_HD inline Real longestDetour(const View& s, int v) {
  return kDetourRadii * s.vertexParams[v].surfaceRadius + kDetourShare * length(foundWay(s, v));
}

/// Where the iterations have put them.
struct FoundWay {
  RUBBLE_HD static Vec3 way(const View& s, int v) { return foundWay(s, v); }
  RUBBLE_HD static Real reach(const View& s, int v) {
    // as it was when the grid was filled
    return s.vertexParams[v].surfaceRadius + s.vertexRepair[v].unit * kDetourUnits;
  }
  /// The longest detour in units of VertexRepair: more than enough digits, and room for a thousand of them in a sum.
  static constexpr int kDetourUnits = 1 << 20;
};

/// `corners` of v are used.
template <class Way>
RUBBLE_HD SweptBox sweptBox(const View& s, const int* v, int corners) {
  Vec3 low{0, 0, 0}, high{0, 0, 0};
  for (int k = 0; k < corners; ++k) {
    const Vec3 x(s.vertexPosition[v[k]]), to = x + Way::way(s, v[k]);
    const Real roundOff = Real(2.4e-7) * (std::fabs(x.x) + std::fabs(x.y) + std::fabs(x.z)), grow = Way::reach(s, v[k]) + roundOff;
    for (int i = 0; i < 3; ++i) {
      const Real a = min(x[i], to[i]) - grow, b = max(x[i], to[i]) + grow;
      low[i] = k == 0 ? a : min(low[i], a);
      high[i] = k == 0 ? b : max(high[i], b);
    }
  }
  return {Real(.5) * (low + high), Real(.5) * (high - low)};
}

RUBBLE_HD inline int cornersOf(const SurfaceFeature& f) { return f.kind == FeatureKind::Triangle ? 3 : 2; }

/// A torn triangle is no longer there, nor an edge that has lost all its triangles or its spring.
RUBBLE_HD inline bool isThere(const View& s, const SurfaceFeature& f) {
  if (f.source[0] == kNoSource) return true;
  for (const std::uint32_t source : f.source) {
    if (source == kNoSource) continue;
    const int type = pointType(source), index = pointIndex(source);
    if (type == typeIndex<Membrane>(ElementTypes{}) && s.membrane[index].alive) return true;
    if (type == typeIndex<Spring>(ElementTypes{}) && s.spring[index].alive) return true;
  }
  return false;
}

RUBBLE_HD inline Real featureCellSize(const View& s, int level) { return s.featureCell * static_cast<Real>(1 << level); }
/// The finest level whose cells the box fits in.
RUBBLE_HD inline int featureLevel(const View& s, const Vec3& half) {
  const Real size = 2 * max(half.x, max(half.y, half.z));
  int level = 0;
  while (level < kFeatureLevels - 1 && !(size <= featureCellSize(s, level))) ++level;
  return level;
}
RUBBLE_HD inline int featureBucket(const View& s, int place, int x, int y, int z) {
  const std::uint32_t row = hash32(static_cast<std::uint32_t>(y) * 0x9e3779b1u ^ hash32(static_cast<std::uint32_t>(z) * 64u + static_cast<std::uint32_t>(place)));
  return static_cast<int>((row + static_cast<std::uint32_t>(x)) & static_cast<std::uint32_t>(s.featureCells - 1));
}

template <class Way>
RUBBLE_HD FeatureEntry featureEntry(const View& s, int i, int& bucket) {
  const SurfaceFeature& f = s.feature[i];
  const SweptBox box = sweptBox<Way>(s, f.v, cornersOf(f));
  const int level = featureLevel(s, box.half), place = static_cast<int>(f.kind) + kFeatureKinds * level;
  const Real size = featureCellSize(s, level);
  bucket = featureBucket(s, place, cellOf(box.centre.x, size), cellOf(box.centre.y, size), cellOf(box.centre.z, size));
  return {box.centre, box.half, i, place};
}

template <class Way>
struct CountFeatures {
  static constexpr const char* kName = "surfaces";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!isThere(s, s.feature[i])) return;
    int bucket;
    const FeatureEntry e = featureEntry<Way>(s, i, bucket);
    const int kind = e.place % kFeatureKinds, level = e.place / kFeatureKinds;
    if ((s.counters->featureLevels[kind] >> level & 1) == 0) atomicSet(&s.counters->featureLevels[kind], 1 << level);
    for (int k = 0; k < 3; ++k) {
      const int bits = floatBits(e.half[k] * Real(1.000001));
      if (bits > s.counters->featureHalf[kind][level][k]) atomicRaise(&s.counters->featureHalf[kind][level][k], bits);
    }
    atomicCount(&s.featureCount[bucket], 1);
  }
};

/// In no fixed order.
template <class Way>
struct FillFeatures {
  static constexpr const char* kName = "surfaces";
  RUBBLE_HD void operator()(const View& s, int i) const {
    if (!isThere(s, s.feature[i])) return;
    int bucket;
    const FeatureEntry e = featureEntry<Way>(s, i, bucket);
    s.featureEntry[s.featureOffset[bucket] + atomicCount(&s.featureCount[bucket], -1) - 1] = e;
  }
};

/// The second filling starts anew.
struct ForgetFeatureLevels {
  static constexpr const char* kName = "surfaces";
  RUBBLE_HD void operator()(const View& s, int kind) const {
    s.counters->featureLevels[kind] = 0;
    for (auto& half : s.counters->featureHalf[kind]) half[0] = half[1] = half[2] = 0;
  }
};

/// Cells that a search visits at most; beyond, looking at everything there is takes less.
inline constexpr Real kMostCells = 512;

/// visit(cell by cell: x, y, z) for the cells of edge `size` that something within `reach` of `centre` may have its centre in. Returns false,
/// and visits none, if they are too many: something that flies fast sweeps over many small cells.
template <class Visit>
RUBBLE_HD bool forEachCell(const Vec3& centre, const Vec3& reach, Real size, Visit&& visit) {
  if (!((2 * reach.x / size + 1) * (2 * reach.y / size + 1) * (2 * reach.z / size + 1) < kMostCells)) return false;
  const int x0 = cellOf(centre.x - reach.x, size), x1 = cellOf(centre.x + reach.x, size);
  const int y0 = cellOf(centre.y - reach.y, size), y1 = cellOf(centre.y + reach.y, size);
  const int z0 = cellOf(centre.z - reach.z, size), z1 = cellOf(centre.z + reach.z, size);
  for (int z = z0; z <= z1; ++z)
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) visit(x, y, z);
  return true;
}

/// found(feature) for those of a kind whose boxes meet the given one.
template <class Found>
RUBBLE_HD void seekFeatures(const View& s, FeatureKind kind, const SweptBox& box, Found&& found) {
  const int levels = s.counters->featureLevels[static_cast<int>(kind)];
  for (int level = 0; level < kFeatureLevels; ++level) {
    if ((levels >> level & 1) == 0) continue;
    const int place = static_cast<int>(kind) + kFeatureKinds * level;
    const Real size = featureCellSize(s, level);
    Vec3 reach;
    for (int k = 0; k < 3; ++k) reach[k] = box.half[k] + fromFloatBits(s.counters->featureHalf[static_cast<int>(kind)][level][k]);
    const auto look = [&](const FeatureEntry& e) {
      if (e.place == place && std::fabs(e.centre.x - box.centre.x) <= e.half.x + box.half.x &&
          std::fabs(e.centre.y - box.centre.y) <= e.half.y + box.half.y && std::fabs(e.centre.z - box.centre.z) <= e.half.z + box.half.z)
        found(e.feature);
    };
    const bool done = forEachCell(box.centre, reach, size, [&](int x, int y, int z) {
      const int bucket = featureBucket(s, place, x, y, z);
      for (int k = s.featureOffset[bucket]; k < s.featureOffset[bucket + 1]; ++k) {
        // another cell may share the bucket
        const FeatureEntry& e = s.featureEntry[k];
        if (cellOf(e.centre.x, size) == x && cellOf(e.centre.y, size) == y && cellOf(e.centre.z, size) == z) look(e);
      }
    });
    for (int k = 0; !done && k < s.featureOffset[s.featureCells]; ++k) look(s.featureEntry[k]);
  }
}

/// Does an attachment hold the two vertices to one another?
RUBBLE_HD inline bool areJoined(const View& s, int a, int b) {
  for (int k = s.refOffset[a]; k < s.refOffset[a + 1]; ++k) {
    if (pointType(s.ref[k]) != kAttachmentCode) continue;
    const Attachment& seam = s.attachment[pointIndex(s.ref[k])];
    if (!active(s, seam)) continue;
    for (int c = 0; c < kPointCorners && seam.v[c] >= 0; ++c)
      if (seam.v[c] == b) return true;
  }
  return false;
}

/// May a vertex or an edge (corners a) meet a feature? Neighbours that share a corner do not, nor do surfaces that an attachment joins there.
RUBBLE_HD inline bool mayMeet(const View& s, const int* a, int corners, const SurfaceFeature& f) {
  const int others = cornersOf(f);
  bool moves = false;
  for (int i = 0; i < corners; ++i) {
    moves |= isDynamicVertex(s, a[i]);
    for (int j = 0; j < others; ++j)
      if (a[i] == f.v[j]) return false;
  }
  const VertexParams &p = s.vertexParams[a[0]], &q = s.vertexParams[f.v[0]];
  if (((p.first == q.first ? kCollidesWithSelf : kCollidesWithSurfaces) & p.collides & q.collides) == 0) return false;
  for (int j = 0; j < others; ++j) moves |= isDynamicVertex(s, f.v[j]);
  if (!moves) return false;
  for (int i = 0; s.attachments > 0 && i < corners; ++i)
    for (int j = 0; j < others; ++j)
      if (areJoined(s, a[i], f.v[j]) || areJoined(s, f.v[j], a[i])) return false;
  return true;
}

/// Corners of the owner of a pair: one vertex, or the two of an edge.
RUBBLE_HD inline int ownerCorners(const View& s, int owner, int (&v)[2]) {
  if (owner < s.vertices) {
    v[0] = owner;
    return 1;
  }
  v[0] = s.feature[owner - s.vertices].v[0], v[1] = s.feature[owner - s.vertices].v[1];
  return 2;
}

/// Has the owner a surface that collides?
RUBBLE_HD inline bool ownsFeatures(const View& s, int owner) {
  if (owner >= s.vertices) return isThere(s, s.feature[owner - s.vertices]);
  return s.vertexParams[owner].kind != VertexKind::Removed && isOnSurface(s, owner);
}

}  // namespace rubble::RUBBLE_CORE

#pragma once
/// The triangles of meshes and height fields inside a box.
///   mesh          vectors: low and high corner of each node of a bounding volume hierarchy in depth-first
///                 order, then vertices;
///                 indices: per node the next node if it is skipped, and its triangle or -1; then corners
///                 of the triangles, their flags, and the opposite corner of the neighbor beyond each edge,
///                 or -1
///   height field  vectors: (spacing x, spacing y, lowest, highest), (x, y of the first sample, -, -), then
///                 samples, four per vector, x fastest;
///                 indices: flags of the two triangles of each cell
/// Flags: bit e: the edge that starts at corner e may be touched; bit 3 + k: corner k may be touched. The
/// next six bits are the same for the back side.
#include "collision/shapes.h"

namespace rubble::RUBBLE_CORE {

struct SurfaceTriangle {
  Vec3 corner[3];
  int flags;
  int index;
  Vec3 beyond[3];  ///< opposite corner of the neighbor beyond the edge that starts at corner e; corner e if
                   ///< there is none
};

RUBBLE_HD inline bool boxesOverlap(const Vec3& lowA, const Vec3& highA, const Vec3& lowB, const Vec3& highB) {
  return lowA.x <= highB.x && lowB.x <= highA.x && lowA.y <= highB.y && lowB.y <= highA.y &&
         lowA.z <= highB.z && lowB.z <= highA.z;
}

RUBBLE_HD inline Vec3 lower(const Vec3& a, const Vec3& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
RUBBLE_HD inline Vec3 upper(const Vec3& a, const Vec3& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}

RUBBLE_HD inline bool isTwoSided(const ShapeTables& tables, const ShapeData& s) {
  return s.kind == ShapeKind::Mesh && tables.index[s.data + 5] != 0;
}

namespace surface {

/// Calls visit(triangle) for the triangles of a mesh whose AABBs, and those of all their parent nodes, pass
/// meets(low, high).
template <class Meets, class Visit>
RUBBLE_HD bool visitMesh(const ShapeTables& tables, const ShapeData& s, Meets&& meets, Visit&& visit) {
  const int* const header = tables.index + s.data;
  const int nodes = header[2], triangles = header[3];
  const Vec4* const boxes = tables.vector + header[0];
  const Vec4* const vertices = boxes + 2 * nodes;
  const int* const links = tables.index + header[1];
  const int* const corners = links + 2 * nodes;
  const int* const flags = corners + 3 * triangles;
  const int* const beyond = flags + triangles;
  for (int i = 0; i < nodes;) {
    if (!meets(xyz(boxes[2 * i]), xyz(boxes[2 * i + 1]))) {
      i = links[2 * i];
      continue;
    }
    const int t = links[2 * i + 1];
    ++i;
    if (t < 0) continue;
    SurfaceTriangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.corner[k] = xyz(vertices[corners[3 * t + k]]);
      triangle.beyond[k] = beyond[3 * t + k] < 0 ? triangle.corner[k] : xyz(vertices[beyond[3 * t + k]]);
    }
    triangle.flags = flags[t];
    triangle.index = t;
    if (visit(triangle)) return true;
  }
  return false;
}

RUBBLE_HD inline int cellAt(Real x, int cells) {
  return static_cast<int>(clamp(std::floor(x), Real(0), Real(cells - 1)));
}

/// The samples of a height field.
struct HeightGrid {
  const Vec4* vectors;
  const int* flags;
  int nx, ny;
  Vec4 grid, first;

  RUBBLE_HD Vec3 corner(int i, int j) const {
    const int k = j * nx + i;
    const Vec4 four = vectors[2 + k / 4];
    const Real h = (k & 3) == 0 ? four.x : (k & 3) == 1 ? four.y : (k & 3) == 2 ? four.z : four.w;
    return {first.x + Real(i) * grid.x, first.y + Real(j) * grid.y, h};
  }
  /// Calls visit(triangle) for the triangles of a cell whose AABBs pass meets(low, high).
  template <class Meets, class Visit>
  RUBBLE_HD bool visitCell(int i, int j, Meets&& meets, Visit&& visit) const {
    const Vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
    const int cell = 2 * (j * (nx - 1) + i);
    for (int half = 0; half < 2; ++half) {
      SurfaceTriangle t{{a, half == 0 ? b : c, half == 0 ? c : d}, flags[cell + half], cell + half, {}};
      // at the boundary this gives the corner itself or another boundary point; neither rises above the edge
      t.beyond[0] = half == 0 ? corner(i, max(j - 1, 0)) : b;
      t.beyond[1] = half == 0 ? corner(min(i + 2, nx - 1), j + 1) : corner(i + 1, min(j + 2, ny - 1));
      t.beyond[2] = half == 0 ? d : corner(max(i - 1, 0), j);
      const Vec3 lowest = lower(t.corner[0], lower(t.corner[1], t.corner[2])),
                 highest = upper(t.corner[0], upper(t.corner[1], t.corner[2]));
      if (meets(lowest, highest) && visit(t)) return true;
    }
    return false;
  }
};
RUBBLE_HD inline HeightGrid heightGrid(const ShapeTables& tables, const ShapeData& s) {
  const int* const header = tables.index + s.data;
  const Vec4* const vectors = tables.vector + header[0];
  return {vectors, tables.index + header[1], header[2], header[3], vectors[0], vectors[1]};
}

template <class Visit>
RUBBLE_HD bool visitHeights(const HeightGrid& g, const Vec3& low, const Vec3& high, Visit&& visit) {
  if (low.z > g.grid.w || high.z < g.grid.z) return false;
  const Real x0 = (low.x - g.first.x) / g.grid.x, x1 = (high.x - g.first.x) / g.grid.x;
  const Real y0 = (low.y - g.first.y) / g.grid.y, y1 = (high.y - g.first.y) / g.grid.y;
  if (x1 < Real(0) || y1 < Real(0) || x0 > Real(g.nx - 1) || y0 > Real(g.ny - 1)) return false;
  const auto meets = [&](const Vec3& l, const Vec3& h) { return boxesOverlap(low, high, l, h); };
  for (int j = cellAt(y0, g.ny - 1); j <= cellAt(y1, g.ny - 1); ++j)
    for (int i = cellAt(x0, g.nx - 1); i <= cellAt(x1, g.nx - 1); ++i)
      if (g.visitCell(i, j, meets, visit)) return true;
  return false;
}

}  // namespace surface

/// Calls visit(triangle) for the triangles whose AABBs overlap [low, high] (frame of the surface), until it
/// returns true. Returns whether it did.
template <class Visit>
RUBBLE_HD bool visitTriangles(const ShapeTables& tables, const ShapeData& s, const Vec3& low,
                              const Vec3& high, Visit&& visit) {
  if (s.kind == ShapeKind::Mesh)
    return surface::visitMesh(
        tables, s, [&](const Vec3& l, const Vec3& h) { return boxesOverlap(low, high, l, h); }, visit);
  if (s.kind == ShapeKind::HeightField)
    return surface::visitHeights(surface::heightGrid(tables, s), low, high, visit);
  return false;
}

}  // namespace rubble::RUBBLE_CORE

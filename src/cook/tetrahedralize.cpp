/// Isosurface stuffing: a body-centered cubic lattice whose points near the surface are moved onto it and
/// whose tetrahedra are cut along it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include <rubble/error.h>
#include <rubble/mesh.h>

#include "cook/lattice_sides.h"

namespace rubble {

namespace {

/// A point is moved onto a cut nearer than this share of the edge. Long edges connect cell to cell, short
/// ones a corner and a center. These values give the best angle bounds (Labelle and Shewchuk 2007, table 1)
/// [1].
constexpr double kLongShare = .24999, kShortShare = .41189;

class Stuffing {
 public:
  Stuffing(const TriangleMesh& surface, double cell, const Path& path) : lattice_(surface, cell, path) {}

  TetrahedronMesh run() {
    lattice_.findSides(side_);
    findCuts();
    movePoints();
    forEachTetrahedron([&](const std::array<int, 4>& t) { clip(t); });
    return std::move(out_);
  }

 private:
  static std::uint64_t edgeKey(int a, int b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint32_t>(std::max(a, b));
  }
  signed char& side(int point) { return side_[static_cast<std::size_t>(point)]; }

  void findCuts() {
    for (int p = 0; p < lattice_.points(); ++p) {
      if (side(p) <= 0) continue;
      lattice_.forEachNeighbor(p, [&](int q, bool) {
        if (side(q) < 0) cuts_.emplace(edgeKey(p, q), lattice_.cut(p, q));
      });
    }
  }

  /// Moves points near a cut onto the surface. Their edges are then not cut.
  void movePoints() {
    moved_.reserve(cuts_.size());
    for (int p = 0; p < lattice_.points(); ++p) {
      double nearest = 1;
      const Vec3* to = nullptr;
      lattice_.forEachNeighbor(p, [&](int q, bool isLong) {
        if (side(p) * side(q) >= 0) return;
        const Vec3& at = cuts_.at(edgeKey(p, q));
        const double share = length(at - lattice_.place(p)) / length(lattice_.place(q) - lattice_.place(p));
        if (share < (isLong ? kLongShare : kShortShare) && share < nearest) nearest = share, to = &at;
      });
      if (!to) continue;
      moved_.emplace(p, *to);
      side(p) = 0;
    }
  }

  /// Each tetrahedron connects the centers of two adjacent cells and the ends of an edge of their common
  /// face.
  template <class Visit> void forEachTetrahedron(Visit&& visit) {
    lattice_.forEachFace([&](int here, int there, const std::array<int, 4>& corners) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::array<int, 4> t{here, there, corners[k], corners[(k + 1) % 4]};
        if (std::any_of(t.begin(), t.end(), [&](int p) { return side(p) > 0; })) visit(t);
      }
    });
  }

  int vertexOf(int point) {
    const auto [incidence, isNew] = vertices_.emplace(point, static_cast<int>(out_.vertices.size()));
    if (isNew) {
      const auto at = moved_.find(point);
      out_.vertices.push_back(at == moved_.end() ? lattice_.place(point) : at->second);
    }
    return incidence->second;
  }
  int cutVertex(int inside, int outside) {
    const auto [incidence, isNew] = cutVertices_.emplace(edgeKey(inside, outside),
                                                         static_cast<int>(out_.vertices.size()));
    if (isNew) out_.vertices.push_back(cuts_.at(edgeKey(inside, outside)));
    return incidence->second;
  }

  /// The part of a tetrahedron that is inside.
  void clip(const std::array<int, 4>& t) {
    int in[4], on[4], out[4], ins = 0, ons = 0, outs = 0;
    for (const int p : t) {
      if (side(p) > 0)
        in[ins++] = p;
      else if (side(p) == 0)
        on[ons++] = p;
      else
        out[outs++] = p;
    }
    if (outs == 0) {
      emit({vertexOf(t[0]), vertexOf(t[1]), vertexOf(t[2]), vertexOf(t[3])});
    } else if (ins == 1) {
      std::array<int, 4> corners{vertexOf(in[0])};
      std::size_t n = 1;
      for (int k = 0; k < ons; ++k) corners[n++] = vertexOf(on[k]);
      for (int k = 0; k < outs; ++k) corners[n++] = cutVertex(in[0], out[k]);
      emit(corners);
    } else if (ins == 3) {
      prism({vertexOf(in[0]), vertexOf(in[1]), vertexOf(in[2]), cutVertex(in[0], out[0]),
             cutVertex(in[1], out[0]), cutVertex(in[2], out[0])});
    } else if (ons == 1) {
      pyramid({vertexOf(in[0]), vertexOf(in[1]), cutVertex(in[1], out[0]), cutVertex(in[0], out[0])},
              vertexOf(on[0]));
    } else {
      prism({vertexOf(in[0]), cutVertex(in[0], out[0]), cutVertex(in[0], out[1]), vertexOf(in[1]),
             cutVertex(in[1], out[0]), cutVertex(in[1], out[1])});
    }
  }

  /// Quadrilaterals are split at their lowest vertex, from either side.
  static bool splitsFirst(int a, int b, int c, int d) { return std::min(a, c) < std::min(b, d); }

  void pyramid(const std::array<int, 4>& base, int top) {
    if (splitsFirst(base[0], base[1], base[2], base[3])) {
      emit({base[0], base[1], base[2], top}), emit({base[0], base[2], base[3], top});
    } else {
      emit({base[1], base[2], base[3], top}), emit({base[1], base[3], base[0], top});
    }
  }

  /// Corners 0 1 2 below 3 4 5 (Dompierre et al. 1999).
  void prism(std::array<int, 6> p) {
    const auto lowest = static_cast<std::size_t>(std::min_element(p.begin(), p.end()) - p.begin());
    const std::size_t turn = lowest % 3;
    std::array<int, 6> v;
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = p[(k + turn) % 3 + (lowest < 3 ? 0 : 3)];
      v[k + 3] = p[(k + turn) % 3 + (lowest < 3 ? 3 : 0)];
    }
    if (splitsFirst(v[1], v[2], v[5], v[4])) {
      emit({v[0], v[1], v[2], v[5]}), emit({v[0], v[1], v[5], v[4]});
    } else {
      emit({v[0], v[1], v[2], v[4]}), emit({v[0], v[4], v[2], v[5]});
    }
    emit({v[0], v[4], v[5], v[3]});
  }

  void emit(std::array<int, 4> t) {
    const auto at = [&](std::size_t k) { return out_.vertices[static_cast<std::size_t>(t[k])]; };
    if (dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) < 0) std::swap(t[2], t[3]);
    out_.tetrahedra.push_back(t);
  }

  SidesOfLattice lattice_;
  std::vector<signed char> side_;                 ///< of each point: 1 inside, -1 outside, 0 on the surface
  std::unordered_map<std::uint64_t, Vec3> cuts_;  ///< intersections of edges with the surface
  std::unordered_map<int, Vec3> moved_;
  std::unordered_map<int, int> vertices_;  ///< output index by point
  std::unordered_map<std::uint64_t, int> cutVertices_;
  TetrahedronMesh out_;
};

}  // namespace

TetrahedronMesh tetrahedralize(const TriangleMesh& surface, double cell, const Path& path) {
  if (!(cell > 0) || !std::isfinite(cell))
    throw Error(path + ".cell", "a width above 0 [m]", std::to_string(cell));
  validateClosed(surface, path);
  TetrahedronMesh mesh = Stuffing(surface, cell, path).run();
  if (mesh.tetrahedra.empty())
    throw Error(path + ".cell", "cells that fit into the surface", std::to_string(cell) + " m");
  return mesh;
}

}  // namespace rubble

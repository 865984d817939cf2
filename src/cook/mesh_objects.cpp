/// Deformable objects from meshes and polylines, and the validation of closed surfaces.
#include <algorithm>
#include <cmath>
#include <map>

#include <rubble/error.h>
#include <rubble/mesh.h>

#include "cook/checks.h"

namespace rubble {

namespace {

/// Triangle areas below this share of the squared longest edge count as zero [1].
constexpr double kNoArea = 1e-12;
/// Half a gigabyte of vertices. A longer cable is most likely a unit error.
constexpr int kMostSegments = 1 << 24;

}  // namespace

double volumeOf(const TriangleMesh& surface) {
  double sum = 0;
  const auto at = [&](int v) { return surface.vertices[static_cast<std::size_t>(v)] - surface.vertices[0]; };
  for (const auto& t : surface.triangles) sum += dot(at(t[0]), cross(at(t[1]), at(t[2]))) / 6;
  return sum;
}

void validateClosed(const TriangleMesh& surface, const Path& path) {
  if (surface.triangles.empty()) throw Error(path + ".triangles", "at least four", "none");
  checks::finite(surface.vertices, path + ".vertices");
  const auto edgeText = [](int a, int b) {
    return "the edge from vertex " + std::to_string(a) + " to " + std::to_string(b);
  };
  std::map<std::pair<int, int>, std::size_t> ways;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    const Path list = path + ".triangles", here = list[i];
    for (const int v : t)
      if (v < 0 || static_cast<std::size_t>(v) >= surface.vertices.size())
        throw Error(here, "indices below " + std::to_string(surface.vertices.size()), std::to_string(v));
    const Vec3 a = surface.vertices[static_cast<std::size_t>(t[0])],
               b = surface.vertices[static_cast<std::size_t>(t[1])],
               c = surface.vertices[static_cast<std::size_t>(t[2])];
    const double longest2 = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    if (!(length(cross(b - a, c - a)) > kNoArea * longest2)) throw Error(here, "a positive area", "zero");
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = t[k], to = t[(k + 1) % 3];
      if (!ways.emplace(std::pair{from, to}, i).second)
        throw Error(here, "two triangles on each edge, which go along it in opposite directions",
                    "a second one along " + edgeText(from, to) + " (turned over, or a third one there)");
    }
  }
  for (const auto& [way, i] : ways)
    if (!ways.contains({way.second, way.first}))
      throw Error((path + ".triangles")[i], "a closed surface",
                  "a hole beside " + edgeText(way.first, way.second));
  const double volume = volumeOf(surface);
  if (!(volume > 0))
    throw Error(path + ".triangles", "corners counter-clockwise seen from outside",
                "a volume of " + std::to_string(volume) + " m3");
}

TetSolidDef tetSolidFromMesh(TetrahedronMesh mesh) {
  TetSolidDef out;
  for (auto& t : mesh.tetrahedra) {
    const auto at = [&](std::size_t k) {
      const int v = t[k];
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
        throw Error("mesh.tetrahedra", "indices below " + std::to_string(mesh.vertices.size()),
                    std::to_string(v));
      return mesh.vertices[static_cast<std::size_t>(v)];
    };
    if (dot(at(1) - at(0), cross(at(2) - at(0), at(3) - at(0))) < 0) std::swap(t[2], t[3]);
  }
  out.vertices = std::move(mesh.vertices);
  out.tetrahedra = std::move(mesh.tetrahedra);
  return out;
}

TetSolidDef tetSolidFromSurface(const TriangleMesh& surface, double cell) {
  return tetSolidFromMesh(tetrahedralize(surface, cell));
}

ClothDef clothFromMesh(const TriangleMesh& mesh) {
  ClothDef out;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    auto& corners = out.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const int v = mesh.triangles[i][k];
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
        throw Error(Path("mesh.triangles")[i], "indices below " + std::to_string(mesh.vertices.size()),
                    std::to_string(v));
      int& own = number[static_cast<std::size_t>(v)];
      if (own < 0) {
        own = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
      }
      corners[k] = own;
    }
  }
  return out;
}

CableDef cableAlong(const std::vector<Vec3>& points, double segment, bool closed) {
  checks::positive(segment, "segment");
  checks::finite(points, "points");
  if (points.size() < (closed ? 3u : 2u))
    throw Error("points", "at least " + std::to_string(closed ? 3 : 2), std::to_string(points.size()));
  CableDef out;
  out.closed = closed;
  const std::size_t pieces = points.size() - (closed ? 0 : 1);
  std::vector<double> reached{0};
  for (std::size_t i = 0; i < pieces; ++i)
    reached.push_back(reached.back() + length(points[(i + 1) % points.size()] - points[i]));
  if (!(reached.back() > 0) || !std::isfinite(reached.back()))
    throw Error("points", "a line with a length", "one of " + std::to_string(reached.back()) + " m");
  const double wanted = std::round(reached.back() / segment);
  if (!(wanted <= kMostSegments))
    throw Error("segment", "a length that makes at most " + std::to_string(kMostSegments) + " segments",
                checks::text(segment) + ", which makes " + checks::text(wanted));
  const int count = std::max(closed ? 3 : 1, static_cast<int>(wanted));
  std::size_t piece = 0;
  for (int i = 0; i < count + (closed ? 0 : 1); ++i) {
    const double at = reached.back() * i / count;
    while (piece + 1 < pieces && reached[piece + 1] < at) ++piece;
    const double size = reached[piece + 1] - reached[piece],
                 share = size > 0 ? std::min(1., (at - reached[piece]) / size) : 0;
    out.vertices.push_back(points[piece] + share * (points[(piece + 1) % points.size()] - points[piece]));
  }
  return out;
}

}  // namespace rubble

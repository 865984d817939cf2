#include "cook/soft_surface.h"

#include <algorithm>
#include <map>

namespace rubble {

namespace {

using Edge = std::pair<int, int>;

constexpr int kMembranes = typeIndex<host::Membrane>(host::ElementTypes{}),
              kSprings = typeIndex<host::Spring>(host::ElementTypes{});
/// Default contact radius over the mean edge length [1]. With a radius of zero the contact normal is
/// undefined.
constexpr double kBareSurfaceRadius = .01;

Edge orderedEdge(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

std::vector<std::array<int, 3>> boundaryOf(const std::vector<std::array<int, 4>>& tetrahedra) {
  std::map<std::array<int, 3>, std::pair<std::array<int, 3>, int>> faces;
  for (const auto& t : tetrahedra) {
    for (const std::array<int, 3>& f :
         {std::array<int, 3>{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}) {
      std::array<int, 3> key = f;
      std::sort(key.begin(), key.end());
      auto& incidence = faces[key];
      incidence.first = f;
      ++incidence.second;
    }
  }
  std::vector<std::array<int, 3>> out;
  for (const auto& [key, face] : faces)
    if (face.second == 1) out.push_back(face.first);
  return out;
}

void addSurface(SoftModel& m, const DeformableDef& d, const std::vector<std::array<int, 3>>& triangles,
                const std::vector<std::pair<int, int>>& bare, bool elements) {
  if (!d.collideSurface && !d.collideSelf) return;
  const auto source = [&](int type, std::size_t k) {
    return elements ? SoftModel::Source{type, int(k)} : SoftModel::Source{};
  };
  for (std::size_t k = 0; k < bare.size(); ++k)
    m.edges.push_back({{bare[k].first, bare[k].second}, true, {source(kSprings, k), {}}, {-1, -1}});
  std::map<Edge, int> numbers;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    SoftModel::SurfaceFace face{triangles[t], {}, source(kMembranes, t)};
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge edge = orderedEdge(triangles[t][k], triangles[t][(k + 1) % 3]);
      const auto [incidence, isNew] = numbers.emplace(edge, int(m.edges.size()));
      if (isNew) m.edges.push_back({{edge.first, edge.second}, false, {}, {-1, -1}});
      SoftModel::SurfaceEdge& own = m.edges[std::size_t(incidence->second)];
      own.source[isNew ? 0 : 1] = face.source;
      own.opposite[isNew ? 0 : 1] = triangles[t][(k + 2) % 3];
      face.edge[k] = incidence->second;
    }
    m.faces.push_back(face);
  }
  for (SoftModel::Vertex& v : m.vertices) v.onSurface = false;
  for (const SoftModel::SurfaceEdge& e : m.edges) {
    m.meanEdge += length(d.vertices[std::size_t(e.v[0])] - d.vertices[std::size_t(e.v[1])]) /
                  double(m.edges.size());
    for (const int v : e.v) m.vertices[std::size_t(v)].onSurface = true;
  }
  m.surfaceRadius = m.vertices[0].radius > 0 ? m.vertices[0].radius : kBareSurfaceRadius * m.meanEdge;
}

}  // namespace rubble

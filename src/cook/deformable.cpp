/// Converts authored deformable objects to elements with their rest-shape constants.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "cook/soft_surface.h"
#include "forces/element_kind.h"
#include "math/portable.h"

namespace rubble {

namespace {

using Edge = std::pair<int, int>;

const Vec3& at(const DeformableDef& d, int vertex) { return d.vertices[std::size_t(vertex)]; }

double triangleArea(const Vec3& a, const Vec3& b, const Vec3& c) { return length(cross(b - a, c - a)) / 2; }

/// Vertices at their initial positions, without mass, radius and velocity.
SoftModel startModel(const DeformableDef& d) {
  SoftModel m;
  const std::vector<Vec3>& from = d.start.empty() ? d.vertices : d.start;
  for (std::size_t v = 0; v < from.size(); ++v)
    m.vertices.push_back({from[v], {}, 0, 0, 0, true, d.vertices[v] - d.vertices[0]});
  for (const ElementDef& e : d.elements) findElementKind(e.type)->add(m, e);
  m.material = d.material;
  m.gravityScale = d.gravityScale;
  m.collides = (d.collide ? kCollidesWithBodies : 0) | (d.collideVertices ? kCollidesWithParticles : 0) |
               (d.collideSurface ? kCollidesWithSurfaces : 0) | (d.collideSelf ? kCollidesWithSelf : 0);
  return m;
}

/// Adds what depends on masses: velocities, fixed vertices, size.
std::shared_ptr<const SoftModel> finished(SoftModel m, const DeformableDef& d) {
  Vec3 moment, lowest = m.vertices[0].position, highest = lowest;
  for (const SoftModel::Vertex& v : m.vertices) {
    m.mass += v.mass;
    moment += v.mass * v.position;
    for (int k = 0; k < 3; ++k) {
      lowest[k] = std::min(lowest[k], v.position[k]);
      highest[k] = std::max(highest[k], v.position[k]);
    }
  }
  m.size = length(highest - lowest) + 2 * m.vertices[0].radius;
  const Vec3 center = moment / m.mass;
  for (SoftModel::Vertex& v : m.vertices)
    v.velocity = d.velocity + cross(d.angularVelocity, v.position - center);
  for (const int v : d.fixed) {
    m.vertices[std::size_t(v)].mass = 0;
    m.vertices[std::size_t(v)].velocity = {};
  }
  makeClusters(m);
  return std::make_shared<const SoftModel>(std::move(m));
}

/// L of each vertex: the mean rest length of its edges, or `otherwise` if it has none.
void setLengths(SoftModel& m, const DeformableDef& d, const std::vector<Edge>& edges, double otherwise) {
  std::vector<double> sum(m.vertices.size()), count(m.vertices.size());
  for (const auto& [a, b] : edges) {
    const double l = length(at(d, a) - at(d, b));
    for (const int v : {a, b}) sum[std::size_t(v)] += l, count[std::size_t(v)] += 1;
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    m.vertices[v].length = count[v] > 0 ? sum[v] / count[v] : otherwise;
}

/// The smallest mass among dynamic vertices.
template <class Corners>
double leastMass(const SoftModel& m, const DeformableDef& d, const Corners& corners) {
  double least = 0;
  for (const int v : corners) {
    if (std::find(d.fixed.begin(), d.fixed.end(), v) != d.fixed.end()) continue;
    const double own = m.vertices[std::size_t(v)].mass;
    least = least > 0 ? std::min(least, own) : own;
  }
  return least > 0 ? least : 1;
}

Edge ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

template <std::size_t N> std::vector<Edge> edgesOf(const std::vector<std::array<int, N>>& cells) {
  std::vector<Edge> edges;
  for (const auto& c : cells)
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i + 1; j < N; ++j) edges.push_back(ordered(c[i], c[j]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

TetrahedronModel cookTetrahedron(const TetSolidDef& d, const std::array<int, 4>& v) {
  const Vec3 a = at(d, v[0]), e1 = at(d, v[1]) - a, e2 = at(d, v[2]) - a, e3 = at(d, v[3]) - a;
  const double det = dot(e1, cross(e2, e3));
  TetrahedronModel t;
  t.v = v;
  t.m[0] = cross(e2, e3) / det, t.m[1] = cross(e3, e1) / det, t.m[2] = cross(e1, e2) / det;
  t.volume = det / 6;
  t.mu = d.youngsModulus / (2 * (1 + d.poissonRatio));
  t.lambda = d.youngsModulus * d.poissonRatio / ((1 + d.poissonRatio) * (1 - 2 * d.poissonRatio)) + t.mu;
  t.viscosity = d.viscosity;
  t.yield = d.yieldStress, t.hardening = d.hardening;
  return t;
}

std::shared_ptr<const SoftModel> cook(const TetSolidDef& d) {
  SoftModel m = startModel(d);
  for (const auto& v : d.tetrahedra) {
    m.list<TetrahedronModel>().push_back(cookTetrahedron(d, v));
    for (const int corner : v)
      m.vertices[std::size_t(corner)].mass += d.density * m.list<TetrahedronModel>().back().volume / 4;
  }
  for (SoftModel::Vertex& v : m.vertices) v.radius = d.contactRadius;
  setLengths(m, d, edgesOf(d.tetrahedra), 1);
  m.surface = boundaryOf(d.tetrahedra);
  m.collides |= kHasInside;
  addSurface(m, d, m.surface, {}, false);
  return finished(std::move(m), d);
}

MembraneModel cookMembrane(const ClothDef& d, const SoftModel& m, const std::array<int, 3>& v) {
  const Vec3 a = at(d, v[0]), e1 = at(d, v[1]) - a, e2 = at(d, v[2]) - a;
  // material axes in the plane of the rest triangle
  const Vec3 u = normalize(e1), n = normalize(cross(e1, e2)), w = cross(n, u);
  const double x1 = dot(e1, u), x2 = dot(e2, u), y2 = dot(e2, w), area = x1 * y2 / 2;
  MembraneModel t;
  t.v = v;
  t.m1[0] = 1 / x1, t.m1[1] = -x2 / (x1 * y2);
  t.m2[0] = 0, t.m2[1] = 1 / y2;
  const double mu = d.youngsModulus * d.thickness / (2 * (1 + d.poissonRatio));
  const double lambda = d.youngsModulus * d.thickness * d.poissonRatio /
                        (1 - d.poissonRatio * d.poissonRatio);
  t.stiffness[0] = area * (mu + lambda), t.stiffness[1] = area * mu;
  t.damper = area * d.thickness * d.viscosity / 2;
  t.tearStretch = d.tearStretch;
  const double m0[2] = {t.m1[0] + t.m2[0], t.m1[1] + t.m2[1]};
  const auto size2 = [](const double(&g)[2]) { return g[0] * g[0] + g[1] * g[1]; };
  const double largest2 = std::max({size2(m0), size2(t.m1), size2(t.m2)});
  t.unit = leastMass(m, d, v) / largest2;
  t.largest = std::sqrt(largest2);
  return t;
}

/// One or two triangles at an edge, with their opposite corners.
struct Hinge {
  int from = 0, to = 0;
  std::vector<int> opposite;
};
std::map<Edge, Hinge> hingesOf(const std::vector<std::array<int, 3>>& triangles) {
  std::map<Edge, Hinge> hinges;
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      Hinge& h = hinges[ordered(a, b)];
      if (h.opposite.empty()) h.from = a, h.to = b;
      h.opposite.push_back(t[(k + 2) % 3]);
    }
  return hinges;
}

double cotangent(const Vec3& a, const Vec3& b) { return dot(a, b) / length(cross(a, b)); }

void addBends(const ClothDef& d, SoftModel& m) {
  const double plate = d.youngsModulus * portable::pow(d.thickness, 3) /
                       (12 * (1 - d.poissonRatio * d.poissonRatio));
  const double kb = d.bendingStiffness.value_or(plate);
  if (!(kb > 0) && !(d.bendingDamping > 0)) return;
  for (const auto& [edge, h] : hingesOf(d.triangles)) {
    if (h.opposite.size() != 2) continue;
    const std::array<int, 4> v{h.from, h.to, h.opposite[0], h.opposite[1]};
    const Vec3 x0 = at(d, v[0]), x1 = at(d, v[1]), x2 = at(d, v[2]), x3 = at(d, v[3]);
    const Vec3 e0 = x1 - x0;
    const double q = 3 / (triangleArea(x0, x1, x2) + triangleArea(x0, x1, x3));
    if (d.restFolded) {
      const Vec3 n1 = cross(x0 - x2, x1 - x2), n2 = cross(x1 - x3, x0 - x3);
      const double angle = portable::atan2(dot(cross(n1, n2), e0) / length(e0), dot(n1, n2));
      m.list<FoldBendModel>().push_back({v, kb * q * dot(e0, e0), d.bendingDamping * length(e0), angle});
      continue;
    }
    const double c01 = cotangent(e0, x2 - x0), c02 = cotangent(e0, x3 - x0), c03 = cotangent(-e0, x2 - x1),
                 c04 = cotangent(-e0, x3 - x1);
    m.list<QuadraticBendModel<4>>().push_back({v, kb * q, {c03 + c04, c01 + c02, -c01 - c03, -c02 - c04}});
  }
}

std::shared_ptr<const SoftModel> cook(const ClothDef& d) {
  SoftModel m = startModel(d);
  for (const auto& t : d.triangles) {
    const double mass = d.density * d.thickness * triangleArea(at(d, t[0]), at(d, t[1]), at(d, t[2]));
    for (const int v : t) m.vertices[std::size_t(v)].mass += mass / 3;
  }
  for (const auto& t : d.triangles) m.list<MembraneModel>().push_back(cookMembrane(d, m, t));
  addBends(d, m);
  for (SoftModel::Vertex& v : m.vertices) v.radius = d.thickness / 2;
  setLengths(m, d, edgesOf(d.triangles), 1);
  m.surface = d.triangles;
  if (d.pressure != 0) {
    for (const auto& t : d.triangles) m.list<PressureModel>().push_back({t, d.pressure});
    m.collides |= kHasInside;
  }
  addSurface(m, d, d.triangles, {}, true);
  return finished(std::move(m), d);
}

std::shared_ptr<const SoftModel> cook(const CableDef& d) {
  SoftModel m = startModel(d);
  const int n = int(d.vertices.size()), segments = d.closed ? n : n - 1;
  const double area = std::numbers::pi * d.radius * d.radius, inertia = area * d.radius * d.radius / 4;
  std::vector<Edge> edges;
  for (int i = 0; i < segments; ++i) edges.emplace_back(i, (i + 1) % n);
  const auto lengthOf = [&](const Edge& e) { return length(at(d, e.first) - at(d, e.second)); };
  for (const Edge& e : edges)
    for (const int v : {e.first, e.second})
      m.vertices[std::size_t(v)].mass += d.density * area * lengthOf(e) / 2;
  for (const Edge& e : edges) {
    const double l = lengthOf(e);
    m.list<SpringModel>().push_back({{e.first, e.second},
                                     d.youngsModulus * area / l,
                                     d.viscosity * area / l,
                                     l,
                                     d.breakForce,
                                     leastMass(m, d, std::array<int, 2>{e.first, e.second})});
  }
  for (int i = d.closed ? 0 : 1; i < segments; ++i) {
    const Edge &before = edges[std::size_t((i + segments - 1) % segments)], &after = edges[std::size_t(i)];
    const double a = lengthOf(before), b = lengthOf(after), mean = (a + b) / 2;
    m.list<QuadraticBendModel<3>>().push_back({{after.first, before.first, after.second},
                                               d.youngsModulus * inertia / (mean * mean * mean),
                                               {-mean * (1 / a + 1 / b), mean / a, mean / b}});
  }
  for (SoftModel::Vertex& v : m.vertices) v.radius = d.radius;
  setLengths(m, d, edges, 1);
  addSurface(m, d, {}, edges, true);
  return finished(std::move(m), d);
}

std::shared_ptr<const SoftModel> cook(const NetDef& d) {
  SoftModel m = startModel(d);
  for (std::size_t v = 0; v < m.vertices.size(); ++v) {
    m.vertices[v].mass = d.masses[d.masses.size() == 1 ? 0 : v];
    m.vertices[v].radius = d.contactRadius;
  }
  std::vector<Edge> edges;
  for (const NetDef::Edge& e : d.edges) {
    edges.emplace_back(e.a, e.b);
    const double rest = e.restLength >= 0 ? e.restLength : length(at(d, e.a) - at(d, e.b));
    m.list<SpringModel>().push_back({{e.a, e.b},
                                     e.stiffness,
                                     e.damping,
                                     rest,
                                     d.breakForce,
                                     leastMass(m, d, std::array<int, 2>{e.a, e.b})});
  }
  setLengths(m, d, edges, d.contactRadius > 0 ? 2 * d.contactRadius : 1);
  m.surface = d.triangles;
  addSurface(m, d, d.triangles, {}, false);
  return finished(std::move(m), d);
}

std::shared_ptr<const SoftModel> cook(const ParticlesDef& d) {
  SoftModel m = startModel(d);
  const double mass = d.density * 4 / 3 * std::numbers::pi * portable::pow(d.radius, 3);
  for (SoftModel::Vertex& v : m.vertices) v.mass = mass, v.radius = d.radius, v.length = 2 * d.radius;
  m.collides |= kCollidesWithParticles;
  m.surfaceRadius = d.radius;
  return finished(std::move(m), d);
}

}  // namespace

std::shared_ptr<const SoftModel> cookDeformable(const Deformable& def, const Path& path) {
  validate(def, path);
  return std::visit([](const auto& d) { return cook(d); }, def);
}

}  // namespace rubble

#include <algorithm>
#include <map>

#include <rubble/deformables.h>
#include <rubble/error.h>

#include "cook/checks.h"
#include "forces/element_kind.h"

namespace rubble {

namespace {

using namespace checks;

void ratio(double a, double least, const Path& path) {
  if (!(a > least && a < .5) && !(a == least && least == 0))
    throw Error(path, "a number from " + text(least) + " to below .5", text(a));
}

/// Indices must be valid and distinct.
template <class Corners> void corners(const DeformableDef& d, const Corners& c, const Path& path) {
  for (const int v : c)
    if (v < 0 || std::size_t(v) >= d.vertices.size())
      throw Error(path, "indices below " + std::to_string(d.vertices.size()), std::to_string(v));
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = i + 1; j < c.size(); ++j)
      if (c[i] == c[j]) throw Error(path, "different vertices", "vertex " + std::to_string(c[i]) + " twice");
}

void checkElement(const DeformableDef& d, const ElementDef& e, const Path& path) {
  const ElementKind* const kind = findElementKind(e.type);
  if (!kind) throw Error(path + ".type", "the keyword of an element type", "\"" + e.type + "\"");
  if (e.vertices.size() != static_cast<std::size_t>(kind->corners))
    throw Error(path + ".vertices", std::to_string(kind->corners) + " vertices",
                std::to_string(e.vertices.size()));
  corners(d, e.vertices, path + ".vertices");
  if (!kind->hasFields(e)) throw Error(path + ".fields", "those of a " + e.type, "others");
  for (const ElementField& info : kind->fields)
    info.visit(e, [&](const auto& value) { checks::field(info, value, path); });
}

void checkCommon(const DeformableDef& d, std::size_t least, const Path& path) {
  if (d.vertices.size() < least)
    throw Error(path + ".vertices", "at least " + std::to_string(least), std::to_string(d.vertices.size()));
  finite(d.vertices, path + ".vertices");
  if (!d.start.empty() && d.start.size() != d.vertices.size())
    throw Error(path + ".start", "as many positions as vertices, " + std::to_string(d.vertices.size()),
                std::to_string(d.start.size()));
  finite(d.start, path + ".start");
  for (std::size_t i = 0; i < d.fixed.size(); ++i)
    corners(d, std::array<int, 1>{d.fixed[i]}, (path + ".fixed")[i]);
  finite(d.velocity, path + ".velocity");
  finite(d.angularVelocity, path + ".angularVelocity");
  const Material& m = d.material;
  checks::material(m, path + ".material");
  const auto none = [&](double a, const char* name, const char* why) {
    if (a != 0) throw Error(path + ".material." + name, why, text(a));
  };
  none(m.rollingFriction, "rollingFriction", "0: vertices do not turn");
  none(m.torsionalFriction, "torsionalFriction", "0: vertices do not turn");
  none(length(m.surfaceVelocity), "surfaceVelocity",
       "none: only the surfaces of bodies move along themselves");
  none(length(m.oneWay), "oneWay", "none: only bodies have one-way surfaces");
  finite(d.gravityScale, path + ".gravityScale");
  for (std::size_t i = 0; i < d.elements.size(); ++i) checkElement(d, d.elements[i], (path + ".elements")[i]);
}

/// Every vertex must have mass, so each must be a corner of an element.
void allUsed(const std::vector<bool>& used, const Path& path, const char* of) {
  const auto it = std::find(used.begin(), used.end(), false);
  if (it != used.end())
    throw Error((path + ".vertices")[std::size_t(it - used.begin())], std::string("a corner of a ") + of,
                "a vertex of none");
}

/// Volumes (areas) below this share of the cubed (squared) longest edge count as zero.
constexpr double kDegenerate = 1e-9;

void check(const TetSolidDef& d, const Path& path) {
  checkCommon(d, 4, path);
  positive(d.youngsModulus, path + ".youngsModulus");
  ratio(d.poissonRatio, 0, path + ".poissonRatio");
  positive(d.density, path + ".density");
  notNegative(d.viscosity, path + ".viscosity");
  positiveOrInfinite(d.yieldStress, path + ".yieldStress");
  notNegative(d.hardening, path + ".hardening");
  notNegative(d.contactRadius, path + ".contactRadius");
  if (d.tetrahedra.empty()) throw Error(path + ".tetrahedra", "at least one", "none");
  std::vector<bool> used(d.vertices.size());
  std::map<std::array<int, 3>, int> faces;
  for (std::size_t i = 0; i < d.tetrahedra.size(); ++i) {
    const auto& t = d.tetrahedra[i];
    const Path list = path + ".tetrahedra", here = list[i];
    corners(d, t, here);
    Vec3 x[4];
    for (std::size_t k = 0; k < 4; ++k) x[k] = d.vertices[std::size_t(t[k])], used[std::size_t(t[k])] = true;
    double longest = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) longest = std::max(longest, length(x[a] - x[b]));
    const double volume = dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])) / 6;
    if (!(volume > kDegenerate * longest * longest * longest))
      throw Error(here, "a positive volume",
                  volume < 0 ? "an inverted tetrahedron of volume " + text(volume) + " m3" : "a flat one");
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<int, 3> f{t[(k + 1) % 4], t[(k + 2) % 4], t[(k + 3) % 4]};
      std::sort(f.begin(), f.end());
      if (++faces[f] > 2)
        throw Error(here, "faces that at most two tetrahedra share", "a third one on a face");
    }
  }
  allUsed(used, path, "tetrahedron");
}

void checkTriangles(const DeformableDef& d, const std::vector<std::array<int, 3>>& triangles,
                    const Path& path, std::vector<bool>& used) {
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& t = triangles[i];
    const Path list = path + ".triangles", here = list[i];
    corners(d, t, here);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      used[std::size_t(a)] = true;
      longest = std::max(longest, length(d.vertices[std::size_t(a)] - d.vertices[std::size_t(b)]));
      if (++edges[{std::min(a, b), std::max(a, b)}] > 2)
        throw Error(here, "edges that at most two triangles share", "a third one on an edge");
    }
    const Vec3 a = d.vertices[std::size_t(t[0])], b = d.vertices[std::size_t(t[1])],
               c = d.vertices[std::size_t(t[2])];
    if (!(length(cross(b - a, c - a)) > kDegenerate * longest * longest))
      throw Error(here, "a positive area", "zero");
  }
}

/// Pressure requires a closed sheet: two triangles of opposite direction at every edge, and a positive
/// volume.
void checkClosed(const ClothDef& d, const Path& path) {
  std::map<std::pair<int, int>, std::size_t> ways;
  for (std::size_t i = 0; i < d.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [way, isNew] = ways.emplace(std::pair{d.triangles[i][k], d.triangles[i][(k + 1) % 3]}, i);
      if (!isNew)
        throw Error((path + ".triangles")[i], "neighbors that are turned the same way, beside a pressure",
                    "one that is turned over");
    }
  double volume = 0;
  for (const auto& [way, i] : ways) {
    if (!ways.contains({way.second, way.first}))
      throw Error(
          (path + ".triangles")[i], "a closed sheet beside a pressure",
          "a rim between vertices " + std::to_string(way.first) + " and " + std::to_string(way.second));
  }
  const Vec3 origin = d.vertices[0];
  for (const auto& t : d.triangles)
    volume += dot(d.vertices[std::size_t(t[0])] - origin,
                  cross(d.vertices[std::size_t(t[1])] - origin, d.vertices[std::size_t(t[2])] - origin)) /
              6;
  if (!(volume > 0))
    throw Error(path + ".triangles", "corners counter-clockwise seen from outside, beside a pressure",
                "a volume of " + text(volume) + " m3");
}

void check(const ClothDef& d, const Path& path) {
  checkCommon(d, 3, path);
  positive(d.thickness, path + ".thickness");
  positive(d.youngsModulus, path + ".youngsModulus");
  ratio(d.poissonRatio, -1, path + ".poissonRatio");
  positive(d.density, path + ".density");
  notNegative(d.viscosity, path + ".viscosity");
  if (d.bendingStiffness) notNegative(*d.bendingStiffness, path + ".bendingStiffness");
  notNegative(d.bendingDamping, path + ".bendingDamping");
  if (d.bendingDamping > 0 && !d.restFolded)
    throw Error(path + ".bendingDamping", "restFolded with it", "a flat rest shape");
  if (!(d.tearStretch > 1))
    throw Error(path + ".tearStretch", "a number above 1 or infinity", text(d.tearStretch));
  if (d.triangles.empty()) throw Error(path + ".triangles", "at least one", "none");
  std::vector<bool> used(d.vertices.size());
  checkTriangles(d, d.triangles, path, used);
  allUsed(used, path, "triangle");
  finite(d.pressure, path + ".pressure");
  if (d.pressure == 0) return;
  if (d.tearStretch < kUnbreakable)
    throw Error(path + ".tearStretch", "none beside a pressure: what is torn does not hold it",
                text(d.tearStretch));
  checkClosed(d, path);
}

void check(const CableDef& d, const Path& path) {
  checkCommon(d, d.closed ? 3 : 2, path);
  positive(d.radius, path + ".radius");
  positive(d.youngsModulus, path + ".youngsModulus");
  positive(d.density, path + ".density");
  notNegative(d.viscosity, path + ".viscosity");
  positiveOrInfinite(d.breakForce, path + ".breakForce");
  const std::size_t n = d.vertices.size();
  for (std::size_t i = 0; i + (d.closed ? 0 : 1) < n; ++i)
    if (!(length(d.vertices[(i + 1) % n] - d.vertices[i]) > 0))
      throw Error((path + ".vertices")[i], "another place than the next vertex", "the same");
}

void check(const NetDef& d, const Path& path) {
  checkCommon(d, 1, path);
  if (d.masses.size() != 1 && d.masses.size() != d.vertices.size())
    throw Error(path + ".masses", "one, or as many as vertices, " + std::to_string(d.vertices.size()),
                std::to_string(d.masses.size()));
  for (std::size_t i = 0; i < d.masses.size(); ++i) positive(d.masses[i], (path + ".masses")[i]);
  notNegative(d.contactRadius, path + ".contactRadius");
  positiveOrInfinite(d.breakForce, path + ".breakForce");
  for (std::size_t i = 0; i < d.edges.size(); ++i) {
    const NetDef::Edge& e = d.edges[i];
    const Path list = path + ".edges", here = list[i];
    corners(d, std::array<int, 2>{e.a, e.b}, here);
    positive(e.stiffness, here + ".stiffness");
    notNegative(e.damping, here + ".damping");
    finite(e.restLength, here + ".restLength");
    if (e.restLength < 0 && !(length(d.vertices[std::size_t(e.a)] - d.vertices[std::size_t(e.b)]) > 0))
      throw Error(here, "two places, or a rest length", "two vertices at one place");
  }
  std::vector<bool> used(d.vertices.size());
  checkTriangles(d, d.triangles, path, used);
}

void check(const ParticlesDef& d, const Path& path) {
  checkCommon(d, 1, path);
  positive(d.radius, path + ".radius");
  positive(d.density, path + ".density");
}

}  // namespace

void validate(const Deformable& deformable, const Path& path) {
  std::visit([&](const auto& d) { check(d, path); }, deformable);
}

}  // namespace rubble

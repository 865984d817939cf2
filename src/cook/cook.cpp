#include "cook/cook.h"

#include <rubble/error.h>

#include <algorithm>
#include <cmath>

#include "cook/hull.h"
#include "cook/rounded_mass.h"
#include "cook/shape_traits.h"
#include "cook/solid_mass.h"

namespace rubble {

namespace cooking {

int beginHeader(CookedShape& out, int size) {
  const int header = static_cast<int>(out.indices.size());
  out.indices.resize(out.indices.size() + static_cast<std::size_t>(size));
  out.indices[static_cast<std::size_t>(header)] = static_cast<int>(out.vectors.size());
  out.indices[static_cast<std::size_t>(header) + 1] = header + size;
  out.vectorPlaces.push_back(header);
  out.indexPlaces.push_back(header + 1);
  return header;
}

void addHull(CookedShape& out, const Shape& shape, const Path& path) {
  constexpr std::size_t kMostVertices = 256;
  const Hull hull = convexHull(shape.geometry->points, path + ".points");
  if (hull.vertices.size() > kMostVertices)
    throw Error(path + ".points", "a hull of at most " + std::to_string(kMostVertices) + " corners",
                std::to_string(hull.vertices.size()));
  out.unit = principal(roundedSums(hull, shape.rounding));
  const int header = beginHeader(out, 4);
  out.indices[static_cast<std::size_t>(header) + 2] = static_cast<int>(hull.vertices.size());
  out.indices[static_cast<std::size_t>(header) + 3] = static_cast<int>(hull.faces.size());
  out.shape = {ShapeKind::Hull, {}, shape.rounding, header};
  std::vector<Vec3> local;
  for (const Vec3& v : hull.vertices) {
    const Vec3 x = rotateInverse(out.unit.axes, v - out.unit.center);
    local.push_back(x);
    out.vectors.push_back({x.x, x.y, x.z, 0});
    for (int i = 0; i < 3; ++i) out.shape.half[i] = std::max(out.shape.half[i], std::fabs(x[i]));
    out.radius = std::max(out.radius, length(x) + shape.rounding);
  }
  int corners = 0;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Vec3 n = rotateInverse(out.unit.axes, hull.normals[f]);
    double offset = -1e300;
    for (const int v : hull.faces[f]) offset = std::max(offset, dot(n, local[static_cast<std::size_t>(v)]));
    out.vectors.push_back({n.x, n.y, n.z, offset});
    out.indices.push_back(corners);
    corners += static_cast<int>(hull.faces[f].size());
  }
  out.indices.push_back(corners);
  for (const std::vector<int>& face : hull.faces)
    out.indices.insert(out.indices.end(), face.begin(), face.end());
}

void addCompound(CookedShape& out, const Shape& shape, const Path& path) {
  const std::vector<ShapePartDef>& parts = shape.geometry->parts;
  const Path list = path + ".parts";
  std::vector<CookedShape> cooked;
  SolidSums sums;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const CookedShape& part = cooked.emplace_back(cook(parts[i].shape, list[i] + ".shape"));
    sums += placed(sumsOf(part.unit), parts[i].position, normalize(parts[i].orientation), parts[i].density);
  }
  out.unit = principal(sums);
  if (shape.geometry->mass) {
    out.unit = *shape.geometry->mass;
    out.unit.axes = normalize(out.unit.axes);
  }
  const int header = beginHeader(out, 4);
  out.indices[static_cast<std::size_t>(header) + 2] = 0;
  out.indices[static_cast<std::size_t>(header) + 3] = static_cast<int>(parts.size());
  out.partPlaces.push_back(header + 2);
  out.shape = {ShapeKind::Compound, {}, 0, header};
  const Quat back = conjugate(out.unit.axes);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    CookedShape& part = cooked[i];
    const Quat q = normalize(parts[i].orientation);
    CookedPart incidence;
    incidence.shape = part.shape;
    incidence.position = rotate(back, parts[i].position + rotate(q, part.unit.center) - out.unit.center);
    incidence.rotation = normalize(back * q * part.unit.axes);
    incidence.radius = part.radius;
    incidence.material = parts[i].material;
    // appends its tables to the existing ones
    const int vectors = static_cast<int>(out.vectors.size()), indices = static_cast<int>(out.indices.size());
    for (const int place : part.vectorPlaces)
      part.indices[static_cast<std::size_t>(place)] += vectors, out.vectorPlaces.push_back(place + indices);
    for (const int place : part.indexPlaces)
      part.indices[static_cast<std::size_t>(place)] += indices, out.indexPlaces.push_back(place + indices);
    if (incidence.shape.data >= 0) incidence.shape.data += indices;
    out.vectors.insert(out.vectors.end(), part.vectors.begin(), part.vectors.end());
    out.indices.insert(out.indices.end(), part.indices.begin(), part.indices.end());

    const Mat3 r = rotationMatrix(incidence.rotation);
    const Vec3& h = part.shape.half;
    const double extra = part.shape.radius;
    const Vec3 reach = abs(r.c0) * h.x + abs(r.c1) * h.y + abs(r.c2) * h.z + Vec3{extra, extra, extra};
    for (int k = 0; k < 3; ++k)
      out.shape.half[k] = std::max(out.shape.half[k], std::fabs(incidence.position[k]) + reach[k]);
    out.radius = std::max(out.radius, length(incidence.position) + part.radius);
    out.parts.push_back(incidence);
  }
}

}  // namespace cooking

CookedShape cook(const Shape& shape, const Path& path) {
  validate(shape, path);
  CookedShape out;
  traitsOf(shape.type).cook(out, shape, path);
  return out;
}

}  // namespace rubble

#include <rubble/error.h>

#include <algorithm>
#include <cmath>

#include "cook/cook.h"
#include "cook/distance_surface.h"
#include "cook/halving.h"
#include "cook/solid_mass.h"

namespace rubble::cooking {

namespace {

/// Samples per cell edge for the inside test.
constexpr int kProbes = 4;

SolidSums insideOf(const ShapeGeometry& g) {
  SolidSums sums;
  const Vec3 half = g.spacing * (.5 / kProbes);
  const SolidSums piece = boxSums(half);
  for (int k = 0; k < (g.counts[2] - 1) * kProbes; ++k)
    for (int j = 0; j < (g.counts[1] - 1) * kProbes; ++j)
      for (int i = 0; i < (g.counts[0] - 1) * kProbes; ++i) {
        const Vec3 x = g.origin + Vec3{(2 * i + 1) * half.x, (2 * j + 1) * half.y, (2 * k + 1) * half.z};
        const double d = distanceAt(g, x);
        // share of the sample cell that is inside, with the surface as a plane
        const double share = std::clamp(.5 - d / (2 * half.x), 0.0, 1.0);
        if (share > 0) sums += placed(piece, x, Quat{}, share);
      }
  return sums;
}

}  // namespace

void addDistanceField(CookedShape& out, const Shape& shape, const Path& path) {
  const ShapeGeometry& g = *shape.geometry;
  const std::size_t count = g.samples.size();
  const ShapeMesh surface = distanceSurface(g);
  if (surface.triangles.empty())
    throw Error(path + ".distances", "a surface of distance 0 within the lattice", "none");
  out.unit = principal(insideOf(g));
  if (!(out.unit.mass > 0)) throw Error(path + ".distances", "something inside", "nothing");

  const int header = beginHeader(out, 6);
  for (std::size_t i = 0; i < 3; ++i) out.indices[static_cast<std::size_t>(header) + 2 + i] = g.counts[i];
  out.indices[static_cast<std::size_t>(header) + 5] = static_cast<int>(surface.points.size());
  out.shape.kind = ShapeKind::Distance;
  out.shape.data = header;
  // pose of the lattice in the engine frame
  const Quat back = conjugate(out.unit.axes);
  const Vec3 first = rotate(back, g.origin - out.unit.center);
  out.vectors.push_back({first.x, first.y, first.z, g.spacing.x});
  out.vectors.push_back({back.v.x, back.v.y, back.v.z, back.s});
  for (std::size_t k = 0; k < count; k += 4) {
    const auto sample = [&](std::size_t i) { return i < count ? g.samples[i] : 0.0; };
    out.vectors.push_back({sample(k), sample(k + 1), sample(k + 2), sample(k + 3)});
  }
  for (const int k : nearOrder(surface.points)) {
    const Vec3 x = rotate(back, surface.points[static_cast<std::size_t>(k)] - out.unit.center);
    out.vectors.push_back({x.x, x.y, x.z, 0});
    for (int i = 0; i < 3; ++i) out.shape.half[i] = std::max(out.shape.half[i], std::fabs(x[i]));
    out.radius = std::max(out.radius, length(x));
  }
}

}  // namespace rubble::cooking

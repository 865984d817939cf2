#include "cook/shape_mesh.h"
#include "cook/shape_traits.h"
#include "cook/solid_mass.h"

namespace rubble {

MassProperties massInside(const Shape& shape, double density, bool symmetric) {
  constexpr int kSegments = 96;
  const ShapeMesh mesh = shapeMesh(shape, kSegments);
  SolidSums sums;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(t[k])]; };
    sums += tetrahedronSums(at(0), at(1), at(2));
  }
  if (symmetric) {
    sums.first = {};
    for (std::size_t i = 3; i < 6; ++i) sums.second[i] = 0;
  }
  return principal(placed(sums, {}, Quat{}, density));
}

}  // namespace rubble

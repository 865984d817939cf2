#include "convert/mesh/corners.h"

#include <cmath>
#include <numbers>
#include <set>

#include "cook/hull.h"

namespace rubble::convert {

std::vector<Vec3> directions(int count) {
  std::vector<Vec3> out{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  // a spiral of the golden angle
  const double angle = std::numbers::pi * (3 - std::sqrt(5.));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1) / static_cast<double>(count), r = std::sqrt(1 - z * z);
    out.push_back({r * std::cos(angle * i), r * std::sin(angle * i), z});
  }
  return out;
}

std::vector<Vec3> cornersOf(const std::vector<Vec3>& points, bool& reduced, const std::string& path) {
  const std::vector<Vec3> corners = convexHull(points, path).vertices;
  reduced = corners.size() > kMostCorners;
  if (!reduced) return corners;
  std::set<std::size_t> kept;
  for (const Vec3& d : directions(static_cast<int>(kMostCorners) - 6)) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < corners.size(); ++i)
      if (dot(corners[i], d) > dot(corners[best], d)) best = i;
    kept.insert(best);
  }
  std::vector<Vec3> out;
  for (const std::size_t i : kept) out.push_back(corners[i]);
  return out;
}

}  // namespace rubble::convert

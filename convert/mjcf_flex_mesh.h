#pragma once
/// Points and elements of <flexcomp>.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "convert/tag.h"

namespace rubble::convert {

constexpr int kMostFlexPoints = 200000;

struct FlexMesh {
  int dimension = 2;
  std::vector<Vec3> points;
  std::vector<int> corners;            ///< dimension + 1 for each element
  std::array<int, 3> counts{0, 1, 1};  ///< of a grid

  const Vec3& corner(std::size_t k) const { return points[static_cast<std::size_t>(corners[k])]; }
  /// Length, area or volume of the element whose corners begin at k; a volume may be negative.
  double sizeOf(std::size_t k) const;
};

/// What MuJoCo generates for a type, in its order: grid, circle, square, disc, box, cylinder, ellipsoid;
/// nothing for other types. `dimension` is that of the file.
std::optional<FlexMesh> generatedFlex(const Tag& tag, const std::string& type, std::optional<int> dimension);
/// Points and elements that are written in the file.
FlexMesh writtenFlex(const Tag& tag, int dimension);

}  // namespace rubble::convert

#pragma once
/// What can be seen of a scene from somewhere, by rays.
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "io/picture.h"

namespace rubble::render {

/// Bodies that do not move freely, as walls between an eye and those that do.
class Sightlines {
 public:
  /// Walls are those of the first moment. Looks for up to `targets` of the bodies that move, in the first,
  /// the middle and the last moment.
  explicit Sightlines(std::span<const std::vector<io::PictureBody>> moments, int targets = 48);

  struct View {
    double visible = 1;                   ///< share of the targets that no wall hides
    std::map<std::uint32_t, int> hiding;  ///< number of targets that a wall hides, by its key
  };
  View from(const Vec3& eye);
  void removeWall(std::uint32_t key);

 private:
  std::vector<std::uint32_t> keys_;  ///< of the walls
  World world_;
  std::vector<Vec3> targets_;
};

}  // namespace rubble::render

#pragma once
/// Drawn parts in the place of bodies.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <rubble/appearance.h>

#include "io/picture.h"

namespace rubble::io {

/// Puts drawn parts in the place of bodies.
class LookTable {
 public:
  LookTable() = default;
  /// `atStart`: bodies of the scene as it begins. Looks are those of bodies that keep key and shape.
  LookTable(std::vector<Look> looks, std::span<const PictureBody> atStart);

  bool empty() const { return looks_.empty(); }
  /// Parts have the key, speed and value of their body. Those of the world come first. Stands of
  /// hinges, which are made up, are left out where any body has a look.
  std::vector<PictureBody> applied(std::span<const PictureBody> bodies) const;

 private:
  struct Known {
    Shape shape;  ///< of the body
    std::size_t look;
  };
  std::vector<Look> looks_;
  std::vector<std::pair<std::uint32_t, Known>> known_;  ///< by key, in ascending order
};
/// Key of parts of the world: above those of bodies and stands, below those of deformable objects.
inline constexpr std::uint32_t kSceneryKey = kSoftKeys - 1;

}  // namespace rubble::io

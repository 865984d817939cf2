#pragma once
/// Cameras that show everything.
#include <span>

#include "io/picture.h"
#include "render/camera.h"

namespace rubble::render {

struct Framing {
  Vec3 direction;           ///< from the eye on; zero: from the side and a little above
  double spread = 0;        ///< room on every side for what may fall there, over the height of what stands
  double aspect = 16. / 9;  ///< width of the picture over its height
  double fieldOfView = .6;  ///< full vertical angle [rad]
  double closer = 1;        ///< distance over that from which everything is seen [1]
};

/// A camera that sees all bodies but planes. Up is against gravity.
Camera cameraShowing(std::span<const io::PictureBody> bodies, const Vec3& gravity,
                     const Framing& framing = {});

}  // namespace rubble::render

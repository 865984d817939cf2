#pragma once
/// How a scene looks where the renderer is not to choose: drawn parts of bodies, their colors, the sun and
/// cameras. None of it has an effect on the motion.
#include <optional>
#include <string>
#include <vector>

#include <rubble/scene.h>

namespace rubble {

/// A drawn part of a body.
struct LookPart {
  Shape shape;                     ///< of any type, on any body
  Vec3 position;                   ///< of the part in the frame of the body [m]
  Quat orientation;                ///< part -> body
  std::optional<Vec3> color = {};  ///< red, green, blue, 0 to 1 (sRGB); none: the renderer chooses
};

/// All that is drawn of a body, in place of its shape.
struct Look {
  int body = kWorld;  ///< index into Scene::bodies; kWorld: parts that stand still in the world
  std::vector<LookPart> parts;
};

/// A view with a name. Up is against gravity.
struct NamedCamera {
  std::string name;
  Vec3 eye, target;                        ///< world [m]
  std::optional<double> fieldOfView = {};  ///< vertical [rad]; none: the renderer chooses
};

struct Appearance {
  std::vector<Look> looks;           ///< at most one for each body
  std::optional<Vec3> toSun;         ///< unit direction to the sun, world; none: the renderer chooses
  std::vector<NamedCamera> cameras;  ///< by different names
};

}  // namespace rubble

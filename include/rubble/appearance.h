#pragma once
/// How a scene looks where the renderer is not to choose: drawn parts of bodies, their colors, lights and
/// cameras. None of it has an effect on the motion.
#include <cstddef>
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

/// Light from all directions: the sun, and the sky about it.
struct Daylight {
  std::optional<Vec3> toSun;  ///< unit direction to the sun, world; none: the renderer chooses
  Vec3 sunColor{1, 1, 1};     ///< factor on the color of sunlight, 0 to 1 (sRGB)
  double sunStrength = 1;     ///< factor on sunlight [1]; 0: no sun
  double skyStrength = 1;     ///< factor on the sky and on the light that comes from all around [1]
};

/// A lamp without size and shadow. At a distance d it lights what faces it as `intensity` / d^2 suns of
/// strength 1 do.
struct PointLight {
  Vec3 position;         ///< world [m]
  Vec3 color{1, 1, 1};   ///< red, green, blue, 0 to 1 (sRGB)
  double intensity = 1;  ///< [m2]
};
/// What the shader of the renderer has room for.
inline constexpr std::size_t kMostPointLights = 16;

struct Appearance {
  std::vector<Look> looks;  ///< at most one for each body
  Daylight daylight;
  std::vector<PointLight> lights;    ///< at most kMostPointLights
  std::vector<NamedCamera> cameras;  ///< by different names
};

}  // namespace rubble

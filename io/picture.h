#pragma once
/// Pictures of a world, drawn on the CPU: perspective, sun and sky light, a soft shadow, ambient occlusion, four samples a pixel.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rubble/scene.h>
#include <rubble/world.h>

namespace rubble::io {

/// A body as it is drawn.
struct PictureBody {
  Shape shape;
  Vec3 position;          ///< world [m]
  Quat orientation;       ///< body -> world
  double speed = 0;       ///< [m/s]
  std::uint32_t key = 0;  ///< picks the colour; stays with the body
  Motion motion = Motion::Dynamic;
  bool deforms = false;   ///< a mesh that is another one in every frame; those stand behind all others in a list
};
/// Keys from here on are of deformable objects.
inline constexpr std::uint32_t kSoftKeys = 1u << 31;
/// Below these bits of such a key: the number of the vertex; above: that of the object.
inline constexpr int kSoftKeyBits = 22;

enum class ColorBy { Body, Speed };

struct PictureSettings {
  int width = 1280, height = 720;
  Vec3 eye{8, -12, 6}, target{0, 0, 1};  ///< [m]
  Vec3 up{0, 0, 1};                      ///< any length; need not be square to the view
  double fieldOfView = .6;               ///< full vertical angle [rad]
  ColorBy colorBy = ColorBy::Body;
  double fullSpeed = 0;  ///< speed drawn in the hottest colour [m/s]; 0: the fastest body
};

/// Rows from the top, three bytes (red, green, blue; sRGB) a pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Draws the bodies. Throws Error for settings that give no picture (no size, eye at target, up along the view).
Image drawPicture(std::span<const PictureBody> bodies, const PictureSettings& settings);

/// Every body of a world as it is now, then its deformable objects: a sphere for each particle, a mesh for each of the others.
std::vector<PictureBody> pictureBodies(const World& world);
/// The same of a scene as it begins; also the bodies that events add, if `withEvents`.
std::vector<PictureBody> pictureBodies(const Scene& scene, bool withEvents = false);

/// The deformable objects of a world as they are now, or of a scene as they begin.
void addDeformables(const World& world, std::vector<PictureBody>& bodies);
void addDeformables(const Scene& scene, std::vector<PictureBody>& bodies);

/// What frameBodies leaves room for and where it looks along.
struct Framing {
  Vec3 direction;     ///< from the eye on; zero: from the side and a little above
  double spread = 0;  ///< room on every side for what may fall there, over the height of what stands
};

/// Sets eye, target and up so that all the bodies that are not planes are seen. Up is against gravity.
void frameBodies(std::span<const PictureBody> bodies, const Vec3& gravity, PictureSettings& settings, const Framing& framing = {});

/// Throws Error if the file cannot be written.
void writePng(const Image& image, const std::string& file);

}  // namespace rubble::io

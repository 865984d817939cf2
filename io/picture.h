#pragma once
/// Bodies and surfaces to draw of a world, a scene or a recording, and pictures as files. render/ draws them.
#include <array>
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
  std::uint32_t key = 0;  ///< picks the color; stays with the body
  Motion motion = Motion::Dynamic;
  bool deforms = false;  ///< a mesh that is another one in every frame; those stand behind all others in a
                         ///< list
  double value = 0;      ///< quantity shown by colors (picture_values.h); NaN: none
  std::vector<float> vertexValues =
      {};                          ///< likewise, of the points of a mesh that deforms; empty: `value` for all
  std::optional<Vec3> color = {};  ///< red, green, blue, 0 to 1 (sRGB); none: the renderer chooses
  bool isWheel = false;            ///< its shape is that of a wheel with teeth (drawMachines)
};
/// The same geometry, in the same sizes?
bool sameShape(const Shape& a, const Shape& b);
/// Keys from here on are of deformable objects.
inline constexpr std::uint32_t kSoftKeys = 1u << 31;
/// Below these bits of such a key: the number of the vertex; above: that of the object.
inline constexpr int kSoftKeyBits = 22;

/// Quantity shown by colors (picture_values.h). A recording has Body and Speed, a world has all.
enum class ColorBy { Body, Material, Speed, Island, Color, Error, Multiplier, Stiffness, Strain };

/// Rows from the top, three bytes (red, green, blue; sRGB) a pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> alpha =
      {};  ///< a byte a pixel, of colors that are not multiplied by it; may be empty
};

/// Every body of a world as it is now, then its deformable objects: a sphere for each particle, a mesh for
/// each of the others. Values are those of `colorBy`.
std::vector<PictureBody> pictureBodies(const World& world, ColorBy colorBy = ColorBy::Body);
/// The same of a scene as it begins; also the bodies that events add, if `withEvents`.
std::vector<PictureBody> pictureBodies(const Scene& scene, bool withEvents = false);

/// Ropes, rods and springs between bodies, as joints of these types are: one mesh of tubes for all of them.
void addRopes(const World& world, std::vector<PictureBody>& bodies);
/// Does a world have some?
bool hasRopes(const World& world);
/// Keys of stands of hinges: above those of bodies, below those of deformable objects.
inline constexpr std::uint32_t kStandKeys = 1u << 30;
/// Key of that mesh.
inline constexpr std::uint32_t kRopeKey = ~0u;
/// A tube from a to b with closed ends, added to a mesh [m].
void addTube(const Vec3& a, const Vec3& b, double radius, std::vector<Vec3>& points,
             std::vector<std::array<int, 3>>& triangles);

/// Draws wheels of gears and racks with teeth, and adds stands of hinges to the world, which are static and
/// have keys that no body has. `bodies`: those of the world, in the order of World::bodies().
void drawMachines(const World& world, std::vector<PictureBody>& bodies);
/// Does a world have some? Large worlds have none.
bool hasMachines(const World& world);

/// The deformable objects of a world as they are now, or of a scene as they begin.
void addDeformables(const World& world, std::vector<PictureBody>& bodies, ColorBy colorBy = ColorBy::Body);
void addDeformables(const Scene& scene, std::vector<PictureBody>& bodies);
/// The drawn parts of a deformable object.
struct DrawnSoft {
  std::uint32_t number;          ///< of the object
  std::vector<Vec3> vertices;    ///< [m]
  std::vector<Vec3> velocities;  ///< [m/s]
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> segments;
  double radius;  ///< [m]
  bool spheres, solid;
  std::vector<float> values = {};  ///< of the vertices; may be empty
};
void addDeformables(std::span<const DrawnSoft> objects, std::vector<PictureBody>& bodies);

/// Half size of the median moving body, or a tenth of that of a deformable object where there are no bodies
/// [m].
double typicalSize(std::span<const PictureBody> bodies);
/// How far a body reaches from its position along an axis of the world, at most [m].
double extentAlong(const PictureBody& body, const Vec3& axis);

/// Radius of a sphere about a shape's origin that holds it [m]; 0 for a plane.
double boundingRadius(const Shape& shape);

/// Throws Error if the file cannot be written.
void writePng(const Image& image, const std::string& file);
/// Reads a picture of at most 2^26 pixels, with its alpha. Throws Error if it cannot be read.
Image readPng(const std::string& file);
/// 16 bits for each number, rows from the top. `channels`: 1 (gray) or 3 (red, green, blue). Throws Error if
/// the file cannot be written.
void writePng16(int width, int height, int channels, const std::vector<std::uint16_t>& numbers,
                const std::string& file);

}  // namespace rubble::io

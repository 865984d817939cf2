#pragma once
/// Draws bodies and surfaces under sun and sky with OpenGL. One thread, one context, which must be current in
/// every call.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "io/picture.h"
#include "render/bodies.h"
#include "render/overlay.h"

namespace rubble::render {

/// A deformable surface of this frame: cloth, the skin of a soft body, the hull of a rod.
struct Surface {
  std::vector<Vec3f> vertices;  ///< in the renderer's frame [m]
  std::vector<Triangle> triangles;
  Vec3f color{.5f, .5f, .5f};  ///< linear
  Finish finish = Finish::Cloth;
  std::vector<float> heat = {};  ///< of the vertices, 0 to 1: colors in place of `color`; empty: none
};

/// A point of light (rubble/appearance.h).
struct Lamp {
  Vec3 position;  ///< world [m]
  Vec3f light;    ///< at one metre, linear, over that of the sun
};

/// Light and scale of a scene; nothing here depends on the view, so it stays as the camera moves.
struct Setting {
  Vec3 up{0, 0, 1};           ///< unit
  Vec3 toSun{-.4, -.5, .77};  ///< unit
  Vec3f sunlight{1, 1, 1};    ///< factor on its light, linear
  double skylight = 1;        ///< factor on the sky and its light
  std::vector<Lamp> lamps = {};
  double bodySize = .5;   ///< half size of a typical body: what occlusion and shadows are scaled by [m]
  double sceneSize = 20;  ///< planes fade into the horizon from about here on [m]
  /// Color in place of the sky, linear.
  std::optional<Vec3f> background = {};
  /// The picture has an alpha channel, in which sky and planes are transparent. Needs several samples a
  /// pixel.
  bool transparent = false;
};

struct Quality {
  int samples = 1;        ///< a pixel; with one, edges are smoothed afterwards
  int shadowSize = 2048;  ///< texels across a shadow map
  int shadowMaps = 4;     ///< at most
  int shadowTaps = 8;     ///< a pixel and sample
};

/// Time per pass of the last picture [ms]; the passes add up to the picture. Measured only
/// if asked for, since that waits for the GPU after each pass.
struct PassTime {
  const char* name;
  double ms;
};

class Renderer {
 public:
  Renderer(int width, int height);
  ~Renderer();

  /// Poses are relative to this point of the world: keep it near the scene [m].
  void setOrigin(const Vec3& origin);
  const Vec3& origin() const;
  Bodies& bodies();
  void setSurfaces(std::span<const Surface> surfaces);
  /// Drawn over the picture, until they are set anew.
  void setLines(std::span<const Line> lines);
  void resize(int width, int height);

  /// Draws a picture into the renderer's own target.
  void draw(const Camera& camera, const Setting& setting, const Quality& quality);
  /// Waits until the last picture is drawn.
  void finish() const;
  /// The last picture. Waits for the GPU.
  io::Image read() const;
  /// View depth of each pixel of the last picture, rows from the top [m]; infinity in the sky.
  std::vector<float> readDepths() const;
  /// Unit normal of each pixel of the last picture, three numbers in world axes, rows from the top; 0 in the
  /// sky.
  std::vector<float> readNormals() const;
  /// Copies the last picture to a framebuffer (0: the window), so many pixels from its left.
  void show(unsigned framebuffer, int left = 0) const;
  /// Body at a pixel (from the left and the top) of the last picture, or -1.
  int bodyAt(int x, int y) const;
  /// Deformable surface at a pixel, by its place in setSurfaces, or -1.
  int surfaceAt(int x, int y) const;
  /// Point of the world that is seen at a pixel of the last picture; far away where that is the sky.
  Vec3 pointAt(int x, int y) const;
  /// What each pixel of the last picture shows, rows from the top: a body by its place, -1 the sky, -2 - k
  /// the deformable surface k.
  std::vector<int> readBodies() const;
  /// Draws this body highlighted; -1: none.
  void select(int body);

  void measurePasses(bool on);
  const std::vector<PassTime>& passTimes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rubble::render

#pragma once
/// A world as colored lines, triangles and text, to be drawn by any renderer.
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/world.h>

namespace rubble {

/// Primitives in world coordinates [m]. Colors are 0xRRGGBB.
struct DebugDraw {
  struct Line {
    Vec3 from, to;
    std::uint32_t color;
  };
  struct Triangle {
    Vec3 corner[3];  ///< counter-clockwise seen from outside
    std::uint32_t color;
  };
  struct Text {
    Vec3 position;
    std::string text;
    std::uint32_t color;
  };
  std::vector<Line> lines;
  std::vector<Triangle> triangles;
  std::vector<Text> texts;
};

/// What to draw.
struct DebugDrawOptions {
  bool surfaces = true;   ///< triangles of bodies and deformable objects. A plane has none: see `planeSize`
  bool edges = false;     ///< the edges of these triangles as lines
  bool contacts = false;  ///< a line along the force of each contact point
  bool joints = false;    ///< a line from body A over the anchors to body B
  bool bounds = false;    ///< axis-aligned boxes of the bounding spheres
  bool names = false;     ///< the names of bodies, at their positions
  double forceScale = 1e-3;  ///< length of a contact force [m/N]
  double planeSize = 20;     ///< edge of the square that stands for a plane [m]; 0: none
  int segments = 16;         ///< triangles per full circle
};

/// Colors of bodies: gray static, blue kinematic, sand dynamic, violet asleep, green sensors. Broken joints
/// are red.
DebugDraw debugDraw(const World& world, const DebugDrawOptions& options = {});

}  // namespace rubble

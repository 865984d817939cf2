#pragma once
/// Lines drawn over a picture: contacts, forces, joint frames and bounds.
#include <string>
#include <vector>

#include <rubble/world.h>

namespace rubble::render {

/// A line as wide everywhere as it says; one without length is a dot.
struct Line {
  Vec3 a, b;              ///< world [m]
  std::uint32_t rgb = 0;  ///< sRGB
  float width = 1.5f;     ///< pixels of a picture 720 high
};

struct Overlays {
  bool contacts = false;  ///< points, and how deep they are along their normals
  bool forces = false;    ///< of contacts, joints and attachments on their second side
  bool joints = false;    ///< frames on both bodies (x red, y green, z blue), and lines to the bodies' frames
  bool bounds = false;    ///< boxes along the axes of the world

  bool any() const { return contacts || forces || joints || bounds; }
};
/// Names as on the command line: "contacts", "forces", "joints", "bounds". Throws Error for others.
Overlays overlaysNamed(const std::vector<std::string>& names);

/// Lines of a world after its last step. `size`: of a typical body [m]; the longest force is drawn
/// kLongestForce times as long.
std::vector<Line> overlayLines(const World& world, const Overlays& overlays, double size);
inline constexpr double kLongestForce = 6;
/// The frame of a joint on one of its bodies (0: A, 1: B), as position and orientation in the world.
struct Frame {
  Vec3 position;
  Quat orientation;
};
Frame jointFrame(const World& world, JointId id, int side);
/// The three axes of a frame.
void addFrame(const Frame& frame, double length, float width, std::vector<Line>& lines);
/// The edges of a box along the axes of the world.
void addBox(const Vec3& low, const Vec3& high, std::uint32_t rgb, std::vector<Line>& lines);

}  // namespace rubble::render

#pragma once
#include <array>
#include <string>
#include <vector>

#include <rubble/math.h>

namespace rubble::render {

using Vec3f = Vec3T<float>;

/// 4 x 4 by columns, as OpenGL takes it.
struct Matrix {
  std::array<float, 16> columns{};
};

/// A half space: points with dot(normal, p) + offset >= 0 are inside.
struct HalfSpace {
  Vec3f normal;
  float offset = 0;
};

/// An axis-aligned box; empty where low > high.
struct Bounds {
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};

  bool empty() const { return !(low.x <= high.x); }
  void add(const Vec3f& point);
  void add(const Bounds& other);
  Vec3f middle() const { return (low + high) * .5f; }
  Vec3f half() const { return (high - low) * .5f; }
  Vec3f corner(int i) const {
    return {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
  }
};

/// Is some of the box in all of the half spaces? May say yes for a box that is near them.
bool touches(const Bounds& bounds, const std::vector<HalfSpace>& spaces);
/// Distance from a point to the nearest point of the box [m].
float distanceTo(const Bounds& bounds, const Vec3f& point);

/// A pinhole camera.
struct Camera {
  Vec3 eye{8, -12, 6}, target{0, 0, 1};  ///< [m]
  Vec3 up{0, 0, 1};                      ///< any length; need not be square to the view
  double fieldOfView = .6;               ///< full vertical angle [rad]
};

/// A camera at the size of a picture, in the renderer's frame (the world shifted by an origin).
struct Eye {
  Vec3f position;
  Vec3f forward, right, up;    ///< unit
  float spanX = 1, spanY = 1;  ///< half width and height of the picture at view depth 1 [m]
  float nearest = .01f;        ///< [m]
  float pixelAngle = .001f;    ///< size of a pixel at view depth 1 [m]

  /// Throws Error for a camera that gives no picture (eye at target, no angle).
  Eye(const Camera& camera, const Vec3& origin, int width, int height);
  /// Depth in [-1, 1] without a far plane; `jitterX` and `jitterY` shift the picture in normalised device
  /// coordinates.
  Matrix viewProjection(float jitterX, float jitterY) const;
  /// Sides of the view and the plane ahead.
  std::vector<HalfSpace> halfSpaces() const;
  /// The point of a picture coordinate (-1 to 1, up) at a view depth.
  Vec3f at(float x, float y, float depth) const;
  float depthOf(const Vec3f& point) const { return dot(point - position, forward); }
};

}  // namespace rubble::render

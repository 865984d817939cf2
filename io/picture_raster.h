#pragma once
/// Depth and surface of bodies as seen through a window: the first half of a picture, and its shadow map.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cook/shape_mesh.h"
#include "io/picture.h"

namespace rubble::io::draw {

using Vec = Vec3T<float>;

/// A window on the world. View space is x right, y up, z forward, origin at the eye [m].
struct View {
  Vec3 eye, right, up, forward;  ///< world
  bool perspective = true;
  float scale = 1;            ///< samples for each metre, at distance 1 m if in perspective
  float nearest = 1e-3f;      ///< what is nearer is cut away [m]; perspective only
  int width = 0, height = 0;  ///< samples

  Vec toView(const Vec3& world) const;
  Vec turnToView(const Vec3& world) const;
  /// View-plane coordinates of the centre of a sample [m at distance 1, or m].
  float planeX(int x) const { return (static_cast<float>(x) + .5f - .5f * static_cast<float>(width)) / scale; }
  float planeY(int y) const { return (.5f * static_cast<float>(height) - static_cast<float>(y) - .5f) / scale; }
};

/// A body in view space.
struct ViewBody {
  ShapeType type = ShapeType::Box;
  Vec center;
  Vec axes[3];  ///< body axes, unit
  Vec half;     ///< box [m]
  float radius = 0;
  float halfLength = 0;
  std::shared_ptr<const ShapeMesh> mesh = nullptr;  ///< of what has no formula of its own here

  Vec placed(const Vec3& point) const;
  Vec turned(const Vec3& direction) const;
};
std::vector<ViewBody> toView(const View& view, std::span<const PictureBody> bodies);

/// No surface: sky, or nothing above the ground.
inline constexpr std::uint32_t kNothing = 0xffffffffu;

/// What is seen at each sample. `nearness` is 1 / z in perspective, -z else: what is nearer is larger.
struct Surfaces {
  int width = 0, height = 0;
  std::vector<float> nearness;
  std::vector<std::uint32_t> surface;  ///< body index * 8 + face; kNothing
  std::vector<std::uint32_t> detail;   ///< triangle of a mesh

  Surfaces(const View& view, bool withSurface);
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x); }
};

/// Draws every body; planes only in perspective (they throw no shadow).
void rasterize(const View& view, std::span<const ViewBody> bodies, Surfaces& out);

/// Outward unit normal of a body at a point of its surface, view space. `face` is axis * 2 + (0: positive, 1: negative side) of a box.
Vec normalAt(const ViewBody& body, std::uint32_t face, const Vec& point, std::uint32_t detail = 0);

}  // namespace rubble::io::draw

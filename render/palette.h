#pragma once
/// Colors of bodies: one muted family per scene, varied from body to body, so that the origin of a body can
/// be recognized in rubble.
#include <array>
#include <span>
#include <unordered_map>
#include <vector>

#include "io/picture.h"
#include "render/body_look.h"

namespace rubble::render {

/// Colors of categories (sRGB), distinguishable and without an order.
inline constexpr std::array<std::uint32_t, 12> kKindColors{0xc0604a, 0x3f7f93, 0xd9b35c, 0x6c9362,
                                                           0x8e6a94, 0x4f6fa8, 0xd08a4e, 0x5aa59a,
                                                           0xb5566f, 0x9aa04c, 0x7f6a5a, 0x7aa7cf};

/// Linear color of "#rrggbb" as 0xrrggbb (sRGB).
Vec3f linearColor(std::uint32_t rgb);
/// The same of red, green and blue from 0 to 1 (sRGB).
Vec3f linearColor(const Vec3f& srgb);

class Palette {
 public:
  /// Looks at the scene as it begins: how high it is, what it is mostly made of.
  Palette(std::span<const io::PictureBody> bodies, const Vec3& up);

  /// How a body looks; the same for the same key and shape in every frame, from where it was first seen.
  /// Geometry kOwnMesh stands for a mesh that ShapeMeshes has.
  BodyLook look(const io::PictureBody& body);
  /// Color of a deformable object.
  Vec3f softColor(std::uint32_t key) const;
  /// Typical half size of a moving body [m].
  double bodySize() const { return bodySize_; }

 private:
  Vec3f stone(const io::PictureBody& body) const;

  Vec3 up_;
  double low_ = 0, high_ = 1;  ///< of the scene along up [m]
  double bodySize_ = .5;       ///< [m]
  double course_ = 1;          ///< height of a course of bricks [m]
  bool isStack_ = false;       ///< many boxes: colored by course
  bool isFlat_ = false;        ///< all in one course
  BodyLook newLook(const io::PictureBody& body) const;

  struct Known {
    Shape shape;
    BodyLook look;
  };
  std::unordered_map<std::uint32_t, Known> known_;
};

/// Cold at rest, through teal and yellow to red at `fraction` 1.
Vec3f heat(double fraction);
/// The colors that heat runs along, three numbers each.
std::vector<float> heatStops();
/// Color of a value of a quantity; what has none is gray.
Vec3f valueColor(double value, io::ColorBy colorBy, double full);

}  // namespace rubble::render

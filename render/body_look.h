#pragma once
/// How a body looks.
#include "render/camera.h"

namespace rubble::render {

enum class Finish { Stone = 1, Metal, Plastic, Ground, Cloth, Paint };

/// Geometries that every renderer has; meshes of one's own follow.
enum Geometry : int { kBox, kRound, kCylinder, kPlane, kOwnMesh };

struct BodyLook {
  int geometry = kBox;
  Vec3f size{.5f, .5f, .5f};   ///< box: half extents; round and cylinder: radius twice, then radius or half
                               ///< height; mesh: scale [m]
  float halfLength = 0;        ///< round: half the distance of the two centers of a capsule [m]
  Vec3f color{.5f, .5f, .5f};  ///< linear, 0 to 1
  Finish finish = Finish::Stone;
  bool heated = false;  ///< surfaces: colored by what their vertices say
};

}  // namespace rubble::render
